/* The part of a touch after the brush: finds where redistancing starts and which neighbouring cells it may
 * change, makes the redistancing steps, and writes the result to the grid. Passes run in parallel
 * over cells; each reads one field of values and writes another, so threads do not change the result. */
#include "sculpt/edit/transaction.h"

#include <math.h>
#include <string.h>

#include "sculpt/edit/mask_boundary.h"

/* The width of the band in voxels: a change nearer than this to a face can change distances in the cell
 * beyond it. */
enum { NEIGHBOUR_DISTANCE = 3 };
enum { SPREAD = ISO_TRANSACTION_SPREAD };
/* A value of iso_edit_cell.sides. */
enum { BOTH_SIDES = 3 };
/* A redistancing step computes a row of voxels only if the step before changed a voxel in its stencils by
 * more than this, in voxels. The limit is smaller where the interface itself is rescaled, because distances
 * then travel farther in small steps. */
static const float LEAST_MOVE_FIXED = 0.02f, LEAST_MOVE_RESCALED = 0.01f;

iso_status iso_transaction_init(iso_transaction *transaction, iso_hgrid *grid, iso_pool *pool,
                                iso_error *error) {
    size_t cells = iso_hgrid_cell_count(grid);
    size_t threads = (size_t)iso_pool_threads(pool);
    transaction->grid = grid;
    transaction->pool = pool;
    transaction->redistancer = iso_redistancer_get(iso_cpu_best());
    transaction->dab = iso_dab_kernel_get(iso_cpu_best());
    transaction->edit_cell_of = iso_alloc_zero(cells, sizeof *transaction->edit_cell_of);
    transaction->workers = iso_alloc_zero(threads, sizeof *transaction->workers);
    for (int sign = 0; sign < 2; sign++) {
        transaction->constant[sign] = iso_alloc(ISO_BRICK_VOXELS * sizeof(float));
        for (int i = 0; transaction->constant[sign] && i < ISO_BRICK_VOXELS; i++)
            transaction->constant[sign][i] = sign ? -grid->band : grid->band;
    }
    iso_status status = iso_field_items_init(&transaction->items, cells, NULL);
    if (status == ISO_OK) status = iso_slabs_reserve(&transaction->slabs, 1, NULL);
    iso_slabs_prefault(&transaction->slabs);
    if (transaction->edit_cell_of && transaction->workers && transaction->constant[0] &&
        transaction->constant[1] && status == ISO_OK)
        return ISO_OK;
    iso_transaction_free(transaction);
    return iso_fail(error, ISO_ERR_NOMEM, "out of memory for sculpting %zu cells", cells);
}

void iso_transaction_free(iso_transaction *transaction) {
    iso_field_items_free(&transaction->items);
    iso_free(transaction->edit_cell_of);
    iso_free(transaction->constant[0]);
    iso_free(transaction->constant[1]);
    for (int i = 0; transaction->workers && i < iso_pool_threads(transaction->pool); i++) {
        iso_buffer_free(&transaction->workers[i].window);
        iso_buffer_free(&transaction->workers[i].edge_points);
    }
    iso_free(transaction->workers);
    iso_buffer_free(&transaction->cells);
    iso_buffer_free(&transaction->mask_boundaries);
    iso_slabs_free(&transaction->slabs);
}

void iso_transaction_clear(iso_transaction *transaction) {
    for (size_t i = 0; i < transaction->cell_count; i++)
        transaction->edit_cell_of[iso_transaction_cell(transaction, i)->cell] = 0;
    transaction->cell_count = 0;
    transaction->current = 0;
    transaction->redistanced = false;
    transaction->far_value = 0;
    transaction->band_damaged = false;
    transaction->progress = NULL;
    transaction->bricks_taken = 0;
    for (int i = 0; i < iso_pool_threads(transaction->pool); i++) transaction->workers[i].brick = NULL;
}

const iso_edit_cell *iso_transaction_neighbour(const iso_transaction *transaction,
                                               const iso_edit_cell *edit_cell, const int side[3]) {
    int at[3];
    for (int axis = 0; axis < 3; axis++) {
        at[axis] = edit_cell->at[axis] + side[axis];
        if (at[axis] < 0 || at[axis] >= transaction->grid->cells[axis]) return NULL;
    }
    const uint32_t number =
        transaction->edit_cell_of[iso_hgrid_cell_index(transaction->grid, at[0], at[1], at[2])];
    return number ? iso_transaction_cell(transaction, number - 1) : NULL;
}

const float *iso_transaction_grid_values(const iso_transaction *transaction, int32_t state) {
    if (state >= 0) return iso_hgrid_brick(transaction->grid, state);
    return transaction->constant[state == ISO_CELL_INSIDE];
}

