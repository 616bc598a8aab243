/* cell_setup_simd: prepares the cells of an octant as vectors of cells: the trilinear field's coefficients,
 * the projected position and bounding box in the picture, and the front-to-back order. */
#ifndef ISO_EXACT_CELL_SETUP_SIMD_H
#define ISO_EXACT_CELL_SETUP_SIMD_H

#include "base/exponential_simd.h"
#include "exact/kernel_simd.h"
#include "render/shading/phong_simd.h"

/* The vector of corner values from number `i` on, as floats; float voxels are divided by 4, so that
 * differences stay finite (iso_exact_projection.isovalue_ceil). */
ISO_INLINE vf corner_values(iso_type type, const void *corners, size_t i) {
    switch (type) {
    case ISO_UINT8:
        return v_to_float(v_load_u8((const uint8_t *)corners + i));
    case ISO_INT16:
        return v_to_float(v_load_i16((const int16_t *)corners + i));
    case ISO_UINT16:
        return v_to_float(v_load_u16((const uint16_t *)corners + i));
    default:
        return v_load((const float *)corners + i) * 0.25f;
    }
}

/* The power of two by which a magnitude must be multiplied to be about 1. */
ISO_INLINE vf unit_scale(vf magnitude) {
    const vi largest = v_seti(253 << 23), exponent = v_bits(magnitude) & 0x7f800000;
    return v_floats(v_seti(254 << 23) - v_selecti(v_lti(exponent, largest), exponent, largest));
}

/* The flags (ISO_EXACT_FACES ..) of a vector of cells. c: their corner values minus the isovalue. */
ISO_INLINE vi tie_flags(const vf c[8]) {
    vm zero[8];
    vf most = c[0];
    for (int i = 0; i < 8; i++) {
        zero[i] = v_eq(c[i], v_set(0));
        most = v_max(c[i], most);
    }
    vi flags = v_seti(0);
    for (int axis = 0; axis < 3; axis++)
        for (int side = 0; side < 2; side++) {
            const int a = side << axis, b = 1 << (axis + 1) % 3, d = 1 << (axis + 2) % 3;
            const vm face = v_and(v_and(zero[a], zero[a + b]), v_and(zero[a + d], zero[a + b + d]));
            flags |= v_selecti(face, v_seti(1 << (2 * axis + side)), v_seti(0));
        }
    const vi touching =
        v_selecti(v_eqi(flags, v_seti(0)), v_seti(ISO_EXACT_UNSEEN), v_seti(ISO_EXACT_TOUCHING));
    return flags | v_selecti(v_le(most, v_set(0)), touching, v_seti(0));
}

/* Sets `low` and `high` to the range of an axis, in [-1, 1], in which the surface lies. c: the corner values
 * minus the isovalue. On a plane perpendicular to the axis the field is bilinear: where it has the same sign
 * on the cell's four edges along the axis, it has that sign on the whole plane. */
ISO_INLINE void surface_range(const vf c[8], int axis, vf *low, vf *high) {
    const vf zero = v_set(0), one = v_set(1);
    const int b = 1 << (axis + 1) % 3, d = 1 << (axis + 2) % 3;
    const int edge[4] = {0, b, d, b + d};
    vf first = one, last = zero;
    vi low_any = v_seti(0), low_all = v_seti(-1), high_any = v_seti(0), high_all = v_seti(-1);
    for (int k = 0; k < 4; k++) {
        const vf from = c[edge[k]], to = c[edge[k] + (1 << axis)];
        const vm crossed = v_lti(v_bits(from) ^ v_bits(to), v_seti(0));
        const vf at = from / (from - to);
        first = v_select(crossed, v_min(at, first), first);
        last = v_select(crossed, v_max(at, last), last);
        low_any |= v_bits(from);
        low_all &= v_bits(from);
        high_any |= v_bits(to);
        high_all &= v_bits(to);
    }
    const vm low_mixed = v_lti(low_any & ~low_all, v_seti(0)),
             high_mixed = v_lti(high_any & ~high_all, v_seti(0));
    *low = v_select(low_mixed, -one, first + first - one);
    *high = v_select(high_mixed, one, last + last - one);
}

