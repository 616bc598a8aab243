/* change_log: records which cells of a grid were changed by which edit.
 *
 * Edits are numbered. A consumer (points, mesh, GPU buffers) remembers the number of the last edit that it
 * has processed, asks for the changes since then and adds its own halo; it never scans the grid. Any number
 * of consumers may lag by any number of edits. A cell is a cube of 16^3 voxels: a cell of an hgrid, a brick
 * of an rgrid.
 *
 * The size of the log is bounded. When it exceeds its budget, the entries of its older half are merged to one
 * for each cell, with the union of their boxes and their latest edit number. A consumer may then be given a
 * larger box than changed since its last edit, never a smaller one. One writer at a time; any number of
 * threads may read while nobody writes. */
#ifndef ISO_GRIDS_CHANGE_LOG_H
#define ISO_GRIDS_CHANGE_LOG_H

#include <stddef.h>
#include <stdint.h>

#include "base/status.h"

/* A change: the box of voxels lo..hi of a cell (inclusive, 0..15) that an edit may have changed. */
typedef struct iso_change {
    uint64_t edit; /* the edit's number, 1 and up */
    uint32_t cell; /* (z * cells_y + y) * cells_x + x */
    uint8_t lo[3], hi[3];
} iso_change;

typedef struct iso_change_log iso_change_log;

/* Creates an empty log for a grid of cells[0] x cells[1] x cells[2] cells. ISO_ERR_LIMIT: 2^32 cells or more;
 * ISO_ERR_NOMEM. */
iso_status iso_change_log_create(const int cells[3], iso_change_log **log, iso_error *error);
void iso_change_log_destroy(iso_change_log *log);

/* Starts an edit and returns its number: 1 for the first edit, one more for each later one. */
uint64_t iso_change_log_begin(iso_change_log *log);

/* Records that the current edit may have changed voxels lo..hi (inclusive, clipped to the grid), with one
 * entry for each of their cells. Entries of one edit that meet in a cell may be joined. Starts edit 1 if no
 * edit has begun yet. ISO_ERR_NOMEM: the log is as before. */
iso_status iso_change_log_add(iso_change_log *log, const int lo[3], const int hi[3], iso_error *error);

/* Returns the number of the current edit, 0 before the first. */
uint64_t iso_change_log_now(const iso_change_log *log);

/* Returns the number of the last edit that changed `cell`, 0: none. */
uint64_t iso_change_log_last_edit(const iso_change_log *log, uint32_t cell);

/* Finds the entries of edits after `seen`, oldest first; a cell may have several. Returns their number;
 * *changes points into the log and is valid until the next iso_change_log_add. */
size_t iso_change_log_since(const iso_change_log *log, uint64_t seen, const iso_change **changes);

/* Returns the size of the log in bytes, including address space for cells that never changed. */
size_t iso_change_log_bytes(const iso_change_log *log);

#endif
