/* picture: draws what a scene consists of, and chooses how its picture is drawn. */
#include "scene/picture.h"

#include "exact/exact.h"
#include "scene/coloring.h"
#include "scene/label_colors.h"
#include "scene/pyramid_sets.h"

/* ---- surfaces, as if they were opaque, and opaque objects */

static void tell_surface(const iso_scene *scene, int number, bool done) {
    if (scene->progress && scene->progress->surface)
        scene->progress->surface(scene->progress->context, number, done);
}

static iso_status draw_object(const iso_scene *scene, int i, const iso_target *target, iso_error *error) {
    iso_target own = *target;
    own.surface = (uint8_t)(scene->count + i);
    scene->objects[i]->by_cpu = scene->engine != NULL;
    return iso_scene_object_draw(scene->objects[i], &own, iso_point_workspace_pullpush(scene->workspace),
                                 error);
}

static iso_status draw_opaque_objects(const iso_scene *scene, const iso_target *target, iso_error *error) {
    for (int i = 0; i < scene->object_count; i++)
        if (iso_scene_object_is_opaque(scene->objects[i]) && !scene->objects[i]->in_pyramid)
            ISO_TRY(draw_object(scene, i, target, error));
    return ISO_OK;
}

iso_status iso_scene_draw_from(const iso_scene *scene, int first, const iso_view *view, iso_gbuffer *gbuffer,
                               iso_pool *pool, iso_error *error) {
    iso_target target = {view, gbuffer, pool, 0, NULL};
    for (int i = first > scene->pyramid_count ? first : scene->pyramid_count; i < scene->count; i++) {
        const iso_scene_surface *surface = scene->surfaces[i].surface;
        target.surface = (uint8_t)i;
        tell_surface(scene, i, false);
        ISO_TRY(i < scene->placed_count ? iso_placed_draw(scene->placed, scene->renderer->method, surface,
                                                          &target, NULL, NULL, error)
                                        : iso_renderer_draw(scene->renderer, surface, &target, error));
        tell_surface(scene, i, true);
    }
    return draw_opaque_objects(scene, &target, error);
}

/* A picture that is being drawn. */
typedef struct drawing {
    iso_scene *scene;
    iso_pool *pool;
    const iso_shading *shading;
} drawing;

/* Whether several labels share a surface. */
static bool has_labels(const iso_scene *scene) {
    bool any = false;
    for (int i = 0; i < scene->count; i++) any |= scene->surfaces[i].surface->labels != NULL;
    return any;
}

/* Colours what is drawn of labels that share a surface, unless it is coloured by data. */
static iso_status paint_labels(const drawing *d, const iso_view *view, iso_gbuffer *gbuffer,
                               iso_error *error) {
    for (int i = 0; i < d->scene->count; i++) {
        const iso_scene_surface *surface = d->scene->surfaces[i].surface;
        const iso_label_colors *labels = surface->labels;
        if (labels && !surface->coloring)
            ISO_TRY(iso_label_colors_paint(labels, i, view, gbuffer, d->pool, error));
    }
    return ISO_OK;
}

/* Whether anything is coloured by data. */
static bool has_colorings(const iso_scene *scene) {
    bool any = false;
    for (int i = 0; i < scene->count; i++) any |= scene->surfaces[i].surface->coloring != NULL;
    for (int i = 0; i < scene->object_count; i++) any |= scene->objects[i]->coloring != NULL;
    return any;
}

/* Colours what is opaque and drawn so far. */
static iso_status paint_colorings(const drawing *d, const iso_view *view, iso_gbuffer *gbuffer,
                                  iso_error *error) {
    const iso_coloring *colorings[ISO_SURFACE_MAX];
    const iso_scene *scene = d->scene;
    if (!has_colorings(scene)) return ISO_OK;
    for (int i = 0; i < scene->count; i++) colorings[i] = scene->surfaces[i].surface->coloring;
    for (int i = 0; i < scene->object_count; i++) colorings[scene->count + i] = scene->objects[i]->coloring;
    return iso_colorings_paint(colorings, iso_scene_colors(scene), view, gbuffer, d->pool, error);
}

static iso_status draw_caps(const drawing *d, const iso_view *view, iso_gbuffer *gbuffer, iso_error *error) {
    return d->scene->caps ? iso_caps_draw(d->scene->caps, view, gbuffer, d->pool, error) : ISO_OK;
}

