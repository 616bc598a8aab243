/* The refined reconstruction as it is meant (render/refined/refined.h), pixel by pixel, in double precision.
 */
#ifndef ISO_TESTS_REFINED_REFERENCE_H
#define ISO_TESTS_REFINED_REFERENCE_H

#include "base/primitives.h"
#include "image/camera.h"
#include "render/gbuffer.h"

void refined_reference(const iso_view *view, const iso_point_view *points, iso_gbuffer *gbuffer);

#endif
