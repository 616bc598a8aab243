/* discs_reference: the method discs as render/discs/discs.h defines it, pixel by pixel, in
 * double. */
#ifndef ISO_TESTS_DISCS_REFERENCE_H
#define ISO_TESTS_DISCS_REFERENCE_H

#include "base/primitives.h"
#include "image/camera.h"
#include "render/view/gbuffer.h"

/* `filtered`: flat discs, convolved with the low-pass filter where they are small. */
void discs_reference(const iso_view *view, const iso_point_view *points, bool filtered, iso_gbuffer *gbuffer);

#endif
