/* Stores the changes of a grid and the last edit of each cell (docs/ARCHITECTURE.md, decision 4).
 *
 * The log may hold BUDGET_PER_CELL entries for each cell that ever changed (at least BUDGET_MIN). Beyond that
 * its older half is sorted by cell and merged. If T cells have changed, half of 4 T entries becomes at most
 * T, so every merge frees at least T entries, and sorting costs O(log T) an entry over the log's life. No
 * step looks at cells that never changed. At 24 bytes an entry the log takes less than 1 % of the bricks'
 * memory. */
#include "grids/change_log.h"

#include <stdbool.h>
#include <stdlib.h>

#include "base/memory.h"
#include "base/primitives.h"

enum { BUDGET_MIN = 4096, BUDGET_PER_CELL = 4, COALESCE_DEPTH = 8 };

struct iso_change_log {
    int cells[3];
    uint64_t now;
    uint64_t *edit;       /* by cell: its last edit; pages of unchanged cells stay unallocated */
    size_t changed_cells; /* number of cells that have an edit */
    iso_buffer entries;
    size_t count;
};

static iso_change *entries_of(const iso_change_log *log) {
    return log->entries.data;
}

iso_status iso_change_log_create(const int cells[3], iso_change_log **out, iso_error *error) {
    size_t total = 1;
    for (int axis = 0; axis < 3; axis++) {
        if (cells[axis] < 1)
            return iso_fail(error, ISO_ERR_USAGE, "change log: %d cells along axis %d", cells[axis], axis);
        if (!iso_size_multiply(total, (size_t)cells[axis], &total) || total > UINT32_MAX)
            return iso_fail(error, ISO_ERR_LIMIT, "change log: %d x %d x %d cells are 2^32 or more", cells[0],
                            cells[1], cells[2]);
    }
    iso_change_log *log = iso_alloc_zero(1, sizeof *log);
    uint64_t *edit = iso_alloc_zero(total, sizeof *edit);
    if (!log || !edit) {
        iso_free(log);
        iso_free(edit);
        return iso_fail(error, ISO_ERR_NOMEM, "out of memory for a change log of %zu cells", total);
    }
    for (int axis = 0; axis < 3; axis++) log->cells[axis] = cells[axis];
    log->edit = edit;
    *out = log;
    return ISO_OK;
}

void iso_change_log_destroy(iso_change_log *log) {
    if (!log) return;
    iso_free(log->edit);
    iso_buffer_free(&log->entries);
    iso_free(log);
}

uint64_t iso_change_log_begin(iso_change_log *log) {
    return ++log->now;
}

/* Whether two boxes in a cell overlap or are neighbours. */
static bool meet(const iso_change *a, const iso_change *b) {
    for (int axis = 0; axis < 3; axis++)
        if (a->lo[axis] > b->hi[axis] + 1 || b->lo[axis] > a->hi[axis] + 1) return false;
    return true;
}

static void unite(iso_change *into, const iso_change *from) {
    for (int axis = 0; axis < 3; axis++) {
        if (from->lo[axis] < into->lo[axis]) into->lo[axis] = from->lo[axis];
        if (from->hi[axis] > into->hi[axis]) into->hi[axis] = from->hi[axis];
    }
    if (from->edit > into->edit) into->edit = from->edit;
}

/* Adds an entry, or enlarges a recent entry of the same cell and edit if the two boxes meet: writers often
 * add a cell several times. */
static void append_entry(iso_change_log *log, const iso_change *change) {
    iso_change *entries = entries_of(log);
    for (size_t back = 1; back <= COALESCE_DEPTH && back <= log->count; back++) {
        iso_change *entry = &entries[log->count - back];
        if (entry->edit != change->edit) break;
        if (entry->cell == change->cell && meet(entry, change)) {
            unite(entry, change);
            return;
        }
    }
    entries[log->count++] = *change;
    if (!log->edit[change->cell]) log->changed_cells++;
    log->edit[change->cell] = change->edit;
}

static int by_cell(const void *left, const void *right) {
    const iso_change *a = left, *b = right;
    return (a->cell > b->cell) - (a->cell < b->cell);
}

