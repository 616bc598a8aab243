/* outlined_roots_simd: where the rays of a patch's pixels meet the surface, and the normals and colours
 * there. The chain of arithmetic per pixel is long, so it is split into short loops over the pixels, of which
 * the processor overlaps several iterations. */
#ifndef ISO_EXACT_OUTLINED_ROOTS_SIMD_H
#define ISO_EXACT_OUTLINED_ROOTS_SIMD_H

#include "exact/kernel_simd.h"
#include "exact/large_cells_simd.h"

/* Computes the rays of the patch's pixels from number i on, in the cell's coordinates: `at` is the position
 * on the ray at the depth of the cell's reference point, `along` the change of position per mm of depth. */
ISO_INLINE void patch_rays(const iso_exact_rays *rays, const iso_exact_patch *patch, int i, vf at[3],
                           vf along[3]) {
    const vf x = v_load(patch->x + i), y = v_load(patch->y + i);
    for (int j = 0; j < 3; j++) {
        at[j] = x * rays->right[j] + y * rays->down[j];
        along[j] = at[j] * rays->turn + rays->along[j];
    }
}

/* The coordinates of the patch's pixels from number i on, as y << 16 | x. */
ISO_INLINE vi patch_pixels(const iso_exact_scratch *scratch, int i) {
    const iso_exact_patch *patch = &scratch->patch;
    const float *place = scratch->record[patch->cell].place;
    const vi x = v_floor(v_load(patch->x + i) + place[0] + 0.5f) + scratch->octant_projection.origin[0],
             y = v_floor(v_load(patch->y + i) + place[1] + 0.5f) + scratch->octant_projection.origin[1];
    return (y << 16) + x;
}

/* Gives unit length to normals whose squares would underflow (unit_normals). Not inlined, as it is rare. */
ISO_STEP static void small_normals(const iso_exact_projection *projection, const iso_exact_scratch *scratch,
                                   int i, vf normal[3]) {
    unit_normals(projection, patch_pixels(scratch, i), normal);
}

/* Stores where the rays of the patch's pixels from number i on meet the surface: positions (`at` is relative
 * to the centre of the surface's box, the stored ones to the cell's centre) and depths. */
ISO_INLINE void store_roots(const iso_exact_projection *projection, const iso_exact_cell *record,
                            iso_exact_patch *patch, int i, const vf at[3], vf depth) {
    for (int j = 0; j < 3; j++) v_store(patch->normal[j] + ISO_LANES_MAX + i, at[j] + record->shift[j]);
    v_store(patch->depth + ISO_LANES_MAX + i, ISO_EXACT_LAYERED ? depth : depth + (float)projection->middle);
}

/* Replaces the positions in patch->normal by the unit normals there. */
ISO_STEP static void shade_patch(const iso_exact_projection *projection, iso_exact_scratch *scratch) {
    iso_exact_patch *patch = &scratch->patch;
    const float(*g)[4] = patch->gradient;
    for (int i = 0; i < patch->count; i += ISO_LANES) {
        float *const to[3] = {patch->normal[0] + ISO_LANES_MAX + i, patch->normal[1] + ISO_LANES_MAX + i,
                              patch->normal[2] + ISO_LANES_MAX + i};
        const vf u = v_load(to[0]), v = v_load(to[1]), w = v_load(to[2]);
        vf normal[3], square = v_set(0);
        for (int k = 0; k < 3; k++) {
            const vf low = (g[1][k] * u + g[0][k]) + (g[4][k] * u + g[2][k]) * v,
                     high = (g[6][k] * u + g[3][k]) + (g[7][k] * u + g[5][k]) * v;
            normal[k] = high * w + low;
            square += normal[k] * normal[k];
        }
        const vf inverse = 1 / v_sqrt(square);
        const vm small = v_lt(square, v_set(1e-12f));
        for (int k = 0; k < 3; k++) v_store(to[k], normal[k] * inverse);
        if (!v_mask(small)) continue;
        vf general[3] = {normal[0], normal[1], normal[2]};
        small_normals(projection, scratch, i, general);
        for (int k = 0; k < 3; k++) v_store(to[k], v_select(small, general[k], normal[k] * inverse));
    }
}

/* Computes the RGBA of the patch's pixels from their normals. Their rays (u, v) are overwritten by the terms
 * of the shading model. */
