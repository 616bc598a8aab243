/* raycaster: the definition of iso_raycaster. Internal to truth. */
#ifndef ISO_TRUTH_RAYCASTER_H
#define ISO_TRUTH_RAYCASTER_H

#include "grids/ray/ray_tracer.h"
#include "truth/raycast.h"

/* Whether the point of a ray at a hit is left of what a clip (NULL: none) cuts away. */
static inline bool iso_raycast_shows(const iso_clip *clip, iso_vec3 origin, iso_vec3 direction, double t) {
    return !clip || iso_clip_shows(clip, iso_vec3_add(origin, iso_vec3_scale(direction, t)));
}

struct iso_raycaster {
    iso_ray_tracer *tracer;
    bool level_set; /* the solid is where the field is below the isovalue */
    double voxel;   /* the smallest side of a voxel, mm */
};

#endif
