/* keyframes: --keyframes: options of a scene whose values change from picture to picture. A keyframe is a
 * number of a picture, and options as scenes have them; docs/movies.md describes the file. Between two
 * keyframes that have an option its numbers are interpolated. */
#ifndef ISO_APPS_ISORENDER_KEYFRAMES_H
#define ISO_APPS_ISORENDER_KEYFRAMES_H

#include "apps/isorender/isorender.h"

/* Reads settings->keyframe_file into settings->keyframes, when the other options are known:
 * isorender_keyframes_free when done. Isovalues and opacities of the settings become those of the first
 * picture. ISO_ERR_IO, ISO_ERR_FORMAT: the file; ISO_ERR_USAGE: an option that cannot change, or a value of
 * it; ISO_ERR_NOMEM. */
iso_status isorender_keyframes_read(isorender_settings *settings, iso_error *error);
void isorender_keyframes_free(isorender_settings *settings);

int isorender_keyframes_count(const struct isorender_keyframes *keyframes);
/* The settings with the values of keyframe `i`, to be checked. */
isorender_settings *isorender_keyframe(const struct isorender_keyframes *keyframes, int i);
/* The number of pictures: up to the last keyframe. */
int isorender_keyframes_pictures(const struct isorender_keyframes *keyframes);
/* Whether isovalues or opacities change. */
bool isorender_keyframes_change_isovalues(const struct isorender_keyframes *keyframes);
bool isorender_keyframes_change_opacities(const struct isorender_keyframes *keyframes);

/* The settings of picture `frame`, which are kept until the next call; `settings` without keyframes. */
const isorender_settings *isorender_keyframes_at(const isorender_settings *settings, int frame);

/* Finds the box that all pictures frame, and how far from it they are taken. Leaves the surfaces as they
 * were. */
iso_status isorender_keyframes_measure(isorender_job *job, iso_error *error);
/* Makes job->settings, the camera, surfaces and opacities those of the job's picture `frame`; *remade:
 * isovalues changed. ISO_ERR_USAGE: a camera that cannot see; errors of extraction. */
iso_status isorender_keyframes_show(isorender_job *job, int frame, bool *remade, iso_error *error);

#endif
