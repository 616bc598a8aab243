/* redistance_kernel: restores distances in the bricks that an edit has changed (redistance.h). */
#include <string.h>

#include "base/simd.h"
#include "sculpt/field/redistance.h"
#include "sculpt/field/stencil_simd.h"

ISO_INLINE vm is_inside(vf value) {
    return v_lt(value, v_set(0));
}

ISO_INLINE vm differ(vm a, vm b) {
    return v_or(v_andnot(a, b), v_andnot(b, a));
}

/* Returns the changed bits of the row that lies `step` rows (+-1: along y, +-16: along z) after `row`. `bits`
 * are those of the brick across the face, where that row may lie. */
ISO_INLINE uint32_t row_beside(const iso_voxel_bits *self, const iso_voxel_bits *bits, int row, int step) {
    const int axis_step = step < 0 ? -step : step, at = row / axis_step % ISO_BRICK;
    const int end = step < 0 ? 0 : ISO_BRICK - 1, back = step < 0 ? ISO_BRICK - 1 : 1 - ISO_BRICK;
    return at == end ? bits->row[row + back * axis_step] : self->row[row + step];
}

static bool find_seam(const iso_stencil *phi, const iso_changed_stencil *side, iso_voxel_bits *seam) {
    enum { LAST = ISO_BRICK - 1 };
    uint32_t any = 0;
    memset(seam, 0, sizeof *seam);
    for (int row = 0; row < ISO_BRICK_ROWS; row++) {
        const uint32_t changed = side->self->row[row];
        if (!changed) continue;
        const uint32_t low[3] = {(changed << 1 & 0xffff) | side->face[0]->row[row] >> LAST,
                                 row_beside(side->self, side->face[2], row, -1),
                                 row_beside(side->self, side->face[4], row, -ISO_BRICK)},
                       high[3] = {changed >> 1 | (side->face[1]->row[row] & 1u) << LAST,
                                  row_beside(side->self, side->face[3], row, 1),
                                  row_beside(side->self, side->face[5], row, ISO_BRICK)};
        const uint32_t all = low[0] & low[1] & low[2] & high[0] & high[1] & high[2];
        if (!(changed & ~all)) continue;
        uint32_t bits = 0;
        for (int x = 0; x < ISO_BRICK; x += ISO_LANES) {
            const row_site site = site_of(phi, row, x);
            const voxel_faces f = faces_of(&site);
            vm fine = v_from_mask(~0u);
            for (int axis = 0; axis < 3; axis++) {
                const vm below = v_or(v_eq(f.low[axis], v_set(side->far_value)), v_from_mask(low[axis] >> x)),
                         above =
                             v_or(v_eq(f.high[axis], v_set(side->far_value)), v_from_mask(high[axis] >> x));
                fine = v_and(fine, v_and(below, above));
            }
            bits |= v_mask(v_andnot(v_from_mask(changed >> x), fine)) << x;
        }
        seam->row[row] = (uint16_t)bits;
        any |= bits;
    }
    return any != 0;
}

static uint32_t sides(const float *values) {
    vm outside = v_from_mask(0), inside = v_from_mask(0);
    for (int row = 0; row < ISO_BRICK_ROWS; row += ISO_BRICK) {
        for (int i = 0; i < ISO_BRICK_ROWS; i += ISO_LANES) {
            const vm in = is_inside(v_load(values + row * ISO_BRICK + i));
            inside = v_or(inside, in);
            outside = v_or(outside, v_andnot(v_from_mask(~0u), in));
        }
        if (v_mask(inside) && v_mask(outside)) break;
    }
    return (uint32_t)(v_mask(outside) != 0) | (uint32_t)(v_mask(inside) != 0) << 1;
}

