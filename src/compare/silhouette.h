/* silhouette: which pixels show the surface, and how two such sets differ.
 *
 * A mask is width * height bytes, 1 where the surface is visible. "Within 2 pixels" means the square of 5 x 5
 * pixels around a pixel, cut off at the picture's border. */
#ifndef ISO_COMPARE_SILHOUETTE_H
#define ISO_COMPARE_SILHOUETTE_H

#include <stddef.h>
#include <stdint.h>

#include "base/parallel.h"
#include "base/status.h"
#include "render/shading/shading.h"

/* How a mask was made. */
typedef enum iso_silhouette_source {
    ISO_SILHOUETTE_ALPHA,     /* alpha of at least one half */
    ISO_SILHOUETTE_COVERAGE,  /* coverage of at least one half */
    ISO_SILHOUETTE_BACKGROUND /* a colour other than the background's */
} iso_silhouette_source;

const char *iso_silhouette_source_name(iso_silhouette_source source); /* "alpha", "coverage", ... */

/* Set the mask of `count` pixels. */
void iso_silhouette_from_alpha(const uint8_t *rgba, size_t count, uint8_t *mask);
void iso_silhouette_from_coverage(const float *coverage, size_t count, uint8_t *mask);
void iso_silhouette_from_background(const uint8_t *rgba, size_t count, iso_rgb background, uint8_t *mask);

/* Dilation and erosion by a square: out is 1 where any (dilation) or all (erosion) of the mask's pixels
 * within `radius` columns and rows are 1; pixels beyond the border are ignored. out must not be mask.
 * ISO_ERR_NOMEM. */
iso_status iso_silhouette_dilate(const uint8_t *mask, const int size[2], int radius, uint8_t *out,
                                 iso_error *error);
iso_status iso_silhouette_erode(const uint8_t *mask, const int size[2], int radius, uint8_t *out,
                                iso_error *error);

/* Differences between the silhouettes of the truth and of a candidate. NaN where there is nothing to measure.
 */
typedef struct iso_silhouette_difference {
    double iou;            /* pixels in both / pixels in either; NaN when both are empty */
    double dilation_mean;  /* pixels, signed: (candidate's area - truth's area) / number of the truth's border
                              pixels (covered pixels of which one of the four neighbours is not covered) */
    double dilation_p99;   /* pixels: 99 % of the candidate's border pixels are at most this far, centre to
                              centre, from the nearest pixel of the truth; 0 when it has none */
    double dilation_max;   /* pixels: the largest distance, centre to centre, of a candidate's pixel from the
                              nearest pixel of the truth; 0 when the candidate has no extra pixels */
    double holes;          /* percent of the truth, eroded by 2 pixels, that the candidate does not cover */
    size_t missing, extra; /* pixels of the truth only; pixels of the candidate only */
} iso_silhouette_difference;

/* size is {width, height}. ISO_ERR_NOMEM. */
iso_status iso_silhouette_compare(const uint8_t *truth, const uint8_t *candidate, const int size[2],
                                  iso_silhouette_difference *difference, iso_error *error);

#endif
