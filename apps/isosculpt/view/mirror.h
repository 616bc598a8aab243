/* mirror: the lines along which a plane cuts what is seen. */
#ifndef ISO_APPS_ISOSCULPT_VIEW_MIRROR_H
#define ISO_APPS_ISOSCULPT_VIEW_MIRROR_H

#include "apps/isosculpt/view/view.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Pixels of the full picture. */
typedef struct isosculpt_segment {
    double x[2], y[2];
} isosculpt_segment;

/* Where the surface in the layer crosses the plane of world coordinate `axis` at `at` (mm), from every fourth
 * sample: up to `room` segments; how many. 0 for a layer that OpenGL holds: its samples are far away. */
size_t isosculpt_mirror_lines(const isosculpt_layer *layer, int axis, double at, isosculpt_segment *segments,
                              size_t room);

#ifdef __cplusplus
}
#endif
#endif
