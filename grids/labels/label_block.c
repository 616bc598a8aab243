/* label_block: the groups or labels in and near a block, and the voxels that are needed of it. */
#include "grids/labels/label_block.h"

/* ---- the labels of a block */

/* Makes a row of labels one of their groups, or leaves those labels that are drawn. */
static void choose_drawn(const label_block *b, uint16_t *row, int n) {
    const iso_label_fields *f = b->all->fields;
    if (b->solids && f->group_count == 1 && !f->has_undrawn) {
        b->all->kernel->present(row, n);
        return;
    }
    for (int x = 0, end; b->solids && x < n; x = end) {
        end = iso_label_run_end(row, x, n);
        iso_label_fill(row, x, end, f->group[row[x]]);
    }
    for (int x = 0; !b->solids && f->has_undrawn && x < n; x++)
        if (!f->group[row[x]]) row[x] = 0;
}

/* Where the first voxel of a box is in the volume. */
static void place_of(const label_rows *r, int at[3]) {
    for (int k = 0; k < 3; k++) at[k] = r->at[k] + r->b->first[k] - NEAR - ISO_LABEL_BORDER;
}

label_rows iso_label_block_rows(const label_block *b, const int at[3], int n, int label, uint16_t *copy) {
    const iso_label_fields *f = b->all->fields;
    const int *dims = f->labels->dims;
    label_rows r = {.b = b, .at = {at[0], at[1], at[2]}, .n = n, .label = label, .copy = copy};
    int v[3];
    place_of(&r, v);
    const bool same = (!b->solids || label == 0) && !f->has_undrawn;
    if (!same || v[0] < 0 || v[0] + n > dims[0] || dims[0] * dims[1] < ISO_LABEL_SLACK) return r;
    for (int k = 0; k < 2; k++) {
        /* (Kernels read beyond the end of a row: the last slice is copied.) */
        const int end = dims[k + 1] - k;
        r.lo[k] = v[k + 1] < 0 ? -v[k + 1] : 0;
        r.hi[k] = end - v[k + 1];
    }
    r.pitch = dims[0];
    r.slice = r.pitch * dims[1];
    r.first = f->labels->number + v[0] + (v[1] + r.lo[0]) * r.pitch + (v[2] + r.lo[1]) * r.slice;
    return r;
}

void iso_label_block_copy_row(const label_rows *r, int y, int z) {
    const iso_labels *labels = r->b->all->fields->labels;
    const int *dims = labels->dims, n = r->n;
    uint16_t *row = r->copy;
    int v[3];
    place_of(r, v);
    v[1] += y;
    v[2] += z;
    const int first = v[0] < 0 ? -v[0] : 0, end = v[0] + n > dims[0] ? dims[0] - v[0] : n;
    const bool outside = v[1] < 0 || v[2] < 0 || v[1] >= dims[1] || v[2] >= dims[2] || first >= end;
    if (outside || first > 0 || end < n) memset(row, 0, (size_t)n * sizeof *row);
    if (outside) return;
    memcpy(row + first,
           labels->number + ((size_t)v[2] * (size_t)dims[1] + (size_t)v[1]) * (size_t)dims[0] +
               (size_t)(v[0] + first),
           (size_t)(end - first) * sizeof *row);
    choose_drawn(r->b, row, n);
}

static void load_window(const label_block *b) {
    uint16_t copy[FIELD + ISO_LABEL_SLACK];
    const label_rows rows =
        iso_label_block_rows(b, (const int[3]){0, 0, 0}, b->size[0], b->solids ? -1 : 0, copy);
    for (int z = 0; z < b->size[2]; z++)
        for (int y = 0; y < b->size[1]; y++)
            memcpy(b->s->window + index_in(b->size, 0, y, z), label_row(&rows, y, z),
                   (size_t)b->size[0] * sizeof *b->s->window);
}

