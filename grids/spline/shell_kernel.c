/* shell_kernel: which side samples are on, and a shell: samples lowered by what their trilinear interpolation
 * may lie above the spline. */
#include <float.h>

#include "base/simd.h"
#include "grids/spline/spline_kernel.h"

enum { OUT = ISO_SPLINE_SAMPLES, SIDE = OUT - 4, ALL = OUT * OUT * OUT };

/* Where the second derivative f'' is the same at two samples, their linear interpolation lies above f by up
 * to f'' / 8 (the spacing is 1). The rest is for its changes. */
static const float SHARE = 0.14f;

/* Turns samples into values that are negative inside. A voxel of a scan that equals the isovalue is inside,
 * and 0 is outside. */
static void set_sides(iso_spline_shell *s) {
    const vf isovalue = v_set(s->isovalue), zero = v_set(0);
    s->inside = s->outside = 0;
    for (int i = 0; i < ALL; i += ISO_LANES) {
        const vf above = v_load(s->samples + i) - isovalue;
        const vf value = s->level_set ? above : v_select(v_eq(above, zero), v_set(-FLT_MIN), zero - above);
        v_store(s->samples + i, value);
        s->inside += __builtin_popcount(v_mask(v_lt(value, zero)));
        s->outside += __builtin_popcount(v_mask(v_le(zero, value)));
    }
}

/* The second derivative where it is positive: where the interpolation is the larger one. Second differences
 * are its means, and at a knot of the spline, where it has a peak, smaller. */
ISO_INLINE vf bend(const float *f, int step) {
    const vf f0 = v_load(f), below = v_load(f - step), over = v_load(f + step);
    const vf at = (below + over) - 2 * f0, before = (v_load(f - 2 * step) + f0) - 2 * below,
             after = (f0 + v_load(f + 2 * step)) - 2 * over;
    const vf d = v_max(at, 1.5f * at - 0.25f * (before + after));
    return v_select(v_and(v_lt(v_set(0), d), v_lt(d, v_set(1e30f))), d, v_set(0)); /* finite ones */
}

void ISO_KERNEL_NAME(iso_spline_shell_units)(iso_spline_shell *s) {
    set_sides(s);
    if (!s->values || s->inside == ALL) return;
    s->lowered = 0;
    for (int row = 0; row < SIDE * SIDE; row++)
        for (int x = 0; x < SIDE; x += ISO_LANES) {
            const float *f = s->samples + ((row / SIDE + 2) * OUT + row % SIDE + 2) * OUT + 2 + x;
            const vf value = v_load(f) - SHARE * ((bend(f, 1) + bend(f, OUT)) + bend(f, OUT * OUT));
            v_store(s->values + row * SIDE + x, value);
            s->lowered += __builtin_popcount(v_mask(v_lt(value, v_set(0))));
        }
}
