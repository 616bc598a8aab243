/* threshold: an isovalue in stored values, and the test whether a voxel is at or above it. Extraction and the
 * renderers that draw the field itself use the same one. */
#ifndef ISO_GRIDS_THRESHOLD_H
#define ISO_GRIDS_THRESHOLD_H

#include <stdbool.h>

#include "grids/grid.h"

/* An isovalue in stored values. isovalue_ceil is the smallest float at or above the isovalue, so that v >=
 * isovalue_ceil holds for exactly the floats v at or above the isovalue; the isovalue itself is
 * isovalue_ceil + residual. */
typedef struct iso_threshold {
    float isovalue_ceil, residual;
    float normal_sign; /* outward normal = normal_sign x gradient: -1; +1 for level sets, whose outside is
                          higher */
} iso_threshold;

iso_threshold iso_threshold_of(const iso_grid *grid, double physical_isovalue);

static inline bool iso_threshold_inside(const iso_threshold *threshold, float value) {
    return value >= threshold->isovalue_ceil;
}

/* Returns the smallest integer at or above the isovalue: for integer voxels v, v >= isovalue is v >= this
 * number. Isovalues beyond the range of the integer types give a number just outside this range. */
static inline int32_t iso_integer_threshold(float isovalue) {
    return isovalue < -40000 ? -40000 : isovalue > 70000 ? 70000 : (int32_t)ceilf(isovalue);
}

#endif
