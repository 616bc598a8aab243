/* spline_kernel: the samples of a block of cells, one axis after the other. The loops have independent
 * iterations, which compilers turn into vectors. */
#include "grids/spline/spline_kernel.h"

#include "base/kernel.h"

enum { IN = ISO_SPLINE_INPUT, ROW = ISO_SPLINE_ROW, OUT = ISO_SPLINE_SAMPLES };

/* Two lines of `n` samples from six lines of inputs, `step` apart. */
ISO_INLINE void filter(const float *restrict in, int step, int n, const iso_spline_weights *w,
                       float *restrict at, float *restrict between) {
    const float *a = w->at, *b = w->between;
    for (int i = 0; i < n; i++) {
        const float f0 = in[i], f1 = in[i + step], f2 = in[i + 2 * step], f3 = in[i + 3 * step],
                    f4 = in[i + 4 * step], f5 = in[i + 5 * step];
        at[i] = (a[0] * f0 + a[4] * f4) + (a[1] * f1 + a[3] * f3) + a[2] * f2;
        between[i] = (b[0] * f0 + b[5] * f5) + (b[1] * f1 + b[4] * f4) + (b[2] * f2 + b[3] * f3);
    }
}

void ISO_KERNEL_NAME(iso_spline_sample_units)(const float *input, const iso_spline_weights *weights,
                                              float *samples) {
    float planes[OUT][IN * ROW], rows[OUT][ROW];
    for (int z = 0; z < OUT / 2; z++)
        filter(input + z * IN * ROW, IN * ROW, IN * ROW, weights, planes[2 * z], planes[2 * z + 1]);
    for (int z = 0; z < OUT; z++) {
        for (int y = 0; y < OUT / 2; y++)
            filter(planes[z] + y * ROW, ROW, ROW, weights, rows[2 * y], rows[2 * y + 1]);
        for (int y = 0; y < OUT; y++) {
            float at[OUT / 2], between[OUT / 2], *to = samples + (z * OUT + y) * OUT;
            filter(rows[y], 1, OUT / 2, weights, at, between);
            for (int x = 0; x < OUT / 2; x++) {
                to[2 * x] = at[x];
                to[2 * x + 1] = between[x];
            }
        }
    }
}
