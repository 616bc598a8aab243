/* shapes_upload: copies a set of shapes to the GPU, in the order of its blocks. */
#include <glad/gl.h>
#include <string.h>

#include "base/memory.h"
#include "render/gl/shapes_set.h"
#include "render/gl/shared.h"

_Static_assert(ISO_GL_SPHERES == (int)ISO_SHAPE_SPHERE && ISO_GL_TUBES == (int)ISO_SHAPE_TUBE &&
                   ISO_GL_RIBBONS == (int)ISO_SHAPE_RIBBON && ISO_GL_SOLIDS == (int)ISO_SHAPE_SOLID,
               "kinds of shapes");
_Static_assert(ISO_GL_TUBE_CUT_FIRST == (unsigned)ISO_TUBE_CUT_FIRST &&
                   ISO_GL_TUBE_CUT_LAST == (unsigned)ISO_TUBE_CUT_LAST &&
                   ISO_GL_TUBE_WIDENED == (unsigned)ISO_TUBE_WIDENED &&
                   ISO_GL_TUBE_SECOND_ONLY == (unsigned)ISO_TUBE_SECOND_ONLY,
               "flags of tubes");
_Static_assert(ISO_GL_CONE == (int)ISO_GLYPH_CONE && ISO_GL_CYLINDER == (int)ISO_GLYPH_CYLINDER &&
                   ISO_GL_ARROW == (int)ISO_GLYPH_ARROW && ISO_GL_ELLIPSOID == (int)ISO_GLYPH_ELLIPSOID &&
                   ISO_GL_DISC == (int)ISO_GLYPH_DISC && ISO_GL_BOX == (int)ISO_GLYPH_BOX,
               "glyphs");

enum {
    FLAGS_SHIFT = 30, /* of a segment's flags, above the number of its first vertex */
    SOLID_VALUES =
        7, /* vectors of a solid: centre and reach, images of the unit vectors, rows of the inverse */
    STORAGE_BLOCKS = 3 /* that shapes.vert reads */
};

/* Memory that is filled before it is uploaded. */
typedef struct uploads {
    size_t shapes, vertices; /* counts */
    float *data;
    uint32_t *marks, *colors;
    size_t data_bytes, mark_bytes, color_bytes;
} uploads;

/* ---- sizes */

/* One beyond the last vertex that a segment has. */
static size_t vertex_end(const iso_shapes *set) {
    size_t end = 0;
    for (size_t b = 0; b < set->block_count; b++)
        for (uint32_t i = set->blocks[b].first; i < set->blocks[b].first + set->blocks[b].count; i++) {
            const size_t last = (size_t)set->runs.first[i] + set->runs.length[i] + 1;
            end = last > end ? last : end;
        }
    return end;
}

static iso_status measure(const iso_gl_engine *engine, const iso_shapes *set, uploads *u, iso_error *error) {
    enum { VECTOR = 4 * sizeof(float) };
    static const size_t vectors[] = {[ISO_SHAPE_SPHERE] = 1,
                                     [ISO_SHAPE_TUBE] = 1,
                                     [ISO_SHAPE_RIBBON] = 2,
                                     [ISO_SHAPE_SOLID] = SOLID_VALUES};
    const bool lines = iso_shapes_are_lines(set);
    u->shapes = set->count;
    u->vertices = lines ? vertex_end(set) : 0;
    u->data_bytes = (lines ? u->vertices : u->shapes) * vectors[set->kind] * VECTOR;
    u->mark_bytes = u->shapes * (lines ? 1 : 2) * sizeof(uint32_t);
    u->color_bytes = lines && set->colors ? u->vertices * sizeof(uint32_t) : 0;
    const size_t most = u->data_bytes > u->mark_bytes ? u->data_bytes : u->mark_bytes;
    if (most > engine->max_storage || u->shapes > INT32_MAX / 4)
        return iso_fail(error, ISO_ERR_LIMIT,
                        "%s: %zu lines' segments or glyphs do not fit into a storage buffer of %s",
                        engine->context->name, u->shapes, engine->context->renderer);
    return iso_gl_check_memory(engine, u->data_bytes + u->mark_bytes + u->color_bytes, error);
}

/* ---- contents */

static void fill_spheres(const iso_shapes *set, const uploads *u) {
    for (size_t i = 0; i < u->shapes; i++) {
        const float sphere[4] = {set->x[i], set->y[i], set->z[i],
                                 iso_shapes_radius(set, iso_shapes_id(set, i))};
        memcpy(u->data + 4 * i, sphere, sizeof sphere);
    }
}

/* The centre is relative to the block's origin, as positions are. */
void iso_gl_solid_centre(const iso_shapes *set, uint32_t place, const iso_solid_map *map, float centre[3]) {
    const float position[3] = {set->x[place], set->y[place], set->z[place]};
    for (int a = 0; a < 3; a++) centre[a] = (float)((double)position[a] + map->centre[a]);
}

static void fill_solids(const iso_shapes *set, const uploads *u) {
    for (size_t i = 0; i < u->shapes; i++) {
        float(*to)[4] = (float(*)[4])(u->data + 4 * SOLID_VALUES * i);
        iso_solid_map map;
        double inverse[3][3];
        memset(to, 0, SOLID_VALUES * sizeof *to);
        if (!iso_solid_map_of(set, iso_shapes_id(set, i), &map)) continue; /* never: the set has none such */
        iso_solid_invert((const double(*)[3])map.axis, inverse);
        iso_gl_solid_centre(set, (uint32_t)i, &map, to[0]);
        to[0][3] = (float)iso_solid_extent(set->glyph, &map);
        for (int k = 0; k < 3; k++)
            for (int a = 0; a < 3; a++) {
                to[1 + k][a] = (float)map.axis[k][a];
                to[4 + k][a] = (float)inverse[k][a];
            }
    }
}

