/* engine: the framebuffer (normal and depth, surface number, depth test), drawn part by part and read
 * back; draw commands of the spans that a part shows, as one multi-draw per surface. */
#include "render/gl/engine.h"

#include <assert.h>
#include <glad/gl.h>
#include <string.h>

#include "base/memory.h"
#include "render/gl/discs.h"
#include "render/gl/output.h"
#include "render/gl/shapes_set.h"
#include "render/gl/shared.h"
#include "render/gl/surface.h"
#include "render/view/project.h"

/* Limits of the side of a part of a picture, samples. Drivers of OpenGL 4.5 can draw 16384, less the
 * margin that the widest points need. */
enum { MOST_SIDE = 4096, LEAST_SIDE = 256 };
static const size_t READ_BYTES = (size_t)8 << 20;

_Static_assert(offsetof(iso_gl_draw_uniforms, turn_x) == 128 &&
                   offsetof(iso_gl_draw_uniforms, screen) == 224 && sizeof(iso_gl_draw_uniforms) == 288,
               "layout of std140");

/* ---- creation */

/* Side of the largest square that is drawn at once. */
static int widest_part(const GladGLContext *gl, int margin) {
    GLint texture = 0, view[2] = {0, 0}, side = MOST_SIDE;
    gl->GetIntegerv(GL_MAX_TEXTURE_SIZE, &texture);
    gl->GetIntegerv(GL_MAX_VIEWPORT_DIMS, view);
    const GLint limits[] = {texture, view[0] - 2 * margin, view[1] - 2 * margin};
    for (int i = 0; i < 3; i++) side = limits[i] < side ? limits[i] : side;
    return side;
}

static void make_buffers(iso_gl_engine *engine, const GladGLContext *gl) {
    GLfloat range[2] = {1, 1};
    gl->GetFloatv(GL_POINT_SIZE_RANGE, range);
    engine->max_point = range[1] < 1024 ? range[1] : 1024;
    GLint64 storage = 0;
    gl->GetInteger64v(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, &storage);
    engine->max_storage = storage > 0 ? (size_t)storage : 0;
    GLint vertex_buffers = 0;
    gl->GetIntegerv(GL_MAX_VERTEX_SHADER_STORAGE_BLOCKS, &vertex_buffers);
    engine->vertex_storage = vertex_buffers >= 3;
    engine->wide_atomics = iso_gl_has_wide_atomics(engine->context);
    engine->max_side = widest_part(gl, iso_gl_engine_margin(engine));
    gl->CreateBuffers(1, &engine->draw_uniforms);
    gl->NamedBufferStorage(engine->draw_uniforms, sizeof(iso_gl_draw_uniforms), NULL, GL_DYNAMIC_STORAGE_BIT);
    gl->CreateBuffers(1, &engine->commands);
    gl->CreateBuffers(1, &engine->instances);
}

static iso_status check_limits(const iso_gl_engine *engine, iso_error *error) {
    if (engine->max_side >= LEAST_SIDE) return ISO_OK;
    return iso_fail(error, ISO_ERR_BACKEND, "%s: pictures of the driver are at most %d pixels wide",
                    engine->context->name, engine->max_side);
}

iso_status iso_gl_engine_create(iso_gl_context *context, iso_gl_engine **engine, iso_error *error) {
    iso_gl_engine *made = iso_alloc_zero(1, sizeof *made);
    if (!made) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for an engine");
    made->context = context;
    made->timer.by_clock = iso_gl_renderer_is_software(context->renderer);
    iso_status status = iso_gl_enter(context, error);
    if (status == ISO_OK) {
        make_buffers(made, context->gl);
        status = iso_gl_leave(context, check_limits(made, error), error);
    }
    if (status == ISO_OK)
        *engine = made;
    else
        iso_gl_engine_destroy(made);
    return status;
}

void iso_gl_engine_destroy(iso_gl_engine *engine) {
    if (!engine) return;
    iso_gl_context *context = engine->context;
    if (iso_gl_enter(context, NULL) == ISO_OK) {
        const GladGLContext *gl = context->gl;
        const GLuint buffers[] = {engine->draw_uniforms, engine->commands, engine->instances};
        iso_gl_target_free(&engine->target, gl);
        iso_gl_disc_targets_free(&engine->discs, gl);
        iso_gl_shapes_target_free(&engine->shapes, gl);
        gl->DeleteBuffers(3, buffers);
        gl->DeleteBuffers(ISO_GL_STORES, engine->storage);
        iso_gl_timer_free(&engine->timer, gl);
        for (int i = 0; i < ISO_GL_PROGRAMS; i++) gl->DeleteProgram(engine->programs[i]);
        iso_gl_leave(context, ISO_OK, NULL);
    }
    iso_free(engine);
}

