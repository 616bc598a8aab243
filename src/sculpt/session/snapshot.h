/* snapshot: a field and its mask as a file of packed cells, to the bit, so that replaying a long session need
 * not start at its beginning. Written beside its name and renamed. Internal to sculpt. */
#ifndef ISO_SCULPT_SNAPSHOT_H
#define ISO_SCULPT_SNAPSHOT_H

#include <stdio.h>

#include "sculpt/field/mask.h"
#include "sculpt/session/hold.h"

/* ISO_ERR_WRITE, ISO_ERR_NOMEM. */
iso_status iso_snapshot_write(const char *path, const iso_hgrid *grid, const iso_mask *mask,
                              iso_error *error);

/* The same to and from memory; errors in writing are the stream's. */
void iso_snapshot_put(FILE *stream, const iso_hgrid *grid, const iso_mask *mask);
iso_status iso_snapshot_get(const char *name, const uint8_t *bytes, size_t size, iso_hgrid *grid,
                            iso_mask *mask, iso_error *error);

/* The same in a thread of its own, of a field that is held; path and mask are copied, the hold is borrowed
 * until iso_snapshot_finish. ISO_ERR_NOMEM. */
typedef struct iso_snapshot iso_snapshot;
iso_status iso_snapshot_start(const char *path, iso_hold *hold, const iso_mask *mask, iso_snapshot **snapshot,
                              iso_error *error);
bool iso_snapshot_done(const iso_snapshot *snapshot);
/* Waits for it; whether it is written. */
bool iso_snapshot_finish(iso_snapshot *snapshot);

/* Fills a grid of the same dims and band; all of it counts as changed. ISO_ERR_IO, ISO_ERR_FORMAT (damaged,
 * another grid's): grid and mask are as before; ISO_ERR_NOMEM. */
iso_status iso_snapshot_read(const char *path, iso_hgrid *grid, iso_mask *mask, iso_error *error);

#endif
