/* closed: a solid that ends at the volume's border, so that its surface is closed.
 *
 * The grid is given one more layer of voxels on every side, so far outside the solid that the surface crosses
 * within 1e-3 voxel of the border's samples: the cap lies there, flat, and bounds stay. */
#ifndef ISO_GRIDS_PARTS_CLOSED_H
#define ISO_GRIDS_PARTS_CLOSED_H

#include "base/parallel.h"
#include "grids/grid.h"

#ifdef __cplusplus
extern "C" {
#endif

/* How far from the border's samples a cap may lie, in voxels. */
#define ISO_CLOSED_TOLERANCE 1e-3

/* A new grid that is `from` with a layer around for the isovalue (physical); its voxel i is voxel i - 1 of
 * `from`, and its origin is moved accordingly. A dense one holds floats, whatever `from` holds, and comes
 * with its index of bricks; voxels that are not finite are outside the solid there, so that the surface is
 * closed around them as well. A sparse one has bricks where the solid reaches the border, with distances
 * beyond the band in the outermost layer: it is for extraction of edge points, meshes and exact surfaces, not
 * for foot points or sculpting.
 *
 * ISO_ERR_LIMIT: an hgrid has no room for two more voxels. ISO_ERR_USAGE: isovalue not finite.
 * ISO_ERR_NOMEM. */
iso_status iso_grid_close(const iso_grid *from, double isovalue, iso_pool *pool, iso_grid *closed,
                          iso_error *error);

/* Bytes that iso_grid_close takes for a dense grid of these voxels, its index included. */
uint64_t iso_grid_close_estimate(const int dims[3]);

#ifdef __cplusplus
}
#endif
#endif
