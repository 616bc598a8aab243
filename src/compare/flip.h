/* flip: LDR-FLIP, the difference that a person sees who flips between two pictures.
 *
 * LDR-FLIP: Andersson, Nilsson, Akenine-Moller, Oskarsson, Astrom and Fairchild 2020, "FLIP: A Difference
 * Evaluator for Alternating Images", Proc. ACM Comput. Graph. Interact. Tech. 3(2). Both pictures are
 * filtered as the eye does (contrast sensitivity of three opponent channels, section 4.1.1) and compared in a
 * uniform colour space (HyAB of Hunt-adjusted L*a*b*, 4.1.2-4.1.3); differences of edges and points increase
 * the result (4.2-4.3). */
#ifndef ISO_COMPARE_FLIP_H
#define ISO_COMPARE_FLIP_H

#include <stdint.h>

#include "base/parallel.h"
#include "base/status.h"

/* The authors' default: a 0.7 m wide screen of 3840 pixels seen from 0.7 m. */
#define ISO_FLIP_PIXELS_PER_DEGREE 67.0206432765823

/* The largest accepted number of pixels per degree, with which the kernels have a radius of 61 pixels. */
#define ISO_FLIP_PIXELS_PER_DEGREE_MAX 450.0

typedef struct iso_flip_opts {
    double pixels_per_degree; /* 0: ISO_FLIP_PIXELS_PER_DEGREE */
    float *map;               /* width * height differences, 0 .. 1, or NULL */
    iso_pool *pool;
} iso_flip_opts;

/* Compares two sRGB pictures of width * height * 3 bytes; size is {width, height}. *mean is the mean
 * difference of all pixels: 0 for equal pictures, at most 1. The outermost rows and columns are repeated
 * beyond the border. The same for every number of threads. ISO_ERR_USAGE: pixels per degree not in 1 ..
 * ISO_FLIP_PIXELS_PER_DEGREE_MAX; ISO_ERR_NOMEM. */
iso_status iso_flip(const uint8_t *reference, const uint8_t *test, const int size[2],
                    const iso_flip_opts *opts, double *mean, iso_error *error);

#endif
