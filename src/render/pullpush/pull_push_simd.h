/* pull_push_simd: pull and push: the levels of the pyramid (Marroquim, Kraus and Cavalcanti 2008, sections
 * 3.1 and 3.2).
 *
 * Rows are processed a vector of coarser pixels at a time, that is two vectors of finer pixels. The
 * parameters `keys` and `sides` of the functions are constants for the compiler. */
#ifndef ISO_RENDER_PULLPUSH_PULL_PUSH_SIMD_H
#define ISO_RENDER_PULLPUSH_PULL_PUSH_SIMD_H

#include "render/pullpush/ellipses_simd.h"

/* ---- pull */

/* One of the four pixels that are averaged into a coarser one, for a vector of coarser ones. Indexed by
 * plane. */
typedef struct pp_child {
    vf value[ISO_PLANE_HIDDEN + 1];
    vf twice[2]; /* of several sets: the planes TWICE, */
    vf set;      /* and SET */
} pp_child;

/* Splits ISO_LANES keys into depths (ISO_NOWHERE where there is no point) and payloads. */
ISO_INLINE void split_keys(const int64_t *keys, vf *depth, vi *payload) {
    vf first = v_load((const float *)keys), second = v_load((const float *)keys + ISO_LANES);
    vi high = v_bits(v_odd(first, second));
    vm none = v_eqi(high, v_seti(INT32_MAX));
    high ^= high >> 31 & INT32_MAX;
    *depth = v_select(none, v_set(ISO_NOWHERE), v_floats(high));
    *payload = v_bits(v_even(first, second));
}

/* Normals from index to view space. */
ISO_INLINE void transform_normals(const iso_pullpush_params *params, const vf n[3], vf out[3]) {
    const float *m = params->normal;
    for (int k = 0; k < 3; k++) out[k] = m[3 * k] * n[0] + m[3 * k + 1] * n[1] + m[3 * k + 2] * n[2];
}

/* The plane of the lengths of depth intervals; NULL: all are the same. */
ISO_INLINE const float *interval_plane(const iso_pyramid_level *level) {
    const float *intervals = level->plane[ISO_PLANE_INTERVAL];
    return intervals ? intervals : level->plane[ISO_PLANE_RADIUS];
}

/* Decodes keys into the values of the planes. Normals stay in index space. */
ISO_INLINE void decode_keys(vf depth, vi payload, vf interval, pp_child *out) {
    unfold_normals(payload, out->value + ISO_PLANE_NX);
    out->value[ISO_PLANE_DEPTH] = out->value[ISO_PLANE_LOW] = depth;
    out->value[ISO_PLANE_HIGH] = depth + interval;
    /* keys have a point's place in its pixel in steps of 1/32: the middle of the step is taken */
    out->value[ISO_PLANE_DX] = v_to_float(payload >> 22 & 31) * (1.0f / 32) - 31.0f / 64;
    out->value[ISO_PLANE_DY] = v_to_float(payload >> 27 & 31) * (1.0f / 32) - 31.0f / 64;
    out->value[ISO_PLANE_HIDDEN] = v_set(0);
}

/* The ISO_LANES items of even (side 0) or odd (side 1) number of a row. */
ISO_INLINE vf every_second(const float *row, int side) {
    vf first = v_load(row), second = v_load(row + ISO_LANES);
    return side ? v_odd(first, second) : v_even(first, second);
}

/* The directions of line fragments in the picture, and the sets of pixels. */
ISO_INLINE void load_kinds(const iso_pyramid_level *level, int x, int y, int side, pp_child *out,
                           const pp_sides sides) {
    const size_t at = (size_t)y * level->stride + (size_t)x;
    if (sides != PP_SETS) return;
    for (int i = 0; i < 2; i++) out->twice[i] = every_second(level->plane[ISO_PLANE_TWICE_X + i] + at, side);
    out->set = every_second(level->plane[ISO_PLANE_SET] + at, side);
}

/* The pixels in row y and columns x, x + 2 .. (side 0) or x + 1, x + 3 .. (side 1), from keys. With
 * one side normals are in index space, and the caller transforms their average; otherwise in view space,
 * because they will be compared. */
ISO_INLINE void child_from_keys(const iso_pullpush_params *params, int x, int y, int side, pp_child *out,
                                const pp_sides sides) {
    const iso_pyramid *p = params->pyramid;
    const int64_t *row = p->keys + (size_t)y * p->key_stride + x;
    const float *radii = interval_plane(&p->level[0]);
    vf depth[2], radius = v_set(params->radius);
    vi payload[2];
    split_keys(row, &depth[0], &payload[0]);
    split_keys(row + ISO_LANES, &depth[1], &payload[1]);
    vf bits[2] = {v_floats(payload[0]), v_floats(payload[1])};
    if (radii) radius = every_second(radii + (size_t)y * p->level[0].stride + x, side);
    decode_keys(side ? v_odd(depth[0], depth[1]) : v_even(depth[0], depth[1]),
                v_bits(side ? v_odd(bits[0], bits[1]) : v_even(bits[0], bits[1])), radius, out);
    if (sides == PP_ONE) return;
    const vf n[3] = {out->value[ISO_PLANE_NX], out->value[ISO_PLANE_NY], out->value[ISO_PLANE_NZ]};
    transform_normals(params, n, out->value + ISO_PLANE_NX);
    load_kinds(&p->level[0], x, y, side, out, sides);
}

