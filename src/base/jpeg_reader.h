/* jpeg_reader: the pixels of JPEG files, by libjpeg. A file from which libjpeg would make up pixels, because
 * it is cut or damaged, is refused. Only in builds with libjpeg (JPEG_FOUND). */
#ifndef ISO_BASE_JPEG_READER_H
#define ISO_BASE_JPEG_READER_H

#include <stdint.h>

#include "base/status.h"

typedef struct iso_jpeg iso_jpeg;

typedef struct iso_jpeg_header {
    uint32_t width, height;
    int samples;      /* of a pixel: 1 (grey) or 3 (RGB) */
    uint64_t scratch; /* bytes that decoding takes, besides a row of the caller's */
    int orientation;  /* how a camera was held: the number of Exif, 1 (upright) to 8 */
} iso_jpeg_header;

/* Opens a file and reads its header. ISO_ERR_IO: it cannot be read, or is damaged; ISO_ERR_FORMAT: its
 * colours are not grey or RGB, or libjpeg does not read its kind; ISO_ERR_NOMEM. */
iso_status iso_jpeg_open(const char *path, iso_jpeg **jpeg, iso_jpeg_header *header, iso_error *error);
/* Gives each row of pixels, from the top, to `row`: width * samples bytes, valid during the call. Once for an
 * open file. Errors as above. */
typedef void iso_jpeg_row(void *context, uint32_t y, const uint8_t *pixels);
iso_status iso_jpeg_read_rows(iso_jpeg *jpeg, iso_jpeg_row *row, void *context, iso_error *error);
void iso_jpeg_close(iso_jpeg *jpeg);

#endif
