/* points_kernel: projects attenuated points (points.c) and draws them into bands.
 *
 * Positions are projected in doubles, so that neighbouring bricks agree; these loops are plain C, which
 * compilers vectorise. */
#include "render/raster/points_kernel.h"

#include "base/point_code_simd.h"
#include "base/simd.h"

static void unpack_positions(const iso_point *points, int count, float position[3][CHUNK]) {
    for (int axis = 0; axis < 3; axis++)
        for (int i = 0; i < count; i++)
            position[axis][i] = iso_point_coordinate((float)(int32_t)iso_point_steps(points[i], axis));
}

static void copy_positions(const iso_surfel *surfels, int count, float position[3][CHUNK]) {
    for (int i = 0; i < count; i++)
        for (int axis = 0; axis < 3; axis++) position[axis][i] = surfels[i].position[axis];
}

/* Transforms positions to view space, as iso_projector_point does. */
static void transform_positions(const iso_projector *projector, const int32_t brick[3], int count,
                                float position[3][CHUNK], double view[3][CHUNK]) {
    const double *m = projector->matrix, *o = projector->origin;
    const double corner[3] = {brick[0] * (double)ISO_BRICK, brick[1] * (double)ISO_BRICK,
                              brick[2] * (double)ISO_BRICK};
    for (int axis = 0; axis < 3; axis++) {
        const double a = m[3 * axis], b = m[3 * axis + 1], c = m[3 * axis + 2], d = o[axis];
        double *out = view[axis];
        for (int i = 0; i < count; i++)
            out[i] = a * (corner[0] + position[0][i]) + b * (corner[1] + position[1][i]) +
                     c * (corner[2] + position[2][i]) + d;
    }
}

/* Computes pixel coordinates along one axis, from the picture's corner, snapped to 1/65536; NaN when they are
 * farther away than FAR_PIXELS. */
static void to_pixels(const double *view, const double *scale, double axis_pixel, int count, double *out) {
    for (int i = 0; i < count; i++) {
        double pixel = floor(view[i] * scale[i] * 65536 + 0.5) * (1.0 / 65536) + axis_pixel;
        out[i] = fabs(pixel) < FAR_PIXELS ? pixel : (double)NAN;
    }
}

/* Splits pixel coordinates into whole pixels and the rest; NaN becomes 0. */
static void split_pixels(const double *pixel, int count, int32_t *whole, float *rest) {
    for (int i = 0; i < count; i++) {
        double sound = pixel[i] == pixel[i] ? pixel[i] : 0, low = floor(sound);
        whole[i] = (int32_t)low;
        rest[i] = (float)(sound - low);
    }
}

static void project_chunk(const point_draw *draw, const block *b, size_t first, int count, point_chunk *out) {
    const iso_view *view = draw->projector.view;
    const iso_point_view *points = draw->points;
    float position[3][CHUNK];
    double at[3][CHUNK], scale[CHUNK], x[CHUNK], y[CHUNK];
    if (points->surfels)
        copy_positions(points->surfels + first, count, position);
    else
        unpack_positions(points->packed + first, count, position);
    transform_positions(&draw->projector, b->span->brick, count, position, at);
    for (int i = 0; i < count; i++) scale[i] = view->orthographic ? view->focal : view->focal / at[2][i];
    to_pixels(at[0], scale, view->cx, count, x);
    to_pixels(at[1], scale, view->cy, count, y);
    split_pixels(x, count, out->column, out->fx);
    split_pixels(y, count, out->row, out->fy);
    const double radius = point_radius(points, first);
    for (int i = 0; i < count; i++) {
        double own = points->radii ? point_radius(points, first + (size_t)i) : radius;
        out->radius[i] = (float)(own * scale[i]);
        out->depth[i] = (float)at[2][i];
    }
    for (int i = 0; i < count; i++) {
        float r = out->radius[i];
        int32_t kind = r < 0.5f ? POINT_PIXEL : r <= REACH ? POINT_DISC : POINT_LARGE;
        if (!(x[i] == x[i] && y[i] == y[i])) kind = POINT_LARGE;
        out->kind[i] = at[2][i] >= view->near ? kind : POINT_OUT;
    }
}

ISO_INLINE void splat_pixel(float *depth, uint32_t *source, float new_depth, uint32_t new_source) {
    bool nearer = new_depth < *depth;
    *depth = nearer ? new_depth : *depth;
    *source = nearer ? new_source : *source;
}

