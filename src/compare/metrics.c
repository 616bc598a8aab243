/* metrics: the table of metrics, and the comparison of two pictures by all of them. */
#include "compare/metrics.h"

#include <math.h>
#include <string.h>

#include "base/memory.h"
#include "compare/flip.h"
#include "compare/ssim.h"

/* ---- the list ---- */

static const iso_metric METRICS[] = {
#define ISO_X(field, title, unit, larger) {#field, title, unit, larger, offsetof(iso_metrics, field)},
    ISO_METRIC_MAP(ISO_X)
#undef ISO_X
};

const iso_metric *iso_metric_list(size_t *count) {
    *count = sizeof METRICS / sizeof *METRICS;
    return METRICS;
}

const iso_metric *iso_metric_find(const char *name) {
    for (size_t i = 0; i < sizeof METRICS / sizeof *METRICS; i++)
        if (strcmp(METRICS[i].name, name) == 0) return &METRICS[i];
    return NULL;
}

double iso_metric_value(const iso_metric *metric, const iso_metrics *metrics) {
    double value;
    memcpy(&value, (const char *)metrics + metric->offset, sizeof value);
    return value;
}

bool iso_metric_is_worse(const iso_metric *metric, double value, double bound) {
    if (isnan(value)) return true;
    bool is_signed = metric->offset == offsetof(iso_metrics, dilation_mean) ||
                     metric->offset == offsetof(iso_metrics, dilation_mean_voxel);
    if (is_signed) value = fabs(value);
    return metric->larger_is_better ? value < bound : value > bound;
}

static const double EQUAL_SQUARES = 1e-9; /* added to mean squared errors: PSNR of equal pictures is finite */

double iso_psnr(double squares, size_t pixels) {
    if (pixels == 0) return NAN;
    return 10 * log10(255.0 * 255.0 / (squares / (3.0 * (double)pixels) + EQUAL_SQUARES));
}

bool iso_metric_is_infinite(const iso_metric *metric, double value) {
    const bool is_psnr =
        metric->offset == offsetof(iso_metrics, psnr) || metric->offset == offsetof(iso_metrics, psnr_in);
    return is_psnr && value == iso_psnr(0, 1);
}

/* ---- colours ---- */

static const double OFF = 1e-3; /* voxels: larger differences of depth count as depth_off */

/* Blends a picture over the background, and rounds. */
static void flatten(const uint8_t *rgba, size_t count, iso_rgb background, uint8_t *rgb) {
    const unsigned back[3] = {background.r, background.g, background.b};
    for (size_t i = 0; i < count; i++) {
        unsigned alpha = rgba[4 * i + 3];
        for (size_t c = 0; c < 3; c++)
            rgb[3 * i + c] = (uint8_t)((rgba[4 * i + c] * alpha + back[c] * (255 - alpha) + 127) / 255);
    }
}

typedef struct color_sums {
    double squares, squares_in; /* of differences, three channels */
    size_t pixels_in, differing, others_differing;
    size_t errors[256]; /* pixels_in, by their error */
} color_sums;

/* The masks and opaque colours of one comparison. */
typedef struct work {
    size_t count;
    int size[2];
    uint8_t *mask[2], *inside, *off, *rgb[2]; /* `inside`: union of the silhouettes, widened; `off`: pixels
                                                 whose silhouette or depth differs */
} work;

static color_sums add_colors(const work *w) {
    const uint8_t *a = w->rgb[0], *b = w->rgb[1];
    color_sums sums = {0};
    for (size_t i = 0; i < w->count; i++) {
        unsigned squares = 0, largest = 0;
        for (size_t c = 0; c < 3; c++) {
            int d = a[3 * i + c] - b[3 * i + c];
            unsigned size = (unsigned)(d < 0 ? -d : d);
            squares += size * size;
            if (size > largest) largest = size;
        }
        sums.squares += squares;
        sums.differing += largest > 1;
        sums.others_differing += largest > 1 && !w->off[i];
        if (!w->inside[i]) continue;
        sums.squares_in += squares;
        sums.pixels_in++;
        sums.errors[largest]++;
    }
    return sums;
}

/* Replaces the sums of squares by those of unrounded colours. */
static void add_unrounded(const work *w, const float *a, const float *b, color_sums *sums) {
    sums->squares = sums->squares_in = 0;
    for (size_t i = 0; i < w->count; i++) {
        double squares = 0;
        for (size_t c = 0; c < 3; c++) {
            double d = (double)a[3 * i + c] - (double)b[3 * i + c];
            squares += d * d;
        }
        sums->squares += squares;
        sums->squares_in += w->inside[i] ? squares : 0;
    }
}

