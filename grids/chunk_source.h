/* chunk_source: where the voxels of a dense volume are read from chunk by chunk, so that the volume need
 * not be in memory as a whole. */
#ifndef ISO_GRIDS_CHUNK_SOURCE_H
#define ISO_GRIDS_CHUNK_SOURCE_H

#include "base/parallel.h"
#include "grids/grid_chunk.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The volume is described as an iso_rgrid is. */
typedef struct iso_chunk_source {
    int dims[3];
    iso_type type;
    double scale, offset;
    iso_transform transform;
    int level_set;
    /* Makes the grid of a chunk (grids/grid_chunk.h) of this volume; the caller destroys it before the
     * source ends. Reads with all threads of `pool`. ISO_ERR_NOMEM, and errors of reading. */
    iso_status (*read)(void *context, const iso_grid_chunk *chunk, iso_pool *pool, iso_rgrid **grid,
                       iso_error *error);
    /* Optional: whether all voxels of a chunk are known to be `*value` (a stored value), without reading
     * them. */
    bool (*is_constant)(void *context, const iso_grid_chunk *chunk, float *value);
    /* Optional: no grid is in use now, so that memory that only helps to read faster can be given back. */
    void (*rest)(void *context);
    void *context;
} iso_chunk_source;

/* The source of a volume that is in memory, which is borrowed. Nothing is copied. */
iso_chunk_source iso_chunk_source_of(const iso_rgrid *grid);

/* Which chunks are visited: every `turns`th, from chunk `turn` on. {0, 1}: all. */
typedef struct iso_chunk_turns {
    int turn, turns;
} iso_chunk_turns;

/* Calls `visit` for the chunks of a volume, `side` voxels along each side (rounded up to whole bricks), one
 * after the other. `grid`: the chunk's voxels without its halo, for the call only; `first`: the number in
 * the volume of its voxel (0, 0, 0). When `visit` fails, its status is returned. Errors of reading. */
typedef iso_status iso_chunk_voxels_visitor(void *context, const iso_rgrid *grid, const int first[3],
                                            iso_error *error);
iso_status iso_chunk_source_visit(const iso_chunk_source *source, int side, iso_chunk_turns turns,
                                  iso_pool *pool, iso_chunk_voxels_visitor *visit, void *context,
                                  iso_error *error);

/* Counts the voxels that are NaN or infinite. Errors of reading. */
iso_status iso_chunk_source_count_nonfinite(const iso_chunk_source *source, int side, iso_pool *pool,
                                            size_t *count, iso_error *error);

#ifdef __cplusplus
}
#endif
#endif