/* Draws a disc: all pixels of the band whose centres it contains. */
ISO_INLINE void splat_disc(const point_band *band, const point_chunk *c, int i, uint32_t source) {
    const float r = c->radius[i], fx = c->fx[i] - 0.5f, fy = c->fy[i] - 0.5f;
    const int column = c->column[i], row = c->row[i];
    if (column < -REACH || column >= band->draw->projector.view->width + REACH) return;
    /* Rows and columns to draw, relative to those of the centre; the test of the distance excludes excess
     * ones. */
    int up = (int)(r - fy), down = (int)(r + fy), left = (int)(r - fx), right = (int)(r + fx);
    if (row - up < band->rows.first) up = row - band->rows.first;
    if (row + down > band->rows.last) down = band->rows.last - row;
    const vf square = v_set(r * r), depth = v_set(c->depth[i]);
    const vi sources = v_seti((int32_t)source);
    /* Storing unchanged values is cheaper than a branch on whether any changes. */
    for (int k = -left; k <= right; k += ISO_LANES) {
        vf dx = v_to_float(v_lanes() + v_seti(k)) - v_set(fx);
        for (int j = -up; j <= down; j++) {
            float dy = (float)j - fy;
            float *there = band_pixel(band, column + k, row + j);
            vf old = v_load(there);
            vm inside = v_and(v_le(dx * dx + v_set(dy * dy), square), v_lt(depth, old));
            int32_t *from = (int32_t *)band->source + (there - band->depth);
            v_store(there, v_select(inside, depth, old));
            v_storei(from, v_selecti(inside, sources, v_loadi(from)));
        }
    }
}

static void splat_chunk(const point_band *band, const block *b, const point_chunk *c, size_t first,
                        int count) {
    const point_draw *draw = band->draw;
    const int width = draw->projector.view->width;
    for (int i = 0; i < count; i++) {
        if (c->kind[i] == POINT_OUT) continue;
        if (c->kind[i] == POINT_LARGE) {
            iso_draw_large_point(band, b, first + (size_t)i);
            continue;
        }
        uint32_t source = source_of(draw, first + (size_t)i);
        const int column = c->column[i], row = c->row[i];
        if (row >= band->rows.first && row <= band->rows.last && column >= 0 && column < width) {
            float *there = band_pixel(band, column, row);
            splat_pixel(there, band->source + (there - band->depth), c->depth[i], source);
        }
        if (c->kind[i] == POINT_DISC) splat_disc(band, c, i, source);
    }
}

typedef struct normals {
    vf x, y, z;
} normals;

ISO_INLINE normals normalize(normals n, vf *length) {
    *length = v_sqrt(n.x * n.x + n.y * n.y + n.z * n.z);
    return (normals){n.x / *length, n.y / *length, n.z / *length};
}

/* Transforms normals to view space, as iso_projector_normal does. */
ISO_INLINE normals project_normal(const float m[9], normals n) {
    normals v = {v_set(m[0]) * n.x + v_set(m[1]) * n.y + v_set(m[2]) * n.z,
                 v_set(m[3]) * n.x + v_set(m[4]) * n.y + v_set(m[5]) * n.z,
                 v_set(m[6]) * n.x + v_set(m[7]) * n.y + v_set(m[8]) * n.z};
    vf length;
    v = normalize(v, &length);
    vm sound = v_lt(v_set(0), length);
    return (normals){v_select(sound, v.x, v_set(0)), v_select(sound, v.y, v_set(0)),
                     v_select(sound, v.z, v_set(-1))};
}

/* Stores the masked lanes of a vector whose first `count` lanes lie in the row. */
ISO_INLINE void store_masked(float *to, vm mask, vf value, int count) {
    float lanes[ISO_LANES];
    if (count >= ISO_LANES) {
        v_store(to, v_select(mask, value, v_load(to)));
        return;
    }
    v_store(lanes, value);
    for (int k = 0; k < count; k++)
        if (v_mask(mask) >> k & 1) to[k] = lanes[k];
}

static void resolve_row(const point_band *band, int row) {
    const point_draw *draw = band->draw;
    const iso_gbuffer *g = draw->target->gbuffer;
    const float *depth = band_pixel(band, 0, row);
    const int32_t *source = (const int32_t *)band->source + (depth - band->depth);
    const size_t start = (size_t)row * (size_t)g->width;
    for (int x = 0; x < g->width; x += ISO_LANES) {
        int left = g->width - x; /* lanes from `left` on are margin */
        vi bits = v_loadi(source + x);
        uint32_t seen = ~v_mask(v_eqi(bits, v_seti(-1))) & ((1u << ISO_LANES) - 1);
        if (left < ISO_LANES) seen &= (1u << left) - 1;
        if (!seen) continue;
        vm mask = v_from_mask(seen);
        vf normal[3];
        unpack_normals(bits, normal);
        normals n = project_normal(draw->projector.normal, (normals){normal[0], normal[1], normal[2]});
        store_masked(g->depth + start + x, mask, v_load(depth + x), left);
        store_masked(g->normal[0] + start + x, mask, n.x, left);
        store_masked(g->normal[1] + start + x, mask, n.y, left);
        store_masked(g->normal[2] + start + x, mask, n.z, left);
        for (int k = 0; k < ISO_LANES && k < left; k++)
            if (seen >> k & 1) g->surface[start + (size_t)(x + k)] = draw->target->surface;
    }
}

const point_kernels ISO_KERNEL_NAME(iso_point_kernels) = {project_chunk, splat_chunk, resolve_row};
