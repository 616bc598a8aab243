/* png_pack: compresses the pixels of a PNG with several threads. Bands of rows are filtered and deflated
 * independently; their concatenation is one zlib stream (RFC 1950), as each band ends on a whole byte and the
 * checksums are combined. The bytes do not depend on the number of threads. Internal to image. */
#ifndef ISO_IMAGE_PNG_PACK_H
#define ISO_IMAGE_PNG_PACK_H

#include <stdbool.h>
#include <stddef.h>

#include "base/parallel.h"
#include "image/image.h"
#include "image/png_palette.h"

enum { ISO_PNG_ROUND = 64 }; /* most bands that one call compresses */

/* The compressed bytes of a band, owned by the packer. */
typedef struct iso_png_part {
    uint8_t *bytes;
    size_t size;
    uint32_t checksum; /* Adler-32 of the filtered rows */
    bool failed;
} iso_png_part;

/* The caller sets the first five members and zeroes the rest. */
typedef struct iso_png_packer {
    const iso_image *image;
    int channels;                   /* 4: RGBA, 3: RGB, 1: indices */
    const iso_png_palette *palette; /* for 1 channel; borrowed */
    bool small;                     /* compress more, and slower */
    iso_pool *pool;
    int next_row;
    uint32_t checksum;
    iso_png_part parts[ISO_PNG_ROUND];
    int part_count;
} iso_png_packer;

/* Compresses the next bands into `parts`, which stay valid until the next call. part_count is 0 when all rows
 * are done. ISO_ERR_NOMEM, without a message. */
iso_status iso_png_pack(iso_png_packer *packer);
void iso_png_packer_free(iso_png_packer *packer);

#endif
