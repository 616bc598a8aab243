/* hold: a field as it is now, for another thread, while the field goes on changing.
 *
 * Holding copies no values: the writer tells the hold of a cell before it first writes it, and only such
 * cells are copied, until the other thread has taken all. Internal to sculpt but for iso_snapshot_copy. */
#ifndef ISO_SCULPT_SESSION_SNAPSHOT_H
#define ISO_SCULPT_SESSION_SNAPSHOT_H

#include "base/progress.h"
#include "grids/hgrid.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct iso_snapshot iso_snapshot;

/* By the grid's writer; the grid must outlive the hold. ISO_ERR_NOMEM. */
iso_status iso_snapshot_create(const iso_hgrid *grid, iso_snapshot **snapshot, iso_error *error);
/* When nobody takes from it any more. */
void iso_snapshot_destroy(iso_snapshot *snapshot);

/* By the writer, before it writes a cell or makes it empty. Without memory for it the hold fails, not the
 * writer. */
void iso_snapshot_preserve(iso_snapshot *snapshot, uint32_t cell);

/* By any one thread, once: a grid of its own with the cells as they were. Cancelled: ISO_ERR_IO. Else
 * ISO_ERR_NOMEM. */
iso_status iso_snapshot_copy(iso_snapshot *snapshot, const iso_progress *progress, iso_hgrid **grid,
                             iso_error *error);

#ifdef __cplusplus
}
#endif
#endif
