/* value_counts: how often each value occurs among the voxels of a dense grid of integers, and among those
 * on the faces of the volume. Histograms are made from these counts (extract/isovalue).
 *
 * Counting takes one increment a voxel, and is best done while the voxels are in the processor's cache for
 * another reason: the brick index counts them when it reads them (iso_brick_index_with_counts). */
#ifndef ISO_GRIDS_VALUE_COUNTS_H
#define ISO_GRIDS_VALUE_COUNTS_H

#include <stdint.h>

#include "base/parallel.h"
#include "grids/rgrid.h"

enum { ISO_COUNTED_VALUES = 1 << 16 };

/* The counts are indexed by value, of int16 by value + 32768. */
typedef struct iso_value_counts {
    uint64_t all[ISO_COUNTED_VALUES];
    uint64_t faces[ISO_COUNTED_VALUES]; /* of the voxels on the volume's six faces only */
} iso_value_counts;

/* Counts the voxels of the slices first .. end - 1 along z of a grid of integers. `pool` may be NULL.
 * *counts: iso_free when done. ISO_ERR_NOMEM. */
iso_status iso_value_counts_create(const iso_rgrid *grid, int first, int end, iso_pool *pool,
                                   iso_value_counts **counts, iso_error *error);

/* Counting box by box, with tables for each of several workers, which may count at the same time. The sum
 * does not depend on how the grid is divided into boxes. */
typedef struct iso_value_counter iso_value_counter;

/* Creates a counter for a grid of integers, which is borrowed. ISO_ERR_NOMEM. */
iso_status iso_value_counter_create(const iso_rgrid *grid, int workers, iso_value_counter **counter,
                                    iso_error *error);

/* Counts the voxels lo .. hi - 1 of the grid. Counting is bound by arithmetic, so memory is idle meanwhile:
 * while a row along x is counted, the row `ahead` rows further along y is fetched into the cache, unless
 * `ahead` is 0. */
void iso_value_counter_add(iso_value_counter *counter, int worker, const int lo[3], const int hi[3],
                           int ahead);

/* The same for voxels that all have the value of the voxel `lo`, which alone is read. */
void iso_value_counter_add_constant(iso_value_counter *counter, int worker, const int lo[3], const int hi[3]);

/* From now on the voxels are read from `window`, a grid of the same type whose voxel (0, 0, 0) is voxel
 * `origin` of the counter's grid, and which is borrowed. For grids that are not in memory as a whole. */
void iso_value_counter_set_window(iso_value_counter *counter, const iso_rgrid *window, const int origin[3]);

/* Returns the sums of all workers (iso_free when done) and destroys the counter. */
iso_value_counts *iso_value_counter_finish(iso_value_counter *counter);

/* Destroys a counter whose counts are not wanted. NULL is fine. */
void iso_value_counter_destroy(iso_value_counter *counter);

#endif
