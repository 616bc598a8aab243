/* chunks: the exact surface of a volume that is visited chunk by chunk (grids/chunk_walk.h). The results do
 * not depend on the size of the chunks. */
#ifndef ISO_EXACT_CHUNKS_H
#define ISO_EXACT_CHUNKS_H

#include "exact/exact.h"
#include "grids/chunk_walk.h"

/* Creates the surface of a chunk, without cells; destroy it before `voxels`, the chunk's grid. Errors as
 * iso_exact_create. */
iso_status iso_exact_chunk_create(iso_rgrid *voxels, const iso_grid_chunk *chunk, double isovalue,
                                  iso_pool *pool, iso_exact **exact, iso_error *error);

/* Computes the boxes of the surface in several coordinates (as iso_exact_bounds: affines[i] may be NULL),
 * and the number of its cells. Errors as iso_chunk_walk_visit. */
typedef struct iso_chunk_bounds {
    iso_chunk_share share; /* of which chunks; {1, 1}: all */
    const iso_affine *const *affines;
    int count;
    iso_box *boxes;      /* results */
    uint64_t primitives; /* result: cells */
} iso_chunk_bounds;
iso_status iso_exact_chunks_bounds(iso_chunk_walk *walk, iso_chunk_bounds *bounds, iso_error *error);

/* Draws a share of the surface into a key image (iso_draw_exact_keys). */
iso_status iso_exact_chunks_draw(iso_chunk_walk *walk, iso_chunk_share share,
                                 const iso_exact_key_picture *picture, iso_error *error);

#endif