/* Sets `half` and `shift` of cells (and returns `shift`): the box in which the surface lies. For a cell with
 * flags it is the whole cell, because its faces can be part of the surface. */
ISO_INLINE void set_surface_box(const vf c[8], vi flags, iso_exact_cell *record, vf shift[3]) {
    const vf zero = v_set(0);
    const vm whole = v_lti(v_seti(0), flags);
    vf half[3];
    for (int axis = 0; axis < 3; axis++) {
        vf low, high;
        surface_range(c, axis, &low, &high);
        half[axis] = v_select(whole, v_set(1), 0.5f * (high - low)) + ISO_EXACT_WIDER;
        shift[axis] = v_select(whole, zero, 0.5f * (high + low));
    }
    const vf halves[4] = {half[0], half[1], half[2], zero}, shifts[4] = {shift[0], shift[1], shift[2], zero};
    v_store4(record->half, RECORD_FLOATS, halves);
    v_store4(record->shift, RECORD_FLOATS, shifts);
}

/* Transforms the field's coefficients (f: 0 .. 3, g: 4 .. 7) to coordinates whose origin is at `shift`. */
ISO_INLINE void move_field(const vf shift[3], vf f[4], vf g[4]) {
    const vf u = shift[0], v = shift[1], w = shift[2];
    const vf uv = g[0] + g[3] * w, vw = g[1] + g[3] * u, uw = g[2] + g[3] * v;
    const vf along_u = f[1] + g[0] * v + uw * w, along_v = f[2] + g[0] * u + vw * w,
             along_w = f[3] + g[1] * v + uw * u;
    f[0] += f[1] * u + along_v * v + (f[3] + g[2] * u) * w;
    f[1] = along_u;
    f[2] = along_v;
    f[3] = along_w;
    g[0] = uv;
    g[1] = vw;
    g[2] = uw;
}

/* Sets the field's coefficients and the flags of the octant's cells; unless the octant is next to the eye,
 * also the box of the surface in each cell (`half`, `shift`). */
ISO_STEP static void set_fields(const iso_exact_projection *projection, iso_exact_scratch *scratch) {
    const iso_type type = projection->exact->type;
    const size_t plane =
        (size_t)iso_exact_groups(scratch->octant->cells) * ISO_EXACT_GROUP * iso_type_size(type);
    const char *corners = scratch->corners;
    for (int i = 0; i < scratch->octant->cells; i += ISO_LANES) {
        vf c[8], largest = v_set(0), least = v_set(INFINITY);
        for (int k = 0; k < 8; k++) {
            c[k] = corner_values(type, corners + (size_t)k * plane, (size_t)i) - projection->isovalue_ceil -
                   projection->residual;
            largest = v_max(v_abs(c[k]), largest);
            least = v_min(v_abs(c[k]), least);
        }
        const bool tied = v_mask(v_eq(least, v_set(0)));
        const vi flags = tied ? tie_flags(c) : v_seti(0);
        v_storei(scratch->flags + i, flags);
        if (type == ISO_FLOAT32)
            for (int k = 0; k < 8; k++) c[k] *= unit_scale(largest);
        vf sum[4], rise[4]; /* of the ends of the edges along x at -y-z +y-z -y+z +y+z */
        for (int k = 0; k < 4; k++) {
            sum[k] = c[2 * k + 1] + c[2 * k];
            rise[k] = c[2 * k + 1] - c[2 * k];
        }
        const vf sum_low = sum[0] + sum[1], sum_high = sum[2] + sum[3], sum_y_low = sum[1] - sum[0],
                 sum_y_high = sum[3] - sum[2];
        const vf rise_low = rise[0] + rise[1], rise_high = rise[2] + rise[3], rise_y_low = rise[1] - rise[0],
                 rise_y_high = rise[3] - rise[2];
        vf first[4] = {sum_low + sum_high, rise_low + rise_high, sum_y_low + sum_y_high, sum_high - sum_low},
           second[4] = {rise_y_low + rise_y_high, sum_y_high - sum_y_low, rise_high - rise_low,
                        rise_y_high - rise_y_low};
        if (!scratch->octant_projection.near) {
            vf shift[3];
            set_surface_box(c, flags, &scratch->record[i], shift);
            if (scratch->large) move_field(shift, first, second);
        }
        v_store4(scratch->record[i].field, RECORD_FLOATS, first);
        v_store4(scratch->record[i].field + 4, RECORD_FLOATS, second);
    }
}

