/* point_solid: the solid whose surface points with normals lie on, sampled as a volume, so that a scan can be
 * converted to a level set.
 *
 * Near the points a voxel's value is its distance to the planes of the points around it, averaged with
 * weights that fall to 0 within two spacings of the points (implicit moving least squares: Shen, O'Brien and
 * Shewchuk 2004, "Interpolating and approximating implicit surfaces from polygon soup"). Far from them the
 * sign is that of the winding number of the points minus 1/2, where each point stands for a part of the
 * surface as large as its distance to its sixth neighbour says (Barill et al. 2018, "Fast winding numbers for
 * soups and clouds"). So holes are closed by a smooth surface, however large they are, and points that face
 * the wrong way do little harm where most face the right way. */
#ifndef ISO_GRIDS_POINT_SOLID_H
#define ISO_GRIDS_POINT_SOLID_H

#include "base/primitives.h"
#include "grids/grid.h"
#include "grids/level_set.h"

/* Samples the solid as float voxels: mm, above 0 inside and below 0 outside, not distances. sampling->margin
 * voxels are added around the points on each side. `path` is used in messages. The caller owns *grid.
 *
 * Errors: ISO_ERR_EMPTY (no points, or they enclose nothing); ISO_ERR_USAGE (the voxel size is not above 0);
 * ISO_ERR_LIMIT (more than max_memory bytes; 0: no limit), ISO_ERR_NOMEM; ISO_ERR_IO: cancelled.
 * The same bytes for every number of threads and on every machine. */
iso_status iso_grid_from_points(const char *path, const iso_point_view *points, const iso_sampling *sampling,
                                uint64_t max_memory, iso_grid *grid, iso_error *error);

#endif