iso_status iso_gl_engine_program(iso_gl_engine *engine, iso_gl_program program, unsigned *name,
                                 iso_error *error) {
    if (!engine->programs[program])
        ISO_TRY(iso_gl_program_build(engine->context, program, &engine->programs[program], error));
    *name = engine->programs[program];
    return ISO_OK;
}

void iso_gl_engine_ensure_storage(iso_gl_engine *engine, iso_gl_storage which, size_t bytes) {
    const GladGLContext *gl = engine->context->gl;
    if (engine->storage[which] && engine->storage_bytes[which] >= bytes) return;
    gl->DeleteBuffers(1, &engine->storage[which]);
    gl->CreateBuffers(1, &engine->storage[which]);
    gl->NamedBufferStorage(engine->storage[which], (GLsizeiptr)bytes, NULL, GL_DYNAMIC_STORAGE_BIT);
    engine->storage_bytes[which] = bytes;
}

iso_status iso_gl_engine_provide_storage(iso_gl_engine *engine, iso_gl_storage which, unsigned slot,
                                         size_t bytes, const char *what, iso_error *error) {
    if (bytes > engine->max_storage)
        return iso_fail(error, ISO_ERR_LIMIT, "%s: %s storage buffers of %zu bytes, and %s has %zu at most",
                        engine->context->name, what, bytes, engine->context->renderer, engine->max_storage);
    iso_gl_engine_ensure_storage(engine, which, bytes);
    engine->context->gl->BindBufferBase(GL_SHADER_STORAGE_BUFFER, slot, engine->storage[which]);
    return ISO_OK;
}

/* ---- the framebuffer */

unsigned iso_gl_make_texture(const GladGLContext *gl, unsigned format, int width, int height) {
    GLuint texture;
    gl->CreateTextures(GL_TEXTURE_2D, 1, &texture);
    gl->TextureStorage2D(texture, 1, format, width, height);
    return texture;
}

enum { TARGET_BYTES = 21 }; /* a pixel: RGBA32F, R8UI, DEPTH_COMPONENT32F */

uint64_t iso_gl_draw_bytes(const iso_gl_engine *engine, int width, int height) {
    uint64_t side = (uint64_t)engine->max_side, w = (uint64_t)width, h = (uint64_t)height;
    return (w < side ? w : side) * (h < side ? h : side) * TARGET_BYTES + READ_BYTES;
}

/* Depth is reversed, 1 at the near plane: floats are finest near 0, where far things are. */
static void begin_part(const iso_gl_engine *engine, const iso_view *view) {
    const GladGLContext *gl = engine->context->gl;
    const GLfloat nothing[4] = {0, 0, -1, INFINITY}, far = 0;
    const GLuint none[4] = {ISO_SURFACE_NONE};
    int margin = iso_gl_engine_margin(engine);
    gl->BindFramebuffer(GL_FRAMEBUFFER, engine->target.framebuffer);
    gl->ClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
    gl->Viewport(-margin, -margin, view->width + 2 * margin, view->height + 2 * margin);
    gl->Enable(GL_SCISSOR_TEST);
    gl->Scissor(0, 0, view->width, view->height);
    gl->Enable(GL_DEPTH_TEST);
    gl->DepthFunc(GL_GREATER);
    gl->Enable(GL_PROGRAM_POINT_SIZE);
    gl->Enable(GL_PRIMITIVE_RESTART_FIXED_INDEX);
    gl->ClearBufferfv(GL_COLOR, ISO_GL_NORMAL_DEPTH, nothing);
    gl->ClearBufferuiv(GL_COLOR, ISO_GL_SURFACE, none);
    gl->ClearBufferfv(GL_DEPTH, 0, &far);
}

/* Copies a row of normals, depths and surface numbers. keep: only where they are nearer. */
static void copy_row(const iso_gbuffer *to, size_t start, const float *pixels, const uint8_t *surfaces,
                     int count, bool keep) {
    for (int i = 0; i < count; i++) {
        const size_t at = start + (size_t)i;
        const float *pixel = pixels + 4 * i;
        if (keep && !(pixel[3] < to->depth[at])) continue;
        for (int axis = 0; axis < 3; axis++) to->normal[axis][at] = pixel[axis];
        to->depth[at] = pixel[3];
        to->surface[at] = surfaces[i];
    }
}

