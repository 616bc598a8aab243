/* gradient: gradients at the corners of a cell, the ones that truth/raycast.c interpolates. Internal to
 * exact. */
#ifndef ISO_EXACT_GRADIENT_H
#define ISO_EXACT_GRADIENT_H

#include "base/cpu.h"
#include "grids/grid.h"

/* gradient[corner][axis]: half the stored value per voxel; the fourth of each is anything finite. Central
 * differences, one-sided where a neighbour is outside the grid or not finite, 0 where both are. The voxels of
 * the cell must be finite. The same bits at every level. */
typedef void iso_exact_gradients(const iso_grid *grid, const int cell[3], float gradient[8][4]);

/* Asks memory for what gradients at the cell will read. */
void iso_exact_gradients_fetch(const iso_grid *grid, const int cell[3]);

/* For the kind of grid and its voxels at an instruction set, or at the best below it that this build has.
 * Never NULL. */
iso_exact_gradients *iso_exact_gradients_get(const iso_grid *grid, iso_cpu_level level);

#endif
