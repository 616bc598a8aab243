/* brick: what the per-brick kernels read: floats around one brick, and which surface is looked for. Internal
 * to extract. */
#ifndef ISO_EXTRACT_BRICK_H
#define ISO_EXTRACT_BRICK_H

#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/primitives.h"
#include "grids/grid.h"
#include "grids/halo.h"
#include "grids/threshold.h"

/* The halos of extraction live here and nowhere else. */

/* An edge p, p + 1 reads both ends' central differences: p - 1 .. p + 2 along its axis and p - 1 .. p + 1
 * along the others. */
#define ISO_HALO_EDGE ((iso_halo){.down = 2, .up = 1})
/* A mesh span also holds copies of the vertices on its far faces: edges of lower voxels up to 16 in the
 * brick, but none that runs along the axis on which it is 16. On that axis such an edge reads 15 .. 17, no
 * further than the brick's own edges, so the bricks are those of edge points. */
#define ISO_HALO_MESH ISO_HALO_EDGE
/* A foot point of voxel p reads p - 1 .. p + 1. */
#define ISO_HALO_FOOT ((iso_halo){.down = 1, .up = 1})
/* An iterated foot point is sampled less than 2 voxels from its voxel, so in cells whose corners are p - 2 ..
 * p + 2, and a corner's gradient reads one further; choosing the seed reads p - 1 .. p + 1. */
#define ISO_HALO_ITERATED ((iso_halo){.down = 3, .up = 3})

typedef struct iso_brick_window {
    int brick[3];
    int first[3], last[3]; /* first and last voxel of the grid, counted from voxel 16 * brick */
    float values[ISO_WINDOW_VOXELS];
} iso_brick_window;

enum { ISO_STEP_Y = ISO_WINDOW, ISO_STEP_Z = ISO_WINDOW * ISO_WINDOW };

void iso_brick_window_fill(const iso_grid *grid, const int brick[3], iso_brick_window *window);

/* Index in `values` of voxel (x, y, z) of the brick, each -1 .. 17. */
static inline ptrdiff_t iso_window_index(int x, int y, int z) {
    return (x + ISO_WINDOW_LOW) + (ptrdiff_t)(y + ISO_WINDOW_LOW) * ISO_STEP_Y +
           (ptrdiff_t)(z + ISO_WINDOW_LOW) * ISO_STEP_Z;
}

static inline int iso_window_step(int axis) {
    return axis == 0 ? 1 : axis == 1 ? ISO_STEP_Y : ISO_STEP_Z;
}

/* Gradient at a voxel 0 .. 16 that is finite and in the grid: central differences; a neighbour outside the
 * grid or not finite counts as missing (one-sided then, or 0). The same bits from every brick's window. */
void iso_window_gradient(const iso_brick_window *window, const int voxel[3], float gradient[3]);

/* gradient * sign / |gradient|; false (and *normal unset) when there is no such thing. */
bool iso_unit_normal(const float gradient[3], float sign, float normal[3]);

#endif
