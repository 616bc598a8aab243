/* surface: copies points and meshes into GPU buffers, only the spans that changed, and draws them. */
#include "render/gl/surface.h"

#include <assert.h>
#include <glad/gl.h>
#include <string.h>

#include "base/memory.h"
#include "render/gl/shared.h"
#include "render/view/project.h"

_Static_assert(sizeof(iso_surfel) == 24 && sizeof(iso_point) == 8 && sizeof(iso_curvature) == 8,
               "layouts of the vertex arrays");

/* An array of the view and the buffer that holds its copy. A span's part lies at the same index in both,
 * so that unchanged parts need not move. */
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

/* One beyond the last item of all spans. */
static size_t end_of(const void *view, size_t spans, part_of *get) {
    size_t end = 0;
    for (size_t s = 0; s < spans; s++) {
        part p = get(view, s);
        if (p.first + p.count > end) end = p.first + p.count;
    }
    return end;
}

/* Makes room for `end` items, keeping the buffer's contents. */
static void ensure_capacity(const GladGLContext *gl, const source *from, size_t end) {
    iso_gl_buffer *to = from->to;
    if (to->name && end <= to->room) return;
    size_t room = to->name ? end + end / 2 : end;
    if (!room) room = 1;
    GLuint made;
    gl->CreateBuffers(1, &made);
    gl->NamedBufferStorage(made, (GLsizeiptr)((room * from->item + 3) / 4 * 4), NULL,
                           GL_DYNAMIC_STORAGE_BIT); /* a multiple of 4 bytes: shaders read words */
    if (to->name) gl->CopyNamedBufferSubData(to->name, made, 0, 0, (GLsizeiptr)(to->room * from->item));
    gl->DeleteBuffers(1, &to->name); /* 0 is ignored */
    *to = (iso_gl_buffer){made, room};
}

static void upload_part(iso_gl_surface *surface, const source *from, part p) {
    if (!p.count) return;
    surface->engine->context->gl->NamedBufferSubData(from->to->name, (GLintptr)(p.first * from->item),
                                                     (GLsizeiptr)(p.count * from->item),
                                                     (const char *)from->data + p.first * from->item);
    surface->uploaded += p.count * from->item;
}

/* Uploads the parts of changed spans; adjacent parts in one call. */
static void upload_changed(iso_gl_surface *surface, const source *from, const void *view, part_of *get) {
    const iso_gl_span *spans = surface->spans.data;
    for (size_t s = 0; s < surface->span_count;) {
        if (!spans[s].changed) {
            s++;
            continue;
        }
        part run = get(view, s++);
        while (s < surface->span_count && spans[s].changed && get(view, s).first == run.first + run.count)
            run.count += get(view, s++).count;
        upload_part(surface, from, run);
    }
}

/* Uploads the strips of changed spans. A span's strips begin at ISO_TRIANGLE_STRIP_ROOM times its first
 * triangle. */
static iso_status upload_strips(iso_gl_surface *surface, const iso_mesh_view *mesh, iso_error *error) {
    enum { INDEX = sizeof(uint16_t) };
    iso_gl_span *spans = surface->spans.data;
    const source from = {NULL, ISO_TRIANGLE_STRIP_ROOM * INDEX, &surface->indices};
    ensure_capacity(surface->engine->context->gl, &from, end_of(mesh, surface->span_count, triangles_of));
    for (size_t s = 0; s < surface->span_count; s++) {
        const iso_mesh_span *span = &mesh->spans[s];
        if (!spans[s].changed || !span->triangle_count) continue;
        size_t count;
        ISO_TRY(iso_triangle_strips_make(&surface->strips, mesh, span, &count, error));
        spans[s].count = (uint32_t)count;
        surface->engine->context->gl->NamedBufferSubData(
            surface->indices.name, (GLintptr)(span->first_triangle * from.item), (GLsizeiptr)(count * INDEX),
            iso_triangle_strips_indices(&surface->strips));
        surface->uploaded += count * INDEX;
    }
    return ISO_OK;
}

