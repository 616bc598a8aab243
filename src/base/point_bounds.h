/* point_bounds: boxes around the points of a span and around their normals, so that who draws them can leave
 * out whole spans. */
#ifndef ISO_BASE_POINT_BOUNDS_H
#define ISO_BASE_POINT_BOUNDS_H

#include "base/primitives.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Bounds of points first .. first + count - 1 of the view. Points whose position is not finite are left out,
 * normals without a direction too; of nothing, lo > hi. Thread-safe. */
void iso_point_bounds_find(const iso_point_view *view, size_t first, size_t count, iso_point_bounds *bounds);

#ifdef __cplusplus
}
#endif
#endif
