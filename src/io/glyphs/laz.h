/* laz: the points of a compressed LAS file (LAZ, and COPC, which is LAZ whose chunks are the nodes of an
 * octree): chunks that are decoded each by itself, and the table of them. Internal to src/io/glyphs. */
#ifndef ISO_IO_GLYPHS_LAZ_H
#define ISO_IO_GLYPHS_LAZ_H

#include "base/parallel.h"
#include "grids/volume/mapping.h"
#include "io/glyphs/laz_items.h"
#include "io/polydata/records.h"

/* A chunk: `bytes` bytes from byte `begin` of the file, points `first` to first + points - 1. */
typedef struct iso_laz_chunk {
    uint64_t begin, bytes, first, points;
} iso_laz_chunk;

/* Zero-initialise. */
typedef struct iso_laz {
    const char *path; /* borrowed; messages begin with it */
    iso_mapping *mapping;
    uint64_t size; /* of the file */
    int compressor;
    uint32_t chunk_points; /* UINT32_MAX: the table says it of each chunk */
    iso_laz_layout layout;
    const iso_laz_decoder *decoder;
    iso_buffer chunks; /* of iso_laz_chunk */
    size_t chunk_count;
} iso_laz;

/* Opens a file whose header and blocks have been read: the contents of the block of LASzip, where the points
 * begin, how many they are, and the bytes of a record. iso_laz_close when done, also after an error.
 * ISO_ERR_IO: damaged or truncated; ISO_ERR_UNSUPPORTED: a way of compression that is not read;
 * ISO_ERR_NOMEM. */
iso_status iso_laz_open(iso_laz *laz, const char *path, const unsigned char *block, size_t block_bytes,
                        uint64_t begin, uint64_t points, size_t record, iso_error *error);
void iso_laz_close(iso_laz *laz);

/* The first point, as its record; NULL: there are none. */
const unsigned char *iso_laz_first(const iso_laz *laz);

/* Adds all points, whose fields are those of records. Chunks are decoded on all threads of the pool, which
 * may be NULL. ISO_ERR_IO: a chunk is damaged; ISO_ERR_LIMIT, ISO_ERR_NOMEM. */
iso_status iso_laz_add_points(const iso_laz *laz, iso_polydata *data, const iso_record_field *fields,
                              int count, iso_pool *pool, iso_error *error);

#endif
