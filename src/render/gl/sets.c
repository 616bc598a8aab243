/* sets: uploads the fragments of a strip, has them pulled and pushed, and reads the picture back. */
#include "render/gl/sets.h"

#include <glad/gl.h>
#include <string.h>

#include "render/gl/picture.h"
#include "render/gl/shared_pyramid.h"
#include "render/pullpush/set_fragments.h"

_Static_assert(sizeof(iso_gl_set_fragment) == 48, "layout of std430");
_Static_assert(sizeof(iso_gl_sets_uniforms) == 144 + 16 * ISO_GL_LEVELS, "layout of std140");

/* The drawing of sets, and of one strip of their picture. */
typedef struct sets_call {
    iso_gl_engine *engine;
    const GladGLContext *gl;
    iso_buffer room;
    iso_gl_sets_uniforms uniforms;
    size_t keys, pixels; /* of the base level, and of all levels above 0 */
} sets_call;

static iso_gl_set_fragment make_fragment(const iso_pyramid_level *base, size_t at, int64_t key) {
    float *const *plane = base->plane;
    const float depth = iso_key_depth(key);
    iso_gl_set_fragment made = {
        .key = {(unsigned)(key & UINT32_MAX), 0, (unsigned)plane[ISO_PLANE_SET][at], 0},
        .more = {plane[ISO_PLANE_TWICE_X][at], plane[ISO_PLANE_TWICE_Y][at], plane[ISO_PLANE_RADIUS][at],
                 plane[ISO_PLANE_INTERVAL][at]}};
    memcpy(&made.key[1], &depth, sizeof depth);
    for (int k = 0; k < 3; k++) made.shape[k] = plane[ISO_PLANE_SHAPE_XX + k][at];
    made.shape[3] = plane[ISO_PLANE_ROOM][at];
    for (int k = 0; k < 3 && plane[ISO_PLANE_RED]; k++)
        made.key[3] |= (unsigned)(plane[ISO_PLANE_RED + k][at] + 0.5f) << 8 * k;
    return made;
}

/* Lists the fragments of the base level, and their numbers by pixel. Returns how many there are. */
static size_t list_fragments(const iso_pyramid *p, uint32_t *index, iso_gl_set_fragment *fragments) {
    const iso_pyramid_level *base = &p->level[0];
    size_t count = 0;
    for (int y = 0; y < base->height; y++)
        for (int x = 0; x < base->width; x++, index++) {
            const int64_t key = p->keys[(size_t)y * p->key_stride + (size_t)x];
            *index = 0;
            if (key == ISO_KEY_NONE) continue;
            fragments[count++] = make_fragment(base, (size_t)y * base->stride + (size_t)x, key);
            *index = (uint32_t)count;
        }
    return count;
}

static size_t count_fragments(const iso_pyramid *p) {
    size_t count = 0;
    for (int y = 0; y < p->level[0].height; y++)
        for (int x = 0; x < p->level[0].width; x++)
            count += p->keys[(size_t)y * p->key_stride + (size_t)x] != ISO_KEY_NONE;
    return count;
}

static void set_uniforms(sets_call *call, const iso_pullpush_params *params) {
    const iso_pyramid *p = params->pyramid;
    const iso_pyramid_layout *layout = &p->layout;
    const iso_gbuffer *g = params->target->gbuffer;
    iso_gl_sets_uniforms *u = &call->uniforms;
    *u =
        (iso_gl_sets_uniforms){.sight = {params->ray[0], params->ray[1], params->slope, params->scale},
                               .disc = {params->low_pass, params->facing, params->edge, params->least_radius},
                               .lattice = {layout->base, layout->rows_before, layout->column, layout->row},
                               .picture = {g->width, g->height, 0, g->color != NULL},
                               .flags = {params->orthographic}};
    float *normals[] = {u->normal_x, u->normal_y, u->normal_z};
    for (int k = 0; k < 3; k++) memcpy(normals[k], params->normal + 3 * k, 3 * sizeof(float));
    memcpy(u->weight, params->weight, sizeof u->weight);
    call->pixels = 0;
    for (int l = 0; l <= layout->top; l++) {
        u->levels[l][0] = p->level[l].width;
        u->levels[l][1] = p->level[l].height;
        u->levels[l][2] = (int)call->pixels;
        if (l > 0) call->pixels += (size_t)p->level[l].width * (size_t)p->level[l].height;
    }
    call->keys = (size_t)p->level[0].width * (size_t)p->level[0].height;
}

/* Makes a buffer of some bytes, and binds it to a slot. ISO_ERR_LIMIT. */
static iso_status provide(sets_call *call, iso_gl_storage which, GLuint slot, size_t bytes,
                          iso_error *error) {
    return iso_gl_engine_provide_storage(call->engine, which, slot, bytes, "--one-pyramid needs", error);
}

