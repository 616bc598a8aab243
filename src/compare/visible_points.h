/* visible_points: which points of a set are seen in a picture, by pass 2 of Guennebaud et al. 2004 (section
 * 4.2): every point is drawn as one pixel that holds its number, if the surface does not hide it; a pixel
 * keeps the nearest point. The points that are left are those that the paper draws as splats. */
#ifndef ISO_COMPARE_VISIBLE_POINTS_H
#define ISO_COMPARE_VISIBLE_POINTS_H

#include "base/primitives.h"
#include "image/camera.h"

/* How many points there are, and why they are not seen. `seen` are the rest. */
typedef struct iso_visible_points {
    size_t points, seen;
    size_t outside;    /* the centre is not in the picture */
    size_t hidden;     /* by the surface */
    size_t same_pixel; /* another point in the same pixel is nearer */
} iso_visible_points;

/* Finds the points that are seen. `depth`: of the surface in each of the view's width * height pixels, mm;
 * infinite where there is none. A point is hidden when it is more than `tolerance` mm behind that. number:
 * receives for each pixel 1 + the index of the point (in the arrays of `points`), 0 where there is none.
 * nearest: working memory, a float for each pixel. Points whose position is not finite count as outside. */
iso_visible_points iso_find_visible_points(const iso_point_view *points, const iso_view *view,
                                           const float *depth, double tolerance, uint32_t *number,
                                           float *nearest);

#endif
