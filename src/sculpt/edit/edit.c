/* The editor: turns a touch into dabs in voxels (brush_to_voxels.c, area_plane.h), lists the cells they
 * reach, runs the brush's kernel on each (dab.h), then redistances and commits them (transaction.h). The
 * tools MASK to MASK_VOXELS change only the mask, PAINT only the paint (painter.h). */
#include "sculpt/edit/edit.h"

#include <math.h>
#include <string.h>

#include "sculpt/edit/area_plane.h"
#include "sculpt/edit/editor.h"
#include "sculpt/edit/mask_rewrite.h"
#include "sculpt/edit/transaction.h"
#include "sculpt/limits.h"

/* Redistancing steps (0.45 voxel each) of an edit that left gaps in the band: enough to fill the whole band.
 */
enum { DAMAGED_BAND_ITERATIONS = 12 };
/* Checks that voxels are cubes, because distances are in voxels, and that the size is a multiple of a brick,
 * because kernels write whole bricks. */
static iso_status check_grid(const iso_hgrid *grid, iso_error *error) {
    const double *s = grid->transform.spacing;
    if (fabs(s[0] - s[1]) > 1e-6 * s[0] || fabs(s[0] - s[2]) > 1e-6 * s[0])
        return iso_fail(error, ISO_ERR_USAGE,
                        "voxels of %g x %g x %g mm cannot be sculpted: resample to cubes", s[0], s[1], s[2]);
    for (int axis = 0; axis < 3; axis++)
        if (grid->dims[axis] % ISO_BRICK)
            return iso_fail(error, ISO_ERR_USAGE,
                            "a level set of %d voxels along %c cannot be sculpted: not whole bricks of %d",
                            grid->dims[axis], "xyz"[axis], ISO_BRICK);
    return ISO_OK;
}

iso_status iso_editor_create(iso_hgrid *grid, const iso_editor_opts *opts, iso_editor **out,
                             iso_error *error) {
    ISO_TRY(check_grid(grid, error));
    iso_editor *editor = iso_alloc_zero(1, sizeof *editor);
    if (!editor) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for an editor");
    iso_status status = iso_transaction_init(&editor->transaction, grid, opts->pool, error);
    if (status != ISO_OK) {
        iso_free(editor);
        return status;
    }
    editor->affine = iso_transform_affine(&grid->transform);
    editor->spacing = grid->transform.spacing[0];
    editor->iterations = opts->iterations > 0 ? opts->iterations : opts->iterations < 0 ? 0 : 4;
    editor->painter.source = iso_editor_paint_source;
    editor->painter.source_context = editor;
    editor->notified = iso_alloc_zero(iso_hgrid_cell_count(grid), sizeof *editor->notified);
    bool whole = editor->notified != NULL;
    for (int i = 0; i < ISO_ITEM_KINDS; i++) {
        editor->item_notified[i] = iso_alloc_zero(iso_hgrid_cell_count(grid), sizeof *editor->notified);
        whole &= editor->item_notified[i] != NULL;
    }
    status = whole ? iso_painter_init(&editor->painter, &editor->transaction, error)
                   : iso_fail(error, ISO_ERR_NOMEM, "out of memory for an editor of %zu cells",
                              iso_hgrid_cell_count(grid));
    if (status == ISO_OK)
        *out = editor;
    else
        iso_editor_destroy(editor);
    return status;
}

void iso_editor_destroy(iso_editor *editor) {
    if (!editor) return;
    iso_painter_free(&editor->painter);
    iso_transaction_free(&editor->transaction);
    iso_buffer_free(&editor->notified_cells);
    iso_buffer_free(&editor->painted_cells);
    iso_free(editor->notified);
    for (int i = 0; i < ISO_ITEM_KINDS; i++) iso_free(editor->item_notified[i]);
    iso_free(editor);
}

void iso_editor_begin_step(iso_editor *editor, const iso_step_opts *opts) {
    editor->opts = *opts;
    editor->notified_count = editor->painted_count = 0;
    editor->step++;
}

/* ---- the cells that a touch may change */

/* Whether a tool can change a cell with this entry in the grid: adding to the inside changes nothing, nor
 * does carving outside. */
static bool can_change(iso_tool tool, int32_t state) {
    if (state >= 0 || iso_tool_is_warp(tool)) return true;
    if (tool == ISO_TOOL_ADD || tool == ISO_TOOL_BLEND_ADD) return state == ISO_CELL_OUTSIDE;
    if (tool == ISO_TOOL_CARVE || tool == ISO_TOOL_BLEND_CARVE) return state == ISO_CELL_INSIDE;
    return false;
}

/* Whether a tool can bring material to places where there was none. */
static bool makes_material(iso_tool tool) {
    return tool != ISO_TOOL_CARVE && tool != ISO_TOOL_BLEND_CARVE && tool != ISO_TOOL_DEFLATE &&
           tool != ISO_TOOL_SMOOTH && tool != ISO_TOOL_SCRAPE && tool != ISO_TOOL_PAINT;
}

/* Computes the range of cells, lo .. hi, within a dab's influence, clipped to the grid. Returns whether the
 * tool makes material and its solid (of set operations) or the radius extends beyond the grid, where that
 * material is lost. */