static void describe_floats(const GladGLContext *gl, unsigned array, unsigned slot, unsigned binding,
                            int count, size_t offset) {
    gl->EnableVertexArrayAttrib(array, slot);
    gl->VertexArrayAttribFormat(array, slot, count, GL_FLOAT, GL_FALSE, (GLuint)offset);
    gl->VertexArrayAttribBinding(array, slot, binding);
}

enum { BIND_VERTICES, BIND_RADII, BIND_COLORS, BIND_CURVATURES, BIND_SPANS };

/* A vertex array for the surface's kind. divisor 0: a point is a vertex; 1: a point is an instance
 * (quads). */
static unsigned make_vertex_array(const GladGLContext *gl, const iso_gl_surface *surface, unsigned divisor) {
    GLuint array;
    gl->CreateVertexArrays(1, &array);
    bool floats = surface->mesh || surface->surfels;
    gl->VertexArrayBindingDivisor(array, BIND_VERTICES, divisor);
    if (floats) {
        describe_floats(gl, array, ISO_GL_POSITION, BIND_VERTICES, 3, offsetof(iso_surfel, position));
        describe_floats(gl, array, ISO_GL_NORMAL, BIND_VERTICES, 3, offsetof(iso_surfel, normal));
    } else {
        gl->EnableVertexArrayAttrib(array, ISO_GL_PACKED);
        gl->VertexArrayAttribIFormat(array, ISO_GL_PACKED, 2, GL_UNSIGNED_INT, 0);
        gl->VertexArrayAttribBinding(array, ISO_GL_PACKED, BIND_VERTICES);
    }
    if (surface->has_radii) {
        gl->VertexArrayBindingDivisor(array, BIND_RADII, divisor);
        describe_floats(gl, array, ISO_GL_RADIUS, BIND_RADII, 1, 0);
    }
    if (surface->has_colors) {
        gl->VertexArrayBindingDivisor(array, BIND_COLORS, divisor);
        gl->EnableVertexArrayAttrib(array, ISO_GL_COLOR);
        gl->VertexArrayAttribFormat(array, ISO_GL_COLOR, 3, GL_UNSIGNED_BYTE, GL_FALSE, 0);
        gl->VertexArrayAttribBinding(array, ISO_GL_COLOR, BIND_COLORS);
    }
    if (surface->has_curvatures) {
        gl->VertexArrayBindingDivisor(array, BIND_CURVATURES, divisor);
        gl->EnableVertexArrayAttrib(array, ISO_GL_CURVATURE);
        gl->VertexArrayAttribIFormat(array, ISO_GL_CURVATURE, 4, GL_SHORT, 0);
        gl->VertexArrayAttribBinding(array, ISO_GL_CURVATURE, BIND_CURVATURES);
    }
    return array;
}

static size_t instance_bytes(const iso_gl_surface *surface) {
    return surface->mesh ? 3 * sizeof(int32_t) : sizeof(iso_gl_instance);
}

/* Adds the per-instance data, one item per draw command, selected by the command's first instance. */
static void add_spans(iso_gl_surface *surface, const GladGLContext *gl) {
    const GLuint array = surface->array;
    gl->VertexArrayVertexBuffer(array, BIND_SPANS, surface->engine->instances, 0,
                                (GLsizei)instance_bytes(surface));
    gl->VertexArrayBindingDivisor(array, BIND_SPANS, 1);
    if (surface->mesh) {
        gl->EnableVertexArrayAttrib(array, ISO_GL_BRICK);
        gl->VertexArrayAttribIFormat(array, ISO_GL_BRICK, 3, GL_INT, 0);
        gl->VertexArrayAttribBinding(array, ISO_GL_BRICK, BIND_SPANS);
    } else {
        describe_floats(gl, array, ISO_GL_ORIGIN, BIND_SPANS, 3, offsetof(iso_gl_instance, origin));
        describe_floats(gl, array, ISO_GL_PLACE, BIND_SPANS, 4, offsetof(iso_gl_instance, place));
    }
}

