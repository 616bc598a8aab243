/* shading: Phong from a gbuffer, with the same arithmetic for every method and engine. No libm
 * transcendentals. */
#ifndef ISO_RENDER_SHADING_H
#define ISO_RENDER_SHADING_H

#include <stdint.h>

#include "base/parallel.h"
#include "image/camera.h"
#include "image/image.h"
#include "render/gbuffer.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Colours are display values 0 .. 255. */
typedef struct iso_rgb {
    uint8_t r, g, b;
} iso_rgb;

/* Two directional lights that move with the camera (a key light from above left, a fill light from the eye),
 * ambient and a specular lobe of exponent 32 (five squarings). Shading is two-sided: a normal that faces away
 * is turned. */
typedef struct iso_shading {
    const iso_rgb *colors; /* one per surface */
    int color_count;       /* surfaces beyond it take the last colour */
    iso_rgb background;
    int transparent; /* 1: background alpha 0 */
} iso_shading;

/* Colour of one sample: view-space unit normal, unit direction from the surface to the eye. Components 0
 * .. 1. */
void iso_shade_sample(const float normal[3], const float to_eye[3], iso_rgb color, float rgb[3]);

/* Shades a supersampled gbuffer of (image width * factor) x (rows * factor) into rows y0 .. y0 + rows - 1 of
 * the image, averaging factor x factor samples (premultiplied, then made straight). `view` is the gbuffer's.
 */
void iso_shade(const iso_shading *shading, const iso_view *view, const iso_gbuffer *gbuffer, int factor,
               int y0, iso_image *image, iso_pool *pool);

#ifdef __cplusplus
}
#endif
#endif
