/* eye_dome: eye-dome lighting (Boucheny 2009, "Interactive scientific visualization of large datasets:
 * towards a perception-based approach"): darkens a sample by how far the surfaces around it in the picture
 * stand out before it. It needs depths only, no normals, and shows edges, hollows and single points.
 *
 * A step towards a neighbour at a distance of n pixels that is d nearer to the eye is the slope s = d / n in
 * pixels as wide as they are at the sample's depth, so that the light depends neither on the unit of length
 * nor on the picture's resolution. Boucheny's differences are not bounded; here a neighbour blocks
 * s / (1 + s), at most all of what it can. Its light is 2^(-ISO_EYE_DOME_STRENGTH * mean), over neighbours in
 * eight directions and ISO_EYE_DOME_RINGS distances. Neighbours that show no surface block nothing. */
#ifndef ISO_RENDER_SHADING_EYE_DOME_H
#define ISO_RENDER_SHADING_EYE_DOME_H

#include "base/parallel.h"
#include "image/camera.h"
#include "render/view/gbuffer.h"

/* Neighbours are 1, 2, 4 pixels away, on diagonals in both coordinates. */
enum { ISO_EYE_DOME_RINGS = 3, ISO_EYE_DOME_REACH = 1 << (ISO_EYE_DOME_RINGS - 1) };
#define ISO_EYE_DOME_STRENGTH 3.5f

/* Sets gbuffer->light of rows first .. last, which has been allocated, from the depths of these rows and of
 * ISO_EYE_DOME_REACH * factor rows above and below them, as far as there are any. A pixel is factor x factor
 * samples. The bytes are the same for every instruction set and number of threads. */
void iso_eye_dome_light(const iso_view *view, int factor, int first, int last, const iso_gbuffer *gbuffer,
                        iso_pool *pool);

#endif
