/* Limits distances on both sides of a surface that a brush has brought up to frozen voxels. */
#include "sculpt/edit/mask_boundary.h"

#include <math.h>

static const float HALF = 0.5f; /* half the distance between neighbouring voxels */

/* A voxel whose distance was limited: the index of its edit cell, and its offset in the brick. */
typedef struct boundary_voxel {
    uint32_t edit_cell;
    uint16_t at;
} boundary_voxel;

/* A voxel of any cell, listed in the transaction or not. */
typedef struct voxel_ref {
    uint32_t cell, edit_cell; /* number of the grid's cell; 1 + the index of its edit cell, 0: not listed */
    int at;                   /* offset in the brick */
} voxel_ref;

static bool is_bit(const iso_voxel_bits *bits, int at) {
    return bits->row[at / ISO_BRICK] >> at % ISO_BRICK & 1;
}

static bool is_masked(const iso_transaction *transaction, const voxel_ref *p) {
    const iso_voxel_bits *bits = iso_mask_bits(iso_transaction_mask(transaction), p->cell);
    return bits && is_bit(bits, p->at);
}

static bool is_changed(const iso_transaction *transaction, const voxel_ref *p) {
    return p->edit_cell && is_bit(&iso_transaction_cell(transaction, p->edit_cell - 1)->changed, p->at);
}

static float value_of(const iso_transaction *transaction, const voxel_ref *p) {
    return p->edit_cell ? iso_transaction_values(transaction, p->edit_cell - 1)[p->at]
                        : iso_transaction_grid_values(transaction, transaction->grid->cell[p->cell])[p->at];
}

/* Finds the neighbour of voxel p beyond a face (0 .. 5: -x, +x, -y, +y, -z, +z). Returns false if it lies
 * outside the grid. */
static bool get_neighbour(const iso_transaction *transaction, const voxel_ref *p, int face, voxel_ref *out) {
    const int axis = face / 2, step = axis == 0 ? 1 : axis == 1 ? ISO_BRICK : ISO_BRICK_ROWS;
    const int *cells = transaction->grid->cells, up = face % 2, at = p->at / step % ISO_BRICK;
    *out = *p;
    if (at != (up ? ISO_BRICK - 1 : 0)) {
        out->at += up ? step : -step;
        return true;
    }
    const uint32_t stride = axis == 0 ? 1 : (uint32_t)cells[0] * (axis == 1 ? 1 : (uint32_t)cells[1]);
    const int cell = (int)(p->cell / stride % (uint32_t)cells[axis]);
    if (cell == (up ? cells[axis] - 1 : 0)) return false;
    out->cell = up ? p->cell + stride : p->cell - stride;
    out->edit_cell = transaction->edit_cell_of[out->cell];
    out->at -= (up ? 1 : -1) * (ISO_BRICK - 1) * step;
    return true;
}

/* Like get_neighbour, but returns false also if the neighbour is on the same side of the surface. */
static bool get_neighbour_across(const iso_transaction *transaction, const voxel_ref *p, int face,
                                 voxel_ref *out) {
    return get_neighbour(transaction, p, face, out) &&
           (value_of(transaction, p) < 0) != (value_of(transaction, out) < 0);
}

/* Like get_neighbour_across, but returns false also if the neighbour is not frozen. */
static bool get_frozen_across(const iso_transaction *transaction, const voxel_ref *changed, int face,
                              voxel_ref *frozen) {
    return get_neighbour_across(transaction, changed, face, frozen) && is_masked(transaction, frozen);
}

/* Returns the largest distance, in voxels, that a changed voxel may have: its present distance, or less if a
 * frozen neighbour lies across the surface. Sets *limited to whether there is such a neighbour. */
static float bound_changed(const iso_transaction *transaction, const voxel_ref *changed, bool *limited) {
    float most = fabsf(value_of(transaction, changed));
    voxel_ref frozen;
    *limited = false;
    for (int face = 0; face < 6; face++) {
        if (!get_frozen_across(transaction, changed, face, &frozen)) continue;
        *limited = true;
        most = fminf(most, fmaxf(1 - fabsf(value_of(transaction, &frozen)), HALF));
    }
    return most;
}

