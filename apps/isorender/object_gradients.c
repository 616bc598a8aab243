/* object_gradients: --glyphs surface: the gradients of the volume at points of its own isosurfaces. */
#include <string.h>

#include "apps/isorender/isorender.h"

bool isorender_object_is_surface(const isorender_object_settings *settings) {
    return settings->kind == ISO_OBJECT_GLYPHS && strcmp(settings->path, "surface") == 0;
}

bool isorender_wants_gradients(const isorender_settings *settings) {
    for (int i = 0; i < settings->object_options.count; i++)
        if (isorender_object_is_surface(&settings->objects[i])) return true;
    return false;
}

bool isorender_gradients_have_bar(const isorender_object_settings *settings) {
    return isorender_object_is_surface(settings) && !settings->colored && !settings->by_direction;
}

static iso_status make_glyphs(isorender_job *job, isorender_object *object, iso_error *error) {
    const isorender_object_settings *settings = object->settings;
    iso_scene_surface *surfaces[ISORENDER_SURFACES];
    const iso_gradient_glyphs_opts opts = {.every = settings->every,
                                           .scale = settings->field.scale,
                                           .max_memory = job->settings->common.input.max_memory};
    for (int i = 0; i < job->input_surface_count; i++) {
        surfaces[i] = &job->surfaces[i].scene;
        surfaces[i]->primitive = isorender_primitive(job);
    }
    return iso_object_gradients(surfaces, job->input_surface_count, &opts, &object->file.glyphs,
                                &object->gradients, error);
}

iso_status isorender_object_take_gradients(isorender_job *job, isorender_object *object, iso_error *error) {
    const isorender_object_settings *settings = object->settings;
    ISO_TRY(make_glyphs(job, object, error));
    object->file.report.items = object->gradients.points;
    if (!object->file.glyphs.count)
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
