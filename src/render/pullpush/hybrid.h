/* hybrid: a surface as points where its cells are small in the picture and as triangles where they are large,
 * in one pyramid (Marroquim, Kraus and Cavalcanti 2008, section 5.2).
 *
 * Each brick is drawn one way or the other. Vertices of the mesh are the edge points, bit for bit. Within
 * half a voxel of a brick that is drawn as points, samples of triangles are fragments in the base level,
 * with the points' radius, so that the points' surface goes on to the triangles without a gap. The paper
 * puts all other triangles into the base level, too, with a radius near 0. Here they are drawn after the
 * pyramid: the base level keeps one fragment a pixel, so that triangles would hide the points behind them,
 * and the surface of these points would end before it reaches the triangles' outline. Where points of the
 * surface are less than a depth interval before its triangles, the triangles are drawn, which are nearer to
 * the surface. */
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
