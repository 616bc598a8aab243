/* lines: uploads the fragments of a strip, has them pulled and pushed, and reads the picture back. */
#include "render/gl/lines.h"

#include <glad/gl.h>
#include <string.h>

#include "render/gl/picture.h"
#include "render/gl/shared_pyramid.h"
#include "render/pullpush/line_graph.h"

_Static_assert(sizeof(iso_gl_line_fragment) == 96, "layout of std430");
_Static_assert(sizeof(iso_gl_lines_uniforms) == 64 + 16 * ISO_GL_LEVELS, "layout of std140");
_Static_assert(ISO_GL_LEVELS == ISO_PYRAMID_TOP + 1, "room for all levels");

/* The drawing of lines, and of one strip of their picture. */
typedef struct lines_call {
    iso_gl_engine *engine;
    const GladGLContext *gl;
    iso_buffer room;
    iso_gl_lines_uniforms uniforms;
    size_t keys, pixels; /* of the base level, and of all levels above 0 */
} lines_call;

static iso_gl_line_fragment make_fragment(const iso_line_fragment *f) {
    iso_gl_line_fragment made = {
        .spot = {f->x, f->y, f->depth, f->interval},
        .ellipse = {(float)f->ellipse.xx, (float)f->ellipse.xy, (float)f->ellipse.yy, f->reach},
        .along = {(float)f->along.xx, (float)f->along.xy, (float)f->along.yy, f->radius},
        .shape = {f->shape[0], f->shape[1], f->shape[2], f->end},
        .way = {f->n[0], f->n[1], f->n[2], f->cosine},
        .more = {(unsigned)f->column | (unsigned)f->row << 16, 0, f->color,
                 f->links | (f->thin ? 256u : 0u) | (unsigned)f->line << 16}};
    memcpy(&made.more[1], &f->sine, sizeof f->sine);
    return made;
}

static void set_uniforms(lines_call *call, const iso_pullpush_params *params, size_t fragments) {
    const iso_pyramid *p = params->pyramid;
    const iso_pyramid_layout *layout = &p->layout;
    const iso_gbuffer *g = params->target->gbuffer;
    const bool colored = layout->planes >> ISO_PLANE_RED & 1;
    iso_gl_lines_uniforms *u = &call->uniforms;
    *u = (iso_gl_lines_uniforms){
        .sight_line = {params->ray[0], params->ray[1], params->slope, 1 / params->scale},
        .lattice = {layout->base, layout->rows_before, layout->column, layout->row},
        .picture = {g->width, g->height, params->target->surface,
                    !g->color ? 0
                    : colored ? 2
                              : 1},
        .flags = {params->orthographic, params->kind == ISO_PULLPUSH_TUBES, params->illuminated,
                  (unsigned)fragments}};
    call->pixels = 0;
    for (int l = 0; l <= layout->top; l++) {
        u->levels[l][0] = p->level[l].width;
        u->levels[l][1] = p->level[l].height;
        u->levels[l][2] = (int)call->pixels;
        if (l > 0) call->pixels += (size_t)p->level[l].width * (size_t)p->level[l].height;
    }
    call->keys = (size_t)p->level[layout->base].width * (size_t)p->level[layout->base].height;
}

/* Makes a buffer of some bytes, and binds it to a slot. ISO_ERR_LIMIT. */
static iso_status provide(lines_call *call, iso_gl_storage which, GLuint slot, size_t bytes,
                          iso_error *error) {
    return iso_gl_engine_provide_storage(call->engine, which, slot, bytes, "lines by pull-push need", error);
}

static void clear(const lines_call *call, iso_gl_storage which, size_t bytes) {
    const GLuint zero = 0;
    call->gl->ClearNamedBufferSubData(call->engine->storage[which], GL_R32UI, 0, (GLsizeiptr)bytes,
                                      GL_RED_INTEGER, GL_UNSIGNED_INT, &zero);
}

/* Uploads what the passes over a strip read, and binds the buffers. */
static iso_status upload(lines_call *call, const iso_pullpush_params *params, size_t count,
                         iso_error *error) {
    const iso_line_fragment *fragments = params->pyramid->line_fragments.data;
    const size_t bytes = count * sizeof(iso_gl_line_fragment), places = call->pixels * 2 * sizeof(uint32_t),
                 index = call->keys * sizeof(uint32_t);
    const unsigned *storage = call->engine->storage;
    ISO_TRY(iso_buffer_reserve(&call->room, bytes, 0, error));
    iso_gl_line_fragment *made = call->room.data;
    for (size_t i = 0; i < count; i++) made[i] = make_fragment(&fragments[i]);
    call->gl->MemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT); /* shaders may still use the strip before's */
    iso_gl_engine_ensure_storage(call->engine, ISO_GL_STORE_UNIFORMS, sizeof(iso_gl_pullpush_uniforms));
    ISO_TRY(provide(call, ISO_GL_STORE_BLOCKS, ISO_GL_LINE_FRAGMENTS, bytes, error));
    ISO_TRY(provide(call, ISO_GL_STORE_KEYS, ISO_GL_LINE_INDEX, index, error));
    ISO_TRY(provide(call, ISO_GL_STORE_RANGES, ISO_GL_LINE_PLACES, places, error));
    call->gl->NamedBufferSubData(storage[ISO_GL_STORE_UNIFORMS], 0, sizeof call->uniforms, &call->uniforms);
    call->gl->BindBufferBase(GL_UNIFORM_BUFFER, ISO_GL_PULLPUSH, storage[ISO_GL_STORE_UNIFORMS]);
    call->gl->NamedBufferSubData(storage[ISO_GL_STORE_BLOCKS], 0, (GLsizeiptr)bytes, made);
    clear(call, ISO_GL_STORE_KEYS, index);
    clear(call, ISO_GL_STORE_RANGES, places);
    return ISO_OK;
}

