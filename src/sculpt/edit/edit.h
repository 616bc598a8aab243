/* edit: applies brush touches to a level set and keeps it a distance field.
 *
 * A touch changes the voxels within the brush's influence, redistances the voxels around them (redistance.h)
 * and makes cells empty that no longer need a brick. It neither reads nor writes other cells, so its cost
 * does not depend on the size of the grid. Set operations (add, carve) leave the voxels beside the interface
 * as they are, so redistancing does not move the zero set by a single bit. Deforming tools (smooth, inflate,
 * ...) rescale the interface voxels that they changed (scheme CR-2 of Hartmann et al. 2010). Not thread-safe:
 * a grid has one writer. Baerentzen and Christensen 2003, section 3; Sussman et al. 1994; Russo and Smereka
 * 2000. */
#ifndef ISO_SCULPT_EDIT_EDIT_H
#define ISO_SCULPT_EDIT_EDIT_H

#include "base/parallel.h"
#include "base/progress.h"
#include "grids/hgrid.h"
#include "isopoint.h"
#include "sculpt/brush/brush.h"
#include "sculpt/brush/stamp.h"
#include "sculpt/field/mask.h"
#include "sculpt/field/paint.h"

/* Callbacks that preserve the old content of cells for undo. In each step each cell is reported once, before
 * a touch first writes it. A status other than ISO_OK stops the touch before anything is written. */
typedef struct iso_write_observer {
    /* `state` is the cell's entry in the grid (a brick number, ISO_CELL_OUTSIDE or ISO_CELL_INSIDE), `brick`
     * the brick's values, or NULL for an empty cell. */
    iso_status (*before)(void *context, uint32_t cell, int32_t state, const float *brick, iso_error *error);
    /* Before a tool changes an item of a cell, its mask or its paint; `item` is NULL when it has none, and
     * may be shared (iso_item_share). */
    iso_status (*item_before)(void *context, iso_item_kind kind, uint32_t cell, void *item, iso_error *error);
    void *context;
} iso_write_observer;

typedef struct iso_editor iso_editor;

typedef struct iso_editor_opts {
    iso_pool *pool; /* borrowed; NULL: the calling thread. Results do not depend on it */
    int iterations; /* redistancing steps of a touch; 0: the default, 4; < 0: none, only for benchmarks,
                       because values then stop being distances */
} iso_editor_opts;

/* The grid is borrowed until destroy. ISO_ERR_USAGE: its voxels are not cubes, or its size is not a multiple
 * of a brick; ISO_ERR_NOMEM. */
iso_status iso_editor_create(iso_hgrid *grid, const iso_editor_opts *opts, iso_editor **editor,
                             iso_error *error);
void iso_editor_destroy(iso_editor *editor);

/* Starts an undo step; the touches that follow belong to it. */
typedef struct iso_step_opts {
    iso_write_observer observer; /* before == NULL: nothing is reported */
    /* Returns the values of a cell of this step that `before` was given, or NULL with *state for an empty
     * cell. MOVE needs this function, because it drags the field as it was when the step began; without it
     * (NULL) MOVE fails with ISO_ERR_USAGE. */
    const float *(*original)(void *context, uint32_t cell, int32_t *state);
    /* The same of the paint of a cell that `item_before` was given (NULL: it had none); *kept: whether it
     * was. */
    const iso_paint_item *(*original_paint)(void *context, uint32_t cell, bool *kept);
    const iso_stamp *stamp; /* for ISO_SOLID_STAMP; borrowed during the step */
} iso_step_opts;
void iso_editor_begin_step(iso_editor *editor, const iso_step_opts *opts);

/* Applies one touch, and its images according to the brush's symmetries, as one edit of the change log.
 * `stats` may be NULL. If the touch fails, grid and items are unchanged. ISO_ERR_NOMEM, the errors of the
 * observer; ISO_ERR_USAGE: a bad brush or sample; ISO_ERR_LIMIT: more than ISO_LIMIT_TOUCH_CELLS cells. */
iso_status iso_editor_touch(iso_editor *editor, const iso_brush *brush, const iso_touch *touch,
                            iso_edit_stats *stats, iso_error *error);

/* A box of cells or voxels: the first and the last along each axis. */
typedef struct iso_index_box {
    int lo[3], hi[3];
} iso_index_box;
/* What an image of a touch can read or write. */
typedef struct iso_editor_range {
    iso_index_box
        cells; /* those of the brush's influence and two more around them: the touch lists neighbours of
                       the cells that it edits, and the neighbours of those tell whether these become empty */
    iso_index_box
        voxels; /* those whose distances the touch reads to compute distances; not their sides of the
                       surface, nor what the end of the stroke corrects */
} iso_editor_range;
enum { ISO_EDITOR_RANGES = ISO_IMAGES_MOST };
/* Finds all that the touch and the end of its stroke can read or write, in this grid. Returns the number of
 * ranges. CLEAR_MASK to MASK_VOXELS also read and write the mask of every cell; where voxels are frozen, or
 * several dabs drag, a touch reads more voxels than `voxels`, but not more cells. */
int iso_editor_ranges(const iso_editor *editor, const iso_brush *brush, const iso_touch *touch,
                      iso_editor_range ranges[ISO_EDITOR_RANGES]);

/* Returns the cost of all touches and finalizations so far, images included. The unit is the editing
 * of one cell with a plain brush (about 10 microseconds). The same on every machine. */
double iso_editor_cost(const iso_editor *editor);

/* Ends a step after its last touch: corrects the distances beside creases in the cells that the step changed
 * (crease.h), which touches leave up to a third of a voxel too small. The zero set does not move. Fails as
 * iso_editor_touch does. */
iso_status iso_editor_finalize(iso_editor *editor, iso_error *error);

/* Computes what iso_editor_finalize would make of some cells, each alone and with nothing frozen, without
 * writing them: bricks: room for `count` bricks, any: for `count` flags: whether the cell's was written (it
 * stays as it is otherwise). ISO_ERR_NOMEM. */
iso_status iso_editor_correct(iso_editor *editor, const uint32_t *cells, size_t count, float *bricks,
                              bool *any, iso_error *error);

/* Recomputes the distances of the whole narrow band, for imported fields. ISO_ERR_IO: cancelled through
 * `progress`, the field is unchanged; ISO_ERR_NOMEM. */
iso_status iso_editor_redistance(iso_editor *editor, int iterations, const iso_progress *progress,
                                 iso_error *error);

/* The mask: voxels that no brush may carry to the other side of the surface. A frozen voxel keeps its value,
 * to the bit, while the surface passes between it and another frozen voxel, so the surface between frozen
 * voxels does not move. It also keeps its value when it lies more than 4 voxels, along any axis, from
 * everything that a brush changed. All other frozen voxels are redistanced as usual. Where a brush builds up
 * against frozen voxels, or digs up to them, the new surface is cut off between these and the voxels beside
 * them (mask_boundary.h). */
bool iso_editor_masked(const iso_editor *editor, int x, int y, int z); /* a voxel inside the grid */
bool iso_editor_has_mask(const iso_editor *editor);

/* The editor's own mask and paint, which undo and checkpoints write, and the log of the voxels whose colours
 * have changed. */
iso_field_items *iso_editor_items(iso_editor *editor);
iso_change_log *iso_editor_paint_log(iso_editor *editor);
/* Makes the paint a copy of `paint`, outside of a step; the log has no part of it. ISO_ERR_NOMEM: all is as
 * before. */
iso_status iso_editor_set_paint(iso_editor *editor, const iso_cell_items *paint, iso_error *error);

#endif
