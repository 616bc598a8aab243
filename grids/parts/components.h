/* components: the connected parts of a solid, and the removal of small ones before extraction.
 *
 * A part is a connected component of the voxels inside an isosurface: at or above the isovalue, below it for
 * level sets; voxels that are not finite belong to none. Voxels of a dense grid that is no level set are
 * joined by the grid's edges, those of a level set by the diagonals of faces as well: this is how Marching
 * Cubes joins them (extract/mesh/mesh.h). The volume of a part is its number of voxels times a voxel's
 * volume; parts are ordered by volume, the largest first, and equal ones by their first voxel in x-fastest
 * order. */
#ifndef ISO_GRIDS_PARTS_COMPONENTS_H
#define ISO_GRIDS_PARTS_COMPONENTS_H

#include "base/parallel.h"
#include "grids/grid.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Which parts are kept: those that meet both conditions. */
typedef struct iso_components_opts {
    double isovalue;   /* physical */
    size_t largest;    /* this many of the largest; 0: all */
    double min_volume; /* mm3; a part must have at least this; 0: any */
    iso_pool *pool;    /* borrowed for the call; NULL: the calling thread */
} iso_components_opts;

typedef struct iso_components_totals {
    size_t kept, dropped;                 /* parts */
    uint64_t kept_voxels, dropped_voxels; /* in them */
    double kept_volume, dropped_volume;   /* mm3 */
    double dropped_share;                 /* of the volume of all parts, 0 .. 1 */
} iso_components_totals;

/* Moves the dropped parts of the solid to the other side of the isovalue, in the grid itself (lent data is
 * written to) and its index of bricks; the change log records where.
 *
 * Dense grids: each voxel of a dropped part takes one value just beyond the isovalue: the next integer, or
 * for floats 1/256 of the range of all values, at most half-way to the extreme value there. No other voxel
 * changes: the Marching Cubes vertices of the kept parts keep their positions to the bit, and their normals
 * unless a dropped part lies within two voxels.
 * Level sets in an hgrid: distances in and around a dropped part become those to the kept parts (estimated,
 * no smaller than before and at most the band); voxels beside a kept part keep theirs, and with them its
 * Marching Cubes vertices.
 *
 * A grid without a solid has no parts; that is no error. ISO_ERR_EMPTY: no part is as large as min_volume
 * (the grid is as before). ISO_ERR_USAGE: isovalue not finite. ISO_ERR_LIMIT, ISO_ERR_NOMEM: of an hgrid,
 * parts may have been removed in part. Not while others read the grid. */
iso_status iso_components_filter(iso_grid *grid, const iso_components_opts *opts,
                                 iso_components_totals *totals, iso_error *error);

#ifdef __cplusplus
}
#endif
#endif
