/* Stores undo steps. While a step is open, the old content of its cells lies unpacked in slabs; ending the
 * step packs it. Undo and redo exchange the content of a step with that of the grid, so each step is stored
 * once. */
#include "sculpt/session/history.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "base/memory.h"
#include "base/temporary_file.h"
#include "sculpt/field/cell_pack.h"
#include "sculpt/field/slabs.h"

static const size_t DEFAULT_MEMORY = (size_t)1 << 30;

/* What is saved of a cell: its distances, or its item of a kind (1 + the kind). */
enum { DISTANCES = 0, PARTS = 1 + ISO_ITEM_KINDS };
/* A value of saved_cell.state beside ISO_CELL_OUTSIDE (there is no item) and ISO_CELL_INSIDE: a brick or an
 * item. */
enum { CONTENT = 0 };

/* A part of a cell in a step. */
typedef struct saved_cell {
    uint32_t cell;
    int16_t part, state;
    size_t first, size; /* range of the step's packed bytes; in the open step `first` is the index of an
                           unpacked brick or item */
} saved_cell;

/* Cost of restoring parts of a cell; that of its distances is 1. */
static const double COST[PARTS] = {1, 1.0 / 64, 1.0 / 2};

/* A step: the content of its cells before the step or, while the step is undone, after it. */
typedef struct step {
    char *name;
    saved_cell *cells;
    size_t count;
    uint8_t *bytes; /* NULL while they are in the spill file */
    size_t size;
    long long offset; /* of the bytes in the spill file */
} step;

struct iso_history {
    iso_hgrid *grid;
    iso_field_items *items;
    iso_change_log *paint_log;
    void (*before_write)(void *context, uint32_t cell);
    void *context;
    size_t memory, used; /* limit and present number of bytes of steps in memory */
    char *beside;        /* iso_history_opts.beside */
    FILE *file;
    long long file_size;
    step *steps;
    size_t count, room, position;
    /* of the open step: */
    bool open, keep;
    char *name;
    uint32_t *copy_of[PARTS]; /* by cell: 1 + the index of the part in `copies`, 0: not saved */
    saved_cell *copies;
    size_t copy_count, copy_room;
    iso_slabs raw;
    iso_buffer raw_items; /* void *: items, shared */
    size_t raw_count, raw_item_count;
};

static char *duplicate(const char *text) {
    size_t size = strlen(text) + 1;
    char *copy = iso_alloc(size);
    if (copy) memcpy(copy, text, size);
    return copy;
}

iso_status iso_history_create(iso_hgrid *grid, const iso_history_opts *opts, iso_history **out,
                              iso_error *error) {
    iso_history *history = iso_alloc_zero(1, sizeof *history);
    if (!history) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for the undo history");
    history->grid = grid;
    history->items = opts->items;
    history->paint_log = opts->paint_log;
    history->before_write = opts->before_write;
    history->context = opts->context;
    history->memory = opts->memory ? opts->memory : DEFAULT_MEMORY;
    bool whole = true;
    for (int part = 0; part < PARTS; part++) {
        history->copy_of[part] = iso_alloc_zero(iso_hgrid_cell_count(grid), sizeof *history->copy_of[part]);
        whole &= history->copy_of[part] != NULL;
    }
    if (opts->beside) history->beside = duplicate(opts->beside);
    iso_status room = iso_slabs_reserve(&history->raw, 1, NULL);
    iso_slabs_prefault(&history->raw);
    if (!whole || (opts->beside && !history->beside) || room != ISO_OK) {
        iso_history_destroy(history);
        return iso_fail(error, ISO_ERR_NOMEM, "out of memory for the undo history of %zu cells",
                        iso_hgrid_cell_count(grid));
    }
    *out = history;
    return ISO_OK;
}

static void free_step(iso_history *history, step *s) {
    if (s->bytes) history->used -= s->size;
    iso_free(s->name);
    iso_free(s->cells);
    iso_free(s->bytes);
}

