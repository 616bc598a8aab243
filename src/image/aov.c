/* aov: allocates and frees the float planes of a picture. */
#include "image/aov.h"

#include "base/memory.h"
#include "image/image.h"

iso_status iso_aov_create(int width, int height, iso_aov *aov, iso_error *error) {
    if (width < 1 || height < 1 || width > ISO_IMAGE_MAX || height > ISO_IMAGE_MAX)
        return iso_fail(error, ISO_ERR_USAGE, "picture size %dx%d: sides must be 1..%d", width, height,
                        ISO_IMAGE_MAX);
    iso_aov made = {.width = width, .height = height};
    float **planes[ISO_AOV_PLANES] = {&made.depth, &made.normal[0], &made.normal[1], &made.normal[2],
                                      &made.coverage};
    for (int i = 0; i < ISO_AOV_PLANES; i++) {
        *planes[i] = iso_alloc((size_t)width * (size_t)height * sizeof(float));
        if (*planes[i]) continue;
        iso_aov_free(&made);
        return iso_fail(error, ISO_ERR_NOMEM, "out of memory for depth and normals of %dx%d pixels", width,
                        height);
    }
    *aov = made;
    return ISO_OK;
}

iso_status iso_aov_add_layers(iso_aov *aov, iso_error *error) {
    if (!aov->layers) aov->layers = iso_alloc((size_t)aov->width * (size_t)aov->height * sizeof(float));
    return aov->layers ? ISO_OK : iso_fail(error, ISO_ERR_NOMEM, "out of memory for the numbers of layers");
}

void iso_aov_remove_layers(iso_aov *aov) {
    iso_free(aov->layers);
    aov->layers = NULL;
}

void iso_aov_free(iso_aov *aov) {
    iso_free(aov->depth);
    for (int axis = 0; axis < 3; axis++) iso_free(aov->normal[axis]);
    iso_free(aov->coverage);
    iso_free(aov->layers);
    *aov = (iso_aov){0};
}
