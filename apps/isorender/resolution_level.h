/* resolution_level: the level of a multiscale image that is read, and the camera by which it is chosen. */
#ifndef ISO_APPS_ISORENDER_RESOLUTION_LEVEL_H
#define ISO_APPS_ISORENDER_RESOLUTION_LEVEL_H

#include "apps/isorender/isorender.h"

/* Sets job->input to the options that the input is read with: for --level auto to the finest level whose
 * voxels are at least half a pixel in a picture of the whole volume, else the coarsest, which a message says.
 * Errors of iso_volume_read_info. */
iso_status isorender_level_choose(isorender_job *job, iso_error *error);

/* camera.c: the camera of a picture that frames a box, before surfaces are known. */
iso_camera isorender_camera_of_box(isorender_job *job, const iso_box *box);

#endif
