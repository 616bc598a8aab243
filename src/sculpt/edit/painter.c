/* Finds the colours of voxels after a touch, cell by cell and in parallel: each cell reads the colours from
 * before the touch and the distances from before and after it, and writes an item of its own. */
#include "sculpt/edit/painter.h"

#include <math.h>
#include <string.h>

#include "base/numbers.h"

static iso_cell_items *paint_of(const iso_painter *painter) {
    return &painter->transaction->items.of[ISO_ITEM_PAINT];
}

static const iso_paint_item *item_of(const iso_painter *painter, size_t cell) {
    return (const iso_paint_item *)paint_of(painter)->cell[cell];
}

iso_status iso_painter_init(iso_painter *painter, iso_transaction *transaction, iso_error *error) {
    painter->transaction = transaction;
    painter->index_of = iso_alloc_zero(iso_hgrid_cell_count(transaction->grid), sizeof *painter->index_of);
    if (!painter->index_of) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for the paint");
    return iso_change_log_create(transaction->grid->cells, &painter->log, error);
}

void iso_painter_free(iso_painter *painter) {
    iso_buffer_free(&painter->cells);
    iso_free(painter->index_of);
    iso_change_log_destroy(painter->log);
}

/* Whether the tool lays the brush's colour over the voxels that it changes. */
static bool covers(iso_tool tool) {
    return tool == ISO_TOOL_PAINT || tool == ISO_TOOL_INFLATE || tool == ISO_TOOL_FILL ||
           tool == ISO_TOOL_CLAY;
}

bool iso_painter_begin(iso_painter *painter, const iso_dabs *dabs) {
    const bool brings = dabs->color && (covers(dabs->tool) || iso_tool_is_set_operation(dabs->tool)),
               paints = brings || paint_of(painter)->used > 0;
    painter->dabs = paints ? dabs : NULL;
    return paints;
}

static iso_status add_cell(iso_painter *painter, uint32_t cell, const int at[3], iso_error *error) {
    const size_t bytes = painter->cell_count * sizeof(iso_painted_cell);
    if (painter->index_of[cell]) return ISO_OK;
    ISO_TRY(iso_buffer_reserve(&painter->cells, bytes + sizeof(iso_painted_cell), bytes, error));
    iso_painted_cell *made = iso_painter_cell(painter, painter->cell_count++);
    memset(made, 0, sizeof *made);
    made->cell = cell;
    memcpy(made->at, at, sizeof made->at);
    painter->index_of[cell] = (uint32_t)painter->cell_count;
    return ISO_OK;
}

iso_status iso_painter_list(iso_painter *painter, iso_error *error) {
    for (size_t i = 0; i < painter->transaction->cell_count; i++) {
        const iso_edit_cell *edit_cell = iso_transaction_cell(painter->transaction, i);
        ISO_TRY(add_cell(painter, edit_cell->cell, edit_cell->at, error));
    }
    return ISO_OK;
}

static iso_paint_item *create_item(iso_painter *painter) {
    iso_paint_item *item = iso_item_create(sizeof *item);
    if (!item) __atomic_store_n(&painter->failed, 1, __ATOMIC_RELAXED);
    return item;
}

/* ---- warps */

/* Whether a cell that a warp reads has paint. */
static bool reads_paint(const iso_painter *painter, const int brick[3], const iso_warp *warp) {
    const iso_hgrid *grid = painter->transaction->grid;
    int lo[3], hi[3];
    for (int axis = 0; axis < 3; axis++) {
        float low = warp->position[axis][0], high = low;
        for (int i = 1; i < ISO_BRICK_VOXELS; i++) {
            low = fminf(low, warp->position[axis][i]);
            high = fmaxf(high, warp->position[axis][i]);
        }
        const int first = ISO_BRICK * brick[axis] + (int)floorf(low),
                  last = ISO_BRICK * brick[axis] + (int)floorf(high) + 1, top = grid->dims[axis];
        lo[axis] = iso_clamp_index(first, top) / ISO_BRICK;
        hi[axis] = iso_clamp_index(last, top) / ISO_BRICK;
    }
    for (int z = lo[2]; z <= hi[2]; z++)
        for (int y = lo[1]; y <= hi[1]; y++)
            for (int x = lo[0]; x <= hi[0]; x++)
                if (painter->source(painter->source_context, (uint32_t)iso_hgrid_cell_index(grid, x, y, z)))
                    return true;
    return false;
}

