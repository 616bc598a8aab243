/* layers: pictures of surfaces of which some are translucent, by the methods that find every crossing of a
 * ray, exact and raycast, and of points by splats. */
#ifndef ISO_METHODS_LAYERS_H
#define ISO_METHODS_LAYERS_H

#include "exact/layers.h"
#include "methods/method.h"
#include "render/picture.h"
#include "render/shapes/fragments.h"
#include "render/splats/layers.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Whether a method draws translucent surfaces. */
bool iso_method_has_layers(iso_method method);

enum { ISO_LAYERED_MAX = ISO_EXACT_LAYERS_MAX }; /* translucent surfaces in a picture */

/* A surface of the picture. Those of opacity 1 are opaque. */
typedef struct iso_layered_surface {
    const iso_subject *subject; /* the parts that the method needs are up to date */
    iso_translucency translucency;
} iso_layered_surface;

/* A picture; all pointers are borrowed while it is rendered. */
typedef struct iso_layered_picture {
    iso_method method; /* iso_method_has_layers */
    const iso_layered_surface *surfaces;
    int count;
    const iso_translucent_shapes *shapes; /* lines and glyphs, of the method exact; NULL: none */
    int shape_count;
    iso_draw_fn *draw_others; /* draws what else is opaque, such as lines; NULL: nothing */
    void *others_context;
    iso_transparency transparency; /* of splats */
    const iso_shading *shading;    /* a colour for each surface, and the background */
    iso_pool *pool;
    iso_exact_layers_totals totals; /* zeroed by the caller, filled while rendering */
} iso_layered_picture;

/* What iso_picture_render needs to render the picture (iso_picture_opts.layers). ISO_ERR_LIMIT: more than
 * ISO_LAYERED_MAX translucent surfaces, lines and glyphs. */
iso_status iso_layered_picture_callbacks(iso_layered_picture *picture, iso_picture_layers *callbacks,
                                         iso_error *error);

#ifdef __cplusplus
}
#endif
#endif
