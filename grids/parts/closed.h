/* closed: caps a solid where the volume's border cuts it, so that its surface is closed.
 *
 * The grid gets one more layer of voxels on each side, with values so far outside the solid that the surface
 * lies within 1e-3 voxel of the border's samples: the caps are flat, and the bounds of the surface stay. */
#ifndef ISO_GRIDS_PARTS_CLOSED_H
#define ISO_GRIDS_PARTS_CLOSED_H

#include "base/parallel.h"
#include "grids/grid.h"

/* The largest distance of a cap from the border's samples, in voxels. */
#define ISO_CLOSED_TOLERANCE 1e-3

/* Creates a copy of `from` with a layer around it for a physical isovalue; voxel i of the copy is voxel i - 1
 * of `from`, and the origin is moved accordingly. A dense copy always holds floats and has a brick
 * index; voxels that are not finite become outside, so the surface is closed around them too. A sparse copy
 * has bricks where the solid reaches the border, and the values of its outermost layer lie beyond the band:
 * edge points, meshes and exact surfaces may be made of a sparse copy, but not foot points or sculptures.
 *
 * ISO_ERR_LIMIT: the grid cannot have two more voxels along an axis; ISO_ERR_USAGE: the isovalue is not
 * finite; ISO_ERR_NOMEM. */
iso_status iso_grid_close(const iso_grid *from, double isovalue, iso_pool *pool, iso_grid *closed,
                          iso_error *error);

/* Returns the bytes that iso_grid_close allocates for a dense grid of this size in voxels, with its index. */
uint64_t iso_grid_close_estimate(const int dims[3]);

#endif
