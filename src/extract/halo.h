/* halo: which bricks must be extracted again after changes to voxels. Internal to extract.
 *
 * The halos live here and nowhere else. A primitive belongs to the brick of its voxel p (an edge: its lower
 * voxel). When p reads voxels p - up .. p + down, an edit at v changes primitives v - down .. v + up. */
#ifndef ISO_EXTRACT_HALO_H
#define ISO_EXTRACT_HALO_H

#include <stddef.h>
#include <stdint.h>

#include "base/memory.h"
#include "grids/change_log.h"

typedef struct iso_halo {
    int down, up; /* voxels */
} iso_halo;

/* An edge p, p + 1 reads both ends' central differences: p - 1 .. p + 2 along its axis and p - 1 .. p + 1
 * along the others. */
#define ISO_HALO_EDGE ((iso_halo){.down = 2, .up = 1})
/* A mesh span also holds copies of the vertices on its far faces: edges of lower voxels up to 16 in the
 * brick, but none that runs along the axis on which it is 16. On that axis such an edge reads 15 .. 17, no
 * further than the brick's own edges, so the bricks are those of edge points. */
#define ISO_HALO_MESH ISO_HALO_EDGE
/* A foot point of voxel p reads p - 1 .. p + 1. */
#define ISO_HALO_FOOT ((iso_halo){.down = 1, .up = 1})
/* An iterated foot point is sampled less than 2 voxels from its voxel, so in cells whose corners are p - 2 ..
 * p + 2, and a corner's gradient reads one further; choosing the seed reads p - 1 .. p + 1. */
#define ISO_HALO_ITERATED ((iso_halo){.down = 3, .up = 3})

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
