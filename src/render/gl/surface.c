#include "render/gl/surface.h"

#include <assert.h>
#include <glad/gl.h>
#include <string.h>

#include "base/memory.h"
#include "render/gl/shared.h"
#include "render/project.h"

_Static_assert(sizeof(iso_surfel) == 24 && sizeof(iso_point) == 8 && sizeof(iso_curvature) == 8,
               "as vertex arrays have it");

/* An array of the shape's owner, of which spans name parts, and the buffer that holds it: each part lies in
 * the buffer where it lies in the array, so that what does not change does not move. */
typedef struct source {
    const void *data;
    size_t item; /* bytes */
    iso_gl_buffer *to;
} source;

typedef struct part {
    size_t first, count;
} part;

typedef part part_of(const void *view, size_t span);

static part points_of(const void *view, size_t span) {
    const iso_point_span *s = &((const iso_point_view *)view)->spans[span];
    return (part){s->first, s->count};
}

static part vertices_of(const void *view, size_t span) {
    const iso_mesh_span *s = &((const iso_mesh_view *)view)->spans[span];
    return (part){s->first_vertex, s->vertex_count};
}

static part triangles_of(const void *view, size_t span) {
    const iso_mesh_span *s = &((const iso_mesh_view *)view)->spans[span];
    return (part){s->first_triangle, s->triangle_count};
}

static size_t end_of(const void *view, size_t spans, part_of *get) {
    size_t end = 0;
    for (size_t s = 0; s < spans; s++) {
        part p = get(view, s);
        if (p.first + p.count > end) end = p.first + p.count;
    }
    return end;
}

/* Room for `end` items; what is in the buffer stays. */
static void fit(const GladGLContext *gl, const source *from, size_t end) {
    iso_gl_buffer *to = from->to;
    if (to->name && end <= to->room) return;
    size_t room = to->name ? end + end / 2 : end;
    if (!room) room = 1;
    GLuint made;
    gl->CreateBuffers(1, &made);
    gl->NamedBufferStorage(made, (GLsizeiptr)((room * from->item + 3) / 4 * 4), NULL,
                           GL_DYNAMIC_STORAGE_BIT); /* shaders read words */
    if (to->name) gl->CopyNamedBufferSubData(to->name, made, 0, 0, (GLsizeiptr)(to->room * from->item));
    gl->DeleteBuffers(1, &to->name); /* 0 is ignored */
    *to = (iso_gl_buffer){made, room};
}

static void send(iso_gl_surface *shape, const source *from, part p) {
    if (!p.count) return;
    shape->engine->context->gl->NamedBufferSubData(from->to->name, (GLintptr)(p.first * from->item),
                                                   (GLsizeiptr)(p.count * from->item),
                                                   (const char *)from->data + p.first * from->item);
    shape->uploaded += p.count * from->item;
}

/* The spans that changed; those that follow one another go up together. */
static void send_changed(iso_gl_surface *shape, const source *from, const void *view, part_of *get) {
    const iso_gl_span *spans = shape->spans.data;
    for (size_t s = 0; s < shape->span_count;) {
        if (!spans[s].changed) {
            s++;
            continue;
        }
        part run = get(view, s++);
        while (s < shape->span_count && spans[s].changed && get(view, s).first == run.first + run.count)
            run.count += get(view, s++).count;
        send(shape, from, run);
    }
}

/* Strips of a span lie at ISO_GL_STRIP_ROOM indices for each triangle before it. */
static iso_status send_strips(iso_gl_surface *shape, const iso_mesh_view *mesh, iso_error *error) {
    enum { INDEX = sizeof(uint16_t) };
    iso_gl_span *spans = shape->spans.data;
    const source from = {NULL, ISO_GL_STRIP_ROOM * INDEX, &shape->indices};
    fit(shape->engine->context->gl, &from, end_of(mesh, shape->span_count, triangles_of));
    for (size_t s = 0; s < shape->span_count; s++) {
        const iso_mesh_span *span = &mesh->spans[s];
        if (!spans[s].changed || !span->triangle_count) continue;
        size_t count;
        ISO_TRY(iso_gl_strips_make(&shape->strips, mesh, span, &count, error));
        spans[s].count = (uint32_t)count;
        shape->engine->context->gl->NamedBufferSubData(
            shape->indices.name, (GLintptr)(span->first_triangle * from.item), (GLsizeiptr)(count * INDEX),
            iso_gl_strips_indices(&shape->strips));
        shape->uploaded += count * INDEX;
    }
    return ISO_OK;
}

