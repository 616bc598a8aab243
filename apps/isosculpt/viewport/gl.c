/* The gl engine of a viewport: one canvas for pictures, one for picking, buffers for points and mesh. */
#include "apps/isosculpt/viewport/gl.h"

#include "base/memory.h"

struct isosculpt_gl {
    iso_gl_context *context;
    iso_gl_engine *engine;
    iso_gl_canvas *drawn, *pick_buffer;
    iso_gl_surface *points, *mesh; /* NULL: not needed so far */
};

iso_status isosculpt_gl_create(iso_gl_context *context, isosculpt_gl **gl, iso_error *error) {
    isosculpt_gl *created = iso_alloc_zero(1, sizeof *created);
    if (!created) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for an engine");
    created->context = context;
    iso_status status = iso_gl_engine_create(context, &created->engine, error);
    if (status == ISO_OK) status = iso_gl_canvas_create(created->engine, &created->drawn, error);
    if (status == ISO_OK) status = iso_gl_canvas_create(created->engine, &created->pick_buffer, error);
    if (status == ISO_OK)
        *gl = created;
    else
        isosculpt_gl_destroy(created);
    return status;
}

void isosculpt_gl_release_buffers(isosculpt_gl *gl) {
    if (!gl) return;
    iso_gl_surface_destroy(gl->points);
    iso_gl_surface_destroy(gl->mesh);
    gl->points = gl->mesh = NULL;
}

void isosculpt_gl_destroy(isosculpt_gl *gl) {
    if (!gl) return;
    isosculpt_gl_release_buffers(gl);
    iso_gl_canvas_destroy(gl->pick_buffer);
    iso_gl_canvas_destroy(gl->drawn);
    iso_gl_engine_destroy(gl->engine);
    iso_free(gl);
}

const char *isosculpt_gl_renderer(const isosculpt_gl *gl) {
    return iso_gl_context_info(gl->context).renderer;
}

iso_status isosculpt_gl_draw_mesh(isosculpt_gl *gl, const iso_mesh_view *mesh, const iso_view *view,
                                  const iso_gl_paint *paint, iso_gl_canvas **canvas, iso_error *error) {
    if (gl->mesh)
        ISO_TRY(iso_gl_update_mesh(gl->mesh, mesh, error));
    else
        ISO_TRY(iso_gl_upload_mesh(gl->engine, mesh, &gl->mesh, error));
    const iso_gl_surface *const surface = gl->mesh;
    const iso_gl_draw_opts opts = {.view = view, .surfaces = &surface, .surface_count = 1};
    *canvas = gl->drawn;
    return iso_gl_canvas_draw(gl->drawn, &opts, paint, error);
}

iso_status isosculpt_gl_draw_points(isosculpt_gl *gl, const iso_point_view *points,
                                    const iso_reconstruction *reconstruction, const iso_view *view,
                                    const iso_gl_paint *paint, iso_gl_canvas **canvas, iso_error *error) {
    if (gl->points)
        ISO_TRY(iso_gl_update_points(gl->points, points, error));
    else
        ISO_TRY(iso_gl_upload_points(gl->engine, points, &gl->points, error));
    const iso_gl_surface *const surface = gl->points;
    const iso_gl_draw_opts dots = {.view = view, .surfaces = &surface, .surface_count = 1};
    *canvas = gl->drawn;
    if (!reconstruction) return iso_gl_canvas_draw(gl->drawn, &dots, paint, error);
    const iso_gl_pullpush_opts opts = {
        .view = view, .surfaces = &surface, .surface_count = 1, .reconstruction = *reconstruction};
    return iso_gl_canvas_draw_pullpush(gl->drawn, &opts, paint, error);
}

iso_status isosculpt_gl_keep_pick_buffer(isosculpt_gl *gl, iso_gl_canvas **pick_buffer, iso_error *error) {
    *pick_buffer = gl->pick_buffer;
    return iso_gl_canvas_copy(gl->pick_buffer, gl->drawn, error);
}
