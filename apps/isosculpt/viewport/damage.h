/* damage: the parts of a picture that an edit can have changed, as a few rectangles around the projected
 * boxes of the voxels that the change log names. */
#ifndef ISO_APPS_ISOSCULPT_VIEWPORT_DAMAGE_H
#define ISO_APPS_ISOSCULPT_VIEWPORT_DAMAGE_H

#include "base/c_linkage.h"
#include "grids/hgrid.h"
#include "image/camera.h"

ISO_C_BEGIN

/* Pixels x0 .. x1 - 1, y0 .. y1 - 1. */
typedef struct isosculpt_rectangle {
    int x0, y0, x1, y1;
} isosculpt_rectangle;

static inline size_t isosculpt_rectangle_area(isosculpt_rectangle r) {
    return (size_t)(r.x1 - r.x0) * (size_t)(r.y1 - r.y0);
}

/* Zero-initialise. */
enum { ISOSCULPT_RECTANGLES = 6 };
typedef struct isosculpt_damage {
    isosculpt_rectangle rectangle[ISOSCULPT_RECTANGLES];
    int count;
} isosculpt_damage;

/* Adds a rectangle; rectangles that lie close together are merged. An empty one changes nothing. */
void isosculpt_damage_add(isosculpt_damage *damage, isosculpt_rectangle rectangle);

/* Adds the pixels that edits of a log after number `drawn_edit` can have changed. A picture of trilinear
 * cells with normals from central differences depends on voxels up to two away. */
void isosculpt_damage_add_edits(isosculpt_damage *damage, const iso_view *view, const iso_hgrid *grid,
                                const iso_change_log *log, uint64_t drawn_edit);

/* Sum of the rectangles' areas, in pixels. */
size_t isosculpt_damage_area(const isosculpt_damage *damage);

ISO_C_END
#endif
