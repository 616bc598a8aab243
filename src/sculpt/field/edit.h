/* edit: one touch of a brush on the clamped distance field of an hgrid, and what keeps it a distance field.
 *
 * A touch edits the voxels it reaches, makes them distances again (redistance.h), and prunes cells that have
 * become empty. It reads and writes no other cell, so its cost does not depend on the grid's size. Set
 * operations leave the voxels at the interface as they are: the zero set moves by no bit when a field is made
 * a distance field again. Deforming ones rescale the interface voxels that they changed (Hartmann et al.,
 * CR-2). Not thread-safe: one writer a grid. Baerentzen and Christensen 2003, section 3; Sussman et al. 1994;
 * Russo and Smereka 2000. */
#ifndef ISO_SCULPT_FIELD_EDIT_H
#define ISO_SCULPT_FIELD_EDIT_H

#include "base/parallel.h"
#include "base/progress.h"
#include "grids/hgrid.h"
#include "isopoint.h"
#include "sculpt/brush/brush.h"
#include "sculpt/brush/stamp.h"
#include "sculpt/field/mask.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Told of a cell before a touch first writes it since iso_editor_set_observer was set or iso_editor_step
 * began: `state` is the cell's entry before (a brick number, ISO_CELL_OUTSIDE or ISO_CELL_INSIDE), `brick`
 * its floats, NULL when empty. A status other than ISO_OK stops the touch before anything is written. */
typedef struct iso_write_observer {
    iso_status (*before)(void *context, uint32_t cell, int32_t state, const float *brick, iso_error *error);
    /* The same of a cell's frozen voxels (NULL: none) before MASK or UNMASK changes them. */
    iso_status (*mask_before)(void *context, uint32_t cell, const iso_voxel_bits *bits, iso_error *error);
    void *context;
} iso_write_observer;

typedef struct iso_editor iso_editor;

typedef struct iso_editor_opts {
    iso_pool *pool; /* borrowed; NULL: the calling thread. Results do not depend on it */
    int iterations; /* of redistancing a touch; 0 means 4, < 0 none (for measuring: the field goes bad) */
} iso_editor_opts;

/* The grid is borrowed until destroy. */
iso_status iso_editor_create(iso_hgrid *grid, const iso_editor_opts *opts, iso_editor **editor,
                             iso_error *error);
void iso_editor_destroy(iso_editor *editor);

/* Starts an undo step: from here each cell is told to the keeper once, before it is first written. The field
 * as it is now is what MOVE drags: cells that the step has told are read from the copies that `keeper_cell`
 * returns. */
typedef struct iso_step_opts {
    iso_write_observer observer; /* before == NULL: nobody is told */
    /* The cell's content as `before` got it, for cells that were told in this step: its floats, or NULL and
     * *state for an empty one. NULL: MOVE is not possible (ISO_ERR_USAGE). */
    const float *(*kept)(void *context, uint32_t cell, int32_t *state);
    const iso_stamp *stamp; /* for ISO_SOLID_STAMP; borrowed */
} iso_step_opts;
void iso_editor_step(iso_editor *editor, const iso_step_opts *opts);

/* One touch: the sample, mirrored by the brush's symmetry, in one change-log edit. `first` and `previous` are
 * the stroke's first sample and the one before (the sample itself at the stroke's start). ISO_ERR_NOMEM and
 * what the keeper returns leave the field a sound distance field, with the touch done wholly or not at all.
 * ISO_ERR_USAGE for a bad brush or a sample that is not finite; ISO_ERR_LIMIT when the touch reaches more
 * than ISO_LIMIT_TOUCH_CELLS cells. stats may be NULL. */
typedef struct iso_touch {
    iso_sample sample, previous, first;
} iso_touch;
iso_status iso_editor_touch(iso_editor *editor, const iso_brush *brush, const iso_touch *touch,
                            iso_edit_stats *stats, iso_error *error);

/* Work of all touches and settles so far, in cells edited by a plain brush (about 10 microseconds each): what
 * a touch looks at and writes, for all its mirrored instances. Does not depend on the machine. */
double iso_editor_work(const iso_editor *editor);

/* After a step's last touch: distances beside creases in the cells that the step changed (those that the
 * keeper was told of), which touches leave a third of a voxel short, are taken from the surface (crease.h).
 * The zero set moves by no bit. What a touch does when it fails, this does. */
iso_status iso_editor_finalize(iso_editor *editor, iso_error *error);

/* Makes the whole narrow band a distance field again (imported fields). Cancelled: ISO_ERR_IO, and the field
 * is as it was. */
iso_status iso_editor_redistance(iso_editor *editor, int iterations, const iso_progress *progress,
                                 iso_error *error);

/* The frozen region, as bits per voxel: cells with none have no bits. A masked voxel stays on its side of the
 * surface. It keeps its value, to the bit, while the surface passes between it and another masked voxel, so
 * that the surface between masked voxels does not move at all; and when it is more than 4 voxels, along any
 * axis, from all that a brush changes. Others are distances to the surface as it is now, as anywhere. A brush
 * that builds up against masked voxels, or digs up to them, is cut off between those and the voxels beside
 * them (mask_boundary.h). */
bool iso_editor_masked(const iso_editor *editor, int x, int y, int z);
bool iso_editor_has_mask(const iso_editor *editor);
void iso_editor_mask_clear(iso_editor *editor);
iso_mask *iso_editor_mask(iso_editor *editor); /* the editor's own, for who restores it */

#ifdef __cplusplus
}
#endif
#endif
