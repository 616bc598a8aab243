/* silhouette: which pixels show the surface, and how two such sets differ.
 *
 * A mask is width * height bytes, 1 where the surface is seen. "Within 2 pixels" means the square of 5 x 5
 * pixels, cut off at the picture's border, as in the study that this project's figures come from. */
#ifndef ISO_COMPARE_SILHOUETTE_H
#define ISO_COMPARE_SILHOUETTE_H

#include <stddef.h>
#include <stdint.h>

#include "base/parallel.h"
#include "base/status.h"
#include "render/shading/shading.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Where a mask came from. */
typedef enum iso_silhouette_source {
    ISO_SILHOUETTE_ALPHA,     /* alpha of at least one half */
    ISO_SILHOUETTE_COVERAGE,  /* coverage of at least one half */
    ISO_SILHOUETTE_BACKGROUND /* a colour other than the background's */
} iso_silhouette_source;

const char *iso_silhouette_source_name(iso_silhouette_source source); /* "alpha", "coverage", ... */

/* Masks of `count` pixels. */
void iso_silhouette_from_alpha(const uint8_t *rgba, size_t count, uint8_t *mask);
void iso_silhouette_from_coverage(const float *coverage, size_t count, uint8_t *mask);
void iso_silhouette_from_background(const uint8_t *rgba, size_t count, iso_rgb background, uint8_t *mask);

/* Minkowski sum and difference with a square: out is 1 where any (all) of the mask's pixels within `radius`
 * columns and rows are 1; pixels beyond the border do not count. out must not be mask. ISO_ERR_NOMEM. */
iso_status iso_silhouette_dilate(const uint8_t *mask, const int size[2], int radius, uint8_t *out,
                                 iso_error *error);
iso_status iso_silhouette_erode(const uint8_t *mask, const int size[2], int radius, uint8_t *out,
                                iso_error *error);

/* What differs between the truth's silhouette and a candidate's. NaN where there is nothing to measure. */
typedef struct iso_silhouette_difference {
    double iou;           /* pixels in both / pixels in either; NaN when both are empty */
    double dilation_mean; /* pixels: (candidate's area - truth's area) / truth's border pixels, where a border
                             pixel has a neighbour to a side that is not covered; signed */
    double dilation_max;  /* pixels: distance of the farthest candidate pixel outside the truth from the
                             nearest truth pixel, centre to centre; 0 when there is none */
    double holes;         /* percent of the truth eroded by 2 pixels that the candidate does not cover */
    size_t missing, extra; /* pixels of the truth that the candidate lacks, and the other way round */
} iso_silhouette_difference;

/* size is {width, height}. ISO_ERR_NOMEM. */
iso_status iso_silhouette_compare(const uint8_t *truth, const uint8_t *candidate, const int size[2],
                                  iso_silhouette_difference *difference, iso_error *error);

#ifdef __cplusplus
}
#endif
#endif
