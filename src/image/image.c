/* image: allocates and frees 8-bit pictures. */
#include "image/image.h"

#include "base/memory.h"

iso_status iso_image_create(int width, int height, iso_image *image, iso_error *error) {
    if (width < 1 || height < 1 || width > ISO_IMAGE_MAX || height > ISO_IMAGE_MAX)
        return iso_fail(error, ISO_ERR_USAGE, "picture size %dx%d: sides must be 1..%d", width, height,
                        ISO_IMAGE_MAX);
    uint8_t *rgba = iso_alloc((size_t)width * (size_t)height * 4);
    if (!rgba) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for a %dx%d picture", width, height);
    *image = (iso_image){width, height, rgba};
    return ISO_OK;
}

void iso_image_free(iso_image *image) {
    iso_free(image->rgba);
    *image = (iso_image){0};
}

bool iso_image_is_opaque(const iso_image *image) {
    size_t width = (size_t)image->width;
    for (int y = 0; y < image->height; y++) {
        const uint8_t *row = image->rgba + (size_t)y * width * 4;
        uint8_t all = 255;
        for (size_t x = 0; x < width; x++) all &= row[4 * x + 3];
        if (all != 255) return false;
    }
    return true;
}