static bool cell_range(const iso_editor *editor, const iso_dabs *dabs, const iso_dab *dab, int lo[3],
                       int hi[3]) {
    bool clipped = false;
    double influence = iso_dabs_influence(dabs),
           solid = influence - (iso_tool_is_set_operation(dabs->tool) ? (double)dabs->band : 0);
    bool segment = iso_tool_is_drag(dabs->tool) || dabs->solid == ISO_SOLID_CAPSULE;
    for (int axis = 0; axis < 3; axis++) {
        double a = dab->centre[axis], b = segment ? dab->from[axis] : a;
        double first = fmin(a, b), last = fmax(a, b), top = editor->transaction.grid->dims[axis] - 1;
        clipped |= first - solid < 0 || last + solid > top;
        lo[axis] = (int)floor(fmax(fmin(first - influence, top), 0) / ISO_BRICK);
        hi[axis] = (int)floor(fmax(fmin(last + influence, top), 0) / ISO_BRICK);
    }
    return clipped && makes_material(dabs->tool);
}

static double cells_in_range(const int lo[3], const int hi[3]) {
    return (hi[0] - lo[0] + 1.0) * (hi[1] - lo[1] + 1.0) * (hi[2] - lo[2] + 1.0);
}

/* Returns the cost of editing the listed cells; one of a brush with one dab of a simple solid costs 1.25. It
 * grows with the number of dabs that reach a cell. A stamp costs more because it is sampled at every voxel, a
 * drag because it follows each voxel back along the stroke in up to 256 steps. */
static double cost_of_cells(const iso_editor *editor, const iso_dabs *dabs) {
    const double cells = (double)editor->transaction.cell_count, reached = (double)editor->reached;
    if (iso_tool_is_drag(dabs->tool)) return cells * (1 + dabs->count * iso_dabs_steps(dabs) / 4.0);
    if (dabs->solid == ISO_SOLID_STAMP && iso_tool_is_set_operation(dabs->tool)) return 16 * reached;
    return cells + reached / 4;
}

static iso_status list_dab_cells(iso_editor *editor, const iso_dabs *dabs, const iso_dab *dab, bool *clipped,
                                 iso_error *error) {
    int lo[3], hi[3], at[3];
    *clipped |= cell_range(editor, dabs, dab, lo, hi);
    editor->cost += cells_in_range(lo, hi) / 256;
    const double influence = iso_dabs_influence(dabs);
    for (at[2] = lo[2]; at[2] <= hi[2]; at[2]++)
        for (at[1] = lo[1]; at[1] <= hi[1]; at[1]++)
            for (at[0] = lo[0]; at[0] <= hi[0]; at[0]++) {
                if (iso_dab_brick_distance(dabs, dab, at) >= influence) continue;
                size_t cell = iso_hgrid_cell_index(editor->transaction.grid, at[0], at[1], at[2]);
                if (!can_change(dabs->tool, editor->transaction.grid->cell[cell])) continue;
                ISO_TRY(iso_transaction_add(&editor->transaction, at, true, error));
                editor->reached++;
                if (editor->transaction.cell_count > ISO_LIMIT_TOUCH_CELLS)
                    return iso_fail(error, ISO_ERR_LIMIT,
                                    "a brush of %g voxels reaches more than %d bricks in one touch",
                                    (double)dabs->radius_voxels, ISO_LIMIT_TOUCH_CELLS);
            }
    return ISO_OK;
}

/* Lists the cells that the step has changed so far. MOVE edits the field as it was when the step began, so
 * cells that its earlier touches changed must be edited again. */
static iso_status list_notified(iso_editor *editor, const iso_buffer *cells, size_t count, iso_error *error) {
    const uint32_t *notified = cells->data;
    for (size_t i = 0; i < count; i++) {
        int at[3];
        iso_hgrid_cell_position(editor->transaction.grid, notified[i], at);
        ISO_TRY(iso_transaction_add(&editor->transaction, at, true, error));
    }
    return ISO_OK;
}

/* What is listed of an outline: cells that it can change. */
typedef struct outline_list {
    iso_editor *editor;
    const iso_dabs *dabs;
} outline_list;

/* Lists a cell. `deep`: all of it is removed. */
static iso_status list_outline_cell(const outline_list *list, const int at[3], bool deep, iso_error *error) {
    iso_transaction *transaction = &list->editor->transaction;
    const size_t cell = iso_hgrid_cell_index(transaction->grid, at[0], at[1], at[2]);
    if (!can_change(list->dabs->tool, transaction->grid->cell[cell])) return ISO_OK;
    ISO_TRY(iso_transaction_add(transaction, at, true, error));
    iso_transaction_cell(transaction, transaction->cell_count - 1)->removed =
        deep && !iso_mask_bits(iso_transaction_mask(transaction), cell);
    list->editor->reached++;
    return transaction->cell_count <= ISO_LIMIT_TOUCH_CELLS
               ? ISO_OK
               : iso_fail(error, ISO_ERR_LIMIT, "an outline removes more than %d bricks",
                          ISO_LIMIT_TOUCH_CELLS);
}

/* Lists what an outline can change of a block of side^3 cells from `at` on: first the distance at its middle
 * tells whether all of it, or nothing, is removed. */
