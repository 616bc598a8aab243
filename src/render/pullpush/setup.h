/* setup: the parameters of pull-push for a view, shared by the cpu and the gl engine. Internal to render. */
#ifndef ISO_RENDER_PULLPUSH_SETUP_H
#define ISO_RENDER_PULLPUSH_SETUP_H

#include "render/pullpush/kernel.h"
#include "render/pullpush/pullpush.h"

/* The layout of a view's pyramid for discs with projected radii from radius[0] to radius[1] pixels, without
 * optional planes and index. */
iso_pyramid_layout iso_pullpush_layout(const iso_view *view, const float radius[2]);

/* Sets all fields except `points` and `pyramid`. `packed`: points are iso_point, else iso_surfel. */
iso_point_projection iso_pullpush_projection(const iso_pyramid_layout *layout, const iso_projector *projector,
                                             const iso_transform *transform, bool packed, bool cull);

/* Sets all fields except `pyramid` and `target`, for a surface alone. `radius`: of points without radii of
 * their own, mm. `dims`: of the points' grid (iso_point_view). `two_sided`: back-facing points are drawn
 * too. */
iso_pullpush_params iso_pullpush_params_make(const iso_pyramid_layout *layout, const iso_projector *projector,
                                             double radius, const int32_t dims[3],
                                             iso_reconstruction reconstruction, bool two_sided);

/* The same for line fragments and several sets, which have depth intervals. */
iso_pullpush_params iso_pullpush_params_of_intervals(const iso_pyramid_layout *layout,
                                                     const iso_projector *projector,
                                                     iso_reconstruction reconstruction,
                                                     iso_pullpush_kind kind);

#endif