bool iso_transaction_failed(iso_transaction *transaction) {
    bool failed = false;
    for (int i = 0; i < iso_pool_threads(transaction->pool); i++) {
        failed |= transaction->workers[i].failed;
        transaction->workers[i].failed = false;
    }
    return failed;
}

iso_status iso_transaction_add(iso_transaction *transaction, const int at[3], bool edited, iso_error *error) {
    uint32_t cell = (uint32_t)iso_hgrid_cell_index(transaction->grid, at[0], at[1], at[2]);
    if (transaction->edit_cell_of[cell]) return ISO_OK;
    size_t bytes = transaction->cell_count * sizeof(iso_edit_cell);
    ISO_TRY(iso_buffer_reserve(&transaction->cells, bytes + sizeof(iso_edit_cell), bytes, error));
    iso_edit_cell *edit_cell = iso_transaction_cell(transaction, transaction->cell_count++);
    *edit_cell = (iso_edit_cell){.cell = cell, .state = transaction->grid->cell[cell], .edited = edited};
    for (int axis = 0; axis < 3; axis++) edit_cell->at[axis] = at[axis];
    edit_cell->value[transaction->current] = iso_transaction_grid_values(transaction, edit_cell->state);
    transaction->edit_cell_of[cell] = (uint32_t)transaction->cell_count;
    return ISO_OK;
}

/* ---- memory */

/* Makes room for `bricks` scratch bricks beside those that are taken. */
static iso_status reserve_bricks(iso_transaction *transaction, size_t bricks, iso_error *error) {
    return iso_slabs_reserve(&transaction->slabs, transaction->bricks_taken + bricks, error);
}

/* Returns the next free scratch brick. Threads take them in any order, which does not affect results. */
static float *take_brick(iso_transaction *transaction) {
    return iso_slabs_get(&transaction->slabs,
                         __atomic_fetch_add(&transaction->bricks_taken, 1, __ATOMIC_RELAXED));
}

iso_status iso_transaction_reserve(iso_transaction *transaction, iso_error *error) {
    return reserve_bricks(transaction, transaction->cell_count + (size_t)iso_pool_threads(transaction->pool),
                          error);
}

/* Returns a scratch brick of the cell that is neither `one` nor `two`, which are still needed; takes a new
 * one if there is none. */
static float *own_brick_except(iso_transaction *transaction, iso_edit_cell *edit_cell, const float *one,
                               const float *two) {
    int i = 0;
    while (edit_cell->own[i] && (edit_cell->own[i] == one || edit_cell->own[i] == two)) i++;
    if (!edit_cell->own[i]) edit_cell->own[i] = take_brick(transaction);
    return edit_cell->own[i];
}

/* Whether `values` is one of the cell's scratch bricks, which may be overwritten. */
static bool is_own(const iso_edit_cell *edit_cell, const float *values) {
    bool own = false;
    for (int i = 0; i < ISO_TRANSACTION_FIELDS; i++) own |= edit_cell->own[i] == values;
    return own;
}

float *iso_transaction_own_values(iso_transaction *transaction, size_t number) {
    iso_edit_cell *edit_cell = iso_transaction_cell(transaction, number);
    const float *values = edit_cell->value[transaction->current];
    if (!is_own(edit_cell, values)) {
        float *own = own_brick_except(transaction, edit_cell, NULL, NULL);
        memcpy(own, values, ISO_BRICK_VOXELS * sizeof *own);
        edit_cell->value[transaction->current] = own;
    }
    return (float *)edit_cell->value[transaction->current];
}

/* ---- stencils */

/* Fills the brick that stands for the neighbour beyond a face on the grid's border: repeats the outermost
 * layer of the brick `self`. Only the parts that a stencil reads are filled: whole rows along x, two layers
 * along y and z. */
static void repeat_layer(const float *self, int face, float *out) {
    const int axis = face / 2, layer = face % 2 ? ISO_BRICK - 1 : 0;
    for (int row = 0; axis == 0 && row < ISO_BRICK_ROWS; row++)
        for (int x = 0; x < ISO_BRICK; x++) out[row * ISO_BRICK + x] = self[row * ISO_BRICK + layer];
    const int step = axis == 1 ? ISO_BRICK : ISO_BRICK_ROWS, along = axis == 1 ? ISO_BRICK_ROWS : ISO_BRICK;
    const int near = face % 2 ? 0 : ISO_BRICK - 1, next = face % 2 ? 1 : ISO_BRICK - 2;
    for (int i = 0; axis > 0 && i < ISO_BRICK; i++) {
        const float *from = self + layer * step + i * along;
        memcpy(out + near * step + i * along, from, ISO_BRICK * sizeof *out);
        memcpy(out + next * step + i * along, from, ISO_BRICK * sizeof *out);
    }
}

