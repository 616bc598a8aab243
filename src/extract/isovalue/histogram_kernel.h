/* histogram_kernel: what a histogram of floats needs to know of a row of voxels, a vector at a time, for each
 * instruction set with the same results. Internal to extract. */
#ifndef ISO_EXTRACT_ISOVALUE_HISTOGRAM_KERNEL_H
#define ISO_EXTRACT_ISOVALUE_HISTOGRAM_KERNEL_H

#include <stdint.h>

#include "base/cpu.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The lowest and highest finite value of a row, infinite (lowest > highest) when there is none. */
typedef struct iso_row_range {
    float lowest, highest;
    int finite; /* how many voxels are neither NaN nor infinite */
} iso_row_range;

/* What a row says about a value that may be padding. */
typedef struct iso_row_padding {
    float low, high, padding;    /* in: the volume's lowest and highest value, and which of them it is */
    float above_low, below_high; /* out: the next values inwards; infinite when there are none */
    int count;                   /* out: voxels of the padding's value */
} iso_row_padding;

/* Bins of equal width between two values. */
enum { ISO_BIN_OUTSIDE = 256 /* not between low and high, or not finite */ };
typedef struct iso_bin_range {
    double low, high, per_value; /* bin = (value - low) * per_value, at most 255 */
} iso_bin_range;

typedef struct iso_histogram_kernels {
    void (*range)(const float *values, int count, iso_row_range *range);
    void (*padding)(const float *values, int count, iso_row_padding *padding);
    void (*bins)(const iso_bin_range *range, const float *values, int count, int32_t *bins);
} iso_histogram_kernels;

/* At an instruction set, or at the best below it that this build has. Never NULL. */
const iso_histogram_kernels *iso_histogram_kernels_get(iso_cpu_level level);

#ifdef __cplusplus
}
#endif
#endif