static bool has_pyramid(const iso_scene *scene) {
    bool any = scene->pyramid_count > 0;
    for (int i = 0; i < scene->object_count; i++) any |= scene->objects[i]->in_pyramid;
    return any;
}

static iso_status draw_things(const drawing *d, const iso_view *view, iso_gbuffer *gbuffer,
                              iso_error *error) {
    const iso_scene *scene = d->scene;
    const iso_target target = {view, gbuffer, d->pool, 0, NULL};
    if (scene->engine) return scene->engine->draw(scene->engine->context, scene, view, gbuffer, error);
    if (has_pyramid(scene)) ISO_TRY(iso_scene_draw_pyramid(scene, &target, NULL, NULL, error));
    return iso_scene_draw_from(scene, 0, view, gbuffer, d->pool, error);
}

/* iso_picture_opts.draw. */
static iso_status draw_all(void *context, const iso_view *view, iso_gbuffer *gbuffer, iso_error *error) {
    const iso_scene *scene = ((const drawing *)context)->scene;
    const bool caps_first = scene->caps && iso_caps_are_in_front(scene->caps) && !scene->engine &&
                            scene->renderer->method == ISO_METHOD_EXACT && !has_colorings(scene);
    if (caps_first) ISO_TRY(draw_caps(context, view, gbuffer, error));
    ISO_TRY(draw_things(context, view, gbuffer, error));
    ISO_TRY(paint_colorings(context, view, gbuffer, error));
    if (!caps_first) ISO_TRY(draw_caps(context, view, gbuffer, error));
    return paint_labels(context, view, gbuffer, error);
}

iso_status iso_scene_draw(iso_scene *scene, const iso_view *view, iso_gbuffer *gbuffer, iso_pool *pool,
                          iso_error *error) {
    drawing d = {.scene = scene, .pool = pool};
    return draw_all(&d, view, gbuffer, error);
}

/* iso_picture_opts.begin_strip. */
static void begin_strip(void *context, double from, double to) {
    const iso_scene_progress *progress = ((const drawing *)context)->scene->progress;
    progress->strip(progress->context, from, to);
}

/* ---- translucent surfaces and objects */

/* iso_layered_picture.draw_others. */
static iso_status draw_others(void *context, const iso_view *view, iso_gbuffer *gbuffer, iso_error *error) {
    const drawing *d = context;
    const iso_target target = {view, gbuffer, d->pool, 0, NULL};
    ISO_TRY(draw_opaque_objects(d->scene, &target, error));
    ISO_TRY(paint_colorings(d, view, gbuffer, error));
    ISO_TRY(draw_caps(d, view, gbuffer, error));
    return paint_labels(d, view, gbuffer, error);
}

/* Whether there is anything for draw_others: also colours of an opaque surface, or labels. */
static bool draws_others(const iso_scene *scene) {
    bool colors = false;
    for (int i = 0; i < scene->count; i++)
        colors |= scene->surfaces[i].surface->coloring && scene->surfaces[i].translucency.opacity >= 1;
    return scene->object_count || scene->caps || colors || has_labels(scene);
}

/* Lists the translucent objects. ISO_ERR_LIMIT. */
static iso_status list_sets(const iso_scene *scene, iso_translucent_set sets[ISO_LAYERED_MAX], int *count,
                            iso_error *error) {
    *count = 0;
    for (int i = 0; i < scene->object_count; i++) {
        iso_scene_object *object = scene->objects[i];
        if (iso_scene_object_is_opaque(object)) continue;
        if (*count == ISO_LAYERED_MAX)
            return iso_fail(error, ISO_ERR_LIMIT, "more than %d translucent lines, glyphs and meshes",
                            ISO_LAYERED_MAX);
        sets[(*count)++] = (iso_translucent_set){.shapes = object->shapes,
                                                 .mesh = iso_triangle_spans_view(&object->spans),
                                                 .color = object->color,
                                                 .translucency = object->translucency,
                                                 .drawn = &object->layered,
                                                 .clip = object->clip};
    }
    return ISO_OK;
}

