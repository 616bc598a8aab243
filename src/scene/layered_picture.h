/* layered_picture: renders pictures in which some surfaces are translucent. The methods exact and raycast
 * find every crossing of a ray; the method splats draws translucent points. */
#ifndef ISO_SCENE_LAYERED_PICTURE_H
#define ISO_SCENE_LAYERED_PICTURE_H

#include "exact/layers.h"
#include "render/groups/disc_layers.h"
#include "render/picture.h"
#include "render/shapes/fragments.h"
#include "scene/method.h"

enum { ISO_LAYERED_MAX = ISO_EXACT_LAYERS_MAX }; /* largest number of translucent surfaces in a picture */

/* A surface of the picture. Those of opacity 1 are opaque, unless their points have opacities. */
typedef struct iso_layered_surface {
    const iso_scene_surface *surface; /* its parts that the method needs are up to date */
    iso_translucency translucency;
} iso_layered_surface;

/* Another engine's iso_shade_splat_layers (render/groups/disc_layers.h). */
typedef iso_status iso_shade_groups_fn(void *context, const iso_splat_layers *input, iso_layer_totals *totals,
                                       iso_error *error);

/* A picture; all pointers are borrowed while it is rendered. */
typedef struct iso_layered_picture {
    iso_method method; /* one with ISO_CAN_LAYERS */
    const iso_layered_surface *surfaces;
    int count;
    /* Translucent lines, glyphs and meshes, with the method exact only; NULL: none. */
    const iso_translucent_set *sets;
    int set_count;
    iso_draw_fn *draw_others; /* draws further opaque objects, such as lines; NULL: there are none */
    void *others_context;
    iso_transparency transparency; /* how splats are composited; for the method splats only */
    /* Draws translucent splats, unless points have opacities of their own; NULL: iso_shade_splat_layers. */
    iso_shade_groups_fn *shade_splats;
    void *splats_context;
    const iso_shading *shading; /* a colour for each surface, and the background */
    iso_pool *pool;
    iso_exact_layers_totals totals; /* zeroed by the caller, filled while rendering */
} iso_layered_picture;

/* Sets the callbacks with which iso_picture_render renders the picture (iso_picture_opts.layers).
 * ISO_ERR_LIMIT: more than ISO_LAYERED_MAX translucent surfaces, lines, glyphs and meshes. */
iso_status iso_layered_picture_callbacks(iso_layered_picture *picture, iso_picture_layers *callbacks,
                                         iso_error *error);

#endif
