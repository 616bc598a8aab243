/* foot_brick: a brick and its neighbours, and the choice of the kernel of foot points. */
#include <math.h>

#include "base/kernel_units.h"
#include "extract/points/foot_kernel.h"

#define SAME_16(v)                                                                                           \
    { v, v, v, v, v, v, v, v, v, v, v, v, v, v, v, v }
_Alignas(64) static const float missing_row[ISO_BRICK] = SAME_16(NAN);
_Alignas(64) static const float clamped_row[ISO_BRICK] = SAME_16(INFINITY);

/* The voxels beyond face number `side` (-x, +x, -y, +y, -z, +z) of a brick. */
static iso_foot_face face_of(const iso_hgrid *grid, const int cell[3], int side) {
    static const size_t across[3] = {0xff0, 0xf00, 0x0f0}; /* offset bits of a face's axes, without x */
    int at[3] = {cell[0], cell[1], cell[2]}, axis = side / 2, up = side % 2;
    at[axis] += up ? 1 : -1;
    if (at[axis] < 0 || at[axis] >= grid->cells[axis]) return (iso_foot_face){missing_row, 0};
    int32_t number = grid->cell[iso_hgrid_cell_index(grid, at[0], at[1], at[2])];
    if (number < 0) return (iso_foot_face){clamped_row, 0};
    size_t last = (size_t)(ISO_BRICK - 1) << 4 * axis;
    return (iso_foot_face){iso_hgrid_brick(grid, number) + (up ? 0 : last), across[axis]};
}

/* Returns the brick's values or, if the brick reaches beyond the grid, a copy in scratch->padded with NaN
 * there. */
static const float *pad_brick(const iso_hgrid *grid, const int cell[3], const float *values,
                              iso_foot_scratch *scratch) {
    int n[3];
    for (int axis = 0; axis < 3; axis++) n[axis] = grid->dims[axis] - cell[axis] * ISO_BRICK;
    if (n[0] >= ISO_BRICK && n[1] >= ISO_BRICK && n[2] >= ISO_BRICK) return values;
    for (int i = 0; i < ISO_BRICK_VOXELS; i++) {
        bool inside = (i & 15) < n[0] && (i >> 4 & 15) < n[1] && i >> 8 < n[2];
        scratch->padded[i] = inside ? values[i] : NAN;
    }
    return scratch->padded;
}

void iso_foot_brick_of(const iso_hgrid *grid, const int cell[3], iso_foot_scratch *scratch,
                       iso_foot_brick *out) {
    int32_t number = grid->cell[iso_hgrid_cell_index(grid, cell[0], cell[1], cell[2])];
    out->values = out->next = pad_brick(grid, cell, iso_hgrid_brick(grid, number), scratch);
    for (int side = 0; side < 6; side++) out->face[side] = face_of(grid, cell, side);
}

const iso_foot_kernel *iso_foot_kernel_get(iso_cpu_level level) {
    return ISO_KERNEL_UNIT(iso_foot_kernel, level);
}
