/* kept: the voxels that pictures of a range of isovalues read. All others can be replaced, so that what is
 * left of a volume compresses well, and every picture of the range keeps its bytes. */
#ifndef ISO_GRIDS_KEPT_H
#define ISO_GRIDS_KEPT_H

#include "grids/rgrid.h"

/* Copies the voxels of a grid to `out`, contiguous and of the grid's type. Kept are the corners of cells that
 * a surface of some isovalue low .. high (physical) crosses, and the six neighbours of these, from which
 * normals come; voxels that are no finite numbers, because cells with one are empty. Each other voxel becomes
 * the greatest value below `low` or the least one at or above `high`, whichever side it is on; one between
 * them, which no cell uses, stays. *kept (may be NULL): how many voxels are kept because of their place.
 * `pool` may be NULL. ISO_ERR_NOMEM. */
iso_status iso_kept_copy(const iso_rgrid *grid, double low, double high, void *out, size_t *kept,
                         iso_pool *pool, iso_error *error);

#endif
