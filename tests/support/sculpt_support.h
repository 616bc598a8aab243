/* Fields to sculpt and what is asked of them, for the sculpting tests. */
#ifndef ISO_TESTS_SCULPT_SUPPORT_H
#define ISO_TESTS_SCULPT_SUPPORT_H

#include "check_support.h"
#include "grids/grid.h"
#include "sculpt/field/edit.h"

/* A ball in a grid of side^3 voxels of 1 mm, voxel (0, 0, 0) at the world's origin. */
iso_hgrid *sculpt_ball(int side, iso_vec3 centre, double radius);

/* An exact copy: cells, bricks, transform. */
iso_hgrid *sculpt_copy(const iso_hgrid *grid);
/* Whether two grids read the same, to the bit, at every voxel; and whether empty cells are the same. */
bool sculpt_same(const iso_hgrid *a, const iso_hgrid *b);

/* The field where foot points are made: voxels at 0 .. sqrt 3 in cells that an edit after `seen` touched. */
typedef struct sculpt_quality {
    size_t voxels, clamped;             /* clamped: a central difference sees a clamped value */
    double gradient_mean, gradient_p99; /* | |gradient| - 1 | */
    double foot_p99, foot_max;          /* |trilinear value| at foot points, voxels */
} sculpt_quality;
sculpt_quality sculpt_measure(const iso_hgrid *grid, uint64_t seen);

/* Where the ray from `centre` in `direction` (unit) leaves the solid, from 80 mm inwards; the centre if
 * nowhere. */
iso_vec3 sculpt_pick(const iso_hgrid *grid, iso_vec3 centre, iso_vec3 direction);

/* One touch with nothing kept; the calling test fails when it fails. */
iso_edit_stats sculpt_touch(iso_editor *editor, const iso_brush *brush, iso_vec3 at, iso_vec3 normal);

/* Volume inside the surface in voxels: trilinear field, 4^3 samples a cell at the surface. */
double sculpt_volume(const iso_hgrid *grid);

#endif
