/* truth_support: differences of a picture from the truth, for tests of methods that approximate it. */
#ifndef ISO_TESTS_TRUTH_SUPPORT_H
#define ISO_TESTS_TRUTH_SUPPORT_H

#include <stddef.h>

#include "image/camera.h"
#include "render/view/gbuffer.h"

/* The PSNR of the shaded pictures in dB, over the union of both silhouettes. */
double test_psnr(const iso_view *view, const iso_gbuffer *a, const iso_gbuffer *b);

/* The number of samples that are not covered inside the truth's silhouette, two pixels or more from its
 * outline; *inside: the number of all samples there. */
size_t test_holes(const iso_gbuffer *truth, const iso_gbuffer *got, size_t *inside);

/* The mean number of pixels by which the silhouette extends beyond the truth's outline. */
double test_dilation(const iso_gbuffer *truth, const iso_gbuffer *got);

#endif
