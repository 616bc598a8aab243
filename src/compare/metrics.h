/* metrics: measures how much a picture differs from the true picture (truth).
 *
 * Both pictures have the same size, and have colours, float channels (depth, normal, coverage), or both. A
 * metric whose inputs are missing is NaN. */
#ifndef ISO_COMPARE_METRICS_H
#define ISO_COMPARE_METRICS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/parallel.h"
#include "base/status.h"
#include "compare/silhouette.h"
#include "render/shading/shading.h"

/* A picture as planes of width * height, borrowed; NULL: not known. At least one of rgba and coverage must be
 * set. */
typedef struct iso_compare_picture {
    int width, height;
    const uint8_t *rgba;    /* straight alpha; display values (sRGB) */
    const float *color;     /* three unrounded display values 0 .. 255 for each pixel; used for PSNR instead
                               of rgba if both pictures have them */
    const float *depth;     /* view z, mm; read only where both pictures are covered; not finite: unknown */
    const float *normal[3]; /* read where depth is read; of any length; zero or not finite: unknown */
    const float *coverage;  /* 0 .. 1 */
} iso_compare_picture;

/* All zero means the default. */
typedef struct iso_compare_opts {
    /* The colour behind transparent pixels. In pictures without transparency and coverage, pixels of this
     * colour count as not covered. Zero is black. */
    iso_rgb background;
    double voxel;             /* size of a voxel in mm; 0: unknown, no depth errors in voxels */
    double pixels_per_voxel;  /* 0: unknown, no dilations in voxels */
    double pixels_per_degree; /* for FLIP; 0: ISO_FLIP_PIXELS_PER_DEGREE */
    float *flip_map;          /* width * height floats, set when both pictures have colours; or NULL */
    iso_pool *pool;
} iso_compare_opts;

/* The list of metrics: X(field, title, unit, larger is better). A field of iso_metrics is also the metric's
 * name in JSON and on the command line. */
#define ISO_METRIC_MAP(X)                                                                                    \
    X(psnr_in, "PSNR, both silhouettes widened by 2 pixels", "dB", true)                                     \
    X(psnr, "PSNR, whole picture", "dB", true)                                                               \
    X(error_p99, "colour error, 99th percentile of the same pixels", "of 255", false)                        \
    X(error_max, "colour error, largest", "of 255", false)                                                   \
    X(ssim, "SSIM (2004), luma", "", true)                                                                   \
    X(flip, "LDR-FLIP (2020)", "", false)                                                                    \
    X(iou, "silhouettes, shared part", "", true)                                                             \
    X(dilation_mean, "silhouette's dilation, mean, signed", "pixels", false)                                 \
    X(dilation_p99, "silhouette's dilation, 99th percentile", "pixels", false)                               \
    X(dilation_max, "silhouette's dilation, largest", "pixels", false)                                       \
    X(dilation_mean_voxel, "the same, mean", "voxels", false)                                                \
    X(dilation_max_voxel, "the same, largest", "voxels", false)                                              \
    X(holes, "holes", "%", false)                                                                            \
    X(normal_error_deg, "normal error, mean", "degrees", false)                                              \
    X(depth_error_voxel, "depth error, mean", "voxels", false)                                               \
    X(wrong, "more than 2 voxels off", "%", false)                                                           \
    X(pixels_differing, "pixels that differ by more than 1/255", "pixels", false)

/* The results of a comparison. NaN: unknown, or nothing to measure.
 *
 * psnr      10 log10(255^2 / (mean squared difference of R, G and B + 1e-9)): 138.1 dB for equal pictures
 * psnr_in   the same over the pixels of either silhouette widened by 2 pixels
 * error_p99 of the pixels of psnr_in, 99 % have at most this largest difference of R, G and B
 * error_max the largest such difference
 * ssim      see compare/ssim.h
 * flip      see compare/flip.h
 * iou, dilation_mean, dilation_p99, dilation_max, holes: see compare/silhouette.h
 * normal_error_deg   mean angle where both are covered, depth is known (or not given) and not wrong
 * depth_error_voxel  mean |difference of depth| where both are covered and not wrong
 * wrong              percent of the pixels covered by both that lie more than 2 voxels apart in depth
 * pixels_differing   pixels with a difference of more than 1 of 255 in any channel */
typedef struct iso_metrics {
#define ISO_X(field, title, unit, larger) double field;
    ISO_METRIC_MAP(ISO_X)
#undef ISO_X
    size_t covered[2];       /* pixels of the silhouettes: truth's, candidate's */
    size_t missing, extra;   /* pixels of the truth's silhouette only; of the candidate's only */
    size_t depth_off;        /* pixels covered by both whose depths differ by more than 1e-3 voxel */
    size_t others_differing; /* pixels counted in pixels_differing that are in none of these three */
    iso_silhouette_source sources[2];
} iso_metrics;

/* Compares two pictures. ISO_ERR_MISMATCH when their sizes differ, ISO_ERR_NOMEM. The same for every number
 * of threads. */
iso_status iso_compare(const iso_compare_picture *truth, const iso_compare_picture *candidate,
                       const iso_compare_opts *opts, iso_metrics *metrics, iso_error *error);

/* PSNR in dB, as in iso_metrics, of pictures whose squared differences of R, G and B (0 .. 255) have the sum
 * `squares`. NaN without pixels. */
double iso_psnr(double squares, size_t pixels);

/* A row of the table of metrics, which is in the order of ISO_METRIC_MAP. */
typedef struct iso_metric {
    const char *name, *title, *unit;
    bool larger_is_better;
    size_t offset; /* of the double in iso_metrics */
} iso_metric;

const iso_metric *iso_metric_list(size_t *count);
const iso_metric *iso_metric_find(const char *name); /* NULL: there is none */
double iso_metric_value(const iso_metric *metric, const iso_metrics *metrics);
/* Returns whether a value stands for infinity. This is the PSNR of equal pictures, for which 138.1 dB is
 * stored, so that means over several pictures stay finite. */
bool iso_metric_is_infinite(const iso_metric *metric, double value);

/* Returns whether a value is worse than a bound: below it for metrics whose larger values are better, else
 * above it. Mean dilations are compared by magnitude. An unknown value is worse than any bound. */
bool iso_metric_is_worse(const iso_metric *metric, double value, double bound);

#endif
