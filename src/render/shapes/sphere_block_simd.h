/* sphere_block_simd: prepares the spheres of a block for drawing. */
#ifndef ISO_RENDER_SHAPES_SPHERE_BLOCK_SIMD_H
#define ISO_RENDER_SHAPES_SPHERE_BLOCK_SIMD_H

#include "render/shapes/chunk_simd.h"

/* The interval of pixels that a sphere covers along one axis, relative to its centre's; u: the slope of its
 * centre's ray. Computed from the two tangents to a circle, in a form in which no large terms cancel. */
ISO_INLINE void sphere_reach(const iso_shapes_frame *frame, vf u, vf z, vf radius, vf *low, vf *high) {
    if (frame->spread == 0) {
        *high = radius * (frame->parallel ? v_set(frame->length) : frame->length / z);
        *low = -*high;
        return;
    }
    const vf away = (z - radius) * (z + radius), scale = frame->length / away, x = u * z;
    const vf half = radius * v_sqrt(x * x + away), shift = u * (radius * radius);
    *low = (shift - half) * scale;
    *high = (shift + half) * scale;
}

/* Returns a lower bound of the depths of a sphere's visible samples, rounding included. */
ISO_INLINE vf sphere_nearest(vf z, vf radius) {
    return z - radius * 1.00001f - v_abs(z) * 1e-6f;
}

/* The projections of points near an origin: pixels from the origin's pixel; depths; slopes of their rays,
 * which are 0 in parallel projection. */
typedef struct sp_points {
    vf x, y, z, u, v;
} sp_points;

/* offset: from the origin, in view space. */
ISO_INLINE sp_points points_of(const iso_shapes_frame *frame, const iso_shapes_origin *o,
                               const vf offset[3]) {
    const vf z = o->depth + (offset[2] + o->rest);
    const vf scale = frame->parallel ? v_set(frame->length) : frame->length / z;
    const vf x = o->x + (offset[0] - o->u * offset[2]) * scale,
             y = o->y + (offset[1] - o->v * offset[2]) * scale;
    return (sp_points){x, y, z, o->u + (x - o->x) * frame->slope, o->v + (y - o->y) * frame->slope};
}

/* Returns which spheres overlap the bin and are not hidden; sets lower bounds of their depths, and their
 * boxes. */
ISO_INLINE vm clip_spheres(const iso_shapes_bin *bin, const iso_shapes_origin *o, vm wanted,
                           const sp_points *p, vf radius, vf *nearest, vi to[4]) {
    sp_reach r;
    *nearest = sphere_nearest(p->z, radius);
    sphere_reach(bin->frame, p->u, p->z, radius, &r.x0, &r.x1);
    sphere_reach(bin->frame, p->v, p->z, radius, &r.y0, &r.y1);
    r = (sp_reach){p->x + r.x0, p->y + r.y0, p->x + r.x1, p->y + r.y1};
    return clip(bin, o, wanted, &r, *nearest, to);
}

/* Adds spheres to the chunk, given relative to an origin: offset in view space. */
ISO_INLINE void add_spheres(iso_shapes_bin *bin, const iso_shapes_origin *o, vm wanted, const vf offset[3],
                            vf radius, vi id) {
    const sp_points p = points_of(bin->frame, o, offset);
    vf nearest;
    vi to[4];
    wanted = clip_spheres(bin, o, wanted, &p, radius, &nearest, to);
    if (!v_mask(wanted)) return;
    const vf rest[2] = {p.z, radius};
    add_shapes(bin, o, wanted, to, p.x, p.y, id, v_seti(0), nearest, rest, 2);
}

/* Adds one sphere with its own origin, or draws it in double precision. */
static void add_sphere_apart(iso_shapes_bin *bin, const iso_shapes_block *block, uint32_t i) {
    const iso_shapes_frame *frame = bin->frame;
    const iso_shapes *set = frame->shapes;
    const double position[3] = {(double)block->origin[0] + (double)set->x[i],
                                (double)block->origin[1] + (double)set->y[i],
                                (double)block->origin[2] + (double)set->z[i]};
    const uint32_t id = iso_shapes_id(set, i);
    const float radius = iso_shapes_radius(set, id);
    const double r = (double)radius;
    double view[3];
    iso_shapes_to_view(frame, position, view);
    if (view[2] + r < frame->near) return;
    iso_shapes_origin o;
    if (!iso_near_fits(frame, view[2] - r, r) || !iso_shapes_origin_of(frame, view, &o)) {
        const iso_near_shape shape = iso_near_sphere(frame, view, r, id);
        iso_near_draw(bin, &shape);
        return;
    }
    const vf zero[3] = {v_set(0), v_set(0), v_set(0)};
    add_spheres(bin, &o, v_from_mask(1), zero, v_set(radius), v_seti((int32_t)id));
}

/* The radii of the spheres from place `at` on, whose numbers are `id`. */
ISO_INLINE vf radii_of(const iso_shapes *set, uint32_t at, vi id) {
    if (set->size) return v_gather(set->sizes, v_load_u8(set->size + at));
    if (!set->radii) return v_set(iso_shapes_radius(set, 0));
    return v_gather(set->radii, id) * (float)set->scale;
}

ISO_INLINE void add_spheres_of(iso_shapes_bin *bin, const iso_shapes_block *block,
                               const iso_shapes_origin *o) {
    const iso_shapes *set = bin->frame->shapes;
    const float *m = bin->frame->turn;
    for (uint32_t i = 0; i < block->count; i += ISO_LANES) {
        const uint32_t at = block->first + i, left = block->count - i;
        const vf x = v_load(set->x + at), y = v_load(set->y + at), z = v_load(set->z + at);
        const vi high = set->id_high ? v_load_u8(set->id_high + at) : v_load_u16(set->id_high_wide + at),
                 id = high << 16 | v_load_u16(set->id_low + at);
        vf offset[3];
        for (int a = 0; a < 3; a++) offset[a] = m[3 * a] * x + m[3 * a + 1] * y + m[3 * a + 2] * z;
        const vm wanted = v_from_mask(left < ISO_LANES ? (1u << left) - 1 : (uint32_t)-1);
        add_spheres(bin, o, wanted, offset, radii_of(set, at, id), id);
    }
}

static void add_sphere_block(iso_shapes_bin *bin, const iso_shapes_seen *seen) {
    const iso_shapes_block *block = &bin->frame->shapes->blocks[seen->block];
    iso_shapes_origin o;
    if (!seen->apart && iso_shapes_origin_of(bin->frame, seen->centre, &o)) {
        add_spheres_of(bin, block, &o);
    } else {
        for (uint32_t i = 0; i < block->count; i++) add_sphere_apart(bin, block, block->first + i);
    }
}

#endif
