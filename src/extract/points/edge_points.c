/* edge_points: edge points of one brick from its window, edge by edge, for windows that the edge kernel
 * cannot handle (NaN, infinity, overflow). Three edges a voxel, the gradient interpolated along the edge:
 * Baerentzen and Christensen 2003, section 4 (the rgridb engine). */
#include "extract/points/edge_points.h"

#include <float.h>

#include "base/numbers.h"

/* The edge from `voxel` along `axis`. index: of the voxel in iso_brick_window.values. */
typedef struct edge {
    int voxel[3], axis;
    ptrdiff_t index;
} edge;

/* The position of the surface between the values a (at the lower voxel) and b: (isovalue - a) / (b - a). The
 * subtraction isovalue_ceil - a is exact when the two are close; `residual` makes up for the rounding of the
 * isovalue to isovalue_ceil. */
static float position_on_edge(const iso_threshold *surface, float a, float b) {
    float t = (surface->isovalue_ceil - a + surface->residual) / (b - a);
    t = t > 0 ? t : 0; /* 0 also for NaN, when the differences overflow */
    return t < 1 ? t : 1;
}

/* Computes the normal, with |x| + |y| + |z| = 1, of a gradient so long or so short that the squares of its
 * components overflow or underflow. Returns false if the gradient is 0. */
static bool wide_normal(const float gradient[3], float normal[3]) {
    if (!iso_unit_normal(gradient, 1, normal)) return false;
    float sum = fabsf(normal[0]) + fabsf(normal[1]) + fabsf(normal[2]);
    for (int axis = 0; axis < 3; axis++) normal[axis] /= sum;
    return true;
}

/* Sets `normal` to the outward gradient at the position t on an edge, scaled to |x| + |y| + |z| = 1 so that
 * squares stay in range; if the gradient vanishes, to the edge's outward direction. The operations and their
 * order, the edge's axis first, are those of edge_kernel.c, so that both give the same bytes. */
static void edge_normal(const iso_brick_window *window, const edge *e, const iso_threshold *surface, float t,
                        float normal[3]) {
    float low[3], high[3], gradient[3];
    int end[3] = {e->voxel[0], e->voxel[1], e->voxel[2]};
    end[e->axis]++;
    iso_window_gradient(window, e->voxel, low);
    iso_window_gradient(window, end, high);
    for (int axis = 0; axis < 3; axis++)
        gradient[axis] = (low[axis] + t * (high[axis] - low[axis])) * surface->normal_sign;
    const int second = e->axis == 0 ? 1 : 0, third = e->axis == 2 ? 1 : 2;
    float sum = fabsf(gradient[e->axis]) + fabsf(gradient[second]) + fabsf(gradient[third]);
    if (!(sum > 0 && sum <= FLT_MAX)) {
        if (wide_normal(gradient, normal)) return; /* the kernel is not used for such values (edge_run.c) */
        bool rises = !iso_threshold_inside(surface, window->values[e->index]);
        for (int axis = 0; axis < 3; axis++) normal[axis] = 0;
        normal[e->axis] = rises ? surface->normal_sign : -surface->normal_sign;
        return;
    }
    float lift = sum < 0x1p-64f ? 0x1p64f : 1, scale = 1 / (sum * lift);
    for (int axis = 0; axis < 3; axis++) normal[axis] = gradient[axis] * lift * scale;
}

static void make_unit(float n[3]) {
    float length = sqrtf(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    for (int axis = 0; axis < 3; axis++) n[axis] /= length;
}

/* Appends the point of an edge if the surface crosses it between finite values. */
static void try_edge(const iso_brick_window *window, const edge *e, const iso_threshold *surface,
                     iso_edge_points *out) {
    if (e->voxel[e->axis] >= window->last[e->axis]) return;
    float a = window->values[e->index], b = window->values[e->index + iso_window_step(e->axis)];
    if (iso_threshold_inside(surface, a) == iso_threshold_inside(surface, b)) return;
    if (!isfinite(a) || !isfinite(b)) return;
    float t = position_on_edge(surface, a, b);
    iso_surfel *point = &out->points[out->count];
    for (int axis = 0; axis < 3; axis++) point->position[axis] = (float)e->voxel[axis];
    point->position[e->axis] += t;
    edge_normal(window, e, surface, t, point->normal);
    if (!out->scaled) make_unit(point->normal);
    if (out->keys) out->keys[out->count] = iso_edge_key_make(e->voxel[0], e->voxel[1], e->voxel[2], e->axis);
    out->count++;
}

void iso_edge_points_own(const iso_brick_window *window, const iso_threshold *surface, iso_edge_points *out) {
    int last[3];
    for (int axis = 0; axis < 3; axis++) last[axis] = iso_min_int(window->last[axis], ISO_BRICK - 1);
    for (int axis = 0; axis < 3; axis++)
        for (int z = 0; z <= last[2]; z++)
            for (int y = 0; y <= last[1]; y++)
                for (int x = 0; x <= last[0]; x++)
                    try_edge(window, &(edge){{x, y, z}, axis, iso_window_index(x, y, z)}, surface, out);
}

void iso_edge_points_far(const iso_brick_window *window, const iso_threshold *surface, iso_edge_points *out) {
    int last[3];
    for (int axis = 0; axis < 3; axis++) {
        if (window->last[axis] < 1) return; /* a layer of one voxel has no cells */
        last[axis] = iso_min_int(window->last[axis], ISO_BRICK);
    }
    for (int axis = 0; axis < 3; axis++)
        for (int z = 0; z <= last[2]; z++)
            for (int y = 0; y <= last[1]; y++)
                for (int x = z == ISO_BRICK || y == ISO_BRICK ? 0 : ISO_BRICK; x <= last[0]; x++) {
                    edge e = {{x, y, z}, axis, iso_window_index(x, y, z)};
                    if (e.voxel[axis] < ISO_BRICK) try_edge(window, &e, surface, out);
                }
}
