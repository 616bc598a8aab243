/* filter: separable convolution of float planes in bands of rows, for SSIM and FLIP.
 *
 * Pictures are processed in bands of rows, so that memory does not grow with their height. A band is set up
 * together with the rows above and below that its kernels reach (the picture's outermost rows are repeated
 * beyond it), and filtered along rows, then along columns. */
#ifndef ISO_COMPARE_FILTER_H
#define ISO_COMPARE_FILTER_H

#include <stddef.h>

#include "base/parallel.h"

enum { ISO_KERNEL_RADIUS = 64, ISO_COMPARE_BAND = 32 };

/* A one-dimensional kernel: taps[radius + k] is the weight of the sample k to the right or below. */
typedef struct iso_kernel {
    int radius; /* 0 .. ISO_KERNEL_RADIUS */
    float taps[2 * ISO_KERNEL_RADIUS + 1];
} iso_kernel;

/* Makes the kernel exp(-x^2 / (2 sigma^2)) at integer x from -radius to radius, scaled so that its taps add
 * up to `sum`. */
iso_kernel iso_kernel_gaussian(double sigma, int radius, double sum);

/* out[y][x] = sum of taps[radius + k] * in[y][x + k] for `rows` rows of `width`, columns replicated beyond
 * the borders. `padded` has room for width + 2 * radius floats. in and out must not overlap. */
void iso_filter_rows(const iso_kernel *kernel, const float *in, int width, int rows, float *padded,
                     float *out);

/* out[y][x] = sum of taps[radius + k] * in[y + radius + k][x]: `in` has 2 * radius rows more than `rows`. */
void iso_filter_columns(const iso_kernel *kernel, const float *in, int width, int rows, float *out);

/* The number of bands of ISO_COMPARE_BAND rows in a picture of `height` rows; the last band may have fewer
 * rows. */
static inline size_t iso_compare_bands(int height) {
    return ((size_t)height + ISO_COMPARE_BAND - 1) / ISO_COMPARE_BAND;
}

#endif
