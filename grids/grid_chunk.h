/* grid_chunk: a box of bricks of a dense grid (the *whole*) whose other voxels need not be in memory.
 *
 * What is extracted from a chunk is what the whole has in the chunk's bricks: with the whole's brick numbers
 * and positions, byte for byte. For this a chunk needs voxels around its bricks as well, its halo, as far as
 * the whole has them: one layer below (central differences at the first voxels) and two layers above (the
 * cells that reach into the next bricks, and the differences at their corners). */
#ifndef ISO_GRIDS_GRID_CHUNK_H
#define ISO_GRIDS_GRID_CHUNK_H

#include <stdbool.h>

#include "base/parallel.h"
#include "grids/brick_range.h"
#include "grids/rgrid.h"

/* Layers of voxels around the bricks of a chunk that it needs. */
enum { ISO_CHUNK_BELOW = 1, ISO_CHUNK_ABOVE = 2 };

/* A box of bricks: first .. end - 1 on each axis. */
typedef struct iso_brick_box {
    int first[3], end[3];
} iso_brick_box;

/* Where a chunk lies in the whole. */
typedef struct iso_grid_chunk {
    int dims[3];             /* of the whole, voxels */
    iso_transform transform; /* of the whole */
    iso_brick_box box;       /* the chunk's bricks, in the whole's numbers; not empty */
    /* The brick of the whole that is brick (0, 0, 0) of the chunk's grid, whose voxel (0, 0, 0) is voxel 16
     * * origin of the whole. Where there are bricks below the box, it is the last of them: grids of chunks
     * begin at a brick, and only the last layer of voxels of the brick below must be set. */
    int origin[3];
    int size[3]; /* of the chunk's grid, voxels */
    /* The ranges of the box's bricks (iso_grid_chunk_ranges), borrowed: they save reading when the chunk is
     * extracted. NULL is fine. */
    const iso_brick_range *ranges;
    /* Which of the box's bricks (numbered as their ranges) matter, a bit each, borrowed; NULL: all do. Voxels
     * that only other bricks need may be anything. */
    const uint64_t *needed;
    bool bare; /* the halo is not needed */
} iso_grid_chunk;

static inline size_t iso_brick_box_count(const iso_brick_box *box) {
    size_t count = 1;
    for (int axis = 0; axis < 3; axis++) count *= (size_t)(box->end[axis] - box->first[axis]);
    return count;
}

/* Whether the bit of a brick of the box is set. */
static inline bool iso_brick_box_has(const iso_brick_box *box, const uint64_t *bits, const int brick[3]) {
    const size_t columns = (size_t)(box->end[0] - box->first[0]),
                 rows = (size_t)(box->end[1] - box->first[1]);
    const size_t number =
        ((size_t)(brick[2] - box->first[2]) * rows + (size_t)(brick[1] - box->first[1])) * columns +
        (size_t)(brick[0] - box->first[0]);
    return bits[number / 64] >> number % 64 & 1;
}

/* Describes the chunk of the bricks in `box`, which is first clipped to the whole. False: there are none. */
bool iso_grid_chunk_make(const int dims[3], const iso_transform *transform, const iso_brick_box *box,
                         iso_grid_chunk *chunk);

/* The voxels that the chunk needs, in the whole's numbers: first[axis] .. end[axis] - 1. */
void iso_grid_chunk_voxels(const iso_grid_chunk *chunk, int first[3], int end[3]);

/* Whether a brick that matters needs some of the voxels first .. end - 1 (in the whole's numbers). */
bool iso_grid_chunk_needs(const iso_grid_chunk *chunk, const int first[3], const int end[3]);

/* Makes the chunk's grid of the whole's voxels, which are not copied: the whole must outlive it. Destroy with
 * iso_rgrid_destroy. ISO_ERR_NOMEM. */
iso_status iso_grid_chunk_view(const iso_rgrid *whole, const iso_grid_chunk *chunk, iso_rgrid **view,
                               iso_error *error);

/* Reads the ranges of the box's bricks from the chunk's grid: ranges[(z * rows + y) * columns + x], with x,
 * y, z counted from the box's first brick. `pool` may be NULL. */
void iso_grid_chunk_ranges(const iso_rgrid *grid, const iso_grid_chunk *chunk, iso_pool *pool,
                           iso_brick_range *ranges);

#endif
