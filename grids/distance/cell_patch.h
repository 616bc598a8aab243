/* cell_patch: the part of a trilinear surface that lies in one cell, and its point that is nearest to
 * another. Internal to grids/distance. */
#ifndef ISO_GRIDS_DISTANCE_CELL_PATCH_H
#define ISO_GRIDS_DISTANCE_CELL_PATCH_H

#include <stdbool.h>

#include "base/geometry.h"

/* Positions in a cell count from its lowest corner, in voxels: 0 .. 1. */
typedef struct iso_cell_patch {
    double c[8]; /* the field, less the isovalue: bit 0 of the index stands for x, bit 1 for y, bit 2 for z */
} iso_cell_patch;

/* Lengths of index vectors. */
typedef struct iso_cell_metric {
    double m[9];  /* squared length, mm2, of an index vector t: t^T m t */
    double voxel; /* the largest spacing, mm */
} iso_cell_metric;

/* m: index vectors to mm, row-major. */
iso_cell_metric iso_cell_metric_make(const double m[9]);

/* corners: the field at corner 0 .. 7 (bit 0: x + 1, ..), less the isovalue. */
iso_cell_patch iso_cell_patch_make(const double corners[8]);

/* The least distance, mm, from p to the surface in the cell, near a start in the cell, which becomes the
 * nearest point. Newton's method along the surface, its faces and its edges. INFINITY: no point of the
 * surface is found from this start, or none would be that is nearer than `limit`. */
double iso_cell_patch_nearest(const iso_cell_patch *patch, const iso_cell_metric *metric, const double p[3],
                              double limit, double at[3]);

/* About how far the surface is from a position in the cell, mm. */
double iso_cell_patch_offset(const iso_cell_patch *patch, const iso_cell_metric *metric, const double at[3]);

#endif
