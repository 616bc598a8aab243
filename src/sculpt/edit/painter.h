/* painter: what a touch does to the paint of a field (paint.h), beside what it does to its distances.
 *
 * PAINT lays the brush's colour over the voxels near the surface within its radius, or takes paint away if
 * the brush has no colour. Set operations give what they make of the surface the brush's colour, or none.
 * Warps carry the paint along with the distances. All other tools leave the colours of voxels as they are, so
 * that paint stays where it is when the surface moves through it: a voxel that comes into the band gets the
 * mean colour of its neighbours there, and those of INFLATE, FILL and CLAY that change get the brush's colour
 * laid over theirs. Voxels that leave the band lose their paint. Frozen voxels keep it. Internal to sculpt.
 */
#ifndef ISO_SCULPT_EDIT_PAINTER_H
#define ISO_SCULPT_EDIT_PAINTER_H

#include "sculpt/edit/transaction.h"
#include "sculpt/field/paint.h"

/* A cell whose paint a touch may change. */
typedef struct iso_painted_cell {
    uint32_t cell;          /* number in the grid */
    int at[3];              /* position in the grid, in cells */
    iso_voxel_bits changed; /* voxels that the brush changed; after finish: whose colours differ */
    iso_paint_item *warped; /* what a warp makes of the colours; NULL: there are none */
    iso_paint_item *made;   /* the colours after the touch; NULL: there are none */
    bool differs;
} iso_painted_cell;

/* Returns the paint that a warp reads; NULL: there is none. */
typedef const iso_paint_item *iso_paint_source(const void *context, uint32_t cell);

typedef struct iso_painter {
    iso_transaction *transaction; /* borrowed */
    const iso_dabs *dabs;         /* of the touch; NULL: it cannot change paint */
    iso_paint_source *source;
    const void *source_context;
    iso_buffer cells; /* iso_painted_cell */
    size_t cell_count;
    uint32_t *index_of;  /* by grid cell: 1 + the index of its iso_painted_cell, 0: not listed */
    int failed;          /* a thread has found no memory; changed atomically */
    iso_change_log *log; /* which voxels have changed their colours, of all touches */
} iso_painter;

/* `painter` is zero-initialised; the transaction is borrowed until free. ISO_ERR_NOMEM. */
iso_status iso_painter_init(iso_painter *painter, iso_transaction *transaction, iso_error *error);
void iso_painter_free(iso_painter *painter);

/* Begins a touch; returns whether it can change paint. What follows, up to commit, is for touches that can.
 */
bool iso_painter_begin(iso_painter *painter, const iso_dabs *dabs);
/* Lists the cells of the transaction, in this order. ISO_ERR_NOMEM. */
iso_status iso_painter_list(iso_painter *painter, iso_error *error);
/* Notes what the brush has done to cell `index` of the transaction: the voxels that it has changed (NULL:
 * none), and for warps where they are sampled (NULL: at their own places). For any thread, one a cell. */
void iso_painter_note(iso_painter *painter, size_t index, const iso_voxel_bits *changed,
                      const iso_warp *warp);
/* When the transaction has been compared with the grid: finds the new colours. *any: whether any differs.
 * ISO_ERR_NOMEM. */
iso_status iso_painter_finish(iso_painter *painter, bool *any, iso_error *error);
static inline iso_painted_cell *iso_painter_cell(const iso_painter *painter, size_t index) {
    return (iso_painted_cell *)painter->cells.data + index;
}
/* Adds the changes to the log, as one edit. ISO_ERR_NOMEM. */
iso_status iso_painter_log(iso_painter *painter, iso_error *error);
/* Writes the new colours; cannot fail. */
void iso_painter_commit(iso_painter *painter);
/* Ends the touch, whether it was committed or not. */
void iso_painter_clear(iso_painter *painter);

#endif
