/* solid_simd: the ray of a pixel and the unit solids of render/shapes/solid.h.
 *
 * In the solid's coordinates the ray is o + s d with o = k m and d = RAY + slope m, where m = dx X + dy Y; X,
 * Y and RAY are the images of the picture's axes and of the centre's ray under the inverse of the glyph's
 * map. So o x d = k (m x RAY): discriminants are written with this product, and have no terms that cancel. */
#ifndef ISO_RENDER_SHAPES_SOLID_SIMD_H
#define ISO_RENDER_SHAPES_SOLID_SIMD_H

#include "render/shapes/patch_simd.h"

typedef struct sp_unit {
    vf o[3], d[3];
    vf xy, xz, yz; /* of o x d: o_x d_y - o_y d_x, .. */
} sp_unit;

/* The part of a ray in a solid, and the normal where it enters. */
typedef struct sp_piece {
    vf in, out, normal[3];
    vm hit;
} sp_piece;

ISO_INLINE sp_unit unit_ray(const sp_pixel *p, const vf *field) {
    const vf *ray = field + ISO_FIELD_UNIT_RAY, tiny = v_set(1e-20f);
    vf m[3];
    sp_unit u;
    for (int a = 0; a < 3; a++) {
        m[a] = p->dx * field[ISO_FIELD_UNIT_X + a] + p->dy * field[ISO_FIELD_UNIT_Y + a];
        u.o[a] = p->k * m[a];
        u.d[a] = ray[a] + p->slope * m[a];
        u.d[a] = v_select(v_lt(v_abs(u.d[a]), tiny), tiny, u.d[a]); /* so that it can be divided by */
    }
    u.xy = p->k * (m[0] * ray[1] - m[1] * ray[0]);
    u.xz = p->k * (m[0] * ray[2] - m[2] * ray[0]);
    u.yz = p->k * (m[1] * ray[2] - m[2] * ray[1]);
    return u;
}

/* The part of the ray in the slab low <= coordinate <= high. */
ISO_INLINE sp_piece meet_slab(const sp_unit *u, int axis, float low, float high) {
    const vf inverse = 1.0f / u->d[axis], a = (low - u->o[axis]) * inverse, b = (high - u->o[axis]) * inverse;
    const vm up = v_lt(v_set(0), inverse);
    sp_piece p = {.in = v_select(up, a, b), .out = v_select(up, b, a), .hit = v_eqi(v_seti(0), v_seti(0))};
    for (int i = 0; i < 3; i++) p.normal[i] = v_set(0);
    p.normal[axis] = v_select(up, v_set(-1), v_set(1));
    return p;
}

ISO_INLINE sp_piece common(const sp_piece *a, const sp_piece *b) {
    const vm later = v_lt(a->in, b->in);
    sp_piece p = {.in = v_select(later, b->in, a->in), .out = v_min(a->out, b->out)};
    for (int i = 0; i < 3; i++) p.normal[i] = v_select(later, b->normal[i], a->normal[i]);
    p.hit = v_and(v_and(a->hit, b->hit), v_le(p.in, p.out));
    return p;
}

ISO_INLINE sp_piece meet_ellipsoid(const sp_unit *u) {
    const vf dd = u->d[0] * u->d[0] + u->d[1] * u->d[1] + u->d[2] * u->d[2],
             discriminant = dd - (u->xy * u->xy + u->xz * u->xz + u->yz * u->yz),
             root = v_sqrt(v_max(discriminant, v_set(0))),
             along = u->o[0] * u->d[0] + u->o[1] * u->d[1] + u->o[2] * u->d[2];
    sp_piece p = {
        .in = -(along + root) / dd, .out = (root - along) / dd, .hit = v_le(v_set(0), discriminant)};
    for (int i = 0; i < 3; i++) p.normal[i] = u->o[i] + p.in * u->d[i];
    return p;
}

/* The part of the ray in the infinite cylinder x^2 + y^2 <= radius^2. */
ISO_INLINE sp_piece meet_pipe(const sp_unit *u, float radius) {
    const vf a = u->d[0] * u->d[0] + u->d[1] * u->d[1], off = u->o[0] * u->o[0] + u->o[1] * u->o[1];
    const vm steep = v_lt(a, v_set(1e-30f)); /* the ray runs along the pipe */
    const vf discriminant = v_select(steep, radius * radius - off, radius * radius * a - u->xy * u->xy),
             root = v_sqrt(v_max(discriminant, v_set(0))), along = u->o[0] * u->d[0] + u->o[1] * u->d[1],
             divisor = v_select(steep, v_set(1), a);
    sp_piece p = {.in = v_select(steep, v_set(-1e30f), -(along + root) / divisor),
                  .out = v_select(steep, v_set(1e30f), (root - along) / divisor),
                  .hit = v_le(v_set(0), discriminant)};
    p.normal[0] = u->o[0] + p.in * u->d[0];
    p.normal[1] = u->o[1] + p.in * u->d[1];
    p.normal[2] = v_set(0);
    return p;
}