static void close_step(iso_history *history) {
    for (size_t i = 0; i < history->copy_count; i++)
        history->copy_of[history->copies[i].part][history->copies[i].cell] = 0;
    for (size_t i = 0; i < history->raw_item_count; i++)
        iso_item_release(((void **)history->raw_items.data)[i]);
    history->copy_count = history->raw_count = history->raw_item_count = 0;
    history->open = history->keep = false;
    iso_free(history->name);
    history->name = NULL;
}

void iso_history_destroy(iso_history *history) {
    if (!history) return;
    for (size_t i = 0; i < history->count; i++) free_step(history, &history->steps[i]);
    if (history->copies) close_step(history);
    if (history->file) fclose(history->file);
    iso_free(history->beside);
    iso_free(history->name);
    iso_free(history->steps);
    iso_free(history->copies);
    for (int part = 0; part < PARTS; part++) iso_free(history->copy_of[part]);
    iso_slabs_free(&history->raw);
    iso_buffer_free(&history->raw_items);
    iso_free(history);
}

/* ---- the spill file */

static bool open_file(iso_history *history) {
    if (history->file || !history->beside) return history->file != NULL;
    const int file = iso_temporary_file_beside(history->beside);
    if (file < 0) return false;
    history->file = fdopen(file, "w+b");
    if (!history->file) close(file);
    return history->file != NULL;
}

/* Moves the bytes of a step to the file. Returns false if the file cannot be written; the bytes then stay in
 * memory. */
static bool spill(iso_history *history, step *s) {
    if (!open_file(history) || fseeko(history->file, (off_t)history->file_size, SEEK_SET)) return false;
    if (fwrite(s->bytes, 1, s->size, history->file) != s->size || fflush(history->file)) return false;
    s->offset = history->file_size;
    history->file_size += (long long)s->size;
    history->used -= s->size;
    iso_free(s->bytes);
    s->bytes = NULL;
    return true;
}

/* Spills steps, oldest first, until the others fit into memory. The step that the next undo needs is never
 * spilled. */
static void spill_excess(iso_history *history) {
    for (size_t i = 0; i < history->count && history->used > history->memory; i++) {
        step *s = &history->steps[i];
        if (!s->bytes || i + 1 == history->position) continue;
        if (!spill(history, s)) return;
    }
}

/* Room for any part of a cell. */
typedef union content {
    float brick[ISO_BRICK_VOXELS];
    iso_voxel_bits mask;
    iso_paint_item item;
} content;

static iso_cell_items *items_of(const iso_history *history, const saved_cell *cell) {
    return &history->items->of[cell->part - 1];
}

/* Restores a part with the state CONTENT from the packed bytes of its step. False: they are damaged. */
static bool unpack(const iso_history *history, const saved_cell *cell, const uint8_t *bytes, void *to) {
    if (cell->part == DISTANCES)
        return iso_cell_unpack(bytes + cell->first, cell->size, history->grid->band, to);
    return iso_item_unpack(bytes + cell->first, cell->size, items_of(history, cell)->bytes, to);
}

/* Reads a spilled step back into memory. */
static iso_status read_back(iso_history *history, step *s, iso_error *error) {
    if (s->bytes || !s->size) return ISO_OK;
    uint8_t *bytes = iso_alloc(s->size);
    if (!bytes) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for a step of %zu bytes", s->size);
    if (fseeko(history->file, (off_t)s->offset, SEEK_SET) ||
        fread(bytes, 1, s->size, history->file) != s->size) {
        iso_free(bytes);
        return iso_fail(error, ISO_ERR_IO, "cannot read step '%s' back from the file beside '%s'", s->name,
                        history->beside);
    }
    for (size_t i = 0; i < s->count; i++) {
        const saved_cell *c = &s->cells[i];
        if (c->state != CONTENT || unpack(history, c, bytes, &(content){.item = {{0}}})) continue;
        iso_free(bytes);
        return iso_fail(error, ISO_ERR_IO, "step '%s' is damaged in the file beside '%s'", s->name,
                        history->beside);
    }
    s->bytes = bytes;
    history->used += s->size;
    return ISO_OK;
}

/* ---- packing */

/* Returns the values or the item of a cell: those of `copy`, which belongs to the open step, or the present
 * ones if `copy` is NULL. */
