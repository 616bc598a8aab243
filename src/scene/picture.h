/* picture: the picture of a scene: its surfaces by one method, opaque, translucent, or one of glass, with
 * lines, glyphs and meshes among them. Programs and the public header set up a scene and call
 * iso_scene_render. */
#ifndef ISO_SCENE_PICTURE_H
#define ISO_SCENE_PICTURE_H

#include "scene/glass.h"
#include "scene/layers.h"

/* The surface is glass. */
typedef struct iso_scene_glass {
    iso_glass glass; /* its environment is borrowed */
    /* Not AUTO; of splats not traced; with ISO_TRANSPARENCY_NEAREST not two-sided. */
    iso_refraction refraction;
    double abbe;            /* dispersion as an Abbe number; 0: all colours are refracted alike */
    bool shows_environment; /* the environment is seen behind the solid; if not, the background colour */
} iso_scene_glass;

/* All pointers are borrowed while the picture is rendered. */
typedef struct iso_scene {
    const iso_renderer *renderer;
    const iso_layered_surface *surfaces; /* the parts that the renderer and the glass need are up to date */
    int count;
    bool translucent; /* at least one surface or set is; the renderer has ISO_CAN_LAYERS then */
    /* Translucent lines, glyphs and meshes; with ISO_CAN_OBJECT_LAYERS only. */
    const iso_translucent_set *sets;
    int set_count;
    iso_draw_fn *draw_others; /* draws opaque lines, glyphs and meshes into layered pictures; NULL: none */
    void *others_context;
    const iso_scene_glass *glass;      /* NULL: no glass; else there is one opaque surface and nothing else */
    iso_transparency transparency;     /* how splats are composited */
    bool other_engine;                 /* opaque surfaces are not drawn by the cpu engine */
    iso_shade_groups_fn *shade_splats; /* as in iso_layered_picture */
    void *splats_context;
    iso_exact_layers_totals totals; /* set by iso_scene_render: of translucent surfaces */
} iso_scene;

/* Renders the picture. `opts`: complete but for `layers`, which is set; `draw` draws all that is opaque. One
 * exact surface is shaded while it is drawn, if nothing in `opts` prevents it, to the same pixels. Errors:
 * those of iso_picture_render; ISO_ERR_LIMIT: more than ISO_LAYERED_MAX translucent things. */
iso_status iso_scene_render(iso_scene *scene, iso_picture_opts *opts, iso_image *image, size_t *covered,
                            iso_error *error);

#endif