bool iso_mask_boundary_any_frozen(const iso_transaction *transaction) {
    for (size_t i = 0; i < transaction->cell_count && iso_transaction_mask(transaction)->used; i++) {
        const iso_edit_cell *edit_cell = iso_transaction_cell(transaction, i);
        for (int k = 0; k < 27 && edit_cell->edited; k++) {
            const int at[3] = {edit_cell->at[0] + k % 3 - 1, edit_cell->at[1] + k / 3 % 3 - 1,
                               edit_cell->at[2] + k / 9 - 1};
            bool within = true;
            for (int axis = 0; axis < 3; axis++)
                within &= at[axis] >= 0 && at[axis] < transaction->grid->cells[axis];
            if (within && iso_mask_bits(iso_transaction_mask(transaction),
                                        iso_hgrid_cell_index(transaction->grid, at[0], at[1], at[2])))
                return true;
        }
    }
    return false;
}

/* Returns the voxels of a row that have a frozen face neighbour: bit x for voxel x. */
static uint32_t beside_frozen(const iso_transaction *transaction, uint32_t cell, int row) {
    uint32_t bits = 0;
    voxel_ref from = {.cell = cell}, to;
    for (int face = 0; face < 6; face++) {
        const int end = face == 1 ? ISO_BRICK - 1 : 0;
        from.at = row * ISO_BRICK + end;
        if (face < 2) { /* the neighbours in the same row */
            const iso_voxel_bits *own = iso_mask_bits(iso_transaction_mask(transaction), cell);
            const uint32_t frozen = own ? own->row[row] : 0;
            bits |= face ? frozen >> 1 : frozen << 1;
            if (get_neighbour(transaction, &from, face, &to))
                bits |= (uint32_t)is_masked(transaction, &to) << end;
        } else if (get_neighbour(transaction, &from, face, &to)) {
            const iso_voxel_bits *other = iso_mask_bits(iso_transaction_mask(transaction), to.cell);
            bits |= other ? other->row[to.at / ISO_BRICK] : 0;
        }
    }
    return bits;
}

static iso_status find_in_row(iso_transaction *transaction, uint32_t number, int row, iso_error *error) {
    iso_edit_cell *edit_cell = iso_transaction_cell(transaction, number);
    if (!edit_cell->changed.row[row]) return ISO_OK;
    uint32_t bits = edit_cell->changed.row[row] & beside_frozen(transaction, edit_cell->cell, row);
    for (; bits; bits &= bits - 1) {
        const voxel_ref changed = {edit_cell->cell, number + 1, row * ISO_BRICK + __builtin_ctz(bits)};
        bool limited;
        const float most = bound_changed(transaction, &changed, &limited);
        if (!limited) continue;
        const size_t bytes = transaction->mask_boundary_count * sizeof(boundary_voxel);
        ISO_TRY(
            iso_buffer_reserve(&transaction->mask_boundaries, bytes + sizeof(boundary_voxel), bytes, error));
        ((boundary_voxel *)transaction->mask_boundaries.data)[transaction->mask_boundary_count++] =
            (boundary_voxel){number, (uint16_t)changed.at};
        float *value = &edit_cell->own[0][changed.at];
        *value = *value < 0 ? -most : most;
    }
    return ISO_OK;
}

iso_status iso_mask_boundary_limit_changed(iso_transaction *transaction, iso_error *error) {
    transaction->mask_boundary_count = 0;
    for (uint32_t edit_cell = 0; edit_cell < transaction->cell_count; edit_cell++)
        for (int row = 0; row < ISO_BRICK_ROWS; row++)
            ISO_TRY(find_in_row(transaction, edit_cell, row, error));
    return ISO_OK;
}

