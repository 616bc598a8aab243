/* histogram_kernel: ranges, padding and bins of the values of a row. */
#include "extract/isovalue/histogram_kernel.h"

#include "base/simd.h"

/* A vector of `count` values; the lanes of missing values are NaN, which no comparison counts. */
ISO_INLINE vf load_some(const float *values, int count) {
    if (count >= ISO_LANES) return v_load(values);
    float some[ISO_LANES];
    for (int i = 0; i < ISO_LANES; i++) some[i] = i < count ? values[i] : NAN;
    return v_load(some);
}

static void row_range(const float *values, int count, iso_row_range *range) {
    vf lowest = v_set(INFINITY), highest = v_set(-INFINITY);
    int finite = 0;
    for (int i = 0; i < count; i += ISO_LANES) {
        const vf value = load_some(values + i, count - i);
        const vm is_finite = v_lt(v_abs(value), v_set(INFINITY));
        lowest = v_min(v_select(is_finite, value, v_set(INFINITY)), lowest);
        highest = v_max(v_select(is_finite, value, v_set(-INFINITY)), highest);
        finite += __builtin_popcount(v_mask(is_finite));
    }
    float low[ISO_LANES], high[ISO_LANES];
    v_store(low, lowest);
    v_store(high, highest);
    *range = (iso_row_range){INFINITY, -INFINITY, finite};
    for (int i = 0; i < ISO_LANES; i++) {
        if (low[i] < range->lowest) range->lowest = low[i];
        if (high[i] > range->highest) range->highest = high[i];
    }
}

static void row_padding(const float *values, int count, iso_row_padding *padding) {
    const vf low = v_set(padding->low), high = v_set(padding->high), wanted = v_set(padding->padding);
    vf above = v_set(INFINITY), below = v_set(-INFINITY);
    padding->count = 0;
    for (int i = 0; i < count; i += ISO_LANES) {
        const vf value = load_some(values + i, count - i);
        above = v_min(v_select(v_lt(low, value), value, v_set(INFINITY)), above);
        below = v_max(v_select(v_lt(value, high), value, v_set(-INFINITY)), below);
        padding->count += __builtin_popcount(v_mask(v_eq(value, wanted)));
    }
    float inner[2][ISO_LANES];
    v_store(inner[0], above);
    v_store(inner[1], below);
    padding->above_low = INFINITY;
    padding->below_high = -INFINITY;
    for (int i = 0; i < ISO_LANES; i++) {
        if (inner[0][i] < padding->above_low) padding->above_low = inner[0][i];
        if (inner[1][i] > padding->below_high) padding->below_high = inner[1][i];
    }
}

/* The `bins` of iso_histogram_kernels, in double and without vector types, as compilers vectorize this
 * loop. */
static void row_bins(const iso_bin_range *range, const float *values, int count, int32_t *bins) {
    const double low = range->low, high = range->high, per_value = range->per_value;
    for (int i = 0; i < count; i++) {
        const double value = values[i], bin = (value - low) * per_value;
        const double inside = bin < ISO_BIN_OUTSIDE - 1 ? bin : ISO_BIN_OUTSIDE - 1;
        bins[i] = (int32_t)(((value >= low) & (value <= high)) ? inside : ISO_BIN_OUTSIDE);
    }
}

const iso_histogram_kernels ISO_KERNEL_NAME(iso_histogram_kernels) = {row_range, row_padding, row_bins};
