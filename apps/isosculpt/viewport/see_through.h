/* see_through: pictures of a viewed volume with translucent surfaces, or with two isosurfaces. For the files
 * of viewport/ only.
 *
 * At rest and while the camera moves, the surfaces are drawn with all their layers (shown.h),
 * as isorender draws them. While the user drags an isovalue there is no time to extract cells; the points of
 * a level of detail are drawn instead, and only the front layer of each surface. */
#ifndef ISO_APPS_ISOSCULPT_VIEWPORT_SEE_THROUGH_H
#define ISO_APPS_ISOSCULPT_VIEWPORT_SEE_THROUGH_H

#include "apps/isosculpt/viewport/viewport.h"

/* Draws a picture of viewport->drawn.view from the points of a level of detail, which are up to date for the
 * first isovalue, into viewport->drawn.gbuffer (the first surface's samples) and viewport->image; both have
 * the size of the view. Uses viewport->tile. ISO_ERR_NOMEM. */
iso_status isosculpt_see_through_draw_quick(isosculpt_viewport *viewport, iso_error *error);

#endif
