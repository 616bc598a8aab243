/* Memory of pictures: allocated anew only when a larger picture is drawn than ever before. */
#include "apps/isosculpt/viewport/memory.h"

iso_status isosculpt_reserve_samples(iso_gbuffer *gbuffer, int width, int height, iso_error *error) {
    iso_gbuffer larger;
    if (gbuffer->samples < (size_t)width * (size_t)height) {
        ISO_TRY(iso_gbuffer_create(width, height, &larger, error));
        iso_gbuffer_free(gbuffer);
        *gbuffer = larger;
    }
    gbuffer->width = width;
    gbuffer->height = height;
    return ISO_OK;
}

iso_status isosculpt_reserve_pixels(iso_image *image, size_t *room, int width, int height, iso_error *error) {
    iso_image larger;
    size_t pixels = (size_t)width * (size_t)height;
    if (*room < pixels) {
        ISO_TRY(iso_image_create(width, height, &larger, error));
        iso_image_free(image);
        *image = larger;
        *room = pixels;
    }
    image->width = width;
    image->height = height;
    return ISO_OK;
}
