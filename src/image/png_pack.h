/* png_pack: the compressed pixels of a PNG, by all threads: bands of rows are filtered and deflated on their
 * own, and their parts put together are one zlib stream (RFC 1950; bands end on whole bytes, checksums are
 * combined). Neither bands nor bytes depend on the number of threads. Internal to image. */
#ifndef ISO_IMAGE_PNG_PACK_H
#define ISO_IMAGE_PNG_PACK_H

#include <stdbool.h>
#include <stddef.h>

#include "base/parallel.h"
#include "image/image.h"
#include "image/png_palette.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { ISO_PNG_ROUND = 64 };

/* Where a band's part is, in memory of the packer's. */
typedef struct iso_png_part {
    uint8_t *bytes;
    size_t size;
    uint32_t checksum; /* Adler-32 of the filtered rows */
    bool failed;
} iso_png_part;

/* Zero-initialise but for the first five. */
typedef struct iso_png_packer {
    const iso_image *image;
    int channels;                   /* 4: RGBA, 3: RGB, 1: indices */
    const iso_png_palette *palette; /* of indices; borrowed */
    bool small;                     /* look for longer matches */
    iso_pool *pool;
    int next_row;
    uint32_t checksum;
    iso_png_part parts[ISO_PNG_ROUND];
    int part_count;
} iso_png_packer;

/* Packs the next bands into `parts`, which hold until the next call; none when all rows are packed.
 * ISO_ERR_NOMEM without a text. */
iso_status iso_png_pack(iso_png_packer *packer);
void iso_png_packer_free(iso_png_packer *packer);

#ifdef __cplusplus
}
#endif
#endif
