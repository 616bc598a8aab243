/* The end of a stroke: corrects the distances beside creases in the cells that it changed (crease.h). */
#include <string.h>

#include "sculpt/edit/editor.h"
#include "sculpt/field/crease.h"

/* Fills the window around a cell from which creases are corrected. Away from the grid's border its rows are
 * parts of the rows of three cells. */
static bool fill_crease_window(const iso_editor *editor, const int at[3], iso_field_window *window,
                               iso_buffer *buffer) {
    enum { M = ISO_CREASE_MARGIN, SIDE = ISO_CREASE_SIDE };
    const iso_hgrid *grid = editor->transaction.grid;
    const float *cells[3][3][3];
    for (int axis = 0; axis < 3; axis++)
        if (at[axis] == 0 || at[axis] == grid->cells[axis] - 1)
            return iso_editor_fill_window(editor, ISO_TOOL_ADD, at, window, buffer);
    if (iso_buffer_reserve(buffer, SIDE * SIDE * SIDE * sizeof(float), 0, NULL) != ISO_OK) return false;
    for (int i = 0; i < 27; i++) {
        const size_t cell =
            iso_hgrid_cell_index(grid, at[0] + i % 3 - 1, at[1] + i / 3 % 3 - 1, at[2] + i / 9 - 1);
        cells[i / 9][i / 3 % 3][i % 3] = iso_transaction_grid_values(&editor->transaction, grid->cell[cell]);
    }
    float *out = buffer->data;
    window->values = out;
    for (int i = 0; i < SIDE * SIDE; i++, out += SIDE) {
        const int y = i % SIDE - M + ISO_BRICK, z = i / SIDE - M + ISO_BRICK;
        const float *const *row = cells[z / ISO_BRICK][y / ISO_BRICK];
        const int from = z % ISO_BRICK * ISO_BRICK_ROWS + y % ISO_BRICK * ISO_BRICK;
        memcpy(out, row[0] + from + ISO_BRICK - M, M * sizeof *out);
        memcpy(out + M, row[1] + from, ISO_BRICK * sizeof *out);
        memcpy(out + M + ISO_BRICK, row[2] + from, M * sizeof *out);
    }
    return true;
}

/* Corrects a cell: writes it to `out` if it has a crease near. */
static void correct_cell(const iso_editor *editor, const int at[3], iso_worker_scratch *scratch, float *out,
                         bool *any) {
    enum { M = ISO_CREASE_MARGIN, SIDE = ISO_CREASE_SIDE };
    iso_field_window window = {.lo = {-M, -M, -M}, .size = {SIDE, SIDE, SIDE}};
    *any = false;
    scratch->failed |= !fill_crease_window(editor, at, &window, &scratch->window);
    if (scratch->failed) return;
    scratch->failed = iso_crease_correct(window.values, editor->transaction.grid->band, &scratch->edge_points,
                                         out, any) != ISO_OK;
}

static void correct_creases(void *context, size_t index, int worker) {
    iso_editor *editor = context;
    iso_transaction *transaction = &editor->transaction;
    iso_edit_cell *edit_cell = iso_transaction_cell(transaction, index);
    bool any;
    correct_cell(editor, edit_cell->at, &transaction->workers[worker],
                 iso_transaction_scratch_brick(transaction, worker), &any);
    if (transaction->workers[worker].failed) return;
    edit_cell->edited = any;
    if (any) iso_transaction_accept_scratch(transaction, index, worker);
}

static iso_status finalize_cells(iso_editor *editor, iso_error *error) {
    iso_transaction *transaction = &editor->transaction;
    bool any;
    const uint32_t *notified = editor->notified_cells.data;
    for (size_t i = 0; i < editor->notified_count; i++) {
        int at[3];
        if (transaction->grid->cell[notified[i]] < 0) continue; /* distances at the band's end stay there */
        iso_hgrid_cell_position(transaction->grid, notified[i], at);
        ISO_TRY(iso_transaction_add(transaction, at, true, error));
    }
    ISO_TRY(iso_transaction_reserve(transaction, error));
    iso_parallel_for(transaction->pool, transaction->cell_count, correct_creases, editor);
    if (iso_transaction_failed(transaction))
        return iso_fail(error, ISO_ERR_NOMEM, "out of memory for a stroke's end");
    editor->cost += 4 * (double)transaction->cell_count;
    ISO_TRY(iso_transaction_end_brush(transaction, false, &any, error));
    iso_edit_stats stats = {0};
    return any ? iso_editor_commit(editor, &stats, error) : ISO_OK;
}

iso_status iso_editor_finalize(iso_editor *editor, iso_error *error) {
    iso_status status = finalize_cells(editor, error);
    iso_transaction_clear(&editor->transaction);
    return status;
}

typedef struct correction {
    iso_editor *editor;
    const uint32_t *cells;
    float *bricks;
    bool *any;
} correction;

static void correct_alone(void *context, size_t index, int worker) {
    const correction *c = context;
    iso_worker_scratch *scratch = &c->editor->transaction.workers[worker];
    int at[3];
    iso_hgrid_cell_position(c->editor->transaction.grid, c->cells[index], at);
    correct_cell(c->editor, at, scratch, c->bricks + index * ISO_BRICK_VOXELS, &c->any[index]);
}

iso_status iso_editor_correct(iso_editor *editor, const uint32_t *cells, size_t count, float *bricks,
                              bool *any, iso_error *error) {
    correction c = {editor, cells, bricks, any};
    iso_parallel_for(editor->transaction.pool, count, correct_alone, &c);
    editor->cost += 4 * (double)count;
    return iso_transaction_failed(&editor->transaction)
               ? iso_fail(error, ISO_ERR_NOMEM, "out of memory for a stroke's end")
               : ISO_OK;
}