static void fill_glyphs(const iso_shapes *set, const uploads *u, uint32_t *starts) {
    for (size_t b = 0; b < set->block_count; b++) starts[b] = set->blocks[b].first;
    for (size_t i = 0; i < u->shapes; i++) {
        u->marks[2 * i] = iso_shapes_id(set, i);
        u->marks[2 * i + 1] = iso_gl_shape_color(set, iso_shapes_id(set, i));
    }
    if (set->kind == ISO_SHAPE_SPHERE)
        fill_spheres(set, u);
    else
        fill_solids(set, u);
}

static void fill_lines(const iso_shapes *set, const uploads *u, uint32_t *starts) {
    uint32_t count = 0;
    for (size_t b = 0; b < set->block_count; b++) {
        int32_t ids[ISO_SHAPES_BLOCK], flags[ISO_SHAPES_BLOCK];
        const int segments = iso_shapes_list_segments(set, &set->blocks[b], ids, flags);
        starts[b] = count;
        for (int i = 0; i < segments; i++)
            u->marks[count++] = (uint32_t)ids[i] | (uint32_t)flags[i] << FLAGS_SHIFT;
    }
    if (set->kind == ISO_SHAPE_TUBE) memcpy(u->data, set->vertices, u->data_bytes);
    for (size_t i = 0; i < u->vertices && set->kind == ISO_SHAPE_RIBBON; i++) {
        memcpy(u->data + 8 * i, set->vertices[i], sizeof set->vertices[i]);
        iso_shapes_across(set, i, u->data + 8 * i + 4);
        u->data[8 * i + 7] = 0;
    }
    for (size_t i = 0; u->colors && i < u->vertices; i++) u->colors[i] = iso_gl_shape_color(set, i);
}

/* ---- buffers */

static unsigned make_buffer(const GladGLContext *gl, size_t bytes, const void *data) {
    GLuint name = 0;
    if (!bytes) return 0;
    gl->CreateBuffers(1, &name);
    gl->NamedBufferStorage(name, (GLsizeiptr)bytes, data, 0);
    return name;
}

static iso_status check_stages(const iso_gl_engine *engine, iso_error *error) {
    GLint blocks = 0;
    engine->context->gl->GetIntegerv(GL_MAX_VERTEX_SHADER_STORAGE_BLOCKS, &blocks);
    if (blocks >= STORAGE_BLOCKS) return ISO_OK;
    return iso_fail(error, ISO_ERR_BACKEND, "%s: vertex shaders of %s have no storage buffers",
                    engine->context->name, engine->context->renderer);
}

static iso_status fill_and_send(iso_gl_shapes *made, uploads *u, iso_error *error) {
    const GladGLContext *gl = made->engine->context->gl;
    const iso_shapes *set = made->set;
    made->starts = iso_alloc(set->block_count * sizeof *made->starts);
    u->data = iso_alloc(u->data_bytes);
    u->marks = iso_alloc(u->mark_bytes);
    u->colors = u->color_bytes ? iso_alloc(u->color_bytes) : NULL;
    if (!made->starts || !u->data || !u->marks || (u->color_bytes && !u->colors))
        return iso_fail_memory(error, "shapes");
    if (iso_shapes_are_lines(set))
        fill_lines(set, u, made->starts);
    else
        fill_glyphs(set, u, made->starts);
    ISO_TRY(iso_gl_enter(made->engine->context, error));
    iso_status status = check_stages(made->engine, error);
    if (status == ISO_OK) {
        made->data = make_buffer(gl, u->data_bytes, u->data);
        made->marks = make_buffer(gl, u->mark_bytes, u->marks);
        made->colors = make_buffer(gl, u->color_bytes, u->colors);
    }
    return iso_gl_leave(made->engine->context, status, error);
}

iso_status iso_gl_upload_shapes(iso_gl_engine *engine, const iso_shapes *shapes, iso_gl_shapes **uploaded,
                                iso_error *error) {
    uploads u = {.shapes = 0};
    ISO_TRY(measure(engine, shapes, &u, error));
    iso_gl_shapes *made = iso_alloc_zero(1, sizeof *made);
    if (!made) return iso_fail_memory(error, "shapes");
    made->engine = engine;
    made->set = shapes;
    const iso_status status = fill_and_send(made, &u, error);
    iso_free(u.data);
    iso_free(u.marks);
    iso_free(u.colors);
    if (status == ISO_OK)
        *uploaded = made;
    else
        iso_gl_shapes_destroy(made);
    return status;
}

void iso_gl_shapes_destroy(iso_gl_shapes *shapes) {
    if (!shapes) return;
    iso_gl_context *context = shapes->engine->context;
    if (iso_gl_enter(context, NULL) == ISO_OK) {
        const GLuint buffers[] = {shapes->data, shapes->marks, shapes->colors};
        context->gl->DeleteBuffers(3, buffers); /* 0 is ignored */
        iso_gl_leave(context, ISO_OK, NULL);
    }
    iso_free(shapes->starts);
    iso_free(shapes);
}