ISO_STEP static void paint_patch(const iso_exact_paint *paint, iso_exact_patch *patch) {
    const vf base[3] = {v_set(paint->base[0]), v_set(paint->base[1]), v_set(paint->base[2])};
    for (int i = 0; i < patch->count; i += ISO_LANES) {
        const int at = ISO_LANES_MAX + i;
        const vf normal[3] = {v_load(patch->normal[0] + at), v_load(patch->normal[1] + at),
                              v_load(patch->normal[2] + at)};
        const vf to_eye[3] = {-v_load(patch->u + i), -v_load(patch->v + i), v_set(-1)};
        vf diffuse, lobe;
        phong_terms(normal, to_eye, &diffuse, &lobe);
        v_store(patch->u + i, diffuse);
        v_store(patch->v + i, lobe);
    }
    for (int i = 0; i < patch->count; i += ISO_LANES) {
        vf rgb[3];
        phong_color(v_load(patch->u + i), v_load(patch->v + i), base, rgb);
        v_storei(patch->word + ISO_LANES_MAX + i, pack_pixels(rgb, v_seti(255)));
    }
}

/* Replaces the patch's normals by the packed fragments. */
ISO_STEP static void pack_patch(const iso_exact_projection *projection, iso_exact_scratch *scratch) {
    iso_exact_patch *patch = &scratch->patch;
    const iso_exact_rays *rays = &scratch->rays[patch->cell];
    const uint32_t all_fall = rays->rate < 0 ? ~0u : 0; /* of a flat cell */
    for (int i = 0; i < patch->count; i += ISO_LANES) {
        const int at = ISO_LANES_MAX + i;
        const vf normal[3] = {v_load(patch->normal[0] + at), v_load(patch->normal[1] + at),
                              v_load(patch->normal[2] + at)};
        const vf to_eye[3] = {-v_load(patch->u + i), -v_load(patch->v + i), v_set(-1)};
        const vm falls =
            rays->flat ? v_from_mask(all_fall) : v_lti(v_seti(-1), v_bits(v_load(patch->cubic[0] + i)));
        vf packed[3];
        pack_fragments(projection, normal, to_eye, falls, packed);
        for (int k = 0; k < 3; k++) v_store(patch->normal[k] + at, packed[k]);
    }
}

/* ---- flat cells: the root is found by Newton's method from the plane of the field's linear part, without
 * clipping the ray to the cell. set_ray_maps made sure that this converges wherever a ray meets the surface
 * in the cell, and to that point. */

/* The field minus the isovalue along rays, in powers of the distance x towards the eye (mm of depth) from a
 * point on each ray, divided by its slope at the point: first - x + bend x^2 - twist x^3. */
typedef struct ex_ray_series {
    vf first, bend, twist;
} ex_ray_series;

/* Expands the field with the coefficients k along rays of the direction `along` from the points `at`. */
ISO_INLINE ex_ray_series ray_series_at(const float k[8], const vf at[3], const vf along[3]) {
    const vf u = at[0], v = at[1], w = at[2], ab = along[0] * along[1];
    const vf uv = k[7] * w + k[4], vw = k[7] * u + k[5], uw = k[7] * v + k[6], part_v = k[5] * w + k[2];
    const vf slope_u = (k[6] * w + k[1]) + uv * v, slope_v = part_v + uv * u,
             slope_w = (k[5] * v + k[3]) + uw * u;
    const vf value = (k[3] * w + k[0]) + (slope_u * u + part_v * v);
    const vf inverse = 1 / ((slope_u * along[0] + slope_v * along[1]) + slope_w * along[2]);
    return (ex_ray_series){
        value * inverse,
        (uv * ab + (vw * along[1] + uw * along[0]) * along[2]) * inverse,
        (k[7] * ab) * along[2] * inverse,
    };
}

/* A step of Newton's method from x: returns what is to be added to x. *left: an estimate of the distance to
 * the root after the step. Instead of a division, the slope's inverse is a series of second order, whose
 * error is part of the estimate. */
ISO_INLINE vf newton_step(const ex_ray_series *f, vf x, vf *left) {
    const vf turn = 3 * x * f->twist, less = x * ((f->bend + f->bend) - turn), square = less * less;
    const vf rest = f->first - x * (1 - x * (f->bend - x * f->twist)), step = rest * ((square + less) + 1);
    *left = v_abs(step) * (square + v_abs((f->bend - turn) * step));
    return step;
}