/* First sample of a part in the picture. */
typedef struct part_origin {
    int x, y;
} part_origin;

/* Reads a part of a picture back into its place in the gbuffer. keep: as in iso_gl_draw_opts. */
static iso_status read_part(const iso_gl_engine *engine, const iso_view *view, part_origin at, bool keep,
                            iso_gbuffer *to, iso_error *error) {
    const GladGLContext *gl = engine->context->gl;
    size_t width = (size_t)view->width, row = width * (4 * sizeof(float) + 1);
    int step = row < READ_BYTES ? (int)(READ_BYTES / row) : 1;
    if (step > view->height) step = view->height;
    float *pixels = iso_alloc(row * (size_t)step);
    if (!pixels) return iso_fail(error, ISO_ERR_NOMEM, "out of memory to read a picture back");
    uint8_t *surfaces = (uint8_t *)(pixels + 4 * width * (size_t)step);
    gl->PixelStorei(GL_PACK_ALIGNMENT, 1);
    for (int y = 0; y < view->height; y += step) {
        int rows = view->height - y < step ? view->height - y : step;
        gl->NamedFramebufferReadBuffer(engine->target.framebuffer,
                                       GL_COLOR_ATTACHMENT0 + ISO_GL_NORMAL_DEPTH);
        gl->ReadPixels(0, y, view->width, rows, GL_RGBA, GL_FLOAT, pixels);
        gl->NamedFramebufferReadBuffer(engine->target.framebuffer, GL_COLOR_ATTACHMENT0 + ISO_GL_SURFACE);
        gl->ReadPixels(0, y, view->width, rows, GL_RED_INTEGER, GL_UNSIGNED_BYTE, surfaces);
        for (int i = 0; i < rows; i++)
            copy_row(to, (size_t)(at.y + y + i) * (size_t)to->width + (size_t)at.x,
                     pixels + (size_t)i * width * 4, surfaces + (size_t)i * width, view->width, keep);
    }
    iso_free(pixels);
    return ISO_OK;
}

/* ---- one surface */

typedef struct surface_draw {
    iso_gl_engine *engine;
    const iso_gl_draw_opts *opts;
    const iso_gl_surface *surface;
    iso_projector projector; /* of the part's view */
    double widening;         /* of attenuated points: 1 / sqrt(k) */
    double range[2];         /* of depth, orthographic */
} surface_draw;

static double squared(double x) {
    return x * x;
}

/* 1 / sqrt(k) of eq. 6 (Baerentzen and Christensen 2003), which is given for square pictures: k = 1 / (1 +
 * 2 tan^2). */
static double widening_of(const iso_gl_draw_opts *opts) {
    const iso_view *view = opts->view;
    if (opts->scaling != ISO_SCALING_ATTENUATED || view->orthographic) return 1;
    double x = opts->tan_x, y = opts->tan_y;
    if (!(x > 0)) x = fmax(view->cx, view->width - view->cx) / view->focal;
    if (!(y > 0)) y = fmax(view->cy, view->height - view->cy) / view->focal;
    return sqrt(1 + squared(x) + squared(y));
}

static void set_row(float to[4], const double *m, double last) {
    for (int i = 0; i < 3; i++) to[i] = (float)m[i];
    to[3] = (float)last;
}

static void upload_uniforms(const surface_draw *draw, int surface) {
    const GladGLContext *gl = draw->engine->context->gl;
    const iso_projector *p = &draw->projector;
    const iso_view *view = p->view;
    double cx = view->cx, cy = view->cy;
    if (draw->surface->mesh) {
        cx = floor(cx * ISO_GL_SUBPIXEL + 0.5) / ISO_GL_SUBPIXEL;
        cy = floor(cy * ISO_GL_SUBPIXEL + 0.5) / ISO_GL_SUBPIXEL;
    }
    int margin = iso_gl_engine_margin(draw->engine);
    iso_gl_draw_uniforms f = {
        .pixels = {view->focal, cx, cy, fmax(view->near, -1e30)},
        .screen = {(float)(view->width + 2 * margin), (float)(view->height + 2 * margin), (float)margin},
        .depths = {(float)draw->range[1], (float)(1 / (draw->range[1] - draw->range[0]))},
        .points = {(float)draw->engine->max_point, (float)draw->widening},
        .flags = {(unsigned)surface, view->orthographic, draw->opts->scaling == ISO_SCALING_ATTENUATED}};
    double *rows[] = {f.row_x, f.row_y, f.row_z};
    float *turns[] = {f.turn_x, f.turn_y, f.turn_z}, *normals[] = {f.normal_x, f.normal_y, f.normal_z};
    for (int k = 0; k < 3; k++) {
        memcpy(rows[k], p->matrix + 3 * k, 3 * sizeof *rows[k]);
        rows[k][3] = p->origin[k];
        set_row(turns[k], p->matrix + 3 * k, 0);
        memcpy(normals[k], p->normal + 3 * k, 3 * sizeof *normals[k]);
    }
    gl->NamedBufferSubData(draw->engine->draw_uniforms, 0, sizeof f, &f);
    gl->BindBufferBase(GL_UNIFORM_BUFFER, ISO_GL_DRAW, draw->engine->draw_uniforms);
}

