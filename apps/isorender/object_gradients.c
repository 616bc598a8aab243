/* object_gradients: --glyphs surface: the gradients of the volume at points of its own isosurfaces. */
#include <string.h>

#include "apps/isorender/isorender.h"

bool isorender_object_is_surface(const isorender_object_settings *settings) {
    return settings->kind == ISORENDER_GLYPHS && strcmp(settings->path, "surface") == 0;
}

bool isorender_wants_gradients(const isorender_settings *settings) {
    for (int i = 0; i < settings->object_options.count; i++)
        if (isorender_object_is_surface(&settings->objects[i])) return true;
    return false;
}

bool isorender_gradients_have_bar(const isorender_object_settings *settings) {
    return isorender_object_is_surface(settings) && !settings->colored && !settings->by_direction;
}

/* The points of the surfaces; `made` gets those that are extracted here, because the picture needs none. */
static iso_status find_points(isorender_job *job, iso_point_set *made[ISORENDER_SURFACES],
                              iso_gradient_source sources[ISORENDER_SURFACES], iso_error *error) {
    for (int i = 0; i < job->input_surface_count; i++) {
        isorender_surface *surface = &job->surfaces[i];
        const iso_points_opts opts = {
            .isovalue = surface->scene.isovalue, .primitive = isorender_primitive(job), .pool = job->pool};
        sources[i].grid = &surface->scene.grid;
        if (!surface->scene.points) {
            ISO_TRY(iso_point_set_create(&surface->scene.grid, &opts, &made[i], error));
            ISO_TRY(iso_point_set_update(made[i], error));
        }
        sources[i].points = iso_point_set_view(made[i] ? made[i] : surface->scene.points);
    }
    return ISO_OK;
}

static iso_status make_glyphs(isorender_job *job, isorender_object *object, iso_error *error) {
    const isorender_object_settings *settings = object->settings;
    iso_point_set *made[ISORENDER_SURFACES] = {NULL};
    iso_gradient_source sources[ISORENDER_SURFACES];
    const iso_gradient_glyphs_opts opts = {.every = settings->every,
                                           .scale = settings->field.scale,
                                           .max_memory = job->settings->common.input.max_memory};
    iso_status status = find_points(job, made, sources, error);
    if (status == ISO_OK)
        status = iso_gradient_glyphs(sources, job->input_surface_count, &opts, &object->glyphs,
                                     &object->gradients, error);
    for (int i = 0; i < job->input_surface_count; i++) iso_point_set_destroy(made[i]);
    return status;
}

iso_status isorender_object_take_gradients(isorender_job *job, isorender_object *object, iso_error *error) {
    const isorender_object_settings *settings = object->settings;
    ISO_TRY(make_glyphs(job, object, error));
    object->report.items = object->gradients.points;
    if (!object->glyphs.count)
        return iso_fail(error, ISO_ERR_EMPTY, "surface: no gradient at %zu points is a number above 0",
                        object->gradients.points);
    if (!settings->glyph_given) object->glyph = ISO_GLYPH_CONE;
    if (isorender_gradients_have_bar(settings) && !object->color_by) object->color_by = "gradient";
    if (!settings->every)
        isorender_log(job, "note: surface: a glyph for each block of %d voxels on each axis (--every)",
                      object->gradients.every);
    return isorender_object_style(object, error);
}

void isorender_gradients_put(iso_json *json, const isorender_object *object) {
    const iso_gradient_glyphs_totals *totals = &object->gradients;
    iso_json_begin_object(json, "gradients");
    iso_json_integer(json, "points", totals->points);
    iso_json_integer(json, "every", (uint64_t)totals->every);
    iso_json_real(json, "scale_mm", totals->scale);
    iso_json_integer(json, "missing", totals->missing);
    iso_json_end_object(json);
}
