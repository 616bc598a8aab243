/* brick_index: which bricks of an rgrid an isovalue crosses, without looking at the others.
 *
 * The index has the range of values of every 16^3 brick (brick_range.h) and over those that are not constant
 * an interval tree (Cignoni, Marino, Montani, Puppo and Scopigno 1997, "Speeding Up Isosurface Extraction
 * Using Interval Trees"): a query costs O(log n + answer), which is optimal, whatever the type and the
 * distribution of values. A brick is crossed when lo < isovalue <= hi, "at or above" being inside.
 *
 * It follows the grid's change log. Edited bricks leave the tree for a short list that queries look through;
 * the tree is made again when that list outgrows 1/32 of the bricks.
 *
 * Queries and look-ups may run in any number of threads while nobody updates the index or the grid. */
#ifndef ISO_GRIDS_BRICK_INDEX_H
#define ISO_GRIDS_BRICK_INDEX_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/memory.h"
#include "base/parallel.h"
#include "grids/brick_range.h"
#include "grids/rgrid.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct iso_brick_index iso_brick_index;

/* Reads all of `grid`, which is borrowed until the index is destroyed. `pool` may be NULL. ISO_ERR_NOMEM. */
iso_status iso_brick_index_create(const iso_rgrid *grid, iso_pool *pool, iso_brick_index **index,
                                  iso_error *error);
void iso_brick_index_destroy(iso_brick_index *index);

/* Reads again what the grid's log says has changed: the changed cells and those lower neighbours whose range
 * sees the changed voxels. ISO_ERR_NOMEM: the index is as before, and not current. */
iso_status iso_brick_index_update(iso_brick_index *index, iso_pool *pool, iso_error *error);

/* Whether no edit was recorded since the index was created or updated. */
bool iso_brick_index_current(const iso_brick_index *index);

/* The index that a grid owns: created by the first call, updated by later ones if the grid was edited.
 * *index (may be NULL) is valid until the grid is destroyed or cropped. Until the next edit, everything that
 * asks which bricks an isovalue crosses uses it. Must not be called while other threads read the grid, except
 * when the index is current: then it is only read. `pool` may be NULL. ISO_ERR_NOMEM. */
iso_status iso_brick_index_of(iso_rgrid *grid, iso_pool *pool, const iso_brick_index **index,
                              iso_error *error);

/* A brick's number: (z * bricks_y + y) * bricks_x + x. */
uint32_t iso_brick_index_number(const iso_brick_index *index, const int brick[3]);

iso_brick_range iso_brick_index_range(const iso_brick_index *index, uint32_t brick);
bool iso_brick_index_crosses(const iso_brick_index *index, uint32_t brick, float isovalue);

/* Which row groups (brick_range.h) of a crossed brick the isovalue may cross, a bit each: the others provably
 * have no edge with one end below it and the other not. For integers in a range of at most 255 values exactly
 * the crossed ones, else up to 1/255 of the brick's range beyond. */
uint32_t iso_brick_index_groups(const iso_brick_index *index, uint32_t brick, float isovalue);

/* Fetches into the cache what is known of a brick. */
void iso_brick_index_fetch(const iso_brick_index *index, uint32_t brick);

/* Least and largest finite value of the grid; *lo > *hi when there is none. */
void iso_brick_index_extremes(const iso_brick_index *index, double *lo, double *hi);

bool iso_brick_index_finite(const iso_brick_index *index, uint32_t brick);

/* An answer, and room for the next one. Zero-initialise; iso_brick_query_free when done. */
typedef struct iso_brick_query {
    iso_buffer bricks; /* `count` numbers (uint32_t), ascending */
    size_t count;
    size_t visited; /* entries of the index that were looked at, for tests and benches */
    iso_buffer scratch;
} iso_brick_query;

/* The bricks that a stored isovalue crosses; none for NaN. On ISO_ERR_NOMEM the answer is empty. */
iso_status iso_brick_index_query(const iso_brick_index *index, float isovalue, iso_brick_query *query,
                                 iso_error *error);
void iso_brick_query_free(iso_brick_query *query);

size_t iso_brick_index_bricks(const iso_brick_index *index);  /* all bricks of the grid */
size_t iso_brick_index_pending(const iso_brick_index *index); /* bricks in the list beside the tree */
size_t iso_brick_index_bytes(const iso_brick_index *index);

/* The most that creating an index takes at one time, itself included, for a grid of these voxels. */
uint64_t iso_brick_index_estimate(const int dims[3]);

#ifdef __cplusplus
}
#endif
#endif