static iso_status list_outline_block(const outline_list *list, const int at[3], int side, iso_error *error) {
    const iso_hgrid *grid = list->editor->transaction.grid;
    const double half = 0.5 * (ISO_BRICK * side - 1), reach = sqrt(3) * half + 0.01;
    double middle[3];
    int p[3], end[3];
    for (int k = 0; k < 3; k++) {
        middle[k] = ISO_BRICK * (double)at[k] + half;
        end[k] = at[k] + side < grid->cells[k] ? at[k] + side : grid->cells[k];
    }
    const double distance = iso_outline_distance(list->dabs->outline, middle),
                 band = (double)list->dabs->band, blend = (double)list->dabs->blend_voxels;
    if (distance >= reach + band + blend) return ISO_OK;
    const bool deep = distance <= -(reach + band + blend);
    if (side == 1) return list_outline_cell(list, at, deep, error);
    for (p[2] = at[2]; p[2] < end[2]; p[2]++)
        for (p[1] = at[1]; p[1] < end[1]; p[1]++)
            for (p[0] = at[0]; p[0] < end[0]; p[0]++)
                ISO_TRY(deep ? list_outline_cell(list, p, true, error)
                             : list_outline_block(list, p, 1, error));
    return ISO_OK;
}

static iso_status list_outline(iso_editor *editor, const iso_dabs *dabs, iso_error *error) {
    enum { BLOCK = 4 };
    const int *cells = editor->transaction.grid->cells;
    const outline_list list = {editor, dabs};
    int at[3];
    for (at[2] = 0; at[2] < cells[2]; at[2] += BLOCK)
        for (at[1] = 0; at[1] < cells[1]; at[1] += BLOCK)
            for (at[0] = 0; at[0] < cells[0]; at[0] += BLOCK)
                ISO_TRY(list_outline_block(&list, at, BLOCK, error));
    editor->cost += (double)iso_hgrid_cell_count(editor->transaction.grid) * dabs->outline->count / 1024;
    return iso_transaction_reserve(&editor->transaction, error);
}

static iso_status list_cells(iso_editor *editor, const iso_dabs *dabs, bool *clipped, iso_error *error) {
    editor->reached = 0;
    if (dabs->outline) return list_outline(editor, dabs, error);
    for (int i = 0; i < dabs->count; i++)
        ISO_TRY(list_dab_cells(editor, dabs, &dabs->dab[i], clipped, error));
    if (dabs->tool == ISO_TOOL_MOVE) {
        ISO_TRY(list_notified(editor, &editor->notified_cells, editor->notified_count, error));
        ISO_TRY(list_notified(editor, &editor->painted_cells, editor->painted_count, error));
    }
    return iso_transaction_reserve(&editor->transaction, error);
}

/* ---- new values */

typedef struct brush_pass {
    iso_editor *editor;
    const iso_dabs *dabs;
} brush_pass;

static void brush_cell(void *context, size_t index, int worker) {
    const brush_pass *pass = context;
    iso_transaction *transaction = &pass->editor->transaction;
    iso_edit_cell *edit_cell = iso_transaction_cell(transaction, index);
    iso_painter *painter = &pass->editor->painter;
    bool warped = false;
    if (edit_cell->removed) {
        iso_transaction_empty(transaction, index);
        if (painter->dabs) iso_painter_note(painter, index, &edit_cell->changed, NULL);
        return;
    }
    float *out = iso_transaction_scratch_brick(transaction, worker);
    if (iso_tool_is_warp(pass->dabs->tool))
        warped =
            iso_editor_warp_cell(pass->editor, pass->dabs, edit_cell, &transaction->workers[worker], out);
    else {
        /* The brush reads the grid's values, which are those before the touch, because other threads are
         * writing the new values of neighbouring cells. */
        iso_stencil stencil;
        iso_transaction_stencil(transaction, ISO_TRANSACTION_GRID, index, transaction->workers[worker].border,
                                &stencil);
        transaction->dab->edit(pass->dabs, edit_cell->at, &stencil, out);
    }
    iso_transaction_accept_scratch(transaction, index, worker);
    if (painter->dabs)
        iso_painter_note(painter, index, edit_cell->edited ? &edit_cell->changed : NULL,
                         warped ? &transaction->workers[worker].warp : NULL);
}

/* ---- a touch */

/* Notifies the observer of the cells that are about to be written for the first time in this step. */
static iso_status notify_observer(iso_editor *editor, iso_error *error) {
    const iso_write_observer *observer = &editor->opts.observer;
    if (!observer->before) return ISO_OK;
    for (size_t i = 0; i < editor->transaction.cell_count; i++) {
        const iso_edit_cell *edit_cell = iso_transaction_cell(&editor->transaction, i);
        if (!edit_cell->edited || editor->notified[edit_cell->cell] == editor->step) continue;
        size_t bytes = editor->notified_count * sizeof(uint32_t);
        ISO_TRY(iso_buffer_reserve(&editor->notified_cells, bytes + sizeof(uint32_t), bytes, error));
        const float *brick =
            edit_cell->state >= 0 ? iso_hgrid_brick(editor->transaction.grid, edit_cell->state) : NULL;
        ISO_TRY(observer->before(observer->context, edit_cell->cell, edit_cell->state, brick, error));
        ((uint32_t *)editor->notified_cells.data)[editor->notified_count++] = edit_cell->cell;
        editor->notified[edit_cell->cell] = editor->step;
    }
    return ISO_OK;
}