/* View space z of the box's nearest corner. */
static double nearest_depth(const surface_draw *draw, const iso_box *box) {
    const double *m = draw->projector.matrix + 6;
    double nearest = INFINITY;
    for (int k = 0; k < 8; k++) {
        iso_vec3 p = iso_box_corner(box, k);
        nearest = fmin(nearest, m[0] * p.x + m[1] * p.y + m[2] * p.z + draw->projector.origin[2]);
    }
    return nearest;
}

static bool is_visible(const surface_draw *draw, const iso_gl_span *span) {
    if (!span->count) return false;
    iso_rows rows = iso_projector_rows(&draw->projector, &span->box, span->radius * draw->widening);
    return rows.first <= rows.last;
}

/* Whether back-facing triangles can be left out: those of a closed surface that lies wholly beyond the
 * near plane. (Never for points: discs face the picture, so back-facing ones show beyond the outline.) */
static bool hides_back_facing(const surface_draw *draw) {
    const iso_gl_surface *surface = draw->surface;
    if (!surface->mesh || !surface->closed || draw->engine->keep_back_facing) return false;
    const iso_gl_span *spans = surface->spans.data;
    for (size_t s = 0; s < surface->span_count; s++)
        if (!iso_box_is_empty(&spans[s].box) &&
            !(nearest_depth(draw, &spans[s].box) > draw->projector.view->near))
            return false;
    return true;
}

static bool is_back_facing(const surface_draw *draw, const double eye[3], size_t s) {
    const iso_gl_span *spans = draw->surface->spans.data;
    const iso_point_bounds *bounds = draw->surface->bounds.data;
    return iso_projector_facing(&draw->projector, eye, spans[s].brick, &bounds[s]) == ISO_FACING_AWAY;
}

/* The per-instance data of a span of points. */
static iso_gl_instance instance_of(const surface_draw *draw, const iso_gl_span *span) {
    const float corner_position[3] = {0, 0, 0};
    const iso_vec3 origin = iso_projector_point(&draw->projector, span->brick, corner_position);
    return (iso_gl_instance){.origin = {(float)origin.x, (float)origin.y, (float)origin.z}};
}

static void draw_commands(const surface_draw *draw, size_t count, const void *commands,
                          const void *instances) {
    draw->engine->drawn += count;
    iso_gl_surface_command(draw->surface, count, commands, instances);
    iso_gl_surface_draw(draw->surface, count);
}

static iso_status draw_mesh(const surface_draw *draw, iso_buffer *room, iso_error *error) {
    const iso_gl_surface *surface = draw->surface;
    size_t commands_size = surface->span_count * sizeof(iso_gl_mesh_command), seen = 0;
    ISO_TRY(iso_buffer_reserve(room, commands_size + surface->span_count * 3 * sizeof(int32_t), 0, error));
    iso_gl_mesh_command *commands = room->data;
    int32_t(*bricks)[3] = (int32_t(*)[3])((char *)room->data + commands_size);
    const iso_gl_span *spans = surface->spans.data;
    bool hides = hides_back_facing(draw);
    double eye[3];
    iso_projector_eye(&draw->projector, &surface->transform, eye);
    for (size_t s = 0; s < surface->span_count; s++) {
        const iso_gl_span *span = &spans[s];
        if (!is_visible(draw, span)) continue;
        if (hides && is_back_facing(draw, eye, s)) {
            draw->engine->back_facing++;
            continue;
        }
        commands[seen] = (iso_gl_mesh_command){span->count, 1, span->first, span->base, (uint32_t)seen};
        memcpy(bricks[seen++], span->brick, sizeof *bricks);
    }
    unsigned program;
    ISO_TRY(iso_gl_engine_program(draw->engine, ISO_GL_MESH, &program, error));
    draw->engine->context->gl->UseProgram(program);
    if (seen) draw_commands(draw, seen, commands, bricks);
    return ISO_OK;
}

