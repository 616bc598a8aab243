/* gaussians_kernel: composites a Gaussian, ISO_LANES samples of a row at a time. */
#include <string.h>

#include "base/exponential_simd.h"
#include "base/simd.h"
#include "render/gaussians/gaussians.h"
#include "render/gaussians/kernel.h"

/* The samples that an opaque surface does not hide. The rows of depths end where the picture ends. */
ISO_INLINE vm visible(const iso_gaussian_band *band, int row, int x, float depth) {
    const float *from = band->depth + (size_t)row * band->depth_stride + x;
    float copy[ISO_LANES];
    const int count = band->width - x;
    if (count >= ISO_LANES) return v_lt(v_set(depth), v_load(from));
    memset(copy, 0, sizeof copy);
    if (count > 0) memcpy(copy, from, (size_t)count * sizeof *copy);
    return v_lt(v_set(depth), v_load(copy));
}

/* Composites the Gaussian into samples x .. x + ISO_LANES - 1 of a row of the band (Porter and Duff 1984,
 * `over`). dy: from the centre to the row. */
ISO_INLINE void add_row(const iso_gaussian_ellipse *e, const iso_gaussian_band *band, int row, int x,
                        float dy) {
    const size_t at = (size_t)row * band->stride + (size_t)x;
    const vf dx = v_to_float(v_lanes() + (x - e->x)) - v_set(e->fx);
    const vf power = dx * (v_set(e->xx) * dx + v_set(e->xy * dy)) + v_set(e->yy * dy * dy);
    const vf opacity = v_set(e->opacity) * v_exp2(-power), through = v_load(band->through + at);
    vm shown = v_and(v_le(v_set(ISO_GAUSSIAN_LEAST), opacity), v_le(v_set(ISO_GAUSSIAN_CUT), through));
    if (band->depth) shown = v_and(shown, visible(band, row, x, e->depth));
    if (!v_mask(shown)) return;
    const vf weight = v_select(shown, opacity * through, v_set(0));
    for (int k = 0; k < 3; k++) {
        float *color = band->color[k] + at;
        v_store(color, v_load(color) + weight * v_set(e->color[k]));
    }
    v_store(band->through + at, v_select(shown, through * (v_set(1) - opacity), through));
    float *layers = band->layers + at;
    v_store(layers, v_load(layers) + v_select(shown, v_set(1), v_set(0)));
}

static void add(const iso_gaussian_ellipse *e, const iso_gaussian_band *band, int x) {
    const int first = e->first_y > band->first ? e->first_y : band->first,
              last = e->last_y < band->last ? e->last_y : band->last;
    for (int y = first; y <= last; y++) {
        const float dy = (float)(y - e->y) - e->fy;
        for (int column = x; column < x + ISO_GAUSSIAN_TILE; column += ISO_LANES)
            if (e->first_x < column + ISO_LANES && e->last_x >= column)
                add_row(e, band, y - band->first, column, dy);
    }
}

static bool finished(const iso_gaussian_band *band, int x) {
    for (int row = 0; row <= band->last - band->first; row++)
        for (int column = x; column < x + ISO_GAUSSIAN_TILE; column += ISO_LANES) {
            const vf through = v_load(band->through + (size_t)row * band->stride + (size_t)column);
            const vm open =
                v_and(v_le(v_set(ISO_GAUSSIAN_CUT), through), v_lti(v_lanes() + column, v_seti(band->width)));
            if (v_mask(open)) return false;
        }
    return true;
}

const iso_gaussian_kernel ISO_KERNEL_NAME(iso_gaussian_kernel) = {add, finished};