/* The same from the planes of a level. */
ISO_INLINE void child_from_level(const iso_pyramid_level *level, int x, int y, int side, pp_child *out,
                                 const pp_sides sides) {
    size_t at = (size_t)y * level->stride + (size_t)x;
    load_kinds(level, x, y, side, out, sides);
    for (int p = 0; p <= ISO_PLANE_HIDDEN; p++) out->value[p] = every_second(level->plane[p] + at, side);
}

/* Reverses normals where `away`. */
ISO_INLINE void turn_normal(vm away, vf normal[3]) {
    for (int i = 0; i < 3; i++) normal[i] = v_select(away, -normal[i], normal[i]);
}

/* Every second item of a level's plane `which`, or `same` where there is none. */
ISO_INLINE vf second_or(const iso_pyramid_level *level, const int which, size_t at, int side, float same) {
    return level->plane[which] ? every_second(level->plane[which] + at, side) : v_set(same);
}

/* Moves the depths of the children of a surface to the coarser pixel's centre, and returns which ellipses
 * contain it: the ellipse test of section 3.2. The ellipses are widened by half a coarser pixel: without
 * that, thin discs would be lost that pass beside the centre. `shrink`: pixels of level 0 to coarser
 * pixels. */
ISO_INLINE void test_children(const iso_pullpush_params *params, pp_child child[4], const vf radius[4],
                              float shrink, vm inside[4]) {
    for (int k = 0; k < 4; k++) {
        vf *value = child[k].value;
        const vf dx = (k & 1 ? -0.25f : 0.25f) - 0.5f * value[ISO_PLANE_DX],
                 dy = (k >> 1 ? -0.25f : 0.25f) - 0.5f * value[ISO_PLANE_DY];
        vf size = radius[k] * (params->scale * shrink);
        if (!params->orthographic) size = size / v_max(value[ISO_PLANE_DEPTH], v_set(1e-12f));
        const vf flat = value[0] * value[0] + value[1] * value[1],
                 square = v_max(flat + value[2] * value[2], v_set(1e-12f)), b = size * size,
                 a = b + (params->low_pass * shrink * shrink + 0.25f), e = a * square - b * flat;
        const vf out = dx * value[0] + dy * value[1];
        inside[k] = v_lt((dx * dx + dy * dy) * e + b * (out * out), a * e);
        const vf rise = radius[k] * v_sqrt(b / (a * e)) * out,
                 there = v_select(v_lt(value[2], v_set(0)), rise, -rise);
        value[ISO_PLANE_LOW] = v_select(v_lt(value[ISO_PLANE_LOW], v_set(ISO_NOWHERE)),
                                        value[ISO_PLANE_LOW] + there, value[ISO_PLANE_LOW]);
    }
}

/* Averages the children of a surface that are within the interval behind the frontmost one and whose normals
 * point to the same side as its (with one side they all do). Of those, if any ellipse contains the coarser
 * pixel's centre (`inside`, NULL: they are not tested), only those whose ellipse does. */
ISO_INLINE void join_children(const pp_child child[4], const vf interval[4], const vm *inside, vf share[4],
                              const pp_sides sides) {
    vf low = v_set(ISO_NOWHERE), limit = v_set(-ISO_NOWHERE), front[3] = {low, low, low};
    vm joins[4], any = v_from_mask(0);
    for (int k = 0; k < 4; k++) {
        const vf *value = child[k].value;
        const vm nearer = v_lt(value[ISO_PLANE_LOW], low);
        low = v_select(nearer, value[ISO_PLANE_LOW], low);
        limit = v_select(nearer, value[ISO_PLANE_LOW] + interval[k], limit);
        for (int i = 0; i < 3 && sides == PP_TWO; i++) front[i] = v_select(nearer, value[i], front[i]);
    }
    for (int k = 0; k < 4; k++) {
        const vf *value = child[k].value;
        joins[k] = v_le(value[ISO_PLANE_LOW], limit);
        if (sides == PP_TWO)
            joins[k] = v_and(joins[k],
                             v_le(v_set(0), front[0] * value[0] + front[1] * value[1] + front[2] * value[2]));
        if (inside) any = v_or(any, v_and(joins[k], inside[k]));
    }
    for (int k = 0; k < 4; k++) {
        if (inside) joins[k] = v_andnot(joins[k], v_andnot(any, inside[k]));
        share[k] = v_select(joins[k], v_set(1), v_set(0));
    }
}

/* The same for several sets: those of the frontmost's set whose depth intervals overlap its and, of surfaces,
 * of the same side. Of ribbons, those which are within 45 degrees of it in the picture, as other parts of the
 * same line are; their normals are turned to its side. Sets extent[0] and [1] to the interval that holds
 * theirs, *hidden to 1 where another surface lies behind, and *set to the frontmost's. */
