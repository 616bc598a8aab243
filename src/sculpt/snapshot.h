/* snapshot: a field and its mask as a file of packed cells, to the bit, so that replaying a long session need
 * not start at its beginning. Written beside its name and renamed. Internal to sculpt. */
#ifndef ISO_SCULPT_SNAPSHOT_H
#define ISO_SCULPT_SNAPSHOT_H

#include "grids/hgrid.h"
#include "sculpt/mask.h"

/* ISO_ERR_WRITE, ISO_ERR_NOMEM. */
iso_status iso_snapshot_write(const char *path, const iso_hgrid *grid, const iso_mask *mask,
                              iso_error *error);

/* Fills a grid of the same dims and band; all of it counts as changed. ISO_ERR_IO, ISO_ERR_FORMAT (damaged,
 * another grid's): grid and mask are as before; ISO_ERR_NOMEM. */
iso_status iso_snapshot_read(const char *path, iso_hgrid *grid, iso_mask *mask, iso_error *error);

#endif
