/* transaction: the cells that one touch edits, with their new values kept beside the grid until it succeeds.
 *
 * Each listed cell is an iso_edit_cell whose values lie in scratch bricks. Kernels read a cell's neighbours
 * from other edit cells, from the grid's bricks, or from two constant bricks that stand for empty cells.
 * Nothing is written to the grid before iso_transaction_commit, so a touch that fails leaves no trace. The
 * order of calls is: add, reserve, (in parallel) scratch_brick and accept_scratch, end_brush, redistance,
 * compare, commit, clear. Internal to sculpt. */
#ifndef ISO_SCULPT_EDIT_TRANSACTION_H
#define ISO_SCULPT_EDIT_TRANSACTION_H

#include "base/memory.h"
#include "base/parallel.h"
#include "sculpt/brush/dab.h"
#include "sculpt/edit/edit.h"
#include "sculpt/field/slabs.h"

/* Each edit cell has ISO_TRANSACTION_FIELDS sets of values (fields), so that one pass reads a field and
 * writes another. ISO_TRANSACTION_GRID names the grid's own values, which are only read. */
enum { ISO_TRANSACTION_FIELDS = 3, ISO_TRANSACTION_GRID = -1 };
/* Voxels around a change within which distances can change: the band's 3, and 1 for the stencil. */
enum { ISO_TRANSACTION_SPREAD = 4 };

/* The rows of a brick that have a marked voxel, as bit y of entry z. any: anywhere in the row; low, high:
 * within ISO_TRANSACTION_SPREAD voxels of the row's low or high end. */
typedef struct iso_marked_rows {
    uint16_t any[ISO_BRICK], low[ISO_BRICK], high[ISO_BRICK];
} iso_marked_rows;

/* A cell of the grid in a transaction, with its new values. */
typedef struct iso_edit_cell {
    uint32_t cell;          /* number in the grid */
    int at[3];              /* position in the grid, in cells */
    int32_t state;          /* the grid's entry before the touch */
    const float *source;    /* the values that the brush began with; NULL: the grid's */
    bool removed;           /* an outline removes all of it (list_outline_cell of edit.c) */
    bool edited;            /* the brush changed it; otherwise a neighbour that redistancing may change */
    iso_voxel_bits changed; /* voxels that the brush changed; after compare: that differ from the grid */
    iso_marked_rows rows;   /* of an edited cell: rows with voxels where redistancing starts */
    iso_band_state band;
    int32_t empty; /* what the cell becomes if commit makes it empty: ISO_CELL_OUTSIDE or ISO_CELL_INSIDE;
                      else 0 */
    bool has_fixed_mask;  /* some frozen voxels, beyond the influence of the change, keep their values */
    uint8_t sides;        /* the sides of the surface on which its voxels are: 1 outside, 2 inside, 3 both */
    uint8_t lo[3], hi[3]; /* box of the voxels where redistancing starts; after compare: of `changed` */
    const float
        *value[ISO_TRANSACTION_FIELDS]; /* by field: a scratch brick, the grid's brick, or a constant brick */
    float *own[ISO_TRANSACTION_FIELDS]; /* scratch bricks; NULL: not allocated yet */
    float *spare; /* one of `own` with the current values except in the rows `stale`; NULL: none */
    iso_row_bits stale;
    iso_row_bits moved[2]; /* rows that the last two redistancing steps changed, alternating */
} iso_edit_cell;

/* The bricks that stand for neighbours beyond the grid's border in one stencil. */
typedef struct iso_border_bricks {
    float face[6][ISO_BRICK_VOXELS];
} iso_border_bricks;

/* The working memory of one thread. */
typedef struct iso_worker_scratch {
    iso_border_bricks border[2];
    iso_warp warp;
    iso_buffer window, edge_points;
    float *brick; /* for the next cell's new values; NULL: not allocated, or the last cell kept it */
    bool failed;  /* out of memory */
} iso_worker_scratch;

typedef struct iso_transaction {
    iso_hgrid *grid;
    iso_pool *pool;
    const iso_redistancer *redistancer;
    const iso_dab_kernel *dab;
    float *constant[2];     /* bricks filled with +band and -band */
    uint32_t *edit_cell_of; /* by grid cell: 1 + the index of its edit cell, 0: not listed */
    iso_field_items items;  /* the mask and the paint of the field */
    iso_buffer cells;       /* iso_edit_cell */
    size_t cell_count;
    float far_value;   /* of iso_changed_stencil; 0: redistancing starts from every changed voxel */
    bool band_damaged; /* the edit may have left gaps in the band: all of it near the change is redistanced */
    int current;       /* the field that holds the current values */
    bool redistanced;
    iso_buffer mask_boundaries; /* owned by mask_boundary.c */
    size_t mask_boundary_count;
    iso_worker_scratch *workers;  /* one for each thread of the pool */
    iso_slabs slabs;              /* scratch bricks */
    size_t bricks_taken;          /* number of scratch bricks in use; changed atomically */
    const iso_progress *progress; /* told how far redistancing is; NULL: nobody is told */
} iso_transaction;

