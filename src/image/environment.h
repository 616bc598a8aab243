/* environment: what is seen in every direction around a scene: an equirectangular picture of linear light.
 *
 * The picture's top row is what lies above, its bottom row what lies below; the middle column is what the
 * preset camera "front" (iso_direction_vectors) looks at, columns to its right lie to that camera's right.
 * The environment is infinitely far away and stays with the world when the camera turns. */
#ifndef ISO_IMAGE_ENVIRONMENT_H
#define ISO_IMAGE_ENVIRONMENT_H

#include "base/geometry.h"
#include "base/parallel.h"
#include "base/status.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Read-only once it is set up: any number of threads may look at it. */
typedef struct iso_environment iso_environment;

/* Reads a picture: OpenEXR with the channels R, G and B (linear), or PNG (sRGB). Negative values become 0.
 * limit: bytes that it may take. ISO_ERR_IO, ISO_ERR_NOMEM, ISO_ERR_LIMIT, ISO_ERR_UNSUPPORTED (an .exr in a
 * build without OpenEXR); ISO_ERR_FORMAT: not such a picture, a side of one pixel, a pixel that is NaN or
 * infinite. */
iso_status iso_environment_read(const char *path, uint64_t limit, iso_pool *pool,
                                iso_environment **environment, iso_error *error);

/* Makes the built-in studio: a bright horizon between a dim ceiling and a dark floor, a light box above and
 * four upright ones around. ISO_ERR_NOMEM. */
iso_status iso_environment_studio(iso_environment **environment, iso_error *error);

/* Copies width * height pixels of three floats, all finite and not negative; sides of at least 2.
 * ISO_ERR_NOMEM. */
iso_status iso_environment_create(int width, int height, const float *rgb, iso_environment **environment,
                                  iso_error *error);
void iso_environment_destroy(iso_environment *environment);

/* Turns the environment for a world whose up axis is `up` (unit). A new one has z up. */
void iso_environment_set_up(iso_environment *environment, iso_vec3 up);

/* Width and height of the picture. */
void iso_environment_size(const iso_environment *environment, int size[2]);

/* The light from a direction (world space, any length but 0): bilinear between the centres of pixels. */
void iso_environment_look(const iso_environment *environment, iso_vec3 direction, double rgb[3]);

#ifdef __cplusplus
}
#endif
#endif
