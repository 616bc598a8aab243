/* histogram_kernel: range, padding and histogram bins of a row of float voxels, a vector at a time. The same
 * results for each instruction set. Internal to extract. */
#ifndef ISO_EXTRACT_ISOVALUE_HISTOGRAM_KERNEL_H
#define ISO_EXTRACT_ISOVALUE_HISTOGRAM_KERNEL_H

#include <stdint.h>

#include "base/cpu.h"

/* The lowest and highest finite value of a row; if there is none, +infinity and -infinity. */
typedef struct iso_row_range {
    float lowest, highest;
    int finite; /* how many voxels are neither NaN nor infinite */
} iso_row_range;

/* Counts the voxels of a row that may be padding: those with the volume's lowest or highest value. */
typedef struct iso_row_padding {
    float low, high,
        padding; /* input: the volume's lowest and highest value; the one of them that is padding */
    float above_low, below_high; /* output: the row's values next to low and high; infinite: none */
    int count;                   /* output: number of voxels with the value `padding` */
} iso_row_padding;

/* 256 bins of equal width between two values. */
enum { ISO_BIN_OUTSIDE = 256 /* for values not between low and high, or not finite */ };
typedef struct iso_bin_range {
    double low, high, per_value; /* bin = (value - low) * per_value, at most 255 */
} iso_bin_range;

typedef struct iso_histogram_kernels {
    /* Each works on `count` values of a row. bins: writes the bin of each value, or ISO_BIN_OUTSIDE. */
    void (*range)(const float *values, int count, iso_row_range *range);
    void (*padding)(const float *values, int count, iso_row_padding *padding);
    void (*bins)(const iso_bin_range *range, const float *values, int count, int32_t *bins);
} iso_histogram_kernels;
ISO_KERNEL_UNITS(const iso_histogram_kernels, iso_histogram_kernels);

#endif