/* Attaches the buffers, which an update may have replaced. */
static void bind_buffers(const iso_gl_surface *surface, unsigned array) {
    const GladGLContext *gl = surface->engine->context->gl;
    bool floats = surface->mesh || surface->surfels;
    gl->VertexArrayVertexBuffer(array, BIND_VERTICES, surface->vertices.name, 0,
                                floats ? sizeof(iso_surfel) : sizeof(iso_point));
    if (surface->has_radii)
        gl->VertexArrayVertexBuffer(array, BIND_RADII, surface->radii.name, 0, sizeof(float));
    if (surface->has_colors)
        gl->VertexArrayVertexBuffer(array, BIND_COLORS, surface->colors.name, 0, 3 * sizeof(uint8_t));
    if (surface->has_curvatures)
        gl->VertexArrayVertexBuffer(array, BIND_CURVATURES, surface->curvatures.name, 0,
                                    sizeof(iso_curvature));
    if (surface->mesh) gl->VertexArrayElementBuffer(array, surface->indices.name);
}

static void make_vertex_arrays(iso_gl_surface *surface) {
    const GladGLContext *gl = surface->engine->context->gl;
    if (!surface->array) {
        surface->array = make_vertex_array(gl, surface, 0);
        add_spans(surface, gl);
        if (!surface->mesh) surface->quad_array = make_vertex_array(gl, surface, 1);
    }
    bind_buffers(surface, surface->array);
    if (surface->quad_array) bind_buffers(surface, surface->quad_array);
}

/* ---- drawing */

void iso_gl_surface_command(const iso_gl_surface *surface, size_t count, const void *commands,
                            const void *instances) {
    const iso_gl_engine *engine = surface->engine;
    const GladGLContext *gl = engine->context->gl;
    const size_t size = surface->mesh ? sizeof(iso_gl_mesh_command) : sizeof(iso_gl_points_command);
    gl->NamedBufferData(engine->commands, (GLsizeiptr)(count * size), commands, GL_STREAM_DRAW);
    gl->NamedBufferData(engine->instances, (GLsizeiptr)(count * instance_bytes(surface)), instances,
                        GL_STREAM_DRAW);
}

void iso_gl_surface_draw(const iso_gl_surface *surface, size_t count) {
    const GladGLContext *gl = surface->engine->context->gl;
    gl->BindBuffer(GL_DRAW_INDIRECT_BUFFER, surface->engine->commands);
    gl->BindVertexArray(surface->array);
    if (surface->mesh)
        gl->MultiDrawElementsIndirect(surface->stripped ? GL_TRIANGLE_STRIP : GL_TRIANGLES, GL_UNSIGNED_SHORT,
                                      NULL, (GLsizei)count, 0);
    else
        gl->MultiDrawArraysIndirect(GL_POINTS, NULL, (GLsizei)count, 0);
}

void iso_gl_surface_draw_range(const iso_gl_surface *surface, size_t first, size_t count) {
    const GladGLContext *gl = surface->engine->context->gl;
    if (!count) return;
    gl->BindBuffer(GL_DRAW_INDIRECT_BUFFER, surface->engine->commands);
    gl->BindVertexArray(surface->array);
    gl->MultiDrawArraysIndirect(GL_POINTS, (const void *)(uintptr_t)(first * sizeof(iso_gl_points_command)),
                                (GLsizei)count, 0);
}

void iso_gl_surface_draw_chosen(const iso_gl_surface *surface, size_t first, size_t count) {
    const iso_gl_engine *engine = surface->engine;
    const GladGLContext *gl = engine->context->gl;
    if (!count) return;
    gl->VertexArrayElementBuffer(surface->array, engine->storage[ISO_GL_STORE_CHOSEN]);
    gl->BindBuffer(GL_DRAW_INDIRECT_BUFFER, engine->storage[ISO_GL_STORE_ELEMENTS]);
    gl->BindVertexArray(surface->array);
    gl->MultiDrawElementsIndirect(GL_POINTS, GL_UNSIGNED_INT,
                                  (const void *)(uintptr_t)(first * sizeof(iso_gl_mesh_command)),
                                  (GLsizei)count, 0);
}

