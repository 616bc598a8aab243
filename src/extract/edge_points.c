/* Edge points: the vertices of Marching Cubes without its triangles. Baerentzen and Christensen 2003, section
 * 4 (the rgridb engine): three edges a voxel, the gradient interpolated along the edge. */
#include "extract/edge_points.h"

/* An edge from `voxel` along `axis`, its index in the window. */
typedef struct edge {
    int voxel[3], axis;
    ptrdiff_t index;
} edge;

/* (isovalue - a) / (b - a), a on the lower voxel. The difference to `at` is exact when it is small; `rest`
 * carries what the float isovalue rounded away. */
static float fraction(const iso_surface *surface, float a, float b) {
    float t = (surface->at - a + surface->rest) / (b - a);
    return t <= 1 ? t : 1;
}

static void edge_normal(const iso_brick_window *window, const edge *e, const iso_surface *surface, float t,
                        float normal[3]) {
    float low[3], high[3];
    int end[3] = {e->voxel[0], e->voxel[1], e->voxel[2]};
    end[e->axis]++;
    iso_window_gradient(window, e->voxel, low);
    iso_window_gradient(window, end, high);
    float gradient[3];
    for (int axis = 0; axis < 3; axis++) gradient[axis] = low[axis] + t * (high[axis] - low[axis]);
    if (iso_unit_normal(gradient, surface->outward, normal)) return;
    bool rises = !iso_surface_inside(surface, window->values[e->index]);
    for (int axis = 0; axis < 3; axis++) normal[axis] = 0;
    normal[e->axis] = rises ? surface->outward : -surface->outward;
}

static void try_edge(const iso_brick_window *window, const edge *e, const iso_surface *surface,
                     iso_edge_points *out) {
    if (e->voxel[e->axis] >= window->last[e->axis]) return;
    float a = window->values[e->index], b = window->values[e->index + iso_window_step(e->axis)];
    if (iso_surface_inside(surface, a) == iso_surface_inside(surface, b)) return;
    if (!isfinite(a) || !isfinite(b)) return;
    float t = fraction(surface, a, b);
    iso_surfel *point = &out->points[out->count];
    for (int axis = 0; axis < 3; axis++) point->position[axis] = (float)e->voxel[axis];
    point->position[e->axis] += t;
    edge_normal(window, e, surface, t, point->normal);
    if (out->keys) out->keys[out->count] = iso_edge_key_of(e->voxel[0], e->voxel[1], e->voxel[2], e->axis);
    out->count++;
}

static int smaller(int a, int b) {
    return a < b ? a : b;
}

void iso_edge_points_own(const iso_brick_window *window, const iso_surface *surface, iso_edge_points *out) {
    int last[3];
    for (int axis = 0; axis < 3; axis++) last[axis] = smaller(window->last[axis], ISO_BRICK - 1);
    for (int z = 0; z <= last[2]; z++)
        for (int y = 0; y <= last[1]; y++)
            for (int x = 0; x <= last[0]; x++)
                for (int axis = 0; axis < 3; axis++)
                    try_edge(window, &(edge){{x, y, z}, axis, iso_window_index(x, y, z)}, surface, out);
}

void iso_edge_points_far(const iso_brick_window *window, const iso_surface *surface, iso_edge_points *out) {
    int last[3];
    for (int axis = 0; axis < 3; axis++) {
        if (window->last[axis] < 1) return; /* a layer of one voxel has no cells */
        last[axis] = smaller(window->last[axis], ISO_BRICK);
    }
    for (int z = 0; z <= last[2]; z++)
        for (int y = 0; y <= last[1]; y++)
            for (int x = z == ISO_BRICK || y == ISO_BRICK ? 0 : ISO_BRICK; x <= last[0]; x++)
                for (int axis = 0; axis < 3; axis++) {
                    edge e = {{x, y, z}, axis, iso_window_index(x, y, z)};
                    if (e.voxel[axis] < ISO_BRICK) try_edge(window, &e, surface, out);
                }
}
