/* surface_colors: surfaces whose colour differs from place to place, computed for each sample of a
 * picture. */
#ifndef ISO_RENDER_VIEW_SURFACE_COLORS_H
#define ISO_RENDER_VIEW_SURFACE_COLORS_H

#include "base/nearby.h"
#include "render/view/project.h"

/* A point of a surface that a sample shows. */
typedef struct iso_colored_point {
    iso_vec3 place;  /* in the world, mm */
    iso_vec3 normal; /* in the world: unit, out of the solid */
    double depth;    /* along the view, mm */
} iso_colored_point;

/* Thread-safe. */
typedef struct iso_surface_colors {
    /* The colour of a point. *nearby: is passed from sample to sample of a row, or of another part of a
     * picture that does not depend on threads; the colour hardly depends on it. */
    iso_rgb (*at)(const void *context, const iso_colored_point *point, iso_nearby *nearby);
    const void *context; /* borrowed */
} iso_surface_colors;

/* The point at `depth` (mm) behind the middle of sample (x, y). normal: in view space. */
static inline iso_colored_point iso_colored_point_at(const iso_view *view, int x, int y, double depth,
                                                     iso_vec3 normal) {
    const double *r = view->rotation;
    iso_vec3 origin, direction;
    iso_view_ray(view, x + 0.5, y + 0.5, &origin, &direction);
    return (iso_colored_point){.place = iso_vec3_add(origin, iso_vec3_scale(direction, depth)),
                               .normal = iso_vec3_make(r[0] * normal.x + r[3] * normal.y + r[6] * normal.z,
                                                       r[1] * normal.x + r[4] * normal.y + r[7] * normal.z,
                                                       r[2] * normal.x + r[5] * normal.y + r[8] * normal.z),
                               .depth = depth};
}

#endif