/* Tells the observer, once in a step, that an item of a cell is going to change. */
static iso_status notify_item_observer(iso_editor *editor, iso_item_kind kind, uint32_t cell,
                                       iso_error *error) {
    const iso_write_observer *observer = &editor->opts.observer;
    if (observer->item_before && editor->item_notified[kind][cell] != editor->step)
        ISO_TRY(observer->item_before(observer->context, kind, cell,
                                      editor->transaction.items.of[kind].cell[cell], error));
    editor->item_notified[kind][cell] = editor->step;
    return ISO_OK;
}

/* The same for the cells whose paint is about to be written. */
static iso_status notify_paint_observer(iso_editor *editor, iso_error *error) {
    const uint32_t *notified = editor->item_notified[ISO_ITEM_PAINT];
    for (size_t i = 0; i < editor->painter.cell_count; i++) {
        const iso_painted_cell *painted = iso_painter_cell(&editor->painter, i);
        if (!painted->differs || notified[painted->cell] == editor->step) continue;
        const size_t bytes = editor->painted_count * sizeof(uint32_t);
        ISO_TRY(iso_buffer_reserve(&editor->painted_cells, bytes + sizeof(uint32_t), bytes, error));
        ISO_TRY(notify_item_observer(editor, ISO_ITEM_PAINT, painted->cell, error));
        ((uint32_t *)editor->painted_cells.data)[editor->painted_count++] = painted->cell;
    }
    return ISO_OK;
}

iso_status iso_editor_commit(iso_editor *editor, iso_edit_stats *stats, iso_error *error) {
    iso_transaction *transaction = &editor->transaction;
    iso_painter *painter = &editor->painter;
    bool any, painted = false;
    iso_transaction_compare(transaction, &any);
    if (painter->dabs) ISO_TRY(iso_painter_finish(painter, &painted, error));
    if (painted) ISO_TRY(notify_paint_observer(editor, error));
    if (painted) ISO_TRY(iso_painter_log(painter, error));
    if (any) ISO_TRY(notify_observer(editor, error));
    if (any) ISO_TRY(iso_transaction_commit(transaction, stats, error));
    if (painted) iso_painter_commit(painter);
    return ISO_OK;
}

/* Returns the far_value (iso_changed_stencil) of a touch: the end of the band that is right on both sides of
 * a seam. Returns 0 if the new values are not exact distances to one solid; redistancing then starts at every
 * changed voxel. */
static float far_value_of(const iso_dabs *dabs) {
    if (!dabs->apart || dabs->solid == ISO_SOLID_STAMP) return 0;
    return dabs->tool == ISO_TOOL_ADD ? dabs->band : dabs->tool == ISO_TOOL_CARVE ? -dabs->band : 0;
}

static iso_status touch_field(iso_editor *editor, const iso_dabs *dabs, iso_edit_stats *stats,
                              iso_error *error) {
    iso_transaction *transaction = &editor->transaction;
    brush_pass pass = {.editor = editor, .dabs = dabs};
    ISO_TRY(list_cells(editor, dabs, &stats->clipped, error));
    editor->cost += cost_of_cells(editor, dabs);
    const bool paints = iso_painter_begin(&editor->painter, dabs);
    if (paints) ISO_TRY(iso_painter_list(&editor->painter, error));
    transaction->far_value = far_value_of(dabs);
    transaction->band_damaged =
        dabs->tool == ISO_TOOL_MOVE; /* MOVE stretches and compresses the field without limit */
    iso_parallel_for(transaction->pool, transaction->cell_count, brush_cell, &pass);
    if (iso_transaction_failed(transaction))
        return iso_fail(error, ISO_ERR_NOMEM, "out of memory for a touch of the brush");
    bool any;
    ISO_TRY(iso_transaction_end_brush(transaction, editor->iterations > 0, &any, error));
    if (!any && !paints) return ISO_OK;
    for (size_t i = 0; i < transaction->cell_count; i++)
        stats->edited += iso_transaction_cell(transaction, i)->edited;
    stats->redistanced += transaction->cell_count;
    editor->cost += (double)transaction->cell_count * (transaction->band_damaged ? 3 : 1);
    bool blends = dabs->tool == ISO_TOOL_BLEND_ADD || dabs->tool == ISO_TOOL_BLEND_CARVE;
    if (any && editor->iterations > 0)
        ISO_TRY(iso_transaction_redistance(
            transaction, transaction->band_damaged ? DAMAGED_BAND_ITERATIONS : editor->iterations,
            blends || !iso_tool_is_set_operation(dabs->tool), error));
    return iso_editor_commit(editor, stats, error);
}

static iso_status touch_paint(iso_editor *editor, const iso_dabs *dabs, iso_edit_stats *stats,
                              iso_error *error) {
    iso_painter *painter = &editor->painter;
    if (!iso_painter_begin(painter, dabs)) return ISO_OK;
    ISO_TRY(list_cells(editor, dabs, &stats->clipped, error));
    ISO_TRY(iso_painter_list(painter, error));
    editor->cost += cost_of_cells(editor, dabs);
    ISO_TRY(iso_editor_commit(editor, stats, error));
    for (size_t i = 0; i < painter->cell_count; i++) stats->edited += iso_painter_cell(painter, i)->differs;
    return ISO_OK;
}

