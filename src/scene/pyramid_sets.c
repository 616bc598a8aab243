/* pyramid_sets: lists the sets of the pyramid, and counts what objects show of themselves. */
#include "scene/pyramid_sets.h"

#include "base/memory.h"

/* The sets of one image pyramid. */
typedef struct pyramid_sets {
    iso_pyramid_set sets[ISO_SURFACE_MAX];
    iso_point_view points[ISO_SURFACE_MAX];
    iso_mesh_view meshes[ISO_SURFACE_MAX];
    size_t count;
} pyramid_sets;

/* Lists the surfaces and objects that share a pyramid. */
static void list_pyramid_sets(const iso_scene *scene, pyramid_sets *all) {
    for (int i = 0; i < scene->pyramid_count; i++) {
        const iso_scene_surface *surface = scene->surfaces[i].surface;
        iso_pyramid_set *set = &all->sets[all->count++];
        all->points[i] = iso_scene_surface_points(surface);
        *set = (iso_pyramid_set){.surface = (uint8_t)i, .points = &all->points[i]};
        if (scene->renderer->method != ISO_METHOD_HYBRID) continue;
        all->meshes[i] = iso_mesh_set_view(surface->mesh);
        set->mesh = &all->meshes[i];
    }
    for (int i = 0; i < scene->object_count; i++) {
        const iso_scene_object *object = scene->objects[i];
        const int number = scene->count + i;
        if (!object->in_pyramid) continue;
        iso_pyramid_set *set = &all->sets[all->count++];
        *set = (iso_pyramid_set){.surface = (uint8_t)number, .ribbons = object->pyramid_lines};
        if (object->shapes) continue;
        all->meshes[number] = iso_triangle_spans_view(&object->spans);
        set->mesh = &all->meshes[number];
    }
}

iso_status iso_scene_draw_pyramid(const iso_scene *scene, const iso_target *target, iso_draw_sets_fn *draw,
                                  void *context, iso_error *error) {
    const iso_pullpush_opts opts = {.reconstruction = scene->renderer->discs,
                                    .workspace = iso_point_workspace_pullpush(scene->workspace)};
    iso_status status = ISO_OK;
    pyramid_sets *all = iso_alloc_zero(1, sizeof *all);
    if (!all) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for drawing");
    list_pyramid_sets(scene, all);
    if (all->count)
        status = draw ? draw(context, target, all->sets, all->count, &opts, error)
                      : iso_draw_pyramid_sets(target, all->sets, all->count, &opts, error);
    iso_free(all);
    for (int i = 0; i < scene->object_count && status == ISO_OK; i++)
        if (scene->objects[i]->in_pyramid)
            iso_scene_object_count(scene->objects[i], target->gbuffer, scene->count + i);
    return status;
}