void iso_gl_surface_draw_quads(const iso_gl_surface *surface, size_t first, size_t count,
                               const iso_gl_instance *instance) {
    const GladGLContext *gl = surface->engine->context->gl;
    gl->BindVertexArray(surface->quad_array);
    gl->VertexAttrib3fv(ISO_GL_ORIGIN, instance->origin);
    gl->VertexAttrib4fv(ISO_GL_PLACE, instance->place);
    gl->DrawArraysInstancedBaseInstance(GL_TRIANGLE_STRIP, 0, 4, (GLsizei)count, (GLuint)first);
}

/* ---- spans */

static double largest_radius(const iso_point_view *points, const iso_point_span *span) {
    if (!points->radii) return points->radius > 0 ? points->radius : 0;
    double radius = 0;
    for (size_t i = span->first; i < span->first + span->count; i++) radius = fmax(radius, points->radii[i]);
    return radius * (double)iso_point_view_radii_scale(points);
}

/* Box of all positions that packed points of a brick can have, index coordinates. */
static iso_box packed_box(const int32_t brick[3]) {
    const iso_surfel corners[2] = {{.position = {-2, -2, -2}}, {.position = {18, 18, 18}}};
    return iso_surfel_bounds(corners, 2, brick);
}

/* Without versions every span counts as changed. */
static bool has_changed(const iso_gl_span *had, const uint64_t *versions, size_t s, const size_t first[2]) {
    return !versions || had->version != versions[s] || had->place[0] != first[0] || had->place[1] != first[1];
}

static void describe_points(iso_gl_surface *surface, const iso_point_view *points) {
    iso_gl_span *spans = surface->spans.data;
    for (size_t s = 0; s < surface->span_count; s++) {
        const iso_point_span *from = &points->spans[s];
        const size_t first[2] = {from->first, 0};
        iso_gl_span *to = &spans[s];
        to->changed = has_changed(to, points->versions, s, first);
        if (!to->changed) continue;
        *to = (iso_gl_span){.changed = true,
                            .version = points->versions ? points->versions[s] : 0,
                            .place = {from->first, 0},
                            .count = from->count,
                            .first = (uint32_t)from->first,
                            .radius = largest_radius(points, from)};
        memcpy(to->brick, from->brick, sizeof to->brick);
        to->box = points->surfels ? iso_surfel_bounds(points->surfels + from->first, from->count, from->brick)
                                  : packed_box(from->brick);
    }
}

static void describe_mesh(iso_gl_surface *surface, const iso_mesh_view *mesh) {
    uint32_t each = surface->stripped ? ISO_TRIANGLE_STRIP_ROOM : 3;
    iso_gl_span *spans = surface->spans.data;
    for (size_t s = 0; s < surface->span_count; s++) {
        const iso_mesh_span *from = &mesh->spans[s];
        const size_t first[2] = {from->first_vertex, from->first_triangle};
        iso_gl_span *to = &spans[s];
        to->changed = has_changed(to, mesh->versions, s, first);
        if (!to->changed) continue;
        *to = (iso_gl_span){.changed = true,
                            .version = mesh->versions ? mesh->versions[s] : 0,
                            .place = {first[0], first[1]},
                            .count = 3 * from->triangle_count,
                            .triangles = from->triangle_count,
                            .first = each * (uint32_t)from->first_triangle,
                            .base = (int32_t)from->first_vertex};
        memcpy(to->brick, from->brick, sizeof to->brick);
        to->box = iso_surfel_bounds(mesh->vertices + from->first_vertex, from->vertex_count, from->brick);
    }
}

/* Makes room for `count` spans; new ones have version 0. */
static iso_status ensure_spans(iso_gl_surface *surface, size_t count, iso_error *error) {
    size_t had = surface->spans.bytes / sizeof(iso_gl_span), kept = surface->span_count;
    ISO_TRY(iso_buffer_reserve(&surface->spans, (count ? count : 1) * sizeof(iso_gl_span),
                               had * sizeof(iso_gl_span), error));
    iso_gl_span *spans = surface->spans.data;
    for (size_t s = kept; s < count; s++) spans[s].version = 0;
    surface->span_count = count;
    return ISO_OK;
}

