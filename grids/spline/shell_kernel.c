/* shell_kernel: lowers samples by what their trilinear interpolation may lie above the spline. */
#include "base/kernel.h"
#include "grids/spline/spline_kernel.h"

enum { OUT = ISO_SPLINE_SAMPLES, SIDE = OUT - 4 };

/* Where the second derivative f'' changes linearly between two samples, the linear interpolation of f lies
 * above it by less than that of f'' / 6 (the spacing is 1). The rest is for what changes across. */
static const float SHARE = 0.14f;

ISO_INLINE float larger(float a, float b) {
    return a > b ? a : b;
}

/* The second derivative where it is positive: where the interpolation is the larger one. Second differences
 * are its means, and at a knot of the spline, where it has a peak, smaller. */
ISO_INLINE float bend(const float *f, int step) {
    const float at = (f[-step] + f[step]) - 2 * f[0], before = (f[-2 * step] + f[0]) - 2 * f[-step],
                after = (f[0] + f[2 * step]) - 2 * f[step];
    const float d = larger(at, 1.5f * at - 0.25f * (before + after));
    return d > 0 && d < 1e30f ? d : 0; /* not of samples that are not finite */
}

void ISO_KERNEL_NAME(iso_spline_shell_units)(const float *samples, float *lowered) {
    for (int z = 0; z < SIDE; z++)
        for (int y = 0; y < SIDE; y++) {
            const float *f = samples + ((z + 2) * OUT + y + 2) * OUT + 2;
            float *to = lowered + (z * SIDE + y) * SIDE;
            for (int x = 0; x < SIDE; x++)
                to[x] = f[x] - SHARE * ((bend(f + x, 1) + bend(f + x, OUT)) + bend(f + x, OUT * OUT));
        }
}
