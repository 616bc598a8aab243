/* foot_points: for voxels near the surface, the nearest points of it. Internal to extract. */
#ifndef ISO_EXTRACT_FOOT_POINTS_H
#define ISO_EXTRACT_FOOT_POINTS_H

#include "extract/brick.h"

/* Room for ISO_BRICK_VOXELS points is needed. */
typedef struct iso_foot_points {
    iso_surfel *points;
    uint32_t count, rejected;
} iso_foot_points;

/* Foot points of a distance field by eq. 1, of the brick's voxels in z, y, x order. `band`: magnitude at and
 * above which stored distances are clamped; INFINITY when they are not. */
void iso_foot_points_direct(const iso_brick_window *window, const iso_surface *surface, float band,
                            iso_foot_points *out);

/* Whether the brick may have any: much faster than trying. */
bool iso_foot_points_may_exist(const iso_grid *grid, const iso_surface *surface, const int brick[3]);

/* Foot points of any scalar field by iterating eq. 2 on `grid`, which the window is from. */
void iso_foot_points_iterated(const iso_grid *grid, const iso_brick_window *window,
                              const iso_surface *surface, iso_foot_points *out);

/* Whether the brick has a voxel that is a corner of a cell which the surface may cross. */
bool iso_foot_seeds_may_exist(const iso_grid *grid, const iso_surface *surface, const int brick[3]);

#endif
