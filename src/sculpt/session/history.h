/* history: undo without limit. Every step keeps the cells that it changed as they were before, packed without
 * loss (cell_pack.h), and the frozen voxels that it changed; undo and redo restore them bit for bit through
 * the change log. Memory is capped;
 * what does not fit goes to a file beside the journal, oldest first, and comes back from there. One thread at
 * a time, the grid's writer. */
#ifndef ISO_SCULPT_SESSION_HISTORY_H
#define ISO_SCULPT_SESSION_HISTORY_H

#include "grids/hgrid.h"
#include "sculpt/field/edit.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct iso_history iso_history;

typedef struct iso_history_opts {
    iso_mask *mask;                                 /* of the field; borrowed; NULL: no step changes it */
    size_t memory;                                  /* bytes; 0 means 1 GiB */
    void (*changing)(void *context, uint32_t cell); /* told of a cell before a step, undo, redo or cancel
                                                       writes it; NULL: nobody is */
    void *context;
    const char
        *spill; /* path of the file that takes what does not fit; copied. NULL: memory grows beyond its cap */
} iso_history_opts;

/* The grid is borrowed until destroy; the spill file is made when first needed and removed by destroy. Where
 * it cannot be written, steps stay in memory. */
iso_status iso_history_create(iso_hgrid *grid, const iso_history_opts *opts, iso_history **history,
                              iso_error *error);
void iso_history_destroy(iso_history *history);

/* A step: begin, edits that tell cells to iso_history_observer, end. What could be redone is forgotten when a
 * step that changed anything ends. Steps do not nest. The name is copied. cancel puts back what was. */
iso_status iso_history_begin(iso_history *history, const char *name, iso_error *error);
iso_step_opts iso_history_step(iso_history *history); /* keeper and kept for iso_editor_step */
iso_status iso_history_end(iso_history *history, iso_error *error);
iso_status iso_history_cancel(iso_history *history, iso_error *error);

/* ISO_ERR_USAGE when there is nothing to undo or redo; ISO_ERR_IO when the spill file cannot be read: the
 * grid is as before. */
iso_status iso_history_undo(iso_history *history, iso_error *error);
iso_status iso_history_redo(iso_history *history, iso_error *error);

/* Forgets all steps. ISO_ERR_USAGE while one is open. */
iso_status iso_history_clear(iso_history *history, iso_error *error);

size_t iso_history_count(const iso_history *history);              /* steps, undone ones included */
size_t iso_history_position(const iso_history *history);           /* steps that are done */
size_t iso_history_cells(const iso_history *history, size_t step); /* that a step changed */
const char *iso_history_name(const iso_history *history, size_t step);
size_t iso_history_bytes(const iso_history *history);   /* in memory */
size_t iso_history_spilled(const iso_history *history); /* in the file */

#ifdef __cplusplus
}
#endif
#endif
