/* jpeg_none: stands in for jpeg_read.c and jpeg_write.c where libjpeg is not built in. */
#include "image/image_file.h"

bool iso_jpeg_available(void) {
    return false;
}

iso_status iso_jpeg_write(const char *path, const iso_image *image, const iso_png_opts *opts,
                          iso_error *error) {
    (void)image;
    (void)opts;
    return iso_image_file_check(path, error);
}

iso_status iso_jpeg_read(const char *path, iso_image *image, iso_error *error) {
    (void)image;
    return iso_fail(error, ISO_ERR_BACKEND, "%s: built without libjpeg: .png needs no library", path);
}