static iso_status dispatch(const lines_call *call, iso_gl_program program, int level, const int size[2],
                           int tile, iso_error *error) {
    unsigned name;
    ISO_TRY(iso_gl_engine_program(call->engine, program, &name, error));
    call->gl->UseProgram(name);
    if (program != ISO_GL_LINES_PLACE) call->gl->Uniform1i(ISO_GL_LEVEL, level);
    call->gl->DispatchCompute((GLuint)(size[0] + tile - 1) / (GLuint)tile,
                              (GLuint)(size[1] + (tile == ISO_GL_TILE ? tile - 1 : 0)) /
                                  (tile == ISO_GL_TILE ? (GLuint)tile : 1),
                              1);
    call->gl->MemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
    return ISO_OK;
}

static iso_status pull_and_push(const lines_call *call, const iso_pyramid_layout *layout, iso_error *error) {
    const iso_gl_lines_uniforms *u = &call->uniforms;
    enum { ACROSS = 32768 }; /* work groups in x; every driver allows more */
    const int count = (int)u->flags[3], all = (count + ISO_GL_GROUP - 1) / ISO_GL_GROUP,
              across = all < ACROSS ? all : ACROSS,
              groups[2] = {across * ISO_GL_GROUP, (all + across - 1) / across};
    iso_gl_timer *timer = &call->engine->timer;
    iso_gl_timer_begin(timer, call->gl, ISO_GL_PASS_PULL);
    iso_status status = dispatch(call, ISO_GL_LINES_PLACE, 0, groups, ISO_GL_GROUP, error);
    for (int l = layout->base > 0 ? layout->base : 1; l <= layout->top && status == ISO_OK; l++)
        status = dispatch(call, l == layout->base ? ISO_GL_LINES_UNPACK : ISO_GL_LINES_PULL, l, u->levels[l],
                          ISO_GL_TILE, error);
    iso_gl_timer_end(timer, call->gl);
    ISO_TRY(status);
    iso_gl_timer_begin(timer, call->gl, ISO_GL_PASS_PUSH);
    for (int l = layout->top; l > 1 && status == ISO_OK; l--)
        status = dispatch(call, ISO_GL_LINES_PUSH, l, u->levels[l - 1], ISO_GL_TILE, error);
    iso_gl_timer_end(timer, call->gl);
    ISO_TRY(status);
    iso_gl_timer_begin(timer, call->gl, ISO_GL_PASS_FINISH);
    status = dispatch(call, ISO_GL_LINES_FINISH, 1, u->picture, ISO_GL_TILE, error);
    iso_gl_timer_end(timer, call->gl);
    return status;
}

/* iso_pyramid_engine.draw. */
static iso_status draw_strip(void *context, const iso_pullpush_params *params, iso_error *error) {
    lines_call *call = context;
    const iso_pyramid *p = params->pyramid;
    const iso_gbuffer *g = params->target->gbuffer;
    const size_t count = (size_t)p->line_starts[p->level[p->layout.base].height],
                 planes = ISO_GL_PICTURE_PLANES + (g->color != NULL),
                 samples = (size_t)g->width * (size_t)g->height;
    if (!count) return ISO_OK;
    set_uniforms(call, params, count);
    ISO_TRY(upload(call, params, count, error));
    ISO_TRY(provide(call, ISO_GL_STORE_PICTURE, ISO_GL_PICTURE, samples * planes * sizeof(float), error));
    ISO_TRY(iso_gl_picture_write(call->engine, planes, g, 0, samples, &call->room, error));
    ISO_TRY(pull_and_push(call, &p->layout, error));
    ISO_TRY(iso_gl_picture_read(call->engine, planes, g, 0, samples, &call->room, error));
    iso_gl_timer_read(&call->engine->timer, call->gl);
    return iso_gl_check(call->engine->context, error); /* stop when the context is lost */
}

iso_status iso_gl_draw_pyramid_lines(iso_gl_engine *engine, const iso_target *target,
                                     const iso_pyramid_lines *lines, iso_pullpush *workspace,
                                     iso_error *error) {
    lines_call call = {.engine = engine, .gl = engine->context->gl};
    const iso_pyramid_engine by = {draw_strip, &call};
    ISO_TRY(iso_gl_enter(engine->context, error));
    const iso_status status = iso_draw_pyramid_lines_by(&by, target, lines, workspace, error);
    iso_buffer_free(&call.room);
    return iso_gl_leave(engine->context, status, error);
}