/* Whether the surface passes between a frozen voxel and a face neighbour that the brush did not change. */
static bool is_at_unchanged_surface(const iso_transaction *transaction, const voxel_ref *frozen) {
    voxel_ref other;
    for (int face = 0; face < 6; face++)
        if (get_neighbour_across(transaction, frozen, face, &other) && !is_changed(transaction, &other))
            return true;
    return false;
}

void iso_mask_boundary_limit_frozen(iso_transaction *transaction) {
    for (size_t i = 0; i < transaction->mask_boundary_count; i++) {
        const boundary_voxel *voxel = (const boundary_voxel *)transaction->mask_boundaries.data + i;
        const voxel_ref changed = {iso_transaction_cell(transaction, voxel->edit_cell)->cell,
                                   voxel->edit_cell + 1, voxel->at};
        const float left = 1 - fabsf(value_of(transaction, &changed));
        voxel_ref frozen;
        for (int face = 0; face < 6; face++) {
            if (!get_frozen_across(transaction, &changed, face, &frozen) ||
                is_at_unchanged_surface(transaction, &frozen))
                continue;
            const float value = value_of(transaction, &frozen);
            if (fabsf(value) <= left) continue;
            iso_transaction_own_values(transaction, frozen.edit_cell - 1)[frozen.at] =
                value < 0 ? -left : left;
        }
    }
}

/* A set of voxels of a cell and of SPREAD voxels around it on each side: bit x + SPREAD of row[z + SPREAD][y
 * + SPREAD]. */
enum { SPREAD = ISO_TRANSACTION_SPREAD, WIDE = ISO_BRICK + 2 * SPREAD };
typedef struct surroundings {
    uint32_t row[WIDE][WIDE];
} surroundings;

/* Adds the changed voxels of the cell at offset `side` (-1, 0 or 1 cells along each axis) that lie in s. */
static void add_changed(const iso_voxel_bits *changed, const int side[3], surroundings *s) {
    int lo[3], hi[3];
    for (int axis = 0; axis < 3; axis++) {
        lo[axis] = side[axis] < 0 ? ISO_BRICK - SPREAD : 0;
        hi[axis] = side[axis] > 0 ? SPREAD : ISO_BRICK;
    }
    for (int z = lo[2]; z < hi[2]; z++)
        for (int y = lo[1]; y < hi[1]; y++) {
            const uint32_t bits = changed->row[z * ISO_BRICK + y] & ((1u << hi[0]) - (1u << lo[0]));
            s->row[z + ISO_BRICK * side[2] + SPREAD][y + ISO_BRICK * side[1] + SPREAD] |=
                side[0] < 0 ? bits >> (ISO_BRICK - SPREAD) : bits << (ISO_BRICK * side[0] + SPREAD);
        }
}

/* Returns the union of the rows at - SPREAD .. at + SPREAD; from one row to the next it is `step` words. */
static uint32_t spread_rows(const uint32_t *rows, int at, int step) {
    uint32_t bits = 0;
    for (int i = at - SPREAD; i <= at + SPREAD; i++) bits |= rows[i * step];
    return bits;
}

void iso_mask_boundary_influence(const iso_transaction *transaction, const iso_edit_cell *edit_cell,
                                 iso_voxel_bits *reached) {
    surroundings s = {0}, along_y = {0};
    for (int k = 0; k < 27; k++) {
        const int side[3] = {k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1};
        const iso_edit_cell *beside = iso_transaction_neighbour(transaction, edit_cell, side);
        if (beside && beside->edited) add_changed(&beside->changed, side, &s);
    }
    for (int z = 0; z < WIDE; z++)
        for (int y = SPREAD; y < WIDE - SPREAD; y++) along_y.row[z][y] = spread_rows(s.row[z], y, 1);
    for (int row = 0; row < ISO_BRICK_ROWS; row++) {
        uint32_t bits =
            spread_rows(&along_y.row[0][row % ISO_BRICK + SPREAD], row / ISO_BRICK + SPREAD, WIDE);
        for (int i = 0; i < SPREAD; i++) bits |= bits << 1 | bits >> 1;
        reached->row[row] = (uint16_t)(bits >> SPREAD);
    }
}
