/* spline_hits_kernel: the polynomial of a cell, and its roots along rays near where they are expected.
 * All loops over hits have independent iterations, which compilers turn into vectors. */
#include "exact/spline_hits_kernel.h"

#include <math.h>
#include <string.h>

#include "base/kernel.h"

enum { EDGE = 6, TAPS = ISO_SPLINE_TAPS, TERMS = ISO_SPLINE_COEFFICIENTS, HITS = ISO_SPLINE_HITS, STEPS = 4 };

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
ISO_INLINE void evaluate(const float c[TERMS], float p[3][HITS], float value[HITS], float gradient[3][HITS]) {
    for (int i = 0; i < HITS; i++) {
        const float x = p[0][i], y = p[1][i], z = p[2][i];
        float f = 0, fx = 0, fy = 0, fz = 0;
        for (int k = TAPS - 1; k >= 0; k--) {
            float g = 0, gx = 0, gy = 0;
            for (int j = TAPS - 1; j >= 0; j--) {
                const float *a = c + k * 16 + j * 4;
                gy = gy * y + g;
                g = g * y + (((a[3] * x + a[2]) * x + a[1]) * x + a[0]);
                gx = gx * y + ((3 * a[3] * x + 2 * a[2]) * x + a[1]);
            }
            fz = fz * z + f;
            f = f * z + g;
            fx = fx * z + gx;
            fy = fy * z + gy;
        }
        value[i] = f;
        gradient[0][i] = fx;
        gradient[1][i] = fy;
        gradient[2][i] = fz;
    }
}

void ISO_KERNEL_NAME(iso_spline_hits_units)(iso_spline_hits *h) {
    float c[TERMS], p[3][HITS], value[HITS], first[3][HITS], last[HITS] = {0};
    for (int i = 0; i < (h->prefilter ? ISO_SPLINE_VOXELS : TERMS); i++) h->values[i] -= h->isovalue;
    if (h->prefilter)
        find_coefficients(h->values, c);
    else
        memcpy(c, h->values, sizeof c);
    find_powers(c);
    memset(h->shift, 0, sizeof h->shift);
    for (int step = 0; step < STEPS; step++) {
        for (int axis = 0; axis < 3; axis++)
            for (int i = 0; i < HITS; i++) p[axis][i] = h->at[axis][i] + h->shift[i] * h->step[axis][i];
        evaluate(c, p, value, h->gradient);
        if (step == 0) memcpy(first, h->gradient, sizeof first);
        for (int i = 0; i < HITS; i++) {
            const float slope = h->gradient[0][i] * h->step[0][i] + h->gradient[1][i] * h->step[1][i] +
                                h->gradient[2][i] * h->step[2][i];
            last[i] = -value[i] / slope; /* not finite: the comparisons below are false */
            h->shift[i] += last[i];
        }
    }
    for (int i = 0; i < HITS; i++) {
        const float square =
            h->step[0][i] * h->step[0][i] + h->step[1][i] * h->step[1][i] + h->step[2][i] * h->step[2][i];
        const bool converged =
            last[i] * last[i] * square < 1e-6f && h->shift[i] * h->shift[i] * square < 0.25f;
        if (!converged) h->shift[i] = 0;
        for (int axis = 0; axis < 3; axis++)
            h->gradient[axis][i] = converged ? h->gradient[axis][i] : first[axis][i];
    }
    if (!h->smooths) return;
    memcpy(c, h->smoothed, sizeof c);
    find_powers(c);
    for (int axis = 0; axis < 3; axis++)
        for (int i = 0; i < HITS; i++) p[axis][i] = h->at[axis][i] + h->shift[i] * h->step[axis][i];
    evaluate(c, p, value, h->gradient);
}