ISO_INLINE void join_intervals(pp_child child[4], vf share[4], vf extent[2], vf *hidden, vf *set,
                               const pp_sides sides) {
    vf front[3] = {child[0].value[0], child[0].value[1], child[0].value[2]},
       twice[2] = {child[0].twice[0], child[0].twice[1]};
    if (sides == PP_SETS) *set = child[0].set;
    vf low = child[0].value[ISO_PLANE_LOW], limit = child[0].value[ISO_PLANE_HIGH];
    for (int k = 1; k < 4; k++) {
        vm nearer = v_lt(child[k].value[ISO_PLANE_LOW], low);
        low = v_select(nearer, child[k].value[ISO_PLANE_LOW], low);
        limit = v_select(nearer, child[k].value[ISO_PLANE_HIGH], limit);
        for (int i = 0; i < 3; i++) front[i] = v_select(nearer, child[k].value[i], front[i]);
        for (int i = 0; i < 2; i++) twice[i] = v_select(nearer, child[k].twice[i], twice[i]);
        if (sides == PP_SETS) *set = v_select(nearer, child[k].set, *set);
    }
    vf high = low;
    *hidden = v_set(0);
    for (int k = 0; k < 4; k++) {
        const vf *value = child[k].value;
        vm there = v_lt(value[ISO_PLANE_LOW], v_set(ISO_NOWHERE));
        vm joins = v_and(there, v_le(value[ISO_PLANE_LOW], limit));
        const vf same = front[0] * value[0] + front[1] * value[1] + front[2] * value[2];
        if (sides == PP_SETS) {
            there = v_and(there, v_eq(*set, child[k].set));
            joins = v_and(joins, v_and(there, v_or(v_le(v_set(0), same), are_ribbons(*set))));
        }
        const vf *other = child[k].twice;
        joins = v_and(joins, v_le(v_set(0), twice[0] * other[0] + twice[1] * other[1]));
        turn_normal(v_lt(same, v_set(0)), child[k].value);
        share[k] = v_select(joins, v_set(1), v_set(0));
        high = v_select(joins, v_max(high, value[ISO_PLANE_HIGH]), high);
        *hidden = v_select(joins, v_max(*hidden, value[ISO_PLANE_HIDDEN]), *hidden);
        *hidden = v_select(v_andnot(there, joins), v_set(1), *hidden);
    }
    extent[0] = low;
    extent[1] = high;
}

/* Averages the children with shares 1, of the others 0; then divides the shares by their number. */
ISO_INLINE void average_children(const pp_child child[4], vf out[ISO_PLANE_HIDDEN + 1], vf share[4]) {
    const vf count = share[0] + share[1] + (share[2] + share[3]);
    vf inverse = 1 / v_max(count, v_set(1));
    for (int k = 0; k < 4; k++) share[k] *= inverse;
#pragma GCC unroll 8
    for (int p = 0; p < ISO_PLANE_HIDDEN; p++) {
        if (p == ISO_PLANE_LOW || p == ISO_PLANE_HIGH) continue;
        out[p] = share[0] * child[0].value[p] + share[1] * child[1].value[p] +
                 (share[2] * child[2].value[p] + share[3] * child[3].value[p]);
    }
    /* a child's centre lies a quarter of a coarser pixel from the coarser pixel's centre, along each axis */
    vf right = share[1] + share[3], below = share[2] + share[3],
       all = v_select(v_lt(v_set(0), count), v_set(0.25f), v_set(0));
    out[ISO_PLANE_DX] = out[ISO_PLANE_DX] * 0.5f + (right * 0.5f - all);
    out[ISO_PLANE_DY] = out[ISO_PLANE_DY] * 0.5f + (below * 0.5f - all);
}

/* Averages four children into a coarser pixel of `level`; `at`: its index. share[k] is set to child k's
 * weight. HIGH is undefined of surfaces. */
ISO_INLINE void pull_children(const iso_pullpush_params *params, int level, size_t below, pp_child child[4],
                              vf out[ISO_PLANE_HIDDEN + 1], vf share[4], vf *set, const bool keys,
                              const pp_sides sides) {
    const iso_pyramid_level *from = &params->pyramid->level[level - 1];
    if (!is_surface(sides)) {
        vf extent[2], hidden;
        join_intervals(child, share, extent, &hidden, set, sides);
        average_children(child, out, share);
        out[ISO_PLANE_LOW] = extent[0];
        out[ISO_PLANE_HIGH] = extent[1];
        out[ISO_PLANE_HIDDEN] = hidden;
        return;
    }
    vf radius[4], interval[4];
    vm inside[4];
    for (int k = 0; k < 4; k++) {
        const size_t at = below + (size_t)(k >> 1) * from->stride;
        radius[k] = second_or(from, ISO_PLANE_RADIUS, at, k & 1, params->radius);
        interval[k] = radius[k];
        if (from->plane[ISO_PLANE_INTERVAL])
            interval[k] = every_second(from->plane[ISO_PLANE_INTERVAL] + at, k & 1);
    }
    if (!keys) test_children(params, child, radius, 1.0f / (float)(1 << level), inside);
    join_children(child, interval, keys ? NULL : inside, share, sides);
    average_children(child, out, share);
    out[ISO_PLANE_LOW] = v_select(v_lt(v_set(0), share[0] + share[1] + (share[2] + share[3])),
                                  out[ISO_PLANE_DEPTH], v_set(ISO_NOWHERE));
    out[ISO_PLANE_HIDDEN] = v_set(0);
}

/* Averages the optional planes, but for SET, with the same weights. */
ISO_INLINE void average_optional_planes(const iso_pyramid_level *to, int x, int y, const vf share[4]) {
    const iso_pyramid_level *from = to - 1;
    for (int p = ISO_PLANE_OPTIONAL; p < ISO_PLANES; p++) {
        if (!to->plane[p] || p == ISO_PLANE_SET) continue;
        const float *upper = from->plane[p] + (size_t)(2 * y) * from->stride + 2 * (size_t)x;
        const float *lower = upper + from->stride;
        v_store(to->plane[p] + (size_t)y * to->stride + x,
                share[0] * every_second(upper, 0) + share[1] * every_second(upper, 1) +
                    (share[2] * every_second(lower, 0) + share[3] * every_second(lower, 1)));
    }
}