/* ---- masking */

static iso_mask *mask_of(iso_editor *editor) {
    return &editor->transaction.items.of[ISO_ITEM_MASK];
}

/* Sets (MASK) or clears (UNMASK) the bits of a cell's voxels within the dab's radius; returns whether any
 * changed. */
static bool mask_cell(iso_voxel_bits *bits, const iso_dabs *dabs, const iso_dab *dab, const int at[3]) {
    const double radius_voxels = (double)dabs->radius_voxels;
    bool any = false;
    for (int i = 0; i < ISO_BRICK_VOXELS; i++) {
        const int voxel[3] = {i % ISO_BRICK, i / ISO_BRICK % ISO_BRICK, i / ISO_BRICK_ROWS};
        double square = 0;
        for (int axis = 0; axis < 3; axis++) {
            double d = ISO_BRICK * (double)at[axis] + voxel[axis] - dab->centre[axis];
            square += d * d;
        }
        if (square > radius_voxels * radius_voxels) continue;
        const uint16_t bit = (uint16_t)(1u << voxel[0]), old = bits->row[i / ISO_BRICK];
        bits->row[i / ISO_BRICK] = (uint16_t)(dabs->tool == ISO_TOOL_MASK ? old | bit : old & ~bit);
        any |= bits->row[i / ISO_BRICK] != old;
    }
    return any;
}

/* Computes the mask bits that a cell has after a dab. Returns whether they differ from the present ones. */
static bool find_mask_bits(const iso_editor *editor, const iso_dabs *dabs, const iso_dab *dab,
                           const int at[3], uint32_t *cell, iso_voxel_bits *bits) {
    *cell = (uint32_t)iso_hgrid_cell_index(editor->transaction.grid, at[0], at[1], at[2]);
    const iso_voxel_bits *before = iso_mask_bits(iso_transaction_mask(&editor->transaction), *cell);
    *bits = before ? *before : (iso_voxel_bits){{0}};
    return mask_cell(bits, dabs, dab, at);
}

/* Does the part of masking a cell that can fail: notifies the observer and allocates bits. */
static iso_status prepare_mask_cell(iso_editor *editor, const iso_dabs *dabs, const iso_dab *dab,
                                    const int at[3], iso_error *error) {
    uint32_t cell;
    iso_voxel_bits bits;
    if (!find_mask_bits(editor, dabs, dab, at, &cell, &bits)) return ISO_OK;
    ISO_TRY(notify_item_observer(editor, ISO_ITEM_MASK, cell, error));
    return iso_cell_items_reserve(mask_of(editor), cell, error);
}

/* Writes the mask bits of a cell; cannot fail, because prepare_mask_cell has allocated them. */
static iso_status write_mask_cell(iso_editor *editor, const iso_dabs *dabs, const iso_dab *dab,
                                  const int at[3], iso_error *error) {
    uint32_t cell;
    iso_voxel_bits bits;
    if (!find_mask_bits(editor, dabs, dab, at, &cell, &bits)) return ISO_OK;
    return iso_cell_items_set(mask_of(editor), cell, &bits, error);
}

/* Frees the bits that prepare_mask_cell allocated, if they were not written. */
static iso_status release_mask_cell(iso_editor *editor, const iso_dabs *dabs, const iso_dab *dab,
                                    const int at[3], iso_error *error) {
    iso_mask *mask = mask_of(editor);
    const size_t cell = iso_hgrid_cell_index(editor->transaction.grid, at[0], at[1], at[2]);
    (void)dabs;
    (void)dab;
    return iso_cell_items_set(mask, cell, iso_mask_bits(mask, cell), error);
}

typedef iso_status mask_cell_fn(iso_editor *editor, const iso_dabs *dabs, const iso_dab *dab, const int at[3],
                                iso_error *error);

/* Calls `visit` for each dab and each cell that it reaches: none for dabs outside the grid. */
static iso_status for_mask_cells(iso_editor *editor, const iso_dabs *dabs, mask_cell_fn *visit,
                                 iso_error *error) {
    const double influence = iso_dabs_influence(dabs);
    for (int i = 0; i < dabs->count; i++) {
        int lo[3], hi[3], at[3];
        cell_range(editor, dabs, &dabs->dab[i], lo, hi);
        for (at[2] = lo[2]; at[2] <= hi[2]; at[2]++)
            for (at[1] = lo[1]; at[1] <= hi[1]; at[1]++)
                for (at[0] = lo[0]; at[0] <= hi[0]; at[0]++)
                    if (iso_dab_brick_distance(dabs, &dabs->dab[i], at) < influence)
                        ISO_TRY(visit(editor, dabs, &dabs->dab[i], at, error));
    }
    return ISO_OK;
}

static iso_status touch_mask(iso_editor *editor, const iso_dabs *dabs, iso_error *error) {
    for (int i = 0; i < dabs->count; i++) {
        int lo[3], hi[3];
        cell_range(editor, dabs, &dabs->dab[i], lo, hi);
        editor->cost += cells_in_range(lo, hi);
    }
    iso_status status = for_mask_cells(editor, dabs, prepare_mask_cell, error);
    if (status == ISO_OK) return for_mask_cells(editor, dabs, write_mask_cell, error);
    for_mask_cells(editor, dabs, release_mask_cell, NULL);
    return status;
}