static void describe_floats(const GladGLContext *gl, unsigned array, unsigned slot, unsigned binding,
                            int count, size_t offset) {
    gl->EnableVertexArrayAttrib(array, slot);
    gl->VertexArrayAttribFormat(array, slot, count, GL_FLOAT, GL_FALSE, (GLuint)offset);
    gl->VertexArrayAttribBinding(array, slot, binding);
}

enum { BIND_VERTICES, BIND_RADII, BIND_SHAPES, BIND_SPANS };

/* divisor 0: points are vertices; 1: instances. */
static unsigned make_array(const GladGLContext *gl, const iso_gl_surface *shape, unsigned divisor) {
    GLuint array;
    gl->CreateVertexArrays(1, &array);
    bool floats = shape->mesh || shape->surfels;
    gl->VertexArrayBindingDivisor(array, BIND_VERTICES, divisor);
    if (floats) {
        describe_floats(gl, array, ISO_GL_POSITION, BIND_VERTICES, 3, offsetof(iso_surfel, position));
        describe_floats(gl, array, ISO_GL_NORMAL, BIND_VERTICES, 3, offsetof(iso_surfel, normal));
    } else {
        gl->EnableVertexArrayAttrib(array, ISO_GL_PACKED);
        gl->VertexArrayAttribIFormat(array, ISO_GL_PACKED, 2, GL_UNSIGNED_INT, 0);
        gl->VertexArrayAttribBinding(array, ISO_GL_PACKED, BIND_VERTICES);
    }
    if (shape->has_radii) {
        gl->VertexArrayBindingDivisor(array, BIND_RADII, divisor);
        describe_floats(gl, array, ISO_GL_RADIUS, BIND_RADII, 1, 0);
    }
    if (shape->has_shapes) {
        gl->VertexArrayBindingDivisor(array, BIND_SHAPES, divisor);
        gl->EnableVertexArrayAttrib(array, ISO_GL_BEND);
        gl->VertexArrayAttribIFormat(array, ISO_GL_BEND, 4, GL_SHORT, 0);
        gl->VertexArrayAttribBinding(array, ISO_GL_BEND, BIND_SHAPES);
    }
    return array;
}

static size_t instance_bytes(const iso_gl_surface *shape) {
    return shape->mesh ? 3 * sizeof(int32_t) : sizeof(iso_gl_instance);
}

/* What each draw tells its primitives: an instance's, named by the draw's first instance. */
static void add_spans(iso_gl_surface *shape, const GladGLContext *gl) {
    const GLuint array = shape->array;
    gl->VertexArrayVertexBuffer(array, BIND_SPANS, shape->engine->instances, 0,
                                (GLsizei)instance_bytes(shape));
    gl->VertexArrayBindingDivisor(array, BIND_SPANS, 1);
    if (shape->mesh) {
        gl->EnableVertexArrayAttrib(array, ISO_GL_BRICK);
        gl->VertexArrayAttribIFormat(array, ISO_GL_BRICK, 3, GL_INT, 0);
        gl->VertexArrayAttribBinding(array, ISO_GL_BRICK, BIND_SPANS);
    } else {
        describe_floats(gl, array, ISO_GL_ORIGIN, BIND_SPANS, 3, offsetof(iso_gl_instance, origin));
        describe_floats(gl, array, ISO_GL_PLACE, BIND_SPANS, 4, offsetof(iso_gl_instance, place));
    }
}

/* Buffers may have been made anew. */
static void bind_buffers(const iso_gl_surface *shape, unsigned array) {
    const GladGLContext *gl = shape->engine->context->gl;
    bool floats = shape->mesh || shape->surfels;
    gl->VertexArrayVertexBuffer(array, BIND_VERTICES, shape->vertices.name, 0,
                                floats ? sizeof(iso_surfel) : sizeof(iso_point));
    if (shape->has_radii) gl->VertexArrayVertexBuffer(array, BIND_RADII, shape->radii.name, 0, sizeof(float));
    if (shape->has_shapes)
        gl->VertexArrayVertexBuffer(array, BIND_SHAPES, shape->shapes.name, 0, sizeof(iso_curvature));
    if (shape->mesh) gl->VertexArrayElementBuffer(array, shape->indices.name);
}