/* Makes the ellipses of a vector of line fragments longer, to PP_REACH pixels of their level or as far as
 * the line goes on: such a pixel stands for a piece of the line about as long as itself, whose middle is the
 * ellipse's centre. Where that piece bends, by less. */
ISO_INLINE void stretch_shapes(const iso_pyramid_level *level, size_t at, float reach) {
    float *xx = level->plane[ISO_PLANE_SHAPE_XX] + at, *xy = level->plane[ISO_PLANE_SHAPE_XY] + at,
          *yy = level->plane[ISO_PLANE_SHAPE_YY] + at;
    const vf cosine = v_load(level->plane[ISO_PLANE_TWICE_X] + at),
             sine = v_load(level->plane[ISO_PLANE_TWICE_Y] + at),
             room = v_min(v_load(level->plane[ISO_PLANE_ROOM] + at), v_set(reach));
    const vf square = cosine * cosine + sine * sine, length = v_sqrt(v_max(square, v_set(1e-12f))),
             c = cosine / length, s = sine / length;
    const vf now = 0.5f * (v_load(xx) + v_load(yy) + c * (v_load(xx) - v_load(yy))) + s * v_load(xy),
             more = 0.5f * square * square * v_max(room * room - now, v_set(0));
    v_store(xx, v_load(xx) + more * (1 + c));
    v_store(xy, v_load(xy) + more * s);
    v_store(yy, v_load(yy) + more * (1 - c));
}

/* Whether any pixel of rows 2y and 2y + 1, in 2 ISO_LANES columns from 2x on, of the level below has a
 * point. */
ISO_INLINE bool has_points_below(const iso_pyramid *p, int level, int x, int y, const bool keys) {
    vf least = v_set(ISO_NOWHERE);
#pragma GCC unroll 4
    for (int k = 0; k < 4; k++) {
        int column = 2 * x + (k & 1) * ISO_LANES, row = 2 * y + (k >> 1);
        vf low;
        vi payload;
        if (keys)
            split_keys(p->keys + (size_t)row * p->key_stride + column, &low, &payload);
        else
            low = v_load(p->level[level - 1].plane[ISO_PLANE_LOW] + (size_t)row * p->level[level - 1].stride +
                         column);
        least = v_min(least, low);
    }
    return v_mask(v_lt(least, v_set(ISO_NOWHERE))) != 0;
}

/* Prefetches a vector of a row from each of the first `planes` planes: hardware prefetchers follow fewer rows
 * at a time. */
ISO_INLINE void prefetch_planes(const iso_pyramid_level *level, int x, int y, const int planes) {
    if (x >= level->width || y < 0 || y >= level->height) return;
    for (int p = 0; p < planes; p++)
        __builtin_prefetch(level->plane[p] + (size_t)y * level->stride + (size_t)x, 1, 2);
}

/* The flags `used` of the pieces of the pair of key rows that contains row y. */
ISO_INLINE uint8_t *used_pieces(const iso_pyramid *p, int y) {
    return p->used + (size_t)(y / 2) * (p->key_stride / ISO_KEY_PIECE);
}

/* Averages rows 2y and 2y + 1 of the level below (of the keys) into row y of `level`, and notes which
 * pieces of keys are used. In pixels without points only LOW is set; the other planes keep old values,
 * which are finite and are never used. */
ISO_INLINE void pull_row(const iso_pullpush_params *params, int level, int y, const bool keys,
                         const pp_sides sides) {
    const iso_pyramid_level *to = &params->pyramid->level[level];
    uint8_t *used = used_pieces(params->pyramid, 2 * y);
    if (keys) memset(used, 0, params->pyramid->key_stride / ISO_KEY_PIECE);
    for (int x = 0; x < to->width; x += ISO_LANES) {
        pp_child child[4];
        vf mean[ISO_PLANE_HIDDEN + 1], share[4], set;
        if (!has_points_below(params->pyramid, level, x, y, keys)) {
            v_store(to->plane[ISO_PLANE_LOW] + (size_t)y * to->stride + x, v_set(ISO_NOWHERE));
            continue;
        }
        if (keys) used[2 * x / ISO_KEY_PIECE] = 1;
        prefetch_planes(to, x, y + 1, ISO_PLANE_HIDDEN + 1);
#pragma GCC unroll 4
        for (int k = 0; k < 4; k++) {
            if (keys)
                child_from_keys(params, 2 * x, 2 * y + (k >> 1), k & 1, &child[k], sides);
            else
                child_from_level(to - 1, 2 * x, 2 * y + (k >> 1), k & 1, &child[k], sides);
        }
        pull_children(params, level, (size_t)(2 * y) * (to - 1)->stride + 2 * (size_t)x, child, mean, share,
                      &set, keys, sides);
        if (keys && sides == PP_ONE) {
            const vf normal[3] = {mean[ISO_PLANE_NX], mean[ISO_PLANE_NY], mean[ISO_PLANE_NZ]};
            transform_normals(params, normal, mean + ISO_PLANE_NX);
        }
        for (int p = 0; p <= ISO_PLANE_HIDDEN; p++)
            if (p != ISO_PLANE_HIGH || !is_surface(sides))
                v_store(to->plane[p] + (size_t)y * to->stride + x, mean[p]);
        average_optional_planes(to, x, y, share);
        if (sides == PP_SETS) v_store(to->plane[ISO_PLANE_SET] + (size_t)y * to->stride + x, set);
        if (to->plane[ISO_PLANE_ROOM])
            stretch_shapes(to, (size_t)y * to->stride + x, PP_REACH * (float)(1 << level));
    }
}

