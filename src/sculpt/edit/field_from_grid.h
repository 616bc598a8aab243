/* field_from_grid: converts any grid to a level set that can be sculpted. */
#ifndef ISO_SCULPT_EDIT_FIELD_FROM_GRID_H
#define ISO_SCULPT_EDIT_FIELD_FROM_GRID_H

#include <stdbool.h>

#include "grids/level_set.h"

/* Voxels added on each side of the source grid, as room for what will be sculpted onto its surface. */
enum { ISO_FIELD_MARGIN = 32 };

typedef struct iso_field_opts {
    iso_resampling resampling; /* `margin` is ignored: it is ISO_FIELD_MARGIN */
    bool damaged; /* the grid is a level set whose voxels were overwritten, so that its values may not be
                     distances */
} iso_field_opts;

/* Converts the solid of a grid to a signed distance field with ISO_FIELD_MARGIN voxels of room on each side.
 * A level set with cubic voxels is copied bit by bit when neither its isovalue (0) nor its voxel size
 * changes, and redistanced only if it is `damaged`; any other grid is resampled and redistanced. `name` is
 * used in messages. The caller owns *grid. Errors: those of iso_level_set_from_grid, and ISO_ERR_NOMEM. */
iso_status iso_field_from_grid(const char *name, const iso_grid *from, const iso_field_opts *opts,
                               iso_hgrid **grid, iso_error *error);

/* Recomputes the distances of the whole narrow band. `pool` may be NULL. ISO_ERR_NOMEM; ISO_ERR_IO: cancelled
 * through `progress`; the caller's grid is of no use then, and still the caller's. */
iso_status iso_field_redistance(iso_hgrid *grid, iso_pool *pool, const iso_progress *progress,
                                iso_error *error);

#endif
