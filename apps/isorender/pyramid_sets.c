/* pyramid_sets: --one-pyramid: the input's surfaces as points (and triangles, with --method hybrid), meshes
 * of files and ribbons. Tubes, glyphs and further volumes are drawn alone. */
#include "apps/isorender/pyramid_sets.h"

#include "render/pullpush/sets.h"

typedef struct collected {
    iso_pyramid_set sets[ISORENDER_SURFACES + ISORENDER_OBJECTS];
    iso_point_view points[ISORENDER_SURFACES];
    iso_mesh_view meshes[ISORENDER_SURFACES + ISORENDER_OBJECTS];
    size_t count;
} collected;

static bool is_mesh(const isorender_object *object) {
    return object->settings->kind == ISORENDER_MESH;
}

static bool is_ribbons(const isorender_object *object) {
    return object->pyramid_lines && object->settings->style == ISORENDER_STYLE_RIBBON;
}

void isorender_pyramid_choose(isorender_job *job) {
    if (!job->settings->one_pyramid) return;
    for (int i = 0; i < job->object_count; i++) {
        isorender_object *object = &job->objects[i];
        object->in_pyramid = is_mesh(object) || is_ribbons(object);
    }
    for (int i = 0; i < job->input_surface_count; i++) job->surfaces[i].in_pyramid = true;
}

static void add_surface(const isorender_job *job, int i, collected *all) {
    const isorender_surface *surface = &job->surfaces[i];
    iso_pyramid_set *set = &all->sets[all->count];
    *set = (iso_pyramid_set){.surface = (uint8_t)i, .points = &all->points[i]};
    all->points[i] = iso_scene_surface_points(&job->surfaces[i].scene);
    if (job->method == ISO_METHOD_HYBRID) {
        all->meshes[all->count] = iso_mesh_set_view(surface->scene.mesh);
        set->mesh = &all->meshes[all->count];
    }
    all->count++;
}

static void add_object(const isorender_job *job, int i, collected *all) {
    const isorender_object *object = &job->objects[i];
    iso_pyramid_set *set = &all->sets[all->count];
    *set = (iso_pyramid_set){.surface = (uint8_t)(job->surface_count + i), .ribbons = object->pyramid_lines};
    if (is_mesh(object)) {
        all->meshes[all->count] = iso_triangle_spans_view(&object->spans);
        set->mesh = &all->meshes[all->count];
    }
    all->count++;
}

iso_status isorender_pyramid_draw(isorender_job *job, const iso_view *view, iso_gbuffer *gbuffer,
                                  iso_error *error) {
    const iso_target target = {view, gbuffer, job->pool, 0};
    const iso_pullpush_opts opts = {.reconstruction = job->method == ISO_METHOD_HYBRID
                                                          ? ISO_RECONSTRUCTION_GAUSSIAN
                                                          : (iso_reconstruction)job->settings->reconstruction,
                                    .workspace = iso_point_workspace_pullpush(job->point_workspace)};
    collected all = {.count = 0};
    for (int i = 0; i < job->surface_count; i++)
        if (job->surfaces[i].in_pyramid) add_surface(job, i, &all);
    for (int i = 0; i < job->object_count; i++)
        if (job->objects[i].in_pyramid) add_object(job, i, &all);
    if (!all.count) return ISO_OK;
    ISO_TRY(iso_draw_pyramid_sets(&target, all.sets, all.count, &opts, error));
    for (int i = 0; i < job->object_count; i++)
        if (job->objects[i].in_pyramid)
            isorender_object_count(&job->objects[i], gbuffer, job->surface_count + i);
    return ISO_OK;
}
