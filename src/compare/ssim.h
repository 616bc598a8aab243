/* ssim: structural similarity (Wang, Bovik, Sheikh and Simoncelli 2004, "Image quality assessment: from error
 * visibility to structural similarity", eq. 13): Gaussian window of 11 x 11 pixels, sigma 1.5, K1 = 0.01,
 * K2 = 0.03, L = 255.
 *
 * The mean over all windows that lie wholly inside the picture, of luma 0.299 R + 0.587 G + 0.114 B of the
 * display values (Rec. 601, not rounded), as in the authors' program. */
#ifndef ISO_COMPARE_SSIM_H
#define ISO_COMPARE_SSIM_H

#include <stdint.h>

#include "base/parallel.h"
#include "base/status.h"

enum { ISO_SSIM_WINDOW = 11 };

/* Compares two RGB pictures of width * height * 3 bytes; size is {width, height}. *ssim is 1 for equal
 * pictures, and NaN when a side is less than ISO_SSIM_WINDOW. The same for every number of threads.
 * ISO_ERR_NOMEM. */
iso_status iso_ssim(const uint8_t *a, const uint8_t *b, const int size[2], iso_pool *pool, double *ssim,
                    iso_error *error);

#endif