/* Records which of the positions `at` lie in the cell (patch->hit), and which are so near to its faces, or
 * not yet converged, that the general test must decide (patch->unsure). near: lanes whose root is within
 * iso_exact_rays.reach of the plane; moving: lanes that have not converged. */
ISO_INLINE void classify_roots(const iso_exact_cell *record, iso_exact_patch *patch, int i, const vf at[3],
                               vm near, vm moving) {
    const float doubt = 4e-5f; /* in half cells: a root this near to a face may belong to the next cell */
    const vf beyond = v_max(v_max(v_abs(at[0]) - record->half[0], v_abs(at[1]) - record->half[1]),
                            v_abs(at[2]) - record->half[2]);
    const vm present = v_and(near, v_lti(v_lanes(), v_seti(patch->count - i)));
    const vm within = v_andnot(v_le(beyond, v_set(-doubt)), moving);
    const vm maybe = v_andnot(v_or(v_le(beyond, v_set(doubt)), moving), within);
    patch->hit[i >> 6] |= (uint64_t)v_mask(v_and(present, within)) << (i & 63);
    patch->unsure[i >> 6] |= (uint64_t)v_mask(v_and(present, maybe)) << (i & 63);
}

/* Intersects each ray with the plane on which the field's linear part is 0, and expands the field along the
 * ray in powers of the distance from that intersection. */
ISO_INLINE void make_ray_series(const iso_exact_cell *record, const iso_exact_rays *rays,
                                iso_exact_patch *patch) {
    const float *k = record->field;
    for (int i = 0; i < patch->count; i += ISO_LANES) {
        vf at[3], along[3];
        patch_rays(rays, patch, i, at, along);
        const vf rise = (at[0] * k[1] + at[1] * k[2]) + at[2] * k[3];
        const vf start = (rise + k[0]) / (rise * rays->turn + rays->rate); /* mm of depth, towards the eye */
        v_store(patch->begin + i, start);
        for (int j = 0; j < 3; j++) {
            v_store(patch->entry[j] + i, at[j] - start * along[j]);
            v_store(patch->step[j] + i, along[j]);
        }
    }
    for (int i = 0; i < patch->count; i += ISO_LANES) {
        vf at[3], along[3];
        for (int j = 0; j < 3; j++) {
            at[j] = v_load(patch->entry[j] + i);
            along[j] = v_load(patch->step[j] + i);
        }
        const ex_ray_series f = ray_series_at(k, at, along);
        v_store(patch->cubic[0] + i, f.first);
        v_store(patch->cubic[1] + i, f.bend);
        v_store(patch->cubic[2] + i, f.twist);
    }
}

/* The root of the series, as a distance towards the eye: an approximation by the inverse series of third
 * order, improved by Newton's method until the estimated error is at most `close`. moving: lanes that have
 * not converged after 17 steps. */
ISO_INLINE vf newton_root(const ex_ray_series *f, vf close, vm *moving) {
    vf left, x = f->first * (1 + f->first * (f->bend + f->first * (2 * f->bend * f->bend - f->twist)));
    x += newton_step(f, x, &left);
    *moving = v_lt(close, left);
    for (int n = 0; n < 16 && v_mask(*moving); n++) {
        x += v_select(*moving, newton_step(f, x, &left), v_set(0));
        *moving = v_and(*moving, v_lt(close, left));
    }
    return x;
}

/* Finds the roots of the patch's rays in a flat cell; sets `hit` and `unsure`. */
ISO_STEP static void find_flat_roots(const iso_exact_projection *projection, iso_exact_scratch *scratch) {
    iso_exact_patch *patch = &scratch->patch;
    const iso_exact_cell *record = &scratch->record[patch->cell];
    const iso_exact_rays *rays = &scratch->rays[patch->cell];
    make_ray_series(record, rays, patch);
    for (int i = 0; i < patch->count; i += ISO_LANES) {
        const ex_ray_series f = {v_load(patch->cubic[0] + i), v_load(patch->cubic[1] + i),
                                 v_load(patch->cubic[2] + i)};
        vm moving;
        const vf x = newton_root(&f, v_set(rays->close), &moving);
        vf at[3];
        for (int j = 0; j < 3; j++) at[j] = v_load(patch->entry[j] + i) - x * v_load(patch->step[j] + i);
        classify_roots(record, patch, i, at, v_le(v_abs(x), v_set(rays->reach)), moving);
        store_roots(projection, record, patch, i, at, record->depth - (v_load(patch->begin + i) + x));
    }
}

