/* foot_points: foot points voxel by voxel, by eq. 1 for distance fields (Baerentzen and Christensen 2003,
 * section 4). Distances up to sqrt 3 voxels are taken, because all outer corners of crossed cells are so
 * near. */
#include "extract/points/foot_points.h"

#include <string.h>

static const float BAND = 1.7320508f; /* sqrt 3, voxels */

static bool in_band(const iso_threshold *surface, float value) {
    float distance = value - surface->isovalue_ceil - surface->residual;
    return value >= surface->isovalue_ceil && distance < BAND;
}

static int last_voxel(const iso_brick_window *window, int axis) {
    return window->last[axis] < ISO_BRICK - 1 ? window->last[axis] : ISO_BRICK - 1;
}

/* in_order, order_of: map the bits of a float, or a float, to an integer in the same order; float_of: the
 * inverse. */
static int32_t in_order(int32_t bits) {
    return bits < 0 ? bits ^ INT32_MAX : bits;
}

static float float_of(int32_t order) {
    float value;
    memcpy(&value, &(int32_t){in_order(order)}, sizeof value);
    return value;
}

static int32_t order_of(float value) {
    int32_t bits;
    memcpy(&bits, &value, sizeof bits);
    return in_order(bits);
}

/* Returns the lowest float that is at or above the isovalue and outside the band of distances. As distances
 * increase with values, it is found by bisection over floats. */
static float band_top(const iso_threshold *surface) {
    if (!in_band(surface, surface->isovalue_ceil)) return surface->isovalue_ceil;
    int64_t in = order_of(surface->isovalue_ceil), out = order_of(INFINITY);
    while (out - in > 1) {
        int64_t middle = in + (out - in) / 2;
        *(in_band(surface, float_of((int32_t)middle)) ? &in : &out) = middle;
    }
    return float_of((int32_t)out);
}

iso_foot_surface iso_foot_surface_of(const iso_threshold *surface, float band) {
    return (iso_foot_surface){.isovalue_ceil = surface->isovalue_ceil,
                              .residual = surface->residual,
                              .normal_sign = surface->normal_sign,
                              .top = band_top(surface),
                              .band = band};
}

bool iso_foot_point(const iso_foot_surface *surface, const iso_foot_stencil *stencil, iso_surfel *point) {
    if (iso_foot_is_clamped(surface->band, stencil)) return false;
    float g[3];
    for (int axis = 0; axis < 3; axis++) {
        bool has_low = !isnan(stencil->low[axis]), has_high = !isnan(stencil->high[axis]);
        float low = has_low ? stencil->low[axis] : stencil->centre;
        float high = has_high ? stencil->high[axis] : stencil->centre;
        g[axis] = has_low && has_high ? 0.5f * (high - low) : high - low;
    }
    float squared = g[0] * g[0] + g[1] * g[1] + g[2] * g[2];
    if (!(squared >= 0.25f)) return false;
    if (iso_foot_is_regular(squared)) {
        float scale = surface->normal_sign / sqrtf(squared);
        for (int axis = 0; axis < 3; axis++) point->normal[axis] = g[axis] * scale;
    } else if (!iso_unit_normal(g, surface->normal_sign, point->normal)) {
        return false;
    }
    float distance = stencil->centre - surface->isovalue_ceil - surface->residual;
    for (int axis = 0; axis < 3; axis++)
        point->position[axis] = (float)stencil->voxel[axis] - distance * point->normal[axis];
    return true;
}

static iso_foot_stencil stencil_at(const iso_brick_window *window, const int voxel[3]) {
    const float *centre = window->values + iso_window_index(voxel[0], voxel[1], voxel[2]);
    iso_foot_stencil stencil = {.centre = *centre};
    for (int axis = 0; axis < 3; axis++) {
        int step = iso_window_step(axis);
        stencil.voxel[axis] = voxel[axis];
        stencil.low[axis] = voxel[axis] > window->first[axis] ? centre[-step] : NAN;
        stencil.high[axis] = voxel[axis] < window->last[axis] ? centre[step] : NAN;
    }
    return stencil;
}

void iso_foot_points_direct(const iso_brick_window *window, const iso_foot_surface *surface,
                            iso_foot_points *out) {
    for (int z = 0; z <= last_voxel(window, 2); z++)
        for (int y = 0; y <= last_voxel(window, 1); y++)
            for (int x = 0; x <= last_voxel(window, 0); x++) {
                float value = window->values[iso_window_index(x, y, z)];
                if (!(value >= surface->isovalue_ceil && value < surface->top)) continue;
                iso_foot_stencil stencil = stencil_at(window, (int[3]){x, y, z});
                if (out->voxels) out->voxels[out->count] = z << 8 | y << 4 | x;
                if (iso_foot_point(surface, &stencil, &out->points[out->count]))
                    out->count++;
                else
                    out->rejected++;
            }
}

bool iso_foot_points_may_exist(const iso_grid *grid, const iso_threshold *surface, const int brick[3]) {
    if (grid->hgrid) /* any cell with a brick: the kernel looks for voxels in the band */
        return grid->hgrid->cell[iso_hgrid_cell_index(grid->hgrid, brick[0], brick[1], brick[2])] >= 0;
    float top = surface->isovalue_ceil + 1.75f; /* a little above sqrt 3: rounding must not lose a voxel */
    if (iso_grid_brick_may_cross(grid, brick, surface->isovalue_ceil) ||
        iso_grid_brick_may_cross(grid, brick, top))
        return true;
    /* all finite voxels are on one side of the band or in it: one voxel decides */
    float value = iso_grid_at(grid, ISO_BRICK * brick[0], ISO_BRICK * brick[1], ISO_BRICK * brick[2]);
    return !isfinite(value) || (value >= surface->isovalue_ceil && value < top);
}

bool iso_foot_seeds_may_exist(const iso_grid *grid, const iso_threshold *surface, const int brick[3]) {
    for (int i = 0; i < 8; i++) { /* a seed's cell may lie in a lower brick */
        const int near[3] = {brick[0] - (i & 1), brick[1] - (i >> 1 & 1), brick[2] - (i >> 2)};
        if (near[0] < 0 || near[1] < 0 || near[2] < 0) continue;
        if (iso_grid_brick_may_cross(grid, near, surface->isovalue_ceil)) return true;
    }
    return false;
}
