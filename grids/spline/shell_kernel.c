/* shell_kernel: lowers samples by what their trilinear interpolation may lie above the spline. */
#include "base/kernel.h"
#include "grids/spline/spline_kernel.h"

enum { OUT = ISO_SPLINE_SAMPLES, SIDE = OUT - 4, WIDE = SIDE + 2 };

/* Between two samples the interpolation of a field lies above it by an eighth of its second difference at
 * most, if this is constant; the rest is for its changes. */
static const float SHARE = 0.15f;

/* The second difference where it is positive: where the interpolation is the larger one. */
ISO_INLINE float bend(const float *f, int step) {
    const float d = (f[-step] + f[step]) - 2 * f[0];
    return d > 0 && d < 1e30f ? d : 0; /* not of samples that are not finite */
}

ISO_INLINE float larger(float a, float b) {
    return a > b ? a : b;
}

void ISO_KERNEL_NAME(iso_spline_shell_units)(float *samples) {
    float rows[WIDE][WIDE][SIDE], planes[WIDE][SIDE][SIDE];
    for (int z = 0; z < WIDE; z++)
        for (int y = 0; y < WIDE; y++) {
            const float *f = samples + ((z + 1) * OUT + y + 1) * OUT + 1;
            float sum[WIDE];
            for (int x = 0; x < WIDE; x++)
                sum[x] = (bend(f + x, 1) + bend(f + x, OUT)) + bend(f + x, OUT * OUT);
            for (int x = 0; x < SIDE; x++)
                rows[z][y][x] = larger(larger(sum[x], sum[x + 2]), sum[x + 1]);
        }
    for (int z = 0; z < WIDE; z++)
        for (int y = 0; y < SIDE; y++)
            for (int x = 0; x < SIDE; x++)
                planes[z][y][x] = larger(larger(rows[z][y][x], rows[z][y + 2][x]), rows[z][y + 1][x]);
    for (int z = 0; z < SIDE; z++)
        for (int y = 0; y < SIDE; y++)
            for (int x = 0; x < SIDE; x++)
                samples[((z + 2) * OUT + y + 2) * OUT + x + 2] -=
                    SHARE * larger(larger(planes[z][y][x], planes[z + 2][y][x]), planes[z + 1][y][x]);
}