/* Copies the bounds of all spans; a mesh without them counts as open. */
static iso_status copy_bounds(iso_gl_surface *surface, const iso_mesh_view *mesh, iso_error *error) {
    surface->closed = false;
    if (!mesh->bounds || !mesh->closed) return ISO_OK;
    size_t bytes = surface->span_count * sizeof *mesh->bounds;
    ISO_TRY(iso_buffer_reserve(&surface->bounds, bytes ? bytes : 1, 0, error));
    memcpy(surface->bounds.data, mesh->bounds, bytes);
    surface->closed = true;
    return ISO_OK;
}

static bool is_unchanged(const void *context, size_t span) {
    return !((const iso_gl_span *)context)[span].changed;
}

/* Cuts changed spans into blocks. A block's `first` is made relative to its span, whose points may move
 * later. */
static iso_status measure_blocks(iso_gl_surface *surface, const iso_point_view *points, iso_error *error) {
    ISO_TRY(iso_point_blocks_measure(surface->blocks, points, is_unchanged, surface->spans.data, error));
    iso_point_block *block = surface->blocks->blocks.data;
    for (size_t i = 0; i < surface->blocks->count; i++) block[i].first -= points->spans[block[i].span].first;
    return ISO_OK;
}

/* After a failure: the next update uploads everything. */
static void invalidate_spans(iso_gl_surface *surface) {
    surface->span_count = 0;
    if (surface->blocks) surface->blocks->count = 0;
}

static iso_status describe_spans(iso_gl_surface *surface, const iso_point_view *points, iso_error *error) {
    ISO_TRY(ensure_spans(surface, points->span_count, error));
    describe_points(surface, points);
    return measure_blocks(surface, points, error);
}

static void describe_surface(iso_gl_surface *surface, const iso_point_view *points) {
    surface->transform = points->transform;
    surface->radius = points->radius;
    surface->radii_scale = points->radii ? iso_point_view_radii_scale(points) : 1;
    surface->closed = points->closed;
    memcpy(surface->dims, points->dims, sizeof surface->dims);
}

iso_status iso_gl_surface_place(iso_gl_surface *surface, const iso_point_view *points, iso_error *error) {
    describe_surface(surface, points);
    const iso_status status = describe_spans(surface, points, error);
    if (status != ISO_OK) invalidate_spans(surface);
    return status;
}

/* ---- from views to the GPU */

iso_status iso_gl_check_memory(const iso_gl_engine *engine, uint64_t bytes, iso_error *error) {
    const iso_gl_context *context = engine->context;
    uint64_t available = iso_memory_available();
    if (!iso_gl_renderer_is_software(context->renderer) || bytes <= available) return ISO_OK;
    return iso_fail(error, ISO_ERR_LIMIT, "%s: a copy of the surface needs %.0f MB, %.0f MB are free",
                    context->name, (double)bytes / 1e6, (double)available / 1e6);
}

/* Bytes that a buffer must be newly allocated with to hold `end` items; 0: it is large enough. */
static uint64_t growth(const iso_gl_buffer *buffer, size_t end, size_t item) {
    return end <= buffer->room ? 0 : (uint64_t)end * item;
}

