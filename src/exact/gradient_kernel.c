/* gradient_kernel: gradients of a cell by whole rows. */
#include <string.h>

#include "base/simd.h"
#include "base/simd_four.h"
#include "exact/gradient.h"
#include "grids/rgrid.h"

/* [z][y][x]: the voxels cell - 1 .. cell + 2 on each axis; beyond the grid, its nearest voxel. Rows with y
 * and z both 0 or 3 are not needed and not set. */
typedef float voxels_around[4][4][4];

/* Copies four voxels of a row of an hgrid, from `at` on; all of them must be in the grid. */
static inline void read_hgrid_row(const iso_hgrid *grid, const int at[3], float out[4]) {
    const int local = at[0] % ISO_BRICK, first = local + 4 <= ISO_BRICK ? 4 : ISO_BRICK - local;
    const size_t cell = iso_hgrid_cell_index(grid, at[0] / ISO_BRICK, at[1] / ISO_BRICK, at[2] / ISO_BRICK);
    const ptrdiff_t row = (at[2] % ISO_BRICK * ISO_BRICK + at[1] % ISO_BRICK) * ISO_BRICK;
    for (int part = 0, x = 0; x < 4; part++) {
        const int end = part ? 4 : first;
        const int32_t brick = grid->cell[cell + (size_t)part];
        const float *voxels = brick < 0 ? NULL : iso_hgrid_brick(grid, brick) + row + (part ? -first : local);
        for (; x < end; x++) out[x] = voxels ? voxels[x] : iso_hgrid_empty_value(grid, brick);
    }
}

/* Reads the voxels around a cell for which is_within is true. */
static void read_hgrid_voxels(const iso_hgrid *grid, const int cell[3], voxels_around around) {
    for (int z = 0; z < 4; z++)
        for (int y = 0; y < 4; y++)
            read_hgrid_row(grid, (const int[3]){cell[0] - 1, cell[1] + y - 1, cell[2] + z - 1}, around[z][y]);
}

/* Whether the grid has all 4^3 voxels around a cell. */
static inline bool is_within(const int cell[3], const int dims[3]) {
    return cell[0] > 0 && cell[1] > 0 && cell[2] > 0 && cell[0] + 2 < dims[0] && cell[1] + 2 < dims[1] &&
           cell[2] + 2 < dims[2];
}

/* Four voxels of a row, times 1/4. */
#if ISO_LANES == 4
static inline v4 row_of_4(iso_type type, const void *row) {
    switch (type) {
    case ISO_UINT8:
        return 0.25f * v_to_float(v_load_u8(row));
    case ISO_INT16:
        return 0.25f * v_to_float(v_load_i16(row));
    case ISO_UINT16:
        return 0.25f * v_to_float(v_load_u16(row));
    default:
        return 0.25f * v4_load(row);
    }
}
#else
static inline v4 row_of_4(iso_type type, const void *row) {
    int32_t four;
    int64_t eight;
    switch (type) {
    case ISO_UINT8:
        memcpy(&four, row, sizeof four);
        return 0.25f * (v4)_mm_cvtepi32_ps(_mm_cvtepu8_epi32(_mm_cvtsi32_si128(four)));
    case ISO_INT16:
        memcpy(&eight, row, sizeof eight);
        return 0.25f * (v4)_mm_cvtepi32_ps(_mm_cvtepi16_epi32(_mm_cvtsi64_si128(eight)));
    case ISO_UINT16:
        memcpy(&eight, row, sizeof eight);
        return 0.25f * (v4)_mm_cvtepi32_ps(_mm_cvtepu16_epi32(_mm_cvtsi64_si128(eight)));
    default:
        return 0.25f * v4_load(row);
    }
}
#endif

/* Computes the gradients of a cell whose 4^3 voxels are all in the grid. first: the voxel at cell - 1 on
 * every axis; step: strides along y and z in voxels. Returns false if a voxel is not finite; `gradient` is
 * undefined then. */
