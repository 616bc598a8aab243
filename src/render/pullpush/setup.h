/* pullpush_setup: what pull-push needs to know of a view, the same for every engine. Internal to render. */
#ifndef ISO_RENDER_PULLPUSH_SETUP_H
#define ISO_RENDER_PULLPUSH_SETUP_H

#include "render/pullpush/kernel.h"
#include "render/pullpush/pullpush.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The shape of a view's pyramid for discs of projected radii radius[0] .. radius[1], without optional planes.
 */
iso_pyramid_layout iso_pullpush_layout(const iso_view *view, const float radius[2]);

/* All but `points` and `pyramid`; `packed` is what the points are. */
iso_point_projection iso_pullpush_projection(const iso_pyramid_layout *layout, const iso_projector *projector,
                                             const iso_transform *transform, bool packed, bool cull);

/* All but `pyramid` and `target`; `radius` is the points' own, mm, of those that share one; `two_sided` when
 * nothing is culled. */
iso_pullpush_params iso_pullpush_params_make(const iso_pyramid_layout *layout, const iso_projector *projector,
                                             double radius, iso_reconstruction reconstruction,
                                             bool two_sided);

#ifdef __cplusplus
}
#endif
#endif
