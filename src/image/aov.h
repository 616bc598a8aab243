/* aov: "arbitrary output variables" of a picture: depth, normal and coverage of every pixel as floats, for
 * comparisons and for compositing.
 *
 * Planes of width * height floats, row 0 at the top. Where a pixel has several samples, depth and normal are
 * the means over the covered samples, and coverage is their share of all samples. A picture of translucent
 * surfaces has depth and normal of the first one, alpha as coverage, and the number of layers. */
#ifndef ISO_IMAGE_AOV_H
#define ISO_IMAGE_AOV_H

#include "base/status.h"
#include "isopoint.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { ISO_AOV_PLANES = 5 }; /* that every picture has */

/* Allocates the planes, uninitialised; iso_aov_free when done. ISO_ERR_USAGE when a side is not in 1 ..
 * ISO_IMAGE_MAX, ISO_ERR_NOMEM. */
iso_status iso_aov_create(int width, int height, iso_aov *aov, iso_error *error);

/* Allocates the plane of the numbers of layers, uninitialised, unless it exists. ISO_ERR_NOMEM. */
iso_status iso_aov_add_layers(iso_aov *aov, iso_error *error);
/* Frees it, if it exists. */
void iso_aov_remove_layers(iso_aov *aov);

#ifdef __cplusplus
}
#endif
#endif
