/* editor: what the files of the editor share (edit.h). Internal to src/sculpt/edit. */
#ifndef ISO_SCULPT_EDIT_EDITOR_H
#define ISO_SCULPT_EDIT_EDITOR_H

#include "sculpt/edit/painter.h"

struct iso_editor {
    iso_transaction transaction;
    iso_painter painter;
    iso_affine affine;
    double spacing;
    int iterations;
    iso_step_opts opts;
    double cost;        /* see iso_editor_cost */
    size_t reached;     /* cells of this touch, one within reach of several dabs as often */
    uint32_t step;      /* number of the current step */
    uint32_t *notified; /* by cell: the last step in which the observer was told of its values */
    uint32_t *item_notified[ISO_ITEM_KINDS]; /* the same for each of its items */
    iso_buffer notified_cells;               /* uint32_t: the cells notified in this step */
    size_t notified_count;
    iso_buffer painted_cells; /* uint32_t: the same for their paint */
    size_t painted_count;
};

/* Writes what a touch, or a stroke's end, has made to the grid, after the observer was told. */
iso_status iso_editor_commit(iso_editor *editor, iso_edit_stats *stats, iso_error *error);

/* Copies to `buffer` the box of the field that `window` has the size of, and sets window->values. For MOVE it
 * is the field from when the step began. Beyond the grid its outermost voxels are repeated. False: there is
 * no memory. */
bool iso_editor_fill_window(const iso_editor *editor, iso_tool tool, const int brick[3],
                            iso_field_window *window, iso_buffer *buffer);

/* Writes the new values of a cell by a warp to `out`. Returns whether some voxel is sampled elsewhere than at
 * its own place: scratch->warp says where. scratch->failed: there was no memory. */
bool iso_editor_warp_cell(const iso_editor *editor, const iso_dabs *dabs, iso_edit_cell *edit_cell,
                          iso_worker_scratch *scratch, float *out);

/* iso_paint_source of an iso_editor: the paint that a warp reads. For MOVE it is that from when the step
 * began, for the others the present one. */
const iso_paint_item *iso_editor_paint_source(const void *editor, uint32_t cell);

#endif