static void make_arrays(iso_gl_surface *shape) {
    const GladGLContext *gl = shape->engine->context->gl;
    if (!shape->array) {
        shape->array = make_array(gl, shape, 0);
        add_spans(shape, gl);
        if (!shape->mesh) shape->quad_array = make_array(gl, shape, 1);
    }
    bind_buffers(shape, shape->array);
    if (shape->quad_array) bind_buffers(shape, shape->quad_array);
}

/* ---- drawing */

void iso_gl_surface_command(const iso_gl_surface *shape, size_t count, const void *commands,
                            const void *instances) {
    const iso_gl_engine *engine = shape->engine;
    const GladGLContext *gl = engine->context->gl;
    const size_t size = shape->mesh ? sizeof(iso_gl_mesh_command) : sizeof(iso_gl_points_command);
    gl->NamedBufferData(engine->commands, (GLsizeiptr)(count * size), commands, GL_STREAM_DRAW);
    gl->NamedBufferData(engine->instances, (GLsizeiptr)(count * instance_bytes(shape)), instances,
                        GL_STREAM_DRAW);
}

void iso_gl_surface_draw(const iso_gl_surface *shape, size_t count) {
    const GladGLContext *gl = shape->engine->context->gl;
    gl->BindBuffer(GL_DRAW_INDIRECT_BUFFER, shape->engine->commands);
    gl->BindVertexArray(shape->array);
    if (shape->mesh)
        gl->MultiDrawElementsIndirect(shape->stripped ? GL_TRIANGLE_STRIP : GL_TRIANGLES, GL_UNSIGNED_SHORT,
                                      NULL, (GLsizei)count, 0);
    else
        gl->MultiDrawArraysIndirect(GL_POINTS, NULL, (GLsizei)count, 0);
}

void iso_gl_surface_draw_quads(const iso_gl_surface *shape, size_t first, size_t count,
                               const iso_gl_instance *instance) {
    const GladGLContext *gl = shape->engine->context->gl;
    gl->BindVertexArray(shape->quad_array);
    gl->VertexAttrib3fv(ISO_GL_ORIGIN, instance->origin);
    gl->VertexAttrib4fv(ISO_GL_PLACE, instance->place);
    gl->DrawArraysInstancedBaseInstance(GL_TRIANGLE_STRIP, 0, 4, (GLsizei)count, (GLuint)first);
}

/* ---- what a draw knows of spans */

static double largest_radius(const iso_point_view *points, const iso_point_span *span) {
    if (!points->radii) return points->radius > 0 ? points->radius : 0;
    double radius = 0;
    for (size_t i = span->first; i < span->first + span->count; i++) radius = fmax(radius, points->radii[i]);
    return radius;
}

static iso_box packed_box(const int32_t brick[3]) {
    const iso_surfel corners[2] = {{.position = {-2, -2, -2}}, {.position = {18, 18, 18}}};
    return iso_surfel_bounds(corners, 2, brick);
}

/* Without stamps everything counts as changed. */
static bool has_changed(const iso_gl_span *had, const uint64_t *stamps, size_t s, const size_t first[2]) {
    return !stamps || had->stamp != stamps[s] || had->place[0] != first[0] || had->place[1] != first[1];
}

static void describe_points(iso_gl_surface *shape, const iso_point_view *points) {
    iso_gl_span *spans = shape->spans.data;
    for (size_t s = 0; s < shape->span_count; s++) {
        const iso_point_span *from = &points->spans[s];
        const size_t first[2] = {from->first, 0};
        iso_gl_span *to = &spans[s];
        to->changed = has_changed(to, points->stamps, s, first);
        if (!to->changed) continue;
        *to = (iso_gl_span){.changed = true,
                            .stamp = points->stamps ? points->stamps[s] : 0,
                            .place = {from->first, 0},
                            .count = from->count,
                            .first = (uint32_t)from->first,
                            .radius = largest_radius(points, from)};
        memcpy(to->brick, from->brick, sizeof to->brick);
        to->box = points->surfels ? iso_surfel_bounds(points->surfels + from->first, from->count, from->brick)
                                  : packed_box(from->brick);
    }
}

