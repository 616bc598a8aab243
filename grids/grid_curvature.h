/* grid_curvature: the mean curvature of a grid's level surfaces. */
#ifndef ISO_GRIDS_GRID_CURVATURE_H
#define ISO_GRIDS_GRID_CURVATURE_H

#include "grids/grid.h"

/* Returns the mean curvature, 1/mm, of the level surface through a position in index coordinates: (k1 +
 * k2) / 2, positive where the solid is convex, 1 / r on a ball. The values are convolved with a cubic
 * B-spline, whose second derivatives are continuous, as those of the trilinear field are not (Kindlmann et
 * al. 2003, "Curvature-based transfer functions for direct volume rendering"). affine: of the grid's
 * transform. NaN: a voxel within two voxels is not finite, or the gradient is 0. Thread-safe. */
double iso_grid_mean_curvature(const iso_grid *grid, const iso_affine *affine, iso_vec3 index);

#endif
