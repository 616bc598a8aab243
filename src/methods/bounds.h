/* bounds: the world boxes of what methods draw from, for framing pictures.
 *
 * Where the volume's axes are the world's, the box is that of the index positions. Where they are oblique,
 * each position is looked at: the world box around the turned index box would be too large. */
#ifndef ISO_METHODS_BOUNDS_H
#define ISO_METHODS_BOUNDS_H

#include "base/primitives.h"
#include "exact/exact.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Empty when there is nothing. Millimetres. */
iso_box iso_bounds_of_points(const iso_point_view *view);
iso_box iso_bounds_of_mesh(const iso_mesh_view *view);
/* `transform` is the grid's. */
iso_box iso_bounds_of_cells(const iso_exact *cells, const iso_transform *transform);

/* Whether axes of the volume are not axes of the world. */
bool iso_bounds_is_oblique(const iso_transform *transform);

/* The box of all positions in the space that `affine` takes index coordinates to. */
iso_box iso_bounds_of_each_point(const iso_point_view *view, const iso_affine *affine);
iso_box iso_bounds_of_each_vertex(const iso_mesh_view *view, const iso_affine *affine);

/* Widens `box` by `more`, which may be empty. */
void iso_bounds_add(iso_box *box, const iso_box *more);

#ifdef __cplusplus
}
#endif
#endif