static iso_status render_layers(drawing *d, iso_picture_opts *opts, iso_image *image, size_t *covered,
                                iso_error *error) {
    iso_scene *scene = d->scene;
    iso_picture_layers callbacks;
    iso_translucent_set sets[ISO_LAYERED_MAX];
    iso_layered_picture picture = {.method = scene->renderer->method,
                                   .surfaces = scene->surfaces,
                                   .count = scene->count,
                                   .sets = sets,
                                   .draw_others = draws_others(scene) ? draw_others : NULL,
                                   .others_context = d,
                                   .transparency = scene->transparency,
                                   .shade_splats = scene->engine ? scene->engine->shade_groups : NULL,
                                   .splats_context = scene->engine ? scene->engine->context : NULL,
                                   .shading = &opts->shading,
                                   .pool = opts->pool};
    ISO_TRY(list_sets(scene, sets, &picture.set_count, error));
    ISO_TRY(iso_layered_picture_callbacks(&picture, &callbacks, error));
    opts->layers = &callbacks;
    const iso_status status = iso_picture_render(opts, image, covered, error);
    opts->layers = NULL;
    scene->totals = picture.totals;
    return status;
}

static iso_status render_glass(const iso_scene *scene, iso_picture_opts *opts, iso_image *image,
                               size_t *covered, iso_error *error) {
    iso_picture_layers callbacks;
    iso_glass_scene glass = {.method = scene->renderer->method,
                             .refraction = scene->glass->refraction,
                             .transparency = scene->transparency,
                             .abbe = scene->glass->abbe,
                             .surface = scene->surfaces[0].surface,
                             .glass = scene->glass->glass,
                             .shows_environment = scene->glass->shows_environment,
                             .opts = opts};
    iso_status status = iso_glass_scene_start(&glass, &callbacks, error);
    opts->layers = &callbacks;
    if (status == ISO_OK) status = iso_picture_render(opts, image, covered, error);
    opts->layers = NULL;
    iso_glass_scene_free(&glass);
    return status;
}

/* ---- Gaussians */

/* iso_picture_layers.draw_opaque. */
static iso_status draw_beside_gaussians(void *context, const iso_view *view, iso_gbuffer *gbuffer,
                                        iso_error *error) {
    const drawing *d = context;
    return iso_scene_draw_from(d->scene, 1, view, gbuffer, d->pool, error);
}

/* iso_picture_layers.shade. */
static iso_status shade_gaussians(void *context, const iso_strip *strip, iso_image *image, iso_aov *aov,
                                  size_t *covered, iso_error *error) {
    (void)aov;
    const drawing *d = context;
    const iso_layer_picture picture = {
        .strip = strip, .shading = d->shading, .image = image, .pool = d->pool};
    iso_layer_totals *totals = &d->scene->totals.layers;
    const size_t before = totals->covered;
    ISO_TRY(iso_shade_gaussians(d->scene->gaussians, &picture, totals, error));
    *covered = totals->covered - before;
    return ISO_OK;
}

static iso_status render_gaussians(drawing *d, iso_picture_opts *opts, iso_image *image, size_t *covered,
                                   iso_error *error) {
    const iso_picture_layers callbacks = {iso_scene_colors(d->scene) > 1 ? draw_beside_gaussians : NULL,
                                          shade_gaussians, d};
    opts->layers = &callbacks;
    const iso_status status = iso_picture_render(opts, image, covered, error);
    opts->layers = NULL;
    return status;
}

/* Whether the picture needs no gbuffer: one exact trilinear surface, and nothing beside it. (Of higher ones,
 * the rows of all samples have numbers only in strips.) */
static bool is_painted(const iso_scene *scene, const iso_picture_opts *opts) {
    return scene->renderer->method == ISO_METHOD_EXACT && !scene->engine && !scene->caps &&
           iso_scene_colors(scene) == 1 && scene->count == 1 && !scene->surfaces[0].surface->spline &&
           !has_labels(scene) && !has_colorings(scene) && !opts->aov &&
           opts->height * iso_picture_factor(opts->samples) <= INT16_MAX &&
           opts->lighting == ISO_LIGHTING_PHONG && !opts->occlusion && !(opts->outline > 0) &&
           !opts->gbuffer && !opts->rows[1];
}