/* The groups, as bits, in and around a block as far as its fields depend on them, or a little farther. */
static uint64_t groups_around(const label_block *b) {
    const iso_label_fields *f = b->all->fields;
    int lo[3], hi[3];
    uint64_t set = 0;
    for (int k = 0; k < 3; k++) {
        lo[k] = b->first[k] / ISO_BRICK - 1;
        hi[k] = (b->first[k] + b->out[k]) / ISO_BRICK;
        if (lo[k] < 0 || hi[k] >= f->bricks[k]) set |= 1;
        lo[k] = lo[k] < 0 ? 0 : lo[k];
        hi[k] = hi[k] >= f->bricks[k] ? f->bricks[k] - 1 : hi[k];
    }
    for (int z = lo[2]; z <= hi[2]; z++)
        for (int y = lo[1]; y <= hi[1]; y++)
            for (int x = lo[0]; x <= hi[0]; x++)
                set |= f->own_groups[iso_hgrid_cell_index(f->grid[1], x, y, z)];
    return set;
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

/* Lists the labels within NEAR voxels of the block. */
static void list_near(const label_block *b) {
    block_memory *s = b->s;
    s->near_count = 0;
    s->kept_count = 0;
    for (int z = 0; z < b->size[2]; z++)
        for (int y = 0; y < b->size[1]; y++) {
            const uint16_t *row = window_row(b, y, z);
            for (int x = 0, end; x < b->size[0]; x = end) {
                end = iso_label_run_end(row, x, b->size[0]);
                add_near(s, row[x], x, end, y, z);
            }
        }
    for (int i = 0; i < s->near_count; i++) {
        s->place[s->near[i].label] = -1;
        widen_near(b, &s->near[i]);
    }
}

/* ---- which voxels are needed */

/* to = the voxels of `from` and those up to `below` before and `above` behind them on each axis. */
static void spread(const label_block *b, const uint64_t *from, int below, int above, uint64_t *work,
                   uint64_t *to) {
    b->all->kernel->spread(from, b->size[1], b->size[2], below, above, work, to);
}

/* Sets `cells` to the cells whose corners differ, and to those beside them. */
static void find_cells(const label_block *b) {
    block_memory *s = b->s;
    const iso_smooth_kernel *kernel = b->all->kernel;
    const ptrdiff_t pitch = b->size[0], slice = pitch * b->size[1];
    for (int z = 0; z < b->size[2]; z++)
        for (int y = 0; y < b->size[1]; y++) {
            const uint16_t *row = window_row(b, y, z);
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
    memcpy(s->edges[0], s->cells, (size_t)b->size[1] * (size_t)b->size[2] * sizeof *s->cells);
    spread(b, s->edges[0], 1, 1, s->edges[1], s->cells);
}

/* Leaves of `drawn` what the block has values for, and finds the voxels that these depend on. False: there
 * are none. */
static bool find_needed(const label_block *b, bool whole) {
    block_memory *s = b->s;
    const uint64_t across = range_of(NEAR, NEAR + b->out[0]), all = range_of(0, b->size[0]);
    uint64_t any = 0;
    for (int z = 0; z < b->size[2]; z++)
        for (int y = 0; y < b->size[1]; y++) {
            uint64_t *set = &s->drawn[row_in(b, y, z)];
            const bool out = y >= NEAR && z >= NEAR && y < NEAR + b->out[1] && z < NEAR + b->out[2];
            *set = !out ? 0 : whole ? across : *set & across;
            any |= *set;
        }
    if (!any) return false;
    spread(b, s->drawn, NEAR - 1, NEAR - 1, s->edges[1], s->needed);
    for (size_t i = 0; i < (size_t)b->size[1] * (size_t)b->size[2]; i++) s->needed[i] &= all;
    return true;
}

bool iso_label_block_groups(label_block *b, bool *pair) {
    block_memory *s = b->s;
    const uint64_t groups = groups_around(b);
    const uint64_t others = groups & (groups - 1);
    b->solids = true;
    load_window(b);
    find_cells(b);
    spread(b, s->cells, 0, 1, s->edges[1], s->drawn);
    if (!find_needed(b, b->all->fields->places & ISO_LABELS_BAND)) return false;
    *pair = others && !(others & (others - 1));
    if (!*pair) {
        list_near(b);
        return true;
    }
    s->near_count = 2;
    s->kept_count = 0;
    s->near[0].label = first_of(groups);
    s->near[1].label = first_of(others);
    return true;
}

/* ---- labels in a group */

/* The voxels of a row in the octants where labels are told apart. */
static uint64_t octant_row(const label_block *b, int y, int z) {
    const int v[3] = {b->first[0], b->first[1] + y - NEAR, b->first[2] + z - NEAR};
    const uint64_t bits = b->octants >> iso_label_octant(0, v[1], v[2]) & range_of(0, ISO_LABEL_OCTANTS);
    uint64_t set = 0;
    for (int i = 0; i < ISO_LABEL_OCTANTS; i++)
        if (bits >> i & 1) set |= range_of(i * ISO_LABEL_OCTANT, (i + 1) * ISO_LABEL_OCTANT);
    return set >> v[0] % ISO_LABEL_SIDE << NEAR;
}

/* Whether labels near the block share a group. */
static bool shares_group(const label_block *b) {
    const iso_label_fields *f = b->all->fields;
    int shared = 0;
    for (int i = 0; i < b->s->near_count; i++) {
        const int label = b->s->near[i].label;
        shared += label && f->labels_in_group[f->group[label]] > 1;
    }
    return shared > 1;
}

/* Sets `drawn` to the corners of cells that have several labels beside the background. */
static void find_mixed(const label_block *b) {
    block_memory *s = b->s;
    uint64_t *voxels = s->edges[0], *once = s->edges[1], *twice = s->edges[2];
    const size_t rows = (size_t)b->size[1] * (size_t)b->size[2];
    memset(once, 0, rows * sizeof *once);
    memset(twice, 0, rows * sizeof *twice);
    memset(s->drawn, 0, rows * sizeof *s->drawn);
    for (int i = 0; i < s->near_count; i++) {
        const extent *box = &s->near[i].box;
        if (!s->near[i].label) continue;
        for (int z = box->lo[2]; z < box->hi[2]; z++)
            for (int y = box->lo[1]; y < box->hi[1]; y++)
                voxels[row_in(b, y, z)] =
                    b->all->kernel->equal(window_row(b, y, z), b->size[0], (uint16_t)s->near[i].label);
        for (int z = box->lo[2] > 0 ? box->lo[2] - 1 : 0; z < box->hi[2]; z++)
            for (int y = box->lo[1] > 0 ? box->lo[1] - 1 : 0; y < box->hi[1]; y++) {
                uint64_t set = 0;
                for (int k = 0; k < 4; k++) {
                    const int at[2] = {y + (k & 1), z + (k >> 1)};
                    if (at[0] >= box->lo[1] && at[1] >= box->lo[2] && at[0] < box->hi[1] &&
                        at[1] < box->hi[2])
                        set |= voxels[row_in(b, at[0], at[1])];
                }
                set |= set >> 1;
                twice[row_in(b, y, z)] |= once[row_in(b, y, z)] & set;
                once[row_in(b, y, z)] |= set;
            }
    }
    for (int z = 0; z + 1 < b->size[2]; z++)
        for (int y = 0; y + 1 < b->size[1]; y++) {
            const uint64_t cells = s->cells[row_in(b, y, z)] & twice[row_in(b, y, z)];
            for (int i = 0; i < 4; i++) s->drawn[row_in(b, y + (i & 1), z + (i >> 1))] |= cells | cells << 1;
        }
}

/* Whether there are groups of several labels around the block. */
static bool may_share(const label_block *b) {
    uint64_t groups = groups_around(b) & ~UINT64_C(1);
    while (groups && b->all->fields->labels_in_group[first_of(groups)] < 2) groups &= groups - 1;
    return groups != 0;
}

bool iso_label_block_labels(label_block *b) {
    const bool inside = b->all->fields->places & ISO_LABELS_INSIDE;
    if (!may_share(b)) return false;
    b->solids = true;
    if (!inside) load_window(b), find_cells(b);
    b->solids = false;
    load_window(b);
    list_near(b);
    if (!shares_group(b)) return false;
    if (inside) find_cells(b);
    find_mixed(b);
    for (int z = NEAR; z < NEAR + b->out[2]; z++)
        for (int y = NEAR; y < NEAR + b->out[1]; y++) b->s->drawn[row_in(b, y, z)] &= octant_row(b, y, z);
    return find_needed(b, false);
}
