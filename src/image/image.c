/* image: allocates and frees 8-bit pictures. */
#include "image/image.h"

#include <string.h>

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
    const size_t pixels = (size_t)image->width * (size_t)image->height;
    uint64_t all = ~(uint64_t)0; /* what all pairs of pixels have in common */
    uint8_t channels[8];
    for (size_t i = 0; i + 2 <= pixels; i += 2) {
        uint64_t two;
        memcpy(&two, image->rgba + 4 * i, sizeof two);
        all &= two;
    }
    memcpy(channels, &all, sizeof channels);
    return (channels[3] & channels[7] & image->rgba[4 * pixels - 1]) == 255;
}
