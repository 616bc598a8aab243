/* shading: Phong from a gbuffer, with the same arithmetic for every method and engine. No libm
 * transcendentals. */
#ifndef ISO_RENDER_SHADING_SHADING_H
#define ISO_RENDER_SHADING_SHADING_H

#include <stdbool.h>
#include <stdint.h>

#include "base/parallel.h"
#include "image/image.h"
#include "isopoint.h"
#include "render/strip.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Two directional lights that move with the camera (a key light from above left, a fill light from the eye),
 * ambient and a specular lobe of exponent 32. Shading is two-sided: a normal that faces away is turned. */
typedef struct iso_shading {
    const iso_rgb *colors; /* one per surface */
    int color_count;       /* surfaces beyond it take the last colour */
    iso_rgb background;
    int transparent; /* 1: background alpha 0 */
} iso_shading;

/* The colour of the surface with this number when none was chosen. */
iso_rgb iso_shading_palette(int surface);

static inline bool iso_rgb_equal(iso_rgb a, iso_rgb b) {
    return a.r == b.r && a.g == b.g && a.b == b.b;
}

/* Colour of one sample: view-space unit normal, direction from the surface to the eye (of any length).
 * Components 0 .. 1. iso_shade's samples are this, with (-u, -v, -1) for the ray through (u, v, 1). */
void iso_shade_sample(const float normal[3], const float to_eye[3], iso_rgb color, float rgb[3]);

/* Shades a strip into its rows of the image, which has the picture's width: the mean of a pixel's covered
 * samples over the background, or with it as alpha (not premultiplied). Returns how many samples show a
 * surface. color_count must be positive. The same bytes for every instruction set and number of threads, and
 * however a picture is cut into strips. */
size_t iso_shade(const iso_shading *shading, const iso_strip *strip, iso_image *image, iso_pool *pool);

#ifdef __cplusplus
}
#endif
#endif
