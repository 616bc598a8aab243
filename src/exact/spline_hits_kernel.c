/* spline_hits_kernel: the polynomial of a cell, and its roots along rays near where they are expected. */
#include "exact/spline_hits_kernel.h"

#include <string.h>

#include "base/simd.h"

enum { EDGE = 6, TAPS = ISO_SPLINE_TAPS, TERMS = ISO_SPLINE_COEFFICIENTS, STEPS = 6 };

/* Steps of Newton's method end when one is shorter than this, voxels. */
static const float SMALL = 1e-3f;
/* So far outside the cell its polynomial is as good as that of the next one. */
static const float BESIDE = 0.02f;

/* Filters `n` lines of 6 items, `step` apart, to 4. */
ISO_INLINE void prefilter(const float *in, float *out, int step, int n) {
    for (int i = 0; i < TAPS; i++)
        for (int k = 0; k < n; k++)
            out[i * step + k] =
                (8 * in[(i + 1) * step + k] - (in[i * step + k] + in[(i + 2) * step + k])) * (1 / 6.f);
}

/* The coefficients from the 6^3 voxels. */
static void find_coefficients(const float *v, float c[TERMS]) {
    float planes[TAPS * EDGE * EDGE], rows[TAPS * TAPS * EDGE];
    prefilter(v, planes, EDGE * EDGE, EDGE * EDGE);
    for (int z = 0; z < TAPS; z++) prefilter(planes + z * EDGE * EDGE, rows + z * TAPS * EDGE, EDGE, EDGE);
    for (int row = 0; row < TAPS * TAPS; row++) prefilter(rows + row * EDGE, c + row * TAPS, 1, 1);
}

/* Turns lines of four B-spline coefficients, `step` apart, into powers of the position in the cell. */
ISO_INLINE void to_powers(float *c, int step, int n) {
    for (int k = 0; k < n; k++) {
        const float c0 = c[k], c1 = c[step + k], c2 = c[2 * step + k], c3 = c[3 * step + k];
        c[k] = ((c0 + c2) + 4 * c1) * (1 / 6.f);
        c[step + k] = (c2 - c0) * 0.5f;
        c[2 * step + k] = ((c0 + c2) - 2 * c1) * 0.5f;
        c[3 * step + k] = ((c3 - c0) + 3 * (c1 - c2)) * (1 / 6.f);
    }
}

static void find_powers(float c[TERMS]) {
    to_powers(c, 16, 16);
    for (int z = 0; z < TAPS; z++) to_powers(c + 16 * z, 4, 4);
    for (int row = 0; row < TAPS * TAPS; row++) to_powers(c + 4 * row, 1, 1);
}

/* Value and gradient at positions p, by Horner's scheme. */
ISO_INLINE void evaluate(const float c[TERMS], const vf p[3], vf *value, vf gradient[3]) {
    const vf x = p[0], y = p[1], z = p[2];
    vf f = v_set(0), fx = f, fy = f, fz = f;
    for (int k = TAPS - 1; k >= 0; k--) {
        vf g = v_set(0), gx = g, gy = g;
        for (int j = TAPS - 1; j >= 0; j--) {
            const float *a = c + k * 16 + j * 4;
            vf slope = v_set(a[3]), row = slope * x + a[2];
            slope = slope * x + row;
            row = row * x + a[1];
            slope = slope * x + row;
            row = row * x + a[0];
            gy = gy * y + g;
            g = g * y + row;
            gx = gx * y + slope;
        }
        fz = fz * z + f;
        f = f * z + g;
        fx = fx * z + gx;
        fy = fy * z + gy;
    }
    *value = f;
    gradient[0] = fx;
    gradient[1] = fy;
    gradient[2] = fz;
}

ISO_INLINE void load3(const float from[3][ISO_SPLINE_HITS], int first, vf to[3]) {
    for (int axis = 0; axis < 3; axis++) to[axis] = v_load(from[axis] + first);
}

