/* layered_picture: sorts the surfaces of a picture into opaque and translucent ones, and calls the renderers
 * for both. */
#include "scene/layered_picture.h"

#include <math.h>

#include "scene/coloring.h"
#include "truth/raycast_layers.h"

/* Whether the points of a surface, given or extracted, have opacities of their own. */
static bool has_opacities(const iso_layered_surface *surface) {
    return surface->surface->given && surface->surface->given->opacities;
}

static bool is_opaque(const iso_layered_surface *surface) {
    return surface->translucency.opacity >= 1 && !has_opacities(surface);
}

/* The callback iso_picture_layers.draw_opaque. */
static iso_status draw_opaque(void *context, const iso_view *view, iso_gbuffer *gbuffer, iso_error *error) {
    const iso_layered_picture *picture = context;
    const iso_renderer *renderer = iso_renderer_get(picture->method);
    for (int i = 0; i < picture->count; i++) {
        const iso_target target = {view, gbuffer, picture->pool, (uint8_t)i, NULL};
        if (!is_opaque(&picture->surfaces[i])) continue;
        ISO_TRY(iso_renderer_draw(renderer, picture->surfaces[i].surface, &target, error));
    }
    return picture->draw_others ? picture->draw_others(picture->others_context, view, gbuffer, error)
                                : ISO_OK;
}

/* Sets *colors to those of a surface; NULL: it has one colour. */
static const iso_surface_colors *find_colors(const iso_scene_surface *surface, iso_surface_colors *colors) {
    if (!surface->coloring) return NULL;
    *colors = iso_coloring_colors(surface->coloring);
    return colors;
}

/* How much light passes a surface. Borders that solids share lie within a voxel of each other. */
static iso_translucency translucency_of(const iso_layered_surface *layered) {
    iso_translucency translucency = layered->translucency;
    const iso_transform *transform = iso_grid_transform(&layered->surface->grid);
    for (int axis = 0; axis < 3 && layered->surface->borders; axis++)
        translucency.gap = fmaxf(translucency.gap, (float)transform->spacing[axis]);
    return translucency;
}

static int list_exact(const iso_layered_picture *picture, iso_surface_colors colors[ISO_LAYERED_MAX],
                      iso_exact_layer layers[ISO_LAYERED_MAX]) {
    int count = 0;
    for (int i = 0; i < picture->count; i++) {
        const iso_scene_surface *surface = picture->surfaces[i].surface;
        if (is_opaque(&picture->surfaces[i])) continue;
        layers[count] = (iso_exact_layer){surface->exact, picture->shading->colors[i],
                                          translucency_of(&picture->surfaces[i]), surface->clip,
                                          find_colors(surface, &colors[count])};
        count++;
    }
    return count;
}

static iso_status shade_exact(iso_layered_picture *picture, const iso_layer_picture *output,
                              iso_error *error) {
    iso_surface_colors colors[ISO_LAYERED_MAX];
    iso_exact_layer layers[ISO_LAYERED_MAX];
    iso_exact_layers input = {
        .layers = layers, .count = list_exact(picture, colors, layers), .picture = *output};
    if (!picture->set_count) return iso_shade_exact_layers(&input, &picture->totals, error);
    iso_shapes_lister *lister;
    ISO_TRY(iso_shapes_lister_create(picture->sets, picture->set_count, input.count, output->strip,
                                     output->pool, &lister, error));
    const iso_layer_source source = iso_shapes_lister_source(lister);
    input.source = &source;
    input.middle = iso_translucent_middle(picture->sets, picture->set_count, output->strip->view);
    const iso_status status = iso_shade_exact_layers(&input, &picture->totals, error);
    iso_shapes_lister_destroy(lister);
    return status;
}

static void shade_raycast(iso_layered_picture *picture, const iso_layer_picture *output) {
    iso_surface_colors colors[ISO_LAYERED_MAX];
    iso_raycast_layer layers[ISO_LAYERED_MAX];
    int count = 0;
    for (int i = 0; i < picture->count; i++) {
        const iso_scene_surface *surface = picture->surfaces[i].surface;
        if (is_opaque(&picture->surfaces[i])) continue;
        layers[count] = (iso_raycast_layer){surface->caster, picture->shading->colors[i],
                                            translucency_of(&picture->surfaces[i]), surface->clip,
                                            find_colors(surface, &colors[count])};
        count++;
    }
    const iso_raycast_layers input = {.layers = layers, .count = count, .picture = *output};
    iso_shade_raycast_layers(&input, &picture->totals.layers);
}

static iso_status shade_splats(iso_layered_picture *picture, const iso_layer_picture *output,
                               iso_error *error) {
    iso_splat_layer layers[ISO_LAYERED_MAX];
    int count = 0;
    bool opacities = false;
    for (int i = 0; i < picture->count; i++) opacities |= has_opacities(&picture->surfaces[i]);
    for (int i = 0; i < picture->count; i++)
        if (!is_opaque(&picture->surfaces[i]))
            layers[count++] =
                (iso_splat_layer){.points = iso_scene_surface_points(picture->surfaces[i].surface),
                                  .groups = &picture->surfaces[i].surface->groups,
                                  .color = picture->shading->colors[i],
                                  .translucency = picture->surfaces[i].translucency};
    const iso_splat_layers input = {
        .transparency = picture->transparency, .layers = layers, .count = count, .picture = *output};
    iso_layer_totals *totals = &picture->totals.layers;
    if (picture->shade_splats && !opacities)
        return picture->shade_splats(picture->splats_context, &input, totals, error);
    return iso_shade_splat_layers(&input, totals, error);
}

/* The callback iso_picture_layers.shade. */
static iso_status shade(void *context, const iso_strip *strip, iso_image *image, iso_aov *aov,
                        size_t *covered, iso_error *error) {
    iso_layered_picture *picture = context;
    const iso_layer_picture output = {.strip = strip,
                                      .shading = picture->shading,
                                      .image = image,
                                      .layer_counts = aov ? aov->layers : NULL,
                                      .coverage = aov ? aov->coverage : NULL,
                                      .pool = picture->pool};
    const size_t before = picture->totals.layers.covered;
    if (picture->method == ISO_METHOD_EXACT)
        ISO_TRY(shade_exact(picture, &output, error));
    else if (iso_method_is_splats(picture->method))
        ISO_TRY(shade_splats(picture, &output, error));
    else
        shade_raycast(picture, &output);
    *covered = picture->totals.layers.covered - before;
    return ISO_OK;
}

iso_status iso_layered_picture_callbacks(iso_layered_picture *picture, iso_picture_layers *callbacks,
                                         iso_error *error) {
    int opaque = 0;
    for (int i = 0; i < picture->count; i++) opaque += is_opaque(&picture->surfaces[i]);
    const int translucent = picture->count - opaque + picture->set_count;
    if (translucent > ISO_LAYERED_MAX)
        return iso_fail(error, ISO_ERR_LIMIT, "%d translucent surfaces%s: a picture has up to %d",
                        translucent, picture->set_count ? ", lines, glyphs and meshes" : "", ISO_LAYERED_MAX);
    const bool draws = opaque || picture->draw_others;
    *callbacks = (iso_picture_layers){draws ? draw_opaque : NULL, shade, picture};
    return ISO_OK;
}
