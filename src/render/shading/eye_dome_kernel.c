/* eye_dome_kernel: the light of ISO_LANES samples of a row at a time. */
#include "render/shading/eye_dome_kernel.h"

#include "base/exponential_simd.h"
#include "base/simd.h"

/* What a neighbour blocks. pixels: in a millimetre at the sample's depth, by the neighbour's distance. Where
 * neither shows a surface the difference is no number and counts as 0. */
ISO_INLINE vf blocked(vf depth, const float *neighbour, vf pixels) {
    const vf slope = v_max((depth - v_load(neighbour)) * pixels, v_set(0));
    return slope / (v_set(1) + slope);
}

void ISO_KERNEL_NAME(iso_eye_dome_light_samples)(const light_rows *r, const depths around, int count,
                                                 float *part) {
    const float per_unit = (float)r->view->focal / (float)r->factor,
                strength = ISO_EYE_DOME_STRENGTH / (8 * ISO_EYE_DOME_RINGS);
    for (int x = 0; x < count; x += ISO_LANES) {
        const float *at = around[ISO_EYE_DOME_RINGS] + SIDE + x;
        const vf depth = v_load(at);
        const vf pixels = r->view->orthographic ? v_set(per_unit) : v_set(per_unit) / depth;
        vf sum = v_set(0);
        for (int ring = 0; ring < ISO_EYE_DOME_RINGS; ring++) {
            const int step = (1 << ring) * r->factor;
            const float *above = around[ISO_EYE_DOME_RINGS - 1 - ring] + SIDE + x,
                        *below = around[ISO_EYE_DOME_RINGS + 1 + ring] + SIDE + x;
            const vf straight = pixels * v_set(1.0f / (float)(1 << ring)),
                     diagonal = straight * v_set(0.707106781f);
            sum += blocked(depth, at - step, straight) + blocked(depth, at + step, straight);
            sum += blocked(depth, above, straight) + blocked(depth, below, straight);
            sum += blocked(depth, above - step, diagonal) + blocked(depth, above + step, diagonal);
            sum += blocked(depth, below - step, diagonal) + blocked(depth, below + step, diagonal);
        }
        v_store(part + x, v_exp2(sum * v_set(-strength)));
    }
}
