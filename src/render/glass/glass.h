/* glass: pictures of a transparent solid that reflects and refracts its environment.
 *
 * A picture is made of the light that each sample sees, which the refraction modes compute; the light of a
 * pixel's samples is averaged and converted to display values. Three of the modes need no ray but that to the
 * eye, only a map of where it enters and leaves the solid (iso_glass_map):
 * - none: what lies straight behind the solid is seen, weakened by its thickness;
 * - layers: the ray is bent once, more for each layer (Zhang and Pajarola 2006, "Single-pass point rendering
 *   and transparent shading", equation 12). The number of layers is no measure of what happens to a ray: the
 *   result is a mood, not an approximation of refraction, and the paper does not claim more;
 * - two-sided: the ray is bent where it enters and where it first leaves (Wyman 2005, "An approximate
 *   image-space approach for interactive refraction").
 * The fourth one, traced, follows rays through the solid: truth/traced_glass.h. */
#ifndef ISO_RENDER_GLASS_GLASS_H
#define ISO_RENDER_GLASS_GLASS_H

#include <math.h>
#include <stdint.h>
#include <string.h>

#include "render/glass/optics.h"
#include "render/shading/shading.h"
#include "render/strip.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum iso_refraction {
    ISO_REFRACTION_NONE,
    ISO_REFRACTION_LAYERS,
    ISO_REFRACTION_TWO_SIDED,
    ISO_REFRACTION_TRACED,
    ISO_REFRACTIONS
} iso_refraction;

/* "none", "layers", "two-sided", "traced". */
const char *iso_refraction_name(iso_refraction refraction);

/* ---- maps */

/* Where a sample's straight ray enters and leaves the solid. */
typedef struct iso_glass_crossings {
    float depth[2];     /* where it first enters and leaves, mm; INFINITY: it does not */
    float normal[2][3]; /* there, in view space, out of the solid */
    float thickness;    /* mm of the ray that lie in the solid */
    uint16_t layers;    /* number of crossings */
    uint16_t inside;    /* 1: the ray begins in the solid, at the near plane or where the volume ends: this
                         is depth[0], which is no crossing and has no normal */
} iso_glass_crossings;

/* A sample's ray begins at `depth`; inside: in the solid. */
static inline iso_glass_crossings iso_glass_crossings_begin(float depth, bool inside) {
    iso_glass_crossings c;
    memset(&c, 0, sizeof c);
    c.depth[0] = inside ? depth : INFINITY;
    c.depth[1] = INFINITY;
    c.inside = inside;
    return c;
}

/* Adds the next crossing along the ray. reached: depth of the one before, or where the ray begins; length: mm
 * of the ray per mm of depth. */
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

/* Computes the light (linear) that sample (x, y) of the whole picture sees; false, and rgb untouched: it sees
 * nothing of the solid. Called by several threads. */
typedef bool iso_glass_fn(const void *context, int x, int y, double rgb[3]);

/* The context of iso_glass_light. */
typedef struct iso_mapped_glass {
    const iso_glass *glass;
    const iso_glass_map *map;
    iso_refraction refraction; /* not ISO_REFRACTION_TRACED */
} iso_mapped_glass;

/* An iso_glass_fn: the light by a map. */
bool iso_glass_light(const void *context, int x, int y, double rgb[3]);

/* A picture to shade; all pointers are borrowed for the call. */
typedef struct iso_glass_picture {
    const iso_view *view;   /* of all samples of the whole picture */
    const iso_strip *strip; /* which rows are shaded; its gbuffer is not used */
    iso_glass_fn *light;
    const void *context;
    const iso_environment
        *behind; /* NULL, or what samples see that miss the solid, instead of `background` */
    const iso_shading *background; /* background, transparent */
    iso_image *image;
    iso_pool *pool; /* NULL: the calling thread */
} iso_glass_picture;

/* Shades the strip's rows of the image; returns the number of samples that show the solid. With
 * background->transparent, alpha is the share of a pixel's samples that do. The same bytes for every number
 * of threads, and in strips of any height. */
size_t iso_glass_shade(const iso_glass_picture *picture);

#ifdef __cplusplus
}
#endif
#endif
