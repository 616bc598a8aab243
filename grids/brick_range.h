/* brick_range: the least and the largest value of each brick of an rgrid, read at memory speed.
 *
 * A brick's range is over voxels 16 * b .. 16 * b + 16 of every axis (clipped to the grid): its own and the
 * first of its upper neighbours, all that the edges and cells of the brick look at. Internal to grids. */
#ifndef ISO_GRIDS_BRICK_RANGE_H
#define ISO_GRIDS_BRICK_RANGE_H

#include <stdbool.h>

#include "base/cpu.h"
#include "grids/rgrid.h"

/* Stored values; exact for every type. */
typedef struct iso_brick_range {
    float lo, hi; /* of the finite voxels; +infinity and -infinity when there are none */
    bool finite;  /* no voxel is NaN or infinite */
} iso_brick_range;

/* The ranges of `count` bricks along x from brick `first` on. The same for every level. */
void iso_brick_ranges(const iso_rgrid *grid, iso_cpu_level level, const int first[3], int count,
                      iso_brick_range *ranges);

#endif
