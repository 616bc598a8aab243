/* label_block: the labels in and near a block, and the voxels that are needed of it. */
#include "grids/labels/label_block.h"

/* ---- the labels of a block */

/* The first labels that are found in a window. */
typedef struct first_labels {
    int label[3], count; /* count: 3 at most */
} first_labels;

static void add_label(first_labels *first, int label) {
    for (int i = 0; i < first->count; i++)
        if (first->label[i] == label) return;
    if (first->count < 3) first->label[first->count++] = label;
}

/* Sets a row of the window; its first voxel is at `at` in the volume. */
static void load_row(const label_block *b, const int at[3], int n, uint16_t *row, first_labels *found) {
    const iso_label_fields *f = b->all->fields;
    const iso_smooth_kernel *kernel = b->all->kernel;
    const int *dims = f->labels->dims;
    const int first = at[0] < 0 ? -at[0] : 0, end = at[0] + n > dims[0] ? dims[0] - at[0] : n;
    const bool outside = at[1] < 0 || at[2] < 0 || at[1] >= dims[1] || at[2] >= dims[2] || first >= end;
    if (outside || first > 0 || end < n) memset(row, 0, (size_t)n * sizeof *row);
    if (!outside)
        memcpy(row + first,
               f->labels->number + ((size_t)at[2] * (size_t)dims[1] + (size_t)at[1]) * (size_t)dims[0] +
                   (size_t)(at[0] + first),
               (size_t)(end - first) * sizeof *row);
    for (int x = 0; f->has_undrawn && x < n; x++)
        if (!f->group[row[x]]) row[x] = 0;
    if (found->count == 3) return;
    uint64_t known = 0;
    for (int i = 0; i < found->count; i++) known |= kernel->equal(row, n, (uint16_t)found->label[i]);
    for (int x = 0; x < n && found->count < 3 && known != ~UINT64_C(0) >> (64 - n);
         x = iso_label_run_end(row, x, n))
        add_label(found, row[x]);
}

/* Sets the window; returns the number of labels in it, 3 at most. */
static int load_window(label_block *b) {
    first_labels found = {{0, 0, 0}, 0};
    const int margin = NEAR + OFFSET + ISO_LABEL_BORDER;
    for (int z = 0; z < b->window[2]; z++)
        for (int y = 0; y < b->window[1]; y++) {
            const int at[3] = {b->first[0] - margin, b->first[1] - margin + y, b->first[2] - margin + z};
            load_row(b, at, b->window[0], b->s->window + index_in(b->window, 0, y, z), &found);
        }
    return found.count;
}

static inline uint64_t *coarse_row(near_label *near, int y, int z) {
    return &near->rows[z / 4 * COARSE + y / 4];
}

static void add_near(block_memory *s, int label, int x, int end, int y, int z) {
    if (s->place[label] < 0) {
        s->place[label] = s->near_count;
        s->near[s->near_count++] = (near_label){.label = label, .box = {{x, y, z}, {end, y + 1, z + 1}}};
    }
    near_label *near = &s->near[s->place[label]];
    const int lo[3] = {x, y, z}, hi[3] = {end, y + 1, z + 1};
    for (int k = 0; k < 3; k++) {
        near->box.lo[k] = lo[k] < near->box.lo[k] ? lo[k] : near->box.lo[k];
        near->box.hi[k] = hi[k] > near->box.hi[k] ? hi[k] : near->box.hi[k];
    }
    *coarse_row(near, y, z) |= range_of(x, end);
}

/* Makes the box of a label, and its rows, larger by NEAR voxels or a little more. */
static void widen_near(const label_block *b, near_label *near) {
    uint64_t along[COARSE * COARSE];
    const bool whole = b->all->fields->places & ISO_LABELS_BAND;
    for (int k = 0; k < 3; k++) {
        near->box.lo[k] = near->box.lo[k] > NEAR ? near->box.lo[k] - NEAR : 0;
        near->box.hi[k] = near->box.hi[k] + NEAR < b->size[k] ? near->box.hi[k] + NEAR : b->size[k];
    }
    for (int i = 0; i < COARSE * COARSE; i++) {
        uint64_t set = near->rows[i];
        if (i % COARSE > 0) set |= near->rows[i - 1];
        if (i % COARSE < COARSE - 1) set |= near->rows[i + 1];
        for (int k = 0; k < NEAR; k++) set |= set << 1 | set >> 1;
        along[i] = whole ? ~UINT64_C(0) : set;
    }
    for (int i = 0; i < COARSE * COARSE; i++) {
        near->rows[i] = along[i];
        if (i >= COARSE) near->rows[i] |= along[i - COARSE];
        if (i < COARSE * (COARSE - 1)) near->rows[i] |= along[i + COARSE];
        near->rows[i] &= range_of(near->box.lo[0], near->box.hi[0]);
    }
}

