/* triangle_tree: a bounding volume hierarchy over triangles, for winding numbers and nearest points.
 *
 * Winding numbers: Jacobson, Kavan and Sorkine-Hornung 2013, "Robust inside-outside segmentation using
 * generalized winding numbers"; far clusters of triangles are approximated by their dipole, as in Barill et
 * al. 2018, "Fast winding numbers for soups and clouds"; solid angles after Van Oosterom and Strackee 1983.
 *
 * Building takes O(n log n), a query O(log n) for evenly distributed triangles. Functions of libm whose
 * results depend on the machine are not used. Queries are thread-safe. */
#ifndef ISO_GRIDS_CLOSING_TRIANGLE_TREE_H
#define ISO_GRIDS_CLOSING_TRIANGLE_TREE_H

#include <stddef.h>

#include "base/geometry.h"
#include "base/primitives.h"
#include "base/status.h"

typedef struct iso_triangle_tree iso_triangle_tree;

/* Copies the triangles, at least one; without those that have no area, if others have one. ISO_ERR_NOMEM. */
iso_status iso_triangle_tree_create(const iso_triangles *mesh, iso_triangle_tree **tree, iso_error *error);
void iso_triangle_tree_destroy(iso_triangle_tree *tree); /* NULL is allowed */

/* Returns the winding number of the triangles around p: 0 outside a closed mesh; inside it 1 if the triangles
 * are counter-clockwise seen from outside, -1 if they are clockwise. 0 for NULL. */
double iso_triangle_tree_winding(const iso_triangle_tree *tree, iso_vec3 p);

/* Finds by how much the winding number at q exceeds that at p, from the triangles that the way between them
 * crosses; this is fast if they are near to each other. The triangles must be closed. Returns false if the
 * way passes too near to an edge or ends too near to a triangle, so that this cannot be told. NULL: *change
 * is 0. */
bool iso_triangle_tree_change(const iso_triangle_tree *tree, iso_vec3 p, iso_vec3 q, int *change);

/* The start and the result of a search for the nearest triangle. Set `squared` to the squared distance within
 * which to search, and `triangle` to a guess (0, or the result for a nearby point). If a triangle is nearer,
 * all three are set; otherwise nothing changes. */
typedef struct iso_nearest {
    double squared; /* distance, mm2 */
    iso_vec3 point;
    size_t triangle; /* number of the triangle in the tree */
} iso_nearest;

/* The point of a triangle that is nearest to p. */
iso_vec3 iso_triangle_nearest(const float triangle[3][3], iso_vec3 p);

typedef struct iso_tree_triangle {
    float corners[3][3];
    float reach;     /* grids/closing/triangle_reach.h */
    uint32_t number; /* of the triangle in the mesh */
} iso_tree_triangle;

/* The number of the tree's triangles, and one of them. */
size_t iso_triangle_tree_count(const iso_triangle_tree *tree);
const iso_tree_triangle *iso_triangle_tree_get(const iso_triangle_tree *tree, size_t triangle);

/* Calls `visit` with every triangle in a leaf whose box meets `box`. */
void iso_triangle_tree_visit(const iso_triangle_tree *tree, const iso_box *box,
                             void (*visit)(void *context, const iso_tree_triangle *triangle), void *context);

/* Searches for the triangle that is nearest to p. */
void iso_triangle_tree_nearest(const iso_triangle_tree *tree, iso_vec3 p, iso_nearest *nearest);

#endif
