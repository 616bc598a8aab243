/* aov: what a picture shows as numbers instead of colours ("arbitrary output variables"): depth, normal and
 * coverage of every pixel, for comparisons and for compositing.
 *
 * Planes of width * height floats, row 0 at the top. Of a pixel with several samples, depth and normal are
 * the means of the covered samples, and coverage is their share. */
#ifndef ISO_IMAGE_AOV_H
#define ISO_IMAGE_AOV_H

#include "base/status.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { ISO_AOV_PLANES = 5 };

typedef struct iso_aov {
    int width, height;
    float *depth;     /* distance along the view direction (not along the ray), mm; INFINITY where empty */
    float *normal[3]; /* world (LPS) x, y, z: unit, out of the solid, not turned to the viewer; 0 where empty
                         and where the normals of a pixel's samples cancel */
    float *coverage;  /* 0 .. 1; 0 is empty */
    float voxel;      /* smallest voxel spacing of what is shown, mm; 0 when unknown */
} iso_aov;

/* Planes uninitialised; iso_aov_free when done. ISO_ERR_USAGE when a side is not in 1 .. ISO_IMAGE_MAX,
 * ISO_ERR_NOMEM. */
iso_status iso_aov_create(int width, int height, iso_aov *aov, iso_error *error);
void iso_aov_free(iso_aov *aov);

#ifdef __cplusplus
}
#endif
#endif
