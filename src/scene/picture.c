/* picture: chooses how a scene's picture is drawn. */
#include "scene/picture.h"

#include "exact/exact.h"

static iso_status render_layers(iso_scene *scene, iso_picture_opts *opts, iso_image *image, size_t *covered,
                                iso_error *error) {
    iso_picture_layers callbacks;
    iso_layered_picture picture = {.method = scene->renderer->method,
                                   .surfaces = scene->surfaces,
                                   .count = scene->count,
                                   .sets = scene->sets,
                                   .set_count = scene->set_count,
                                   .draw_others = scene->draw_others,
                                   .others_context = scene->others_context,
                                   .transparency = scene->transparency,
                                   .shade_splats = scene->shade_splats,
                                   .splats_context = scene->splats_context,
                                   .shading = &opts->shading,
                                   .pool = opts->pool};
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

/* Whether the picture needs no gbuffer: one exact surface with one sample a pixel, and nothing beside it. */
static bool is_painted(const iso_scene *scene, const iso_picture_opts *opts) {
    return scene->renderer->method == ISO_METHOD_EXACT && !scene->other_engine && scene->count == 1 &&
           opts->shading.color_count == 1 && opts->samples <= 1 && !opts->aov &&
           opts->lighting == ISO_LIGHTING_PHONG;
}

static iso_status paint(const iso_scene *scene, const iso_picture_opts *opts, iso_image *image,
                        size_t *covered, iso_error *error) {
    const iso_view view = iso_view_make(opts->camera, opts->width, opts->height);
    const iso_exact_picture whole = {&view, &opts->shading, image, opts->pool};
    return iso_paint_exact(&whole, scene->surfaces[0].surface->exact, covered, error);
}

iso_status iso_scene_render(iso_scene *scene, iso_picture_opts *opts, iso_image *image, size_t *covered,
                            iso_error *error) {
    if (scene->glass) return render_glass(scene, opts, image, covered, error);
    if (scene->translucent) return render_layers(scene, opts, image, covered, error);
    return is_painted(scene, opts) ? paint(scene, opts, image, covered, error)
                                   : iso_picture_render(opts, image, covered, error);
}
