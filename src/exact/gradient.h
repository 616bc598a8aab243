/* gradient: gradients at the corners of a cell, the same ones that truth/raycast.c interpolates. Internal to
 * exact. */
#ifndef ISO_EXACT_GRADIENT_H
#define ISO_EXACT_GRADIENT_H

#include "base/cpu.h"
#include "grids/grid.h"

/* Computes gradient[corner][axis] of the cell with the first corner `cell`, in units of half a stored value
 * per voxel (so that the difference of any two floats is finite); gradient[corner][3] is any finite number.
 * Differences are central; one-sided where one neighbour is outside the grid or not finite; 0 where both
 * neighbours are. The voxels of the cell must be finite. Every instruction set gives the same bits. */
typedef void iso_exact_gradients(const iso_grid *grid, const int cell[3], float gradient[8][4]);

/* By kind of grid, and voxel type of an rgrid. */
typedef struct iso_exact_gradient_kernel {
    iso_exact_gradients *rgrid[ISO_FLOAT32 + 1], *hgrid;
} iso_exact_gradient_kernel;
ISO_KERNEL_UNITS(const iso_exact_gradient_kernel, iso_exact_gradient_kernel);

/* The gradients of any cell, one difference at a time. */
void iso_exact_gradients_anywhere(const iso_grid *grid, const int cell[3], float gradient[8][4]);

/* Where the voxels of an rgrid lie: the address of the first, and the steps along the axes in bytes. The
 * address is 0 for an hgrid. */
typedef struct iso_exact_voxels {
    uintptr_t first;
    ptrdiff_t step[3];
} iso_exact_voxels;
iso_exact_voxels iso_exact_voxels_of(const iso_grid *grid);

/* Prefetches the voxels that the gradients of a cell need. Addresses may lie outside the grid: prefetching
 * them is allowed, computing them as pointers is not. */
static inline void iso_exact_gradients_fetch(const iso_exact_voxels *voxels, const int cell[3]) {
    if (!voxels->first) return;
    const ptrdiff_t *step = voxels->step;
    uintptr_t row =
        voxels->first + (uintptr_t)(step[0] * cell[0] + step[1] * (cell[1] - 1) + step[2] * (cell[2] - 1));
    for (int z = 0; z < 4; z++, row += (uintptr_t)step[2])
        for (int y = 0; y < 4; y++) /* also the four rows that are not needed: cheaper than a branch */
            __builtin_prefetch((const void *)(row + (uintptr_t)(y * step[1])));
}

/* The function for the grid's kind and voxel type at an instruction set, or at the best below it that this
 * build has. Never NULL. */
iso_exact_gradients *iso_exact_gradients_get(const iso_grid *grid, iso_cpu_level level);

#endif
