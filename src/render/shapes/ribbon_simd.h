/* ribbon_simd: the ray of a pixel and a bilinear patch.
 *
 * The patch is m(s) + t h(s) with m(s) = s path the line from the first vertex, h(s) = h0 + s (h1 - h0) the
 * vector from the line to an edge, 0 <= s <= 1, -1 <= t <= 1. Along the ray of a pixel, everything is
 * projected onto the plane of the first vertex's depth, where the ray is a point, b: then b - m and h are
 * parallel, which is a quadratic in s. Its values at the ends, h0 x b and h1 x (b - path), have no terms that
 * cancel.
 *
 * Source: Reshetov 2019, "Cool patches: a geometric approach to ray/bilinear patch intersections" (Ray
 * Tracing Gems, chapter 8), for the quadratic; the projection is ours. */
#ifndef ISO_RENDER_SHAPES_RIBBON_SIMD_H
#define ISO_RENDER_SHAPES_RIBBON_SIMD_H

#include "render/shapes/patch_simd.h"

/* The fields' vectors have the components (x - u z, y - v z, z), u and v the slopes of the first vertex's
 * ray. */
typedef struct sp_patch {
    vf b[2];             /* the pixel from the first vertex, mm */
    vf path[2], h[2][2]; /* the same vectors, projected along the pixel's ray onto the first vertex's plane */
    vf path_z, h_z[2];
} sp_patch;

ISO_INLINE vf cross2(const vf a[2], const vf b[2]) {
    return a[0] * b[1] - a[1] * b[0];
}

ISO_INLINE sp_patch patch_at(const sp_pixel *p, const vf *field) {
    const vf shift[2] = {p->slope * p->dx, p->slope * p->dy};
    const vf *path = field + ISO_FIELD_PATH, *first = field + ISO_FIELD_FIRST_EDGE,
             *last = field + ISO_FIELD_LAST_EDGE;
    sp_patch q = {.b = {p->k * p->dx, p->k * p->dy}, .path_z = path[2], .h_z = {first[2], last[2]}};
    for (int a = 0; a < 2; a++) {
        q.path[a] = path[a] - path[2] * shift[a];
        q.h[0][a] = first[a] - first[2] * shift[a];
        q.h[1][a] = last[a] - last[2] * shift[a];
    }
    return q;
}

/* Returns whether the ray meets the patch at s; sets t, and the depth relative to the first vertex's.
 * `width`: how wide a pixel is at the depths of the two vertices, mm. */
ISO_INLINE vm meets_at(const sp_patch *q, vf s, const vf width[2], vf *t, vf *depth) {
    const vf zero = v_set(0), one = v_set(1), slack = v_set(1e-5f);
    vf m[2], h[2];
    for (int a = 0; a < 2; a++) {
        m[a] = q->b[a] - s * q->path[a];
        h[a] = q->h[0][a] + s * (q->h[1][a] - q->h[0][a]);
    }
    const vf square = h[0] * h[0] + h[1] * h[1], beside = cross2(m, h),
             pixel = width[0] + s * (width[1] - width[0]);
    *t = (m[0] * h[0] + m[1] * h[1]) / square;
    *depth = s * q->path_z + *t * (q->h_z[0] + s * (q->h_z[1] - q->h_z[0]));
    /* a ribbon that is seen from its edge has no width: rounding must not find hits far beside the edge */
    const vm close = v_le(beside * beside, square * (pixel * pixel * 1e-3f));
    const vm within = v_and(v_le(-slack, s), v_le(s, one + slack));
    return v_and(v_and(within, close), v_and(v_lt(zero, square), v_le(v_abs(*t), one)));
}

/* Finds the nearest intersection: s, t and the depth. */
ISO_INLINE vm meet_ribbon(const sp_pixel *p, const vf *field, vf *s, vf *t, vf *depth) {
    const vf zero = v_set(0);
    const sp_patch q = patch_at(p, field);
    const vf rest[2] = {q.b[0] - q.path[0], q.b[1] - q.path[1]},
             turn[2] = {q.h[1][0] - q.h[0][0], q.h[1][1] - q.h[0][1]};
    const vf c = cross2(q.h[0], q.b), end = cross2(q.h[1], rest), a = cross2(q.path, turn), b = end - c - a,
             discriminant = b * b - 4.0f * a * c;
    vm hit = v_le(zero, discriminant);
    *s = *t = *depth = zero;
    if (!v_mask(hit)) return hit;
    const vf root = v_sqrt(v_max(discriminant, zero)),
             sum = -0.5f * (b + v_select(v_lt(b, zero), -root, root));
    const vf width[2] = {p->k, p->k + q.path_z * p->slope};
    vf other = sum / a, other_t, other_depth;
    *s = c / sum;
    const vm one = v_and(hit, meets_at(&q, *s, width, t, depth)),
             two = v_and(hit, meets_at(&q, other, width, &other_t, &other_depth));
    const vm take = v_and(two, v_or(v_andnot(two, one), v_lt(other_depth, *depth)));
    *s = v_select(take, other, *s);
    *t = v_select(take, other_t, *t);
    *depth = field[ISO_FIELD_Z] + v_select(take, other_depth, *depth);
    return v_or(one, two);
}

/* Computes the normal of the side that the pixel sees, and the position along the segment, 0 to 1. */
ISO_INLINE void ribbon_normal(const sp_pixel *p, const sp_place *at, const vf *field, vf normal[3],
                              vf *along) {
    const vf zero = v_set(0), one = v_set(1);
    const vf *path = field + ISO_FIELD_PATH, *first = field + ISO_FIELD_FIRST_EDGE,
             *last = field + ISO_FIELD_LAST_EDGE;
    vf s, t, depth, ds[3], dt[3];
    meet_ribbon(p, field, &s, &t, &depth);
    *along = s = v_min(v_max(s, zero), one);
    for (int a = 0; a < 3; a++) {
        ds[a] = path[a] + t * (last[a] - first[a]);
        dt[a] = first[a] + s * (last[a] - first[a]);
    }
    ds[0] += at->u * ds[2], ds[1] += at->v * ds[2];
    dt[0] += at->u * dt[2], dt[1] += at->v * dt[2];
    for (int a = 0; a < 3; a++)
        normal[a] = ds[(a + 1) % 3] * dt[(a + 2) % 3] - ds[(a + 2) % 3] * dt[(a + 1) % 3];
    const vf square = normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2],
             size = one / v_sqrt(v_max(square, v_set(1e-36f)));
    const vm away = v_lt(zero, normal[0] * p->u + normal[1] * p->v + normal[2]);
    for (int a = 0; a < 3; a++) normal[a] = v_select(away, -size, size) * normal[a];
}

#endif
