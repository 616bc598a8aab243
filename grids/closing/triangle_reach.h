/* triangle_reach: how far beside each triangle of a mesh the points lie that it can be nearest to.
 *
 * Let x be a point whose nearest point on the mesh is y, at distance d.
 *  - If y is inside a triangle, x lies straight above or below the triangle.
 *  - If y is on an edge, x lies between the planes through the edge that are perpendicular to the edge's two
 *    triangles (compare Mauch 2003, "Efficient algorithms for solving static Hamilton-Jacobi equations"): at
 *    most d times the sine of the angle between the triangles outside that side of either.
 *  - If y is a corner, this holds for both sides of one of the triangles around it. Otherwise x would be
 *    farther outside one side of each. As it is then inside the same side of the next triangle, these would
 *    be the left sides of all triangles, say; and the part of x - y along a direction that turns once around
 *    the corner on the mesh would always grow.
 * So if the angles are small, a point needs to be tested against few triangles. */
#ifndef ISO_GRIDS_CLOSING_TRIANGLE_REACH_H
#define ISO_GRIDS_CLOSING_TRIANGLE_REACH_H

#include "base/primitives.h"

/* Whether a triangle is more than a line, as precisely as floats say. */
bool iso_triangle_has_area(const iso_triangles *mesh, size_t triangle);

/* Finds the reach of each triangle of a mesh: of every point, the nearest point of the mesh is on a triangle
 * outside whose sides, seen along its normal, the point is at most `reach` times its distance. 1 if an edge
 * is sharp or does not have two triangles; triangles without area do not count. Returns false if there is no
 * memory. */
bool iso_triangle_reaches(const iso_triangles *mesh, float *reaches);

#endif
