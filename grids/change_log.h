/* Which cells of a grid changed, and when: a stamp per cell and a log of changes.
 *
 * Every edit takes a number. A consumer (points, GPU buffers, undo, journal) remembers the number up to which
 * it has read and asks only for what came later, with its own halo; it never sweeps the grid, and any number
 * of consumers can lag by any amount. A cell is a 16^3 block of voxels: a cell of the hgrid, a block of the
 * rgrid.
 *
 * The log is bounded: when it outgrows its budget, its older half is merged, one entry a cell (the union of
 * its boxes under its latest number). A consumer may then be told of a larger box than it asked for, never of
 * less. One writer at a time; readers may run together while nobody writes. */
#ifndef ISO_GRIDS_CHANGE_LOG_H
#define ISO_GRIDS_CHANGE_LOG_H

#include <stddef.h>
#include <stdint.h>

#include "base/status.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The voxels of one cell that one edit may have changed: lo..hi inclusive, 0..15 in the cell. */
typedef struct iso_change {
    uint64_t edit; /* the edit's number, 1 and up */
    uint32_t cell; /* (z * cells_y + y) * cells_x + x */
    uint8_t lo[3], hi[3];
} iso_change;

typedef struct iso_change_log iso_change_log;

/* A log over cells[0] x cells[1] x cells[2] cells (product below 2^32), no changes yet. */
iso_status iso_change_log_create(const int cells[3], iso_change_log **log, iso_error *error);
void iso_change_log_destroy(iso_change_log *log);

/* Starts an edit and returns its number: 1 + the number of the one before. */
uint64_t iso_change_log_begin(iso_change_log *log);

/* Records, under the current edit, that voxels lo..hi (inclusive, clipped to the grid) may have changed; one
 * entry for each cell they lie in. Before the first iso_change_log_begin it starts edit 1. ISO_ERR_NOMEM: the
 * log is as before. Touches that meet in one cell under one edit may share an entry. */
iso_status iso_change_log_add(iso_change_log *log, const int lo[3], const int hi[3], iso_error *error);

/* Number of the current edit, 0 before the first. */
uint64_t iso_change_log_now(const iso_change_log *log);

/* Number of the last edit that touched `cell`, 0 when none did. */
uint64_t iso_change_log_last_edit(const iso_change_log *log, uint32_t cell);

/* All entries with a stamp above `seen`, oldest first: *changes points into the log (borrowed until the next
 * touch) and the count is returned. A cell can appear more than once. */
size_t iso_change_log_since(const iso_change_log *log, uint64_t seen, const iso_change **changes);

/* Bytes that the log takes, address space of untouched stamps included. */
size_t iso_change_log_bytes(const iso_change_log *log);

#ifdef __cplusplus
}
#endif
#endif
