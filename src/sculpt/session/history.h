/* history: unlimited undo. Each step stores the previous content of the cells that it changed, packed without
 * loss (cell_pack.h), and their items (cell_items.h): mask and paint. Undo and redo restore them bit for bit
 * and mark them in the change log. Memory is limited: steps that do not fit are moved to a file, oldest
 * first, and read back when they are needed. For the thread that writes the grid only. */
#ifndef ISO_SCULPT_SESSION_HISTORY_H
#define ISO_SCULPT_SESSION_HISTORY_H

#include "base/c_linkage.h"
#include "grids/hgrid.h"
#include "sculpt/edit/edit.h"

ISO_C_BEGIN

typedef struct iso_history iso_history;

typedef struct iso_history_opts {
    iso_field_items *items;    /* of the field; borrowed; NULL: no step changes any */
    iso_change_log *paint_log; /* restored paint is marked in it; borrowed; NULL: it is not */
    size_t memory;             /* limit in bytes; 0 means 1 GiB */
    /* Called before a step, undo, redo or cancel writes a cell; NULL: not called. */
    void (*before_write)(void *context, uint32_t cell);
    void *context;
    const char
        *beside; /* steps that do not fit go to a file without a name in the folder of this file; copied.
                           NULL: all stay in memory */
} iso_history_opts;

/* The grid is borrowed until destroy. The spill file is created when it is first needed, and vanishes
 * with the history or the program; if it cannot be written, steps stay in memory. ISO_ERR_NOMEM. */
iso_status iso_history_create(iso_hgrid *grid, const iso_history_opts *opts, iso_history **history,
                              iso_error *error);
void iso_history_destroy(iso_history *history);

/* Records a step: begin, edits by an editor that uses iso_history_step_opts, then end, or cancel, which
 * restores the content from before the step. A step that changed something discards all steps that could be
 * redone. Steps do not nest (ISO_ERR_USAGE). The name is copied. ISO_ERR_NOMEM. */
iso_status iso_history_begin(iso_history *history, const char *name, iso_error *error);
iso_step_opts iso_history_step_opts(iso_history *history); /* for iso_editor_begin_step */
iso_status iso_history_end(iso_history *history, iso_error *error);
/* Returns the number of cells, masks and painted cells that the open step has changed so far. */
size_t iso_history_open_cells(const iso_history *history);
/* Makes the open step one that can be undone even if it changes no cell. */
void iso_history_keep(iso_history *history);
/* Ends the open step without storing it: what it changed stays. */
void iso_history_forget(iso_history *history);
iso_status iso_history_cancel(iso_history *history, iso_error *error);

/* Undo the last step, or redo the last step that was undone. ISO_ERR_USAGE: there is no such step, or a step
 * is open; ISO_ERR_IO: the spill file cannot be read; ISO_ERR_NOMEM. The grid is as before then. */
iso_status iso_history_undo(iso_history *history, iso_error *error);
iso_status iso_history_redo(iso_history *history, iso_error *error);

/* Brings a copy of the grid to what the grid was before all steps; the grid and the steps stay as they are.
 * For any thread while no step is begun, undone or redone. ISO_ERR_IO, ISO_ERR_NOMEM. */
iso_status iso_history_first(iso_history *history, iso_hgrid *copy, iso_error *error);

/* Discards all steps. ISO_ERR_USAGE: a step is open. */
iso_status iso_history_clear(iso_history *history, iso_error *error);

size_t iso_history_count(const iso_history *history);    /* number of steps, undone ones included */
size_t iso_history_position(const iso_history *history); /* number of steps that are not undone */
/* Returns the cost of undoing or redoing a step, in the unit of iso_editor_cost. */
double iso_history_cost(const iso_history *history, size_t step);
const char *iso_history_name(const iso_history *history, size_t step);
size_t iso_history_bytes(const iso_history *history);   /* packed bytes in memory */
size_t iso_history_spilled(const iso_history *history); /* bytes of the spill file */

ISO_C_END
#endif
