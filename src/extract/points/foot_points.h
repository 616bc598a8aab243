/* foot_points: for voxels near the surface, the nearest points of it. Internal to extract. */
#ifndef ISO_EXTRACT_POINTS_FOOT_POINTS_H
#define ISO_EXTRACT_POINTS_FOOT_POINTS_H

#include "extract/brick.h"

/* The surface of a distance field, and which voxels have foot points. `band`: magnitude at and above which
 * stored distances are clamped; INFINITY when they are not. */
typedef struct iso_foot_surface {
    float isovalue_ceil, residual, normal_sign; /* as in iso_threshold */
    float top; /* v is in the band [0, sqrt 3) of distances exactly when at <= v < top */
    float band;
} iso_foot_surface;

iso_foot_surface iso_foot_surface_of(const iso_threshold *surface, float band);

/* A voxel with its neighbours on the three axes, NaN where there is none. */
typedef struct iso_foot_stencil {
    int voxel[3];
    float centre, low[3], high[3];
} iso_foot_stencil;

static inline bool iso_foot_is_clamped(float band, const iso_foot_stencil *s) {
    bool clamped = fabsf(s->centre) >= band;
    for (int axis = 0; axis < 3; axis++)
        clamped |= (fabsf(s->low[axis]) >= band) | (fabsf(s->high[axis]) >= band);
    return clamped;
}

/* Whether a gradient of this squared length, made of central differences only (else it is NaN), is that of a
 * distance field, and the plain arithmetic of iso_foot_point holds. */
static inline bool iso_foot_is_regular(float squared) {
    return squared >= 0.25f && squared < 1e30f;
}

/* The foot point of a voxel in the band; false when it is rejected. */
bool iso_foot_point(const iso_foot_surface *surface, const iso_foot_stencil *stencil, iso_surfel *point);

/* Room for ISO_BRICK_VOXELS points is needed. */
typedef struct iso_foot_points {
    iso_surfel *points;
    int32_t *voxels; /* whose each is, z << 8 | y << 4 | x; NULL: not wanted */
    uint32_t count, rejected;
} iso_foot_points;

/* Foot points of a distance field by eq. 1, of the brick's voxels in z, y, x order. The plain way: what
 * extract/points/foot_kernel.h does faster for an hgrid, with the same bytes. */
void iso_foot_points_direct(const iso_brick_window *window, const iso_foot_surface *surface,
                            iso_foot_points *out);

/* Whether the brick may have any: much faster than trying. */
bool iso_foot_points_may_exist(const iso_grid *grid, const iso_threshold *surface, const int brick[3]);

/* Foot points of any scalar field by iterating eq. 2 on `grid`, which the window is from. */
void iso_foot_points_iterated(const iso_grid *grid, const iso_brick_window *window,
                              const iso_threshold *surface, iso_foot_points *out);

/* Whether the brick has a voxel that is a corner of a cell which the surface may cross. */
bool iso_foot_seeds_may_exist(const iso_grid *grid, const iso_threshold *surface, const int brick[3]);

#endif