/* The part of the ray in the infinite cone x^2 + y^2 <= w^2, w >= 0 with w = (1 - z) * widening. */
ISO_INLINE sp_piece meet_funnel(const sp_unit *u, float widening) {
    const vf zero = v_set(0), w = (1.0f - u->o[2]) * widening, dw = -u->d[2] * widening;
    const vf p = widening * (u->d[0] + u->xz), q = widening * (u->d[1] + u->yz),
             discriminant = (p * p + q * q) - u->xy * u->xy, root = v_sqrt(v_max(discriminant, zero));
    const vf a = u->d[0] * u->d[0] + u->d[1] * u->d[1] - dw * dw,
             b = u->o[0] * u->d[0] + u->o[1] * u->d[1] - w * dw,
             c = u->o[0] * u->o[0] + u->o[1] * u->o[1] - w * w;
    const vm back = v_lt(b, zero), front = v_lt(zero, b); /* where -b - root, -b + root cancel */
    const vf first = v_select(back, c, -(b + root)) / v_select(back, root - b, a),
             last = v_select(front, c, root - b) / v_select(front, -(b + root), a);
    /* a > 0: between the roots; else the ray passes through the funnel's wide end, forwards or backwards */
    const vm shallow = v_lt(zero, a), widens = v_lt(zero, dw);
    sp_piece piece = {.in = v_select(v_or(shallow, widens), first, v_set(-1e30f)),
                      .out = v_select(v_andnot(widens, shallow), v_set(1e30f), last),
                      .hit = v_le(zero, discriminant)};
    piece.normal[0] = u->o[0] + piece.in * u->d[0];
    piece.normal[1] = u->o[1] + piece.in * u->d[1];
    piece.normal[2] = (w + piece.in * dw) * widening;
    return piece;
}

ISO_INLINE sp_piece meet_box(const sp_unit *u) {
    sp_piece p = meet_slab(u, 0, -1, 1);
    for (int axis = 1; axis < 3; axis++) {
        const sp_piece other = meet_slab(u, axis, -1, 1);
        p = common(&p, &other);
    }
    return p;
}

ISO_INLINE sp_piece meet_cylinder_between(const sp_unit *u, float radius, float low, float high) {
    const sp_piece pipe = meet_pipe(u, radius), slab = meet_slab(u, 2, low, high);
    return common(&pipe, &slab);
}

/* The part of the ray in the cone with a base of radius 1 at z = base and its apex at z = 1. */
ISO_INLINE sp_piece meet_cone_from(const sp_unit *u, float base) {
    const sp_piece funnel = meet_funnel(u, 1 / (1 - base)), slab = meet_slab(u, 2, base, 1);
    return common(&funnel, &slab);
}

ISO_INLINE sp_piece meet_disc(const sp_unit *u) {
    sp_piece p = meet_slab(u, 2, 0, 0);
    const vf x = u->o[0] + p.in * u->d[0], y = u->o[1] + p.in * u->d[1];
    p.hit = v_le(x * x + y * y, v_set(1));
    return p;
}

ISO_INLINE sp_piece meet_arrow(const sp_unit *u) {
    const float neck = (float)ISO_ARROW_NECK;
    const sp_piece shaft = meet_cylinder_between(u, (float)ISO_ARROW_SHAFT, -1, neck),
                   head = meet_cone_from(u, neck);
    const vm first = v_and(shaft.hit, v_or(v_andnot(shaft.hit, head.hit), v_lt(shaft.in, head.in)));
    sp_piece p = {.in = v_select(first, shaft.in, head.in), .hit = v_or(shaft.hit, head.hit)};
    for (int i = 0; i < 3; i++) p.normal[i] = v_select(first, shaft.normal[i], head.normal[i]);
    return p;
}

ISO_INLINE sp_piece meet_solid(iso_glyph glyph, const sp_unit *u) {
    switch (glyph) {
    case ISO_GLYPH_CONE:
        return meet_cone_from(u, -1);
    case ISO_GLYPH_CYLINDER:
        return meet_cylinder_between(u, 1, -1, 1);
    case ISO_GLYPH_ARROW:
        return meet_arrow(u);
    case ISO_GLYPH_DISC:
        return meet_disc(u);
    case ISO_GLYPH_BOX:
        return meet_box(u);
    default:
        return meet_ellipsoid(u);
    }
}

ISO_INLINE vm solid_depth(iso_glyph glyph, const sp_pixel *p, const vf *field, vf *depth) {
    const sp_unit u = unit_ray(p, field);
    const sp_piece piece = meet_solid(glyph, &u);
    *depth = field[ISO_FIELD_Z] + piece.in;
    return piece.hit;
}

/* The normal where solid_depth found the solid: through the transpose of the map's inverse, whose columns are
 * X, Y and what remains of the ray without them. */
ISO_INLINE void solid_normal(iso_glyph glyph, const sp_pixel *p, const sp_place *at, const vf *field,
                             vf normal[3]) {
    const sp_unit u = unit_ray(p, field);
    const sp_piece piece = meet_solid(glyph, &u);
    for (int i = 0; i < 3; i++) normal[i] = v_set(0);
    for (int a = 0; a < 3; a++) {
        const vf x = field[ISO_FIELD_UNIT_X + a], y = field[ISO_FIELD_UNIT_Y + a],
                 z = field[ISO_FIELD_UNIT_RAY + a] - at->u * x - at->v * y;
        normal[0] += piece.normal[a] * x;
        normal[1] += piece.normal[a] * y;
        normal[2] += piece.normal[a] * z;
    }
    const vf square = normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2],
             scale = 1.0f / v_sqrt(v_max(square, v_set(1e-36f)));
    for (int i = 0; i < 3; i++) normal[i] *= scale;
}

#endif
