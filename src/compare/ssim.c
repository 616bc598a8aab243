/* ssim: means over windows by separable filters (compare/filter.h), in bands of rows in parallel. */
#include "compare/ssim.h"

#include <math.h>

#include "base/memory.h"
#include "compare/filter.h"

enum { RADIUS = ISO_SSIM_WINDOW / 2, TALL = ISO_COMPARE_BAND + 2 * RADIUS, MOMENTS = 5 };

typedef struct ssim {
    const uint8_t *picture[2];
    int width, rows; /* size of the part of the picture in which windows lie wholly inside */
    iso_kernel window;
    float *scratch; /* per worker */
    size_t scratch_floats;
    double *sums; /* per band */
} ssim;

/* Subtracted from all values. This does not change variances, and floats are more precise around zero. */
static const float MIDDLE = 128;

static void luma(const uint8_t *rgb, size_t count, float *out) {
    for (size_t i = 0; i < count; i++)
        out[i] = 0.299f * rgb[3 * i] + 0.587f * rgb[3 * i + 1] + 0.114f * rgb[3 * i + 2] - MIDDLE;
}

/* Computes the weighted means of a, b, aa, bb and ab over windows: `rows` rows of each from rows + 2 * RADIUS
 * rows of a and b. */
static void moments(const ssim *s, float *scratch, int rows, float *out[MOMENTS]) {
    enum { ALONE = 2 };
    static const int factors[MOMENTS][2] = {{0, ALONE}, {1, ALONE}, {0, 0}, {1, 1}, {0, 1}};
    size_t plane = (size_t)s->width * TALL, count = (size_t)s->width * (size_t)(rows + 2 * RADIUS);
    float *product = scratch + 2 * plane, *along = product + plane, *padded = along + plane;
    for (int m = 0; m < MOMENTS; m++) {
        const float *in = scratch + (size_t)factors[m][0] * plane;
        if (factors[m][1] != ALONE) {
            const float *other = scratch + (size_t)factors[m][1] * plane;
            for (size_t i = 0; i < count; i++) product[i] = in[i] * other[i];
            in = product;
        }
        iso_filter_rows(&s->window, in, s->width, rows + 2 * RADIUS, padded, along);
        iso_filter_columns(&s->window, along, s->width, rows, out[m]);
    }
}

/* Returns the sum of SSIM over a row of windows. Where a and b are equal, numerator and denominator are equal
 * to the last bit. */
static double sum_row(float *const mean[MOMENTS], size_t first, size_t end) {
    const float c1 = (0.01f * 255) * (0.01f * 255), c2 = (0.03f * 255) * (0.03f * 255);
    double sum = 0;
    for (size_t i = first; i < end; i++) {
        float a = mean[0][i], b = mean[1][i];
        float variances = (mean[2][i] - a * a) + (mean[3][i] - b * b), covariance = mean[4][i] - a * b;
        a += MIDDLE;
        b += MIDDLE;
        float ab = a * b;
        double above = (double)((ab + ab + c1) * (covariance + covariance + c2));
        sum += above / (double)((a * a + b * b + c1) * (variances + c2));
    }
    return sum;
}

static void band(void *context, size_t index, int worker) {
    const ssim *s = context;
    size_t width = (size_t)s->width, plane = width * TALL, y0 = index * ISO_COMPARE_BAND;
    int rows = s->rows - (int)y0 < ISO_COMPARE_BAND ? s->rows - (int)y0 : ISO_COMPARE_BAND;
    float *scratch = s->scratch + (size_t)worker * s->scratch_floats;
    size_t count = width * (size_t)(rows + 2 * RADIUS);
    luma(s->picture[0] + 3 * y0 * width, count, scratch);
    luma(s->picture[1] + 3 * y0 * width, count, scratch + plane);
    float *mean[MOMENTS];
    for (size_t m = 0; m < MOMENTS; m++)
        mean[m] = scratch + 4 * plane + (width + 2 * RADIUS) + m * width * ISO_COMPARE_BAND;
    moments(s, scratch, rows, mean);
    double sum = 0;
    for (size_t y = 0; y < (size_t)rows; y++)
        sum += sum_row(mean, y * width + RADIUS, (y + 1) * width - RADIUS);
    s->sums[index] = sum;
}

iso_status iso_ssim(const uint8_t *a, const uint8_t *b, const int size[2], iso_pool *pool, double *out,
                    iso_error *error) {
    *out = NAN;
    if (size[0] < ISO_SSIM_WINDOW || size[1] < ISO_SSIM_WINDOW) return ISO_OK;
    ssim s = {.picture = {a, b},
              .width = size[0],
              .rows = size[1] - 2 * RADIUS,
              .window = iso_kernel_gaussian(1.5, RADIUS, 1)};
    size_t bands = iso_compare_bands(s.rows), width = (size_t)s.width;
    s.scratch_floats = width * (4 * TALL + MOMENTS * ISO_COMPARE_BAND) + width + 2 * RADIUS;
    s.scratch = iso_alloc((size_t)iso_pool_threads(pool) * s.scratch_floats * sizeof *s.scratch);
    s.sums = iso_alloc(bands * sizeof *s.sums);
    iso_status status = ISO_OK;
    if (s.scratch && s.sums) {
        iso_parallel_for(pool, bands, band, &s);
        double sum = 0;
        for (size_t i = 0; i < bands; i++) sum += s.sums[i];
        *out = sum / ((double)s.rows * (s.width - 2 * RADIUS));
    } else {
        status = iso_fail(error, ISO_ERR_NOMEM, "out of memory for SSIM");
    }
    iso_free(s.scratch);
    iso_free(s.sums);
    return status;
}