static int by_edit(const void *left, const void *right) {
    const iso_change *a = left, *b = right;
    if (a->edit != b->edit) return a->edit > b->edit ? 1 : -1;
    return by_cell(left, right);
}

/* Merges the entries of the older half of the log to one for each cell. A merged entry gets the cell's
 * latest edit number in this half. That is not above the numbers of the newer half, so the log stays
 * sorted by edit. */
static void merge_older_half(iso_change_log *log) {
    iso_change *entries = entries_of(log);
    size_t half = log->count / 2, merged = 0;
    qsort(entries, half, sizeof *entries, by_cell);
    for (size_t i = 0; i < half; i++) {
        if (merged && entries[merged - 1].cell == entries[i].cell)
            unite(&entries[merged - 1], &entries[i]);
        else
            entries[merged++] = entries[i];
    }
    qsort(entries, merged, sizeof *entries, by_edit);
    for (size_t i = half; i < log->count; i++) entries[merged++] = entries[i];
    log->count = merged;
}

static void append_cell(iso_change_log *log, const int cell[3], const int lo[3], const int hi[3]) {
    iso_change change = {.edit = log->now};
    size_t row = (size_t)cell[2] * (size_t)log->cells[1] + (size_t)cell[1];
    change.cell = (uint32_t)(row * (size_t)log->cells[0] + (size_t)cell[0]);
    for (int axis = 0; axis < 3; axis++) {
        int first = cell[axis] * ISO_BRICK;
        change.lo[axis] = (uint8_t)(lo[axis] > first ? lo[axis] - first : 0);
        change.hi[axis] = (uint8_t)(hi[axis] < first + ISO_BRICK - 1 ? hi[axis] - first : ISO_BRICK - 1);
    }
    append_entry(log, &change);
}

iso_status iso_change_log_add(iso_change_log *log, const int lo[3], const int hi[3], iso_error *error) {
    int first[3], last[3], from[3], to[3];
    size_t cells = 1;
    for (int axis = 0; axis < 3; axis++) {
        int end = log->cells[axis] > INT32_MAX / ISO_BRICK ? INT32_MAX : log->cells[axis] * ISO_BRICK - 1;
        first[axis] = lo[axis] < 0 ? 0 : lo[axis];
        last[axis] = hi[axis] > end ? end : hi[axis];
        if (first[axis] > last[axis]) return ISO_OK;
        from[axis] = first[axis] / ISO_BRICK;
        to[axis] = last[axis] / ISO_BRICK;
        cells *= (size_t)(to[axis] - from[axis] + 1);
    }
    ISO_TRY(iso_buffer_reserve(&log->entries, (log->count + cells) * sizeof(iso_change),
                               log->count * sizeof(iso_change), error));
    if (log->now == 0) log->now = 1;
    int cell[3];
    for (cell[2] = from[2]; cell[2] <= to[2]; cell[2]++)
        for (cell[1] = from[1]; cell[1] <= to[1]; cell[1]++)
            for (cell[0] = from[0]; cell[0] <= to[0]; cell[0]++) append_cell(log, cell, first, last);
    size_t budget = log->changed_cells * BUDGET_PER_CELL;
    if (log->count > (budget > BUDGET_MIN ? budget : BUDGET_MIN)) merge_older_half(log);
    return ISO_OK;
}

uint64_t iso_change_log_now(const iso_change_log *log) {
    return log->now;
}

uint64_t iso_change_log_last_edit(const iso_change_log *log, uint32_t cell) {
    return log->edit[cell];
}

size_t iso_change_log_since(const iso_change_log *log, uint64_t seen, const iso_change **changes) {
    const iso_change *entries = entries_of(log);
    size_t low = 0, high = log->count;
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        if (entries[middle].edit > seen)
            high = middle;
        else
            low = middle + 1;
    }
    *changes = low < log->count ? entries + low : NULL;
    return log->count - low;
}

size_t iso_change_log_bytes(const iso_change_log *log) {
    size_t cells = (size_t)log->cells[0] * (size_t)log->cells[1] * (size_t)log->cells[2];
    return sizeof *log + cells * sizeof *log->edit + log->entries.bytes;
}
