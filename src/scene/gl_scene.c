/* gl_scene: uploads a scene, and draws it by OpenGL. */
#include "scene/gl_scene.h"

#include "base/memory.h"
#include "render/gl/groups.h"
#include "render/gl/hybrid.h"
#include "render/gl/instances.h"
#include "render/gl/lines.h"
#include "render/gl/pullpush.h"
#include "render/gl/sets.h"
#include "scene/pyramid_sets.h"

static bool draws_groups(const iso_scene *scene) {
    return scene->renderer->needs & 1u << ISO_PART_GROUPS;
}

/* Whether what is uploaded of surfaces depends on the view. */
static bool uploads_each_time(const iso_scene *scene) {
    return draws_groups(scene) || scene->renderer->method == ISO_METHOD_HYBRID;
}

static iso_status upload_objects(iso_gl_scene *gl, const iso_scene *scene, iso_error *error) {
    for (int i = 0; i < scene->object_count; i++) {
        const iso_scene_object *object = scene->objects[i];
        const iso_mesh_view mesh = iso_triangle_spans_view(&object->spans);
        if (object->in_pyramid) continue;
        if (!object->shapes)
            ISO_TRY(iso_gl_upload_mesh(gl->engine, &mesh, &gl->meshes[i], error));
        else if (!object->pyramid_lines)
            ISO_TRY(iso_gl_upload_shapes(gl->engine, object->shapes, &gl->shapes[i], error));
    }
    return ISO_OK;
}

static iso_status upload_surface(iso_gl_scene *gl, const iso_scene *scene, int i, iso_error *error) {
    const iso_scene_surface *surface = scene->surfaces[i].surface;
    iso_gl_surface **uploaded = &gl->surfaces[i];
    if (scene->renderer->method == ISO_METHOD_MESH) {
        ISO_TRY(iso_mesh_set_bound(surface->mesh, error));
        const iso_mesh_view mesh = iso_mesh_set_view(surface->mesh);
        return gl->strips ? iso_gl_upload_strips(gl->engine, &mesh, uploaded, error)
                          : iso_gl_upload_mesh(gl->engine, &mesh, uploaded, error);
    }
    if (i < scene->placed_count ||
        (scene->renderer->can & ISO_CAN_LEVELS && iso_scene_surface_uses_levels(surface)))
        return ISO_OK;
    const iso_point_view points = iso_scene_surface_points(surface);
    return iso_gl_upload_points(gl->engine, &points, uploaded, error);
}

iso_status iso_gl_scene_upload(iso_gl_scene *gl, const iso_scene *scene, iso_error *error) {
    ISO_TRY(upload_objects(gl, scene, error));
    for (int i = scene->pyramid_count; i < scene->count && !uploads_each_time(scene); i++)
        ISO_TRY(upload_surface(gl, scene, i, error));
    return ISO_OK;
}

uint64_t iso_gl_scene_bytes(const iso_gl_engine *engine, const iso_gl_picture *picture) {
    const int width = picture->width, height = picture->height;
    const iso_method family = picture->renderer->family;
    const uint64_t shapes = picture->shapes ? iso_gl_shapes_bytes(engine, width, height) : 0;
    if (picture->renderer->method == ISO_METHOD_SPLATS)
        return shapes + iso_gl_groups_bytes(engine, picture->groups ? picture->groups : ISO_GROUPS_DEFAULT,
                                            width, height);
    if (family != ISO_METHOD_PULLPUSH && family != ISO_METHOD_DISCS && family != ISO_METHOD_SPLATS)
        return shapes + iso_gl_draw_bytes(engine, width, height);
    return shapes + (picture->selects ? iso_gl_selection_bytes(width, height) : 0) +
           iso_gl_pullpush_bytes(engine, picture->renderer->discs, width, height);
}

void iso_gl_scene_free(iso_gl_scene *gl) {
    for (int i = 0; i < ISO_SURFACE_MAX; i++) {
        iso_gl_surface_destroy(gl->surfaces[i]);
        iso_gl_surface_destroy(gl->meshes[i]);
        iso_gl_shapes_destroy(gl->shapes[i]);
        gl->surfaces[i] = gl->meshes[i] = NULL;
        gl->shapes[i] = NULL;
    }
}

static iso_status draw_groups(const iso_gl_scene *gl, const iso_scene *scene, const iso_view *view,
                              iso_gbuffer *gbuffer, iso_error *error) {
    iso_gl_grouped_points surfaces[ISO_SURFACE_MAX];
    for (int i = 0; i < scene->count; i++)
        surfaces[i] = (iso_gl_grouped_points){iso_scene_surface_points(scene->surfaces[i].surface),
                                              &scene->surfaces[i].surface->groups};
    const iso_gl_draw_groups_opts opts = {view, surfaces, scene->count, gl->pool,
                                          scene->surfaces[0].surface->bins};
    return iso_gl_draw_groups(gl->engine, &opts, gbuffer, error);
}

