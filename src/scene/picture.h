/* picture: the picture of a scene: its surfaces by one method, opaque, translucent, or one of glass, and
 * lines, glyphs and meshes among them. Programs and the public header set up a scene and call
 * iso_scene_render. */
#ifndef ISO_SCENE_PICTURE_H
#define ISO_SCENE_PICTURE_H

#include "render/gaussians/gaussians.h"
#include "scene/caps.h"
#include "scene/glass.h"
#include "scene/instances.h"
#include "scene/layered_picture.h"
#include "scene/object.h"
#include "scene/occluders.h"

/* The surface is glass. */
typedef struct iso_scene_glass {
    iso_glass glass; /* its environment is borrowed */
    /* Not AUTO; of splats not traced; with ISO_TRANSPARENCY_NEAREST not two-sided. */
    iso_refraction refraction;
    double abbe;            /* dispersion as an Abbe number; 0: all colours are refracted alike */
    bool shows_environment; /* the environment is seen behind the solid; if not, the background colour */
} iso_scene_glass;

typedef struct iso_scene iso_scene;

/* An engine other than the cpu's. */
typedef struct iso_scene_engine {
    /* Draws all surfaces, as if they were opaque, and the opaque objects into a cleared gbuffer. */
    iso_status (*draw)(void *context, const iso_scene *scene, const iso_view *view, iso_gbuffer *gbuffer,
                       iso_error *error);
    iso_shade_groups_fn *shade_groups; /* as in iso_layered_picture; NULL: the cpu does it */
    void *context;
} iso_scene_engine;

/* Is told how far a picture is. */
typedef struct iso_scene_progress {
    void (*strip)(void *context, double from, double to); /* as iso_picture_opts.begin_strip */
    /* NULL, or: surface `number` is going to be drawn into the strip, or has been. Not in layered pictures.
     */
    void (*surface)(void *context, int number, bool done);
    void *context;
} iso_scene_progress;

/* All pointers are borrowed while the picture is rendered. */
struct iso_scene {
    const iso_renderer *renderer;
    const iso_layered_surface *surfaces; /* the parts that the renderer and the glass need are up to date */
    int count;
    /* Their surface numbers follow those of the surfaces. Translucent ones with ISO_CAN_OBJECT_LAYERS only.
     * */
    iso_scene_object *const *objects;
    int object_count;
    bool translucent;   /* at least one surface or object is; the renderer has ISO_CAN_LAYERS then */
    iso_placed *placed; /* the first `placed_count` surfaces are drawn once for each of its placements */
    int placed_count;
    int pyramid_count; /* the first surfaces, which share an image pyramid with objects that are in_pyramid */
    iso_point_workspace *workspace; /* of objects and that pyramid; NULL: made when needed */
    const iso_scene_glass *glass;   /* NULL: no glass; else there is one opaque surface and nothing else */
    const iso_gaussians
        *gaussians;                /* what the first surface is drawn as, among what is opaque; NULL: discs */
    iso_transparency transparency; /* how splats are composited */
    const iso_cut_caps *caps;      /* caps of surfaces that are cut, and slices; NULL: none */
    /* What the surfaces block of the light, of pictures of opaque surfaces with ISO_CAN_OCCLUSION;
     * `occluders` is kept between pictures, and may be NULL if nothing is blocked. */
    iso_occlusion_opts occlusion;
    iso_occluders *occluders;
    const iso_scene_engine *engine;     /* NULL: the cpu engine */
    const iso_scene_progress *progress; /* NULL: nobody is told */
    iso_exact_layers_totals totals;     /* set by iso_scene_render: of translucent surfaces, or Gaussians */
};

/* The numbers of a picture's surfaces are those of the scene's surfaces and objects. */
static inline int iso_scene_colors(const iso_scene *scene) {
    return scene->count + scene->object_count;
}

/* Draws surfaces from number `first` on, as if they were opaque, and all opaque objects, with the cpu engine.
 * Errors: those of the renderer and of iso_scene_object_draw. */
iso_status iso_scene_draw_from(const iso_scene *scene, int first, const iso_view *view, iso_gbuffer *gbuffer,
                               iso_pool *pool, iso_error *error);

/* Draws the whole scene, as if all of it were opaque, with its engine, into a cleared gbuffer: coloured by
 * data, with labels and caps, but not lit. Errors: those of the engine, the renderer, objects and caps. */
iso_status iso_scene_draw(iso_scene *scene, const iso_view *view, iso_gbuffer *gbuffer, iso_pool *pool,
                          iso_error *error);

/* Renders the picture. `opts`: without `draw`, `draw_context`, `begin_strip` and `layers`, which are set. One
 * exact surface is shaded while it is drawn, if nothing in `opts` prevents it, to the same pixels. Elements
 * in `opts->aov` are numbered as in the files and arrays of objects; surfaces have none, but those of labels.
 * Errors: those of iso_picture_render; ISO_ERR_LIMIT: more than ISO_LAYERED_MAX translucent things. */
iso_status iso_scene_render(iso_scene *scene, iso_picture_opts *opts, iso_image *image, size_t *covered,
                            iso_error *error);

#endif