static void describe_mesh(iso_gl_surface *shape, const iso_mesh_view *mesh) {
    uint32_t each = shape->stripped ? ISO_GL_STRIP_ROOM : 3;
    iso_gl_span *spans = shape->spans.data;
    for (size_t s = 0; s < shape->span_count; s++) {
        const iso_mesh_span *from = &mesh->spans[s];
        const size_t first[2] = {from->first_vertex, from->first_triangle};
        iso_gl_span *to = &spans[s];
        to->changed = has_changed(to, mesh->stamps, s, first);
        if (!to->changed) continue;
        *to = (iso_gl_span){.changed = true,
                            .stamp = mesh->stamps ? mesh->stamps[s] : 0,
                            .place = {first[0], first[1]},
                            .count = 3 * from->triangle_count,
                            .triangles = from->triangle_count,
                            .first = each * (uint32_t)from->first_triangle,
                            .base = (int32_t)from->first_vertex};
        memcpy(to->brick, from->brick, sizeof to->brick);
        to->box = iso_surfel_bounds(mesh->vertices + from->first_vertex, from->vertex_count, from->brick);
    }
}

/* Room for the spans; new ones have no stamp. */
static iso_status fit_spans(iso_gl_surface *shape, size_t count, iso_error *error) {
    size_t had = shape->spans.bytes / sizeof(iso_gl_span), kept = shape->span_count;
    ISO_TRY(iso_buffer_reserve(&shape->spans, (count ? count : 1) * sizeof(iso_gl_span),
                               had * sizeof(iso_gl_span), error));
    iso_gl_span *spans = shape->spans.data;
    for (size_t s = kept; s < count; s++) spans[s].stamp = 0;
    shape->span_count = count;
    return ISO_OK;
}

/* Bounds of all spans; a mesh without them does not count as closed. */
static iso_status keep_bounds(iso_gl_surface *shape, const iso_mesh_view *mesh, iso_error *error) {
    shape->closed = false;
    if (!mesh->bounds || !mesh->closed) return ISO_OK;
    size_t bytes = shape->span_count * sizeof *mesh->bounds;
    ISO_TRY(iso_buffer_reserve(&shape->bounds, bytes ? bytes : 1, 0, error));
    memcpy(shape->bounds.data, mesh->bounds, bytes);
    shape->closed = true;
    return ISO_OK;
}

static bool is_same(const void *context, size_t span) {
    return !((const iso_gl_span *)context)[span].changed;
}

/* Blocks say where they begin in their span, as its points may come to lie elsewhere. */
static iso_status measure_blocks(iso_gl_surface *shape, const iso_point_view *points, iso_error *error) {
    ISO_TRY(iso_point_blocks_measure(shape->blocks, points, is_same, shape->spans.data, error));
    iso_point_block *block = shape->blocks->blocks.data;
    for (size_t i = 0; i < shape->blocks->count; i++) block[i].first -= points->spans[block[i].span].first;
    return ISO_OK;
}

/* ---- from views to the GPU */

/* Software drivers keep buffers in main memory, and are stopped when it ends. */
static iso_status check_memory(const iso_gl_surface *shape, uint64_t bytes, iso_error *error) {
    const iso_gl_context *context = shape->engine->context;
    uint64_t available = iso_memory_available();
    if (!iso_gl_renderer_is_software(context->renderer) || bytes <= available) return ISO_OK;
    return iso_fail(error, ISO_ERR_LIMIT, "%s: a copy of the surface needs %.0f MB, %.0f MB are free",
                    context->name, (double)bytes / 1e6, (double)available / 1e6);
}

static uint64_t growth(const iso_gl_buffer *buffer, size_t end, size_t item) {
    return end <= buffer->room ? 0 : (uint64_t)end * item;
}

