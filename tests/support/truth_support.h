/* How near a picture comes to the truth's, for tests of methods that only come near. */
#ifndef ISO_TESTS_TRUTH_SUPPORT_H
#define ISO_TESTS_TRUTH_SUPPORT_H

#include <stddef.h>

#include "image/camera.h"
#include "render/gbuffer.h"

/* Decibels between the shaded pictures, over the union of both silhouettes. */
double test_psnr(const iso_view *view, const iso_gbuffer *a, const iso_gbuffer *b);

/* Samples of the truth's inside, two pixels from its outline, that are not covered. */
size_t test_holes(const iso_gbuffer *truth, const iso_gbuffer *got, size_t *inside);

/* Pixels by which the silhouette is larger than the truth's, per pixel of its outline. */
double test_dilation(const iso_gbuffer *truth, const iso_gbuffer *got);

#endif
