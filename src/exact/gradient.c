/* gradient: central differences from the 4^3 voxels around a cell, times 1/2, so that the differences of any
 * two floats are finite. A cell whose 4^3 voxels are all in the grid and finite gets its gradients from whole
 * rows (gradient_kernel.c), any other from one axis_difference at a time (iso_exact_gradients_anywhere), with
 * the same arithmetic. */
#include "exact/gradient.h"

#include <math.h>

#include "base/kernel_units.h"
#include "grids/grid.h"

/* [z][y][x]: the voxels cell - 1 .. cell + 2 on each axis; beyond the grid, its nearest voxel. Rows with y
 * and z both 0 or 3 are not needed and not set. */
typedef float voxels_around[4][4][4];

static void read_voxels_around(const iso_grid *grid, const int cell[3], voxels_around around) {
    const int *dims = iso_grid_dims(grid);
    for (int z = 0; z < 4; z++)
        for (int y = 0; y < 4; y++) {
            const bool edge = (z == 0 || z == 3) && (y == 0 || y == 3);
            for (int x = 0; x < 4 && !edge; x++) {
                const int at[3] = {cell[0] + x - 1, cell[1] + y - 1, cell[2] + z - 1};
                int inside[3];
                for (int i = 0; i < 3; i++) inside[i] = at[i] < 0 ? 0 : at[i] < dims[i] ? at[i] : dims[i] - 1;
                around[z][y][x] = grid->rgrid ? iso_rgrid_at(grid->rgrid, inside[0], inside[1], inside[2])
                                              : iso_hgrid_at(grid->hgrid, inside[0], inside[1], inside[2]);
            }
        }
}

/* Half the derivative at the value `middle`; has_low, has_high: whether its neighbours are in the grid. */
static float axis_difference(float low, float middle, float high, bool has_low, bool has_high) {
    has_low = has_low && isfinite(low);
    has_high = has_high && isfinite(high);
    if (has_low && has_high) return 0.25f * high - 0.25f * low;
    return has_high ? 0.5f * high - 0.5f * middle : has_low ? 0.5f * middle - 0.5f * low : 0;
}

/* Computes the gradients of any cell, as iso_exact_gradients describes. */
void iso_exact_gradients_anywhere(const iso_grid *grid, const int cell[3], float gradient[8][4]) {
    const int *dims = iso_grid_dims(grid);
    voxels_around around;
    read_voxels_around(grid, cell, around);
    for (int corner = 0; corner < 8; corner++) {
        const int x = 1 + (corner & 1), y = 1 + (corner >> 1 & 1), z = 1 + (corner >> 2);
        const int at[3] = {cell[0] + x - 1, cell[1] + y - 1, cell[2] + z - 1};
        const float middle = around[z][y][x];
        const float low[3] = {around[z][y][x - 1], around[z][y - 1][x], around[z - 1][y][x]};
        const float high[3] = {around[z][y][x + 1], around[z][y + 1][x], around[z + 1][y][x]};
        for (int i = 0; i < 3; i++)
            gradient[corner][i] = axis_difference(low[i], middle, high[i], at[i] > 0, at[i] + 1 < dims[i]);
        gradient[corner][3] = 0;
    }
}

iso_exact_voxels iso_exact_voxels_of(const iso_grid *grid) {
    if (!grid->rgrid) return (iso_exact_voxels){0, {0, 0, 0}};
    const ptrdiff_t bytes = (ptrdiff_t)iso_type_size(grid->rgrid->type);
    return (iso_exact_voxels){(uintptr_t)grid->rgrid->data,
                              {bytes, bytes * grid->rgrid->stride_y, bytes * grid->rgrid->stride_z}};
}

iso_exact_gradients *iso_exact_gradients_get(const iso_grid *grid, iso_cpu_level level) {
    const iso_exact_gradient_kernel *kernel = ISO_KERNEL_UNIT(iso_exact_gradient_kernel, level);
    return grid->rgrid ? kernel->rgrid[grid->rgrid->type] : kernel->hgrid;
}
