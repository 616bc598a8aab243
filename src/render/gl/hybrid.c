/* hybrid: uploads the bricks that are points, and those that are triangles, and draws them in one pyramid. */
#include "render/gl/hybrid.h"

#include <glad/gl.h>

#include "render/gl/shared_pyramid.h"
#include "render/gl/surface.h"

_Static_assert(sizeof(iso_gl_polygons_uniforms) == 128, "layout of std140");

static iso_gl_polygons_uniforms uniforms_of(const iso_gl_triangles *triangles) {
    const iso_projector *p = &triangles->choice->projector;
    iso_gl_polygons_uniforms u = {.choice = {(float)(triangles->choice->cell * p->view->focal),
                                             (float)triangles->choice->pixels, 0, (float)triangles->radius},
                                  .depth_row = {0, 0, 0, (float)p->origin[2]}};
    float *index[] = {u.index_x, u.index_y, u.index_z}, *turn[] = {u.turn_x, u.turn_y, u.turn_z};
    double half = 0; /* of a brick's depth */
    for (int k = 0; k < 3; k++) {
        double origin = 0;
        for (int i = 0; i < 3; i++) {
            index[k][i] = (float)triangles->to_index[3 * k + i];
            turn[k][i] = (float)triangles->to_normal[3 * k + i];
            origin -= triangles->to_index[3 * k + i] * p->origin[i];
        }
        index[k][3] = (float)origin;
        u.depth_row[k] = (float)p->matrix[6 + k];
        half += 0.5 * ISO_BRICK * fabs(p->matrix[6 + k]);
    }
    u.choice[2] = (float)half;
    return u;
}

static iso_status dispatch(const iso_gl_engine *engine, unsigned program, int width, int height) {
    const GladGLContext *gl = engine->context->gl;
    gl->UseProgram(program);
    gl->DispatchCompute((GLuint)(width + ISO_GL_TILE - 1) / ISO_GL_TILE,
                        (GLuint)(height + ISO_GL_TILE - 1) / ISO_GL_TILE, 1);
    gl->MemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
    return ISO_OK;
}

iso_status iso_gl_triangles_add(iso_gl_engine *engine, const iso_gl_triangles *triangles,
                                const iso_view *view, const iso_pyramid_layout *layout, iso_error *error) {
    const GladGLContext *gl = engine->context->gl;
    const iso_gl_polygons_uniforms u = uniforms_of(triangles);
    const iso_view whole = iso_pyramid_view(view, layout);
    const iso_gl_draw_opts opts = {.view = &whole, .surfaces = &triangles->mesh, .surface_count = 1};
    unsigned program;
    ISO_TRY(iso_gl_draw_target(engine, &opts, error));
    ISO_TRY(iso_gl_engine_program(engine, ISO_GL_POLYGON_KEYS, &program, error));
    iso_gl_engine_ensure_storage(engine, ISO_GL_STORE_SPLATTING, sizeof u);
    gl->NamedBufferSubData(engine->storage[ISO_GL_STORE_SPLATTING], 0, sizeof u, &u);
    gl->BindBufferBase(GL_UNIFORM_BUFFER, ISO_GL_POLYGONS, engine->storage[ISO_GL_STORE_SPLATTING]);
    gl->BindBufferBase(GL_SHADER_STORAGE_BUFFER, ISO_GL_KEYS, engine->storage[ISO_GL_STORE_KEYS]);
    gl->BindTextureUnit(ISO_GL_NORMAL_DEPTHS, engine->target.colors[ISO_GL_NORMAL_DEPTH]);
    return dispatch(engine, program, layout->width, layout->height);
}

iso_status iso_gl_triangles_finish(iso_gl_engine *engine, const iso_view *view, iso_error *error) {
    unsigned program;
    ISO_TRY(iso_gl_engine_program(engine, ISO_GL_POLYGON_SAMPLES, &program, error));
    return dispatch(engine, program, view->width, view->height);
}

static iso_status draw_mesh(iso_gl_engine *engine, const iso_target *target, const iso_gl_surface *mesh,
                            iso_error *error) {
    const iso_gl_draw_opts opts = {.view = target->view,
                                   .surfaces = &mesh,
                                   .surface_count = 1,
                                   .first_surface = target->surface,
                                   .keep = true};
    return iso_gl_draw(engine, &opts, target->gbuffer, error);
}

static iso_status draw_parts(iso_gl_engine *engine, const iso_target *target, const iso_hybrid_parts *parts,
                             const iso_gl_surface *points, const iso_gl_surface *mesh, iso_error *error) {
    iso_gl_triangles triangles = {
        .mesh = mesh, .choice = &parts->choice, .radius = ISO_DISC_RADII * parts->points.radius};
    const iso_gl_pullpush_opts opts = {target->view, &points, 1, ISO_RECONSTRUCTION_GAUSSIAN,
                                       ISO_SELECTION_ALL};
    double normal[9];
    for (int k = 0; k < 9; k++) normal[k] = (double)parts->choice.projector.normal[k];
    if (!mesh) return iso_gl_draw_pullpush_over(engine, &opts, target->surface, NULL, target->gbuffer, error);
    if (!points || !iso_matrix_invert(parts->choice.projector.matrix, triangles.to_index) ||
        !iso_matrix_invert(normal, triangles.to_normal))
        return draw_mesh(engine, target, mesh, error);
    return iso_gl_draw_pullpush_over(engine, &opts, target->surface, &triangles, target->gbuffer, error);
}

iso_status iso_gl_draw_hybrid(iso_gl_engine *engine, const iso_target *target, const iso_point_view *points,
                              const iso_mesh_view *mesh, iso_error *error) {
    iso_hybrid_parts parts;
    iso_gl_surface *uploaded[2] = {NULL, NULL};
    iso_status status = iso_hybrid_parts_make(target->view, points, mesh, 0, &parts, error);
    if (status == ISO_OK && (parts.points.span_count || !parts.mesh.span_count))
        status = iso_gl_upload_points(engine, &parts.points, &uploaded[0], error);
    if (status == ISO_OK && parts.mesh.span_count)
        status = iso_gl_upload_mesh(engine, &parts.mesh, &uploaded[1], error);
    if (status == ISO_OK) status = draw_parts(engine, target, &parts, uploaded[0], uploaded[1], error);
    for (int i = 0; i < 2; i++) iso_gl_surface_destroy(uploaded[i]);
    iso_hybrid_parts_free(&parts);
    return status;
}
