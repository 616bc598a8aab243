/* bounds: world boxes of points, meshes and cells, for placing cameras.
 *
 * If the volume's axes are parallel to the world's, the box is the transformed box of the index positions. If
 * they are oblique, every position is transformed, because the world box of the transformed index box would
 * be too large. */
#ifndef ISO_SCENE_BOUNDS_H
#define ISO_SCENE_BOUNDS_H

#include "base/primitives.h"
#include "exact/exact.h"

/* The following functions return a world box in mm; it is empty when there are no positions. */
iso_box iso_bounds_of_points(const iso_point_view *view);
iso_box iso_bounds_of_mesh(const iso_mesh_view *view);
/* `transform` is that of the grid. */
iso_box iso_bounds_of_cells(const iso_exact *cells, const iso_transform *transform);

/* Whether an axis of the volume is not parallel to an axis of the world. */
bool iso_bounds_is_oblique(const iso_transform *transform);

/* Returns the box of all positions, in the coordinates to which `affine` maps index coordinates. Meshes are
 * extracted ones: their vertices lie in their bricks or at most two voxels beyond them. */
iso_box iso_bounds_of_each_point(const iso_point_view *view, const iso_affine *affine);
iso_box iso_bounds_of_each_vertex(const iso_mesh_view *view, const iso_affine *affine);

/* How far a disc is drawn around its point, in radii. */
#define ISO_BOUNDS_DISC_REACH 1.4

/* The box of points with their discs, which reach ISO_BOUNDS_DISC_REACH radii, in coordinates along three
 * world vectors, to which `along` maps index coordinates. */
iso_box iso_bounds_of_each_disc(const iso_point_view *view, const iso_affine *along,
                                const iso_vec3 vectors[3]);

/* Extends `box` so that it contains `more`, which may be empty. */
void iso_bounds_add(iso_box *box, const iso_box *more);

#endif
