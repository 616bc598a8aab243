/* snapshot: a field and its mask as a file of packed cells, to the bit, so that replaying a long session need
 * not start at its beginning. Written beside its name and renamed. Internal to sculpt. */
#ifndef ISO_SCULPT_SESSION_CHECKPOINT_H
#define ISO_SCULPT_SESSION_CHECKPOINT_H

#include <stdio.h>

#include "sculpt/field/mask.h"
#include "sculpt/session/snapshot.h"

/* ISO_ERR_WRITE, ISO_ERR_NOMEM. */
iso_status iso_checkpoint_write(const char *path, const iso_hgrid *grid, const iso_mask *mask,
                                iso_error *error);

/* The same to and from memory; errors in writing are the stream's. */
void iso_checkpoint_put(FILE *stream, const iso_hgrid *grid, const iso_mask *mask);
iso_status iso_checkpoint_get(const char *name, const uint8_t *bytes, size_t size, iso_hgrid *grid,
                              iso_mask *mask, iso_error *error);

/* The same in a thread of its own, of a field that is held; path and mask are copied, the hold is borrowed
 * until iso_checkpoint_finish. ISO_ERR_NOMEM. */
typedef struct iso_checkpoint iso_checkpoint;
iso_status iso_checkpoint_start(const char *path, iso_snapshot *snapshot, const iso_mask *mask,
                                iso_checkpoint **checkpoint, iso_error *error);
bool iso_checkpoint_done(const iso_checkpoint *checkpoint);
/* Waits for it; whether it is written. */
bool iso_checkpoint_finish(iso_checkpoint *checkpoint);

/* Fills a grid of the same dims and band; all of it counts as changed. ISO_ERR_IO, ISO_ERR_FORMAT (damaged,
 * another grid's): grid and mask are as before; ISO_ERR_NOMEM. */
iso_status iso_checkpoint_read(const char *path, iso_hgrid *grid, iso_mask *mask, iso_error *error);

#endif
