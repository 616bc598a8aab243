/* bounds: world boxes of points, meshes and cells, for placing cameras.
 *
 * If the volume's axes are parallel to the world's, the box is the transformed box of the index positions. If
 * they are oblique, every position is transformed, because the world box of the transformed index box would
 * be too large. */
#ifndef ISO_SCENE_BOUNDS_H
#define ISO_SCENE_BOUNDS_H

#include "scene/surface.h"

/* The box of a surface's part, which exists: POINTS, MESH or CELLS. In the coordinates to which `affine` maps
 * index coordinates, NULL: in these. Empty when there are no positions. */
iso_box iso_bounds_along(const iso_scene_surface *surface, iso_part part, const iso_affine *affine);
/* The same in the world, mm. The second function is for points alone. */
iso_box iso_bounds_of_part(const iso_scene_surface *surface, iso_part part);
iso_box iso_bounds_of_points(const iso_point_view *view);

/* Whether an axis of the volume is not parallel to an axis of the world. */
bool iso_bounds_is_oblique(const iso_transform *transform);

/* Returns the box of all positions, in the coordinates to which `affine` maps index coordinates. */
iso_box iso_bounds_of_each_point(const iso_point_view *view, const iso_affine *affine);

/* How far a disc is drawn around its point, in radii. */
#define ISO_BOUNDS_DISC_REACH 1.4

/* The box of points with their discs, which reach ISO_BOUNDS_DISC_REACH radii, in coordinates along three
 * world vectors, to which `along` maps index coordinates. */
iso_box iso_bounds_of_each_disc(const iso_point_view *view, const iso_affine *along,
                                const iso_vec3 vectors[3]);

/* Extends `box` so that it contains `more`, which may be empty. */
void iso_bounds_add(iso_box *box, const iso_box *more);

#endif
