/* field: a field to sculpt, made of any grid. */
#ifndef ISO_SCULPT_FIELD_H
#define ISO_SCULPT_FIELD_H

#include "grids/level_set.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Voxels of room around, for what will be added. */
enum { ISO_FIELD_MARGIN = 32 };

/* The solid of a grid as a distance field, with ISO_FIELD_MARGIN voxels of room around (how->margin is not
 * read). A level set of cubic voxels is taken bit by bit, when it is not to be moved (isovalue 0) or sampled
 * at another voxel size; anything else is sampled and made a distance field. `name` is for messages. As
 * iso_level_set_from_grid, and ISO_ERR_NOMEM. */
iso_status iso_field_from_grid(const char *name, const iso_grid *from, const iso_resampling *how,
                               iso_hgrid **grid, iso_error *error);

#ifdef __cplusplus
}
#endif
#endif
