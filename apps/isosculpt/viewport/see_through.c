/* Pictures with translucent surfaces or with two isovalues: quick ones, with the front layer of each surface.
 *
 * The quick picture blends the front layer of each surface over what is behind it. The opacity depends on the
 * angle (Kay and Greenberg 1979), as in the exact picture. */
#include "apps/isosculpt/viewport/see_through.h"

#include "apps/isosculpt/viewport/memory.h"
#include "apps/isosculpt/viewport/shown.h"
#include "render/layers/opacity.h"

enum { SURFACES = ISOSCULPT_SURFACES };

bool isosculpt_viewport_has_second(const isosculpt_viewport *viewport) {
    const isosculpt_see_through *s = &viewport->see_through;
    return viewport->lod && !viewport->opaque && s->has_second && s->second_isovalue != viewport->isovalue;
}

bool isosculpt_viewport_is_see_through(const isosculpt_viewport *viewport) {
    return isosculpt_viewport_has_second(viewport) ||
           (viewport->lod && !viewport->opaque && viewport->see_through.opacity < 1);
}

bool isosculpt_viewport_is_translucent(const isosculpt_viewport *viewport) {
    const isosculpt_see_through *s = &viewport->see_through;
    return isosculpt_viewport_is_see_through(viewport) &&
           (s->opacity < 1 || (isosculpt_viewport_has_second(viewport) && s->second_opacity < 1));
}

bool isosculpt_viewport_is_cut(const isosculpt_viewport *viewport) {
    return viewport->cut.count > 0;
}

isosculpt_light isosculpt_viewport_light(const isosculpt_viewport *viewport) {
    const isosculpt_see_through *s = &viewport->see_through;
    isosculpt_light light = viewport->light;
    if (!isosculpt_viewport_is_translucent(viewport)) return light;
    light.outline = 0;
    if (s->opacity < 1 && !(isosculpt_viewport_has_second(viewport) && s->second_opacity >= 1))
        light.occlusion = (iso_occlusion_opts){.ambient = false};
    return light;
}

bool isosculpt_viewport_has_light(const isosculpt_viewport *viewport) {
    const isosculpt_light light = isosculpt_viewport_light(viewport);
    return light.occlusion.ambient || light.occlusion.shadow || light.outline > 0;
}

bool isosculpt_viewport_is_painted(const isosculpt_viewport *viewport) {
    return !viewport->lod && iso_painted_any(&viewport->painted);
}

iso_method isosculpt_viewport_method(const isosculpt_viewport *viewport) {
    const iso_method chosen = viewport->mode.method;
    const bool cuts = !isosculpt_viewport_is_cut(viewport) || iso_method_can(chosen, ISO_CAN_CLIP),
               colored = isosculpt_viewport_is_colored(viewport) || isosculpt_viewport_is_painted(viewport),
               colors = !colored || iso_method_can(chosen, ISO_CAN_COLORS);
    return isosculpt_viewport_is_see_through(viewport) || !cuts || !colors ? ISO_METHOD_EXACT : chosen;
}

isosculpt_material isosculpt_viewport_material(const isosculpt_viewport *viewport) {
    isosculpt_material material = viewport->mode.material;
    if (isosculpt_viewport_is_see_through(viewport) || isosculpt_viewport_is_cut(viewport) ||
        isosculpt_viewport_has_light(viewport) || isosculpt_viewport_is_colored(viewport) ||
        isosculpt_viewport_is_painted(viewport))
        material.shading = ISOSCULPT_SHADING_LAMPS;
    return material;
}

/* ---- with the front layers */

/* The front layer of a surface. */
typedef struct front_layer {
    const iso_gbuffer *gbuffer;
    const iso_image *image; /* the surface as if it were opaque */
    iso_layer_opacity opacity;
} front_layer;

/* The state shared by the threads that blend rows. */
typedef struct blending {
    const iso_view *view;
    front_layer layers[SURFACES];
    int count;
    iso_rgb background;
    iso_image *image; /* may be that of a layer */
} blending;

/* Blends the layer of a sample over the colour behind it. */
static void blend(const front_layer *layer, size_t at, const float to_eye[3], float rgb[3]) {
    const iso_gbuffer *g = layer->gbuffer;
    const uint8_t *front = layer->image->rgba + 4 * at;
    if (g->surface[at] == ISO_SURFACE_NONE) return;
    const float normal[3] = {g->normal[0][at], g->normal[1][at], g->normal[2][at]},
                opacity = iso_layer_opacity_at(&layer->opacity, normal, to_eye);
    for (int k = 0; k < 3; k++) rgb[k] += opacity * ((float)front[k] - rgb[k]);
}