/* Whether a point of the span may be wider than the driver's largest point. */
static bool may_be_wide(const surface_draw *draw, const iso_gl_span *span) {
    const iso_view *view = draw->projector.view;
    double scale = view->focal;
    if (!view->orthographic) {
        scale = draw->widening * view->focal / fmax(nearest_depth(draw, &span->box), view->near);
    }
    return 2.001 * span->radius * scale + 1 > draw->engine->max_point;
}

/* Draws the points that are wider than the driver's largest point, as quads. */
static iso_status draw_wide_points(const surface_draw *draw, iso_error *error) {
    const iso_gl_surface *surface = draw->surface;
    unsigned program = 0;
    const iso_gl_span *spans = surface->spans.data;
    for (size_t s = 0; s < surface->span_count; s++) {
        const iso_gl_span *span = &spans[s];
        if (!is_visible(draw, span) || !may_be_wide(draw, span)) continue;
        if (!program) {
            ISO_TRY(iso_gl_engine_program(draw->engine,
                                          surface->surfels ? ISO_GL_QUADS_SURFELS : ISO_GL_QUADS_PACKED,
                                          &program, error));
            draw->engine->context->gl->UseProgram(program);
        }
        const iso_gl_instance instance = instance_of(draw, span);
        iso_gl_surface_draw_quads(surface, span->first, span->count, &instance);
    }
    return ISO_OK;
}

static iso_status draw_points(const surface_draw *draw, iso_buffer *room, iso_error *error) {
    const iso_gl_surface *surface = draw->surface;
    const GladGLContext *gl = draw->engine->context->gl;
    size_t commands_size = surface->span_count * sizeof(iso_gl_points_command), seen = 0;
    ISO_TRY(
        iso_buffer_reserve(room, commands_size + surface->span_count * sizeof(iso_gl_instance), 0, error));
    iso_gl_points_command *commands = room->data;
    iso_gl_instance *instances = (iso_gl_instance *)((char *)room->data + commands_size);
    const iso_gl_span *spans = surface->spans.data;
    for (size_t s = 0; s < surface->span_count; s++) {
        const iso_gl_span *span = &spans[s];
        if (!is_visible(draw, span)) continue;
        commands[seen] = (iso_gl_points_command){span->count, 1, span->first, (uint32_t)seen};
        instances[seen++] = instance_of(draw, span);
    }
    unsigned program;
    ISO_TRY(iso_gl_engine_program(
        draw->engine, surface->surfels ? ISO_GL_POINTS_SURFELS : ISO_GL_POINTS_PACKED, &program, error));
    gl->UseProgram(program);
    if (!surface->has_radii) gl->VertexAttrib1f(ISO_GL_RADIUS, (GLfloat)surface->radius);
    if (seen) draw_commands(draw, seen, commands, instances);
    return draw_wide_points(draw, error);
}

/* ---- the picture */

/* Range of depths of all surfaces, a little widened; for the depth buffer of orthographic views. */
static void depth_range(const iso_gl_draw_opts *opts, double range[2]) {
    range[0] = INFINITY;
    range[1] = -INFINITY;
    for (int i = 0; i < opts->surface_count; i++) {
        const iso_gl_surface *surface = opts->surfaces[i];
        iso_projector p = iso_projector_make(opts->view, &surface->transform);
        const iso_gl_span *spans = surface->spans.data;
        for (size_t s = 0; s < surface->span_count; s++)
            for (int k = 0; k < 8 && !iso_box_is_empty(&spans[s].box); k++) {
                iso_vec3 c = iso_box_corner(&spans[s].box, k);
                double z = p.matrix[6] * c.x + p.matrix[7] * c.y + p.matrix[8] * c.z + p.origin[2];
                range[0] = fmin(range[0], z);
                range[1] = fmax(range[1], z);
            }
    }
    if (!(range[0] <= range[1])) range[0] = range[1] = 0;
    double slack = 1e-3 * (range[1] - range[0]) + 1e-3 * fabs(range[1]) + 1e-6;
    range[0] -= slack;
    range[1] += slack;
}

