/* splat: a disc as the shaders read it (shaders/splats.glsl). Inside render/gl only. */
#ifndef ISO_RENDER_GL_SPLAT_H
#define ISO_RENDER_GL_SPLAT_H

#include "render/groups/banded_discs.h"
#include "render/groups/grouping.h"

typedef struct iso_gl_splat {
    float x, y, z, normal[3], radius;
    uint32_t paint; /* the group, and the colour in the upper three bytes */
} iso_gl_splat;

/* groups NULL: group 0. */
static inline iso_gl_splat iso_gl_splat_make(const iso_disc *disc, const iso_point_view *points,
                                             const iso_groups *groups) {
    uint32_t paint = groups ? groups->group[disc->point] : 0;
    for (int k = 0; k < 3 && points->colors; k++)
        paint |= (uint32_t)points->colors[disc->point][k] << (8 * k + 8);
    return (iso_gl_splat){disc->x,      disc->y, disc->z, {disc->normal[0], disc->normal[1], disc->normal[2]},
                          disc->radius, paint};
}

#endif