/* Sets the errors that 99 % of the pixels, and all of them, do not exceed. */
static void find_errors(const color_sums *sums, iso_metrics *metrics) {
    size_t seen = 0;
    for (int error = 0; error < 256 && seen < sums->pixels_in; error++) {
        seen += sums->errors[error];
        if (isnan(metrics->error_p99) && 100 * seen >= 99 * sums->pixels_in) metrics->error_p99 = error;
        if (seen == sums->pixels_in) metrics->error_max = error;
    }
}

/* ---- one comparison ---- */

static void free_work(work *w) {
    for (int side = 0; side < 2; side++) {
        iso_free(w->mask[side]);
        iso_free(w->rgb[side]);
    }
    iso_free(w->inside);
    iso_free(w->off);
}

static iso_status alloc_work(work *w, bool colors, iso_error *error) {
    bool good = (w->inside = iso_alloc(w->count)) != NULL;
    good = (w->off = iso_alloc(w->count)) != NULL && good;
    for (int side = 0; side < 2; side++) {
        good = (w->mask[side] = iso_alloc(w->count)) != NULL && good;
        if (colors) good = (w->rgb[side] = iso_alloc(3 * w->count)) != NULL && good;
    }
    return good ? ISO_OK : iso_fail(error, ISO_ERR_NOMEM, "out of memory for comparing pictures");
}

static bool is_transparent(const uint8_t *rgba, size_t count) {
    for (size_t i = 0; i < count; i++)
        if (rgba[4 * i + 3] != 255) return true;
    return false;
}

static iso_silhouette_source find_silhouette(const iso_compare_picture *picture, size_t count,
                                             iso_rgb background, uint8_t *mask) {
    if (picture->rgba && is_transparent(picture->rgba, count)) {
        iso_silhouette_from_alpha(picture->rgba, count, mask);
        return ISO_SILHOUETTE_ALPHA;
    }
    if (picture->coverage) {
        iso_silhouette_from_coverage(picture->coverage, count, mask);
        return ISO_SILHOUETTE_COVERAGE;
    }
    iso_silhouette_from_background(picture->rgba, count, background, mask);
    return ISO_SILHOUETTE_BACKGROUND;
}

static iso_status compare_silhouettes(work *w, double pixels_per_voxel, iso_metrics *metrics,
                                      iso_error *error) {
    iso_silhouette_difference d;
    ISO_TRY(iso_silhouette_compare(w->mask[0], w->mask[1], w->size, &d, error));
    metrics->iou = d.iou;
    metrics->dilation_mean = d.dilation_mean;
    metrics->dilation_p99 = d.dilation_p99;
    metrics->dilation_max = d.dilation_max;
    if (pixels_per_voxel > 0) {
        metrics->dilation_mean_voxel = d.dilation_mean / pixels_per_voxel;
        metrics->dilation_max_voxel = d.dilation_max / pixels_per_voxel;
    }
    metrics->holes = d.holes;
    metrics->missing = d.missing;
    metrics->extra = d.extra;
    for (size_t i = 0; i < w->count; i++) {
        metrics->covered[0] += w->mask[0][i];
        metrics->covered[1] += w->mask[1][i];
        w->off[i] = w->mask[0][i] != w->mask[1][i];
    }
    return ISO_OK;
}

/* Sets w->inside to the union of the silhouettes, widened by 2 pixels. */
static iso_status find_inside(work *w, iso_error *error) {
    uint8_t *either = iso_alloc(w->count);
    if (!either) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for a silhouette");
    for (size_t i = 0; i < w->count; i++) either[i] = w->mask[0][i] || w->mask[1][i];
    iso_status status = iso_silhouette_dilate(either, w->size, 2, w->inside, error);
    iso_free(either);
    return status;
}

