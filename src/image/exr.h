/* exr: reads and writes OpenEXR pictures: depth, normal, coverage and ids of an aov, or colours.
 *
 * An aov is written as one part of scanlines with ZIP compression. Its channels are 32-bit floats: Z (depth),
 * N.X N.Y N.Z (normal), A (coverage), and layers if the aov has them; then unsigned integers, if it has ids:
 * id.surface, id.element and id.segment. The attribute isopointVoxel is iso_aov.voxel. In a build without
 * OpenEXR, reading and writing return ISO_ERR_UNSUPPORTED. The bytes do not depend on the number of
 * threads. */
#ifndef ISO_IMAGE_EXR_H
#define ISO_IMAGE_EXR_H

#include <stdbool.h>
#include <stdint.h>

#include "base/parallel.h"
#include "base/status.h"
#include "image/aov.h"
#include "image/camera.h"

/* Further attributes for the header; members that are zero are not written. */
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

/* Reads width and height from the header. Returns false if the file is not OpenEXR or cannot be read, or if
 * this build has no OpenEXR; iso_exr_read then reports the reason. */
bool iso_exr_size(const char *path, uint32_t size[2]);

/* Reads pictures written by iso_exr_write, and pictures of other programs that have the same channels (float
 * or half) as scanlines, uncompressed or with RLE, ZIPS or ZIP compression. The picture is the data window.
 * Ids are read if all three channels exist as unsigned integers; all other channels are ignored. Where
 * coverage is 0, depth is set to INFINITY and normal and ids to 0. Free with iso_aov_free. ISO_ERR_IO;
 * ISO_ERR_NOMEM; ISO_ERR_FORMAT: not an OpenEXR file, sides larger than ISO_IMAGE_MAX, a missing channel, a
 * truncated or damaged file, coverage outside 0 .. 1, or a depth or normal that is not finite in a covered
 * pixel. */
iso_status iso_exr_read(const char *path, iso_pool *pool, iso_aov *aov, iso_error *error);

/* A picture of linear colours, row 0 at the top. */
typedef struct iso_float_image {
    int width, height;
    float *rgb; /* width * height pixels of 3 floats; iso_free */
} iso_float_image;

/* Reads the channels R, G and B of a picture, as iso_exr_read reads its channels; values may be any floats,
 * NaN and infinity included. ISO_ERR_IO; ISO_ERR_NOMEM; ISO_ERR_FORMAT. */
iso_status iso_exr_read_color(const char *path, iso_pool *pool, iso_float_image *image, iso_error *error);

#endif