static iso_status draw_hybrids(const iso_gl_scene *gl, const iso_scene *scene, const iso_view *view,
                               iso_gbuffer *gbuffer, iso_error *error) {
    for (int i = scene->pyramid_count; i < scene->count; i++) {
        const iso_scene_surface *surface = scene->surfaces[i].surface;
        const iso_point_view points = iso_scene_surface_points(surface);
        const iso_mesh_view mesh = iso_mesh_set_view(surface->mesh);
        const iso_target target = {view, gbuffer, gl->pool, (uint8_t)i, NULL};
        ISO_TRY(iso_gl_draw_hybrid(gl->engine, &target, &points, &mesh, error));
    }
    return ISO_OK;
}

/* Radii of the points of a level of detail whose spans have scales; NULL without an error: they have none. */
static iso_status make_radii(const iso_point_view *level, float **radii, iso_error *error) {
    size_t end = 0;
    *radii = NULL;
    if (!level->span_scales || level->radii) return ISO_OK;
    for (size_t s = 0; s < level->span_count; s++)
        end = level->spans[s].first + level->spans[s].count > end
                  ? level->spans[s].first + level->spans[s].count
                  : end;
    *radii = iso_alloc_zero(end, sizeof **radii);
    if (!*radii) return iso_fail_memory(error, "levels of detail");
    for (size_t s = 0; s < level->span_count; s++)
        for (size_t i = level->spans[s].first; i < level->spans[s].first + level->spans[s].count; i++)
            (*radii)[i] = (float)level->radius * level->span_scales[s];
    return ISO_OK;
}

static iso_status draw_level(const iso_gl_scene *gl, const iso_scene *scene, int number,
                             const iso_point_view *level, const iso_view *view, iso_gbuffer *gbuffer,
                             iso_error *error) {
    iso_point_view points = *level;
    iso_gl_surface *uploaded = NULL;
    float *radii;
    ISO_TRY(make_radii(level, &radii, error));
    if (radii) points.radii = radii;
    iso_status status = iso_gl_upload_points(gl->engine, &points, &uploaded, error);
    const iso_gl_surface *const surface = uploaded;
    const iso_gl_pullpush_opts opts = {view, &surface, 1, scene->renderer->discs,
                                       scene->surfaces[number].surface->selection};
    if (status == ISO_OK) status = iso_gl_draw_pullpush_over(gl->engine, &opts, number, NULL, gbuffer, error);
    iso_gl_surface_destroy(uploaded);
    iso_free(radii);
    return status;
}

/* Levels of detail are chosen, and uploaded, for every picture. */
static iso_status draw_levels(const iso_gl_scene *gl, const iso_scene *scene, int number,
                              const iso_view *view, iso_gbuffer *gbuffer, iso_error *error) {
    const iso_scene_surface *surface = scene->surfaces[number].surface;
    iso_lod_cut *cut = surface->cut;
    ISO_TRY(iso_lod_cut_make(cut, &surface->lod, view, surface->lod_pixels, gl->pool, error));
    for (int k = 0; k < cut->levels; k++)
        if (cut->view[k].span_count)
            ISO_TRY(draw_level(gl, scene, number, &cut->view[k], view, gbuffer, error));
    return ISO_OK;
}

/* iso_draw_instances_fn. */
static iso_status draw_instances(void *context, iso_instance_drawing *drawing, const iso_target *target,
                                 const iso_instances *instances, iso_instance_counts *counts,
                                 iso_error *error) {
    const iso_gl_scene *gl = context;
    return iso_gl_draw_instances(gl->engine, drawing, target, instances, counts, error);
}

/* The same as iso_renderer.draw of points, for each surface in turn: some have levels of detail, or
 * instances. */
static iso_status draw_detailed(iso_gl_scene *gl, const iso_scene *scene, const iso_view *view,
                                iso_gbuffer *gbuffer, iso_error *error) {
    for (int i = scene->pyramid_count; i < scene->count; i++) {
        const iso_gl_surface *const uploaded = gl->surfaces[i];
        const iso_target target = {view, gbuffer, gl->pool, (uint8_t)i, NULL};
        if (i < scene->placed_count) {
            ISO_TRY(iso_placed_draw(scene->placed, scene->renderer->method, scene->surfaces[i].surface,
                                    &target, draw_instances, gl, error));
            continue;
        }
        const iso_gl_pullpush_opts opts = {view, &uploaded, 1, scene->renderer->discs,
                                           scene->surfaces[i].surface->selection};
        ISO_TRY(uploaded ? iso_gl_draw_pullpush_over(gl->engine, &opts, i, NULL, gbuffer, error)
                         : draw_levels(gl, scene, i, view, gbuffer, error));
    }
    return ISO_OK;
}

