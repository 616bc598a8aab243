/* exr: depth, normal, coverage and ids as an OpenEXR picture; pictures of colours.
 *
 * One part of scanlines, 32-bit float channels Z (depth), N.X N.Y N.Z (normal) and A (coverage), and where
 * the aov has them layers, and the unsigned integers id.surface, id.element and id.segment; ZIP compressed;
 * the attribute isopointVoxel is iso_aov.voxel. In a build without OpenEXR, reading and writing
 * return ISO_ERR_UNSUPPORTED. The bytes do not depend on the number of threads. */
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

/* Further attributes of the header; members that are zero are not written. */
typedef struct iso_exr_info {
    const iso_view *view;            /* written as the standard attributes worldToCamera and worldToNDC */
    const char *software, *comments; /* UTF-8 */
} iso_exr_info;

/* Whether this build has OpenEXR. */
bool iso_exr_available(void);

/* Writes through base/file.h: the file appears whole or not at all. The file must be seekable ("-" is a usage
 * error). info may be NULL. ISO_ERR_USAGE, ISO_ERR_WRITE, ISO_ERR_NOMEM. */
iso_status iso_exr_write(const char *path, const iso_aov *aov, const iso_exr_info *info, iso_pool *pool,
                         iso_error *error);

/* Reads width and height from the header. False when it is not an OpenEXR picture or cannot be read, or when
 * this build has no OpenEXR; iso_exr_read then gives the reason. */
bool iso_exr_size(const char *path, uint32_t size[2]);

/* Reads pictures written by iso_exr_write, and those of other programs that have the same channels (float or
 * half) in scanlines, uncompressed or with RLE, ZIPS or ZIP compression. Other channels are ignored, and ids
 * unless all three are there as unsigned integers; the picture is the data window. Where coverage is 0, depth
 * becomes INFINITY, and normal and ids 0, whatever the file has there. iso_aov_free when done. ISO_ERR_IO;
 * ISO_ERR_NOMEM; ISO_ERR_FORMAT: not an OpenEXR file, sides beyond ISO_IMAGE_MAX, a missing channel, a
 * truncated or damaged file, coverage outside 0 .. 1, a depth or normal that is not finite in a covered
 * pixel. */
iso_status iso_exr_read(const char *path, iso_pool *pool, iso_aov *aov, iso_error *error);

/* Linear colours, row 0 at the top. */
typedef struct iso_float_image {
    int width, height;
    float *rgb; /* width * height pixels of 3 floats; iso_free */
} iso_float_image;

/* Reads the channels R, G and B of a picture, as iso_exr_read reads its channels; values may be any floats,
 * NaN and infinity included. ISO_ERR_IO; ISO_ERR_NOMEM; ISO_ERR_FORMAT. */
iso_status iso_exr_read_color(const char *path, iso_pool *pool, iso_float_image *image, iso_error *error);

#ifdef __cplusplus
}
#endif
#endif