typedef struct picture {
    iso_gl_engine *engine;
    const iso_gl_draw_opts *opts;
    double range[2], widening;
    iso_buffer room;
} picture;

static iso_status draw_surfaces(picture *p, const iso_view *view, iso_error *error) {
    for (int i = 0; i < p->opts->surface_count; i++) {
        const iso_gl_surface *surface = p->opts->surfaces[i];
        surface_draw draw = {.engine = p->engine,
                             .opts = p->opts,
                             .surface = surface,
                             .projector = iso_projector_make(view, &surface->transform),
                             .widening = p->widening,
                             .range = {p->range[0], p->range[1]}};
        upload_uniforms(&draw, p->opts->first_surface + i);
        ISO_TRY(surface->mesh ? draw_mesh(&draw, &p->room, error) : draw_points(&draw, &p->room, error));
    }
    return ISO_OK;
}

static iso_status draw_part(picture *p, const iso_view *view, part_origin at, const iso_gl_output *to,
                            iso_error *error) {
    iso_gl_engine *engine = p->engine;
    ISO_TRY(
        iso_gl_target_ensure(&engine->target, engine->context, GL_R8UI, view->width, view->height, error));
    begin_part(p->engine, view);
    iso_gl_timer_begin(&p->engine->timer, p->engine->context->gl, ISO_GL_PASS_DRAW);
    iso_status status = draw_surfaces(p, view, error);
    iso_gl_timer_end(&p->engine->timer, p->engine->context->gl);
    ISO_TRY(status);
    if (to->gbuffer)
        ISO_TRY(read_part(p->engine, view, at, p->opts->keep, to->gbuffer, error));
    else
        ISO_TRY(iso_gl_canvas_shade(to, false, view, at.x, at.y, error));
    iso_gl_timer_read(&p->engine->timer, p->engine->context->gl);
    return ISO_OK;
}

static iso_status draw_parts(picture *p, const iso_gl_output *to, iso_error *error) {
    const iso_view *whole = p->opts->view;
    int side = p->engine->max_side - p->engine->max_side % iso_gl_output_factor(to);
    for (int y = 0; y < whole->height; y += side)
        for (int x = 0; x < whole->width; x += side) {
            iso_view view = iso_view_rows(whole, y, whole->height - y < side ? whole->height - y : side);
            view.cx -= x;
            view.width = whole->width - x < side ? whole->width - x : side;
            ISO_TRY(draw_part(p, &view, (part_origin){x, y}, to, error));
            ISO_TRY(iso_gl_check(p->engine->context, error)); /* stop when the context is lost */
        }
    return ISO_OK;
}

iso_status iso_gl_draw_to(iso_gl_engine *engine, const iso_gl_draw_opts *opts, const iso_gl_output *to,
                          iso_error *error) {
    assert(opts->surface_count >= 0 && opts->first_surface >= 0 &&
           opts->surface_count <= ISO_SURFACE_MAX - opts->first_surface);
    picture p = {.engine = engine, .opts = opts, .widening = widening_of(opts)};
    depth_range(opts, p.range);
    engine->drawn = engine->back_facing = 0;
    ISO_TRY(iso_gl_enter(engine->context, error));
    iso_status status = draw_parts(&p, to, error);
    iso_buffer_free(&p.room);
    return iso_gl_leave(engine->context, status, error);
}

iso_status iso_gl_draw_target(iso_gl_engine *engine, const iso_gl_draw_opts *opts, iso_error *error) {
    const iso_view *view = opts->view;
    picture p = {.engine = engine, .opts = opts, .widening = 1};
    if (view->width > engine->max_side || view->height > engine->max_side)
        return iso_fail(error, ISO_ERR_LIMIT,
                        "%s: %d x %d pixels with the margin are more than %s draws at once",
                        engine->context->name, view->width, view->height, engine->context->renderer);
    depth_range(opts, p.range);
    ISO_TRY(
        iso_gl_target_ensure(&engine->target, engine->context, GL_R8UI, view->width, view->height, error));
    begin_part(engine, view);
    const iso_status status = draw_surfaces(&p, view, error);
    iso_buffer_free(&p.room);
    return status;
}

iso_status iso_gl_draw(iso_gl_engine *engine, const iso_gl_draw_opts *opts, iso_gbuffer *gbuffer,
                       iso_error *error) {
    assert(opts->view->width == gbuffer->width && opts->view->height == gbuffer->height);
    return iso_gl_draw_to(engine, opts, &(iso_gl_output){.gbuffer = gbuffer}, error);
}