static iso_status send_points(iso_gl_surface *surface, const iso_point_view *points, iso_error *error) {
    const GladGLContext *gl = surface->engine->context->gl;
    source vertices = {points->surfels, sizeof *points->surfels, &surface->vertices};
    if (!points->surfels) vertices = (source){points->packed, sizeof *points->packed, &surface->vertices};
    const source radii = {points->radii, sizeof *points->radii, &surface->radii};
    const source colors = {points->colors, sizeof *points->colors, &surface->colors};
    const source curvatures = {points->curvatures, sizeof *points->curvatures, &surface->curvatures};
    size_t end = end_of(points, points->span_count, points_of);
    if (end > UINT32_MAX) return iso_fail(error, ISO_ERR_LIMIT, "more than 2^32 - 1 points");
    ISO_TRY(
        iso_gl_check_memory(surface->engine,
                            growth(&surface->vertices, end, vertices.item) +
                                (points->radii ? growth(&surface->radii, end, radii.item) : 0) +
                                (points->colors ? growth(&surface->colors, end, colors.item) : 0) +
                                (points->curvatures ? growth(&surface->curvatures, end, curvatures.item) : 0),
                            error));
    ISO_TRY(describe_spans(surface, points, error));
    ensure_capacity(gl, &vertices, end);
    upload_changed(surface, &vertices, points, points_of);
    if (points->radii) {
        ensure_capacity(gl, &radii, end);
        upload_changed(surface, &radii, points, points_of);
    }
    if (points->colors) {
        ensure_capacity(gl, &colors, end);
        upload_changed(surface, &colors, points, points_of);
    }
    if (points->curvatures) {
        ensure_capacity(gl, &curvatures, end);
        upload_changed(surface, &curvatures, points, points_of);
    }
    return ISO_OK;
}

static iso_status send_mesh(iso_gl_surface *surface, const iso_mesh_view *mesh, iso_error *error) {
    const GladGLContext *gl = surface->engine->context->gl;
    const source vertices = {mesh->vertices, sizeof *mesh->vertices, &surface->vertices};
    const source triangles = {mesh->triangles, sizeof *mesh->triangles, &surface->indices};
    size_t vertex_end = end_of(mesh, mesh->span_count, vertices_of);
    size_t triangle_end = end_of(mesh, mesh->span_count, triangles_of);
    if (vertex_end > INT32_MAX || triangle_end > UINT32_MAX / ISO_TRIANGLE_STRIP_ROOM)
        return iso_fail(error, ISO_ERR_LIMIT, "more than 2^31 - 1 vertices or 2^30 - 1 triangles");
    size_t item = surface->stripped ? ISO_TRIANGLE_STRIP_ROOM * sizeof(uint16_t) : triangles.item;
    ISO_TRY(iso_gl_check_memory(surface->engine,
                                growth(&surface->vertices, vertex_end, vertices.item) +
                                    growth(&surface->indices, triangle_end, item),
                                error));
    ISO_TRY(ensure_spans(surface, mesh->span_count, error));
    ISO_TRY(copy_bounds(surface, mesh, error));
    describe_mesh(surface, mesh);
    ensure_capacity(gl, &vertices, vertex_end);
    upload_changed(surface, &vertices, mesh, vertices_of);
    if (surface->stripped) return upload_strips(surface, mesh, error);
    ensure_capacity(gl, &triangles, triangle_end);
    upload_changed(surface, &triangles, mesh, triangles_of);
    return ISO_OK;
}

iso_status iso_gl_update_points(iso_gl_surface *surface, const iso_point_view *points, iso_error *error) {
    assert(!surface->mesh && surface->has_radii == (points->radii != NULL) &&
           surface->has_colors == (points->colors != NULL) &&
           surface->has_curvatures == (points->curvatures != NULL));
    ISO_TRY(iso_gl_enter(surface->engine->context, error));
    describe_surface(surface, points);
    surface->uploaded = 0;
    iso_status status = send_points(surface, points, error);
    if (status == ISO_OK) make_vertex_arrays(surface);
    status = iso_gl_leave(surface->engine->context, status, error);
    if (status != ISO_OK) invalidate_spans(surface);
    return status;
}

iso_status iso_gl_update_mesh(iso_gl_surface *surface, const iso_mesh_view *mesh, iso_error *error) {
    assert(surface->mesh);
    ISO_TRY(iso_gl_enter(surface->engine->context, error));
    surface->transform = mesh->transform;
    surface->uploaded = 0;
    iso_status status = send_mesh(surface, mesh, error);
    if (status == ISO_OK) make_vertex_arrays(surface);
    status = iso_gl_leave(surface->engine->context, status, error);
    if (status != ISO_OK) invalidate_spans(surface);
    return status;
}