void iso_transaction_stencil(const iso_transaction *transaction, int field, size_t number,
                             iso_border_bricks *border, iso_stencil *stencil) {
    const iso_edit_cell *edit_cell = iso_transaction_cell(transaction, number);
    const bool grid = field == ISO_TRANSACTION_GRID;
    stencil->self =
        grid ? iso_transaction_grid_values(transaction, edit_cell->state) : edit_cell->value[field];
    for (int face = 0; face < 6; face++) {
        int at[3] = {edit_cell->at[0], edit_cell->at[1], edit_cell->at[2]};
        at[face / 2] += face % 2 ? 1 : -1;
        if (at[face / 2] < 0 || at[face / 2] >= transaction->grid->cells[face / 2]) {
            repeat_layer(stencil->self, face, border->face[face]);
            stencil->face[face] = border->face[face];
            continue;
        }
        size_t cell = iso_hgrid_cell_index(transaction->grid, at[0], at[1], at[2]);
        uint32_t beside = grid ? 0 : transaction->edit_cell_of[cell];
        stencil->face[face] = beside
                                  ? iso_transaction_cell(transaction, beside - 1)->value[field]
                                  : iso_transaction_grid_values(transaction, transaction->grid->cell[cell]);
    }
}

/* ---- finding changes */

void iso_transaction_find_box(iso_edit_cell *edit_cell, const iso_voxel_bits *marked) {
    enum { LOW = (1 << SPREAD) - 1, HIGH = LOW << (ISO_BRICK - SPREAD) };
    uint32_t x = 0, y = 0, z = 0;
    for (int i = 0; i < ISO_BRICK; i++) {
        uint32_t any = 0, low = 0, high = 0;
        for (int k = 0; k < ISO_BRICK; k++) {
            const uint32_t bits = marked->row[i * ISO_BRICK + k];
            x |= bits;
            any |= (uint32_t)(bits != 0) << k;
            low |= (uint32_t)((bits & LOW) != 0) << k;
            high |= (uint32_t)((bits & HIGH) != 0) << k;
        }
        edit_cell->rows.any[i] = (uint16_t)any;
        edit_cell->rows.low[i] = (uint16_t)low;
        edit_cell->rows.high[i] = (uint16_t)high;
        y |= any;
        z |= (uint32_t)(any != 0) << i;
    }
    const uint32_t bits[3] = {x, y, z};
    for (int axis = 0; axis < 3; axis++) {
        edit_cell->lo[axis] = (uint8_t)__builtin_ctz(bits[axis] | 1u << 31);
        edit_cell->hi[axis] = (uint8_t)(31 - __builtin_clz(bits[axis] | 1));
    }
}

float *iso_transaction_scratch_brick(iso_transaction *transaction, int worker) {
    iso_worker_scratch *scratch = &transaction->workers[worker];
    if (!scratch->brick) scratch->brick = take_brick(transaction);
    return scratch->brick;
}

/* If the cell has a `source` (MOVE), `changed` is relative to it: voxels that merely return to their original
 * value do not affect their neighbours. The cell is edited if its values differ from the grid. */
void iso_transaction_accept_scratch(iso_transaction *transaction, size_t number, int worker) {
    iso_edit_cell *edit_cell = iso_transaction_cell(transaction, number);
    float *values = transaction->workers[worker].brick;
    const float *before = iso_transaction_grid_values(transaction, edit_cell->state);
    edit_cell->edited = transaction->dab->find_changes(
        edit_cell->source ? edit_cell->source : before,
        iso_mask_bits(iso_transaction_mask(transaction), edit_cell->cell), values, &edit_cell->changed);
    if (edit_cell->source)
        edit_cell->edited |= memcmp(values, before, ISO_BRICK_VOXELS * sizeof *values) != 0;
    if (!edit_cell->edited) return;
    edit_cell->value[transaction->current] = edit_cell->own[0] = values;
    transaction->workers[worker].brick = NULL;
}

void iso_transaction_empty(iso_transaction *transaction, size_t number) {
    iso_edit_cell *edit_cell = iso_transaction_cell(transaction, number);
    const float *before = iso_transaction_grid_values(transaction, edit_cell->state);
    float *outside = transaction->constant[0]; /* (not written where nothing is frozen) */
    edit_cell->edited = transaction->dab->find_changes(before, NULL, outside, &edit_cell->changed);
    if (edit_cell->edited) edit_cell->value[transaction->current] = outside;
}

/* Removes the cells that the brush did not change from the list. */
static void drop_unchanged(iso_transaction *transaction) {
    size_t kept = 0;
    for (size_t i = 0; i < transaction->cell_count; i++) {
        const iso_edit_cell *edit_cell = iso_transaction_cell(transaction, i);
        transaction->edit_cell_of[edit_cell->cell] = 0;
        if (!edit_cell->edited) continue;
        if (kept != i) *iso_transaction_cell(transaction, kept) = *edit_cell;
        transaction->edit_cell_of[edit_cell->cell] = (uint32_t)++kept;
    }
    transaction->cell_count = kept;
}

