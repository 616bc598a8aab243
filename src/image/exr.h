/* exr: depth, normal and coverage as an OpenEXR picture.
 *
 * One part of scanlines, 32-bit float channels Z (depth), N.X N.Y N.Z (normal) and A (coverage), ZIP
 * compressed; attribute isopointVoxel is iso_aov's voxel. OpenEXR is optional at build: without it both
 * functions answer ISO_ERR_UNSUPPORTED. The bytes do not depend on the number of threads. */
#ifndef ISO_IMAGE_EXR_H
#define ISO_IMAGE_EXR_H

#include <stdbool.h>
#include <stdint.h>

#include "base/parallel.h"
#include "base/status.h"
#include "image/aov.h"
#include "image/camera.h"

#ifdef __cplusplus
extern "C" {
#endif

/* What else the header says; all-zero says nothing. */
typedef struct iso_exr_info {
    const iso_view *view;            /* written as the standard attributes worldToCamera and worldToNDC */
    const char *software, *comments; /* UTF-8 */
} iso_exr_info;

/* false: built without OpenEXR. */
bool iso_exr_available(void);

/* Writes through base/file.h: the file appears whole or not at all. The file must be one that can be sought
 * in
 * ("-" is a usage error). info may be NULL. ISO_ERR_USAGE, ISO_ERR_WRITE, ISO_ERR_NOMEM. */
iso_status iso_exr_write(const char *path, const iso_aov *aov, const iso_exr_info *info, iso_pool *pool,
                         iso_error *error);

/* Width and height as the header says. False when it is no OpenEXR picture or cannot be read, or when OpenEXR
 * is not built in: iso_exr_read says why. */
bool iso_exr_size(const char *path, uint32_t size[2]);

/* Reads what iso_exr_write writes, and pictures of other programs that have these channels (float or half) as
 * scanlines, uncompressed or with RLE, ZIPS or ZIP compression; other channels are ignored, and the data
 * window is the picture. Where coverage is 0, depth becomes INFINITY and the normal 0, whatever the file says
 * there. iso_aov_free when done. ISO_ERR_IO; ISO_ERR_FORMAT for all else: no OpenEXR file, sides beyond
 * ISO_IMAGE_MAX, a missing channel, a truncated or damaged file, coverage outside 0 .. 1, depth or normal
 * that is not finite where something is covered. ISO_ERR_NOMEM. */
iso_status iso_exr_read(const char *path, iso_pool *pool, iso_aov *aov, iso_error *error);

#ifdef __cplusplus
}
#endif
#endif
