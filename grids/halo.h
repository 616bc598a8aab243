/* halo: which bricks' results must be made again after changes to voxels. Internal to the library.
 *
 * How far what is made of a voxel reads is known to who makes it. A primitive belongs to the brick of its
 * voxel p (an edge: its lower voxel). When p reads voxels p - up .. p + down, an edit at v changes primitives
 * v - down .. v + up. */
#ifndef ISO_GRIDS_HALO_H
#define ISO_GRIDS_HALO_H

#include <stddef.h>
#include <stdint.h>

#include "base/memory.h"
#include "grids/change_log.h"

typedef struct iso_halo {
    int down, up; /* voxels */
} iso_halo;

/* Changes and the grid that they happened in. */
typedef struct iso_changes {
    const iso_change *changes;
    size_t count;
    const int *bricks; /* of the grid, 3 */
} iso_changes;

/* Fills `list` with the numbers (uint32_t, (z * bricks_y + y) * bricks_x + x) of the bricks whose primitives
 * may have changed, ascending, each once. Takes time in proportion to the changes. ISO_ERR_NOMEM. */
iso_status iso_halo_bricks(const iso_changes *changes, iso_halo halo, iso_buffer *list, size_t *count,
                           iso_error *error);

#endif