/* A vector of points of an octant, projected into the picture. */
typedef struct ex_projected {
    vf place[2]; /* pixels from iso_exact_octant_projection.origin */
    vf tilt[2];  /* x / z and y / z of the ray through the point; 0 when rays are parallel */
    vf rise;     /* depth relative to the octant's centre, mm */
    vf depth;    /* mm */
} ex_projected;

/* Projects points whose index coordinates relative to the octant's centre are `at`. */
ISO_INLINE void project(const iso_exact_projection *projection,
                        const iso_exact_octant_projection *octant_projection, const vf at[3],
                        ex_projected *to) {
    to->rise = octant_projection->along[0] * at[0] + octant_projection->along[1] * at[1] +
               octant_projection->along[2] * at[2];
    to->depth = octant_projection->depth + to->rise;
    const vf inverse = projection->perspective ? 1 / to->depth : v_set(1);
    for (int k = 0; k < 2; k++) {
        const float *sheared = octant_projection->sheared[k];
        const vf across = sheared[0] * at[0] + sheared[1] * at[1] + sheared[2] * at[2];
        const vf off = (octant_projection->residue[k] + across) * inverse;
        to->place[k] = octant_projection->place[k] + octant_projection->focal * off;
        to->tilt[k] = projection->perspective ? octant_projection->reference[k] + off : v_set(0);
    }
}

/* Sets scratch->box of the vector of cells from number i on: the pixels that the boxes with the half extents
 * `half` (half voxels) around the projected points `at` can cover. The bound is the linear part of the
 * projection, divided by the smallest depth in the cell. */
ISO_INLINE void set_boxes(const iso_exact_projection *projection, iso_exact_scratch *scratch, int i,
                          const ex_projected *at, const vf half[3]) {
    const iso_exact_octant_projection *octant_projection = &scratch->octant_projection;
    const vf nearest = projection->perspective ? at->depth - (float)projection->half_depth : v_set(1),
             pixels = 0.5f * octant_projection->focal / nearest;
    for (int k = 0; k < 2; k++) {
        vf reach = v_set(0);
        for (int axis = 0; axis < 3; axis++)
            reach +=
                v_abs(octant_projection->across[k][axis] - at->tilt[k] * octant_projection->along[axis]) *
                half[axis];
        reach = reach * pixels * 1.001f + 0.002f;
        const vf lowest = v_set((float)(scratch->clip[2 * k] - octant_projection->origin[k])),
                 highest = v_set((float)(scratch->clip[2 * k + 1] - octant_projection->origin[k]));
        const vf low = v_min(v_max(at->place[k] - reach, lowest), highest + 1),
                 high = v_max(v_min(at->place[k] + reach, highest), lowest - 1);
        v_storei(scratch->box[2 * k] + i, octant_projection->origin[k] - v_floor(-low));
        v_storei(scratch->box[2 * k + 1] + i, octant_projection->origin[k] + v_floor(high));
    }
}

/* Sets scratch->record and scratch->box of the cells of an octant so far from the eye that floats relative to
 * the octant's centre are precise enough. */
