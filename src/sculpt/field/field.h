/* field: a field to sculpt, made of any grid. */
#ifndef ISO_SCULPT_FIELD_FIELD_H
#define ISO_SCULPT_FIELD_FIELD_H

#include <stdbool.h>

#include "grids/level_set.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Voxels of room around, for what will be added. */
enum { ISO_FIELD_MARGIN = 32 };

typedef struct iso_field_opts {
    iso_resampling resampling; /* its margin is not read */
    bool damaged;              /* voxels of a level set were written: they are no distances any more */
} iso_field_opts;

/* The solid of a grid as a distance field, with ISO_FIELD_MARGIN voxels of room around. A level set of cubic
 * voxels is taken bit by bit, when it is not to be moved (isovalue 0) or sampled at another voxel size, and
 * made a distance field only when it is damaged; anything else is sampled and made one. `name` is for
 * messages. As iso_level_set_from_grid, and ISO_ERR_NOMEM. */
iso_status iso_field_from_grid(const char *name, const iso_grid *from, const iso_field_opts *opts,
                               iso_hgrid **grid, iso_error *error);

/* Makes all of a field's narrow band distances again. The grid is destroyed by a failure. `pool` may be NULL.
 * Cancelled: ISO_ERR_IO. */
iso_status iso_field_redistance(iso_hgrid *grid, iso_pool *pool, const iso_progress *progress,
                                iso_error *error);

#ifdef __cplusplus
}
#endif
#endif
