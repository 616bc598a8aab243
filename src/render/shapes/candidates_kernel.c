/* candidates_kernel: finds the samples near a shape at which it may be seen. */
#include "base/simd.h"
#include "render/shapes/candidates.h"

int ISO_KERNEL_NAME(iso_shapes_find_candidates)(const iso_shapes_samples *samples,
                                                const iso_shapes_stadium *o, const iso_shapes_rect *box,
                                                float nearest, int32_t *out) {
    const float square = o->dx * o->dx + o->dy * o->dy;
    const vf scale = v_set(square > 0 ? 1 / square : 0), reach = v_set(o->radius * o->radius),
             zero = v_set(0), one = v_set(1);
    int count = 0;
    for (int y = box->y0; y <= box->y1; y++) {
        const float *limit = samples->limit + (ptrdiff_t)y * samples->width;
        const vf py = v_set((float)y + 0.5f - o->y);
        for (int x = box->x0; x <= box->x1; x += ISO_LANES) {
            const vi column = v_seti(x) + v_lanes();
            const vf px = v_to_float(column) + (0.5f - o->x);
            const vf along = v_min(v_max((px * o->dx + py * o->dy) * scale, zero), one),
                     ex = px - along * o->dx, ey = py - along * o->dy;
            const vm within = v_and(v_le(ex * ex + ey * ey, reach), v_lti(column, v_seti(box->x1 + 1))),
                     found = v_and(within, v_lt(v_set(nearest), v_load(limit + x)));
            v_compressi(out + count, found, column + (int32_t)((uint32_t)y << 16));
            count += __builtin_popcount(v_mask(found));
        }
    }
    return count;
}
