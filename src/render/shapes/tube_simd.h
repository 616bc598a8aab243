/* tube_simd: the ray of a pixel and a rounded cone.
 *
 * A rounded cone is the convex hull of two spheres: a part of a cone that touches both, and what the spheres
 * add at its ends. Everything is relative to the first vertex, in the frame (E1, E2, A) of the fields: the
 * ray is o + s d with o = k (w1, w2, w3) and d = slope (w1, w2, w3) + (0, RAY_E2, RAY_A), w = (dx, dy) in
 * that frame. So o x d is k w1 RAY_E2 along the axis: the discriminants, of the cylinder r^2 |d12|^2 - (o x
 * d)^2 and of the cone g ((r d12 - ..)^2 - g (o x d)^2), have no terms that cancel. */
#ifndef ISO_RENDER_SHAPES_TUBE_SIMD_H
#define ISO_RENDER_SHAPES_TUBE_SIMD_H

#include "render/shapes/sphere_simd.h"

typedef struct sp_meeting {
    vm hit, body; /* body: the hit is on the cone, else on the sphere at an end */
    vf depth, s;  /* s: relative to the first vertex's depth (on the body), or to the end's vertex's */
    vf along;     /* on the body: where the normal meets the axis, mm from the first vertex */
    vf place;     /* along the axis, mm from the first vertex */
    vm last;      /* the hit is at the second vertex's end */
    vm flat;      /* on a flat cap; its normal is the axis, inverted where not `last` */
    sp_pixel end; /* the pixel relative to the end's vertex */
    vf end_radius;
} sp_meeting;

/* The pixel relative to the second vertex. */
ISO_INLINE sp_pixel pixel_at_last(const sp_pixel *p, const vf *field) {
    sp_pixel q = *p;
    q.dx = p->dx - field[ISO_FIELD_X1];
    q.dy = p->dy - field[ISO_FIELD_Y1];
    q.k = p->k + (field[ISO_FIELD_Z1] - field[ISO_FIELD_Z]) * p->slope;
    return q;
}

ISO_INLINE sp_pixel choose_pixel(vm mask, const sp_pixel *a, const sp_pixel *b) {
    sp_pixel q = *b;
    q.dx = v_select(mask, a->dx, b->dx);
    q.dy = v_select(mask, a->dy, b->dy);
    q.k = v_select(mask, a->k, b->k);
    return q;
}

/* Intersects with the sphere at one end: the second vertex's where `last`. Where that sphere is missed the
 * other one is tried, because rounding may have chosen the wrong end. Sets m->last and m->end; returns which
 * pixels hit a sphere. */
ISO_INLINE vm meet_ends(const sp_pixel *p, const vf *field, bool tapered, vm wanted, vm last, sp_meeting *m,
                        vf *depth, vf *s) {
    const sp_pixel first = *p, second = pixel_at_last(p, field);
    vf dd;
    m->end = choose_pixel(last, &second, &first);
    m->end_radius = tapered ? v_select(last, field[ISO_FIELD_R1], field[ISO_FIELD_R]) : field[ISO_FIELD_R];
    vf d = sphere_discriminant(&m->end, m->end_radius, &dd);
    const vm missed = v_and(wanted, v_lt(d, v_set(0)));
    if (v_mask(missed)) {
        const sp_pixel other = choose_pixel(last, &first, &second);
        const vf radius = v_select(last, field[ISO_FIELD_R], field[ISO_FIELD_R1]);
        const vf again = sphere_discriminant(&other, radius, &dd);
        const vm found = v_and(missed, v_le(v_set(0), again));
        m->end = choose_pixel(found, &other, &m->end);
        m->end_radius = v_select(found, radius, m->end_radius);
        d = v_select(found, again, d);
        last = v_or(v_andnot(last, found), v_andnot(found, last));
    }
    *s = sphere_root(&m->end, v_max(d, v_set(0)), dd);
    *depth = v_select(last, field[ISO_FIELD_Z1], field[ISO_FIELD_Z]) + *s;
    m->last = last;
    return v_le(v_set(0), d);
}

/* Returns whether the ray enters the infinite cylinder, and sets s to where. */
ISO_INLINE vm meet_cylinder(vf radius, vf side, const vf w[3], const vf d[3], vf k, vf *s) {
    const vf a = v_max(d[0] * d[0] + d[1] * d[1], v_set(1e-30f)),
             discriminant = radius * radius * a - side * side;
    const vm hit = v_le(v_set(0), discriminant);
    *s = v_set(0);
    if (v_mask(hit)) *s = -(k * (w[0] * d[0] + w[1] * d[1]) + v_sqrt(v_max(discriminant, *s))) / a;
    return hit;
}

