/* triangle_tree: a bounding volume hierarchy over triangles, for winding numbers and nearest points.
 *
 * Winding numbers: Jacobson, Kavan and Sorkine-Hornung 2013, "Robust inside-outside segmentation using
 * generalized winding numbers"; far clusters of triangles by their dipole, as in Barill et al. 2018, "Fast
 * winding numbers for soups and clouds"; solid angles after Van Oosterom and Strackee 1983.
 *
 * Building takes O(n log n), a query O(log n) where the triangles are spread evenly. No function of libm is
 * used whose result depends on the machine. Queries are thread-safe. */
#ifndef ISO_GRIDS_CLOSING_TRIANGLE_TREE_H
#define ISO_GRIDS_CLOSING_TRIANGLE_TREE_H

#include <stddef.h>

#include "base/geometry.h"
#include "base/primitives.h"
#include "base/status.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct iso_triangle_tree iso_triangle_tree;

/* The triangles are copied; there must be one at least. ISO_ERR_NOMEM. */
iso_status iso_triangle_tree_create(const iso_triangles *mesh, iso_triangle_tree **tree, iso_error *error);
void iso_triangle_tree_destroy(iso_triangle_tree *tree); /* NULL is fine */

/* How often the triangles wind around p: 1 inside a closed mesh whose triangles are counter-clockwise seen
 * from outside, -1 when they are clockwise, 0 outside. 0 for NULL. */
double iso_triangle_tree_winding(const iso_triangle_tree *tree, iso_vec3 p);

/* What a search for the nearest triangle begins with and finds. */
typedef struct iso_nearest {
    double
        squared; /* of the distance: only what is nearer is looked for; the distance found, else unchanged */
    iso_vec3 point; /* the nearest point, unchanged when none was found */
    size_t
        triangle; /* the tree's number of a triangle that may be near, 0 at first; the one that was found */
} iso_nearest;

void iso_triangle_tree_nearest(const iso_triangle_tree *tree, iso_vec3 p, iso_nearest *nearest);

#ifdef __cplusplus
}
#endif
#endif
