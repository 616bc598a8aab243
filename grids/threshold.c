/* Converts a physical isovalue to stored values. */
#include "grids/threshold.h"

#include <float.h>
#include <math.h>

iso_threshold iso_threshold_of(const iso_grid *grid, double physical_isovalue) {
    double stored = iso_grid_stored(grid, physical_isovalue);
    float at = (float)stored;
    /* The conversion may miss a voxel's value by rounding; the isovalue is then taken to be this value. */
    double scale = iso_grid_scale(grid), offset = grid->rgrid ? grid->rgrid->offset : 0;
    double rounding = 4 * DBL_EPSILON * (fabs(physical_isovalue) + fabs(offset)) / scale;
    bool hit = fabs(at - stored) <= rounding;
    if (at < stored && !hit) at = nextafterf(at, INFINITY);
    iso_threshold surface = {.isovalue_ceil = at, .residual = hit ? 0 : (float)(stored - at)};
    surface.normal_sign = iso_grid_is_level_set(grid) ? 1.0f : -1.0f;
    return surface;
}