/* Uploads what the passes over a strip read, and binds the buffers. */
static iso_status upload(sets_call *call, const iso_pullpush_params *params, size_t count, iso_error *error) {
    const size_t bytes = count * sizeof(iso_gl_set_fragment), index = call->keys * sizeof(uint32_t);
    const unsigned *storage = call->engine->storage;
    ISO_TRY(iso_buffer_reserve(&call->room, bytes + index, 0, error));
    iso_gl_set_fragment *fragments = call->room.data;
    uint32_t *numbers = (uint32_t *)(fragments + count);
    list_fragments(params->pyramid, numbers, fragments);
    call->gl->MemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT); /* shaders may still use the strip before's */
    iso_gl_engine_ensure_storage(call->engine, ISO_GL_STORE_UNIFORMS, sizeof(iso_gl_pullpush_uniforms));
    ISO_TRY(provide(call, ISO_GL_STORE_BLOCKS, ISO_GL_SET_FRAGMENTS, bytes, error));
    ISO_TRY(provide(call, ISO_GL_STORE_KEYS, ISO_GL_SET_INDEX, index, error));
    ISO_TRY(
        provide(call, ISO_GL_STORE_SHADES, ISO_GL_SET_PIXELS, call->pixels * ISO_GL_SET_PIXEL_BYTES, error));
    call->gl->NamedBufferSubData(storage[ISO_GL_STORE_UNIFORMS], 0, sizeof call->uniforms, &call->uniforms);
    call->gl->BindBufferBase(GL_UNIFORM_BUFFER, ISO_GL_PULLPUSH, storage[ISO_GL_STORE_UNIFORMS]);
    call->gl->NamedBufferSubData(storage[ISO_GL_STORE_BLOCKS], 0, (GLsizeiptr)bytes, fragments);
    call->gl->NamedBufferSubData(storage[ISO_GL_STORE_KEYS], 0, (GLsizeiptr)index, numbers);
    return ISO_OK;
}

static iso_status dispatch(const sets_call *call, iso_gl_program program, int level, const int size[2],
                           iso_error *error) {
    unsigned name;
    ISO_TRY(iso_gl_engine_program(call->engine, program, &name, error));
    call->gl->UseProgram(name);
    if (program != ISO_GL_SETS_FINISH) call->gl->Uniform1i(ISO_GL_LEVEL, level);
    call->gl->DispatchCompute((GLuint)(size[0] + ISO_GL_TILE - 1) / ISO_GL_TILE,
                              (GLuint)(size[1] + ISO_GL_TILE - 1) / ISO_GL_TILE, 1);
    call->gl->MemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
    return ISO_OK;
}

static iso_status pull_and_push(const sets_call *call, int top, iso_error *error) {
    const iso_gl_sets_uniforms *u = &call->uniforms;
    iso_gl_timer *timer = &call->engine->timer;
    iso_status status = ISO_OK;
    iso_gl_timer_begin(timer, call->gl, ISO_GL_PASS_PULL);
    for (int l = 1; l <= top && status == ISO_OK; l++)
        status = dispatch(call, ISO_GL_SETS_PULL, l, u->levels[l], error);
    iso_gl_timer_end(timer, call->gl);
    ISO_TRY(status);
    iso_gl_timer_begin(timer, call->gl, ISO_GL_PASS_PUSH);
    for (int l = top - 1; l >= 1 && status == ISO_OK; l--)
        status = dispatch(call, ISO_GL_SETS_PUSH, l, u->levels[l], error);
    iso_gl_timer_end(timer, call->gl);
    ISO_TRY(status);
    iso_gl_timer_begin(timer, call->gl, ISO_GL_PASS_FINISH);
    status = dispatch(call, ISO_GL_SETS_FINISH, 0, u->picture, error);
    iso_gl_timer_end(timer, call->gl);
    return status;
}

/* iso_pyramid_engine.draw. */
static iso_status draw_strip(void *context, const iso_pullpush_params *params, iso_error *error) {
    sets_call *call = context;
    const iso_gbuffer *g = params->target->gbuffer;
    const size_t count = count_fragments(params->pyramid),
                 planes = ISO_GL_PICTURE_PLANES + (g->color != NULL),
                 samples = (size_t)g->width * (size_t)g->height;
    if (!count) return ISO_OK;
    set_uniforms(call, params);
    ISO_TRY(upload(call, params, count, error));
    ISO_TRY(provide(call, ISO_GL_STORE_PICTURE, ISO_GL_PICTURE, samples * planes * sizeof(float), error));
    ISO_TRY(iso_gl_picture_write(call->engine, planes, g, 0, samples, &call->room, error));
    ISO_TRY(pull_and_push(call, params->pyramid->layout.top, error));
    ISO_TRY(iso_gl_picture_read(call->engine, planes, g, 0, samples, &call->room, error));
    iso_gl_timer_read(&call->engine->timer, call->gl);
    return iso_gl_check(call->engine->context, error); /* stop when the context is lost */
}

iso_status iso_gl_draw_pyramid_sets(iso_gl_engine *engine, const iso_target *target,
                                    const iso_pyramid_set *sets, size_t count, const iso_pullpush_opts *opts,
                                    iso_error *error) {
    sets_call call = {.engine = engine, .gl = engine->context->gl};
    const iso_pyramid_engine by = {draw_strip, &call};
    ISO_TRY(iso_gl_enter(engine->context, error));
    const iso_status status = iso_draw_pyramid_sets_by(&by, target, sets, count, opts, error);
    iso_buffer_free(&call.room);
    return iso_gl_leave(engine->context, status, error);
}