static void classify(const iso_stencil *phi, float band, const iso_row_bits *rows, iso_band_state *state) {
    memset(state, 0, sizeof *state);
    for (int row = 0; row < ISO_BRICK_ROWS; row++) {
        uint32_t fixed = 0, unknown = 0, active = 0;
        if (!(rows->word[row / 32] >> (row % 32) & 1)) continue;
        for (int x = 0; x < ISO_BRICK; x += ISO_LANES) {
            const row_site site = site_of(phi, row, x);
            const voxel_faces f = faces_of(&site);
            vf least = v_abs(f.self);
            const vm inside = is_inside(f.self);
            vm edge = v_from_mask(0);
            for (int axis = 0; axis < 3; axis++) {
                least = v_min(least, v_min(v_abs(f.low[axis]), v_abs(f.high[axis])));
                edge = v_or(edge, v_or(differ(inside, is_inside(f.low[axis])),
                                       differ(inside, is_inside(f.high[axis]))));
            }
            active |= v_mask(v_lt(least, v_set(band)));
            fixed |= v_mask(edge) << x;
            unknown |= v_mask(v_andnot(edge, v_lt(v_abs(f.self), v_set(band)))) << x;
        }
        state->fixed.row[row] = (uint16_t)fixed;
        state->unknown.row[row] = (uint16_t)unknown;
        if (active) state->active.word[row / 32] |= 1u << (row % 32);
    }
}

/* Returns the length of the gradient from one-sided differences towards the interface. */
ISO_INLINE vf upwind_length(const voxel_faces *f) {
    const vf sign = v_select(is_inside(f->self), v_set(-1), v_set(1)), u = sign * f->self;
    vf square = v_set(0);
    for (int axis = 0; axis < 3; axis++) {
        const vf g = v_max(v_max(u - sign * f->low[axis], u - sign * f->high[axis]), v_set(0));
        square += g * g;
    }
    return v_sqrt(square);
}

/* Returns the length of the gradient from central differences. In a sheet of one or two voxels these cancel;
 * where they are much smaller than the one-sided differences, the latter are used. */
ISO_INLINE vf gradient_length(const voxel_faces *f) {
    vf square = v_set(0);
    for (int axis = 0; axis < 3; axis++) {
        const vf g = f->high[axis] - f->low[axis];
        square += g * g;
    }
    const vf central = v_set(0.5f) * v_sqrt(square), upwind = upwind_length(f);
    const vf chosen = v_select(v_lt(central, v_set(0.85f) * upwind), upwind, central);
    return v_max(chosen, v_set(0.05f));
}

static void rescale(const iso_stencil *phi, const iso_band_state *state, const iso_voxel_bits *changed,
                    float *out) {
    memcpy(out, phi->self, ISO_BRICK_VOXELS * sizeof(float));
    for (int row = 0; row < ISO_BRICK_ROWS; row++) {
        const uint32_t chosen = (state->fixed.row[row] & changed->row[row]) | state->unknown.row[row];
        if (!chosen) continue;
        for (int x = 0; x < ISO_BRICK; x += ISO_LANES) {
            const row_site site = site_of(phi, row, x);
            const voxel_faces f = faces_of(&site);
            const vf scaled = f.self / gradient_length(&f);
            v_store(out + site.at, v_select(v_from_mask(chosen >> x), scaled, f.self));
        }
    }
}

/* For neighbours with the surface between them: adds to *sum the distance that keeps the position of the
 * edge point (CR-2), and 1 to *count. phi: values before rescaling, d: after it. */
ISO_INLINE void add_edge_point(vf phi, vf phi_beside, vf d, vf d_beside, vf *sum, vf *count) {
    const vm crossed = differ(is_inside(phi), is_inside(phi_beside));
    const vf gap = v_select(crossed, phi - phi_beside, v_set(1));
    *sum += v_select(crossed, phi / gap * (d - d_beside), v_set(0));
    *count += v_select(crossed, v_set(1), v_set(0));
}

static void correct(const iso_stencil *phi, const iso_stencil *scaled, const iso_band_state *state,
                    const iso_voxel_bits *changed, float *out) {
    memcpy(out, scaled->self, ISO_BRICK_VOXELS * sizeof(float));
    for (int row = 0; row < ISO_BRICK_ROWS; row++) {
        const uint32_t chosen = (state->fixed.row[row] & changed->row[row]) | state->unknown.row[row];
        if (!chosen) continue;
        for (int x = 0; x < ISO_BRICK; x += ISO_LANES) {
            const row_site here = site_of(phi, row, x), there = site_of(scaled, row, x);
            const voxel_faces f = faces_of(&here), d = faces_of(&there);
            vf sum = v_set(0), count = v_set(0);
            for (int axis = 0; axis < 3; axis++) {
                add_edge_point(f.self, f.low[axis], d.self, d.low[axis], &sum, &count);
                add_edge_point(f.self, f.high[axis], d.self, d.high[axis], &sum, &count);
            }
            const vm use = v_and(v_from_mask(chosen >> x), v_lt(v_set(0), count));
            v_store(out + here.at, v_select(use, sum / v_max(count, v_set(1)), d.self));
        }
    }
}