/* `transaction` is zero-initialised storage; grid and pool are borrowed until free. ISO_ERR_NOMEM. */
iso_status iso_transaction_init(iso_transaction *transaction, iso_hgrid *grid, iso_pool *pool,
                                iso_error *error);
void iso_transaction_free(iso_transaction *transaction);
/* Removes all cells from the list, for the next touch. The items and the memory stay. */
void iso_transaction_clear(iso_transaction *transaction);

static inline const iso_mask *iso_transaction_mask(const iso_transaction *transaction) {
    return &transaction->items.of[ISO_ITEM_MASK];
}
/* Return edit cell `index`, and its current values (a brick). */
static inline iso_edit_cell *iso_transaction_cell(const iso_transaction *transaction, size_t index) {
    return (iso_edit_cell *)transaction->cells.data + index;
}
static inline const float *iso_transaction_values(const iso_transaction *transaction, size_t index) {
    return iso_transaction_cell(transaction, index)->value[transaction->current];
}

/* Returns the neighbour of an edit cell at an offset of -1, 0 or 1 cells along each axis; NULL: outside the
 * grid, or not listed. */
const iso_edit_cell *iso_transaction_neighbour(const iso_transaction *transaction,
                                               const iso_edit_cell *edit_cell, const int side[3]);

/* Returns the grid's values of a cell with the entry `state`: its brick, or a constant brick for an empty
 * cell. */
const float *iso_transaction_grid_values(const iso_transaction *transaction, int32_t state);
/* Whether a worker has run out of memory; resets the flags. */
bool iso_transaction_failed(iso_transaction *transaction);

/* Lists the cell at position `at` (in cells), with the grid's values; does nothing if it is listed already.
 * ISO_ERR_NOMEM. */
iso_status iso_transaction_add(iso_transaction *transaction, const int at[3], bool edited, iso_error *error);
/* Allocates a scratch brick for each listed cell and each worker, so that the brush cannot run out of them.
 */
iso_status iso_transaction_reserve(iso_transaction *transaction, iso_error *error);

/* Returns the brick into which a worker writes the new values of one cell. Call
 * iso_transaction_accept_scratch with the index of this cell next. */
float *iso_transaction_scratch_brick(iso_transaction *transaction, int worker);
/* Makes the worker's brick the cell's current values, with frozen voxels restored, and finds `changed`. If
 * nothing changed, clears `edited` and keeps the brick for the worker's next cell. */
void iso_transaction_accept_scratch(iso_transaction *transaction, size_t index, int worker);

/* Makes the cell's current values those of a cell outside, and finds `changed` and `edited`; no voxel of it
 * is frozen. */
void iso_transaction_empty(iso_transaction *transaction, size_t index);

/* Returns a cell's current values, to be written. Values that are the grid's or constant are first copied to
 * a scratch brick, which must have been reserved. */
float *iso_transaction_own_values(iso_transaction *transaction, size_t index);

/* Fills the stencil of a cell's values in `field`. Neighbours that are not listed have the grid's values;
 * faces on the grid's border repeat the outermost voxels (stored in `border`, which must outlive the
 * stencil). */
void iso_transaction_stencil(const iso_transaction *transaction, int field, size_t index,
                             iso_border_bricks *border, iso_stencil *stencil);

/* Ends the brush's part, when all cells have been edited: drops unchanged cells and, with `neighbours`, adds
 * the cells that redistancing may change. *any: whether anything changed. ISO_ERR_NOMEM. */
iso_status iso_transaction_end_brush(iso_transaction *transaction, bool neighbours, bool *any,
                                     iso_error *error);

/* Sets a cell's `rows`, `lo` and `hi` to those of the marked voxels. */
void iso_transaction_find_box(iso_edit_cell *edit_cell, const iso_voxel_bits *bits);

/* Makes the listed cells a distance field near the changes (the `changed`, `rows` and boxes of the `edited`
 * cells). `rescale`: interface voxels that the brush changed are rescaled too. ISO_ERR_NOMEM; ISO_ERR_IO:
 * cancelled. */
iso_status iso_transaction_redistance(iso_transaction *transaction, int iterations, bool rescale,
                                      iso_error *error);

/* Compares each cell with the grid and sets `edited`, `changed` and its box. *any: whether any differs. */
void iso_transaction_compare(iso_transaction *transaction, bool *any);

/* Writes the cells that differ to the grid, as one edit of its change log, and adds to `stats`.
 * ISO_ERR_NOMEM: nothing was written. */
iso_status iso_transaction_commit(iso_transaction *transaction, iso_edit_stats *stats, iso_error *error);

#endif
