/* silhouette: masks, their dilation and erosion, and distances between them. The distance transform is that
 * of Meijster, Roerdink and Hesselink 2000, "A general algorithm for computing distance transforms in linear
 * time", in the form of Felzenszwalb and Huttenlocher 2012: first the distance to the nearest set pixel in
 * each column, then the lower envelope of parabolas along rows. */
#include "compare/silhouette.h"

#include <math.h>
#include <stdlib.h>

#include "base/memory.h"
#include "base/numbers.h"

const char *iso_silhouette_source_name(iso_silhouette_source source) {
    static const char *const names[] = {"alpha", "coverage", "background"};
    return names[source];
}

void iso_silhouette_from_alpha(const uint8_t *rgba, size_t count, uint8_t *mask) {
    for (size_t i = 0; i < count; i++) mask[i] = rgba[4 * i + 3] >= 128;
}

void iso_silhouette_from_coverage(const float *coverage, size_t count, uint8_t *mask) {
    for (size_t i = 0; i < count; i++) mask[i] = coverage[i] >= 0.5f;
}

void iso_silhouette_from_background(const uint8_t *rgba, size_t count, iso_rgb background, uint8_t *mask) {
    for (size_t i = 0; i < count; i++) {
        const uint8_t *pixel = rgba + 4 * i;
        mask[i] = pixel[0] != background.r || pixel[1] != background.g || pixel[2] != background.b;
    }
}

/* ---- dilation and erosion ---- */

/* Sets out[i] to 1 where the mask has `value` anywhere in i - radius .. i + radius, else to 0; for a line of
 * `count` entries that are `step` apart. */
static void spread_line(const uint8_t *mask, uint8_t value, int count, size_t step, int radius,
                        uint8_t *out) {
    int last = -1 - radius; /* the last entry up to i + radius that is `value` */
    for (int i = 0; i < radius && i < count; i++)
        if (mask[(size_t)i * step] == value) last = i;
    for (int i = 0; i < count; i++) {
        if (i + radius < count && mask[(size_t)(i + radius) * step] == value) last = i + radius;
        out[(size_t)i * step] = last >= i - radius;
    }
}

/* Sets `out` to 1 where the mask has `value` within `radius` rows and columns, else to 0. */
static iso_status spread(const uint8_t *mask, uint8_t value, const int size[2], int radius, uint8_t *out,
                         iso_error *error) {
    size_t width = (size_t)size[0];
    uint8_t *along_rows = iso_alloc(width * (size_t)size[1]);
    if (!along_rows) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for a silhouette");
    for (size_t y = 0; y < (size_t)size[1]; y++)
        spread_line(mask + y * width, value, size[0], 1, radius, along_rows + y * width);
    for (size_t x = 0; x < width; x++) spread_line(along_rows + x, 1, size[1], width, radius, out + x);
    iso_free(along_rows);
    return ISO_OK;
}

iso_status iso_silhouette_dilate(const uint8_t *mask, const int size[2], int radius, uint8_t *out,
                                 iso_error *error) {
    return spread(mask, 1, size, radius, out, error);
}

iso_status iso_silhouette_erode(const uint8_t *mask, const int size[2], int radius, uint8_t *out,
                                iso_error *error) {
    ISO_TRY(spread(mask, 0, size, radius, out, error));
    size_t count = (size_t)size[0] * (size_t)size[1];
    for (size_t i = 0; i < count; i++) out[i] = !out[i];
    return ISO_OK;
}

/* ---- distances ---- */

/* Computes for each pixel the distance in rows to the nearest set pixel of its column; 1e6 if the column has
 * none. */
static void column_distances(const uint8_t *mask, const int size[2], double *rows) {
    size_t width = (size_t)size[0];
    const double far = 1e6;
    for (size_t x = 0; x < width; x++) {
        double distance = far;
        for (size_t y = 0; y < (size_t)size[1]; y++) {
            distance = mask[y * width + x] ? 0 : distance < far ? distance + 1 : far;
            rows[y * width + x] = distance;
        }
        distance = far;
        for (size_t y = (size_t)size[1]; y-- > 0;) {
            distance = mask[y * width + x] ? 0 : distance < far ? distance + 1 : far;
            if (distance < rows[y * width + x]) rows[y * width + x] = distance;
        }
    }
}

/* The lower envelope of parabolas along a row. */
typedef struct envelope {
    int *center;    /* column of each parabola, from left to right */
    double *start;  /* x where each parabola begins to be the lowest */
    double *height; /* of its lowest point */
} envelope;