static iso_status draw_surfaces(iso_gl_scene *gl, const iso_scene *scene, const iso_view *view,
                                iso_gbuffer *gbuffer, iso_error *error) {
    const iso_gl_surface *const *surfaces = (const iso_gl_surface *const *)gl->surfaces;
    const iso_method method = scene->renderer->method;
    if (draws_groups(scene)) return draw_groups(gl, scene, view, gbuffer, error);
    if (method == ISO_METHOD_HYBRID) return draw_hybrids(gl, scene, view, gbuffer, error);
    if (method == ISO_METHOD_MESH || method == ISO_METHOD_POINTS) {
        const iso_gl_draw_opts opts = {.view = view,
                                       .surfaces = surfaces,
                                       .surface_count = scene->count,
                                       .scaling = gl->scaling,
                                       .tan_x = gl->tan_x,
                                       .tan_y = gl->tan_y};
        return iso_gl_draw(gl->engine, &opts, gbuffer, error);
    }
    for (int i = 0; i < scene->count; i++)
        if (!gl->surfaces[i]) return draw_detailed(gl, scene, view, gbuffer, error);
    const iso_gl_pullpush_opts opts = {view, surfaces, scene->count, scene->renderer->discs,
                                       scene->surfaces[0].surface->selection};
    return iso_gl_draw_pullpush(gl->engine, &opts, gbuffer, error);
}

/* Objects are drawn one after the other, so that their samples are counted as the cpu's are: before later
 * ones hide them. */
static iso_status draw_object(const iso_gl_scene *gl, const iso_scene *scene, int i, const iso_view *view,
                              iso_gbuffer *gbuffer, iso_error *error) {
    iso_scene_object *object = scene->objects[i];
    const int number = scene->count + i;
    const iso_target target = {view, gbuffer, gl->pool, (uint8_t)number, NULL};
    iso_pullpush *pullpush = iso_point_workspace_pullpush(scene->workspace);
    if (object->pyramid_lines) {
        ISO_TRY(iso_gl_draw_pyramid_lines(gl->engine, &target, object->pyramid_lines, pullpush, error));
        iso_scene_object_count(object, gbuffer, number);
        return ISO_OK;
    }
    if (gl->shapes[i]) {
        const iso_gl_shapes *const sets[] = {gl->shapes[i]};
        const iso_gl_shapes_opts opts = {view, sets, 1, number};
        return iso_gl_draw_shapes(gl->engine, &opts, gbuffer, &object->drawn, error);
    }
    if (gl->meshes[i] && !gbuffer->element) {
        const iso_gl_surface *const surface = gl->meshes[i];
        const iso_gl_draw_opts opts = {
            .view = view, .surfaces = &surface, .surface_count = 1, .first_surface = number, .keep = true};
        return iso_gl_draw(gl->engine, &opts, gbuffer, error);
    }
    object->by_cpu = true;
    return iso_scene_object_draw(object, &target, pullpush, error);
}

/* iso_draw_sets_fn. */
static iso_status draw_sets(void *context, const iso_target *target, const iso_pyramid_set *sets,
                            size_t count, const iso_pullpush_opts *opts, iso_error *error) {
    const iso_gl_scene *gl = context;
    return iso_gl_draw_pyramid_sets(gl->engine, target, sets, count, opts, error);
}

/* iso_scene_engine.draw. */
static iso_status draw(void *context, const iso_scene *scene, const iso_view *view, iso_gbuffer *gbuffer,
                       iso_error *error) {
    iso_gl_scene *gl = context;
    const iso_target target = {view, gbuffer, gl->pool, 0, NULL};
    if (scene->count) ISO_TRY(draw_surfaces(gl, scene, view, gbuffer, error));
    ISO_TRY(iso_scene_draw_pyramid(scene, &target, draw_sets, gl, error));
    for (int i = 0; i < scene->object_count; i++)
        if (iso_scene_object_is_opaque(scene->objects[i]) && !scene->objects[i]->in_pyramid)
            ISO_TRY(draw_object(gl, scene, i, view, gbuffer, error));
    return ISO_OK;
}

/* iso_scene_engine.shade_groups. */
static iso_status shade_groups(void *context, const iso_splat_layers *input, iso_layer_totals *totals,
                               iso_error *error) {
    const iso_gl_scene *gl = context;
    return iso_gl_shade_splat_layers(gl->engine, input, totals, error);
}

iso_scene_engine iso_gl_scene_engine(iso_gl_scene *gl) {
    return (iso_scene_engine){draw, shade_groups, gl};
}