/* Finds where the redistancing of an edited cell starts: at its seams or, if far_value is 0, at all changed
 * voxels. */
static void find_seam_in_cell(void *context, size_t index, int worker) {
    static const iso_voxel_bits none;
    iso_transaction *transaction = context;
    iso_edit_cell *edit_cell = iso_transaction_cell(transaction, index);
    iso_voxel_bits seam;
    if (transaction->far_value == 0) {
        iso_transaction_find_box(edit_cell, &edit_cell->changed);
        return;
    }
    iso_stencil stencil;
    iso_transaction_stencil(transaction, transaction->current, index, transaction->workers[worker].border,
                            &stencil);
    iso_changed_stencil side = {.self = &edit_cell->changed, .far_value = transaction->far_value};
    for (int face = 0; face < 6; face++) {
        int sides[3] = {0};
        sides[face / 2] = face % 2 ? 1 : -1;
        const iso_edit_cell *beside = iso_transaction_neighbour(transaction, edit_cell, sides);
        side.face[face] = beside ? &beside->changed : &none;
    }
    transaction->redistancer->find_seam(&stencil, &side, &seam);
    iso_transaction_find_box(edit_cell, &seam);
}

/* Whether a cell has a voxel inside the band that is within NEIGHBOUR_DISTANCE voxels of its neighbour at
 * `side`. */
static bool band_is_near(const iso_transaction *transaction, size_t number, const int side[3]) {
    const float *values = iso_transaction_values(transaction, number), band = transaction->grid->band;
    int lo[3], hi[3];
    for (int axis = 0; axis < 3; axis++) {
        lo[axis] = side[axis] > 0 ? ISO_BRICK - NEIGHBOUR_DISTANCE : 0;
        hi[axis] = side[axis] < 0 ? NEIGHBOUR_DISTANCE - 1 : ISO_BRICK - 1;
    }
    for (int z = lo[2]; z <= hi[2]; z++)
        for (int y = lo[1]; y <= hi[1]; y++)
            for (int x = lo[0]; x <= hi[0]; x++)
                if (fabsf(values[(z * ISO_BRICK + y) * ISO_BRICK + x]) < band) return true;
    return false;
}

/* Whether redistancing of a cell starts at a voxel within NEIGHBOUR_DISTANCE voxels of its neighbour at
 * `side`. */
static bool start_is_near(const iso_edit_cell *edit_cell, const int side[3]) {
    for (int axis = 0; axis < 3; axis++)
        if ((side[axis] < 0 && edit_cell->lo[axis] >= NEIGHBOUR_DISTANCE) ||
            (side[axis] > 0 && edit_cell->hi[axis] < ISO_BRICK - NEIGHBOUR_DISTANCE))
            return false;
    return true;
}

/* Lists the neighbours of an edited cell whose distances its redistancing can change. */
static iso_status add_neighbours(iso_transaction *transaction, size_t number, iso_error *error) {
    for (int k = 0; k < 27; k++) {
        const iso_edit_cell *edit_cell = iso_transaction_cell(
            transaction, number); /* fetched again, because adding a cell may move the list */
        const int side[3] = {k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1};
        int at[3];
        bool within = true;
        for (int axis = 0; axis < 3; axis++) {
            at[axis] = edit_cell->at[axis] + side[axis];
            within &= at[axis] >= 0 && at[axis] < transaction->grid->cells[axis];
        }
        if (!within || !start_is_near(edit_cell, side)) continue;
        int32_t state = transaction->grid->cell[iso_hgrid_cell_index(transaction->grid, at[0], at[1], at[2])];
        if (state < 0 && !transaction->band_damaged && !band_is_near(transaction, number, side)) continue;
        ISO_TRY(iso_transaction_add(transaction, at, false, error));
    }
    return ISO_OK;
}

iso_status iso_transaction_end_brush(iso_transaction *transaction, bool neighbours, bool *any,
                                     iso_error *error) {
    drop_unchanged(transaction);
    size_t edited = transaction->cell_count;
    *any = edited > 0;
    if (!neighbours) return ISO_OK;
    const bool frozen = iso_mask_boundary_any_frozen(transaction);
    if (frozen) { /* a surface cut off at frozen voxels leaves gaps in the band beyond the voxels that the
                     brush changed */
        transaction->far_value = 0;
        transaction->band_damaged = true;
        ISO_TRY(iso_mask_boundary_limit_changed(transaction, error));
    }
    iso_parallel_for(transaction->pool, edited, find_seam_in_cell, transaction);
    for (size_t i = 0; i < edited; i++) ISO_TRY(add_neighbours(transaction, i, error));
    if (!frozen) return ISO_OK;
    ISO_TRY(reserve_bricks(transaction, transaction->cell_count, error));
    iso_mask_boundary_limit_frozen(transaction);
    return ISO_OK;
}