/* ---- the whole mask */

/* Computes the mask bits that CLEAR_MASK or INVERT_MASK gives a cell. Returns whether they differ from the
 * present ones. */
static bool find_whole_mask_bits(const iso_mask *mask, iso_tool tool, size_t cell, iso_voxel_bits *bits) {
    const iso_voxel_bits *before = iso_mask_bits(mask, cell);
    *bits = (iso_voxel_bits){{0}};
    if (tool == ISO_TOOL_CLEAR_MASK) return before != NULL;
    for (int row = 0; row < ISO_BRICK_ROWS; row++)
        bits->row[row] = (uint16_t) ~(before ? before->row[row] : 0);
    return true;
}

/* Does the part of changing the whole mask that can fail. */
static iso_status prepare_whole_mask(iso_editor *editor, iso_tool tool, iso_error *error) {
    iso_mask *mask = mask_of(editor);
    iso_voxel_bits bits;
    for (size_t cell = 0; cell < mask->cells; cell++) {
        if (!find_whole_mask_bits(mask, tool, cell, &bits)) continue;
        ISO_TRY(notify_item_observer(editor, ISO_ITEM_MASK, (uint32_t)cell, error));
        ISO_TRY(iso_cell_items_reserve(mask, cell, error));
    }
    return ISO_OK;
}

/* Clears or inverts the whole mask. If it fails, the bits that were allocated for it are freed again. */
static iso_status change_whole_mask(iso_editor *editor, iso_tool tool, iso_error *error) {
    iso_mask *mask = mask_of(editor);
    iso_voxel_bits bits;
    editor->cost += (double)mask->cells / 64; /* inverting 64 cells takes as long as editing one */
    const iso_status status = prepare_whole_mask(editor, tool, error);
    for (size_t cell = 0; cell < mask->cells; cell++)
        if (status != ISO_OK)
            iso_cell_items_set(mask, cell, iso_mask_bits(mask, cell), NULL);
        else if (find_whole_mask_bits(mask, tool, cell, &bits))
            iso_cell_items_set(mask, cell, &bits, NULL); /* cannot fail: its bits are allocated */
    return status;
}

static iso_status write_blurred(iso_editor *editor, const iso_mask_cell *cells, size_t count,
                                iso_error *error) {
    iso_mask *mask = mask_of(editor);
    iso_status status = ISO_OK;
    for (size_t i = 0; i < count && status == ISO_OK; i++) {
        status = notify_item_observer(editor, ISO_ITEM_MASK, cells[i].cell, error);
        if (status == ISO_OK) status = iso_cell_items_reserve(mask, cells[i].cell, error);
    }
    for (size_t i = 0; i < count; i++)
        iso_cell_items_set(mask, cells[i].cell,
                           status == ISO_OK ? &cells[i].bits : iso_mask_bits(mask, cells[i].cell), NULL);
    return status;
}

/* Smooths the mask's border, or freezes the stamp's voxels. If it fails, the mask is as before. */
static iso_status rewrite_mask(iso_editor *editor, const iso_dabs *dabs, iso_error *error) {
    const int reach = (int)fmax(1, fmin(round((double)dabs->radius_voxels), ISO_MASK_BLUR_MOST));
    const iso_hgrid *grid = editor->transaction.grid;
    iso_mask *mask = mask_of(editor);
    iso_buffer changed = {0};
    size_t count = 0, looked_at = 0;
    iso_status status = dabs->tool == ISO_TOOL_BLUR_MASK
                            ? iso_mask_blur(mask, grid, reach, &changed, &count, &looked_at, error)
                            : iso_mask_add_voxels(mask, grid, &editor->opts.stamp->voxels, &changed, &count,
                                                  &looked_at, error);
    editor->cost += (double)mask->cells / 64 + (double)looked_at;
    if (status == ISO_OK) status = write_blurred(editor, changed.data, count, error);
    iso_buffer_free(&changed);
    return status;
}

static iso_status check_touch(const iso_editor *editor, const iso_brush *brush, const iso_touch *touch,
                              iso_error *error) {
    ISO_TRY(iso_brush_check(brush, error));
    if (iso_tool_is_trim(brush->tool)) return ISO_OK; /* its samples are checked one by one */
    const iso_sample *samples[] = {&touch->sample, &touch->previous, &touch->first};
    for (int i = 0; i < 3; i++) {
        const iso_sample *s = samples[i];
        double sum = s->position.x + s->position.y + s->position.z + s->normal.x + s->normal.y + s->normal.z;
        if (!isfinite(sum) || !(s->pressure >= 0 && s->pressure <= 1))
            return iso_fail(error, ISO_ERR_USAGE, "a sample at (%g, %g, %g) with pressure %g", s->position.x,
                            s->position.y, s->position.z, s->pressure);
    }
    if (brush->tool == ISO_TOOL_MOVE && !editor->opts.original)
        return iso_fail(error, ISO_ERR_USAGE, "move needs a step that keeps what it changes");
    const iso_stamp *stamp = editor->opts.stamp;
    if (brush->alpha != ISO_ALPHA_NONE && iso_tool_has_alpha(brush->tool) && !(stamp && stamp->heights.value))
        return iso_fail(error, ISO_ERR_USAGE, "a brush with an alpha needs a picture as its stamp");
    if (brush->tool == ISO_TOOL_MASK_VOXELS && !(stamp && stamp->voxels.word))
        return iso_fail(error, ISO_ERR_USAGE, "there are no voxels to freeze");
    if (brush->shape == ISO_SOLID_STAMP && iso_tool_is_set_operation(brush->tool) && !(stamp && stamp->count))
        return iso_fail(error, ISO_ERR_USAGE, "a stamp needs a shape of its own");
    return ISO_OK;
}

