/* image: 8-bit RGBA pictures and PNG.
 *
 * Row 0 is the top row. Alpha is straight (not premultiplied). Pixel (x, y) covers [x, x+1) x [y, y+1). */
#ifndef ISO_IMAGE_IMAGE_H
#define ISO_IMAGE_IMAGE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/parallel.h"
#include "base/status.h"
#include "isopoint.h"

bool iso_image_is_opaque(const iso_image *image); /* whether no pixel is transparent */

/* A text in a PNG file: a tEXt chunk, or an iTXt chunk in UTF-8 when the value is not ASCII. Keys are those
 * of the PNG specification ("Software", "Description"). */
typedef struct iso_png_text {
    const char *key, *value;
} iso_png_text;

/* Writes a PNG, RGB when all pixels are opaque and RGBA otherwise, through base/file.h: path "-" is stdout,
 * and a file appears whole or not at all. texts: `text_count` entries, may be NULL. ISO_ERR_WRITE,
 * ISO_ERR_NOMEM. */
iso_status iso_png_write(const char *path, const iso_image *image, const iso_png_text *texts, int text_count,
                         iso_error *error);

typedef struct iso_png_opts {
    const iso_png_text *texts;
    int text_count;
    bool small; /* smaller files, more time; up to 256 opaque colours are stored as a palette */
    double
        pixels_per_metre; /* written as a pHYs chunk, rounded; 0, or more than that can hold: not written */
    iso_pool *pool;       /* for compression; NULL: the calling thread; the bytes do not depend on it */
} iso_png_opts;
iso_status iso_png_write_with(const char *path, const iso_image *image, const iso_png_opts *opts,
                              iso_error *error);

/* Encodes the bytes that iso_png_write_with would write into memory: *bytes (the caller's, to free()) and
 * *size. ISO_ERR_NOMEM. */
iso_status iso_png_encode(const iso_image *image, const iso_png_opts *opts, uint8_t **bytes, size_t *size,
                          iso_error *error);

/* Reads width and height from the file's first bytes, without decoding the picture. False when it is not a
 * PNG, or cannot be read; iso_png_read then gives the reason. */
bool iso_png_size(const char *path, uint32_t size[2]);

/* Reads any PNG as 8-bit RGBA; gamma and colour profiles are ignored. ISO_ERR_IO, ISO_ERR_FORMAT (also for
 * sides beyond ISO_IMAGE_MAX), ISO_ERR_NOMEM. */
iso_status iso_png_read(const char *path, iso_image *image, iso_error *error);

#endif