static iso_status make_surface(iso_gl_engine *engine, iso_gl_surface **made, iso_error *error) {
    *made = iso_alloc_zero(1, sizeof **made);
    if (!*made) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for a surface");
    (*made)->engine = engine;
    return ISO_OK;
}

iso_status iso_gl_upload_points(iso_gl_engine *engine, const iso_point_view *points, iso_gl_surface **surface,
                                iso_error *error) {
    iso_gl_surface *made;
    ISO_TRY(make_surface(engine, &made, error));
    made->surfels = points->surfels != NULL;
    made->has_radii = points->radii != NULL;
    made->has_colors = points->colors != NULL;
    made->has_curvatures = points->curvatures != NULL;
    made->blocks = iso_alloc_zero(1, sizeof *made->blocks);
    made->seen = iso_alloc_zero(1, sizeof *made->seen);
    iso_status status = made->blocks && made->seen
                            ? iso_gl_update_points(made, points, error)
                            : iso_fail(error, ISO_ERR_NOMEM, "out of memory for blocks of points");
    if (status == ISO_OK)
        *surface = made;
    else
        iso_gl_surface_destroy(made);
    return status;
}

static iso_status upload_mesh(iso_gl_engine *engine, const iso_mesh_view *mesh, bool stripped,
                              iso_gl_surface **surface, iso_error *error) {
    iso_gl_surface *made;
    ISO_TRY(make_surface(engine, &made, error));
    made->mesh = true;
    made->stripped = stripped;
    iso_status status = iso_gl_update_mesh(made, mesh, error);
    if (status == ISO_OK)
        *surface = made;
    else
        iso_gl_surface_destroy(made);
    return status;
}

iso_status iso_gl_upload_mesh(iso_gl_engine *engine, const iso_mesh_view *mesh, iso_gl_surface **surface,
                              iso_error *error) {
    return upload_mesh(engine, mesh, false, surface, error);
}

iso_status iso_gl_upload_strips(iso_gl_engine *engine, const iso_mesh_view *mesh, iso_gl_surface **surface,
                                iso_error *error) {
    return upload_mesh(engine, mesh, true, surface, error);
}

iso_gl_surface_stats iso_gl_surface_measure(const iso_gl_surface *surface) {
    iso_gl_surface_stats stats = {.uploaded = surface->uploaded};
    const iso_gl_span *spans = surface->spans.data;
    for (size_t s = 0; surface->mesh && s < surface->span_count; s++) {
        stats.indices += spans[s].triangles ? spans[s].count : 0;
        stats.triangles += spans[s].triangles;
    }
    return stats;
}

/* Frees what a surface has in main memory. */
static void free_surface(iso_gl_surface *surface) {
    if (surface->blocks) iso_point_blocks_free(surface->blocks);
    iso_free(surface->blocks);
    if (surface->seen) iso_buffer_free(&surface->seen->flags);
    iso_free(surface->seen);
    iso_triangle_strips_free(&surface->strips);
    iso_buffer_free(&surface->bounds);
    iso_buffer_free(&surface->spans);
    iso_free(surface);
}

void iso_gl_surface_destroy(iso_gl_surface *surface) {
    if (!surface) return;
    iso_gl_context *context = surface->engine->context;
    if (iso_gl_enter(context, NULL) == ISO_OK) {
        if (surface->seen) context->gl->DeleteBuffers(2, surface->seen->fronts);
        const GLuint buffers[] = {surface->vertices.name, surface->radii.name, surface->colors.name,
                                  surface->curvatures.name, surface->indices.name};
        const GLuint arrays[] = {surface->array, surface->quad_array};
        context->gl->DeleteVertexArrays(2, arrays); /* 0 is ignored */
        context->gl->DeleteBuffers(5, buffers);
        iso_gl_leave(context, ISO_OK, NULL);
    }
    free_surface(surface);
}
