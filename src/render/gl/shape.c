#include "render/gl/shape.h"

#include <glad/gl.h>
#include <string.h>

#include "base/memory.h"
#include "render/gl/shared.h"
#include "render/project.h"

_Static_assert(ISO_GL_BRICK_SIDE == ISO_BRICK && ISO_GL_COORDINATE_BITS == ISO_POINT_COORDINATE_BITS &&
                   ISO_GL_NORMAL_BITS == ISO_POINT_NORMAL_BITS &&
                   ISO_GL_NORMAL_STEPS == ISO_POINT_NORMAL_STEPS,
               "shaders unpack what base/primitives.h packs");
_Static_assert(sizeof(iso_surfel) == 24 && sizeof(iso_point) == 8, "as vertex arrays have it");

/* An array of the shape's owner, of which spans name parts: the parts are put side by side. */
typedef struct source {
    const void *data;
    size_t item; /* bytes */
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

/* Parts that follow one another in the source go up together. */
static unsigned upload(const GladGLContext *gl, source from, const void *view, size_t spans, part_of *get) {
    size_t total = 0, done = 0;
    for (size_t s = 0; s < spans; s++) total += get(view, s).count;
    GLuint buffer;
    gl->CreateBuffers(1, &buffer);
    gl->NamedBufferStorage(buffer, (GLsizeiptr)((total ? total : 1) * from.item), NULL,
                           GL_DYNAMIC_STORAGE_BIT);
    for (size_t s = 0; s < spans;) {
        part run = get(view, s++);
        while (s < spans && get(view, s).first == run.first + run.count) run.count += get(view, s++).count;
        if (!run.count) continue;
        gl->NamedBufferSubData(buffer, (GLintptr)(done * from.item), (GLsizeiptr)(run.count * from.item),
                               (const char *)from.data + run.first * from.item);
        done += run.count;
    }
    return buffer;
}

static void describe_floats(const GladGLContext *gl, unsigned array, unsigned slot, unsigned binding,
                            int count, size_t offset) {
    gl->EnableVertexArrayAttrib(array, slot);
    gl->VertexArrayAttribFormat(array, slot, count, GL_FLOAT, GL_FALSE, (GLuint)offset);
    gl->VertexArrayAttribBinding(array, slot, binding);
}

enum { BIND_VERTICES, BIND_RADII, BIND_SPANS };

/* divisor 0: points are vertices; 1: instances. */
static unsigned make_array(const GladGLContext *gl, const iso_gl_shape *shape, unsigned divisor) {
    GLuint array;
    gl->CreateVertexArrays(1, &array);
    bool floats = shape->mesh || shape->surfels;
    gl->VertexArrayVertexBuffer(array, BIND_VERTICES, shape->vertices, 0,
                                floats ? sizeof(iso_surfel) : sizeof(iso_point));
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
        gl->VertexArrayVertexBuffer(array, BIND_RADII, shape->radii, 0, sizeof(float));
        gl->VertexArrayBindingDivisor(array, BIND_RADII, divisor);
        describe_floats(gl, array, ISO_GL_RADIUS, BIND_RADII, 1, 0);
    }
    return array;
}

/* One number of a brick for each draw: an instance's, named by the draw's first instance. */
static void add_spans(iso_gl_shape *shape, const GladGLContext *gl) {
    GLuint slot = shape->mesh ? ISO_GL_BRICK : ISO_GL_ORIGIN;
    gl->VertexArrayVertexBuffer(shape->array, BIND_SPANS, shape->engine->instances, 0, 3 * sizeof(float));
    gl->VertexArrayBindingDivisor(shape->array, BIND_SPANS, 1);
    gl->EnableVertexArrayAttrib(shape->array, slot);
    if (shape->mesh)
        gl->VertexArrayAttribIFormat(shape->array, slot, 3, GL_INT, 0);
    else
        gl->VertexArrayAttribFormat(shape->array, slot, 3, GL_FLOAT, GL_FALSE, 0);
    gl->VertexArrayAttribBinding(shape->array, slot, BIND_SPANS);
}

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

static void describe_points(iso_gl_shape *shape, const iso_point_view *points) {
    uint32_t first = 0;
    for (size_t s = 0; s < shape->span_count; s++) {
        const iso_point_span *from = &points->spans[s];
        iso_gl_span *to = &shape->spans[s];
        *to = (iso_gl_span){.count = from->count, .first = first, .radius = largest_radius(points, from)};
        memcpy(to->brick, from->brick, sizeof to->brick);
        to->box = points->surfels ? iso_surfel_bounds(points->surfels + from->first, from->count, from->brick)
                                  : packed_box(from->brick);
        first += from->count;
    }
}

static void describe_mesh(iso_gl_shape *shape, const iso_mesh_view *mesh) {
    uint32_t first = 0;
    int32_t base = 0;
    for (size_t s = 0; s < shape->span_count; s++) {
        const iso_mesh_span *from = &mesh->spans[s];
        iso_gl_span *to = &shape->spans[s];
        *to = (iso_gl_span){.count = 3 * from->triangle_count, .first = first, .base = base};
        memcpy(to->brick, from->brick, sizeof to->brick);
        to->box = iso_surfel_bounds(mesh->vertices + from->first_vertex, from->vertex_count, from->brick);
        first += 3 * from->triangle_count;
        base += (int32_t)from->vertex_count;
    }
}