static const void *find_content(const iso_history *history, const saved_cell *cell, const saved_cell *copy) {
    if (cell->part != DISTANCES && !copy) return items_of(history, cell)->cell[cell->cell];
    if (cell->part != DISTANCES)
        return copy->state == CONTENT ? ((void **)history->raw_items.data)[copy->first] : NULL;
    return copy ? iso_slabs_get(&history->raw, copy->first)
                : iso_hgrid_brick(history->grid, history->grid->cell[cell->cell]);
}

/* Packs the parts of the cells of step `s`. They are read from `copies`, which preserve what the cells held
 * before the open step, or from the grid if `copies` is NULL. ISO_ERR_NOMEM. */
static iso_status pack_cells(const iso_history *history, step *s, const saved_cell *copies,
                             iso_error *error) {
    const float band = history->grid->band;
    size_t total = 0;
    for (size_t i = 0; i < s->count; i++) {
        saved_cell *c = &s->cells[i];
        const void *from = c->state == CONTENT ? find_content(history, c, copies ? &copies[i] : NULL) : NULL;
        c->size = !from                  ? 0
                  : c->part == DISTANCES ? iso_cell_pack_size(from, band)
                                         : iso_item_pack_size(from, items_of(history, c)->bytes);
        c->first = total;
        total += c->size;
    }
    s->bytes = iso_alloc(total);
    if (!s->bytes)
        return iso_fail(error, ISO_ERR_NOMEM, "out of memory for an undo step of %zu bytes", total);
    s->size = total;
    for (size_t i = 0; i < s->count; i++) {
        const saved_cell *c = &s->cells[i];
        if (!c->size) continue;
        const void *from = find_content(history, c, copies ? &copies[i] : NULL);
        if (c->part == DISTANCES)
            iso_cell_pack(from, band, s->bytes + c->first);
        else
            iso_item_pack(from, items_of(history, c)->bytes, s->bytes + c->first);
    }
    return ISO_OK;
}

/* Allocates the items that will be restored, so that restore_item cannot fail. */
static iso_status reserve_items(iso_history *history, const saved_cell *cells, size_t count,
                                iso_error *error) {
    for (size_t i = 0; i < count; i++)
        if (cells[i].part != DISTANCES && cells[i].state == CONTENT)
            ISO_TRY(iso_cell_items_reserve(items_of(history, &cells[i]), cells[i].cell, error));
    return ISO_OK;
}

/* Frees the items that reserve_items allocated, if they were not written. */
static void release_items(iso_history *history, const saved_cell *cells, size_t count) {
    for (size_t i = 0; i < count; i++) {
        if (cells[i].part == DISTANCES) continue;
        iso_cell_items *items = items_of(history, &cells[i]);
        iso_cell_items_set(items, cells[i].cell, items->cell[cells[i].cell], NULL);
    }
}

/* Does the part of restoring cells that can fail: adds them to the change logs and allocates bricks. */
static iso_status prepare_restore(iso_history *history, const saved_cell *cells, size_t count,
                                  iso_error *error) {
    iso_change_log_begin(history->grid->log);
    if (history->paint_log) iso_change_log_begin(history->paint_log);
    for (size_t i = 0; i < count; i++) {
        int at[3], lo[3], hi[3];
        float *brick;
        const bool paint = cells[i].part == 1 + ISO_ITEM_PAINT;
        if (cells[i].part != DISTANCES && !(paint && history->paint_log)) continue;
        iso_hgrid_cell_position(history->grid, cells[i].cell, at);
        for (int axis = 0; axis < 3; axis++) {
            lo[axis] = ISO_BRICK * at[axis];
            hi[axis] = lo[axis] + ISO_BRICK - 1;
        }
        ISO_TRY(iso_change_log_add(paint ? history->paint_log : history->grid->log, lo, hi, error));
        if (!paint && cells[i].state == CONTENT)
            ISO_TRY(iso_hgrid_split(history->grid, at[0], at[1], at[2], &brick, error));
    }
    return ISO_OK;
}

/* Cannot fail: reserve_items has allocated the item. */
static void restore_item(iso_history *history, const saved_cell *cell, const uint8_t *bytes) {
    content room;
    const bool any = cell->state == CONTENT;
    if (any && bytes) unpack(history, cell, bytes, &room);
    const void *item = bytes ? &room : find_content(history, cell, cell);
    iso_cell_items_set(items_of(history, cell), cell->cell, any ? item : NULL, NULL);
}

