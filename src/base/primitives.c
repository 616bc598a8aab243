/* primitives: packing of points and curvatures, and access to views of points and meshes. */
#include "base/primitives.h"

#include <string.h>

#include "base/memory.h"
#include "base/point_code.h"

/* Truncates to an integer, clamped to 0 .. `most`. */
static uint32_t cut_off(float steps, int most) {
    return (uint32_t)(steps < 0 ? 0 : steps > (float)most ? (float)most : steps);
}

iso_point iso_point_pack(const iso_surfel *surfel) {
    iso_surfel scaled = *surfel;
    const float *n = surfel->normal;
    float scale = 1 / (fabsf(n[0]) + fabsf(n[1]) + fabsf(n[2]));
    for (int axis = 0; axis < 3; axis++) scaled.normal[axis] *= scale;
    return iso_point_pack_scaled(&scaled);
}

iso_point iso_point_pack_scaled(const iso_surfel *surfel) {
    const float *n = surfel->normal;
    uint32_t steps[3], normal_steps[2];
    float part[2];
    for (int axis = 0; axis < 3; axis++)
        steps[axis] =
            cut_off(iso_point_scale_coordinate(surfel->position[axis]), ISO_POINT_COORDINATE_STEPS - 1);
    iso_point_fold_normal(n[0], n[1], n[2], part);
    for (int k = 0; k < 2; k++)
        normal_steps[k] = cut_off(iso_point_scale_normal(part[k]), ISO_POINT_NORMAL_STEPS);
    return iso_point_join(steps[0], steps[1], steps[2], normal_steps[0], normal_steps[1]);
}

iso_surfel iso_point_unpack(iso_point point) {
    iso_surfel surfel;
    float n[3];
    for (int axis = 0; axis < 3; axis++)
        surfel.position[axis] = iso_point_coordinate((float)iso_point_steps(point, axis));
    iso_point_unfold_normal(iso_point_normal_bits(point), n);
    const float length = sqrtf(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    for (int axis = 0; axis < 3; axis++) surfel.normal[axis] = n[axis] / length;
    return surfel;
}

void iso_curvature_frame(const float n[3], float u[3], float v[3]) {
    const float sign = copysignf(1, n[2]), a = -1 / (sign + n[2]), b = n[0] * n[1] * a;
    u[0] = 1 + sign * (n[0] * n[0] * a);
    u[1] = sign * b;
    u[2] = -(sign * n[0]);
    v[0] = b;
    v[1] = sign + n[1] * n[1] * a;
    v[2] = -n[1];
}

static int16_t shape_steps(float value) {
    const float per_voxel = 1 / (ISO_CURVATURE_STEP * (1 << ISO_CURVATURE_LOW_BITS));
    return (int16_t)(((int32_t)(value * per_voxel + 2048.5f) - 2048) * (1 << ISO_CURVATURE_LOW_BITS));
}

iso_curvature iso_curvature_pack(float uu, float uv, float vv) {
    float norm = sqrtf(uu * uu + 2 * (uv * uv) + vv * vv);
    if (!(norm < 1e15f)) return (iso_curvature){0};
    float scale = norm > ISO_CURVATURE_MOST ? ISO_CURVATURE_MOST / norm : 1;
    return (iso_curvature){shape_steps(uu * scale), shape_steps(uv * scale), shape_steps(vv * scale), 0};
}

void iso_curvature_unpack(iso_curvature curvature, float s[3], float tilt[2]) {
    const int entry[3] = {curvature.uu, curvature.uv, curvature.vv}, low = (1 << ISO_CURVATURE_LOW_BITS) - 1,
              most = ISO_CURVATURE_TILT_STEPS;
    int bits = 0;
    for (int k = 0; k < 3; k++) {
        s[k] = (float)(entry[k] - (entry[k] & low)) * ISO_CURVATURE_STEP;
        bits |= (entry[k] & low) << (ISO_CURVATURE_LOW_BITS * k);
    }
    for (int k = 0; k < 2; k++) {
        int steps = bits >> (ISO_CURVATURE_TILT_BITS * k) & (2 * most + 1);
        if (steps > most) steps -= 2 * most + 2;
        tilt[k] =
            (float)(steps * (steps < 0 ? -steps : steps)) * (ISO_CURVATURE_TILT_MOST / (float)(most * most));
    }
}

size_t iso_point_view_count(const iso_point_view *view) {
    size_t count = 0;
    for (size_t i = 0; i < view->span_count; i++) count += view->spans[i].count;
    return count;
}

iso_surfel iso_point_view_get(const iso_point_view *view, size_t index) {
    return view->packed ? iso_point_unpack(view->packed[index]) : view->surfels[index];
}

iso_vec3 iso_brick_position(const int32_t brick[3], const float position[3]) {
    return iso_vec3_make(brick[0] * (double)ISO_BRICK + position[0],
                         brick[1] * (double)ISO_BRICK + position[1],
                         brick[2] * (double)ISO_BRICK + position[2]);
}

/* Adds the points of a span. Rounding keeps the order of coordinates, so only the smallest and the largest
 * ones in the brick are converted. */
static void add_span(const iso_point_view *view, size_t number, iso_box *box) {
    const iso_point_span *span = &view->spans[number];
    float lo[3] = {NAN, NAN, NAN}, hi[3] = {NAN, NAN, NAN};
    if (view->bounds) {
        const iso_point_bounds *bounds = &view->bounds[number];
        if (!(bounds->lo[0] <= bounds->hi[0])) return;
        memcpy(lo, bounds->lo, sizeof lo);
        memcpy(hi, bounds->hi, sizeof hi);
    }
    for (uint32_t i = 0; i < span->count && !view->bounds; i++) {
        const iso_surfel surfel = iso_point_view_get(view, span->first + i);
        for (int axis = 0; axis < 3; axis++) {
            const float p = surfel.position[axis];
            lo[axis] = p >= lo[axis] || isnan(p) ? lo[axis] : p;
            hi[axis] = p <= hi[axis] || isnan(p) ? hi[axis] : p;
        }
    }
    iso_box_add(box, iso_brick_position(span->brick, lo));
    iso_box_add(box, iso_brick_position(span->brick, hi));
}

iso_box iso_point_view_bounds(const iso_point_view *view) {
    iso_box box = iso_box_empty();
    for (size_t s = 0; s < view->span_count; s++) add_span(view, s, &box);
    return box;
}

size_t iso_mesh_view_vertex_count(const iso_mesh_view *view) {
    size_t count = 0;
    for (size_t i = 0; i < view->span_count; i++) count += view->spans[i].owned_count;
    return count;
}

size_t iso_mesh_view_triangle_count(const iso_mesh_view *view) {
    size_t count = 0;
    for (size_t i = 0; i < view->span_count; i++) count += view->spans[i].triangle_count;
    return count;
}

iso_box iso_mesh_view_bounds(const iso_mesh_view *view) {
    iso_box box = iso_box_empty();
    for (size_t s = 0; s < view->span_count; s++) {
        const iso_mesh_span *span = &view->spans[s];
        for (uint32_t i = 0; i < span->owned_count; i++)
            iso_box_add(&box,
                        iso_brick_position(span->brick, view->vertices[span->first_vertex + i].position));
    }
    return box;
}

void iso_triangles_free(iso_triangles *mesh) {
    iso_free(mesh->vertices);
    iso_free(mesh->triangles);
    iso_free(mesh->colors);
    *mesh = (iso_triangles){0};
}