static iso_status paint(const iso_scene *scene, const iso_picture_opts *opts, iso_image *image,
                        size_t *covered, iso_error *error) {
    ISO_TRY(iso_picture_check_samples(opts->samples, error));
    const int factor = iso_picture_factor(opts->samples);
    const iso_view pixels = opts->view ? *opts->view : iso_view_make(opts->camera, opts->width, opts->height),
                   view = iso_view_scaled(&pixels, factor);
    const iso_exact_picture whole = {.view = &view,
                                     .shading = &opts->shading,
                                     .image = image,
                                     .pool = opts->pool,
                                     .clip = scene->surfaces[0].surface->clip,
                                     .factor = factor};
    ISO_TRY(iso_paint_exact(&whole, scene->surfaces[0].surface->exact, covered, error));
    return iso_pool_check(opts->pool, "the picture", error);
}

/* Sets opts->occlusion. */
static iso_status find_occlusion(const iso_scene *scene, iso_picture_opts *opts, iso_error *error) {
    iso_occluding all = {.count = 0};
    for (int i = 0; i < scene->count && all.count < ISO_OCCLUDERS_MAX; i++) {
        const iso_scene_surface *surface = scene->surfaces[i].surface;
        if (scene->surfaces[i].translucency.opacity >= 1 && (surface->grid.rgrid || surface->grid.hgrid))
            all.surfaces[all.count++] = surface;
    }
    for (int i = 0; i < scene->object_count && all.object_count < ISO_SURFACE_MAX; i++)
        if (iso_scene_object_is_opaque(scene->objects[i]))
            all.objects[all.object_count++] = scene->objects[i];
    return iso_occluders_update(scene->occluders, &all, &scene->occlusion, opts->camera, opts->pool,
                                &opts->occlusion, error);
}

/* Makes the strips of exact surfaces small: the gbuffer takes little memory then, and as many strips take no
 * longer, because only cells at their borders are drawn twice. (Of points and triangles, all are looked at
 * for each strip, and outlines and occlusion read the rows around it.) */
static void keep_strips_small(const iso_scene *scene, iso_picture_opts *opts) {
    enum { ROWS = 128 }; /* of pixels, at least */
    const size_t samples = (size_t)opts->width * (size_t)(opts->samples > 1 ? opts->samples : 1),
                 rows = ROWS * samples * ISO_PICTURE_SAMPLE_BYTES,
                 small = rows > ISO_EXACT_STRIP_BYTES ? rows : ISO_EXACT_STRIP_BYTES;
    if (scene->renderer->method != ISO_METHOD_EXACT || scene->engine || scene->object_count ||
        opts->occlusion || opts->outline > 0 || opts->lighting != ISO_LIGHTING_PHONG)
        return;
    const size_t most = opts->strip_bytes ? opts->strip_bytes : ISO_PICTURE_STRIP_BYTES;
    opts->strip_bytes = most < small ? most : small;
}

static iso_status render(iso_scene *scene, iso_picture_opts *opts, iso_image *image, size_t *covered,
                         iso_error *error) {
    drawing d = {scene, opts->pool, &opts->shading};
    opts->draw = draw_all;
    opts->draw_context = &d;
    opts->begin_strip = scene->progress ? begin_strip : NULL;
    if (scene->gaussians) return render_gaussians(&d, opts, image, covered, error);
    if (scene->glass) return render_glass(scene, opts, image, covered, error);
    if (scene->occluders && (!scene->translucent || scene->renderer->can & ISO_CAN_LIT_LAYERS))
        ISO_TRY(find_occlusion(scene, opts, error));
    if (scene->translucent) return render_layers(&d, opts, image, covered, error);
    keep_strips_small(scene, opts);
    return is_painted(scene, opts) ? paint(scene, opts, image, covered, error)
                                   : iso_picture_render(opts, image, covered, error);
}

/* Gives elements the numbers that users see. */
static void number_elements(const iso_scene *scene, iso_aov *aov) {
    for (int i = 0; i < scene->count; i++)
        if (!scene->surfaces[i].surface->labels) iso_aov_unnumber(aov, (uint32_t)i + 1);
    for (int i = 0; i < scene->object_count; i++)
        iso_scene_object_number(scene->objects[i], (uint32_t)(scene->count + i + 1), aov);
}

iso_status iso_scene_render(iso_scene *scene, iso_picture_opts *opts, iso_image *image, size_t *covered,
                            iso_error *error) {
    ISO_TRY(render(scene, opts, image, covered, error));
    if (opts->aov) number_elements(scene, opts->aov);
    return ISO_OK;
}
