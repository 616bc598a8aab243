/* exr_none: stands in for exr.c where OpenEXR is not built in. */
#include "image/exr.h"

bool iso_exr_available(void) {
    return false;
}

iso_status iso_exr_write(const char *path, const iso_aov *aov, const iso_exr_info *info, iso_pool *pool,
                         iso_error *error) {
    (void)aov;
    (void)info;
    (void)pool;
    return iso_fail(error, ISO_ERR_UNSUPPORTED, "%s: built without OpenEXR", path);
}

iso_status iso_exr_read(const char *path, iso_pool *pool, iso_aov *aov, iso_error *error) {
    (void)pool;
    (void)aov;
    return iso_fail(error, ISO_ERR_UNSUPPORTED, "%s: built without OpenEXR", path);
}

iso_status iso_exr_read_color(const char *path, iso_pool *pool, iso_float_image *image, iso_error *error) {
    (void)pool;
    (void)image;
    return iso_fail(error, ISO_ERR_UNSUPPORTED, "%s: built without OpenEXR", path);
}

bool iso_exr_size(const char *path, uint32_t size[2]) {
    (void)path;
    (void)size;
    return false;
}