static void restore_empty_cell(iso_history *history, const saved_cell *cell) {
    int at[3];
    iso_hgrid_cell_position(history->grid, cell->cell, at);
    iso_hgrid_coalesce(history->grid, at[0], at[1], at[2], cell->state);
}

/* Restores cells from packed bytes or, if `bytes` is NULL, from the open step's copies. */
static iso_status restore_cells(iso_history *history, const saved_cell *cells, size_t count,
                                const uint8_t *bytes, iso_error *error) {
    for (size_t i = 0; history->before_write && i < count; i++)
        if (cells[i].part == DISTANCES) history->before_write(history->context, cells[i].cell);
    iso_status status = reserve_items(history, cells, count, error);
    if (status == ISO_OK) status = prepare_restore(history, cells, count, error);
    if (status != ISO_OK) {
        release_items(history, cells, count);
        return status;
    }
    for (size_t i = 0; i < count; i++) {
        const saved_cell *c = &cells[i];
        if (c->part != DISTANCES) {
            restore_item(history, c, bytes);
            continue;
        }
        if (c->state != CONTENT) {
            restore_empty_cell(history, c);
            continue;
        }
        float *values = iso_hgrid_brick(history->grid, history->grid->cell[c->cell]);
        if (bytes)
            unpack(history, c, bytes, values);
        else
            memcpy(values, find_content(history, c, c), ISO_BRICK_VOXELS * sizeof(float));
    }
    return ISO_OK;
}

/* ---- steps */

static void discard_undone(iso_history *history) {
    while (history->count > history->position) free_step(history, &history->steps[--history->count]);
}

iso_status iso_history_begin(iso_history *history, const char *name, iso_error *error) {
    if (history->open) return iso_fail(error, ISO_ERR_USAGE, "a step is open already: '%s'", history->name);
    history->name = duplicate(name);
    if (!history->name) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for an undo step");
    history->open = true;
    return ISO_OK;
}

static iso_status make_copy_room(iso_history *history, iso_error *error) {
    if (history->copy_count < history->copy_room) return ISO_OK;
    size_t room = history->copy_room ? 2 * history->copy_room : 256;
    saved_cell *copies = iso_alloc(room * sizeof *copies);
    if (!copies) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for an undo step of %zu cells", room);
    if (history->copies) memcpy(copies, history->copies, history->copy_count * sizeof *copies);
    iso_free(history->copies);
    history->copies = copies;
    history->copy_room = room;
    return ISO_OK;
}

/* Makes room for one more item of `size` bytes in a buffer of `count` items. */
static iso_status make_room(iso_buffer *buffer, size_t count, size_t size, iso_error *error) {
    return iso_buffer_reserve(buffer, (count + 1) * size, count * size, error);
}

/* iso_write_observer.before: saves the values of a cell in the open step. */
static iso_status keep_cell(void *context, uint32_t cell, int32_t state, const float *brick,
                            iso_error *error) {
    iso_history *history = context;
    const size_t size = ISO_BRICK_VOXELS * sizeof(float);
    if (history->copy_of[DISTANCES][cell]) return ISO_OK;
    if (history->before_write) history->before_write(history->context, cell);
    ISO_TRY(make_copy_room(history, error));
    if (brick) ISO_TRY(iso_slabs_reserve(&history->raw, history->raw_count + 1, error));
    saved_cell *copy = &history->copies[history->copy_count++];
    *copy =
        (saved_cell){.cell = cell, .state = brick ? CONTENT : (int16_t)state, .first = history->raw_count};
    if (brick) memcpy(iso_slabs_get(&history->raw, history->raw_count++), brick, size);
    history->copy_of[DISTANCES][cell] = (uint32_t)history->copy_count;
    return ISO_OK;
}