ISO_INLINE vf dot(const vf a[3], const vf b[3]) {
    return (a[0] * b[0] + a[1] * b[1]) + a[2] * b[2];
}

/* The shifts with which rays enter and leave the cell. */
ISO_INLINE void find_ends(const vf at[3], const vf step[3], vf *enter, vf *leave) {
    *enter = v_set(-1e30f);
    *leave = v_set(1e30f);
    for (int axis = 0; axis < 3; axis++) {
        const vf low = (v_set(-BESIDE) - at[axis]) / step[axis],
                 high = (v_set(1 + BESIDE) - at[axis]) / step[axis];
        *enter = v_max(v_min(low, high), *enter); /* not by a NaN */
        *leave = v_min(v_max(high, low), *leave);
    }
}

/* Moves a vector of hits. A hit that has arrived does not change while others go on. */
ISO_INLINE void move(iso_spline_hits *h, const float c[TERMS], const float smoothed[TERMS], int first) {
    vf at[3], step[3], p[3], value, gradient[3], best[3], enter, leave, shift = v_set(0);
    vf toward = v_load(h->toward + first);
    load3(h->at, first, at);
    load3(h->step, first, step);
    find_ends(at, step, &enter, &leave);
    const vf square = dot(step, step);
    vm active = v_le(shift, shift), arrived = v_lt(shift, shift), beside = arrived;
    for (int axis = 0; axis < 3; axis++) best[axis] = shift;
    for (int k = 0; k < STEPS && v_mask(active); k++) {
        for (int axis = 0; axis < 3; axis++) p[axis] = at[axis] + shift * step[axis];
        evaluate(c, p, &value, gradient);
        const vf slope = dot(gradient, step), last = v_set(0) - value / slope, next = shift + last;
        toward = v_select(v_eq(toward, v_set(0)), slope, toward);
        for (int axis = 0; axis < 3; axis++) best[axis] = v_select(active, gradient[axis], best[axis]);
        /* A ray that leaves the solid where it should enter it has entered it before, or somewhere else. */
        active = v_and(active, v_lt(v_set(0), toward * slope));
        const vm within = v_and(v_le(enter, next), v_le(next, leave)),
                 small = v_and(within, v_lt(last * last * square, v_set(SMALL * SMALL)));
        shift = v_select(active, v_max(v_min(next, leave), enter), shift);
        arrived = v_or(arrived, v_and(active, small));
        beside = v_or(beside, v_andnot(active, within));
        active = v_andnot(v_and(active, within), small);
    }
    for (int axis = 0; axis < 3; axis++) p[axis] = at[axis] + shift * step[axis];
    if (smoothed) evaluate(smoothed, p, &value, best);
    for (int axis = 0; axis < 3; axis++) v_store(h->gradient[axis] + first, best[axis]);
    v_store(h->shift + first, shift);
    v_storei(h->state + first,
             v_selecti(arrived, v_seti(ISO_SPLINE_MOVED),
                       v_selecti(beside, v_seti(ISO_SPLINE_AGAIN), v_seti(ISO_SPLINE_LOST))));
    v_store(h->toward + first, toward);
}

void ISO_KERNEL_NAME(iso_spline_hits_units)(iso_spline_hits *h) {
    float c[TERMS];
    for (int i = 0; i < (h->prefilter ? ISO_SPLINE_VOXELS : TERMS); i++) h->values[i] -= h->isovalue;
    if (h->prefilter)
        find_coefficients(h->values, c);
    else
        memcpy(c, h->values, sizeof c);
    find_powers(c);
    if (h->smooths) find_powers(h->smoothed);
    for (int i = h->count; i % 16; i++) {
        h->toward[i] = 0;
        for (int axis = 0; axis < 3; axis++) {
            h->at[axis][i] = h->at[axis][h->count - 1];
            h->step[axis][i] = h->step[axis][h->count - 1];
        }
    }
    for (int i = 0; i < h->count; i += ISO_LANES) move(h, c, h->smooths ? h->smoothed : NULL, i);
}
