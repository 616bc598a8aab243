/* snapshot: a copy-on-write snapshot of a level set. A background thread (saving, meshing) reads the field as
 * it was while editing continues.
 *
 * Creating a snapshot copies no values. Before the writer changes a cell for the first time it calls
 * iso_snapshot_preserve, which copies the cell unless the reader has it already. Internal to sculpt, except
 * iso_snapshot_copy. */
#ifndef ISO_SCULPT_FIELD_SNAPSHOT_H
#define ISO_SCULPT_FIELD_SNAPSHOT_H

#include "base/progress.h"
#include "grids/hgrid.h"

typedef struct iso_snapshot iso_snapshot;

/* Creates a snapshot; called by the thread that writes the grid. The grid must outlive the snapshot.
 * ISO_ERR_NOMEM. */
iso_status iso_snapshot_create(const iso_hgrid *grid, iso_snapshot **snapshot, iso_error *error);
/* Must not be called during iso_snapshot_copy. NULL is allowed. */
void iso_snapshot_destroy(iso_snapshot *snapshot);

/* Called by the writer before it writes a cell or makes it empty. If there is no memory for a copy of the
 * cell, iso_snapshot_copy will fail; the writer goes on. */
void iso_snapshot_preserve(iso_snapshot *snapshot, uint32_t cell);

/* Copies the field as it was when the snapshot was made to a new grid, which the caller owns. Called once, by
 * any thread. ISO_ERR_IO: cancelled through `progress`; ISO_ERR_NOMEM. */
iso_status iso_snapshot_copy(iso_snapshot *snapshot, const iso_progress *progress, iso_hgrid **grid,
                             iso_error *error);

#endif
