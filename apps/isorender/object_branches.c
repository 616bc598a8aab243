/* object_branches: a mesh in --lines, which becomes tubes, ribbons, and what stays triangles. Each is an
 * object of its own; the first is the object that was read. */
#include <string.h>

#include "apps/isorender/isorender.h"

/* Gives the object settings of its own, with the style of what it holds if the options say none. */
static void set_style(isorender_object *object, isorender_line_style style) {
    object->own = *object->settings;
    object->settings = &object->own;
    if (!object->own.style_given) object->own.style = style;
}

void isorender_object_take_branches(isorender_object *object) {
    iso_mesh_lines *made = object->file.branches;
    iso_lines *from = made->tubes.line_count ? &made->tubes : &made->ribbons;
    set_style(object, from == &made->tubes ? ISORENDER_STYLE_TUBE : ISORENDER_STYLE_RIBBON);
    object->file.lines = *from;
    *from = (iso_lines){.line_count = 0};
}

/* The next object, with the settings of `whole`. */
static iso_status add_part(isorender_job *job, const isorender_object *whole, isorender_object **part,
                           iso_error *error) {
    if (job->object_count == ISORENDER_OBJECTS)
        return iso_fail(error, ISO_ERR_USAGE,
                        "%s: more than %d files, or parts of files, of lines, glyphs and meshes",
                        whole->settings->path, ISORENDER_OBJECTS);
    *part = &job->objects[job->object_count++];
    **part = (isorender_object){.settings = whole->settings,
                                .whole = whole,
                                .scene.color = whole->scene.color,
                                .color_by = whole->color_by,
                                .file.report = whole->file.report};
    return ISO_OK;
}

static void log_rest(const isorender_job *job, const isorender_object *whole) {
    const iso_mesh_lines *made = whole->file.branches;
    const size_t rest = made->pieces - made->tube_pieces - made->ribbon_pieces;
    const char *path = whole->settings->path;
    const bool is_input = strcmp(path, job->plan->input) == 0; /* it is named already */
    const char *name = is_input ? "" : path, *colon = is_input ? "" : ": ";
    if (rest)
        isorender_log(job, "note: %s%s%zu of %zu pieces are not made of thin branches and stay triangles",
                      name, colon, rest, made->pieces);
    if (made->left_out)
        isorender_log(job, "note: %s%s%zu triangles are degenerate, or there twice, and are left out", name,
                      colon, made->left_out);
}

iso_status isorender_object_add_parts(isorender_job *job, isorender_object *whole, iso_error *error) {
    isorender_object *part;
    iso_mesh_lines *made = whole->file.branches;
    if (!made) return ISO_OK;
    log_rest(job, whole);
    if (made->ribbons.line_count) {
        ISO_TRY(add_part(job, whole, &part, error));
        set_style(part, ISORENDER_STYLE_RIBBON);
        part->file.lines = made->ribbons;
        made->ribbons = (iso_lines){.line_count = 0};
        ISO_TRY(isorender_object_style(part, error));
    }
    if (!made->rest.triangle_count) return ISO_OK;
    ISO_TRY(add_part(job, whole, &part, error));
    set_style(part, ISORENDER_STYLE_TUBE);
    part->own.kind = ISO_OBJECT_MESH;
    part->file.mesh = made->rest;
    made->rest = (iso_triangles){.triangle_count = 0};
    return ISO_OK;
}