static iso_status compare_colors(work *w, const iso_compare_picture *const pictures[2],
                                 const iso_compare_opts *opts, iso_metrics *metrics, iso_error *error) {
    ISO_TRY(find_inside(w, error));
    color_sums sums = add_colors(w);
    if (pictures[0]->color && pictures[1]->color)
        add_unrounded(w, pictures[0]->color, pictures[1]->color, &sums);
    metrics->others_differing = sums.others_differing;
    metrics->psnr = iso_psnr(sums.squares, w->count);
    metrics->psnr_in = iso_psnr(sums.squares_in, sums.pixels_in);
    metrics->pixels_differing = (double)sums.differing;
    find_errors(&sums, metrics);
    ISO_TRY(iso_ssim(w->rgb[0], w->rgb[1], w->size, opts->pool, &metrics->ssim, error));
    iso_flip_opts flip = {opts->pixels_per_degree, opts->flip_map, opts->pool};
    return iso_flip(w->rgb[0], w->rgb[1], w->size, &flip, &metrics->flip, error);
}

/* Returns the angle between two normals in degrees; NaN when one is zero. It is computed by the arc tangent,
 * which is precise for small angles; the arc cosine of a product of floats has errors of 0.02 degrees. */
static double angle(const iso_compare_picture *a, const iso_compare_picture *b, size_t i) {
    iso_vec3 m = iso_vec3_make(a->normal[0][i], a->normal[1][i], a->normal[2][i]);
    iso_vec3 n = iso_vec3_make(b->normal[0][i], b->normal[1][i], b->normal[2][i]);
    double lengths = iso_vec3_length(m) * iso_vec3_length(n);
    if (!(lengths > 0 && isfinite(lengths))) return NAN;
    return atan2(iso_vec3_length(iso_vec3_cross(m, n)), iso_vec3_dot(m, n)) * (180 / ISO_PI);
}

static void compare_channels(work *w, const iso_compare_picture *truth, const iso_compare_picture *candidate,
                             double voxel, iso_metrics *metrics) {
    bool depths = truth->depth && candidate->depth && voxel > 0;
    bool normals = truth->normal[0] && candidate->normal[0];
    double depth_sum = 0, angle_sum = 0;
    size_t known = 0, wrong = 0, angles = 0;
    for (size_t i = 0; i < w->count; i++) {
        if (!w->mask[0][i] || !w->mask[1][i]) continue;
        if (depths) {
            double off = fabs((double)truth->depth[i] - (double)candidate->depth[i]) / voxel;
            if (!isfinite(off)) continue;
            known++;
            wrong += off > 2;
            metrics->depth_off += w->off[i] = off > OFF;
            if (off > 2) continue;
            depth_sum += off;
        }
        double degrees = normals ? angle(truth, candidate, i) : NAN;
        if (isnan(degrees)) continue;
        angle_sum += degrees;
        angles++;
    }
    if (known) metrics->wrong = 100.0 * (double)wrong / (double)known;
    if (known > wrong) metrics->depth_error_voxel = depth_sum / (double)(known - wrong);
    if (angles) metrics->normal_error_deg = angle_sum / (double)angles;
}

static iso_status compare(work *w, const iso_compare_picture *const pictures[2], const iso_compare_opts *opts,
                          iso_metrics *metrics, iso_error *error) {
    bool colors = pictures[0]->rgba && pictures[1]->rgba;
    ISO_TRY(alloc_work(w, colors, error));
    for (int side = 0; side < 2; side++) {
        metrics->sources[side] = find_silhouette(pictures[side], w->count, opts->background, w->mask[side]);
        if (colors) flatten(pictures[side]->rgba, w->count, opts->background, w->rgb[side]);
    }
    ISO_TRY(compare_silhouettes(w, opts->pixels_per_voxel, metrics, error));
    compare_channels(w, pictures[0], pictures[1], opts->voxel, metrics);
    return colors ? compare_colors(w, pictures, opts, metrics, error) : ISO_OK;
}

iso_status iso_compare(const iso_compare_picture *truth, const iso_compare_picture *candidate,
                       const iso_compare_opts *opts, iso_metrics *metrics, iso_error *error) {
    if (truth->width != candidate->width || truth->height != candidate->height)
        return iso_fail(error, ISO_ERR_MISMATCH, "sizes differ: %dx%d and %dx%d", truth->width, truth->height,
                        candidate->width, candidate->height);
    work w = {.count = (size_t)truth->width * (size_t)truth->height, .size = {truth->width, truth->height}};
    iso_metrics result = {0};
#define ISO_X(field, title, unit, larger) result.field = NAN;
    ISO_METRIC_MAP(ISO_X)
#undef ISO_X
    const iso_compare_picture *pictures[2] = {truth, candidate};
    iso_status status = compare(&w, pictures, opts, &result, error);
    free_work(&w);
    if (status == ISO_OK) *metrics = result;
    return status;
}