static void make_dabs(const iso_editor *editor, const iso_brush *brush, const iso_touch *touch,
                      iso_dabs *dabs) {
    const iso_dab_space space = {.affine = &editor->affine,
                                 .spacing = editor->spacing,
                                 .band = editor->transaction.grid->band,
                                 .stamp = editor->opts.stamp};
    iso_dabs_make(&space, brush, touch, dabs);
    if (iso_tool_has_area_plane(brush->tool)) iso_area_planes(editor->transaction.grid, dabs);
}

/* Removes one image of what a stroke outlines: carves it. */
static iso_status touch_outline(iso_editor *editor, const iso_brush *brush, const iso_outline *outline,
                                iso_edit_stats *stats, iso_error *error) {
    const iso_touch nowhere = {.path = NULL};
    iso_brush carve = *brush;
    iso_dabs dabs;
    carve.tool = brush->blend > 0 ? ISO_TOOL_BLEND_CARVE : ISO_TOOL_CARVE;
    carve.shape = ISO_SOLID_SPHERE;
    carve.symmetry = carve.radial = carve.repeat[0] = carve.repeat[1] = 0;
    carve.pressure_radius = carve.pressure_strength = false;
    make_dabs(editor, &carve, &nowhere, &dabs);
    dabs.outline = outline;
    const iso_status status = touch_field(editor, &dabs, stats, error);
    iso_painter_clear(&editor->painter);
    iso_transaction_clear(&editor->transaction);
    return status;
}

static iso_status trim(iso_editor *editor, const iso_brush *brush, const iso_touch *touch,
                       iso_edit_stats *stats, iso_error *error) {
    const iso_outline_space space = {.affine = &editor->affine, .spacing = editor->spacing};
    iso_brush_image images[ISO_IMAGES_MOST];
    const int count = iso_brush_images(brush, images);
    iso_status status = ISO_OK;
    for (int i = 0; i < count && status == ISO_OK; i++) {
        iso_outline outline;
        ISO_TRY(iso_outline_make(&space, brush->tool, &images[i], touch->path, touch->path_count, &outline,
                                 error));
        status = touch_outline(editor, brush, &outline, stats, error);
        iso_outline_free(&outline);
    }
    return status;
}

/* Computes the box of the voxels that a dab of a touch can read or write: `influence`, and around it what
 * redistancing changes (ISO_TRANSACTION_SPREAD) and reads; along x, whose rows are redistanced whole, it ends
 * with cells. A drag follows voxels back in steps of at most an eighth of the radius. */
static void reach_of_dab(const iso_editor *editor, const iso_dabs *dabs, const iso_dab *dab, int lo[3],
                         int hi[3]) {
    enum { READ = 3 };
    const bool segment = iso_tool_is_drag(dabs->tool) || dabs->solid == ISO_SOLID_CAPSULE;
    const double influence = iso_dabs_influence(dabs) + ISO_TRANSACTION_SPREAD +
                             (iso_tool_is_warp(dabs->tool) ? 0.25 * (double)dabs->radius_voxels + 2 : 0);
    for (int axis = 0; axis < 3; axis++) {
        const double a = dab->centre[axis], b = segment ? dab->from[axis] : a,
                     top = editor->transaction.grid->dims[axis] - 1;
        lo[axis] = (int)floor(fmax(fmin(fmin(a, b) - influence, top), 0));
        hi[axis] = (int)ceil(fmax(fmin(fmax(a, b) + influence, top), 0));
        if (axis == 0) {
            lo[0] -= lo[0] % ISO_BRICK;
            hi[0] += ISO_BRICK - 1 - hi[0] % ISO_BRICK;
        }
        lo[axis] = lo[axis] > READ ? lo[axis] - READ : 0;
        hi[axis] = hi[axis] + READ < (int)top ? hi[axis] + READ : (int)top;
    }
}

