/* glass: computes the map of crossings of a picture with the chosen method, and shades its strips. */
#include "scene/glass.h"

#include "exact/glass.h"
#include "render/groups/disc_layers.h"
#include "truth/traced_glass.h"

iso_refraction iso_glass_usual_refraction(bool points, iso_transparency transparency) {
    if (!points) return ISO_REFRACTION_TRACED;
    return transparency == ISO_TRANSPARENCY_NEAREST ? ISO_REFRACTION_LAYERS : ISO_REFRACTION_TWO_SIDED;
}

iso_part iso_glass_part(iso_method method, iso_refraction refraction) {
    if (iso_method_is_splats(method)) return ISO_PART_POINTS;
    const bool rays = method == ISO_METHOD_RAYCAST || refraction == ISO_REFRACTION_TRACED;
    return rays ? ISO_PART_CASTER : ISO_PART_CELLS;
}

uint64_t iso_glass_scene_bytes(iso_refraction refraction, uint64_t samples) {
    return refraction == ISO_REFRACTION_TRACED ? 0 : samples * sizeof(iso_glass_crossings);
}

static iso_status make_map(iso_glass_scene *scene, iso_error *error) {
    iso_pool *pool = scene->opts->pool;
    ISO_TRY(iso_glass_map_create(&scene->view, &scene->map, error));
    if (scene->method == ISO_METHOD_EXACT)
        return iso_exact_map_glass(scene->surface->exact, &scene->map, pool, error);
    if (iso_method_is_splats(scene->method)) {
        const iso_point_view points = iso_scene_surface_points(scene->surface);
        return iso_groups_map_glass(&points, &scene->surface->groups, scene->transparency, &scene->map, pool,
                                    error);
    }
    iso_raycast_map_glass(scene->surface->caster, &scene->map, pool);
    return ISO_OK;
}

/* The callback iso_picture_layers.shade. */
static iso_status shade(void *context, const iso_strip *strip, iso_image *image, iso_aov *aov,
                        size_t *covered, iso_error *error) {
    (void)aov, (void)error; /* coverage is already that of the surface */
    const iso_glass_scene *scene = context;
    const bool traced = scene->refraction == ISO_REFRACTION_TRACED, disperses = scene->abbe > 0;
    double iors[3] = {scene->glass.ior, scene->glass.ior, scene->glass.ior};
    if (disperses) iso_glass_disperse(scene->glass.ior, scene->abbe, iors);
    iso_glass glass[3];
    iso_traced_glass rays[3];
    iso_mapped_glass mapped[3];
    iso_dispersed_glass colors = {.light = traced ? iso_traced_glass_light : iso_glass_light};
    for (int k = 0; k < 3; k++) {
        glass[k] = scene->glass;
        glass[k].ior = iors[k];
        rays[k] = (iso_traced_glass){scene->surface->caster, &glass[k], &scene->view};
        mapped[k] = (iso_mapped_glass){&glass[k], &scene->map, scene->refraction};
        colors.contexts[k] = traced ? (const void *)&rays[k] : (const void *)&mapped[k];
    }
    const iso_glass_picture picture = {.view = &scene->view,
                                       .strip = strip,
                                       .light = disperses ? iso_dispersed_glass_light : colors.light,
                                       .context = disperses ? (const void *)&colors : colors.contexts[0],
                                       .behind = scene->shows_environment ? scene->glass.environment : NULL,
                                       .background = &scene->opts->shading,
                                       .image = image,
                                       .pool = scene->opts->pool};
    *covered = iso_glass_shade(&picture);
    return ISO_OK;
}

/* Returns the number of samples along a side of a pixel. */
static int factor_of(int samples) {
    int factor = 1;
    while (factor * factor < samples) factor++;
    return factor;
}

iso_status iso_glass_scene_start(iso_glass_scene *scene, iso_picture_layers *callbacks, iso_error *error) {
    const iso_picture_opts *opts = scene->opts;
    const iso_view pixels = iso_view_make(opts->camera, opts->width, opts->height);
    scene->view = iso_view_scaled(&pixels, factor_of(opts->samples));
    *callbacks = (iso_picture_layers){NULL, shade, scene};
    return scene->refraction == ISO_REFRACTION_TRACED ? ISO_OK : make_map(scene, error);
}

void iso_glass_scene_free(iso_glass_scene *scene) {
    iso_glass_map_free(&scene->map);
}