/* The paint of a cell; `number` and `item` are those of the cell that was looked at last. */
static const iso_paint_item *source_item(const iso_painter *painter, uint32_t cell, uint32_t *number,
                                         const iso_paint_item **item) {
    if (cell != *number) {
        *number = cell;
        *item = painter->source(painter->source_context, cell);
    }
    return *item;
}

/* The colours of the eight voxels from `first` on; beyond the grid there are none. Returns whether there are
 * any. */
static bool find_corners(const iso_painter *painter, const int first[3], uint32_t *number,
                         const iso_paint_item **item, uint32_t corners[8]) {
    const iso_hgrid *grid = painter->transaction->grid;
    uint32_t any = 0;
    bool whole = true; /* all lie in one cell */
    for (int axis = 0; axis < 3; axis++)
        whole &=
            first[axis] >= 0 && first[axis] + 1 < grid->dims[axis] && first[axis] % ISO_BRICK + 1 < ISO_BRICK;
    if (whole && !source_item(painter,
                              (uint32_t)iso_hgrid_cell_index(grid, first[0] / ISO_BRICK, first[1] / ISO_BRICK,
                                                             first[2] / ISO_BRICK),
                              number, item))
        return false;
    for (int k = 0; k < 8; k++) {
        const int at[3] = {first[0] + (k & 1), first[1] + (k >> 1 & 1), first[2] + (k >> 2)};
        bool inside = true;
        for (int axis = 0; axis < 3 && !whole; axis++) inside &= at[axis] >= 0 && at[axis] < grid->dims[axis];
        const iso_paint_item *of =
            whole    ? *item
            : inside ? source_item(painter,
                                   (uint32_t)iso_hgrid_cell_index(grid, at[0] / ISO_BRICK, at[1] / ISO_BRICK,
                                                                  at[2] / ISO_BRICK),
                                   number, item)
                     : NULL;
        any |= corners[k] = of ? of->voxel[(at[2] % ISO_BRICK * ISO_BRICK + at[1] % ISO_BRICK) * ISO_BRICK +
                                           at[0] % ISO_BRICK]
                               : 0;
    }
    return any != 0;
}

/* Samples the colours at the warp's positions, which are multiples of 2^-16. Returns whether there are any.
 */
static bool sample_paint(const iso_painter *painter, const int brick[3], const iso_warp *warp,
                         uint32_t *out) {
    uint32_t all = 0, number = UINT32_MAX;
    const iso_paint_item *item = NULL;
    for (int i = 0; i < ISO_BRICK_VOXELS; i++) {
        uint32_t part[3], corners[8];
        int first[3];
        for (int axis = 0; axis < 3; axis++) {
            const float p = warp->position[axis][i], whole = floorf(p);
            first[axis] = ISO_BRICK * brick[axis] + (int)whole;
            part[axis] = (uint32_t)((p - whole) * ISO_PAINT_ONE);
        }
        out[i] = find_corners(painter, first, &number, &item, corners) ? iso_paint_mix(corners, part) : 0;
        all |= out[i];
    }
    return all != 0;
}

static void note_warp(iso_painter *painter, iso_painted_cell *cell, const iso_warp *warp) {
    const iso_paint_item *source = painter->source(painter->source_context, cell->cell);
    iso_paint_item sampled;
    if (!warp) {
        if (!source || !(cell->warped = create_item(painter))) return;
        *cell->warped = *source;
        return;
    }
    if (!reads_paint(painter, cell->at, warp) || !sample_paint(painter, cell->at, warp, sampled.voxel))
        return;
    cell->warped = create_item(painter);
    if (cell->warped) *cell->warped = sampled;
}

void iso_painter_note(iso_painter *painter, size_t index, const iso_voxel_bits *changed,
                      const iso_warp *warp) {
    iso_painted_cell *cell = iso_painter_cell(painter, index);
    if (changed) cell->changed = *changed;
    if (iso_tool_is_warp(painter->dabs->tool)) note_warp(painter, cell, warp);
}

/* ---- what the brush's colour does */

