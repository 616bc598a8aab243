/* brick: fills the window of a brick, and gradients and normals from it: central differences, one-sided next
 * to missing neighbours. */
#include "extract/brick.h"

void iso_brick_window_fill(const iso_grid *grid, const int brick[3], iso_brick_window *window) {
    const int *dims = iso_grid_dims(grid);
    for (int axis = 0; axis < 3; axis++) {
        window->brick[axis] = brick[axis];
        window->first[axis] = -ISO_BRICK * brick[axis];
        window->last[axis] = window->first[axis] + dims[axis] - 1;
    }
    iso_grid_window(grid, brick, window->values);
}

void iso_window_gradient(const iso_brick_window *window, const int voxel[3], float gradient[3]) {
    const float *centre = window->values + iso_window_index(voxel[0], voxel[1], voxel[2]);
    for (int axis = 0; axis < 3; axis++) {
        int step = iso_window_step(axis);
        bool has_low = voxel[axis] > window->first[axis] && isfinite(centre[-step]);
        bool has_high = voxel[axis] < window->last[axis] && isfinite(centre[step]);
        float low = has_low ? centre[-step] : *centre, high = has_high ? centre[step] : *centre;
        gradient[axis] = has_low && has_high ? 0.5f * (high - low) : high - low;
    }
}

/* iso_unit_normal in double, for the rare gradients whose squares overflow or underflow in float or that are
 * 0. */
static bool unit_normal_wide(const float g[3], float sign, float normal[3]) {
    double length = sqrt((double)g[0] * g[0] + (double)g[1] * g[1] + (double)g[2] * g[2]);
    if (!(length > 0) || !isfinite(length)) return false;
    for (int axis = 0; axis < 3; axis++) normal[axis] = (float)(sign * g[axis] / length);
    return true;
}

bool iso_unit_normal(const float gradient[3], float sign, float normal[3]) {
    float squared = gradient[0] * gradient[0] + gradient[1] * gradient[1] + gradient[2] * gradient[2];
    if (!(squared > 1e-30f && squared < 1e30f)) return unit_normal_wide(gradient, sign, normal);
    float length = sqrtf(squared);
    for (int axis = 0; axis < 3; axis++) normal[axis] = sign * gradient[axis] / length;
    return true;
}