int iso_editor_ranges(const iso_editor *editor, const iso_brush *brush, const iso_touch *touch,
                      iso_editor_range ranges[ISO_EDITOR_RANGES]) {
    enum { RINGS = 2 };
    iso_dabs dabs;
    if (iso_tool_is_trim(brush->tool)) {
        for (int axis = 0; axis < 3; axis++) {
            ranges[0].cells.lo[axis] = ranges[0].voxels.lo[axis] = 0;
            ranges[0].cells.hi[axis] = editor->transaction.grid->cells[axis] - 1;
            ranges[0].voxels.hi[axis] = editor->transaction.grid->dims[axis] - 1;
        }
        return 1;
    }
    make_dabs(editor, brush, touch, &dabs);
    for (int i = 0; i < dabs.count; i++) {
        iso_index_box *cells = &ranges[i].cells;
        cell_range(editor, &dabs, &dabs.dab[i], cells->lo, cells->hi);
        for (int axis = 0; axis < 3; axis++) {
            const int last = editor->transaction.grid->cells[axis] - 1;
            cells->lo[axis] = cells->lo[axis] > RINGS ? cells->lo[axis] - RINGS : 0;
            cells->hi[axis] = cells->hi[axis] + RINGS < last ? cells->hi[axis] + RINGS : last;
        }
        reach_of_dab(editor, &dabs, &dabs.dab[i], ranges[i].voxels.lo, ranges[i].voxels.hi);
    }
    return dabs.count;
}

iso_status iso_editor_touch(iso_editor *editor, const iso_brush *brush, const iso_touch *touch,
                            iso_edit_stats *stats, iso_error *error) {
    ISO_TRY(check_touch(editor, brush, touch, error));
    iso_edit_stats made = {0};
    iso_status status = ISO_OK;
    if (iso_tool_is_trim(brush->tool)) {
        status = trim(editor, brush, touch, &made, error);
        if (status == ISO_OK && stats) *stats = made;
        return status;
    }
    iso_dabs dabs;
    make_dabs(editor, brush, touch, &dabs);
    if (brush->tool == ISO_TOOL_MASK || brush->tool == ISO_TOOL_UNMASK)
        status = touch_mask(editor, &dabs, error);
    else if (brush->tool == ISO_TOOL_BLUR_MASK || brush->tool == ISO_TOOL_MASK_VOXELS)
        status = rewrite_mask(editor, &dabs, error);
    else if (iso_tool_is_whole_mask(brush->tool))
        status = change_whole_mask(editor, brush->tool, error);
    else if (brush->tool == ISO_TOOL_PAINT)
        status = touch_paint(editor, &dabs, &made, error);
    else if (dabs.radius_voxels > 0) /* it is 0 at pressure 0 */
        status = touch_field(editor, &dabs, &made, error);
    iso_painter_clear(&editor->painter);
    iso_transaction_clear(&editor->transaction);
    if (status == ISO_OK && stats) *stats = made;
    return status;
}

double iso_editor_cost(const iso_editor *editor) {
    return editor->cost;
}

/* Marks every voxel that is not frozen as changed. */
static void change_all(const iso_transaction *transaction, iso_edit_cell *edit_cell) {
    const iso_voxel_bits *masked = iso_mask_bits(iso_transaction_mask(transaction), edit_cell->cell);
    for (int row = 0; row < ISO_BRICK_ROWS; row++)
        edit_cell->changed.row[row] = masked ? (uint16_t)~masked->row[row] : 0xffff;
    iso_transaction_find_box(edit_cell, &edit_cell->changed);
}

iso_status iso_editor_redistance(iso_editor *editor, int iterations, const iso_progress *progress,
                                 iso_error *error) {
    iso_transaction *transaction = &editor->transaction;
    iso_status status = ISO_OK;
    for (size_t cell = 0; cell < iso_hgrid_cell_count(transaction->grid) && status == ISO_OK; cell++) {
        int at[3];
        if (transaction->grid->cell[cell] < 0) continue;
        iso_hgrid_cell_position(transaction->grid, (size_t)cell, at);
        status = iso_transaction_add(transaction, at, true, error);
    }
    for (size_t i = 0; i < transaction->cell_count; i++)
        change_all(transaction, iso_transaction_cell(transaction, i));
    transaction->progress = progress;
    if (status == ISO_OK) status = iso_transaction_redistance(transaction, iterations, true, error);
    iso_edit_stats stats = {0};
    if (status == ISO_OK) status = iso_editor_commit(editor, &stats, error);
    iso_transaction_clear(transaction);
    return status;
}

/* ---- the mask */

bool iso_editor_masked(const iso_editor *editor, int x, int y, int z) {
    size_t cell = iso_hgrid_cell_index(editor->transaction.grid, x / ISO_BRICK, y / ISO_BRICK, z / ISO_BRICK);
    const iso_voxel_bits *bits = iso_mask_bits(iso_transaction_mask(&editor->transaction), cell);
    return bits && bits->row[z % ISO_BRICK * ISO_BRICK + y % ISO_BRICK] >> (x % ISO_BRICK) & 1;
}

bool iso_editor_has_mask(const iso_editor *editor) {
    return iso_transaction_mask(&editor->transaction)->used > 0;
}

iso_field_items *iso_editor_items(iso_editor *editor) {
    return &editor->transaction.items;
}

iso_change_log *iso_editor_paint_log(iso_editor *editor) {
    return editor->painter.log;
}

iso_status iso_editor_set_paint(iso_editor *editor, const iso_cell_items *paint, iso_error *error) {
    iso_cell_items copy;
    ISO_TRY(iso_cell_items_copy(paint, &copy, error));
    iso_cell_items_free(&editor->transaction.items.of[ISO_ITEM_PAINT]);
    editor->transaction.items.of[ISO_ITEM_PAINT] = copy;
    return ISO_OK;
}
