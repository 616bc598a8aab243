/* las_blocks: what the blocks before the points of a LAS file ("variable length records") say of them: the
 * unit of their coordinates, and the columns behind the numbers of their format ("extra bytes"). Internal to
 * src/io/glyphs. */
#ifndef ISO_IO_GLYPHS_LAS_BLOCKS_H
#define ISO_IO_GLYPHS_LAS_BLOCKS_H

#include "io/polydata/records.h"

enum {
    ISO_LAS_BLOCK = UINT16_MAX,
    ISO_LAS_EXTRA = 192,
    ISO_LAS_EXTRAS = ISO_LAS_BLOCK / ISO_LAS_EXTRA,
    ISO_LAS_LASZIP = 128
};

/* The numbers of a column: 1 to 3 of one type for each point, or bytes without a known meaning. */
typedef struct iso_las_extra {
    char name[33];
    size_t bytes; /* of a point */
    int count;    /* numbers of a point; 0: their meaning is not known */
    iso_scalar scalar;
    bool has_no_data;
    double no_data[3]; /* as stored: stands for "no value" */
    double scale[3], shift[3];
} iso_las_extra;

/* Zero-initialise. */
typedef struct iso_las_blocks {
    /* How points are compressed; the contents of LASzip's block, or as much of them as are used. */
    bool compressed;
    unsigned char laszip[ISO_LAS_LASZIP];
    size_t laszip_bytes;
    iso_world_unit unit; /* of x and y */
    int extra_count;
    iso_las_extra extras[ISO_LAS_EXTRAS];
    unsigned char block[ISO_LAS_BLOCK + 1]; /* the contents of one */
} iso_las_blocks;

/* Reads `count` blocks from the stream, whose next `bytes` bytes hold them, and skips what is left of those.
 * ISO_ERR_IO. */
iso_status iso_las_blocks_read(iso_las_blocks *blocks, iso_stream *stream, uint64_t count, uint64_t bytes,
                               iso_error *error);

#endif
