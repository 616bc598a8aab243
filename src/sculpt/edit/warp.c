/* Warps: the field that they read, a window of it or voxel by voxel, and the new values of a cell. */
#include <math.h>
#include <string.h>

#include "base/numbers.h"
#include "sculpt/edit/editor.h"

/* The largest window of the field, in floats, that is copied to warp one brick. A warp that needs more (a
 * long drag of a small brush) reads the grid voxel by voxel instead. */
enum { WINDOW_MAX = 1 << 22 };

/* Returns the values of a cell that a warp reads: for MOVE those when the step began, for the others the
 * current ones. */
static const float *source_of(const iso_editor *editor, iso_tool tool, uint32_t cell) {
    int32_t state = editor->transaction.grid->cell[cell];
    if (tool == ISO_TOOL_MOVE && editor->notified[cell] == editor->step) {
        const float *original = editor->opts.original(editor->opts.observer.context, cell, &state);
        if (original) return original;
    }
    return iso_transaction_grid_values(&editor->transaction, state);
}

/* Fills one row of a window: `count` voxels along x, beginning with voxel `first`. Beyond the grid its
 * outermost voxels are repeated. */
static void fill_window_row(const iso_editor *editor, iso_tool tool, const int first[3], int count,
                            float *out) {
    const iso_hgrid *grid = editor->transaction.grid;
    const int y = iso_clamp_index(first[1], grid->dims[1]), z = iso_clamp_index(first[2], grid->dims[2]);
    for (int i = 0, copied; i < count; i += copied) {
        const int x = iso_clamp_index(first[0] + i, grid->dims[0]), at = x % ISO_BRICK;
        const size_t cell = iso_hgrid_cell_index(grid, x / ISO_BRICK, y / ISO_BRICK, z / ISO_BRICK);
        const float *row = source_of(editor, tool, (uint32_t)cell) + (z % ISO_BRICK) * ISO_BRICK_ROWS +
                           (y % ISO_BRICK) * ISO_BRICK;
        copied = x != first[0] + i ? 1 : ISO_BRICK - at < count - i ? ISO_BRICK - at : count - i;
        memcpy(out + i, row + at, (size_t)copied * sizeof *out);
    }
}

/* Sets the window's box to all voxels that interpolation at the warp's positions reads. */
static void find_window_box(const iso_warp *warp, iso_field_window *window) {
    for (int axis = 0; axis < 3; axis++) {
        float low = warp->position[axis][0], high = low;
        for (int i = 1; i < ISO_BRICK_VOXELS; i++) {
            const float p = warp->position[axis][i];
            low = p < low ? p : low;
            high = p > high ? p : high;
        }
        window->lo[axis] = (int)floorf(low);
        window->size[axis] = (int)floorf(high) - window->lo[axis] + 2;
    }
}

static bool window_is_too_large(const iso_field_window *window) {
    return (double)window->size[0] * window->size[1] * window->size[2] > WINDOW_MAX;
}

/* Interpolates linearly, with the same arithmetic as the kernels, so that results are the same to the bit. */
static float mix(float a, float b, float t) {
    return a * (1 - t) + b * t;
}

/* Returns a voxel of the field that a warp reads. Beyond the grid its outermost voxels are repeated. */
static float value_at(const iso_editor *editor, iso_tool tool, const int at[3]) {
    const iso_hgrid *grid = editor->transaction.grid;
    int p[3];
    for (int axis = 0; axis < 3; axis++) p[axis] = iso_clamp_index(at[axis], grid->dims[axis]);
    const size_t cell = iso_hgrid_cell_index(grid, p[0] / ISO_BRICK, p[1] / ISO_BRICK, p[2] / ISO_BRICK);
    return source_of(editor, tool, (uint32_t)cell)[(p[2] % ISO_BRICK) * ISO_BRICK_ROWS +
                                                   (p[1] % ISO_BRICK) * ISO_BRICK + p[0] % ISO_BRICK];
}

/* Computes what the kernel's `sample` computes, to the bit, but reads the grid voxel by voxel instead of a
 * window. */
static void sample_without_window(const iso_editor *editor, iso_tool tool, const int brick[3],
                                  const iso_warp *warp, const iso_field_window *window, float *out) {
    for (int i = 0; i < ISO_BRICK_VOXELS; i++) {
        float part[3], row[4];
        int first[3];
        for (int axis = 0; axis < 3; axis++) {
            const float p = warp->position[axis][i] - (float)window->lo[axis], whole = floorf(p);
            part[axis] = p - whole;
            first[axis] = ISO_BRICK * brick[axis] + window->lo[axis] + (int)whole;
        }
        for (int k = 0; k < 4; k++) {
            const int a[3] = {first[0], first[1] + (k & 1), first[2] + (k >> 1)},
                      b[3] = {a[0] + 1, a[1], a[2]};
            row[k] = mix(value_at(editor, tool, a), value_at(editor, tool, b), part[0]);
        }
        out[i] = mix(mix(row[0], row[1], part[1]), mix(row[2], row[3], part[1]), part[2]);
    }
}

bool iso_editor_fill_window(const iso_editor *editor, iso_tool tool, const int brick[3],
                            iso_field_window *window, iso_buffer *buffer) {
    size_t row = (size_t)window->size[0], rows = (size_t)window->size[1] * (size_t)window->size[2];
    if (iso_buffer_reserve(buffer, row * rows * sizeof(float), 0, NULL) != ISO_OK) return false;
    float *out = buffer->data;
    window->values = out;
    for (size_t i = 0; i < rows; i++) {
        const int first[3] = {ISO_BRICK * brick[0] + window->lo[0],
                              ISO_BRICK * brick[1] + window->lo[1] + (int)(i % (size_t)window->size[1]),
                              ISO_BRICK * brick[2] + window->lo[2] + (int)(i / (size_t)window->size[1])};
        fill_window_row(editor, tool, first, window->size[0], out + i * row);
    }
    return true;
}

bool iso_editor_warp_cell(const iso_editor *editor, const iso_dabs *dabs, iso_edit_cell *edit_cell,
                          iso_worker_scratch *scratch, float *out) {
    const iso_tool tool = dabs->tool;
    edit_cell->source = source_of(editor, tool, edit_cell->cell);
    if (!editor->transaction.dab->warp(dabs, edit_cell->at, &scratch->warp)) {
        memcpy(out, edit_cell->source, ISO_BRICK_VOXELS * sizeof(float));
        return false;
    }
    iso_field_window window;
    find_window_box(&scratch->warp, &window);
    if (window_is_too_large(&window))
        sample_without_window(editor, tool, edit_cell->at, &scratch->warp, &window, out);
    else if (iso_editor_fill_window(editor, tool, edit_cell->at, &window, &scratch->window))
        editor->transaction.dab->sample(&scratch->warp, &window, out);
    else
        scratch->failed = true;
    return true;
}

const iso_paint_item *iso_editor_paint_source(const void *context, uint32_t cell) {
    const iso_editor *editor = context;
    const iso_paint_item *now =
        (const iso_paint_item *)editor->transaction.items.of[ISO_ITEM_PAINT].cell[cell];
    if (editor->painter.dabs->tool != ISO_TOOL_MOVE || !editor->opts.original_paint ||
        editor->item_notified[ISO_ITEM_PAINT][cell] != editor->step)
        return now;
    bool kept = false;
    const iso_paint_item *original = editor->opts.original_paint(editor->opts.observer.context, cell, &kept);
    return kept ? original : now;
}
