/* line_block_simd: prepares the segments of a block, tubes or ribbons, for drawing. */
#ifndef ISO_RENDER_SHAPES_LINE_BLOCK_SIMD_H
#define ISO_RENDER_SHAPES_LINE_BLOCK_SIMD_H

#include "render/shapes/sphere_block_simd.h"

/* A vertex in the picture. */
typedef struct sp_end {
    vf z, x, y, u, v, radius; /* x, y: pixels relative to the origin's pixel */
    vm widened;
    sp_reach reach;
} sp_end;

ISO_INLINE sp_end end_of(const iso_shapes_frame *frame, const iso_shapes_origin *o, const vf offset[3],
                         vf radius) {
    sp_end e;
    e.z = o->depth + (offset[2] + o->rest);
    const vf scale = frame->parallel ? v_set(frame->length) : frame->length / e.z;
    const vf least = e.z * (float)frame->least_slope + (float)frame->least_fixed;
    e.widened = v_lt(radius, least);
    e.radius = v_select(e.widened, least, radius);
    e.x = o->x + (offset[0] - o->u * offset[2]) * scale;
    e.y = o->y + (offset[1] - o->v * offset[2]) * scale;
    e.u = o->u + (e.x - o->x) * frame->slope;
    e.v = o->v + (e.y - o->y) * frame->slope;
    sphere_reach(frame, e.u, e.z, e.radius, &e.reach.x0, &e.reach.x1);
    sphere_reach(frame, e.v, e.z, e.radius, &e.reach.y0, &e.reach.y1);
    e.reach = (sp_reach){e.x + e.reach.x0, e.y + e.reach.y0, e.x + e.reach.x1, e.y + e.reach.y1};
    return e;
}

ISO_INLINE sp_end choose_end(vm mask, const sp_end *a, const sp_end *b) {
    sp_end e = *b;
    e.z = v_select(mask, a->z, b->z);
    e.x = v_select(mask, a->x, b->x);
    e.y = v_select(mask, a->y, b->y);
    e.u = v_select(mask, a->u, b->u);
    e.v = v_select(mask, a->v, b->v);
    e.radius = v_select(mask, a->radius, b->radius);
    return e;
}

/* Sets E1 perpendicular to the axis and to the ray of the first vertex, and E2; returns the ray's component
 * along E2, which is the length of its cross product with the axis. */
ISO_INLINE vf make_frame(const vf axis[3], vf u, vf v, vf e1[3], vf e2[3]) {
    const vf zero = v_set(0), one = v_set(1);
    const vf cross[3] = {v * axis[2] - axis[1], axis[0] - u * axis[2], u * axis[1] - v * axis[0]};
    const vf size = v_sqrt(cross[0] * cross[0] + cross[1] * cross[1] + cross[2] * cross[2]);
    const vm along = v_lt(size, v_set(1e-6f)), flat = v_lt(v_abs(axis[0]), v_set(0.8f));
    const vf other[3] = {v_select(flat, zero, axis[2]), v_select(flat, -axis[2], zero),
                         v_select(flat, axis[1], -axis[0])}; /* perpendicular to the axis */
    for (int a = 0; a < 3; a++) e1[a] = v_select(along, other[a], cross[a]);
    vf scale = one / v_sqrt(e1[0] * e1[0] + e1[1] * e1[1] + e1[2] * e1[2]);
    for (int a = 0; a < 3; a++) e1[a] *= scale;
    /* Where the ray runs nearly along the axis, rounding has tilted E1: make it perpendicular again. */
    const vf tilt = e1[0] * axis[0] + e1[1] * axis[1] + e1[2] * axis[2];
    for (int a = 0; a < 3; a++) e1[a] -= tilt * axis[a];
    e2[0] = axis[1] * e1[2] - axis[2] * e1[1];
    e2[1] = axis[2] * e1[0] - axis[0] * e1[2];
    e2[2] = axis[0] * e1[1] - axis[1] * e1[0];
    return v_select(along, u * e2[0] + v * e2[1] + e2[2], size);
}

/* Computes the fields of tubes, from ISO_FIELD_Z on. path: the vector from vertex a to vertex b. */
ISO_INLINE void tube_fields(const iso_shapes_frame *frame, const sp_end *a, const sp_end *b, const vf path[3],
                            vf fields[ISO_TUBE_FIELDS - ISO_FIELD_Z]) {
    const vf zero = v_set(0), one = v_set(1);
    const vf length = v_sqrt(path[0] * path[0] + path[1] * path[1] + path[2] * path[2]);
    const vm point = v_le(length, zero);
    const vf scale = one / v_select(point, one, length);
    const vf axis[3] = {v_select(point, one, path[0] * scale), path[1] * scale, path[2] * scale};
    const vf sine = v_select(point, zero, (b->radius - a->radius) * scale),
             ray = a->u * axis[0] + a->v * axis[1] + axis[2];
    const vf k = a->z * frame->slope + frame->fixed;
    vf e1[3], e2[3];
    const vf across = make_frame(axis, a->u, a->v, e1, e2);
    const vf made[ISO_TUBE_FIELDS - ISO_FIELD_Z] = {a->z,
                                                    a->radius,
                                                    b->z,
                                                    b->x - a->x,
                                                    b->y - a->y,
                                                    b->radius,
                                                    e1[0],
                                                    e1[1],
                                                    e2[0],
                                                    e2[1],
                                                    axis[0],
                                                    axis[1],
                                                    across,
                                                    ray,
                                                    length,
                                                    sine,
                                                    (one - sine) * (one + sine),
                                                    a->radius * frame->slope - sine * (k * ray)};
    for (int i = 0; i < ISO_TUBE_FIELDS - ISO_FIELD_Z; i++) fields[i] = made[i];
}