/* Returns whether the ray enters the infinite cone, and sets s to where; sets `within` where the ray comes
 * from inside the cone's wide end. */
ISO_INLINE vm meet_cone(const vf *field, vf side, const vf w[3], const vf d[3], vf k, vf *s, vm *within) {
    const vf sine = field[ISO_FIELD_SINE], g = field[ISO_FIELD_COSINE2], cone = field[ISO_FIELD_CONE];
    const vf radius = field[ISO_FIELD_R] + sine * (k * w[2]), widening = sine * d[2];
    const vf p = cone * w[0], q = cone * w[1] + field[ISO_FIELD_RAY_E2] * radius,
             discriminant = (p * p + q * q) - g * (side * side);
    const vm hit = v_le(v_set(0), discriminant);
    *s = v_set(0);
    *within = v_lt(*s, *s);
    if (!v_mask(hit)) return hit;
    const vf root = v_sqrt(v_max(g * discriminant, v_set(0)));
    const vf a = g * (d[0] * d[0] + d[1] * d[1]) - widening * widening,
             b = g * (k * (w[0] * d[0] + w[1] * d[1])) - radius * widening,
             c = g * (k * k * (w[0] * w[0] + w[1] * w[1])) - radius * radius;
    const vm back = v_lt(b, v_set(0)); /* -b - root would cancel */
    *s = v_select(back, c, -(b + root)) / v_select(back, root - b, a);
    *within = v_and(v_lt(a, v_set(0)), v_lt(widening, v_set(0)));
    return hit;
}

/* The first intersection with a rounded cone, without regard to flat caps. */
ISO_INLINE void meet_tube(const sp_pixel *p, const vf *field, bool tapered, sp_meeting *m) {
    const vf zero = v_set(0);
    const vf w[3] = {field[ISO_FIELD_E1X] * p->dx + field[ISO_FIELD_E1Y] * p->dy,
                     field[ISO_FIELD_E2X] * p->dx + field[ISO_FIELD_E2Y] * p->dy,
                     field[ISO_FIELD_AX] * p->dx + field[ISO_FIELD_AY] * p->dy};
    const vf d[3] = {p->slope * w[0], field[ISO_FIELD_RAY_E2] + p->slope * w[1],
                     field[ISO_FIELD_RAY_A] + p->slope * w[2]};
    const vf side = p->k * field[ISO_FIELD_RAY_E2] * w[0];
    vf top = field[ISO_FIELD_LENGTH], y;
    vm within = v_lt(zero, zero);
    if (tapered)
        m->hit = meet_cone(field, side, w, d, p->k, &m->s, &within);
    else
        m->hit = meet_cylinder(field[ISO_FIELD_R], side, w, d, p->k, &m->s);
    m->depth = field[ISO_FIELD_Z];
    m->place = m->along = zero;
    m->body = m->flat = m->last = v_lt(zero, zero);
    m->end = *p;
    m->end_radius = field[ISO_FIELD_R];
    if (!v_mask(m->hit)) return; /* the infinite cone holds both spheres: rays that miss it miss them */
    m->place = p->k * w[2] + m->s * d[2];
    m->along = y = m->place;
    if (tapered) {
        y = m->place + field[ISO_FIELD_R] * field[ISO_FIELD_SINE];
        m->along = y / field[ISO_FIELD_COSINE2];
        top = top * field[ISO_FIELD_COSINE2];
        const vf end = v_select(v_lt(zero, field[ISO_FIELD_SINE]), v_set(1e30f), v_set(-1e30f));
        y = v_select(within, end, y);
    }
    m->body = v_and(v_lt(zero, y), v_lt(y, top));
    m->depth = field[ISO_FIELD_Z] + m->s;
    const vm ends = v_andnot(m->hit, m->body);
    if (!v_mask(ends)) return;
    vf depth, s;
    const vm seen = meet_ends(p, field, tapered, ends, v_lt(zero, y), m, &depth, &s);
    const vf place =
        (m->end.k * (field[ISO_FIELD_AX] * m->end.dx + field[ISO_FIELD_AY] * m->end.dy) + s * d[2]) +
        v_select(m->last, field[ISO_FIELD_LENGTH], zero);
    m->hit = v_and(m->hit, v_or(m->body, seen));
    m->depth = v_select(m->body, m->depth, depth);
    m->s = v_select(m->body, m->s, s);
    m->place = v_select(m->body, m->place, place);
}

