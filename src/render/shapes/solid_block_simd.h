/* solid_block_simd: prepares the glyphs of a block, other than spheres, for drawing.
 *
 * Cones, cylinders, arrows and discs have maps with perpendicular axes, which are made here for a vector of
 * glyphs at a time, relative to the block's origin. All others are placed one by one in double precision
 * (solid.c): ellipsoids and boxes, but only those that may be seen by the block's reach, billboards, and
 * glyphs for which floats are too coarse. */
#ifndef ISO_RENDER_SHAPES_SOLID_BLOCK_SIMD_H
#define ISO_RENDER_SHAPES_SOLID_BLOCK_SIMD_H

#include "render/shapes/sphere_block_simd.h"

/* Maps of unit solids (solid.h) in view space: centres relative to the block's origin, images of the unit
 * vectors, and the rows of the maps' inverses. */
typedef struct sp_map {
    vf centre[3], axis[3][3], inverse[3][3], reach;
} sp_map;

ISO_INLINE vf dot(const vf a[3], const vf b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

ISO_INLINE void turn(const iso_shapes_frame *frame, const vf world[3], vf view[3]) {
    const float *m = frame->turn;
    for (int a = 0; a < 3; a++)
        view[a] = m[3 * a] * world[0] + m[3 * a + 1] * world[1] + m[3 * a + 2] * world[2];
}

/* Two unit vectors that are perpendicular to `along`, of the given length, and to each other. */
ISO_INLINE void axes_across(const vf along[3], vf length, vf first[3], vf second[3]) {
    const vf x = v_abs(along[0]), y = v_abs(along[1]), z = v_abs(along[2]), zero = v_set(0);
    /* `along` x the unit vector of its least component */
    const vm is_x = v_and(v_le(x, y), v_le(x, z)), is_y = v_le(y, z);
    const vf a[3] = {v_select(is_y, -along[2], along[1]), v_select(is_y, zero, -along[0]),
                     v_select(is_y, along[0], zero)};
    first[0] = v_select(is_x, zero, a[0]);
    first[1] = v_select(is_x, along[2], a[1]);
    first[2] = v_select(is_x, -along[1], a[2]);
    const vf scale = 1.0f / v_sqrt(dot(first, first)), inverse = 1.0f / length;
    for (int i = 0; i < 3; i++) first[i] *= scale;
    second[0] = (along[1] * first[2] - along[2] * first[1]) * inverse;
    second[1] = (along[2] * first[0] - along[0] * first[2]) * inverse;
    second[2] = (along[0] * first[1] - along[1] * first[0]) * inverse;
}

ISO_INLINE vf solid_radii(const iso_shapes *set, vi id, vf length) {
    if (set->radii) return v_gather(set->radii, id) * (float)set->scale;
    if (set->radius > 0) return v_set((float)(set->radius * set->scale));
    return length * (float)iso_solid_radius_ratio(set->glyph);
}

/* Makes the maps of glyphs along directions. offset: from the block's origin to the glyphs' positions; along:
 * vectors in their directions, of the given length. */
ISO_INLINE void map_along(const iso_shapes *set, vi id, const vf offset[3], const vf along[3], vf length,
                          sp_map *m) {
    const bool disc = set->glyph == ISO_GLYPH_DISC;
    const vf radius = solid_radii(set, id, length), narrow = 1.0f / radius;
    const vf part = disc ? radius / length : v_set(0.5f); /* the third axis is `along` times this */
    vf across[2][3];
    axes_across(along, length, across[0], across[1]);
    const vf square = dot(along, along) * part;
    for (int a = 0; a < 3; a++) {
        m->centre[a] = disc ? offset[a] : offset[a] + 0.5f * along[a];
        for (int i = 0; i < 2; i++) {
            m->axis[i][a] = radius * across[i][a];
            m->inverse[i][a] = narrow * across[i][a];
        }
        m->axis[2][a] = part * along[a];
        m->inverse[2][a] = along[a] / square;
    }
    m->reach = disc ? radius : length + radius;
}

/* Boxes of glyphs in the picture, relative to the pixel of the block's origin, and lower bounds of their
 * depths. */
typedef struct sp_bounds {
    sp_reach box;
    vf front;
} sp_bounds;

/* Half the extent of a circle's image along one axis of the picture, in pixels, and how far its middle is
 * from the image of the circle's centre. Half diameters of the circle have the components along[2] on that
 * axis and depth[2]. slope: of the centre's ray; away: its depth squared, less the circle's extent in depth
 * squared. As add_ellipsoid of solid.c. */
ISO_INLINE vf circle_half(const iso_shapes_frame *frame, const vf along[2], const vf depth[2], vf slope,
                          vf away, vf *shift) {
    const vf e0 = along[0] - slope * depth[0], e1 = along[1] - slope * depth[1], wide = e0 * e0 + e1 * e1;
    *shift = v_set(0);
    if (frame->parallel) return v_sqrt(wide) * frame->length;
    const vf mixed = depth[0] * e0 + depth[1] * e1, scale = frame->length / away;
    *shift = -mixed * scale;
    return v_sqrt(mixed * mixed + wide * away) * scale;
}

/* Extends bounds by a circle around the map's third axis, at height z on it; radius 0: by a point. */
ISO_INLINE void add_circle(const iso_shapes_frame *frame, const iso_shapes_origin *o, const sp_map *m,
                           float z, float radius, sp_bounds *b) {
    vf at[3], half[2], shift[2], depth[2];
    for (int a = 0; a < 3; a++) at[a] = m->centre[a] + z * m->axis[2][a];
    const sp_points p = points_of(frame, o, at);
    for (int i = 0; i < 2; i++) depth[i] = radius * m->axis[i][2];
    const vf deep = v_sqrt(depth[0] * depth[0] + depth[1] * depth[1]), away = (p.z - deep) * (p.z + deep);
    for (int a = 0; a < 2; a++) {
        const vf along[2] = {radius * m->axis[0][a], radius * m->axis[1][a]};
        half[a] = circle_half(frame, along, depth, a ? p.v : p.u, away, &shift[a]);
    }
    b->box.x0 = v_min(b->box.x0, p.x + (shift[0] - half[0]));
    b->box.y0 = v_min(b->box.y0, p.y + (shift[1] - half[1]));
    b->box.x1 = v_max(b->box.x1, p.x + (shift[0] + half[0]));
    b->box.y1 = v_max(b->box.y1, p.y + (shift[1] + half[1]));
    b->front = v_min(b->front, p.z - deep);
}

ISO_INLINE sp_bounds solid_bounds(const iso_shapes_frame *frame, const iso_shapes_origin *o,
                                  const sp_map *m) {
    const iso_glyph glyph = frame->shapes->glyph;
    const vf most = v_set(INFINITY);
    sp_bounds b = {{most, most, -most, -most}, most};
    if (glyph == ISO_GLYPH_DISC) add_circle(frame, o, m, 0, 1, &b);
    if (glyph == ISO_GLYPH_CYLINDER) add_circle(frame, o, m, 1, 1, &b);
    if (glyph == ISO_GLYPH_CYLINDER || glyph == ISO_GLYPH_CONE) add_circle(frame, o, m, -1, 1, &b);
    if (glyph == ISO_GLYPH_CONE || glyph == ISO_GLYPH_ARROW) add_circle(frame, o, m, 1, 0, &b);
    if (glyph != ISO_GLYPH_ARROW) return b;
    add_circle(frame, o, m, -1, (float)ISO_ARROW_SHAFT, &b);
    add_circle(frame, o, m, (float)ISO_ARROW_NECK, 1, &b);
    return b;
}

/* Adds the wanted ones of a vector of glyphs to the chunk. */
ISO_INLINE void add_solids(iso_shapes_bin *bin, const iso_shapes_origin *o, vm wanted, const sp_map *m,
                           vi id) {
    const iso_shapes_frame *frame = bin->frame;
    const sp_bounds b = solid_bounds(frame, o, m);
    const vf nearest = b.front - m->reach * 1e-5f - v_abs(b.front) * 1e-6f;
    vi to[4];
    wanted = clip(bin, o, wanted, &b.box, nearest, to);
    if (!v_mask(wanted)) return;
    const sp_points p = points_of(frame, o, m->centre);
    vf rest[ISO_SOLID_FIELDS - ISO_FIELD_Z];
    rest[0] = p.z;
    for (int a = 0; a < 3; a++) {
        const vf *row = m->inverse[a];
        rest[ISO_FIELD_UNIT_X - ISO_FIELD_Z + a] = row[0];
        rest[ISO_FIELD_UNIT_Y - ISO_FIELD_Z + a] = row[1];
        rest[ISO_FIELD_UNIT_RAY - ISO_FIELD_Z + a] =
            frame->parallel ? row[2] : p.u * row[0] + p.v * row[1] + row[2];
    }
    add_shapes(bin, o, wanted, to, p.x, p.y, id, v_seti(0), nearest, rest, ISO_SOLID_FIELDS - ISO_FIELD_Z);
}

/* The glyphs of a block, by place in the order of blocks, that may be seen. */
typedef struct sp_candidates {
    int32_t place[ISO_SHAPES_BLOCK + ISO_LANES_MAX];
    int count;
} sp_candidates;

/* Finds the glyphs around which a sphere of the block's reach is in the bin and not hidden. */
ISO_INLINE void find_candidates(const iso_shapes_bin *bin, const iso_shapes_block *block,
                                const iso_shapes_origin *o, sp_candidates *found) {
    const iso_shapes *set = bin->frame->shapes;
    const vf reach = v_set(block->reach);
    found->count = 0;
    for (uint32_t i = 0; i < block->count; i += ISO_LANES) {
        const uint32_t at = block->first + i, left = block->count - i;
        const vf position[3] = {v_load(set->x + at), v_load(set->y + at), v_load(set->z + at)};
        vf offset[3], nearest;
        vi to[4];
        turn(bin->frame, position, offset);
        const sp_points p = points_of(bin->frame, o, offset);
        const vm all = v_from_mask(left < ISO_LANES ? (1u << left) - 1 : (uint32_t)-1),
                 seen = clip_spheres(bin, o, all, &p, reach, &nearest, to);
        v_compressi(found->place + found->count, seen, v_seti((int32_t)at) + v_lanes());
        found->count += __builtin_popcount(v_mask(seen));
    }
}

/* Places the candidates of glyphs along directions. Where squares would underflow glyphs are left out: they
 * are smaller than a millionth of the block's reach, which is less than a thousandth of a pixel. */
ISO_INLINE void add_directed(iso_shapes_bin *bin, const iso_shapes_block *block, const iso_shapes_origin *o,
                             sp_candidates *found) {
    const iso_shapes *set = bin->frame->shapes;
    const float *directions = &set->directions[0][0];
    for (int i = found->count; i < found->count + ISO_LANES; i++)
        found->place[i] = (int32_t)block->first; /* read, but not wanted */
    for (int i = 0; i < found->count; i += ISO_LANES) {
        int32_t ids[ISO_LANES];
        for (int k = 0; k < ISO_LANES; k++) ids[k] = (int32_t)iso_shapes_id(set, (size_t)found->place[i + k]);
        const vi place = v_loadi(found->place + i), id = v_loadi(ids);
        const int left = found->count - i;
        vm wanted = v_from_mask(left < ISO_LANES ? (1u << left) - 1 : (uint32_t)-1);
        const vf position[3] = {v_gather(set->x, place), v_gather(set->y, place), v_gather(set->z, place)};
        vf world[3], offset[3], along[3];
        for (int a = 0; a < 3; a++) world[a] = v_gather(directions, id * 3 + a) * (float)set->scale;
        turn(bin->frame, position, offset);
        turn(bin->frame, world, along);
        const vf length = v_sqrt(dot(along, along));
        wanted = v_and(wanted, v_lt(v_set(1e-12f), length));
        sp_map m;
        map_along(set, id, offset, along, length, &m);
        add_solids(bin, o, wanted, &m, id);
    }
}

/* Whether floats hold the squares of the block's lengths and depths. */
ISO_INLINE bool is_plain(const iso_shapes_block *block, const iso_shapes_origin *o) {
    return block->reach > 1e-6f && block->reach < 1e12f && o->depth < 1e15f;
}

static void add_solid_block(iso_shapes_bin *bin, const iso_shapes_seen *seen) {
    const iso_shapes *set = bin->frame->shapes;
    const iso_shapes_block *block = &set->blocks[seen->block];
    sp_candidates found;
    iso_shapes_origin o;
    const bool flat = set->billboards && !bin->frame->parallel;
    if (seen->apart || flat || !iso_shapes_origin_of(bin->frame, seen->centre, &o) || !is_plain(block, &o)) {
        for (uint32_t i = 0; i < block->count; i++) iso_solid_add(bin, block, block->first + i);
        return;
    }
    find_candidates(bin, block, &o, &found);
    /* numbers of directions fit into the lanes of a vector */
    const bool few = set->count + set->skipped < INT32_MAX / 3;
    if (set->directions && iso_solid_is_directed(set->glyph) && few)
        add_directed(bin, block, &o, &found);
    else
        for (int i = 0; i < found.count; i++) iso_solid_add(bin, block, (uint32_t)found.place[i]);
}

#endif