static iso_status send_points(iso_gl_surface *shape, const iso_point_view *points, iso_error *error) {
    const GladGLContext *gl = shape->engine->context->gl;
    source vertices = {points->surfels, sizeof *points->surfels, &shape->vertices};
    if (!points->surfels) vertices = (source){points->packed, sizeof *points->packed, &shape->vertices};
    const source radii = {points->radii, sizeof *points->radii, &shape->radii};
    const source colors = {points->colors, sizeof *points->colors, &shape->colors};
    const source shapes = {points->shapes, sizeof *points->shapes, &shape->shapes};
    size_t end = end_of(points, points->span_count, points_of);
    if (end > UINT32_MAX) return iso_fail(error, ISO_ERR_LIMIT, "more than 2^32 - 1 points");
    ISO_TRY(check_memory(shape,
                         growth(&shape->vertices, end, vertices.item) +
                             (points->radii ? growth(&shape->radii, end, radii.item) : 0) +
                             (points->colors ? growth(&shape->colors, end, colors.item) : 0) +
                             (points->shapes ? growth(&shape->shapes, end, shapes.item) : 0),
                         error));
    ISO_TRY(fit_spans(shape, points->span_count, error));
    shape->closed = points->closed;
    describe_points(shape, points);
    ISO_TRY(measure_blocks(shape, points, error));
    fit(gl, &vertices, end);
    send_changed(shape, &vertices, points, points_of);
    if (points->radii) {
        fit(gl, &radii, end);
        send_changed(shape, &radii, points, points_of);
    }
    if (points->colors) {
        fit(gl, &colors, end);
        send_changed(shape, &colors, points, points_of);
    }
    if (points->shapes) {
        fit(gl, &shapes, end);
        send_changed(shape, &shapes, points, points_of);
    }
    return ISO_OK;
}

static iso_status send_mesh(iso_gl_surface *shape, const iso_mesh_view *mesh, iso_error *error) {
    const GladGLContext *gl = shape->engine->context->gl;
    const source vertices = {mesh->vertices, sizeof *mesh->vertices, &shape->vertices};
    const source triangles = {mesh->triangles, sizeof *mesh->triangles, &shape->indices};
    size_t vertex_end = end_of(mesh, mesh->span_count, vertices_of);
    size_t triangle_end = end_of(mesh, mesh->span_count, triangles_of);
    if (vertex_end > INT32_MAX || triangle_end > UINT32_MAX / ISO_GL_STRIP_ROOM)
        return iso_fail(error, ISO_ERR_LIMIT, "more than 2^31 - 1 vertices or 2^30 - 1 triangles");
    size_t item = shape->stripped ? ISO_GL_STRIP_ROOM * sizeof(uint16_t) : triangles.item;
    ISO_TRY(check_memory(shape,
                         growth(&shape->vertices, vertex_end, vertices.item) +
                             growth(&shape->indices, triangle_end, item),
                         error));
    ISO_TRY(fit_spans(shape, mesh->span_count, error));
    ISO_TRY(keep_bounds(shape, mesh, error));
    describe_mesh(shape, mesh);
    fit(gl, &vertices, vertex_end);
    send_changed(shape, &vertices, mesh, vertices_of);
    if (shape->stripped) return send_strips(shape, mesh, error);
    fit(gl, &triangles, triangle_end);
    send_changed(shape, &triangles, mesh, triangles_of);
    return ISO_OK;
}

/* After a failure the next update sends everything. */
static void forget_spans(iso_gl_surface *shape) {
    shape->span_count = 0;
    if (shape->blocks) shape->blocks->count = 0;
}

iso_status iso_gl_update_points(iso_gl_surface *shape, const iso_point_view *points, iso_error *error) {
    assert(!shape->mesh && shape->has_radii == (points->radii != NULL) &&
           shape->has_colors == (points->colors != NULL) && shape->has_shapes == (points->shapes != NULL));
    ISO_TRY(iso_gl_enter(shape->engine->context, error));
    shape->transform = points->transform;
    shape->radius = points->radius;
    memcpy(shape->dims, points->dims, sizeof shape->dims);
    shape->uploaded = 0;
    iso_status status = send_points(shape, points, error);
    if (status == ISO_OK) make_arrays(shape);
    status = iso_gl_leave(shape->engine->context, status, error);
    if (status != ISO_OK) forget_spans(shape);
    return status;
}

