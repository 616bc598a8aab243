/* raycaster: the definition of iso_raycaster. Internal to truth. */
#ifndef ISO_TRUTH_RAYCASTER_H
#define ISO_TRUTH_RAYCASTER_H

#include "grids/ray/ray_tracer.h"
#include "truth/raycast.h"

struct iso_raycaster {
    iso_ray_tracer *tracer;
    bool level_set; /* the solid is where the field is below the isovalue */
    double voxel;   /* the smallest side of a voxel, mm */
};

#endif
