/* jpeg_read: pictures from JPEG files, turned as the camera was held. */
#include <string.h>

#include "base/jpeg_reader.h"
#include "image/image_file.h"

typedef struct turned {
    iso_jpeg_header header;
    iso_image *image;
} turned;

/* Exif 2.3, section 4.6.4 A, names the sides of the picture that the first row and the first column of the
 * file are: 1 top and left, 2 top and right, 3 bottom and right, 4 bottom and left, 5 left and top, 6 right
 * and top, 7 right and bottom, 8 left and bottom. */
static void take_row(void *context, uint32_t row, const uint8_t *pixels) {
    const turned *t = context;
    const int samples = t->header.samples, exif = t->header.orientation, rows = (int)t->header.height,
              columns = (int)t->header.width;
    for (int x = 0; x < columns; x++) {
        const int y = (int)row;
        const bool back = exif == 2 || exif == 3 || exif == 7 || exif == 8; /* the columns of the file */
        const bool up = exif == 3 || exif == 4 || exif == 6 || exif == 7;   /* its rows */
        const int along = back ? columns - 1 - x : x, across = up ? rows - 1 - y : y,
                  column = exif < 5 ? along : across, line = exif < 5 ? across : along;
        uint8_t *out = t->image->rgba + 4 * ((size_t)line * (size_t)t->image->width + (size_t)column);
        for (int c = 0; c < 3; c++) out[c] = pixels[x * samples + (samples == 3 ? c : 0)];
        out[3] = 255;
    }
}

iso_status iso_jpeg_read(const char *path, iso_image *image, iso_error *error) {
    iso_jpeg *jpeg;
    turned t = {.image = image};
    ISO_TRY(iso_jpeg_open(path, &jpeg, &t.header, error));
    const int width = (int)t.header.width, height = (int)t.header.height;
    const bool exchanged = t.header.orientation >= 5;
    iso_status status =
        iso_image_create(exchanged ? height : width, exchanged ? width : height, image, error);
    if (status == ISO_OK) {
        status = iso_jpeg_read_rows(jpeg, take_row, &t, error);
        if (status != ISO_OK) iso_image_free(image);
    }
    iso_jpeg_close(jpeg);
    return status;
}