static void pull_rows(const iso_pullpush_params *params, int level, iso_rows rows) {
    const bool keys = level == 1 && params->pyramid->layout.base == 0;
    for (int y = rows.first; y <= rows.last; y++)
        if (keys)
            pull_row(params, level, y, true, PP_SIDES);
        else
            pull_row(params, level, y, false, PP_SIDES);
}

static void unpack_keys(const iso_pullpush_params *params, iso_rows rows) {
    const iso_pyramid *p = params->pyramid;
    const iso_pyramid_level *level = &p->level[p->layout.base];
    const float *intervals = interval_plane(level);
    for (int y = rows.first; y <= rows.last; y++) {
        uint8_t *used = used_pieces(p, y);
        if (y % 2 == 0) memset(used, 0, p->key_stride / ISO_KEY_PIECE);
        for (int x = 0; x < level->width; x += ISO_LANES) {
            size_t at = (size_t)y * level->stride + (size_t)x;
            pp_child made;
            vf depth, radius = v_set(params->radius);
            vi payload;
            split_keys(p->keys + (size_t)y * p->key_stride + x, &depth, &payload);
            if (intervals) radius = v_load(intervals + at);
            decode_keys(depth, payload, radius, &made);
            vf normal[3] = {made.value[ISO_PLANE_NX], made.value[ISO_PLANE_NY], made.value[ISO_PLANE_NZ]};
            transform_normals(params, normal, made.value + ISO_PLANE_NX);
            vm none = v_le(v_set(ISO_NOWHERE), depth);
            used[x / ISO_KEY_PIECE] |= v_mask(v_lt(depth, v_set(ISO_NOWHERE))) != 0;
            for (int k = 0; k <= ISO_PLANE_HIDDEN; k++) {
                vf empty = v_set(k == ISO_PLANE_LOW || k == ISO_PLANE_HIGH ? ISO_NOWHERE : 0);
                v_store(level->plane[k] + at, v_select(none, empty, made.value[k]));
            }
        }
    }
}

/* ---- push */

/* Push works on cells, so that coarser pixels are read once for four finer ones. A cell is the square between
 * the centres of four coarser pixels, its corners; it contains the centres of four finer pixels. Cell (x, y)
 * lies between columns x - 1 and x and rows y - 1 and y of the coarser level. Its corner k is in column
 * x - 1 + (k & 1) and row y - 1 + (k >> 1), its finer pixel s in column 2x - 1 + (s & 1) and row
 * 2y - 1 + (s >> 1). `at` is the index of coarser pixel (x, y) of the first cell of a vector. */

/* The offset d of both finer pixels of a cell along one axis from the centre of an ellipse: its square and
 * its part of the product d.THIN. `displacement` and `thin`: the planes DX and THIN_X or DY and THIN_Y at
 * the corner; k: the corner's number along the axis. */
ISO_INLINE void axis_offsets(const float *displacement, const float *thin, int k, vf square[2], vf along[2]) {
    for (int side = 0; side < 2; side++) {
        vf d = (side ? 0.25f : -0.25f) + (k ? -0.5f : 0.5f) - v_load(displacement);
        square[side] = d * d;
        along[side] = d * v_load(thin);
    }
}

/* Chooses which of the finer pixels that have a value of another set than the corners get a new value
 * (sets.h). In the last push all of them do, and complete_nearer chooses between the two values. Before it,
 * those whose own value lies behind the depth of the frontmost ellipse do: if that hides nearer points of
 * level 0, the last push brings them back. */
ISO_INLINE void choose_foreign(vf own, vf own_set, vf depth, bool last, pp_mix *mix) {
    const vm there = v_and(mix->covered, v_lt(own, v_set(ISO_NOWHERE)));
    mix->foreign = v_andnot(there, v_eq(own_set, mix->set));
    const vm behind = last ? mix->foreign : v_and(mix->foreign, v_lt(depth, own));
    mix->made = v_or(v_andnot(mix->made, mix->foreign), behind);
}

/* Computes the weights of the corners for each finer pixel. A pixel gets a new value when its own lies behind
 * the frontmost ellipse that contains its centre, by more than the interval; own values of another set, see
 * choose_foreign. In gaps between ellipses, see look_for_gaps. Returns whether any pixel does; if not,
 * weights are undefined. */
