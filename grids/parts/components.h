/* components: removes small connected parts of a solid before extraction.
 *
 * A part is a connected component of the voxels inside an isosurface: at or above the isovalue, or below it
 * in a level set; voxels that are not finite belong to no part. Voxels are connected along the edges of the
 * grid, in level sets also along the diagonals of faces, as Marching Cubes connects them
 * (extract/mesh/mesh.h). The volume of a part is its number of voxels times the volume of a voxel. Parts are
 * ordered by volume, the largest first; equal ones by their first voxel in x-fastest order. */
#ifndef ISO_GRIDS_PARTS_COMPONENTS_H
#define ISO_GRIDS_PARTS_COMPONENTS_H

#include "base/parallel.h"
#include "grids/grid.h"

/* The parts to keep: those that meet both conditions. */
typedef struct iso_components_opts {
    double isovalue;   /* physical */
    size_t largest;    /* keep only this many of the largest; 0: all */
    double min_volume; /* smallest volume, mm3; 0: any */
    iso_pool *pool;    /* borrowed for the call; NULL: the calling thread */
} iso_components_opts;

typedef struct iso_components_totals {
    size_t kept, dropped;                 /* parts */
    uint64_t kept_voxels, dropped_voxels; /* in them */
    double kept_volume, dropped_volume;   /* mm3 */
    double dropped_share; /* dropped volume as a fraction of the volume of all parts, 0 .. 1 */
} iso_components_totals;

/* Moves the voxels of dropped parts to the other side of the isovalue, in the grid itself (lent data is
 * written) and in its index; the changes are recorded in the change log.
 *
 * Dense grids: all voxels of dropped parts get the same value just beyond the isovalue: the next integer, or
 * for floats 1/256 of the range of all values away, at most half-way to the extreme value. No other voxel
 * changes, so the Marching Cubes vertices of the kept parts keep their positions to the bit, and their
 * normals too unless a dropped part lies within two voxels. Level sets in an hgrid: distances in and around a
 * dropped part become estimates of the distances to the kept parts (no smaller than before, at most the
 * band). Voxels beside a kept part, and with them its Marching Cubes vertices, do not change.
 *
 * A grid without a solid has no parts, which is no error. ISO_ERR_EMPTY: no part is as large as min_volume
 * (the grid is as before); ISO_ERR_USAGE: the isovalue is not finite; ISO_ERR_LIMIT; ISO_ERR_NOMEM: some
 * parts of an hgrid may have been removed. Must not be called while other threads read the grid. */
iso_status iso_components_filter(iso_grid *grid, const iso_components_opts *opts,
                                 iso_components_totals *totals, iso_error *error);

#endif