/* Lists the labels within NEAR voxels of the block, and sets `groups`. */
static void list_near(label_block *b) {
    block_memory *s = b->s;
    const uint8_t *group = b->all->fields->group;
    s->near_count = 0;
    s->kept_count = 0;
    for (int z = 0; z < b->size[2]; z++)
        for (int y = 0; y < b->size[1]; y++) {
            const uint16_t *row = window_row(b, y, z);
            uint16_t *to = s->groups + index_in(b->size, 0, y, z);
            for (int x = 0, end; x < b->size[0]; x = end) {
                end = iso_label_run_end(row, x, b->size[0]);
                add_near(s, row[x], x, end, y, z);
                iso_label_fill(to, x, end, group[row[x]]);
            }
        }
    for (int i = 0; i < s->near_count; i++) {
        s->place[s->near[i].label] = -1;
        widen_near(b, &s->near[i]);
    }
}

/* ---- which voxels are needed */

/* The rows in which sets of voxels are looked at. */
static inline bool has_row(const label_block *b, int y, int z) {
    return y >= 0 && z >= 0 && y < b->size[1] && z < b->size[2];
}

/* to = the voxels of `from` and those up to `below` before and `above` behind them on each axis. */
static void spread(const label_block *b, const uint64_t *from, int below, int above, uint64_t *work,
                   uint64_t *to) {
    const size_t rows = (size_t)b->size[1] * (size_t)b->size[2];
    for (size_t i = 0; i < rows; i++) {
        uint64_t set = from[i];
        for (int k = 1; k <= above; k++) set |= from[i] << k;
        for (int k = 1; k <= below; k++) set |= from[i] >> k;
        to[i] = set;
    }
    for (int z = 0; z < b->size[2]; z++)
        for (int y = 0; y < b->size[1]; y++) {
            uint64_t set = 0;
            for (int k = -above; k <= below; k++) set |= has_row(b, y + k, z) ? to[row_in(b, y + k, z)] : 0;
            work[row_in(b, y, z)] = set;
        }
    for (int z = 0; z < b->size[2]; z++)
        for (int y = 0; y < b->size[1]; y++) {
            uint64_t set = 0;
            for (int k = -above; k <= below; k++) set |= has_row(b, y, z + k) ? work[row_in(b, y, z + k)] : 0;
            to[row_in(b, y, z)] = set;
        }
}

/* Sets `cells` to the cells whose corners have several groups, or several labels if these are drawn inside of
 * solids, too. */
static void find_mixed_cells(const label_block *b) {
    block_memory *s = b->s;
    const iso_smooth_kernel *kernel = b->all->kernel;
    const bool of_labels = b->all->fields->places & ISO_LABELS_INSIDE;
    const ptrdiff_t pitch = of_labels ? b->window[0] : b->size[0],
                    slice = pitch * (of_labels ? b->window[1] : b->size[1]);
    for (int z = 0; z < b->size[2]; z++)
        for (int y = 0; y < b->size[1]; y++) {
            const uint16_t *row = of_labels ? window_row(b, y, z) : s->groups + index_in(b->size, 0, y, z);
            const size_t i = row_in(b, y, z);
            s->edges[0][i] = kernel->differ(row, row + 1, b->size[0] - 1);
            s->edges[1][i] = y + 1 < b->size[1] ? kernel->differ(row, row + pitch, b->size[0]) : 0;
            s->edges[2][i] = z + 1 < b->size[2] ? kernel->differ(row, row + slice, b->size[0]) : 0;
        }
    for (int z = 0; z < b->size[2]; z++)
        for (int y = 0; y < b->size[1]; y++) {
            const size_t i = row_in(b, y, z), up = row_in(b, y + 1, z), back = row_in(b, y, z + 1),
                         across = row_in(b, y + 1, z + 1);
            const bool last = y + 1 == b->size[1] || z + 1 == b->size[2];
            /* (a tree of edges that joins all corners) */
            s->cells[i] = last ? 0
                               : s->edges[0][i] | s->edges[0][up] | s->edges[0][back] | s->edges[0][across] |
                                     s->edges[1][i] | s->edges[1][back] | s->edges[2][i];
        }
}

/* Finds the voxels that are needed. */
static void find_needed(const label_block *b) {
    block_memory *s = b->s;
    const bool whole = b->all->fields->places & ISO_LABELS_BAND;
    find_mixed_cells(b);
    memcpy(s->edges[0], s->cells, (size_t)b->size[1] * (size_t)b->size[2] * sizeof *s->cells);
    spread(b, s->edges[0], 1, 1, s->edges[1], s->cells);
    spread(b, s->cells, 0, 1, s->edges[1], s->drawn);
    const uint64_t across = range_of(NEAR, NEAR + b->out[0]), all = range_of(0, b->size[0]);
    for (int z = 0; z < b->size[2]; z++)
        for (int y = 0; y < b->size[1]; y++) {
            uint64_t *set = &s->drawn[row_in(b, y, z)];
            const bool out = y >= NEAR && z >= NEAR && y < NEAR + b->out[1] && z < NEAR + b->out[2];
            *set = !out ? 0 : whole ? across : *set & across;
        }
    spread(b, s->drawn, NEAR - 1, NEAR - 1, s->edges[1], s->needed);
    for (size_t i = 0; i < (size_t)b->size[1] * (size_t)b->size[2]; i++) s->needed[i] &= all;
}

bool iso_label_block_look(label_block *b) {
    const int labels = load_window(b);
    list_near(b);
    find_needed(b);
    return labels == 2 && b->s->near_count == 2;
}
