/* point_bounds: boxes around the points of a span and around their normals, so that renderers can skip spans
 * that are hidden or out of view. */
#ifndef ISO_BASE_POINT_BOUNDS_H
#define ISO_BASE_POINT_BOUNDS_H

#include "base/cpu.h"
#include "base/primitives.h"

/* Computes the bounds of points first .. first + count - 1 of the view. Positions that are not finite and
 * normals that are zero or not finite are ignored; when nothing is left, lo > hi. Thread-safe. */
void iso_point_bounds_find(const iso_point_view *view, size_t first, size_t count, iso_point_bounds *bounds);

/* What it calls. */
typedef void iso_point_bounds_fn(const iso_point_view *view, size_t first, size_t count,
                                 iso_point_bounds *bounds);
ISO_KERNEL_UNITS(iso_point_bounds_fn, iso_find_point_bounds);

#endif
