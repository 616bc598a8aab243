/* versions: what each stroke of a list made of the cells that it wrote, so that an edit of a past stroke
 * draws only the strokes again that can come out differently.
 *
 * The versions of a cell are what each stroke that wrote it changed, packed without loss (version_cells.h).
 * An update walks the new list beside the old one and keeps the set of dirty cells, whose content is not what
 * it was at this place of the old list, with the voxels that differ. A stroke that reads none of these keeps
 * its versions, or has only its end done again (version_draw.c); another one is drawn again on a work grid,
 * whose cells are first brought to this place. Cells that come out as they were are clean again, which ends
 * the work early. The result is to the bit that of drawing the whole list. Internal to sculpt. */
#ifndef ISO_SCULPT_SESSION_VERSIONS_H
#define ISO_SCULPT_SESSION_VERSIONS_H

#include "base/parallel.h"
#include "base/progress.h"
#include "grids/hgrid.h"
#include "sculpt/field/cell_items.h"
#include "sculpt/session/stroke_list.h"

typedef struct iso_versions iso_versions;

/* What updates have cost so far. */
typedef struct iso_versions_stats {
    size_t strokes, drawn;  /* strokes of the lists of all updates, and those of them that were drawn */
    size_t bytes, in_files; /* packed versions now, and those of them that lie in files */
    double cost;            /* iso_editor_cost */
} iso_versions_stats;

/* `memory`: bytes of packed versions that are kept in memory; more lie in files in TMPDIR (/tmp).
 * Takes ownership of the field before all strokes, also when it fails; `paint` is its paint, which is copied
 * (no cells: it has none). `check` is called before each touch, and an error of it ends the update (NULL: not
 * called). The pool is borrowed. ISO_ERR_NOMEM; ISO_ERR_USAGE: a grid that cannot be sculpted. */
typedef iso_status iso_versions_check(void *context, double cost, iso_error *error);
iso_status iso_versions_create(iso_hgrid *first, const iso_cell_items *paint, size_t memory, iso_pool *pool,
                               iso_versions_check *check, void *context, iso_versions **versions,
                               iso_error *error);
void iso_versions_destroy(iso_versions *versions); /* NULL is fine */

/* Called for each stroke at its place in the list, before it is drawn; not for muted ones. It may give the
 * stroke other samples. */
typedef iso_status iso_versions_visit(void *context, iso_versions *versions, iso_stroke *stroke,
                                      iso_error *error);
typedef struct iso_versions_visitor {
    iso_versions_visit *visit;
    void *context;
} iso_versions_visitor;

/* Draws a list. visitor: NULL, or whom it is shown to. Errors: those of touches and of visits; ISO_ERR_IO:
 * cancelled. The versions are as before then. */
iso_status iso_versions_update(iso_versions *versions, const iso_stroke_list *list,
                               const iso_versions_visitor *visitor, const iso_progress *progress,
                               iso_error *error);

/* During a visit: the distance, in mm along a sample's normal, from the sample to the surface as it is before
 * the stroke: to where that turns from the inside to the outside, the nearest such place ahead or behind.
 * NAN: there is none within a quarter of the grid. ISO_ERR_NOMEM. */
iso_status iso_versions_cast(iso_versions *versions, const iso_sample *sample, double *distance,
                             iso_error *error);

/* The cells in which the result of the last update differs from that of the update before it: each has a new
 * brick or entry, or a new item. `state` of the field: 0 (a brick), ISO_CELL_OUTSIDE or ISO_CELL_INSIDE; of
 * items: 0 (an item), or ISO_CELL_OUTSIDE for a cell without one. */
enum { ISO_CHANGE_DISTANCES = -1 };
typedef struct iso_cell_change {
    uint32_t cell;
    int kind; /* iso_item_kind, or ISO_CHANGE_DISTANCES */
    int32_t state;
} iso_cell_change;
size_t iso_versions_change_count(const iso_versions *versions);
iso_cell_change iso_versions_change(const iso_versions *versions, size_t index);
/* Writes the values of a change with state 0: a brick, or an item. */
void iso_versions_change_values(const iso_versions *versions, size_t index, void *values);

/* Returns the number of the last stroke of the list that moved the surface near a place, given in voxels:
 * that changed the distance there by more than a twentieth of a voxel. 0: none did. Between updates. */
unsigned iso_versions_find(const iso_versions *versions, const double at[3]);

iso_versions_stats iso_versions_get_stats(const iso_versions *versions);

#endif