/* ---- redistancing */

typedef struct redistance_pass {
    iso_transaction *transaction;
    int from, to, phi; /* the fields that are read and written, and the one with the values after the brush */
    int turn;          /* index in iso_edit_cell.moved of the set that this step writes */
    bool first;        /* the first step: all active rows are due */
    float least;       /* see iso_relaxation */
} redistance_pass;

/* Adds to `plane` the marked rows of the neighbour at `side` that lie within SPREAD voxels of this cell, in
 * coordinates of this cell: bit y + SPREAD of plane[z + SPREAD]. */
static void add_rows(const iso_edit_cell *beside, const int side[3], uint32_t plane[ISO_BRICK + 2 * SPREAD]) {
    const uint16_t *rows = side[0] == 0  ? beside->rows.any
                           : side[0] < 0 ? beside->rows.high
                                         : beside->rows.low;
    const int first = side[2] < 0 ? ISO_BRICK - SPREAD : 0, last = side[2] > 0 ? SPREAD - 1 : ISO_BRICK - 1;
    for (int z = first; z <= last; z++) {
        const uint32_t bits = rows[z], into = side[1] == 0 ? bits << SPREAD
                                              : side[1] < 0
                                                  ? bits >> (ISO_BRICK - SPREAD)
                                                  : (bits & ((1 << SPREAD) - 1)) << (ISO_BRICK + SPREAD);
        plane[z + ISO_BRICK * side[2] + SPREAD] |= into;
    }
}

/* Add to a set the rows of slice z, and return them: bit y. */
static void add_slice_rows(iso_row_bits *rows, int z, uint32_t bits) {
    rows->word[z / 2] |= (bits & 0xffff) << 16 * (z % 2);
}

static uint32_t slice_rows(const iso_row_bits *rows, int z) {
    return rows->word[z / 2] >> 16 * (z % 2) & 0xffff;
}

/* Finds the rows of a cell that have a voxel within SPREAD voxels of those that redistancing starts from.
 * Only these rows are redistanced; in the others all values are distances already. */
static void find_near_rows(const iso_transaction *transaction, const iso_edit_cell *edit_cell,
                           iso_row_bits *near) {
    uint32_t plane[ISO_BRICK + 2 * SPREAD] = {0};
    for (int k = 0; k < 27; k++) {
        const int side[3] = {k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1};
        const iso_edit_cell *beside = iso_transaction_neighbour(transaction, edit_cell, side);
        if (beside && beside->edited) add_rows(beside, side, plane);
    }
    for (int z = 0; z < ISO_BRICK + 2 * SPREAD; z++)
        for (int step = 0; step < SPREAD; step++) plane[z] |= plane[z] << 1 | plane[z] >> 1;
    memset(near, 0, sizeof *near);
    for (int z = 0; z < ISO_BRICK; z++) {
        uint32_t rows = 0;
        for (int step = 0; step <= 2 * SPREAD; step++) rows |= plane[z + step];
        add_slice_rows(near, z, rows >> SPREAD);
    }
}

/* Takes frozen voxels out of redistancing: none is rescaled, and those beyond the influence of the change are
 * fixed. */
static void fix_masked(const iso_transaction *transaction, iso_edit_cell *edit_cell,
                       const iso_voxel_bits *masked) {
    iso_voxel_bits reached;
    iso_mask_boundary_influence(transaction, edit_cell, &reached);
    for (int row = 0; row < ISO_BRICK_ROWS; row++) {
        const uint16_t beyond = masked->row[row] & (uint16_t)~reached.row[row];
        edit_cell->band.fixed.row[row] |= beyond;
        edit_cell->band.unknown.row[row] &= (uint16_t)~masked->row[row];
        edit_cell->has_fixed_mask |= beyond != 0;
    }
}

static void classify_cell(void *context, size_t index, int worker) {
    const redistance_pass *p = context;
    iso_edit_cell *edit_cell = iso_transaction_cell(p->transaction, index);
    iso_stencil stencil;
    iso_row_bits near;
    iso_transaction_stencil(p->transaction, p->from, index, p->transaction->workers[worker].border, &stencil);
    find_near_rows(p->transaction, edit_cell, &near);
    p->transaction->redistancer->classify(&stencil, p->transaction->grid->band, &near, &edit_cell->band);
    if (p->transaction->band_damaged) edit_cell->band.active = near;
    const iso_voxel_bits *masked = iso_mask_bits(iso_transaction_mask(p->transaction), edit_cell->cell);
    if (masked) fix_masked(p->transaction, edit_cell, masked);
}