ISO_INLINE bool gradients_within(iso_type type, const void *first, const ptrdiff_t step[2],
                                 float gradient[8][4]) {
    v4 row[4][4]; /* z, y */
    const ptrdiff_t bytes = type == ISO_UINT8 ? 1 : type == ISO_FLOAT32 ? 4 : 2;
    v4 sum = v4_set(0);
    for (int z = 0; z < 4; z++)
        for (int y = 0; y < 4; y++) {
            if ((z == 0 || z == 3) && (y == 0 || y == 3)) continue;
            row[z][y] = row_of_4(type, (const char *)first + (y * step[0] + z * step[1]) * bytes);
            if (type == ISO_FLOAT32) sum += row[z][y] * 0.0f;
        }
    if (type == ISO_FLOAT32 && !v4_are_numbers(sum)) return false;
    for (int z = 1; z < 3; z++)
        for (int y = 1; y < 3; y++) {
            const v4 middle = row[z][y], across = row[z][y + 1] - row[z][y - 1],
                     up = row[z + 1][y] - row[z - 1][y];
            const v4 along = __builtin_shufflevector(middle, middle, 2, 3, 2, 3) -
                             __builtin_shufflevector(middle, middle, 0, 1, 0, 1);
            const v4 others = __builtin_shufflevector(across, up, 1, 5, 2, 6);
            float(*out)[4] = gradient + 2 * (y - 1) + 4 * (z - 1);
            v4_store(out[0], __builtin_shufflevector(along, others, 0, 4, 5, 5));
            v4_store(out[1], __builtin_shufflevector(along, others, 1, 6, 7, 7));
        }
    return true;
}

/* The iso_exact_gradients for an rgrid with voxels of one type. */
ISO_INLINE void gradients_rgrid(iso_type type, const iso_grid *grid, const int cell[3],
                                float gradient[8][4]) {
    const iso_rgrid *rgrid = grid->rgrid;
    const ptrdiff_t step[2] = {rgrid->stride_y, rgrid->stride_z};
    const ptrdiff_t first = (cell[0] - 1) + (cell[1] - 1) * step[0] + (cell[2] - 1) * step[1];
    const ptrdiff_t bytes = type == ISO_UINT8 ? 1 : type == ISO_FLOAT32 ? 4 : 2;
    if (!is_within(cell, rgrid->dims) ||
        !gradients_within(type, (const char *)rgrid->data + first * bytes, step, gradient))
        iso_exact_gradients_anywhere(grid, cell, gradient);
}

static void gradients_uint8(const iso_grid *grid, const int cell[3], float gradient[8][4]) {
    gradients_rgrid(ISO_UINT8, grid, cell, gradient);
}
static void gradients_int16(const iso_grid *grid, const int cell[3], float gradient[8][4]) {
    gradients_rgrid(ISO_INT16, grid, cell, gradient);
}
static void gradients_uint16(const iso_grid *grid, const int cell[3], float gradient[8][4]) {
    gradients_rgrid(ISO_UINT16, grid, cell, gradient);
}
static void gradients_float(const iso_grid *grid, const int cell[3], float gradient[8][4]) {
    gradients_rgrid(ISO_FLOAT32, grid, cell, gradient);
}

/* The iso_exact_gradients for an hgrid. If the 4^3 voxels lie in several bricks or in an empty cell, they are
 * first copied to one array. */
static void gradients_hgrid(const iso_grid *grid, const int cell[3], float gradient[8][4]) {
    const iso_hgrid *hgrid = grid->hgrid;
    ptrdiff_t step[2] = {ISO_BRICK, ISO_BRICK * ISO_BRICK};
    voxels_around around;
    const float *first = around[0][0];
    int brick[3], in[3];
    bool one_brick = true;
    for (int axis = 0; axis < 3; axis++) {
        brick[axis] = cell[axis] / ISO_BRICK;
        in[axis] = cell[axis] % ISO_BRICK - 1;
        one_brick = one_brick && in[axis] >= 0 && in[axis] + 3 < ISO_BRICK;
    }
    if (!is_within(cell, hgrid->dims)) {
        iso_exact_gradients_anywhere(grid, cell, gradient);
        return;
    }
    const int32_t number = hgrid->cell[iso_hgrid_cell_index(hgrid, brick[0], brick[1], brick[2])];
    if (one_brick && number >= 0) {
        first = iso_hgrid_brick(hgrid, number) + in[0] + in[1] * step[0] + in[2] * step[1];
    } else {
        read_hgrid_voxels(hgrid, cell, around);
        step[0] = 4;
        step[1] = 16;
    }
    if (!gradients_within(ISO_FLOAT32, first, step, gradient))
        iso_exact_gradients_anywhere(grid, cell, gradient);
}

const iso_exact_gradient_kernel ISO_KERNEL_NAME(iso_exact_gradient_kernel) = {
    .rgrid = {[ISO_UINT8] = gradients_uint8,
              [ISO_INT16] = gradients_int16,
              [ISO_UINT16] = gradients_uint16,
              [ISO_FLOAT32] = gradients_float},
    .hgrid = gradients_hgrid};