/* A vector of segments in view space. */
typedef struct sp_segments {
    vf offset[3], path[3];      /* from the block's origin to the first vertex; from there to the second */
    vf radius[2], across[2][3]; /* at both vertices; across: of ribbons, from the line to an edge */
    vi id, flags;
    vm wanted;
} sp_segments;

/* A vector of segments in the picture. */
typedef struct sp_seen {
    sp_end a, b;
    vf nearest;
    vi to[4]; /* their boxes */
    vm wanted;
} sp_seen;

/* Stores a vector in the form that the fields of ribbons have (ribbon_simd.h). */
ISO_INLINE void store_skewed(const sp_end *a, const vf v[3], vf scale, vf to[3]) {
    to[0] = scale * (v[0] - a->u * v[2]);
    to[1] = scale * (v[1] - a->v * v[2]);
    to[2] = scale * v[2];
}

ISO_INLINE void add_ribbons(iso_shapes_bin *bin, const iso_shapes_origin *o, const sp_segments *s,
                            const sp_seen *seen) {
    vf fields[ISO_RIBBON_FIELDS - ISO_FIELD_Z];
    const sp_end *a = &seen->a, *b = &seen->b;
    fields[0] = a->z;
    store_skewed(a, s->path, v_set(1), fields + ISO_FIELD_PATH - ISO_FIELD_Z);
    store_skewed(a, s->across[0], a->radius, fields + ISO_FIELD_FIRST_EDGE - ISO_FIELD_Z);
    store_skewed(a, s->across[1], b->radius, fields + ISO_FIELD_LAST_EDGE - ISO_FIELD_Z);
    const vi flags = v_selecti(v_or(a->widened, b->widened), v_seti(ISO_TUBE_WIDENED), v_seti(0));
    add_shapes(bin, o, seen->wanted, seen->to, a->x, a->y, s->id, flags, seen->nearest, fields,
               ISO_RIBBON_FIELDS - ISO_FIELD_Z);
}

ISO_INLINE void add_tubes(iso_shapes_bin *bin, const iso_shapes_origin *o, const sp_segments *s,
                          const sp_seen *seen) {
    sp_end a = seen->a, b = seen->b;
    /* Where one sphere holds the other, the larger is drawn alone. */
    const vf taper = b.radius - a.radius, *p = s->path;
    const vm holds = v_le(p[0] * p[0] + p[1] * p[1] + p[2] * p[2], taper * taper),
             second = v_and(holds, v_lt(v_set(0), taper)), first = v_andnot(holds, second);
    const vi widened = v_selecti(v_or(a.widened, b.widened), v_seti(ISO_TUBE_WIDENED), v_seti(0));
    vi flags = v_selecti(holds, v_seti(0), s->flags) | widened;
    flags = v_selecti(second, flags | ISO_TUBE_SECOND_ONLY, flags);
    vf path[3], fields[ISO_TUBE_FIELDS - ISO_FIELD_Z];
    for (int i = 0; i < 3; i++) path[i] = v_select(holds, v_set(0), p[i]);
    a = choose_end(second, &b, &a);
    b = choose_end(first, &a, &b);
    tube_fields(bin->frame, &a, &b, path, fields);
    add_shapes(bin, o, seen->wanted, seen->to, a.x, a.y, s->id, flags, seen->nearest, fields,
               ISO_TUBE_FIELDS - ISO_FIELD_Z);
}

ISO_INLINE void add_segments(iso_shapes_bin *bin, const iso_shapes_origin *o, const sp_segments *s,
                             iso_shape_kind kind) {
    const iso_shapes_frame *frame = bin->frame;
    const vf there[3] = {s->offset[0] + s->path[0], s->offset[1] + s->path[1], s->offset[2] + s->path[2]};
    sp_seen seen = {.a = end_of(frame, o, s->offset, s->radius[0]),
                    .b = end_of(frame, o, there, s->radius[1])};
    const sp_end *a = &seen.a, *b = &seen.b;
    const sp_reach r = {v_min(a->reach.x0, b->reach.x0), v_min(a->reach.y0, b->reach.y0),
                        v_max(a->reach.x1, b->reach.x1), v_max(a->reach.y1, b->reach.y1)};
    seen.nearest = v_min(sphere_nearest(a->z, a->radius), sphere_nearest(b->z, b->radius));
    seen.wanted = v_and(s->wanted, v_lt(v_set(0), v_max(a->radius, b->radius)));
    seen.wanted = clip(bin, o, seen.wanted, &r, seen.nearest, seen.to);
    if (!v_mask(seen.wanted)) return;
    if (kind == ISO_SHAPE_RIBBON)
        add_ribbons(bin, o, s, &seen);
    else
        add_tubes(bin, o, s, &seen);
}