/* Whether the cell has voxels to rescale: interface voxels that the brush changed, or that have a clamped
 * value. */
static bool needs_rescaling(const iso_edit_cell *edit_cell) {
    uint32_t any = 0;
    for (int row = 0; row < ISO_BRICK_ROWS; row++)
        any |=
            (edit_cell->band.fixed.row[row] & edit_cell->changed.row[row]) | edit_cell->band.unknown.row[row];
    return any != 0;
}

static void rescale_cell(void *context, size_t index, int worker) {
    const redistance_pass *p = context;
    iso_edit_cell *edit_cell = iso_transaction_cell(p->transaction, index);
    edit_cell->value[p->to] = edit_cell->value[p->from];
    if (!needs_rescaling(edit_cell)) return;
    iso_stencil stencil;
    iso_transaction_stencil(p->transaction, p->from, index, p->transaction->workers[worker].border, &stencil);
    float *out = own_brick_except(p->transaction, edit_cell, stencil.self, NULL);
    p->transaction->redistancer->rescale(&stencil, &edit_cell->band, &edit_cell->changed, out);
    edit_cell->value[p->to] = out;
}

static void correct_cell(void *context, size_t index, int worker) {
    const redistance_pass *p = context;
    iso_edit_cell *edit_cell = iso_transaction_cell(p->transaction, index);
    edit_cell->value[p->to] = edit_cell->value[p->from];
    if (!needs_rescaling(edit_cell)) return;
    iso_stencil phi, scaled;
    iso_transaction_stencil(p->transaction, p->phi, index, &p->transaction->workers[worker].border[0], &phi);
    iso_transaction_stencil(p->transaction, p->from, index, &p->transaction->workers[worker].border[1],
                            &scaled);
    float *out = own_brick_except(p->transaction, edit_cell, phi.self, scaled.self);
    p->transaction->redistancer->correct(&phi, &scaled, &edit_cell->band, &edit_cell->changed, out);
    edit_cell->value[p->to] = out;
}

/* Finds the active rows whose stencils contain a row in which the last step moved a voxel. */
static void find_due(const redistance_pass *p, const iso_edit_cell *edit_cell, iso_row_bits *due) {
    enum { FAR = 2 }; /* how far a stencil extends, in voxels */
    uint32_t plane[ISO_BRICK + 2 * FAR] = {0}, across[ISO_BRICK] = {0}; /* bit y + FAR; bit y */
    const int last = 1 - p->turn;
    for (int z = 0; z < ISO_BRICK; z++) plane[z + FAR] = slice_rows(&edit_cell->moved[last], z) << FAR;
    for (int face = 0; face < 6; face++) {
        const int up = face % 2, side[3] = {face / 2 == 0 ? 2 * up - 1 : 0, face / 2 == 1 ? 2 * up - 1 : 0,
                                            face / 2 == 2 ? 2 * up - 1 : 0};
        const iso_edit_cell *beside = iso_transaction_neighbour(p->transaction, edit_cell, side);
        if (!beside) continue;
        const iso_row_bits *moved = &beside->moved[last];
        for (int z = 0; z < ISO_BRICK && side[0]; z++) across[z] |= slice_rows(moved, z);
        for (int z = 0; z < ISO_BRICK && side[1]; z++)
            plane[z + FAR] |= up ? (slice_rows(moved, z) & ((1 << FAR) - 1)) << (ISO_BRICK + FAR)
                                 : slice_rows(moved, z) >> (ISO_BRICK - FAR);
        for (int z = 0; z < FAR && side[2]; z++)
            plane[up ? ISO_BRICK + FAR + z : z] |= slice_rows(moved, up ? z : ISO_BRICK - FAR + z) << FAR;
    }
    memset(due, 0, sizeof *due);
    for (int z = 0; z < ISO_BRICK; z++) {
        uint32_t rows = plane[z + FAR];
        rows |= rows << 1 | rows << 2 | rows >> 1 | rows >> 2;
        rows |= plane[z] | plane[z + 1] | plane[z + 3] | plane[z + 4];
        add_slice_rows(due, z, rows >> FAR | across[z]);
    }
    for (int i = 0; i < ISO_ROW_WORDS; i++) due->word[i] &= edit_cell->band.active.word[i];
}