iso_status iso_gl_update_mesh(iso_gl_surface *shape, const iso_mesh_view *mesh, iso_error *error) {
    assert(shape->mesh);
    ISO_TRY(iso_gl_enter(shape->engine->context, error));
    shape->transform = mesh->transform;
    shape->uploaded = 0;
    iso_status status = send_mesh(shape, mesh, error);
    if (status == ISO_OK) make_arrays(shape);
    status = iso_gl_leave(shape->engine->context, status, error);
    if (status != ISO_OK) forget_spans(shape);
    return status;
}

static iso_status make_shape(iso_gl_engine *engine, iso_gl_surface **made, iso_error *error) {
    *made = iso_alloc_zero(1, sizeof **made);
    if (!*made) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for a surface");
    (*made)->engine = engine;
    return ISO_OK;
}

iso_status iso_gl_upload_points(iso_gl_engine *engine, const iso_point_view *points, iso_gl_surface **shape,
                                iso_error *error) {
    iso_gl_surface *made;
    ISO_TRY(make_shape(engine, &made, error));
    made->surfels = points->surfels != NULL;
    made->has_radii = points->radii != NULL;
    made->has_colors = points->colors != NULL;
    made->has_shapes = points->shapes != NULL;
    made->blocks = iso_alloc_zero(1, sizeof *made->blocks);
    iso_status status = made->blocks ? iso_gl_update_points(made, points, error)
                                     : iso_fail(error, ISO_ERR_NOMEM, "out of memory for blocks of points");
    if (status == ISO_OK)
        *shape = made;
    else
        iso_gl_surface_destroy(made);
    return status;
}

static iso_status upload_mesh(iso_gl_engine *engine, const iso_mesh_view *mesh, bool stripped,
                              iso_gl_surface **shape, iso_error *error) {
    iso_gl_surface *made;
    ISO_TRY(make_shape(engine, &made, error));
    made->mesh = true;
    made->stripped = stripped;
    iso_status status = iso_gl_update_mesh(made, mesh, error);
    if (status == ISO_OK)
        *shape = made;
    else
        iso_gl_surface_destroy(made);
    return status;
}

iso_status iso_gl_upload_mesh(iso_gl_engine *engine, const iso_mesh_view *mesh, iso_gl_surface **shape,
                              iso_error *error) {
    return upload_mesh(engine, mesh, false, shape, error);
}

iso_status iso_gl_upload_strips(iso_gl_engine *engine, const iso_mesh_view *mesh, iso_gl_surface **shape,
                                iso_error *error) {
    return upload_mesh(engine, mesh, true, shape, error);
}

iso_gl_surface_stats iso_gl_surface_measure(const iso_gl_surface *shape) {
    iso_gl_surface_stats stats = {.uploaded = shape->uploaded};
    const iso_gl_span *spans = shape->spans.data;
    for (size_t s = 0; shape->mesh && s < shape->span_count; s++) {
        stats.indices += spans[s].triangles ? spans[s].count : 0;
        stats.triangles += spans[s].triangles;
    }
    return stats;
}

/* What a shape has outside the GPU. */
static void free_shape(iso_gl_surface *shape) {
    if (shape->blocks) iso_point_blocks_free(shape->blocks);
    iso_free(shape->blocks);
    iso_gl_strips_free(&shape->strips);
    iso_buffer_free(&shape->bounds);
    iso_buffer_free(&shape->spans);
    iso_free(shape);
}

void iso_gl_surface_destroy(iso_gl_surface *shape) {
    if (!shape) return;
    iso_gl_context *context = shape->engine->context;
    if (iso_gl_enter(context, NULL) == ISO_OK) {
        const GLuint buffers[] = {shape->vertices.name, shape->radii.name, shape->colors.name,
                                  shape->shapes.name, shape->indices.name};
        const GLuint arrays[] = {shape->array, shape->quad_array};
        context->gl->DeleteVertexArrays(2, arrays); /* 0 is ignored */
        context->gl->DeleteBuffers(5, buffers);
        iso_gl_leave(context, ISO_OK, NULL);
    }
    free_shape(shape);
}
