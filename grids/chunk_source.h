/* chunk_source: where the voxels of a dense volume are read from chunk by chunk, so that the volume need
 * not be in memory as a whole. */
#ifndef ISO_GRIDS_CHUNK_SOURCE_H
#define ISO_GRIDS_CHUNK_SOURCE_H

#include "base/parallel.h"
#include "grids/grid_chunk.h"

/* The volume is described as an iso_rgrid is. */
typedef struct iso_chunk_source {
    int dims[3];
    iso_type type;
    double scale, offset;
    iso_transform transform;
    int level_set;
    /* The voxels of the tiles that are read as a whole (grids/volume/tiled.h), and where the first voxel of
     * the volume lies in its tile; 0: there are no tiles. */
    int tile[3], in_tile[3];
    /* Makes the grid of a chunk (grids/grid_chunk.h) of this volume; the caller destroys it before the
     * source ends. Reads with all threads of `pool`. ISO_ERR_NOMEM, and errors of reading. */
    iso_status (*read)(void *context, const iso_grid_chunk *chunk, iso_pool *pool, iso_rgrid **grid,
                       iso_error *error);
    /* Optional: whether all voxels of a chunk are known to be `*value` (a stored value), without reading
     * them. */
    bool (*is_constant)(void *context, const iso_grid_chunk *chunk, float *value);
    /* Optional: bytes of the voxels of all tiles that were read and decoded so far. */
    uint64_t (*decoded)(void *context);
    /* Optional: gives back memory that only helps to read faster, because there is no other left, and takes
     * less from now on. False: there is none. No grid is in use. */
    bool (*give_back)(void *context);
    /* Optional: no grid is in use now, so that memory that only helps to read faster can be given back. */
    void (*rest)(void *context);
    void *context;
} iso_chunk_source;

/* The source of a volume that is in memory, which is borrowed. Nothing is copied. */
iso_chunk_source iso_chunk_source_of(const iso_rgrid *grid);

/* How a volume is cut into chunks of about `side` voxels (rounded up to whole bricks). Where tiles are not
 * larger, a chunk ends with the last brick that needs no voxel beyond a border of tiles: so that tiles are
 * not decoded for two layers of voxels, long before the others of them are needed. */
typedef struct iso_chunk_cuts {
    int bricks[3]; /* of the volume */
    int counts[3]; /* of chunks */
    int most[3];   /* bricks of the largest chunk */
    int pitch[3];  /* voxels from one border to the next */
    int before[3]; /* the first border lies at pitch - before */
    int above;     /* voxels above its bricks that a chunk needs this side of a border */
} iso_chunk_cuts;

void iso_chunk_cuts_make(const iso_chunk_source *source, int side, iso_chunk_cuts *cuts);
/* The first brick of chunk `number` along an axis; of the number of chunks: that of bricks. */
int iso_chunk_cut(const iso_chunk_cuts *cuts, int axis, int number);
/* The chunk that has a brick. */
int iso_chunk_with(const iso_chunk_cuts *cuts, int axis, int brick);
/* The bricks of chunk `number`, counted along x, y, z. */
iso_brick_box iso_chunk_box(const iso_chunk_cuts *cuts, size_t number);
size_t iso_chunk_cuts_count(const iso_chunk_cuts *cuts);

/* By how many bricks the first blocks of 64^3 voxels are to be smaller (iso_block_ranges.before), so that
 * they end where chunks of whole tiles do, if sides of tiles and blocks divide each other. */
void iso_chunk_source_blocks(const iso_chunk_source *source, int before[3]);

/* Which chunks are visited: every `turns`th, from chunk `turn` on. {0, 1}: all. */
typedef struct iso_chunk_turns {
    int turn, turns;
} iso_chunk_turns;

/* Calls `visit` for the chunks of a volume (iso_chunk_cuts_make), one after the other. `grid`: the chunk's
 * voxels without its halo, for the call only; `first`: the number in the volume of its voxel (0, 0, 0);
 * `constant`: all voxels are known to be equal. When `visit` fails, its status is returned. Errors of
 * reading. */
typedef iso_status iso_chunk_voxels_visitor(void *context, const iso_rgrid *grid, const int first[3],
                                            bool constant, iso_error *error);
iso_status iso_chunk_source_visit(const iso_chunk_source *source, int side, iso_chunk_turns turns,
                                  iso_pool *pool, iso_chunk_voxels_visitor *visit, void *context,
                                  iso_error *error);

/* Counts the voxels that are NaN or infinite. Errors of reading. */
iso_status iso_chunk_source_count_nonfinite(const iso_chunk_source *source, int side, iso_pool *pool,
                                            size_t *count, iso_error *error);

#endif
