/* project: transforms of positions and normals, and conservative bounds of boxes in the picture. */
#include "render/view/project.h"

iso_projector iso_projector_make(const iso_view *view, const iso_transform *transform) {
    iso_projector projector = {.view = view};
    iso_affine affine = iso_transform_affine(transform);
    const double *r = view->rotation;
    for (int row = 0; row < 3; row++)
        for (int column = 0; column < 3; column++) {
            double sum = 0, normal = 0;
            for (int k = 0; k < 3; k++) {
                sum += r[3 * row + k] * affine.m[3 * k + column];
                normal += r[3 * row + k] * affine.inverse[3 * column + k];
            }
            projector.matrix[3 * row + column] = sum;
            projector.normal[3 * row + column] = (float)normal;
        }
    iso_vec3 origin =
        iso_view_point(view, iso_vec3_make(affine.origin[0], affine.origin[1], affine.origin[2]));
    projector.origin[0] = origin.x;
    projector.origin[1] = origin.y;
    projector.origin[2] = origin.z;
    return projector;
}

void iso_projector_eye(const iso_projector *projector, const iso_transform *transform, double eye[3]) {
    const iso_view *view = projector->view;
    const double *forward = view->rotation + 6;
    iso_affine affine = iso_transform_affine(transform);
    iso_vec3 index =
        view->orthographic
            ? iso_affine_vector_to_index(&affine, iso_vec3_make(forward[0], forward[1], forward[2]))
            : iso_affine_point_to_index(&affine, view->eye);
    eye[0] = index.x;
    eye[1] = index.y;
    eye[2] = index.z;
}

void iso_projector_normal(const iso_projector *projector, const float n[3], float out[3]) {
    const float *m = projector->normal;
    float v[3], square = 0;
    for (int row = 0; row < 3; row++) {
        v[row] = m[3 * row] * n[0] + m[3 * row + 1] * n[1] + m[3 * row + 2] * n[2];
        square += v[row] * v[row];
    }
    float length = sqrtf(square);
    if (!(length > 0)) {
        out[0] = out[1] = 0;
        out[2] = -1;
        return;
    }
    for (int row = 0; row < 3; row++) out[row] = v[row] / length;
}

/* Replaces lo and hi by the least lo / z and the largest hi / z of all z in [near, far], near > 0. */
static void perspective_range(double *lo, double *hi, double near, double far) {
    *lo /= *lo < 0 ? near : far;
    *hi /= *hi > 0 ? near : far;
}

/* Pixels of [lo, hi], clipped to 0 .. size - 1. Wider by one on each side: rasterisation snaps positions, and
 * a point always covers the pixel that contains its centre. */
static iso_rows pixel_range(double lo, double hi, int size) {
    lo = floor(lo) - 1;
    hi = floor(hi) + 1;
    if (!(lo < size && hi >= 0)) return (iso_rows){0, -1};
    return (iso_rows){lo < 0 ? 0 : (int)lo, hi > size - 1 ? size - 1 : (int)hi};
}

static iso_box view_box(const iso_projector *projector, const iso_box *box) {
    const double *m = projector->matrix, *o = projector->origin;
    iso_box seen = iso_box_empty();
    for (int corner = 0; corner < 8; corner++) {
        iso_vec3 p = iso_box_corner(box, corner);
        iso_box_add(&seen, iso_vec3_make(m[0] * p.x + m[1] * p.y + m[2] * p.z + o[0],
                                         m[3] * p.x + m[4] * p.y + m[5] * p.z + o[1],
                                         m[6] * p.x + m[7] * p.y + m[8] * p.z + o[2]));
    }
    return seen;
}

