/* halo: finds the bricks that must be extracted again after changes to voxels. Internal to the library.
 *
 * A primitive (a point, a cell) belongs to the brick of its voxel p; an edge belongs to its lower voxel. If
 * the primitive of voxel p is computed from voxels p - up .. p + down, a change of voxel v affects the
 * primitives of voxels v - down .. v + up. */
#ifndef ISO_GRIDS_HALO_H
#define ISO_GRIDS_HALO_H

#include <stddef.h>
#include <stdint.h>

#include "base/memory.h"
#include "grids/change_log.h"

typedef struct iso_halo {
    int down, up; /* voxels */
} iso_halo;

/* A list of changes, and the size of the grid that they are of. */
typedef struct iso_changes {
    const iso_change *changes;
    size_t count;
    const int *bricks; /* bricks of the grid along x, y, z */
} iso_changes;

/* Fills `list` with the numbers (uint32_t, (z * bricks_y + y) * bricks_x + x) of the bricks whose primitives
 * may have changed, ascending and without duplicates. Takes O(n log n) for n changes. ISO_ERR_NOMEM. */
iso_status iso_halo_bricks(const iso_changes *changes, iso_halo halo, iso_buffer *list, size_t *count,
                           iso_error *error);

#endif
