/* brick: the window of a brick (its voxels and their surroundings as floats), and the halos of extraction.
 * Internal to extract. */
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

/* The halos of extraction: how far around a changed voxel the results change. They are defined here only. */

/* The point of an edge from voxel p to p + 1 depends on central differences at both ends, that is, on the
 * voxels p - 1 .. p + 2 along the edge's axis and p - 1 .. p + 1 along the others. */
#define ISO_HALO_EDGE ((iso_halo){.down = 2, .up = 1})
/* A mesh span also holds copies of the vertices on its far faces: those of edges whose lower voxel is 16 on
 * an axis other than the edge's. On that axis such an edge depends on 15 .. 17, no farther than the brick's
 * own edges, so that the halo is that of edge points. */
#define ISO_HALO_MESH ISO_HALO_EDGE
/* The foot point of voxel p depends on p - 1 .. p + 1. */
#define ISO_HALO_FOOT ((iso_halo){.down = 1, .up = 1})
/* The field is sampled less than 2 voxels from an iterated foot point's voxel p, that is, in cells with
 * corners p - 2 .. p + 2, and gradients at corners depend on one more voxel. */
#define ISO_HALO_ITERATED ((iso_halo){.down = 3, .up = 3})

typedef struct iso_brick_window {
    int brick[3];
    int first[3], last[3]; /* first and last voxel of the grid, relative to the brick's first voxel */
    float values[ISO_WINDOW_VOXELS];
} iso_brick_window;

enum { ISO_STEP_Y = ISO_WINDOW, ISO_STEP_Z = ISO_WINDOW * ISO_WINDOW };

/* Reads all voxels of a brick's window from the grid. */
void iso_brick_window_fill(const iso_grid *grid, const int brick[3], iso_brick_window *window);

/* Index in `values` of the voxel (x, y, z) relative to the brick's first one; each is -1 .. 17. */
static inline ptrdiff_t iso_window_index(int x, int y, int z) {
    return (x + ISO_WINDOW_LOW) + (ptrdiff_t)(y + ISO_WINDOW_LOW) * ISO_STEP_Y +
           (ptrdiff_t)(z + ISO_WINDOW_LOW) * ISO_STEP_Z;
}

static inline int iso_window_step(int axis) {
    return axis == 0 ? 1 : axis == 1 ? ISO_STEP_Y : ISO_STEP_Z;
}

/* Computes the gradient (stored values per voxel) at a voxel 0 .. 16 that is finite and in the grid, by
 * central differences. A neighbour that is outside the grid or not finite counts as missing: the
 * difference is one-sided then, or 0 if both neighbours are missing. The windows of different bricks give
 * the same bits. */
void iso_window_gradient(const iso_brick_window *window, const int voxel[3], float gradient[3]);

/* Sets normal to gradient * sign / |gradient|. Returns false, and leaves normal as it is, if this length is 0
 * or not finite. */
bool iso_unit_normal(const float gradient[3], float sign, float normal[3]);

#endif
