/* filter: Gaussian kernels, and convolution along rows and along columns. */
#include "compare/filter.h"

#include <assert.h>
#include <math.h>
#include <string.h>

iso_kernel iso_kernel_gaussian(double sigma, int radius, double sum) {
    assert(radius >= 0 && radius <= ISO_KERNEL_RADIUS && sigma > 0);
    iso_kernel kernel = {.radius = radius};
    double weights[2 * ISO_KERNEL_RADIUS + 1], total = 0;
    for (int k = -radius; k <= radius; k++) {
        weights[radius + k] = exp(-(double)k * k / (2 * sigma * sigma));
        total += weights[radius + k];
    }
    for (int k = 0; k <= 2 * radius; k++) kernel.taps[k] = (float)(weights[k] * sum / total);
    return kernel;
}

/* Sets out[x] to tap * in[x], or adds it unless `first`. Tap by tap, so that sums do not depend on the vector
 * width. */
static void accumulate(const float *in, float tap, int width, int first, float *out) {
    if (first)
        for (int x = 0; x < width; x++) out[x] = tap * in[x];
    else
        for (int x = 0; x < width; x++) out[x] += tap * in[x];
}

void iso_filter_rows(const iso_kernel *kernel, const float *in, int width, int rows, float *padded,
                     float *out) {
    int radius = kernel->radius;
    for (int y = 0; y < rows; y++, in += width, out += width) {
        memcpy(padded + radius, in, (size_t)width * sizeof *in);
        for (int k = 0; k < radius; k++) {
            padded[k] = in[0];
            padded[radius + width + k] = in[width - 1];
        }
        for (int k = 0; k <= 2 * radius; k++) accumulate(padded + k, kernel->taps[k], width, k == 0, out);
    }
}

void iso_filter_columns(const iso_kernel *kernel, const float *in, int width, int rows, float *out) {
    for (int y = 0; y < rows; y++, in += width, out += width)
        for (int k = 0; k <= 2 * kernel->radius; k++)
            accumulate(in + (size_t)k * (size_t)width, kernel->taps[k], width, k == 0, out);
}
