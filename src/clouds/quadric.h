/* quadric: the normal of a surface at a point from a quadratic height function that is fitted to the point's
 * neighbours (Cazals and Pouget 2005, "Estimating differential quantities using polynomial fitting of
 * osculating jets", degree 2). A plane through neighbours that lie to one side of a bend is tilted, a
 * quadratic function is not; on noisy points the plane is the better of the two. Internal to clouds. */
#ifndef ISO_CLOUDS_QUADRIC_H
#define ISO_CLOUDS_QUADRIC_H

#include <stdbool.h>

#include "base/geometry.h"

enum { ISO_QUADRIC_POINTS = 16 }; /* most points */

/* Fits a height function over the plane through the origin that is perpendicular to `normal` (unit) to the
 * origin and `count` further points, near ones with more weight. If the function fits the points better than
 * a plane does, and its normal is less than 45 degrees from `normal`, replaces the normal by that of the
 * function at the origin and returns true. Offsets are positions relative to the origin, in any unit; count
 * is at most ISO_QUADRIC_POINTS. */
bool iso_quadric_normal(const iso_vec3 *offsets, int count, iso_vec3 *normal);

#endif
