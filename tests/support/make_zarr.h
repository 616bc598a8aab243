/* Small arrays with axes c, z, y and x for the tests of Zarr and N5: their values, how they are written, and
 * whether they are read so. */
#ifndef ISO_TESTS_SUPPORT_MAKE_ZARR_H
#define ISO_TESTS_SUPPORT_MAKE_ZARR_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { ZARR_AXES = 4, ZARR_MOST = 1 << 20 }; /* c z y x */

typedef enum zarr_coding {
    ZARR_PLAIN,
    ZARR_ZLIB,
    ZARR_GZIP,
    ZARR_ZSTD,
    ZARR_LZ4,
    ZARR_BLOSC,
    ZARR_BZ2,
    ZARR_ALL_CODINGS
} zarr_coding;
enum { ZARR_CODINGS = ISO_HAVE_BZIP2 ? ZARR_ALL_CODINGS : ZARR_BZ2 };

/* How an array is written. */
typedef struct zarr_layout {
    int version;
    int shape[ZARR_AXES], chunk[ZARR_AXES], across[ZARR_AXES]; /* across: chunks of a shard; 0: no shards */
    int order[ZARR_AXES]; /* the axes of a chunk in memory, slowest first */
    const char *type;     /* "u1", "i2", "f4", .. */
    bool big, prefix, checked, index_at_start;
    char separator;
    zarr_coding coding;
    const char *compressor; /* of blosc */
    int missing;            /* the number of a chunk that is not written; -1: none */
    const char *fill;
    const char *fill_text; /* how the metadata have it; NULL: as it is */
    bool delta, shuffle;   /* filters; delta only in version 2 */
} zarr_layout;

/* A layout to change: two channels of 19 x 13 x 11 voxels. */
zarr_layout zarr_usual(int version);
double zarr_value_at(const int at[ZARR_AXES]);
int zarr_size_of(const zarr_layout *l); /* bytes of a value */
void zarr_store(const zarr_layout *l, double value, unsigned char *target);

int zarr_chunks_along(const zarr_layout *l, int axis);
int zarr_number_of(const zarr_layout *l, const int index[ZARR_AXES]); /* of a chunk */
bool zarr_is_missing(const zarr_layout *l, const int at[ZARR_AXES]);  /* whether the chunk of a voxel is */

/* A chunk's values, and what they were coded to. */
extern unsigned char zarr_plain[ZARR_MOST], zarr_coded[ZARR_MOST];
/* Codes the first bytes of zarr_plain; returns their number then. */
size_t zarr_code_chunk(const zarr_layout *l, size_t bytes);

void zarr_write_metadata(const zarr_layout *l, const char *path);
/* Writes an array of Zarr into a folder, which is emptied before. */
void zarr_write_array(const zarr_layout *l, const char *path);
/* Fails the test unless the folder is read as all channels of the array. */
void zarr_expect_array(const zarr_layout *l, const char *path);

#endif