ISO_STEP static void project_far_cells(const iso_exact_projection *projection, iso_exact_scratch *scratch) {
    const iso_exact_octant_projection *octant_projection = &scratch->octant_projection;
    const vf zero = v_set(0), per_focal = v_set((float)(1 / projection->target->view->focal));
    for (int i = 0; i < scratch->octant->cells; i += ISO_LANES) {
        const vi position = v_load_u16(scratch->position + i);
        const vf at[3] = {v_to_float(position & 7) - 3.5f, v_to_float(position >> 3 & 7) - 3.5f,
                          v_to_float(position >> 6) - 3.5f};
        int32_t index[ISO_LANES];
        vf box_of[8], middle[3];
        v_storei(index, v_lanes() * RECORD_FLOATS);
        v_load4(scratch->record[i].half, index, 2, box_of);
        for (int axis = 0; axis < 3; axis++) middle[axis] = at[axis] + 0.5f * box_of[4 + axis];
        ex_projected centre, box;
        project(projection, octant_projection, middle, &box);
        set_boxes(projection, scratch, i, &box, box_of);
        centre = box;
        if (!scratch->large) project(projection, octant_projection, at, &centre);
        const vf here[4] = {centre.place[0], centre.place[1],
                            projection->perspective ? centre.depth * per_focal : per_focal,
                            octant_projection->relative + centre.rise},
                 eye[4] = {zero, zero, zero, octant_projection->behind + centre.rise};
        v_store4(scratch->record[i].place, RECORD_FLOATS, here);
        v_store4(scratch->record[i].eye, RECORD_FLOATS, eye);
    }
}

/* Sets scratch->position of the octant's crossed cells; items up to a whole vector are 0. */
ISO_STEP static void list_cells(iso_exact_scratch *scratch) {
    int count = 0;
    for (int z = 0; z < ISO_EXACT_SIDE; z++)
        for (uint64_t mask = scratch->octant->mask[z]; mask; mask &= mask - 1)
            scratch->position[count++] = (uint16_t)(z << 6 | __builtin_ctzll(mask));
    memset(scratch->position + count, 0, ISO_LANES_MAX * sizeof *scratch->position);
}

/* Sets scratch->drawable and scratch->cell_of, by front-to-back rank, for the cells that cover pixels. */
ISO_STEP static void rank_cells(const iso_exact_projection *projection, iso_exact_scratch *scratch) {
    uint16_t rank[3][ISO_EXACT_SIDE];
    for (int axis = 0; axis < 3; axis++) {
        const int split =
            projection->split[axis] - ISO_BRICK * scratch->span->brick[axis] - scratch->octant->origin[axis];
        for (int n = 0; n < ISO_EXACT_SIDE; n++)
            rank[axis][n] = (uint16_t)(iso_exact_rank(n, ISO_EXACT_SIDE, split) << 3 * axis);
    }
    memset(scratch->drawable, 0, sizeof scratch->drawable);
    const int count = scratch->octant->cells;
    for (int i = 0; i < count; i += ISO_LANES) {
        const vi x0 = v_loadi(scratch->box[0] + i), x1 = v_loadi(scratch->box[1] + i),
                 y0 = v_loadi(scratch->box[2] + i), y1 = v_loadi(scratch->box[3] + i);
        const vm seen = v_lti(v_loadi(scratch->flags + i), v_seti(ISO_EXACT_UNSEEN));
        uint32_t lanes = v_mask(v_andnot(v_andnot(seen, v_lti(x1, x0)), v_lti(y1, y0)));
        if (count - i < ISO_LANES) lanes &= (1u << (count - i)) - 1;
        for (; lanes; lanes &= lanes - 1) {
            const int cell = i + __builtin_ctz(lanes), position = scratch->position[cell];
            const int at = rank[0][position & 7] | rank[1][position >> 3 & 7] | rank[2][position >> 6];
            scratch->drawable[at >> 6] |= (uint64_t)1 << (at & 63);
            scratch->cell_of[at] = (uint16_t)cell;
        }
    }
    memset(scratch->slot, 0xff, (size_t)count * sizeof *scratch->slot);
}

#endif
