#include "image/image_file.h"

#include <string.h>

#include "base/file_types.h"

iso_image_kind iso_image_kind_of(const char *path) {
    if (strcmp(path, "-") == 0) return ISO_IMAGE_PNG;
    switch (iso_file_type_of_name(path, ISO_WRITES_IMAGE)) {
#define WRITE_IMAGE(kind) return ISO_IMAGE_##kind;
#include "base/file_types.inc"
    default:
        break;
    }
    return ISO_IMAGE_UNKNOWN;
}

iso_status iso_image_file_check(const char *path, iso_error *error) {
    if (iso_image_kind_of(path) != ISO_IMAGE_JPEG || iso_jpeg_available()) return ISO_OK;
    return iso_fail(error, ISO_ERR_BACKEND, "%s: built without libjpeg: .png and .tif need no library", path);
}

iso_status iso_image_file_write(const char *path, const iso_image *image, const iso_png_opts *opts,
                                iso_error *error) {
    switch (iso_image_kind_of(path)) {
    case ISO_IMAGE_PNG:
        return iso_png_write_with(path, image, opts, error);
    case ISO_IMAGE_TIFF:
        return iso_tiff_write(path, image, opts, error);
    case ISO_IMAGE_JPEG:
        if (!iso_image_is_opaque(image))
            return iso_fail(error, ISO_ERR_USAGE, "%s: a JPEG has no transparency: .png and .tif have", path);
        return iso_jpeg_write(path, image, opts, error);
    case ISO_IMAGE_UNKNOWN:
        break;
    }
    return iso_fail(error, ISO_ERR_USAGE, "%s: a picture's name ends in .png, .tif or .jpg", path);
}