/* The dabs of a touch that reach a brick, relative to its first voxel, in 1/4096 voxel. */
typedef struct local_brush {
    int count;
    int64_t centre[ISO_DAB_MAX][3];
    double square; /* of the radius */
} local_brush;

static void make_local_brush(const iso_dabs *dabs, const int brick[3], local_brush *local) {
    enum { PART = 4096 }; /* (centres are multiples of 1/4096) */
    const double radius = rint((double)dabs->radius_voxels * PART);
    int near[ISO_DAB_MAX];
    local->count = iso_dabs_find_near(dabs, brick, near);
    for (int i = 0; i < local->count; i++)
        for (int k = 0; k < 3; k++)
            local->centre[i][k] = (int64_t)rint(fmin(
                fmax((dabs->dab[near[i]].centre[k] - ISO_BRICK * (double)brick[k]) * PART, -4e12), 4e12));
    local->square = radius * radius;
}

/* The falloff (0 .. ISO_PAINT_ONE) at a squared distance. All is exact or rounded alike everywhere. */
static int falloff_at(iso_falloff falloff, double square, double radius_square) {
    const int64_t one = ISO_PAINT_ONE;
    if (!(square < radius_square)) return 0;
    const int64_t t2 = (int64_t)(square * ISO_PAINT_ONE / radius_square), s = one - t2;
    if (falloff == ISO_FALLOFF_SMOOTH) return (int)(s * s / one);
    if (falloff == ISO_FALLOFF_LINEAR) return (int)(one - (int64_t)sqrt((double)(t2 * one)));
    return ISO_PAINT_ONE;
}

/* The weight of the brush's colour at a voxel: of the nearest dab. */
static int weight_at(const iso_dabs *dabs, const local_brush *local, int voxel) {
    const int64_t at[3] = {4096 * (voxel % ISO_BRICK), 4096 * (voxel / ISO_BRICK % ISO_BRICK),
                           4096 * (voxel / ISO_BRICK_ROWS)};
    double least = INFINITY;
    for (int i = 0; i < local->count; i++) {
        double square = 0;
        for (int k = 0; k < 3; k++) {
            const double d = (double)(at[k] - local->centre[i][k]);
            square += d * d;
        }
        least = square < least ? square : least;
    }
    return (int)((int64_t)falloff_at(dabs->falloff, least, local->square) * dabs->cover / ISO_PAINT_ONE);
}

/* ---- the colours after a touch */

/* What the colours of a cell are made from. */
typedef struct cell_source {
    const iso_painter *painter;
    const iso_painted_cell *cell;
    const float *after;           /* distances */
    iso_voxel_bits inside;        /* voxels that were in the band */
    bool near;                    /* there is paint here or beside the cell */
    const iso_paint_item *old;    /* colours; NULL: none */
    const iso_voxel_bits *frozen; /* NULL: none */
    local_brush brush;
} cell_source;

/* The distance and the colour, before the touch, of a voxel that may lie beside the cell. False: it is
 * outside of the grid, or has no distance. */
static bool find_neighbour(const cell_source *s, const int voxel[3], uint32_t *color) {
    const iso_transaction *t = s->painter->transaction;
    int at[3];
    for (int axis = 0; axis < 3; axis++) {
        at[axis] = ISO_BRICK * s->cell->at[axis] + voxel[axis];
        if (at[axis] < 0 || at[axis] >= t->grid->dims[axis]) return false;
    }
    const size_t cell =
        iso_hgrid_cell_index(t->grid, at[0] / ISO_BRICK, at[1] / ISO_BRICK, at[2] / ISO_BRICK);
    const int number = (at[2] % ISO_BRICK * ISO_BRICK + at[1] % ISO_BRICK) * ISO_BRICK + at[0] % ISO_BRICK;
    const iso_paint_item *item = item_of(s->painter, cell);
    *color = item ? item->voxel[number] : 0;
    return fabsf(iso_transaction_grid_values(t, t->grid->cell[cell])[number]) < t->grid->band;
}

