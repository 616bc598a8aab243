/* sculpt_support: fields to sculpt, and measurements of them, for the sculpting tests. */
#ifndef ISO_TESTS_SCULPT_SUPPORT_H
#define ISO_TESTS_SCULPT_SUPPORT_H

#include "check_support.h"
#include "grids/grid.h"
#include "sculpt/edit/edit.h"

/* A ball in a grid of side^3 voxels of 1 mm, voxel (0, 0, 0) at the world's origin. */
iso_hgrid *sculpt_ball(int side, iso_vec3 centre, double radius);

/* An exact copy of a grid: cells, bricks, transform. */
iso_hgrid *sculpt_copy(const iso_hgrid *grid);
/* Whether two grids have the same bits at every voxel and the same empty cells. */
bool sculpt_same(const iso_hgrid *a, const iso_hgrid *b);

/* The quality of a field where foot points are extracted: at voxels with distances 0 .. sqrt 3, in cells that
 * an edit after number `seen` changed. */
typedef struct sculpt_quality {
    size_t voxels, clamped;             /* clamped: voxels with a clamped value in a central difference */
    double gradient_mean, gradient_p99; /* | |gradient| - 1 | */
    double foot_p99, foot_max;          /* |trilinear value| at foot points, voxels */
} sculpt_quality;
sculpt_quality sculpt_measure(const iso_hgrid *grid, uint64_t seen);

/* The point where the ray from `centre` in `direction` (unit) leaves the solid, searched from 80 mm away
 * inwards; the centre if there is none. */
iso_vec3 sculpt_pick(const iso_hgrid *grid, iso_vec3 centre, iso_vec3 direction);

/* Applies one touch, without an observer; fails the test on errors. */
iso_edit_stats sculpt_touch(iso_editor *editor, const iso_brush *brush, iso_vec3 at, iso_vec3 normal);

/* The volume inside the surface in voxels, by the trilinear field with 4^3 samples in each cell at the
 * surface. */
double sculpt_volume(const iso_hgrid *grid);

#endif
