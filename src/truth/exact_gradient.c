/* The gradients that raycast interpolates, from the 4^3 voxels around a cell: central differences, one-sided
 * where a neighbour is outside the grid or not finite, 0 where both are. All by 1/2: differences of any two
 * floats are finite then. */
#include <math.h>

#include "truth/exact_kernel.h"

/* around[z][y][x]: voxels cell - 1 .. cell + 2; clamped to the grid. The eight outermost edges are not
 * needed. */
typedef float voxels_around[4][4][4];

static void fetch(const iso_grid *grid, const int cell[3], voxels_around around) {
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

static float difference(float low, float middle, float high, bool has_low, bool has_high) {
    has_low = has_low && isfinite(low);
    has_high = has_high && isfinite(high);
    if (has_low && has_high) return 0.25f * high - 0.25f * low;
    return has_high ? 0.5f * high - 0.5f * middle : has_low ? 0.5f * middle - 0.5f * low : 0;
}

void iso_exact_gradients(const iso_grid *grid, const int cell[3], float gradient[8][4]) {
    const int *dims = iso_grid_dims(grid);
    voxels_around around;
    fetch(grid, cell, around);
    for (int corner = 0; corner < 8; corner++) {
        const int x = 1 + (corner & 1), y = 1 + (corner >> 1 & 1), z = 1 + (corner >> 2);
        const int at[3] = {cell[0] + x - 1, cell[1] + y - 1, cell[2] + z - 1};
        const float middle = around[z][y][x];
        const float low[3] = {around[z][y][x - 1], around[z][y - 1][x], around[z - 1][y][x]};
        const float high[3] = {around[z][y][x + 1], around[z][y + 1][x], around[z + 1][y][x]};
        for (int i = 0; i < 3; i++)
            gradient[corner][i] = difference(low[i], middle, high[i], at[i] > 0, at[i] + 1 < dims[i]);
        gradient[corner][3] = 0;
    }
}