static void blend_row(void *context, size_t row, int worker) {
    (void)worker;
    const blending *b = context;
    const iso_view *view = b->view;
    const iso_rgb empty = b->background;
    const size_t width = (size_t)view->width;
    const float v = view->orthographic ? 0 : (float)(((double)row + 0.5 - view->cy) / view->focal);
    for (size_t x = 0; x < width; x++) {
        const size_t at = row * width + x;
        const float u = view->orthographic ? 0 : (float)(((double)x + 0.5 - view->cx) / view->focal);
        const bool second_behind =
            b->count > 1 && b->layers[1].gbuffer->depth[at] > b->layers[0].gbuffer->depth[at];
        const float to_eye[3] = {-u, -v, -1};
        float rgb[3] = {empty.r, empty.g, empty.b};
        for (int i = 0; i < b->count; i++) blend(&b->layers[second_behind ? 1 - i : i], at, to_eye, rgb);
        for (int k = 0; k < 3; k++) b->image->rgba[4 * at + (size_t)k] = (uint8_t)(rgb[k] + 0.5f);
    }
}

/* Draws points as if they were opaque, into a gbuffer and an image of the picture's size. */
static iso_status draw_points(isosculpt_viewport *viewport, int surface, iso_point_set *set, iso_rgb color,
                              iso_gbuffer *gbuffer, iso_image *image, iso_error *error) {
    const iso_view *view = &viewport->drawn.view;
    const iso_point_view points = iso_point_set_view(set);
    const iso_target target = {.view = view, .gbuffer = gbuffer, .pool = viewport->pool};
    const iso_point_surface_opts opts = {.workspace = viewport->workspace};
    const iso_strip strip = {.view = view, .gbuffer = gbuffer, .factor = 1};
    const iso_shading shading = {
        .colors = &color, .color_count = 1, .background = viewport->mode.material.background};
    iso_gbuffer_clear_bands(gbuffer, viewport->pool);
    ISO_TRY(iso_draw_point_surface(&target, &points, &opts, error));
    isosculpt_shown_cut_samples(viewport, surface, view, gbuffer);
    iso_shade(&shading, &strip, image, viewport->pool);
    return ISO_OK;
}

static front_layer make_layer(const iso_gbuffer *gbuffer, const iso_image *image, double opacity) {
    const iso_translucency translucency = {.opacity = (float)opacity, .constant = !(opacity < 1)};
    return (front_layer){gbuffer, image, iso_layer_opacity_make(&translucency)};
}

static iso_status draw_second(isosculpt_viewport *viewport, iso_error *error) {
    const iso_view *view = &viewport->drawn.view;
    const isosculpt_see_through *how = &viewport->see_through;
    ISO_TRY(isosculpt_reserve_samples(&viewport->tile, view->width, view->height, error));
    ISO_TRY(isosculpt_reserve_pixels(&viewport->tile_image, &viewport->tile_room, view->width, view->height,
                                     error));
    ISO_TRY(isosculpt_lod_update_second(viewport->lod, how->second_isovalue, error));
    return draw_points(viewport, 1, isosculpt_lod_second_points(viewport->lod), how->second_color,
                       &viewport->tile, &viewport->tile_image, error);
}

iso_status isosculpt_see_through_draw_quick(isosculpt_viewport *viewport, iso_error *error) {
    const isosculpt_see_through *how = &viewport->see_through;
    const isosculpt_material *material = &viewport->mode.material;
    const bool two = isosculpt_viewport_has_second(viewport);
    iso_gbuffer *gbuffer = &viewport->drawn.gbuffer;
    if (two) ISO_TRY(draw_second(viewport, error));
    ISO_TRY(draw_points(viewport, 0, isosculpt_lod_points(viewport->lod), material->color, gbuffer,
                        &viewport->image, error));
    blending b = {.view = &viewport->drawn.view,
                  .layers = {make_layer(gbuffer, &viewport->image, how->opacity),
                             make_layer(&viewport->tile, &viewport->tile_image, how->second_opacity)},
                  .count = two ? 2 : 1,
                  .background = material->background,
                  .image = &viewport->image};
    iso_parallel_for(viewport->pool, (size_t)viewport->drawn.view.height, blend_row, &b);
    return ISO_OK;
}