/* Computes one redistancing step of a cell, in the rows where it is due. */
static void relax_cell(void *context, size_t index, int worker) {
    const redistance_pass *p = context;
    iso_transaction *transaction = p->transaction;
    iso_edit_cell *edit_cell = iso_transaction_cell(transaction, index);
    iso_relaxation step = {.due = edit_cell->band.active, .band = transaction->grid->band, .least = p->least};
    if (!p->first) find_due(p, edit_cell, &step.due);
    uint32_t any = 0;
    for (int i = 0; i < ISO_ROW_WORDS; i++) any |= step.due.word[i];
    edit_cell->value[p->to] = edit_cell->value[p->from];
    memset(&edit_cell->moved[p->turn], 0, sizeof edit_cell->moved[p->turn]);
    if (!any) return;
    iso_stencil stencil;
    iso_transaction_stencil(transaction, p->from, index, transaction->workers[worker].border, &stencil);
    float *out =
        edit_cell->spare ? edit_cell->spare : own_brick_except(transaction, edit_cell, stencil.self, NULL);
    if (edit_cell->spare)
        step.stale = edit_cell->stale;
    else
        memset(&step.stale, 0xff, sizeof step.stale);
    transaction->redistancer->relax(&stencil, &edit_cell->band.fixed, &step, out, &edit_cell->moved[p->turn]);
    edit_cell->value[p->to] = out;
    edit_cell->stale = step.due;
    edit_cell->spare = is_own(edit_cell, stencil.self) ? (float *)stencil.self : NULL;
}

static void run_pass(const redistance_pass *p, iso_task *task) {
    iso_parallel_for(p->transaction->pool, p->transaction->cell_count, task, (void *)p);
}

iso_status iso_transaction_redistance(iso_transaction *transaction, int iterations, bool rescale,
                                      iso_error *error) {
    redistance_pass p = {.transaction = transaction,
                         .from = transaction->current,
                         .to = (transaction->current + 1) % ISO_TRANSACTION_FIELDS,
                         .phi = transaction->current,
                         .first = true,
                         .least = rescale ? LEAST_MOVE_RESCALED : LEAST_MOVE_FIXED};
    ISO_TRY(reserve_bricks(transaction, transaction->cell_count * (rescale ? 3 : 2), error));
    run_pass(&p, classify_cell);
    transaction->redistanced = true;
    if (rescale) {
        run_pass(&p, rescale_cell);
        p.from = p.to;
        p.to = (p.phi + 2) % ISO_TRANSACTION_FIELDS;
        run_pass(&p, correct_cell);
        p.from = p.to;
        p.to = p.phi;
    }
    for (int i = 0; i < iterations; i++) {
        ISO_TRY(iso_progress_tell(transaction->progress, "the field", (double)i / iterations, error));
        p.turn = i % 2;
        p.first = i == 0;
        run_pass(&p, relax_cell);
        const int swap = p.from;
        p.from = p.to;
        p.to = swap;
    }
    transaction->current = p.from;
    return ISO_OK;
}

static void find_sides(void *context, size_t index, int worker) {
    (void)worker;
    const iso_transaction *transaction = context;
    iso_edit_cell *edit_cell = iso_transaction_cell(transaction, index);
    edit_cell->sides =
        edit_cell->has_fixed_mask
            ? BOTH_SIDES
            : (uint8_t)transaction->redistancer->sides(iso_transaction_values(transaction, index));
}

/* Returns the sides of the surface that the voxels of a cell may be on: both for a brick that is not listed,
 * whose values are not read. */
static unsigned sides_of(const iso_transaction *transaction, const int at[3]) {
    const size_t cell = iso_hgrid_cell_index(transaction->grid, at[0], at[1], at[2]);
    if (transaction->edit_cell_of[cell])
        return iso_transaction_cell(transaction, transaction->edit_cell_of[cell] - 1)->sides;
    return transaction->grid->cell[cell] >= 0 ? BOTH_SIDES
                                              : 1u << (transaction->grid->cell[cell] == ISO_CELL_INSIDE);
}

/* Clamps all values of a cell if all voxels of the cell and of its 26 neighbours are on one side: the values
 * are then distances to a surface that the touch removed. */
static void clamp_without_interface(void *context, size_t index, int worker) {
    (void)worker;
    iso_transaction *transaction = context;
    iso_edit_cell *edit_cell = iso_transaction_cell(transaction, index);
    unsigned sides = edit_cell->sides;
    for (int k = 0; k < 27 && sides != BOTH_SIDES; k++) {
        const int at[3] = {edit_cell->at[0] + k % 3 - 1, edit_cell->at[1] + k / 3 % 3 - 1,
                           edit_cell->at[2] + k / 9 - 1};
        bool within = true;
        for (int axis = 0; axis < 3; axis++)
            within &= at[axis] >= 0 && at[axis] < transaction->grid->cells[axis];
        if (within) sides |= sides_of(transaction, at);
    }
    if (sides != BOTH_SIDES) edit_cell->value[transaction->current] = transaction->constant[sides >> 1];
}