/* ---- curved cells: rays are clipped to the cell, and the cubic along each is solved */

/* A step of Chebyshev's method (Newton's with a term of second order) for the cubic f from x: returns what is
 * to be subtracted from x. *left: an estimate of the distance to the root after the step. */
ISO_INLINE vf chebyshev_step(const vf f[4], vf x, vf *left) {
    const vf triple = 3 * f[3], bend = triple * x + f[2];
    const vf value = ((f[3] * x + f[2]) * x + f[1]) * x + f[0],
             inverse = 1 / ((triple * x + (f[2] + f[2])) * x + f[1]);
    const vf newton = value * inverse, more = bend * inverse * newton;
    *left = (v_abs(bend) + v_abs(f[3])) * v_abs(inverse) * (newton * newton) * (v_abs(more) + v_abs(newton));
    return newton + newton * more;
}

/* The root in [0, 1] of the parabola through a cubic's values at 0, 1/2 and 1; f[0] and the value at 1 have
 * different signs. */
ISO_INLINE vf parabola_root(const vf f[4]) {
    const vf bend = f[2] + 1.5f * f[3], rise = f[1] - 0.5f * f[3];
    const vf root = v_sqrt(rise * rise - 4 * bend * f[0]);
    const vf along = v_floats(v_bits(root) | (~v_bits(f[0]) & INT32_MIN));
    return -(f[0] + f[0]) / (rise + along);
}

/* The roots in [0, 1] of cubics that change sign once there, from first approximations x; computed in the
 * lanes `wanted`. */
ISO_INLINE vf refine_root(const vf f[4], vf x, vm wanted) {
    const vf most = v_set(1e-6f); /* allowed distance to the root */
    vf left, again;
    x -= chebyshev_step(f, x, &left);
    const vm far = v_andnot(wanted, v_le(left, most));
    if (v_mask(far)) {
        x = v_select(far, x - chebyshev_step(f, x, &again), x);
        left = v_select(far, again, left);
    }
    const vm found = v_and(v_le(left, most), v_le(v_abs(x - 0.5f), v_set(0.5f + 4e-7f)));
    const vm rest = v_andnot(wanted, found);
    if (v_mask(rest)) {
        ex_search search = {.f = {f[0], f[1], f[2], f[3]}};
        start_search(&search, rest);
        for (int step = 0; step < 24 && v_mask(search.moving); step++) search_step(&search);
        x = v_select(rest, search.x, x);
    }
    return v_min(v_max(x, v_set(0)), v_set(1));
}

/* Calls false_hits for the patch's pixels from number i on. */
ISO_STEP static uint32_t false_hits_of_patch(const iso_exact_projection *projection,
                                             iso_exact_scratch *scratch, int i) {
    scratch->owner[0] = scratch->patch.cell * RECORD_FLOATS;
    v_storei(scratch->pixel, patch_pixels(scratch, i));
    return false_hits(projection, scratch, 0);
}

ISO_INLINE void store_chord(iso_exact_patch *patch, int i, const ex_chord *chord) {
    for (int j = 0; j < 3; j++) {
        v_store(patch->entry[j] + i, chord->entry[j]);
        v_store(patch->step[j] + i, chord->step[j]);
    }
    v_store(patch->begin + i, chord->depth);
    v_store(patch->length + i, chord->length);
}

ISO_INLINE void load_chord(const iso_exact_patch *patch, int i, ex_chord *chord) {
    for (int j = 0; j < 3; j++) {
        chord->entry[j] = v_load(patch->entry[j] + i);
        chord->step[j] = v_load(patch->step[j] + i);
    }
    chord->depth = v_load(patch->begin + i);
    chord->length = v_load(patch->length + i);
    chord->meets = v_lt(v_set(0), chord->length);
}

/* Clips the patch's rays to the cell; sets patch->hit for those that cross the surface there, and the cubics
 * along all of them. */
