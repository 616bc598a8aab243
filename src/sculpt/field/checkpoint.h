/* checkpoint: the field, mask and paint of a session in a file, to the bit, so that replaying a long journal
 * need not start at its beginning. The files end in .snapshot and journals call them snapshots. A file
 * appears whole or not at all. Internal to sculpt. */
#ifndef ISO_SCULPT_FIELD_CHECKPOINT_H
#define ISO_SCULPT_FIELD_CHECKPOINT_H

#include <stdio.h>

#include "sculpt/field/cell_items.h"
#include "sculpt/field/snapshot.h"

/* Writes a checkpoint file. ISO_ERR_WRITE, ISO_ERR_NOMEM. */
iso_status iso_checkpoint_write(const char *path, const iso_hgrid *grid, const iso_field_items *items,
                                iso_error *error);

/* Write a checkpoint to a stream, whose error flag the caller checks, and read one from memory; `name` is
 * used in messages. Errors: those of iso_checkpoint_read. */
void iso_checkpoint_put(FILE *stream, const iso_hgrid *grid, const iso_field_items *items);
iso_status iso_checkpoint_get(const char *name, const uint8_t *bytes, size_t size, iso_hgrid *grid,
                              iso_field_items *items, iso_error *error);

/* Writes a checkpoint file from a snapshot in a background thread. Path and items are copied; the snapshot is
 * borrowed until iso_checkpoint_finish. ISO_ERR_NOMEM. */
typedef struct iso_checkpoint iso_checkpoint;
iso_status iso_checkpoint_start(const char *path, iso_snapshot *snapshot, const iso_field_items *items,
                                iso_checkpoint **checkpoint, iso_error *error);
/* Whether the thread has ended; does not wait. */
bool iso_checkpoint_done(const iso_checkpoint *checkpoint);
/* Waits for the thread and frees the checkpoint. Returns whether the file was written. */
bool iso_checkpoint_finish(iso_checkpoint *checkpoint);

/* Reads a checkpoint into a grid of the same dims and band, and its items; the change log marks the whole
 * grid. ISO_ERR_IO, ISO_ERR_FORMAT (damaged, or of another grid): grid and items are as before.
 * ISO_ERR_NOMEM: they may be changed in part. */
iso_status iso_checkpoint_read(const char *path, iso_hgrid *grid, iso_field_items *items, iso_error *error);

#endif