/* The colour of a voxel that comes into the band: the mean of its face neighbours that were there. */
static uint32_t extend(const cell_source *s, int voxel) {
    uint32_t colors[6];
    int count = 0;
    for (int face = 0; face < 6; face++) {
        int at[3] = {voxel % ISO_BRICK, voxel / ISO_BRICK % ISO_BRICK, voxel / ISO_BRICK_ROWS};
        at[face / 2] += face % 2 ? 1 : -1;
        count += find_neighbour(s, at, &colors[count]);
    }
    return iso_paint_mean(colors, count);
}

/* Whether the cell or one that shares a face with it has paint. */
static bool is_near_paint(const iso_painter *painter, const iso_painted_cell *cell) {
    const iso_hgrid *grid = painter->transaction->grid;
    if (item_of(painter, cell->cell)) return true;
    for (int face = 0; face < 6; face++) {
        int at[3] = {cell->at[0], cell->at[1], cell->at[2]};
        at[face / 2] += face % 2 ? 1 : -1;
        if (at[face / 2] < 0 || at[face / 2] >= grid->cells[face / 2]) continue;
        if (item_of(painter, iso_hgrid_cell_index(grid, at[0], at[1], at[2]))) return true;
    }
    return false;
}

/* The bits of a row of a set; NULL: the set is empty. */
static uint32_t row_of(const iso_voxel_bits *bits, int row) {
    return bits ? bits->row[row] : 0;
}

/* Lays the brush's colour over the marked voxels of a row. */
static void lay_colors(const cell_source *s, int row, uint32_t marked, uint32_t *out) {
    const iso_dabs *dabs = s->painter->dabs;
    for (; marked; marked &= marked - 1) {
        const int x = __builtin_ctz(marked);
        out[x] = iso_paint_over(out[x], dabs->color, weight_at(dabs, &s->brush, row * ISO_BRICK + x));
    }
}

/* Sets the colours of a row that are made one by one. inside: the voxels in the band; changed: those that the
 * brush has changed and that are not frozen. */
static void refine_row(const cell_source *s, int row, uint32_t inside, uint32_t changed, uint32_t *out) {
    const iso_dabs *dabs = s->painter->dabs;
    const bool warps = iso_tool_is_warp(dabs->tool), paints = dabs->tool == ISO_TOOL_PAINT,
               sets = iso_tool_is_set_operation(dabs->tool);
    const uint32_t frozen = row_of(s->frozen, row);
    uint32_t entering =
        warps || !s->near ? 0 : inside & ~(uint32_t)s->inside.row[row] & ~frozen & ~(sets ? changed : 0);
    for (uint32_t bits = warps ? frozen & inside : 0; bits; bits &= bits - 1) {
        const int x = __builtin_ctz(bits);
        out[x] = s->old ? s->old->voxel[row * ISO_BRICK + x] : 0;
    }
    for (; entering; entering &= entering - 1)
        out[__builtin_ctz(entering)] = extend(s, row * ISO_BRICK + __builtin_ctz(entering));
    if (paints || (dabs->color && covers(dabs->tool)))
        lay_colors(s, row, paints ? inside & ~frozen : changed, out);
}

static void make_colors(const cell_source *s, uint32_t *out) {
    const iso_dabs *dabs = s->painter->dabs;
    const iso_transaction *t = s->painter->transaction;
    const iso_paint_item *from = iso_tool_is_warp(dabs->tool) ? s->cell->warped : s->old;
    iso_voxel_bits inside, changed;
    static const iso_voxel_bits none;
    t->dab->find_band(s->after, t->grid->band, &inside);
    for (int row = 0; row < ISO_BRICK_ROWS; row++)
        changed.row[row] = (uint16_t)(s->cell->changed.row[row] & inside.row[row] & ~row_of(s->frozen, row));
    t->dab->set_colors(from ? from->voxel : NULL, &inside,
                       iso_tool_is_set_operation(dabs->tool) ? &changed : &none, dabs->color, out);
    for (int row = 0; row < ISO_BRICK_ROWS; row++)
        if (inside.row[row]) refine_row(s, row, inside.row[row], changed.row[row], out + row * ISO_BRICK);
}

static bool any_marked(const iso_voxel_bits *bits) {
    uint32_t any = 0;
    for (int row = 0; row < ISO_BRICK_ROWS; row++) any |= bits->row[row];
    return any != 0;
}