/* iso_write_observer.item_before: shares the item of a cell with the open step. */
static iso_status keep_item(void *context, iso_item_kind kind, uint32_t cell, void *item, iso_error *error) {
    iso_history *history = context;
    ISO_TRY(make_copy_room(history, error));
    if (item) ISO_TRY(make_room(&history->raw_items, history->raw_item_count, sizeof item, error));
    saved_cell *copy = &history->copies[history->copy_count++];
    *copy = (saved_cell){.cell = cell,
                         .part = (int16_t)(1 + kind),
                         .state = item ? CONTENT : ISO_CELL_OUTSIDE,
                         .first = history->raw_item_count};
    if (item) ((void **)history->raw_items.data)[history->raw_item_count++] = iso_item_share(item);
    history->copy_of[copy->part][cell] = (uint32_t)history->copy_count;
    return ISO_OK;
}

/* iso_step_opts.original. */
static const float *cell_before_step(void *context, uint32_t cell, int32_t *state) {
    const iso_history *history = context;
    if (!history->copy_of[DISTANCES][cell]) return NULL;
    const saved_cell *copy = &history->copies[history->copy_of[DISTANCES][cell] - 1];
    if (copy->state == CONTENT) return iso_slabs_get(&history->raw, copy->first);
    *state = copy->state;
    return NULL;
}

/* iso_step_opts.original_paint. */
static const iso_paint_item *paint_before_step(void *context, uint32_t cell, bool *kept) {
    const iso_history *history = context;
    const uint32_t number = history->copy_of[1 + ISO_ITEM_PAINT][cell];
    *kept = number > 0;
    if (!number) return NULL;
    const saved_cell *copy = &history->copies[number - 1];
    return (const iso_paint_item *)find_content(history, copy, copy);
}

iso_step_opts iso_history_step_opts(iso_history *history) {
    return (iso_step_opts){.observer = {keep_cell, history->items ? keep_item : NULL, history},
                           .original = cell_before_step,
                           .original_paint = paint_before_step};
}

static iso_status make_step_room(iso_history *history, iso_error *error) {
    if (history->position < history->room) return ISO_OK;
    size_t room = history->room ? 2 * history->room : 64;
    step *steps = iso_alloc(room * sizeof *steps);
    if (!steps) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for %zu undo steps", room);
    if (history->steps) memcpy(steps, history->steps, history->count * sizeof *steps);
    iso_free(history->steps);
    history->steps = steps;
    history->room = room;
    return ISO_OK;
}

size_t iso_history_open_cells(const iso_history *history) {
    return history->copy_count;
}

void iso_history_keep(iso_history *history) {
    history->keep = true;
}

void iso_history_forget(iso_history *history) {
    close_step(history);
}

iso_status iso_history_end(iso_history *history, iso_error *error) {
    if (!history->open) return iso_fail(error, ISO_ERR_USAGE, "no step is open");
    if (history->copy_count == 0 && !history->keep) { /* the step changed nothing */
        close_step(history);
        return ISO_OK;
    }
    ISO_TRY(make_step_room(history, error));
    step made = {.count = history->copy_count};
    made.cells = iso_alloc(made.count * sizeof *made.cells);
    if (!made.cells)
        return iso_fail(error, ISO_ERR_NOMEM, "out of memory for an undo step of %zu cells", made.count);
    memcpy(made.cells, history->copies, made.count * sizeof *made.cells);
    iso_status status = pack_cells(history, &made, history->copies, error);
    if (status != ISO_OK) {
        iso_free(made.cells);
        return status;
    }
    made.name = history->name;
    history->name = NULL;
    discard_undone(history);
    history->steps[history->count++] = made;
    history->position = history->count;
    history->used += made.size;
    close_step(history);
    spill_excess(history);
    return ISO_OK;
}

iso_status iso_history_cancel(iso_history *history, iso_error *error) {
    if (!history->open) return iso_fail(error, ISO_ERR_USAGE, "no step is open");
    if (history->copy_count)
        ISO_TRY(restore_cells(history, history->copies, history->copy_count, NULL, error));
    close_step(history);
    return ISO_OK;
}

static int16_t state_now(const iso_history *history, const saved_cell *cell) {
    if (cell->part != DISTANCES)
        return items_of(history, cell)->cell[cell->cell] ? CONTENT : ISO_CELL_OUTSIDE;
    int32_t state = history->grid->cell[cell->cell];
    return state >= 0 ? CONTENT : (int16_t)state;
}

