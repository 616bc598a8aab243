/* work: the cells that a touch works on: their new values beside the grid, until all is done.
 *
 * Jobs are listed cells with their values in scratch; a job's neighbours are other jobs' scratch, the grid's
 * bricks, or one of two constant bricks. Nothing is written to the grid before iso_transaction_commit, so a
 * touch that fails leaves no trace. Internal to sculpt. */
#ifndef ISO_SCULPT_FIELD_TRANSACTION_H
#define ISO_SCULPT_FIELD_TRANSACTION_H

#include "base/memory.h"
#include "base/parallel.h"
#include "sculpt/brush/dab.h"
#include "sculpt/field/edit.h"
#include "sculpt/field/slabs.h"

/* Values of a job that a pass may read and the next one writes; and, read only, the grid's own. */
enum { ISO_TRANSACTION_FIELDS = 3, ISO_TRANSACTION_GRID = -1 };
/* Voxels around a change within which distances can change: the band, and one for the stencil's sake. */
enum { ISO_TRANSACTION_SPREAD = 4 };

/* Rows of a brick with a voxel of some kind, a bit for each y: anywhere, and near the row's low and high end.
 */
typedef struct iso_marked_rows {
    uint16_t any[ISO_BRICK], low[ISO_BRICK], high[ISO_BRICK];
} iso_marked_rows;

/* One cell. */
typedef struct iso_edit_cell {
    uint32_t cell;
    int at[3];
    int32_t state;          /* the grid's entry before */
    const float *source;    /* what the brush began with; NULL: the grid's floats */
    bool edited;            /* the brush wrote it; else it is a neighbour that redistancing may reach */
    iso_voxel_bits changed; /* by the brush; later by all that was done */
    iso_marked_rows rows;   /* from which redistancing begins; of an edited job */
    iso_band_state band;
    int32_t empty;        /* the cell's state when it is to be empty, else 0 */
    bool partly_frozen;   /* some voxels are frozen, and beyond what changed */
    uint8_t sides;        /* of the interface: 1 outside, 2 inside, 3 both, or `still` */
    uint8_t lo[3], hi[3]; /* box of what redistancing begins from; later of `changed` */
    const float *value[ISO_TRANSACTION_FIELDS]; /* own memory, the grid's, or a constant brick */
    float *own[ISO_TRANSACTION_FIELDS];         /* NULL: not taken yet */
    float *spare; /* own memory with the current values but for the rows `stale`; NULL: none */
    iso_row_bits stale;
    iso_row_bits moved[2]; /* by the last step and the one before, taking turns */
} iso_edit_cell;

/* Neighbours beyond the grid's border, made up for one stencil. */
typedef struct iso_border {
    float face[6][ISO_BRICK_VOXELS];
} iso_border;

/* One worker's. */
typedef struct iso_worker {
    iso_border border[2];
    iso_warp warp;
    iso_buffer window, crossings;
    float *stage; /* where the next job is edited, unless the last one kept it; NULL: none yet */
    bool failed;  /* no memory */
} iso_worker;

typedef struct iso_transaction {
    iso_hgrid *grid;
    iso_pool *pool;
    const iso_redistancer *redistancer;
    const iso_dab_kernel *dab;
    float *constant[2]; /* bricks of +band and -band */
    uint32_t *cell_of;  /* by cell: 1 + its job, 0: none */
    iso_mask mask;
    iso_buffer cells;
    size_t cell_count;
    float far_value;   /* of iso_seam_side; 0: redistancing begins from all that changed */
    bool band_damaged; /* what the brush left may lack its band: it is made anew, not only mended */
    int now;           /* the field that holds the jobs' values */
    bool redistanced;
    iso_buffer mask_boundaries; /* of mask_boundary.h */
    size_t mask_boundary_count;
    iso_worker *workers;
    iso_slabs slabs;              /* of bricks that jobs take */
    size_t taken;                 /* of them; atomic while jobs run */
    const iso_progress *progress; /* of redistancing; NULL: nobody waits */
} iso_transaction;

/* Zero-initialised storage; grid and pool are borrowed until free. */
iso_status iso_transaction_init(iso_transaction *transaction, iso_hgrid *grid, iso_pool *pool,
                                iso_error *error);
void iso_transaction_free(iso_transaction *transaction);
/* Forgets all jobs. */
void iso_transaction_clear(iso_transaction *transaction);

static inline iso_edit_cell *iso_transaction_cell(const iso_transaction *transaction, size_t edit_cell) {
    return (iso_edit_cell *)transaction->cells.data + edit_cell;
}
static inline const float *iso_transaction_values(const iso_transaction *transaction, size_t edit_cell) {
    return iso_transaction_cell(transaction, edit_cell)->value[transaction->now];
}

/* The job of the cell beside another's (side: -1, 0, 1 an axis); NULL: none. */
const iso_edit_cell *iso_transaction_neighbour(const iso_transaction *transaction,
                                               const iso_edit_cell *edit_cell, const int side[3]);

/* The floats of a cell with this entry in the grid. */
const float *iso_transaction_grid_values(const iso_transaction *transaction, int32_t state);
/* Whether a worker ran out of memory since the last question. */
bool iso_transaction_failed(iso_transaction *transaction);

/* Lists a cell once, with the grid's values. ISO_ERR_NOMEM. */
iso_status iso_transaction_add(iso_transaction *transaction, const int at[3], bool edited, iso_error *error);
/* Room for the brush's values of all listed cells. */
iso_status iso_transaction_reserve(iso_transaction *transaction, iso_error *error);

/* Where a worker writes a job's new values; iso_transaction_mark_edited is to follow. */
float *iso_transaction_scratch(iso_transaction *transaction, int worker);
/* The job's values are those now, or, where they are the same as before, it is no longer `edited`. */
void iso_transaction_mark_edited(iso_transaction *transaction, size_t edit_cell, int worker);

/* The job's values, in memory of its own: those of an edited job, or a copy of the grid's (there is room). */
float *iso_transaction_own_values(iso_transaction *transaction, size_t edit_cell);

/* The stencil of a job's values in `field` (of the grid's where a neighbour is no job); faces on the grid's
 * border repeat the outermost voxels (kept in `border` while the stencil is used). */
void iso_transaction_stencil(const iso_transaction *transaction, int field, size_t edit_cell,
                             iso_border *border, iso_stencil *stencil);

/* After the brush has been everywhere: drops jobs where nothing changed, and lists the neighbours that
 * redistancing may reach. *any: whether anything changed. */
iso_status iso_transaction_finalize(iso_transaction *transaction, bool neighbours, bool *any,
                                    iso_error *error);

/* Sets a job's box and rows from these voxels. */
void iso_transaction_find_box(iso_edit_cell *edit_cell, const iso_voxel_bits *bits);

/* Makes the listed cells a distance field where something changed near by (jobs that are `edited`, their
 * bits and boxes); `rescale`: voxels at the interface that the brush changed too. ISO_ERR_NOMEM. */
iso_status iso_transaction_redistance(iso_transaction *transaction, int iterations, bool rescale,
                                      iso_error *error);

/* Finds what differs from the grid now; *any: whether anything does. */
void iso_transaction_compare(iso_transaction *transaction, bool *any);

/* Writes what differs, under one edit of the change log. ISO_ERR_NOMEM: nothing was written. */
iso_status iso_transaction_commit(iso_transaction *transaction, iso_edit_stats *stats, iso_error *error);

#endif
