/* glass: pictures of a transparent solid that reflects and refracts its environment.
 *
 * A refraction mode computes the light that each sample sees; the light of a pixel's samples is averaged and
 * converted to display values. Three of the modes follow only the straight ray to the eye, and use a map of
 * the points where it enters and leaves the solid (iso_glass_map).
 *
 * none: shows what is straight behind the solid, attenuated by the solid's thickness.
 *
 * single and layers: bend the ray once, as the first surface bends it, or by an angle that grows with the
 * number of layers (Zhang and Pajarola 2006, "Single-pass point rendering and transparent shading", section
 * 5.2.3, equation 12). The second is an effect, not an approximation of refraction, because the number of
 * layers does not determine the path of a ray; the paper does not claim more.
 *
 * two-sided: bends the ray where it enters and where it first leaves (Wyman 2005, "An approximate image-space
 * approach for interactive refraction"). A ray that is totally reflected there is followed through the solid
 * as far as the map shows it.
 *
 * The fifth mode, traced, follows rays through the solid: truth/traced_glass.h. */
#ifndef ISO_RENDER_GLASS_GLASS_H
#define ISO_RENDER_GLASS_GLASS_H

#include <math.h>
#include <stdint.h>
#include <string.h>

#include "render/glass/optics.h"
#include "render/shading/shading.h"
#include "render/view/strip.h"

/* Returns "auto", "none", "single", "layers", "two-sided" or "traced". */
const char *iso_refraction_name(iso_refraction refraction);

/* ---- maps */

/* The points where a sample's straight ray enters and leaves the solid. */
typedef struct iso_glass_crossings {
    float depth[2];     /* of the points where it first enters and first leaves, mm; INFINITY: there is no
                           such point */
    float normal[2][3]; /* the normals there, in view space, out of the solid */
    float thickness;    /* mm of the ray inside the solid */
    uint16_t layers;    /* number of crossings */
    uint16_t inside;    /* 1: the ray begins inside the solid, at the near plane or at the volume's border;
                           depth[0] is then the beginning, which is no crossing and has no normal */
} iso_glass_crossings;

/* Begins the crossings of a sample's ray, which starts at `depth`; `inside`: in the solid. */
static inline iso_glass_crossings iso_glass_crossings_begin(float depth, bool inside) {
    iso_glass_crossings c;
    memset(&c, 0, sizeof c);
    c.depth[0] = inside ? depth : INFINITY;
    c.depth[1] = INFINITY;
    c.inside = inside;
    return c;
}

/* Adds the next crossing along the ray. reached: depth of the previous crossing, or of the ray's beginning;
 * length: mm along the ray for 1 mm of depth. */
static inline void iso_glass_crossings_add(iso_glass_crossings *c, float reached, float depth, float length,
                                           bool leaves, const float normal[3]) {
    const int number = c->layers + c->inside;
    if (leaves) c->thickness += (depth - reached) * length;
    if (number < 2) {
        c->depth[number] = depth;
        memcpy(c->normal[number], normal, sizeof c->normal[number]);
    }
    if (c->layers < UINT16_MAX - 1) c->layers++;
}

/* The crossings of all samples of a picture. */
typedef struct iso_glass_map {
    const iso_view *view;           /* of the samples; borrowed */
    iso_glass_crossings *crossings; /* view->width * view->height */
} iso_glass_map;

/* Allocates the crossings, uninitialised. ISO_ERR_NOMEM. */
iso_status iso_glass_map_create(const iso_view *view, iso_glass_map *map, iso_error *error);
void iso_glass_map_free(iso_glass_map *map);

/* ---- pictures */

/* Computes the light (linear) that sample (x, y) of the whole picture sees. Returns false, without changing
 * rgb, if the ray misses the solid. Called by several threads. */
typedef bool iso_glass_fn(const void *context, int x, int y, double rgb[3]);

/* The context of iso_glass_light. */
typedef struct iso_mapped_glass {
    const iso_glass *glass;
    const iso_glass_map *map;
    iso_refraction refraction; /* neither AUTO nor TRACED */
} iso_mapped_glass;

/* An iso_glass_fn that uses a map of crossings. */
bool iso_glass_light(const void *context, int x, int y, double rgb[3]);

/* The context of iso_dispersed_glass_light; all pointers are borrowed. */
typedef struct iso_dispersed_glass {
    iso_glass_fn *light;
    const void *contexts[3]; /* of `light`, for red, green and blue: as iso_glass_disperse says */
} iso_dispersed_glass;

/* An iso_glass_fn that takes each colour from a context of its own. */
bool iso_dispersed_glass_light(const void *context, int x, int y, double rgb[3]);

/* A picture to shade; all pointers are borrowed for the call. */
typedef struct iso_glass_picture {
    const iso_view *view;   /* the view of all samples of the whole picture */
    const iso_strip *strip; /* the rows to shade; its gbuffer is not used */
    iso_glass_fn *light;
    const void *context;
    const iso_environment *behind; /* NULL, or what samples that miss the solid see instead of `background` */
    const iso_shading *background; /* background, transparent */
    iso_image *image;
    iso_pool *pool; /* NULL: the calling thread */
} iso_glass_picture;

/* Shades the strip's rows of the image; returns the number of samples that show the solid. With
 * background->transparent, alpha is the share of these among the pixel's samples. The bytes are the same for
 * every number of threads and for strips of any height. */
size_t iso_glass_shade(const iso_glass_picture *picture);

#endif