iso_area iso_projector_area(const iso_projector *projector, const iso_box *box, double radius) {
    const iso_view *view = projector->view;
    const iso_area none = {{0, -1}, {0, -1}, 0};
    if (iso_box_is_empty(box)) return none;
    iso_box seen = view_box(projector, box);
    const iso_vec3 reach = iso_vec3_make(radius, radius, radius);
    seen = (iso_box){iso_vec3_sub(seen.lo, reach), iso_vec3_add(seen.hi, reach)};
    if (!(seen.hi.z >= view->near)) return none;
    const double near = iso_max(seen.lo.z, view->near);
    double x[2] = {seen.lo.x, seen.hi.x}, y[2] = {seen.lo.y, seen.hi.y};
    if (!view->orthographic) {
        perspective_range(&x[0], &x[1], near, seen.hi.z);
        perspective_range(&y[0], &y[1], near, seen.hi.z);
    }
    const double focal = view->focal;
    const iso_area area = {
        .columns = pixel_range(x[0] * focal + view->cx, x[1] * focal + view->cx, view->width),
        .rows = pixel_range(y[0] * focal + view->cy, y[1] * focal + view->cy, view->height),
        .nearest = near - 1e-5 * fabs(near)};
    return iso_area_is_empty(&area) ? none : area;
}

iso_rows iso_projector_rows(const iso_projector *projector, const iso_box *box, double radius) {
    return iso_projector_area(projector, box, radius).rows;
}

/* Bounds normal . (position - eye) by interval arithmetic on the boxes around positions and normals. */
iso_facing iso_projector_facing(const iso_projector *projector, const double eye[3], const int32_t brick[3],
                                const iso_point_bounds *bounds) {
    bool orthographic = projector->view->orthographic;
    double lowest = 0, highest = 0, size = 0;
    for (int k = 0; k < 3; k++) {
        double corner = brick[k] * (double)ISO_BRICK - eye[k];
        double lo = orthographic ? eye[k] : corner + bounds->lo[k];
        double hi = orthographic ? eye[k] : corner + bounds->hi[k];
        double a = lo * bounds->normal_lo[k], b = lo * bounds->normal_hi[k], c = hi * bounds->normal_lo[k],
               d = hi * bounds->normal_hi[k];
        lowest += iso_min(iso_min(a, b), iso_min(c, d));
        highest += iso_max(iso_max(a, b), iso_max(c, d));
        size += iso_max(fabs(lo), fabs(hi));
    }
    if (lowest > 1e-5 * size) return ISO_FACING_AWAY;
    return highest < -1e-5 * size ? ISO_FACING_EYE : ISO_FACING_BOTH;
}

iso_box iso_surfel_bounds(const iso_surfel *surfels, size_t count, const int32_t brick[3]) {
    iso_box box = iso_box_empty();
    for (size_t i = 0; i < count; i++) {
        const float *p = surfels[i].position;
        if (isfinite(p[0]) && isfinite(p[1]) && isfinite(p[2]))
            iso_box_add(&box, iso_vec3_make(p[0], p[1], p[2]));
    }
    if (iso_box_is_empty(&box)) return box;
    iso_vec3 corner = iso_vec3_make(brick[0] * (double)ISO_BRICK, brick[1] * (double)ISO_BRICK,
                                    brick[2] * (double)ISO_BRICK);
    return (iso_box){iso_vec3_add(box.lo, corner), iso_vec3_add(box.hi, corner)};
}

int iso_band_count(const iso_pool *pool, int height) {
    enum { BANDS_PER_THREAD = 4, LEAST_ROWS = 16 };
    int threads = iso_pool_threads(pool);
    if (threads == 1) return 1;
    int most = (height + LEAST_ROWS - 1) / LEAST_ROWS;
    return BANDS_PER_THREAD * threads < most ? BANDS_PER_THREAD * threads : most;
}

iso_rows iso_band_rows(int height, int band_count, size_t band) {
    int64_t first = (int64_t)height * (int64_t)band / band_count;
    int64_t end = (int64_t)height * ((int64_t)band + 1) / band_count;
    return (iso_rows){(int)first, (int)end - 1};
}