ISO_INLINE void intersect_rays(const iso_exact_projection *projection, iso_exact_scratch *scratch) {
    iso_exact_patch *patch = &scratch->patch;
    const iso_exact_cell *record = &scratch->record[patch->cell];
    const iso_exact_rays *rays = &scratch->rays[patch->cell];
    const vf half[3] = {v_set(record->half[0]), v_set(record->half[1]), v_set(record->half[2])};
    vf field[8];
    for (int k = 0; k < 8; k++) field[k] = v_set(record->field[k]);
    for (int i = 0; i < patch->count; i += ISO_LANES) {
        vf at[3], along[3];
        ex_faces faces;
        ex_chord chord;
        patch_rays(rays, patch, i, at, along);
        meet_faces(at, along, half, &faces);
        set_chord(at, along, min_of_3(faces.before), min_of_3(faces.after), v_set(record->depth), &chord);
        store_chord(patch, i, &chord);
    }
    for (int i = 0; i < patch->count; i += ISO_LANES) {
        ex_chord chord;
        vm more;
        vi end;
        load_chord(patch, i, &chord);
        set_cubic(field, &chord);
        vm hit = single_changes(NULL, &chord, &more, &end);
        const vm present = v_lti(v_lanes(), v_seti(patch->count - i));
        if (ISO_EXACT_LAYERED) {
            /* several crossings are found by the test of pairs */
            patch->unsure[i >> 6] |= (uint64_t)v_mask(v_and(more, present)) << (i & 63);
        } else if (v_mask(more)) {
            hit = v_or(hit, first_monotone_piece(more, end, &chord));
            store_chord(patch, i, &chord);
        }
        hit = v_and(hit, present);
        const vm doubt = v_and(hit, may_be_false(&chord));
        if (v_mask(doubt))
            hit = v_andnot(hit, v_and(doubt, v_from_mask(false_hits_of_patch(projection, scratch, i))));
        patch->hit[i >> 6] |= (uint64_t)v_mask(hit) << (i & 63);
        for (int k = 0; k < 4; k++) v_store(patch->cubic[k] + i, chord.f[k]);
    }
}

/* Leaves hits near the cell's faces, among the patch's pixels from number i on, to the test of pairs, which
 * reports them as doubtful. at: the positions relative to the centre of the surface's box. */
ISO_INLINE void set_doubtful_aside(iso_exact_scratch *scratch, int i, const vf at[3]) {
    iso_exact_patch *patch = &scratch->patch;
    const float *shift = scratch->record[patch->cell].shift;
    const vf place[3] = {at[0] + shift[0], at[1] + shift[1], at[2] + shift[2]};
    const uint64_t doubtful = (uint64_t)v_mask(are_doubtful(place, v_seti(0))) << (i & 63);
    patch->unsure[i >> 6] |= patch->hit[i >> 6] & doubtful;
    patch->hit[i >> 6] &= ~doubtful;
}

/* Finds the roots of the patch's rays in a cell that is not flat; sets `hit`. */
ISO_STEP static void find_curved_roots(const iso_exact_projection *projection, iso_exact_scratch *scratch) {
    iso_exact_patch *patch = &scratch->patch;
    intersect_rays(projection, scratch);
    for (int i = 0; i < patch->count; i += ISO_LANES) {
        vf f[4];
        for (int k = 0; k < 4; k++) f[k] = v_load(patch->cubic[k] + i);
        v_store(patch->guess + i, parabola_root(f));
    }
    for (int i = 0; i < patch->count; i += ISO_LANES) {
        const vm hit = v_from_mask((uint32_t)(patch->hit[i >> 6] >> (i & 63)));
        vf f[4], at[3];
        for (int k = 0; k < 4; k++) f[k] = v_load(patch->cubic[k] + i);
        const vf x = refine_root(f, v_load(patch->guess + i), hit);
        for (int j = 0; j < 3; j++) at[j] = v_load(patch->entry[j] + i) + x * v_load(patch->step[j] + i);
        if (ISO_EXACT_LAYERED) set_doubtful_aside(scratch, i, at);
        store_roots(projection, &scratch->record[patch->cell], patch, i, at,
                    v_load(patch->begin + i) + x * v_load(patch->length + i));
    }
}

#endif