/* Cuts off what lies beyond the vertices with flat caps: the part of a rounded cone that remains is convex,
 * so a ray that enters it through the cap's plane does so inside the cap's disc. */
ISO_INLINE void cut_tube(const sp_pixel *p, const vf *field, vi flags, sp_meeting *m) {
    const vf zero = v_set(0), sine = field[ISO_FIELD_SINE], g = field[ISO_FIELD_COSINE2];
    const vm before =
                 v_and(v_eqi(flags & ISO_TUBE_CUT_FIRST, v_seti(ISO_TUBE_CUT_FIRST)), v_lt(m->place, zero)),
             beyond = v_and(v_eqi(flags & ISO_TUBE_CUT_LAST, v_seti(ISO_TUBE_CUT_LAST)),
                            v_lt(field[ISO_FIELD_LENGTH], m->place));
    const vm out = v_and(m->hit, v_or(before, beyond));
    if (!v_mask(out)) return;
    const vf w[3] = {field[ISO_FIELD_E1X] * p->dx + field[ISO_FIELD_E1Y] * p->dy,
                     field[ISO_FIELD_E2X] * p->dx + field[ISO_FIELD_E2Y] * p->dy,
                     field[ISO_FIELD_AX] * p->dx + field[ISO_FIELD_AY] * p->dy};
    const vf ahead = field[ISO_FIELD_RAY_A] + p->slope * w[2];
    const vf s = (v_select(beyond, field[ISO_FIELD_LENGTH], zero) - p->k * w[2]) / ahead;
    const vf x = p->k * w[0] + s * (p->slope * w[0]),
             y = p->k * w[1] + s * (field[ISO_FIELD_RAY_E2] + p->slope * w[1]);
    const vf r = v_select(beyond, field[ISO_FIELD_R1], field[ISO_FIELD_R]);
    const vm cone = v_lt(zero, v_select(beyond, -sine, sine)); /* the plane cuts the cone, not the sphere */
    const vm inside = v_and(v_le(x * x + y * y, v_select(cone, r * r / g, r * r)),
                            v_lt(zero, v_select(beyond, -ahead, ahead)));
    m->flat = v_and(out, inside);
    m->hit = v_andnot(m->hit, v_andnot(out, inside));
    m->depth = v_select(m->flat, field[ISO_FIELD_Z] + s, m->depth);
    m->place = v_select(m->flat, v_select(beyond, field[ISO_FIELD_LENGTH], zero), m->place);
    m->last = v_or(v_andnot(m->last, m->flat), v_and(m->flat, beyond));
}

/* The normal where a pixel sees the tube, and how far along the segment that is, 0 to 1. */
ISO_INLINE void tube_normal(const sp_pixel *p, const sp_place *at, const vf *field, vi flags, bool cut,
                            vf normal[3], vf *along) {
    const vf zero = v_set(0), one = v_set(1), length = field[ISO_FIELD_LENGTH];
    const vf az = field[ISO_FIELD_RAY_A] - at->u * field[ISO_FIELD_AX] - at->v * field[ISO_FIELD_AY];
    sp_meeting m = {
        .end = *p, .end_radius = field[ISO_FIELD_R], .last = v_lt(zero, zero), .body = v_lt(zero, one)};
    m.along = m.place = zero;
    meet_tube(p, field, true, &m);
    const sp_pixel base = choose_pixel(m.body, p, &m.end);
    const vf l = v_select(m.body, m.along, zero),
             scale = one / v_select(m.body, field[ISO_FIELD_R] + l * field[ISO_FIELD_SINE], m.end_radius);
    normal[0] = (base.k * base.dx + m.s * p->u - l * field[ISO_FIELD_AX]) * scale;
    normal[1] = (base.k * base.dy + m.s * p->v - l * field[ISO_FIELD_AY]) * scale;
    normal[2] = (m.s - l * az) * scale;
    if (cut) {
        cut_tube(p, field, flags, &m);
        const vf way = v_select(m.last, one, -one);
        normal[0] = v_select(m.flat, way * field[ISO_FIELD_AX], normal[0]);
        normal[1] = v_select(m.flat, way * field[ISO_FIELD_AY], normal[1]);
        normal[2] = v_select(m.flat, way * az, normal[2]);
    }
    /* a hit on the sphere at an end is at the vertex, so that the segments that share it agree */
    *along = v_select(v_andnot(m.body, m.flat), v_min(v_max(m.along / length, zero), one),
                      v_select(m.last, one, zero));
    *along = v_select(v_eqi(flags & ISO_TUBE_SECOND_ONLY, v_seti(ISO_TUBE_SECOND_ONLY)), one, *along);
}

#endif