ISO_INLINE bool weigh_corners(const iso_pullpush_params *params, const pp_cells *cells, const pp_finer *own,
                              pp_mix mix[4], const pp_sides sides) {
    const iso_pyramid_level *c = cells->corners;
    const size_t at = cells->at;
    const bool surface = is_surface(sides), near = surface && are_near_border(params, cells);
    pp_ray ray[4];
    vf place[4][4]; /* of surfaces: the corners' depths at the finer pixels */
    if (near) make_cell_rays(params, cells, ray);
    vf depth[4]; /* of several sets: of the frontmost ellipses */
    vf least[4], limit[4], front[4][3], twice[4][2];
    const float *g = params->weight;
    for (int s = 0; s < 4; s++) {
        least[s] = front[s][0] = front[s][1] = front[s][2] = v_set(ISO_NOWHERE);
        limit[s] = v_set(-ISO_NOWHERE);
        twice[s][0] = twice[s][1] = v_set(0);
        if (sides == PP_SETS) mix[s].set = depth[s] = v_set(0);
    }
#pragma GCC unroll 1
    for (int k = 0; k < 4; k++) {
        const ptrdiff_t o = corner_index(c, at, k);
        vf square_x[2], square_y[2], along_x[2], along_y[2];
        axis_offsets(c->plane[ISO_PLANE_DX] + o, c->plane[ISO_PLANE_THIN_X] + o, k & 1, square_x, along_x);
        axis_offsets(c->plane[ISO_PLANE_DY] + o, c->plane[ISO_PLANE_THIN_Y] + o, k >> 1, square_y, along_y);
        const vf wide = v_load(c->plane[ISO_PLANE_WIDE] + o), out = v_load(c->plane[ISO_PLANE_OUT] + o);
        const vf low = v_load(c->plane[ISO_PLANE_LOW] + o);
        const vf rise = surface ? rise_of(params, c, o) : v_set(0),
                 interval = surface ? interval_of(params, c, o) : v_set(0);
#pragma GCC unroll 4
        for (int s = 0; s < 4; s++) {
            vf thin = along_x[s & 1] + along_y[s >> 1];
            vf q = (square_x[s & 1] + square_y[s >> 1]) * wide + thin * thin;
            vm inside = v_and(v_lt(q, v_set(1)), v_le(thin, out));
            vf z = surface ? low + rise * thin : low;
            if (near) inside = clip_to_grid(params, &ray[s], z, has_mark(c, o, ISO_OUT_BORDER), inside);
            place[s][k] = z;
            vm nearer = v_and(inside, v_lt(z, least[s]));
            least[s] = v_select(nearer, z, least[s]);
            limit[s] =
                v_select(nearer, surface ? z + interval : v_load(c->plane[ISO_PLANE_HIGH] + o), limit[s]);
            if (sides != PP_ONE)
                for (int i = 0; i < 3; i++)
                    front[s][i] = v_select(nearer, v_load(c->plane[ISO_PLANE_NX + i] + o), front[s][i]);
            if (sides == PP_SETS) {
                mix[s].set = v_select(nearer, v_load(c->plane[ISO_PLANE_SET] + o), mix[s].set);
                depth[s] = v_select(nearer, v_load(c->plane[ISO_PLANE_DEPTH] + o), depth[s]);
            }
            if (sides == PP_SETS) {
                mix[s].side[k] = v_set(1);
                for (int i = 0; i < 2; i++)
                    twice[s][i] = v_select(nearer, v_load(c->plane[ISO_PLANE_TWICE_X + i] + o), twice[s][i]);
            }
            mix[s].weight[k] = weigh(g, q, inside);
        }
    }
    uint32_t any = 0, uncovered = 0;
    for (int s = 0; s < 4; s++) {
        mix[s].weak = mix[s].around = v_from_mask(0);
        mix[s].covered = v_lt(least[s], v_set(ISO_NOWHERE));
        mix[s].made = v_andnot(mix[s].covered, v_le(own->low[s], limit[s]));
        if (sides == PP_SETS) choose_foreign(own->low[s], own->set[s], depth[s], own->last, &mix[s]);
        mix[s].sum = v_set(1);
        any |= v_mask(mix[s].made);
        uncovered |= v_mask(v_le(v_set(ISO_NOWHERE), least[s]));
    }
    if (any) {
#pragma GCC unroll 1
        for (int k = 0; k < 4; k++) {
            const ptrdiff_t o = corner_index(c, at, k);
#pragma GCC unroll 4
            for (int s = 0; s < 4; s++) {
                vm joins = v_and(mix[s].made, v_le(place[s][k], limit[s]));
                const vf same = front[s][0] * v_load(c->plane[ISO_PLANE_NX] + o) +
                                front[s][1] * v_load(c->plane[ISO_PLANE_NY] + o) +
                                front[s][2] * v_load(c->plane[ISO_PLANE_NZ] + o);
                if (sides == PP_TWO) joins = v_and(joins, v_le(v_set(0), same));
                if (sides == PP_SETS) {
                    joins = v_and(joins, v_eq(mix[s].set, v_load(c->plane[ISO_PLANE_SET] + o)));
                    joins = v_and(joins, v_or(v_le(v_set(0), same), are_ribbons(mix[s].set)));
                    const vf turn = twice[s][0] * v_load(c->plane[ISO_PLANE_TWICE_X] + o) +
                                    twice[s][1] * v_load(c->plane[ISO_PLANE_TWICE_Y] + o);
                    joins = v_and(joins, v_le(v_set(0), turn));
                    mix[s].side[k] = v_select(v_lt(same, v_set(0)), v_set(-1), v_set(1));
                }
                mix[s].weight[k] = v_select(joins, mix[s].weight[k], v_set(0));
            }
        }
        for (int s = 0; s < 4; s++) {
            const vf *w = mix[s].weight;
            mix[s].sum = v_select(mix[s].made, w[0] + w[1] + (w[2] + w[3]), v_set(1));
        }
    }
    if (!surface || !uncovered) return any;
    return look_for_gaps(params, cells, own->low, near ? ray : NULL, mix, sides) || any;
}

/* Computes the weighted sums of a plane over the corners, for each of the four finer pixels. */
ISO_INLINE void mix_plane(const iso_pyramid_level *c, const int plane, size_t at, const pp_mix mix[4],
                          vf out[4]) {
    vf from[4];
    for (int k = 0; k < 4; k++) from[k] = v_load(c->plane[plane] + corner_index(c, at, k));
#pragma GCC unroll 4
    for (int s = 0; s < 4; s++) {
        const vf *w = mix[s].weight;
        out[s] = w[0] * from[0] + w[1] * from[1] + (w[2] * from[2] + w[3] * from[3]);
    }
}