/* Replaces a row of column_distances by the distances to the nearest set pixel of the picture. */
static void row_distances(double *rows, int width, const envelope *e) {
    int count = 0;
    for (int x = 0; x < width; x++) {
        double height = rows[x] * rows[x] + (double)x * x, cut = -INFINITY;
        for (; count > 0; count--) {
            int c = e->center[count - 1];
            cut = (height - (rows[c] * rows[c] + (double)c * c)) / (2.0 * (x - c));
            if (cut > e->start[count - 1]) break;
        }
        e->center[count] = x;
        e->start[count] = count ? cut : -INFINITY;
        e->height[count] = rows[x] * rows[x];
        count++;
    }
    for (int x = 0, at = 0; x < width; x++) {
        while (at + 1 < count && e->start[at + 1] <= x) at++;
        int c = e->center[at];
        rows[x] = sqrt((double)(x - c) * (x - c) + e->height[at]);
    }
}

/* Computes the distance of each pixel to the nearest set pixel of `mask`, which must not be empty. */
static iso_status distances(const uint8_t *mask, const int size[2], double *out, iso_error *error) {
    const size_t width = (size_t)size[0], count = width * (size_t)size[1];
    envelope e = {iso_alloc(width * sizeof *e.center), iso_alloc(width * sizeof *e.start),
                  iso_alloc(width * sizeof *e.height)};
    iso_status status = ISO_OK;
    if (e.center && e.start && e.height) {
        column_distances(mask, size, out);
        for (size_t i = 0; i < count; i += width) row_distances(out + i, size[0], &e);
    } else {
        status = iso_fail(error, ISO_ERR_NOMEM, "out of memory for distances to a silhouette");
    }
    iso_free(e.center);
    iso_free(e.start);
    iso_free(e.height);
    return status;
}

/* ---- comparison ---- */

static bool is_border(const uint8_t *mask, const int size[2], int x, int y) {
    size_t i = (size_t)y * (size_t)size[0] + (size_t)x;
    return mask[i] &&
           ((x > 0 && !mask[i - 1]) || (x + 1 < size[0] && !mask[i + 1]) ||
            (y > 0 && !mask[i - (size_t)size[0]]) || (y + 1 < size[1] && !mask[i + (size_t)size[0]]));
}

static size_t count_border(const uint8_t *mask, const int size[2]) {
    size_t border = 0;
    for (int y = 0; y < size[1]; y++)
        for (int x = 0; x < size[0]; x++) border += is_border(mask, size, x, y);
    return border;
}

static iso_status count_holes(const uint8_t *truth, const uint8_t *candidate, const int size[2],
                              double *holes, iso_error *error) {
    size_t count = (size_t)size[0] * (size_t)size[1], inner = 0, open = 0;
    uint8_t *eroded = iso_alloc(count);
    if (!eroded) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for a silhouette");
    iso_status status = iso_silhouette_erode(truth, size, 2, eroded, error);
    for (size_t i = 0; status == ISO_OK && i < count; i++) {
        inner += eroded[i];
        open += eroded[i] && !candidate[i];
    }
    *holes = inner ? 100.0 * (double)open / (double)inner : NAN;
    iso_free(eroded);
    return status;
}

/* Measures how far the candidate's pixels are from the truth, which must not be empty. */
static iso_status measure_dilation(const uint8_t *truth, const uint8_t *candidate, const int size[2],
                                   iso_silhouette_difference *d, iso_error *error) {
    const size_t count = (size_t)size[0] * (size_t)size[1];
    double *far = iso_alloc(count * sizeof *far);
    if (!far) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for distances to a silhouette");
    const iso_status status = distances(truth, size, far, error);
    size_t border = 0;
    for (size_t i = 0; status == ISO_OK && i < count; i++) {
        if (!candidate[i]) continue;
        d->dilation_max = fmax(d->dilation_max, far[i]);
        if (is_border(candidate, size, (int)(i % (size_t)size[0]), (int)(i / (size_t)size[0])))
            far[border++] = far[i]; /* in place: those before i are not needed any more */
    }
    if (border) {
        qsort(far, border, sizeof *far, iso_compare_doubles);
        d->dilation_p99 = far[(border * 99 + 99) / 100 - 1];
    }
    iso_free(far);
    return status;
}

iso_status iso_silhouette_compare(const uint8_t *truth, const uint8_t *candidate, const int size[2],
                                  iso_silhouette_difference *difference, iso_error *error) {
    size_t count = (size_t)size[0] * (size_t)size[1], area[2] = {0, 0}, both = 0;
    for (size_t i = 0; i < count; i++) {
        area[0] += truth[i];
        area[1] += candidate[i];
        both += truth[i] && candidate[i];
    }
    size_t either = area[0] + area[1] - both, border = count_border(truth, size);
    iso_silhouette_difference d = {.iou = either ? (double)both / (double)either : NAN,
                                   .dilation_mean =
                                       border ? ((double)area[1] - (double)area[0]) / (double)border : NAN,
                                   .dilation_p99 = area[0] ? 0 : NAN,
                                   .dilation_max = area[0] ? 0 : NAN,
                                   .missing = area[0] - both,
                                   .extra = area[1] - both};
    ISO_TRY(count_holes(truth, candidate, size, &d.holes, error));
    if (area[0] && d.extra) ISO_TRY(measure_dilation(truth, candidate, size, &d, error));
    *difference = d;
    return ISO_OK;
}