static iso_status make_shape(iso_gl_engine *engine, const iso_transform *transform, size_t spans,
                             iso_gl_shape **shape, iso_error *error) {
    iso_gl_shape *made = iso_alloc_zero(1, sizeof *made);
    iso_gl_span *room = iso_alloc_zero(spans ? spans : 1, sizeof *room);
    if (!made || !room) {
        iso_free(made);
        iso_free(room);
        return iso_fail(error, ISO_ERR_NOMEM, "out of memory for %zu spans", spans);
    }
    *made = (iso_gl_shape){.engine = engine, .transform = *transform, .spans = room, .span_count = spans};
    *shape = made;
    return ISO_OK;
}

/* Ends an upload: the context is left, and the shape given out or destroyed. */
static iso_status finish(iso_gl_shape *made, iso_gl_shape **shape, iso_error *error) {
    iso_status status = iso_gl_leave(made->engine->context, ISO_OK, error);
    if (status == ISO_OK)
        *shape = made;
    else
        iso_gl_shape_destroy(made);
    return status;
}

/* Blocks say where they begin in their span, as its points may come to lie elsewhere in the GPU's memory. */
static iso_status measure_blocks(iso_gl_shape *shape, const iso_point_view *points, iso_error *error) {
    shape->blocks = iso_alloc_zero(1, sizeof *shape->blocks);
    if (!shape->blocks) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for blocks of points");
    ISO_TRY(iso_point_blocks_measure(shape->blocks, points, error));
    iso_point_block *block = shape->blocks->blocks.data;
    for (size_t i = 0; i < shape->blocks->count; i++) block[i].first -= points->spans[block[i].span].first;
    return ISO_OK;
}

/* What a shape has outside the GPU. */
static void free_shape(iso_gl_shape *shape) {
    if (shape->blocks) iso_point_blocks_free(shape->blocks);
    iso_free(shape->blocks);
    iso_free(shape->spans);
    iso_free(shape);
}

iso_status iso_gl_upload_points(iso_gl_engine *engine, const iso_point_view *points, iso_gl_shape **shape,
                                iso_error *error) {
    const GladGLContext *gl = engine->context->gl;
    if (iso_point_view_count(points) > UINT32_MAX)
        return iso_fail(error, ISO_ERR_LIMIT, "more than 2^32 - 1 points");
    iso_gl_shape *made;
    ISO_TRY(make_shape(engine, &points->transform, points->span_count, &made, error));
    made->surfels = points->surfels != NULL;
    made->has_radii = points->radii != NULL;
    made->radius = points->radius;
    made->closed = points->closed;
    describe_points(made, points);
    iso_status status = measure_blocks(made, points, error);
    if (status == ISO_OK) status = iso_gl_enter(engine->context, error);
    if (status != ISO_OK) {
        free_shape(made);
        return status;
    }
    source vertices = {points->surfels, sizeof *points->surfels};
    if (!points->surfels) vertices = (source){points->packed, sizeof *points->packed};
    made->vertices = upload(gl, vertices, points, points->span_count, points_of);
    if (points->radii)
        made->radii =
            upload(gl, (source){points->radii, sizeof *points->radii}, points, points->span_count, points_of);
    made->array = make_array(gl, made, 0);
    made->quad_array = make_array(gl, made, 1);
    add_spans(made, gl);
    return finish(made, shape, error);
}

static bool is_too_large(const iso_mesh_view *mesh) {
    size_t vertices = 0, triangles = 0;
    for (size_t s = 0; s < mesh->span_count; s++) {
        vertices += mesh->spans[s].vertex_count;
        triangles += mesh->spans[s].triangle_count;
    }
    return vertices > INT32_MAX || triangles > UINT32_MAX / 3;
}

iso_status iso_gl_upload_mesh(iso_gl_engine *engine, const iso_mesh_view *mesh, iso_gl_shape **shape,
                              iso_error *error) {
    const GladGLContext *gl = engine->context->gl;
    if (is_too_large(mesh))
        return iso_fail(error, ISO_ERR_LIMIT, "more than 2^31 - 1 vertices or 2^32 - 1 indices");
    iso_gl_shape *made;
    ISO_TRY(make_shape(engine, &mesh->transform, mesh->span_count, &made, error));
    made->mesh = true;
    describe_mesh(made, mesh);
    iso_status status = iso_gl_enter(engine->context, error);
    if (status != ISO_OK) {
        free_shape(made);
        return status;
    }
    made->vertices =
        upload(gl, (source){mesh->vertices, sizeof *mesh->vertices}, mesh, mesh->span_count, vertices_of);
    made->indices =
        upload(gl, (source){mesh->triangles, sizeof *mesh->triangles}, mesh, mesh->span_count, triangles_of);
    made->array = make_array(gl, made, 0);
    gl->VertexArrayElementBuffer(made->array, made->indices);
    add_spans(made, gl);
    return finish(made, shape, error);
}

void iso_gl_shape_destroy(iso_gl_shape *shape) {
    if (!shape) return;
    iso_gl_context *context = shape->engine->context;
    if (iso_gl_enter(context, NULL) == ISO_OK) {
        const GLuint buffers[] = {shape->vertices, shape->radii, shape->indices};
        const GLuint arrays[] = {shape->array, shape->quad_array};
        context->gl->DeleteVertexArrays(2, arrays); /* 0 is ignored */
        context->gl->DeleteBuffers(3, buffers);
        iso_gl_leave(context, ISO_OK, NULL);
    }
    free_shape(shape);
}
