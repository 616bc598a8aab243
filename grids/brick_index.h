/* brick_index: finds the bricks of an rgrid that an isovalue crosses, without looking at the others.
 *
 * The index stores the range of values of each brick (brick_range.h) and an interval tree over the bricks
 * that are not constant (Cignoni, Marino, Montani, Puppo and Scopigno 1997, "Speeding Up Isosurface
 * Extraction Using Interval Trees"). A query for k of n bricks takes O(log n + k), which is optimal, for
 * every type and distribution of values. An isovalue crosses a brick if lo < isovalue <= hi.
 *
 * The index follows the grid's change log. Edited bricks are moved from the tree to a short list that queries
 * scan; the tree is rebuilt when this list exceeds 1/32 of the bricks.
 *
 * Any number of threads may query while nobody updates the index or the grid. */
#ifndef ISO_GRIDS_BRICK_INDEX_H
#define ISO_GRIDS_BRICK_INDEX_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/memory.h"
#include "base/parallel.h"
#include "grids/brick_range.h"
#include "grids/rgrid.h"
#include "grids/value_counts.h"

typedef struct iso_brick_index iso_brick_index;

/* Creates an index by reading the whole grid, which is borrowed until the index is destroyed. `pool` may be
 * NULL. ISO_ERR_NOMEM. Most callers should use iso_brick_index_of instead. */
iso_status iso_brick_index_create(const iso_rgrid *grid, iso_pool *pool, iso_brick_index **index,
                                  iso_error *error);
void iso_brick_index_destroy(iso_brick_index *index);

/* Reads the bricks that have changed since the last update, according to the grid's log, and their lower
 * neighbours whose ranges include the changed voxels. ISO_ERR_NOMEM: the index is as before, and not current.
 */
iso_status iso_brick_index_update(iso_brick_index *index, iso_pool *pool, iso_error *error);

/* Whether no edit was recorded since the index was created or updated. */
bool iso_brick_index_current(const iso_brick_index *index);

/* Returns the index that the grid owns. The first call creates it, later ones update it if the grid was
 * edited. *index (may be NULL) is valid until the grid is destroyed or cropped. While the index is current,
 * other functions that ask which bricks an isovalue crosses use it, too. Must not be called while other
 * threads read the grid, except when the index is current and thus only read. `pool` may be NULL.
 * ISO_ERR_NOMEM. */
iso_status iso_brick_index_of(iso_rgrid *grid, iso_pool *pool, const iso_brick_index **index,
                              iso_error *error);

/* As iso_brick_index_of; but if this creates the index and the voxels are integers, it also counts how often
 * each value occurs, in the same pass over the voxels. For readers of volumes whose histogram will be asked
 * for: a second pass would take longer, because the voxels come from memory once more. */
iso_status iso_brick_index_with_counts(iso_rgrid *grid, iso_pool *pool, iso_error *error);

/* Returns the counts that were made with the grid's index, valid until the grid is edited, cropped or
 * destroyed. NULL: there are none, or the grid was edited since. */
const iso_value_counts *iso_brick_index_counts(const iso_rgrid *grid);

/* Returns the number of a brick: (z * bricks_y + y) * bricks_x + x. */
uint32_t iso_brick_index_number(const iso_brick_index *index, const int brick[3]);

/* Return the range of a brick, and whether a stored isovalue crosses it. */
iso_brick_range iso_brick_index_range(const iso_brick_index *index, uint32_t brick);
bool iso_brick_index_crosses(const iso_brick_index *index, uint32_t brick, float isovalue);

/* Returns the row groups (brick_range.h) of a crossed brick that the isovalue may cross, one bit each. In all
 * other groups no edge has one end below the isovalue and the other at or above it. Exact for integer types
 * if the brick's highest and lowest value differ by at most 254; otherwise groups that the isovalue misses by
 * up to 1/255 of the brick's range are included, too. */
uint32_t iso_brick_index_groups(const iso_brick_index *index, uint32_t brick, float isovalue);

/* Prefetches the data of a brick into the processor's cache. */
void iso_brick_index_fetch(const iso_brick_index *index, uint32_t brick);

/* Computes the smallest and the largest finite value of the grid; *lo > *hi if there is none. */
void iso_brick_index_extremes(const iso_brick_index *index, double *lo, double *hi);

/* Whether all voxels in the brick's range are finite. */
bool iso_brick_index_finite(const iso_brick_index *index, uint32_t brick);

/* The result of a query; its memory is reused by the next query. Zero-initialise; iso_brick_query_free when
 * done. */
typedef struct iso_brick_query {
    iso_buffer bricks; /* the numbers (uint32_t) of the `count` bricks found, ascending */
    size_t count;
    size_t visited; /* entries of the index that the query read, for tests and benchmarks */
    iso_buffer scratch;
} iso_brick_query;

/* Finds the bricks that a stored isovalue crosses; none for NaN. ISO_ERR_NOMEM: the result is empty. */
iso_status iso_brick_index_query(const iso_brick_index *index, float isovalue, iso_brick_query *query,
                                 iso_error *error);
void iso_brick_query_free(iso_brick_query *query);

size_t iso_brick_index_bricks(const iso_brick_index *index);  /* number of bricks of the grid */
size_t iso_brick_index_pending(const iso_brick_index *index); /* number of edited bricks outside the tree */
size_t iso_brick_index_bytes(const iso_brick_index *index);   /* size of the index in bytes */

/* Returns the largest memory, in bytes, that creating the index of a grid of this size (in voxels) takes,
 * including the index itself. */
uint64_t iso_brick_index_estimate(const int dims[3]);

#endif