static bool has_colors(const iso_paint_item *item) {
    uint32_t any = 0;
    for (int i = 0; i < ISO_BRICK_VOXELS && !any; i += ISO_BRICK)
        for (int k = 0; k < ISO_BRICK; k++) any |= item->voxel[i + k];
    return any != 0;
}

static void finish_cell(void *context, size_t index, int worker) {
    (void)worker;
    iso_painter *painter = context;
    const iso_transaction *t = painter->transaction;
    iso_painted_cell *cell = iso_painter_cell(painter, index);
    const bool near = is_near_paint(painter, cell),
               brings = painter->dabs->color &&
                        (painter->dabs->tool == ISO_TOOL_PAINT || any_marked(&cell->changed));
    const iso_tool tool = painter->dabs->tool;
    const uint32_t edited = t->edit_cell_of[cell->cell];
    const bool changes = tool == ISO_TOOL_PAINT || iso_tool_is_warp(tool) ||
                         (edited && iso_transaction_cell(t, edited - 1)->edited);
    if (!cell->warped && !brings && !(near && changes)) return;
    cell->made = create_item(painter);
    if (!cell->made) return;
    const float *before = iso_transaction_grid_values(t, t->grid->cell[cell->cell]);
    cell_source s = {.painter = painter,
                     .cell = cell,
                     .after = edited ? iso_transaction_values(t, edited - 1) : before,
                     .near = near,
                     .old = item_of(painter, cell->cell),
                     .frozen = iso_mask_bits(iso_transaction_mask(t), cell->cell)};
    make_local_brush(painter->dabs, cell->at, &s.brush);
    if (near) t->dab->find_band(before, t->grid->band, &s.inside);
    iso_voxel_bits differing;
    make_colors(&s, cell->made->voxel);
    cell->differs = t->dab->find_recolored(s.old ? s.old->voxel : NULL, cell->made->voxel, &differing);
    cell->changed = differing;
    if (cell->differs && has_colors(cell->made)) return;
    iso_item_release(cell->made);
    cell->made = NULL;
}

iso_status iso_painter_finish(iso_painter *painter, bool *any, iso_error *error) {
    const iso_transaction *t = painter->transaction;
    *any = false;
    for (size_t i = 0; i < t->cell_count; i++) { /* those that redistancing has changed */
        const iso_edit_cell *edit_cell = iso_transaction_cell(t, i);
        if (edit_cell->edited) ISO_TRY(add_cell(painter, edit_cell->cell, edit_cell->at, error));
    }
    iso_parallel_for(t->pool, painter->cell_count, finish_cell, painter);
    if (painter->failed) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for the paint");
    for (size_t i = 0; i < painter->cell_count; i++) *any |= iso_painter_cell(painter, i)->differs;
    return ISO_OK;
}

/* ---- writing */

iso_status iso_painter_log(iso_painter *painter, iso_error *error) {
    iso_change_log_begin(painter->log);
    for (size_t i = 0; i < painter->cell_count; i++) {
        const iso_painted_cell *cell = iso_painter_cell(painter, i);
        int lo[3], hi[3];
        if (!cell->differs) continue;
        iso_edit_cell box;
        iso_transaction_find_box(&box, &cell->changed);
        for (int axis = 0; axis < 3; axis++) {
            lo[axis] = ISO_BRICK * cell->at[axis] + box.lo[axis];
            hi[axis] = ISO_BRICK * cell->at[axis] + box.hi[axis];
        }
        ISO_TRY(iso_change_log_add(painter->log, lo, hi, error));
    }
    return ISO_OK;
}

void iso_painter_commit(iso_painter *painter) {
    for (size_t i = 0; i < painter->cell_count; i++) {
        iso_painted_cell *cell = iso_painter_cell(painter, i);
        if (!cell->differs) continue;
        iso_cell_items_give(paint_of(painter), cell->cell, cell->made);
        cell->made = NULL;
    }
}

void iso_painter_clear(iso_painter *painter) {
    for (size_t i = 0; i < painter->cell_count; i++) {
        const iso_painted_cell *cell = iso_painter_cell(painter, i);
        painter->index_of[cell->cell] = 0;
        iso_item_release(cell->warped);
        iso_item_release(cell->made);
    }
    painter->cell_count = 0;
    painter->dabs = NULL;
    painter->failed = 0;
}