static void compare_cell(void *context, size_t index, int worker) {
    (void)worker;
    const iso_transaction *transaction = context;
    iso_edit_cell *edit_cell = iso_transaction_cell(transaction, index);
    const float *before = iso_transaction_grid_values(transaction, edit_cell->state),
                *values = iso_transaction_values(transaction, index);
    edit_cell->edited = before != values &&
                        transaction->dab->find_changes(before, NULL, (float *)values, &edit_cell->changed);
    if (edit_cell->edited) iso_transaction_find_box(edit_cell, &edit_cell->changed);
}

void iso_transaction_compare(iso_transaction *transaction, bool *any) {
    if (transaction->redistanced) {
        iso_parallel_for(transaction->pool, transaction->cell_count, find_sides, transaction);
        iso_parallel_for(transaction->pool, transaction->cell_count, clamp_without_interface, transaction);
    }
    iso_parallel_for(transaction->pool, transaction->cell_count, compare_cell, transaction);
    *any = false;
    for (size_t i = 0; i < transaction->cell_count; i++) *any |= iso_transaction_cell(transaction, i)->edited;
}

/* ---- writing */

/* Returns ISO_CELL_OUTSIDE or ISO_CELL_INSIDE if all values of a cell are +band or all are -band, otherwise
 * 0. */
static int32_t empty_state(const iso_transaction *transaction, const float *values) {
    const float first = values[0], band = transaction->grid->band;
    if (first != band && first != -band) return 0;
    int same = 1;
    for (int i = 0; i < ISO_BRICK_VOXELS && same; i += ISO_BRICK)
        for (int k = 0; k < ISO_BRICK; k++) same &= values[i + k] == first;
    return !same ? 0 : first > 0 ? ISO_CELL_OUTSIDE : ISO_CELL_INSIDE;
}

static void find_empty(void *context, size_t index, int worker) {
    (void)worker;
    const iso_transaction *transaction = context;
    iso_edit_cell *edit_cell = iso_transaction_cell(transaction, index);
    if (edit_cell->edited)
        edit_cell->empty = empty_state(transaction, iso_transaction_values(transaction, index));
}

/* Does the part of a commit that can fail: adds entries to the change log (superfluous ones do no harm) and
 * allocates bricks, still uninitialised. */
static iso_status prepare_commit(iso_transaction *transaction, iso_edit_stats *stats, iso_error *error) {
    iso_change_log_begin(transaction->grid->log);
    for (size_t i = 0; i < transaction->cell_count; i++) {
        const iso_edit_cell *edit_cell = iso_transaction_cell(transaction, i);
        if (!edit_cell->edited) continue;
        int lo[3], hi[3];
        for (int axis = 0; axis < 3; axis++) {
            lo[axis] = ISO_BRICK * edit_cell->at[axis] + edit_cell->lo[axis];
            hi[axis] = ISO_BRICK * edit_cell->at[axis] + edit_cell->hi[axis];
        }
        ISO_TRY(iso_change_log_add(transaction->grid->log, lo, hi, error));
        if (edit_cell->state >= 0 || edit_cell->empty) continue;
        ISO_TRY(iso_hgrid_split_unset(transaction->grid, edit_cell->at[0], edit_cell->at[1], edit_cell->at[2],
                                      error));
        stats->created++;
    }
    return ISO_OK;
}

/* Makes the cells empty again for which prepare_commit allocated bricks. */
static void undo_prepare(iso_transaction *transaction) {
    for (size_t i = 0; i < transaction->cell_count; i++) {
        const iso_edit_cell *edit_cell = iso_transaction_cell(transaction, i);
        if (edit_cell->state < 0)
            iso_hgrid_coalesce(transaction->grid, edit_cell->at[0], edit_cell->at[1], edit_cell->at[2],
                               edit_cell->state);
    }
}

iso_status iso_transaction_commit(iso_transaction *transaction, iso_edit_stats *stats, iso_error *error) {
    iso_edit_stats made = *stats;
    iso_parallel_for(transaction->pool, transaction->cell_count, find_empty, transaction);
    iso_status status = prepare_commit(transaction, &made, error);
    if (status != ISO_OK) {
        undo_prepare(transaction);
        return status;
    }
    for (size_t i = 0; i < transaction->cell_count; i++) {
        const iso_edit_cell *edit_cell = iso_transaction_cell(transaction, i);
        if (!edit_cell->edited) continue;
        if (edit_cell->empty) {
            made.pruned += edit_cell->state >= 0;
            iso_hgrid_coalesce(transaction->grid, edit_cell->at[0], edit_cell->at[1], edit_cell->at[2],
                               edit_cell->empty);
        } else
            memcpy(iso_hgrid_brick(transaction->grid, transaction->grid->cell[edit_cell->cell]),
                   iso_transaction_values(transaction, i), ISO_BRICK_VOXELS * sizeof(float));
    }
    *stats = made;
    return ISO_OK;
}