/* Returns the argument that is nearer to zero, or 0 if the arguments differ in sign. */
ISO_INLINE vf min_mod(vf a, vf b) {
    const vf zero = v_set(0);
    return v_max(v_min(a, b), zero) + v_min(v_max(a, b), zero);
}

/* Returns the square of Godunov's upwind difference of second order along an axis. near, far: the neighbours
 * at a distance of 1 and 2 voxels. All values are multiplied by the sign of u, so that u is positive. */
ISO_INLINE vf upwind_square(vf u, voxel_pair near, voxel_pair far) {
    const vf twice = u + u, half = v_set(0.5f);
    const vf middle = near.low + near.high - twice;
    const vf low = far.low - (near.low + near.low) + u, high = far.high - (near.high + near.high) + u;
    const vf a = u - near.low + half * min_mod(middle, low);
    const vf b = u - near.high + half * min_mod(middle, high);
    const vf g = v_max(v_max(a, b), v_set(0));
    return g * g;
}

ISO_INLINE voxel_pair signed_pair(vf low, vf high, vi sign) {
    voxel_pair pair;
    pair.low = v_floats(v_bits(low) ^ sign);
    pair.high = v_floats(v_bits(high) ^ sign);
    return pair;
}

/* Returns the values of ISO_LANES voxels after one step: u - 0.45 (|grad u| - 1), clamped. */
ISO_INLINE vf relaxed_value(const row_site *site, float band) {
    const vf self = v_load(site->stencil->self + site->at);
    const vi sign = v_selecti(is_inside(self), v_seti(INT32_MIN), v_seti(0));
    const vf u = v_floats(v_bits(self) ^ sign);
    const voxel_pair x = load_along_x(site), y1 = load_along_y(site, 1), y2 = load_along_y(site, 2),
                     z1 = load_along_z(site, 1), z2 = load_along_z(site, 2);
    vf square = upwind_square(u, signed_pair(v_last1(x.low, self), v_next1(self, x.high), sign),
                              signed_pair(v_last2(x.low, self), v_next2(self, x.high), sign));
    square += upwind_square(u, signed_pair(y1.low, y1.high, sign), signed_pair(y2.low, y2.high, sign));
    square += upwind_square(u, signed_pair(z1.low, z1.high, sign), signed_pair(z2.low, z2.high, sign));
    vf next = u - v_set(0.45f) * (v_sqrt(square) - v_set(1));
    next = v_min(v_max(next, v_set(0.01f)), v_set(band)); /* the sign never changes */
    return v_floats(v_bits(next) ^ sign);
}

static void relax(const iso_stencil *phi, const iso_voxel_bits *fixed, const iso_relaxation *step, float *out,
                  iso_row_bits *moved) {
    memset(moved, 0, sizeof *moved);
    for (int row = 0; row < ISO_BRICK_ROWS; row++) {
        const uint32_t bit = 1u << (row % 32);
        if (step->due.word[row / 32] & bit) {
            uint32_t moving = 0;
            for (int x = 0; x < ISO_BRICK; x += ISO_LANES) {
                const row_site site = site_of(phi, row, x);
                const vf self = v_load(phi->self + site.at), next = relaxed_value(&site, step->band);
                const vf made = v_select(v_from_mask((uint32_t)fixed->row[row] >> x), self, next);
                v_store(out + site.at, made);
                moving |= v_mask(v_lt(v_set(step->least), v_abs(made - self)));
            }
            if (moving) moved->word[row / 32] |= bit;
        } else if (step->stale.word[row / 32] & bit)
            memcpy(out + row * ISO_BRICK, phi->self + row * ISO_BRICK, ISO_BRICK * sizeof *out);
    }
}

const iso_redistancer ISO_KERNEL_NAME(iso_redistancer) = {find_seam, sides,   classify,
                                                          rescale,   correct, relax};
