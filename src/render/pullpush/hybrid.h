/* hybrid: a surface as points where its cells are small in the picture and as triangles where they are large,
 * in one pyramid (Marroquim, Kraus and Cavalcanti 2008, section 5.2).
 *
 * Each brick is drawn one way or the other. Triangles are rasterized into the base level: such a polygon
 * fragment has a depth interval, widened by the depth's slope, but no ellipse, so that triangles do not grow
 * beyond their edges. Within a voxel of a brick that is drawn as points, fragments get a radius, from the
 * points' own at the seam to 0, so that points and triangles blend there. Nothing has to be matched: vertices
 * of the mesh are the edge points, bit for bit. */
#ifndef ISO_RENDER_PULLPUSH_HYBRID_H
#define ISO_RENDER_PULLPUSH_HYBRID_H

#include "render/pullpush/pullpush.h"

typedef struct iso_hybrid_opts {
    double pixels;           /* a brick whose cells can be larger is drawn as triangles; 0: 3 */
    iso_pullpush *workspace; /* borrowed; NULL: made for the call */
} iso_hybrid_opts;

/* Draws one surface from its edge points, without radii and colours of their own, and its mesh, as
 * iso_draw_pullpush (with Gaussian weights) and iso_draw_mesh do. Both have the same transform. `opts` NULL:
 * defaults. ISO_ERR_NOMEM. */
iso_status iso_draw_hybrid(const iso_target *target, const iso_point_view *points, const iso_mesh_view *mesh,
                           const iso_hybrid_opts *opts, iso_error *error);

#endif
