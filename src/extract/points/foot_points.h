/* foot_points: foot points, the nearest points of the surface to the voxels near it. Internal to extract. */
#ifndef ISO_EXTRACT_POINTS_FOOT_POINTS_H
#define ISO_EXTRACT_POINTS_FOOT_POINTS_H

#include "extract/brick.h"

/* The surface of a distance field, and which voxels have foot points. */
typedef struct iso_foot_surface {
    float isovalue_ceil, residual, normal_sign; /* as in iso_threshold */
    float top;  /* a value v is at a distance in [0, sqrt 3) voxels exactly if isovalue_ceil <= v < top */
    float band; /* the magnitude from which on stored distances are clamped; INFINITY: none are */
} iso_foot_surface;

iso_foot_surface iso_foot_surface_of(const iso_threshold *surface, float band);

/* The values of a voxel and of its neighbours on the three axes; NaN: there is no neighbour. */
typedef struct iso_foot_stencil {
    int voxel[3];
    float centre, low[3], high[3];
} iso_foot_stencil;

/* Whether a value of the stencil is clamped; such voxels have no foot point. */
static inline bool iso_foot_is_clamped(float band, const iso_foot_stencil *s) {
    bool clamped = fabsf(s->centre) >= band;
    for (int axis = 0; axis < 3; axis++)
        clamped |= (fabsf(s->low[axis]) >= band) | (fabsf(s->high[axis]) >= band);
    return clamped;
}

/* Whether a voxel can be computed without special cases, given the squared length of its gradient by central
 * differences: the length is that of a distance field, and no neighbour is missing (the square would be NaN).
 */
static inline bool iso_foot_is_regular(float squared) {
    return squared >= 0.25f && squared < 1e30f;
}

/* Computes the foot point of a voxel in the band of distances; returns false if it is rejected (points.h). */
bool iso_foot_point(const iso_foot_surface *surface, const iso_foot_stencil *stencil, iso_surfel *point);

/* The caller's arrays, with room for ISO_BRICK_VOXELS points. */
typedef struct iso_foot_points {
    iso_surfel *points;
    int32_t *voxels; /* the voxel of each point, z << 8 | y << 4 | x; NULL: not wanted */
    uint32_t count, rejected;
} iso_foot_points;

/* Foot points of a distance field by eq. 1, in z, y, x order of the brick's voxels. For the bricks of an
 * hgrid, foot_kernel.h gives the same bytes faster. */
void iso_foot_points_direct(const iso_brick_window *window, const iso_foot_surface *surface,
                            iso_foot_points *out);

/* Whether the brick may have foot points by eq. 1: a quick test of its range of values. */
bool iso_foot_points_may_exist(const iso_grid *grid, const iso_threshold *surface, const int brick[3]);

/* The voxels that iteration may read: those of a brick, and 3 beyond its faces, which is 2 for the way from a
 * voxel to its foot point and 1 for the gradients there. */
enum { ISO_FOOT_REACH = 2, ISO_FOOT_LOW = ISO_FOOT_REACH + 1, ISO_FOOT_SIDE = ISO_BRICK + 2 * ISO_FOOT_LOW };

/* Working memory of iso_foot_points_iterated. */
typedef struct iso_foot_block {
    float values[ISO_FOOT_SIDE * ISO_FOOT_SIDE * ISO_FOOT_SIDE]; /* x fastest; NaN outside the grid */
} iso_foot_block;

/* Foot points of any scalar field by iterating eq. 2, in z, y, x order of the voxels that iteration begins
 * at. The window must be of `grid`. */
void iso_foot_points_iterated(const iso_grid *grid, const iso_brick_window *window,
                              const iso_threshold *surface, iso_foot_block *block, iso_foot_points *out);

/* Whether the brick can have a seed, a voxel from which eq. 2 is iterated: a quick test of the ranges of
 * values of the brick and of its lower neighbours. */
bool iso_foot_seeds_may_exist(const iso_grid *grid, const iso_threshold *surface, const int brick[3]);

#endif
