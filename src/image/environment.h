/* environment: the light that arrives from every direction around a scene, as an equirectangular picture of
 * linear light.
 *
 * The top row of the picture is straight above, the bottom row straight below. The middle column is in front
 * of the preset camera "front" (iso_direction_vectors); columns to its right are to the right of that
 * camera's view. The environment is infinitely far away, and stays fixed to the world when the camera
 * turns. */
#ifndef ISO_IMAGE_ENVIRONMENT_H
#define ISO_IMAGE_ENVIRONMENT_H

#include "base/geometry.h"
#include "base/parallel.h"
#include "base/status.h"

/* Read-only after it has been set up; may then be used by any number of threads. */
typedef struct iso_environment iso_environment;

/* Reads an environment from OpenEXR with the channels R, G and B (linear) or from PNG (sRGB). Negative values
 * become 0. `limit`: largest number of bytes to allocate. ISO_ERR_IO, ISO_ERR_NOMEM, ISO_ERR_LIMIT,
 * ISO_ERR_UNSUPPORTED (an .exr in a build without OpenEXR); ISO_ERR_FORMAT: another kind of picture, a side
 * of one pixel, or a pixel that is NaN or infinite. */
iso_status iso_environment_read(const char *path, uint64_t limit, iso_pool *pool,
                                iso_environment **environment, iso_error *error);

/* Makes the built-in studio: a bright horizon between a dim ceiling and a dark floor, a light box above and
 * four upright ones around. ISO_ERR_NOMEM. */
iso_status iso_environment_studio(iso_environment **environment, iso_error *error);

/* Makes an environment of width * height pixels of three floats, which it copies. All must be finite and not
 * negative, and each side at least 2. ISO_ERR_NOMEM. */
iso_status iso_environment_create(int width, int height, const float *rgb, iso_environment **environment,
                                  iso_error *error);
void iso_environment_destroy(iso_environment *environment);

/* Sets the world's up axis (unit vector). It is z in a new environment. */
void iso_environment_set_up(iso_environment *environment, iso_vec3 up);

/* Width and height of the picture. */
void iso_environment_size(const iso_environment *environment, int size[2]);

/* Returns the light from a direction (world space, any length but 0), interpolated bilinearly between the
 * centres of pixels. */
void iso_environment_look(const iso_environment *environment, iso_vec3 direction, double rgb[3]);

#endif
