/* shading: shades the samples of a gbuffer by Phong's model, with the same arithmetic for every method and
 * engine. No transcendental functions of libm are used, so that results are the same on every machine. */
#ifndef ISO_RENDER_SHADING_SHADING_H
#define ISO_RENDER_SHADING_SHADING_H

#include <stdbool.h>
#include <stdint.h>

#include "base/parallel.h"
#include "image/image.h"
#include "isopoint.h"
#include "render/view/strip.h"

/* Two directional lights that move with the camera (a key light from above left, a fill light along the
 * optical axis), an ambient term and a specular lobe with exponent 32. Shading is two-sided: back-facing
 * normals are flipped. */
typedef struct iso_shading {
    const iso_rgb *colors; /* one per surface */
    int color_count;       /* at least 1; surfaces with higher numbers have the last colour */
    iso_rgb background;
    int transparent; /* 1: background alpha 0 */
    iso_rgb ink;     /* the colour of outlines; iso_picture_render chooses it */
} iso_shading;

/* Returns the default colour for a surface number. */
iso_rgb iso_shading_palette(int surface);

/* The four bytes, in memory order, of a pixel that shows no surface: the background, or transparent black. */
int32_t iso_shading_empty(const iso_shading *shading);

static inline bool iso_rgb_equal(iso_rgb a, iso_rgb b) {
    return a.r == b.r && a.g == b.g && a.b == b.b;
}

/* Colour (0 .. 1) of one sample, given its unit normal and the direction to the eye (of any length), both
 * in view space. iso_shade computes the same, with the direction (-u, -v, -1) for a pixel's ray (u, v, 1). */
void iso_shade_sample(const float normal[3], const float to_eye[3], iso_rgb color, float rgb[3]);
/* The same as the bytes of a pixel, red in the low byte, opaque. */
uint32_t iso_shade_pixel(const float normal[3], const float to_eye[3], iso_rgb color);
/* The same of a sample that the shares `ambient` of the light from all around and `key` of the key light
 * reach. */
void iso_shade_occluded(const float normal[3], const float to_eye[3], iso_rgb color, float ambient, float key,
                        float rgb[3]);

/* Shades a strip into its rows of the image, which has the picture's width. A pixel's colour is the mean
 * of its covered samples, each rounded to 8 bits, blended with the background by coverage, or with
 * `transparent` stored with coverage as alpha (not premultiplied). Returns the number of samples that show a
 * surface. The result has the same bytes for every instruction set and number of threads, and however the
 * picture is cut into strips. */
size_t iso_shade(const iso_shading *shading, const iso_strip *strip, iso_image *image, iso_pool *pool);

/* Samples that are shaded already: RGBA, opaque where they show a surface, else 0. */
typedef struct iso_shaded_samples {
    const int32_t *samples; /* (image's width * factor) x (rows * factor) */
    int factor;             /* 2 .. ISO_FACTOR_MAX */
    int y0, rows;           /* the rows of the image that they are for */
} iso_shaded_samples;

/* Writes their means into the rows of the image, as iso_shade makes them; in the calling thread. */
void iso_average_samples(const iso_shading *shading, const iso_shaded_samples *shaded, iso_image *image);

#endif