/* The same for a plane of normals. */
ISO_INLINE void mix_normals(const iso_pyramid_level *c, const int plane, size_t at, const pp_mix mix[4],
                            vf out[4], const pp_sides sides) {
    if (sides != PP_SETS) {
        mix_plane(c, plane, at, mix, out);
        return;
    }
    for (int s = 0; s < 4; s++) out[s] = v_set(0);
    for (int k = 0; k < 4; k++) {
        const vf from = v_load(c->plane[plane] + corner_index(c, at, k));
        for (int s = 0; s < 4; s++) out[s] += mix[s].weight[k] * mix[s].side[k] * from;
    }
}

/* The same for DX and DY: offsets from the finer pixels' centres to the ellipses' centres, in finer
 * pixels. */
ISO_INLINE void mix_offsets(const iso_pyramid_level *c, const int plane, size_t at, const pp_mix mix[4],
                            vf out[4]) {
    mix_plane(c, plane, at, mix, out);
#pragma GCC unroll 4
    for (int s = 0; s < 4; s++) {
        const vf *w = mix[s].weight;
        /* weighted offset from the coarser pixels' centres to the finer pixel's, in coarser pixels */
        vf centres =
            plane == ISO_PLANE_DX
                ? (w[0] + w[2]) * (s & 1 ? 0.75f : 0.25f) - (w[1] + w[3]) * (s & 1 ? 0.25f : 0.75f)
                : (w[0] + w[1]) * (s >> 1 ? 0.75f : 0.25f) - (w[2] + w[3]) * (s >> 1 ? 0.25f : 0.75f);
        out[s] = (out[s] - centres) * 2;
    }
}

/* What the corners that are mixed have in common: the depth interval that holds theirs, and whether one of
 * them is HIDDEN (1 or 0). */
typedef struct pp_extent {
    vf low[4], high[4], hidden[4];
} pp_extent;

ISO_INLINE void mix_extents(const iso_pyramid_level *c, size_t at, const pp_mix mix[4], pp_extent *out) {
    for (int s = 0; s < 4; s++) {
        out->low[s] = v_set(ISO_NOWHERE);
        out->high[s] = v_set(-ISO_NOWHERE);
        out->hidden[s] = v_set(0);
    }
#pragma GCC unroll 4
    for (int k = 0; k < 4; k++) {
        const ptrdiff_t o = corner_index(c, at, k);
        const vf low = v_load(c->plane[ISO_PLANE_LOW] + o), high = v_load(c->plane[ISO_PLANE_HIGH] + o);
        const vm hides = v_eqi(v_bits(v_load(c->plane[ISO_PLANE_OUT] + o)) & 1, v_seti(1));
#pragma GCC unroll 4
        for (int s = 0; s < 4; s++) {
            vm joins = v_lt(v_set(0), mix[s].weight[k]);
            out->low[s] = v_select(joins, v_min(out->low[s], low), out->low[s]);
            out->high[s] = v_select(joins, v_max(out->high[s], high), out->high[s]);
            out->hidden[s] = v_select(v_and(joins, hides), v_set(1), out->hidden[s]);
        }
    }
}

/* Whether any corner of a vector of cells has a point. */
ISO_INLINE bool has_points_around(const iso_pyramid_level *c, size_t at) {
    vf least = v_set(ISO_NOWHERE);
    for (int k = 0; k < 4; k++)
        least = v_min(least, v_load(c->plane[ISO_PLANE_LOW] + corner_index(c, at, k)));
    return v_mask(v_lt(least, v_set(ISO_NOWHERE))) != 0;
}

/* The finer pixels' own values; `at`: index of the first finer pixel. */
ISO_INLINE void read_own_values(const iso_pyramid_level *level, size_t at, pp_finer *own,
                                const pp_sides sides) {
    for (int s = 0; s < 4; s++) {
        const size_t row = at + (size_t)(s >> 1) * level->stride;
        own->low[s] = every_second(level->plane[ISO_PLANE_LOW] + row, s & 1);
        if (sides == PP_SETS) own->set[s] = every_second(level->plane[ISO_PLANE_SET] + row, s & 1);
    }
}

/* Masks for writing a row of finer pixels, two vectors: which got a new value, and which lie in the level. */
typedef struct pp_row_masks {
    vm made[2], within[2];
} pp_row_masks;

/* The masks of a row that begins in column `first`; `even` and `odd`: which left and right finer pixels of
 * the cells got a new value. */
ISO_INLINE pp_row_masks make_row_masks(vm even, vm odd, int first, int width) {
    const vf one = v_set(1), none = v_set(0);
    vf left = v_select(even, one, none), right = v_select(odd, one, none);
    pp_row_masks place;
    for (int end = 0; end < 2; end++) {
        vi column = v_lanes() + (first + end * ISO_LANES);
        place.within[end] = v_andnot(v_lti(column, v_seti(width)), v_lti(column, v_seti(0)));
        vf made = end ? v_zip_high(left, right) : v_zip_low(left, right);
        place.made[end] = v_and(place.within[end], v_lt(none, made));
    }
    return place;
}