/* Adds one segment with its own origin, or draws it in double precision. */
static void add_segment_apart(iso_shapes_bin *bin, uint32_t id, int flags, iso_shape_kind kind) {
    const iso_shapes_frame *frame = bin->frame;
    iso_near_shape shape = iso_near_segment(frame, id, flags);
    const double reach = shape.radius[0] > shape.radius[1] ? shape.radius[0] : shape.radius[1],
                 *a = shape.end[0], *b = shape.end[1];
    if (a[2] + shape.radius[0] < frame->near && b[2] + shape.radius[1] < frame->near) return;
    iso_shapes_origin o;
    if (!iso_near_fits(frame, (a[2] < b[2] ? a[2] : b[2]) - reach, reach) ||
        !iso_shapes_origin_of(frame, a, &o)) {
        iso_near_draw(bin, &shape);
        return;
    }
    const float *va = frame->shapes->vertices[id], *vb = va + 4, *m = frame->turn;
    sp_segments s = {.radius = {v_set(va[3]), v_set(vb[3])},
                     .id = v_seti((int32_t)id),
                     .flags = v_seti(flags),
                     .wanted = v_from_mask(1)};
    const float step[3] = {vb[0] - va[0], vb[1] - va[1], vb[2] - va[2]};
    for (int i = 0; i < 3; i++) {
        s.offset[i] = v_set(0);
        s.path[i] = v_set(m[3 * i] * step[0] + m[3 * i + 1] * step[1] + m[3 * i + 2] * step[2]);
        for (int end = 0; end < 2; end++) s.across[end][i] = v_set((float)shape.across[end][i]);
    }
    add_segments(bin, &o, &s, kind);
}

/* Loads the vectors from a ribbon's line to its edge at both vertices. */
ISO_INLINE void load_across(const iso_shapes_frame *frame, sp_segments *s) {
    const float *m = frame->turn;
    int32_t id[ISO_LANES];
    v_storei(id, s->id);
    for (int end = 0; end < 2; end++) {
        float across[3][ISO_LANES], one[3];
        for (int lane = 0; lane < ISO_LANES; lane++) {
            iso_shapes_across(frame->shapes, (size_t)(id[lane] + end), one);
            for (int i = 0; i < 3; i++) across[i][lane] = one[i];
        }
        const vf v[3] = {v_load(across[0]), v_load(across[1]), v_load(across[2])};
        for (int i = 0; i < 3; i++)
            s->across[end][i] = m[3 * i] * v[0] + m[3 * i + 1] * v[1] + m[3 * i + 2] * v[2];
    }
}

ISO_INLINE void load_segments(const iso_shapes_frame *frame, const float *from, const int32_t *ids,
                              const int32_t *flags, sp_segments *s) {
    const float *m = frame->turn;
    int32_t index[ISO_LANES];
    vf a[4], b[4];
    s->id = v_loadi(ids);
    s->flags = v_loadi(flags);
    v_storei(index, s->id * 4);
    v_load4(frame->shapes->vertices[0], index, 1, a);
    v_load4(frame->shapes->vertices[1], index, 1, b);
    for (int i = 0; i < 3; i++) {
        s->offset[i] =
            m[3 * i] * (a[0] - from[0]) + m[3 * i + 1] * (a[1] - from[1]) + m[3 * i + 2] * (a[2] - from[2]);
        s->path[i] = m[3 * i] * (b[0] - a[0]) + m[3 * i + 1] * (b[1] - a[1]) + m[3 * i + 2] * (b[2] - a[2]);
    }
    s->radius[0] = a[3];
    s->radius[1] = b[3];
}

ISO_INLINE void add_line_block(iso_shapes_bin *bin, const iso_shapes_seen *seen, iso_shape_kind kind) {
    const iso_shapes *set = bin->frame->shapes;
    const iso_shapes_block *block = &set->blocks[seen->block];
    int32_t ids[ISO_SHAPES_CHUNK], flags[ISO_SHAPES_CHUNK];
    const int count = iso_shapes_list_segments(set, block, ids, flags);
    for (int i = count; i < count + ISO_LANES; i++) ids[i] = count ? ids[0] : 0, flags[i] = 0;
    iso_shapes_origin o;
    if (seen->apart || !iso_shapes_origin_of(bin->frame, seen->centre, &o)) {
        for (int i = 0; i < count; i++) add_segment_apart(bin, (uint32_t)ids[i], flags[i], kind);
        return;
    }
    for (int i = 0; i < count; i += ISO_LANES) {
        sp_segments s;
        load_segments(bin->frame, block->origin, ids + i, flags + i, &s);
        s.wanted = v_from_mask(count - i < ISO_LANES ? (1u << (count - i)) - 1 : (uint32_t)-1);
        if (kind == ISO_SHAPE_RIBBON) load_across(bin->frame, &s);
        add_segments(bin, &o, &s, kind);
    }
}

#endif