/* Exchanges the content of a step with that of the grid. */
static iso_status exchange(iso_history *history, step *s, iso_error *error) {
    ISO_TRY(read_back(history, s, error));
    step now = {.count = s->count, .cells = iso_alloc(s->count * sizeof *now.cells)};
    if (!now.cells) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for undoing %zu cells", s->count);
    for (size_t i = 0; i < s->count; i++)
        now.cells[i] = (saved_cell){
            .cell = s->cells[i].cell, .part = s->cells[i].part, .state = state_now(history, &s->cells[i])};
    iso_status status = pack_cells(history, &now, NULL, error);
    if (status == ISO_OK) status = restore_cells(history, s->cells, s->count, s->bytes, error);
    if (status != ISO_OK) {
        iso_free(now.cells);
        iso_free(now.bytes);
        return status;
    }
    history->used += now.size - s->size;
    iso_free(s->cells);
    iso_free(s->bytes);
    s->cells = now.cells;
    s->bytes = now.bytes;
    s->size = now.size;
    return ISO_OK;
}

iso_status iso_history_undo(iso_history *history, iso_error *error) {
    if (history->open) return iso_fail(error, ISO_ERR_USAGE, "cannot undo while a step is open");
    if (!history->position) return iso_fail(error, ISO_ERR_USAGE, "there is nothing to undo");
    ISO_TRY(exchange(history, &history->steps[history->position - 1], error));
    history->position--;
    spill_excess(history);
    return ISO_OK;
}

iso_status iso_history_redo(iso_history *history, iso_error *error) {
    if (history->open) return iso_fail(error, ISO_ERR_USAGE, "cannot redo while a step is open");
    if (history->position == history->count)
        return iso_fail(error, ISO_ERR_USAGE, "there is nothing to redo");
    ISO_TRY(exchange(history, &history->steps[history->position], error));
    history->position++;
    spill_excess(history);
    return ISO_OK;
}

static iso_status restore_copy(const step *s, iso_hgrid *copy, iso_error *error) {
    for (size_t i = 0; i < s->count; i++) {
        const saved_cell *c = &s->cells[i];
        int at[3];
        float *brick;
        if (c->part != DISTANCES) continue;
        iso_hgrid_cell_position(copy, c->cell, at);
        if (c->state == CONTENT) {
            ISO_TRY(iso_hgrid_split(copy, at[0], at[1], at[2], &brick, error));
            iso_cell_unpack(s->bytes + c->first, c->size, copy->band, brick);
        } else
            iso_hgrid_coalesce(copy, at[0], at[1], at[2], c->state);
    }
    return ISO_OK;
}

iso_status iso_history_first(iso_history *history, iso_hgrid *copy, iso_error *error) {
    iso_status status = ISO_OK;
    for (size_t i = history->position; status == ISO_OK && i-- > 0;) {
        step *s = &history->steps[i];
        const bool spilled = s->size && !s->bytes;
        status = read_back(history, s, error);
        if (status == ISO_OK) status = restore_copy(s, copy, error);
        if (!spilled || !s->bytes) continue;
        iso_free(s->bytes); /* it is in the file still */
        s->bytes = NULL;
        history->used -= s->size;
    }
    return status;
}

iso_status iso_history_clear(iso_history *history, iso_error *error) {
    if (history->open) return iso_fail(error, ISO_ERR_USAGE, "cannot forget steps while one is open");
    history->position = 0;
    discard_undone(history);
    return ISO_OK;
}

size_t iso_history_count(const iso_history *history) {
    return history->count;
}
size_t iso_history_position(const iso_history *history) {
    return history->position;
}
double iso_history_cost(const iso_history *history, size_t number) {
    const step *s = &history->steps[number];
    double cost = 0;
    for (size_t i = 0; i < s->count; i++) cost += COST[s->cells[i].part];
    return cost;
}
const char *iso_history_name(const iso_history *history, size_t number) {
    return history->steps[number].name;
}
size_t iso_history_bytes(const iso_history *history) {
    return history->used;
}
size_t iso_history_spilled(const iso_history *history) {
    return (size_t)history->file_size;
}