/* Writes the new values of a row. Other pixels keep their values, or without `over` are set to `empty`. */
ISO_INLINE void store_row(float *row, const pp_row_masks *place, vf even, vf odd, float empty,
                          const bool over) {
    for (int end = 0; end < 2; end++, row += ISO_LANES) {
        vf there = v_load(row), value = end ? v_zip_high(even, odd) : v_zip_low(even, odd);
        if (!over) there = v_select(place->within[end], v_set(empty), there);
        v_store(row, v_select(place->made[end], value, there));
    }
}

/* Computes the weighted means of a plane over the corners; `inverse` is 1 / the sum of the weights. */
ISO_INLINE void mix_mean(const iso_pyramid_level *c, const int plane, size_t at, const pp_mix mix[4],
                         const vf inverse[4], vf out[4], const pp_sides sides) {
    if (plane == ISO_PLANE_DX || plane == ISO_PLANE_DY)
        mix_offsets(c, plane, at, mix, out);
    else if (plane <= ISO_PLANE_NZ)
        mix_normals(c, plane, at, mix, out, sides);
    else
        mix_plane(c, plane, at, mix, out);
    for (int s = 0; s < 4; s++) out[s] = inverse[s] * out[s];
}

/* Fills the finer pixels of a vector of cells. `over`: the finer level has values of its own, from pull. */
ISO_INLINE void push_cells(const iso_pullpush_params *params, int level, int x, int y, const bool over,
                           const pp_sides sides) {
    const iso_pyramid_level *c = &params->pyramid->level[level], *to = c - 1;
    const size_t at = (size_t)y * c->stride + (size_t)x;
    const size_t there = (size_t)(2 * y - 1) * to->stride + (size_t)(2 * x - 1);
    const bool in_level[2] = {y > 0, 2 * y < to->height};
    const vf nowhere = v_set(ISO_NOWHERE);
    pp_finer own = {.low = {nowhere, nowhere, nowhere, nowhere}};
    pp_mix mix[4];
    pp_extent extent;
    if (over) read_own_values(to, there, &own, sides);
    const pp_cells cells = {c, level, at, x, y};
    bool any = weigh_corners(params, &cells, &own, mix, sides);
    if (over && !any) return;
    const pp_row_masks place[2] = {
        make_row_masks(mix[0].made, mix[1].made, 2 * x - 1, to->width),
        make_row_masks(mix[2].made, mix[3].made, 2 * x - 1, to->width),
    };
    vf inverse[4];
    if (!is_surface(sides)) mix_extents(c, at, mix, &extent);
    for (int i = 0; i < 4; i++) inverse[i] = 1 / mix[i].sum;
#pragma GCC unroll 1
    for (int p = 0; p < ISO_PLANES; p++) {
        if (p > ISO_PLANE_HIDDEN && p <= ISO_PLANE_OUT) continue;
        if (p >= ISO_PLANE_OPTIONAL && !to->plane[p]) continue;
        vf mean[4];
        const vf *value = mean;
        if (is_surface(sides)) {
            if (p == ISO_PLANE_HIGH) continue;
            if (p == ISO_PLANE_HIDDEN)
                for (int s = 0; s < 4; s++) mean[s] = v_select(mix[s].weak, v_set(1), v_set(0));
            else
                mix_mean(c, p, at, mix, inverse, mean, sides);
        } else if (p == ISO_PLANE_LOW)
            value = extent.low;
        else if (p == ISO_PLANE_HIGH)
            value = extent.high;
        else if (p == ISO_PLANE_HIDDEN)
            value = extent.hidden;
        else if (p == ISO_PLANE_SET && sides == PP_SETS)
            for (int s = 0; s < 4; s++) mean[s] = mix[s].set;
        else
            mix_mean(c, p, at, mix, inverse, mean, sides);
        float empty = p == ISO_PLANE_LOW || p == ISO_PLANE_HIGH ? ISO_NOWHERE : 0;
        for (int row = 0; row < 2; row++)
            if (in_level[row])
                store_row(to->plane[p] + there + (size_t)row * to->stride, &place[row], value[2 * row],
                          value[2 * row + 1], empty, over);
    }
}

/* Fills the finer pixels of row y of cells. */
ISO_INLINE void push_row(const iso_pullpush_params *params, int level, int y, const bool over,
                         const pp_sides sides) {
    const iso_pyramid_level *c = &params->pyramid->level[level];
    for (int x = 0; x <= (c - 1)->width / 2; x += ISO_LANES) {
        if (over && !has_points_around(c, (size_t)y * c->stride + (size_t)x)) continue;
        prefetch_planes(c, x, y + 1, ISO_PLANE_OUT + 1);
        for (int i = 0; i < 2; i++) {
            prefetch_planes(c - 1, 2 * x + i * ISO_LANES, 2 * y + 1, ISO_PLANE_OUT + 1);
            prefetch_planes(c - 1, 2 * x + i * ISO_LANES, 2 * y + 2, ISO_PLANE_OUT + 1);
        }
        push_cells(params, level, x, y, over, sides);
    }
}

static void push_rows(const iso_pullpush_params *params, int level, iso_rows rows) {
    const iso_pyramid_level *to = &params->pyramid->level[level - 1];
    const bool over = level - 1 >= params->pyramid->layout.base;
    for (int y = rows.first; y <= rows.last; y++) push_row(params, level, y, over, PP_SIDES);
    int first = 2 * rows.first - 1, last = 2 * rows.last;
    make_ellipses(params, level - 1,
                  (iso_rows){first < 0 ? 0 : first, last < to->height ? last : to->height - 1});
}

#endif
