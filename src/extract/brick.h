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

/* A surface in stored values. `at` is the smallest float at or above the isovalue, so that v >= at holds for
 * exactly the floats v at or above it; the isovalue itself is at + rest. */
typedef struct iso_surface {
    float at, rest;
    float outward; /* -1: the outside is lower; +1: higher (level sets) */
} iso_surface;

iso_surface iso_surface_of(const iso_grid *grid, double physical_isovalue);

static inline bool iso_surface_inside(const iso_surface *surface, float value) {
    return value >= surface->at;
}

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
