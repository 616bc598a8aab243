/* groups: uploads the discs of a strip, has them drawn into slots, resolves the slots into the picture
 * buffer and reads that back (Zhang and Pajarola 2006; render/groups/groups.h). */
#include "render/gl/groups.h"

#include <assert.h>
#include <glad/gl.h>

#include "render/gl/picture.h"
#include "render/gl/shared.h"
#include "render/gl/splat.h"

enum { STRIP_ROWS_LEAST = 16 };
/* Limit of the storage buffers of the slots and the picture; a larger picture is drawn in strips. */
static const size_t STORAGE_BYTES = (size_t)256 << 20;

_Static_assert(sizeof(iso_gl_splat) == 32, "layout of std430");
_Static_assert(sizeof(iso_gl_splatting_uniforms) == 80, "layout of std140");

/* The drawing of a picture. */
typedef struct splats_call {
    iso_gl_engine *engine;
    const GladGLContext *gl;
    const iso_gl_draw_groups_opts *opts;
    size_t planes; /* of the picture */
    iso_banded_discs discs;
    iso_buffer splats, room;
} splats_call;

/* ---- one surface in one strip */

/* Makes the splats of the discs that the strip shows; returns how many. ISO_ERR_NOMEM. */
static iso_status gather_splats(splats_call *call, const iso_gl_grouped_points *surface, const iso_view *view,
                                size_t *count, iso_error *error) {
    ISO_TRY(iso_banded_discs_project(&call->discs, view, &surface->points, ISO_GROUPS_DISC, call->opts->pool,
                                     error));
    ISO_TRY(iso_buffer_reserve(&call->splats, call->discs.count * sizeof(iso_gl_splat), 0, error));
    const iso_disc *disc = call->discs.disc.data;
    const iso_rows *rows = call->discs.rows.data;
    iso_gl_splat *to = call->splats.data;
    *count = 0;
    for (size_t i = 0; i < call->discs.count; i++) {
        if (rows[i].first > rows[i].last) continue;
        to[(*count)++] = iso_gl_splat_make(&disc[i], &surface->points, surface->groups);
    }
    return ISO_OK;
}

static iso_status upload(splats_call *call, int number, const iso_view *view, size_t count,
                         iso_error *error) {
    iso_gl_engine *engine = call->engine;
    const iso_gl_grouped_points *surface = &call->opts->surfaces[number];
    const iso_disc_view rays = iso_disc_view_make(view);
    const iso_gl_splatting_uniforms u = {
        .axis = {(float)view->cx, (float)view->cy},
        .rays = {rays.slope, rays.scale, rays.near, ISO_GROUPS_THICKNESS / ISO_GROUPS_DISC},
        .picture = {view->width, view->height, number},
        .counts = {(int)count, surface->groups->count, surface->points.colors != NULL},
        .layers = {0, (float)call->opts->bins, call->discs.depth[0],
                   call->discs.depth[1] - call->discs.depth[0]}};
    if (count * sizeof(iso_gl_splat) > engine->max_storage || count > INT32_MAX)
        return iso_fail(error, ISO_ERR_LIMIT, "%s: %zu discs do not fit into a storage buffer of %s",
                        engine->context->name, count, engine->context->renderer);
    iso_gl_engine_ensure_storage(engine, ISO_GL_STORE_SPLATTING, sizeof u);
    iso_gl_engine_ensure_storage(engine, ISO_GL_STORE_SPLATS, count * sizeof(iso_gl_splat));
    call->gl->NamedBufferSubData(engine->storage[ISO_GL_STORE_SPLATTING], 0, sizeof u, &u);
    call->gl->NamedBufferSubData(engine->storage[ISO_GL_STORE_SPLATS], 0,
                                 (GLsizeiptr)(count * sizeof(iso_gl_splat)), call->splats.data);
    return ISO_OK;
}

static void bind(const splats_call *call) {
    const unsigned *storage = call->engine->storage;
    call->gl->BindBufferBase(GL_UNIFORM_BUFFER, ISO_GL_SPLATTING, storage[ISO_GL_STORE_SPLATTING]);
    call->gl->BindBufferBase(GL_SHADER_STORAGE_BUFFER, ISO_GL_SPLATS, storage[ISO_GL_STORE_SPLATS]);
    call->gl->BindBufferBase(GL_SHADER_STORAGE_BUFFER, ISO_GL_KEYS, storage[ISO_GL_STORE_SLOTS]);
    call->gl->BindBufferBase(GL_SHADER_STORAGE_BUFFER, ISO_GL_PICTURE, storage[ISO_GL_STORE_PICTURE]);
}

static iso_status dispatch(const splats_call *call, iso_gl_program program, GLuint across, GLuint down,
                           iso_error *error) {
    unsigned name;
    ISO_TRY(iso_gl_engine_program(call->engine, program, &name, error));
    call->gl->UseProgram(name);
    call->gl->DispatchCompute(across, down, 1);
    call->gl->MemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
    return ISO_OK;
}

/* Draws `count` discs into the slots, in as many passes as the driver needs. */
static iso_status draw_splats(const splats_call *call, size_t count, iso_error *error) {
    enum { GROUPS = 32768 }; /* work groups in x; every driver allows more */
    const size_t groups = (count + ISO_GL_GROUP - 1) / ISO_GL_GROUP;
    const GLuint across = (GLuint)(groups < GROUPS ? groups : GROUPS),
                 down = (GLuint)((groups + GROUPS - 1) / GROUPS);
    if (call->engine->wide_atomics) return dispatch(call, ISO_GL_SPLAT_KEYS, across, down, error);
    ISO_TRY(dispatch(call, ISO_GL_SPLAT_DEPTHS, across, down, error));
    return dispatch(call, ISO_GL_SPLAT_NUMBERS, across, down, error);
}

static iso_status draw_surface(splats_call *call, int number, const iso_view *view, iso_error *error) {
    const GLuint none = ISO_GL_KEY_NONE;
    const iso_gl_grouped_points *surface = &call->opts->surfaces[number];
    const size_t slots =
        (size_t)view->width * (size_t)view->height * (size_t)surface->groups->count * 2 * sizeof(uint32_t);
    size_t count;
    ISO_TRY(gather_splats(call, surface, view, &count, error));
    if (!count) return ISO_OK;
    ISO_TRY(upload(call, number, view, count, error));
    iso_gl_engine_ensure_storage(call->engine, ISO_GL_STORE_SLOTS, slots);
    call->gl->ClearNamedBufferSubData(call->engine->storage[ISO_GL_STORE_SLOTS], GL_R32UI, 0,
                                      (GLsizeiptr)slots, GL_RED_INTEGER, GL_UNSIGNED_INT, &none);
    bind(call);
    ISO_TRY(draw_splats(call, count, error));
    return dispatch(call, ISO_GL_SPLAT_RESOLVE, (GLuint)(view->width + ISO_GL_TILE - 1) / ISO_GL_TILE,
                    (GLuint)(view->height + ISO_GL_TILE - 1) / ISO_GL_TILE, error);
}

/* ---- strips */

/* Bytes of the largest storage buffer that a row of samples needs. */
static size_t row_bytes(const splats_call *call) {
    size_t most = call->planes * sizeof(float);
    for (int i = 0; i < call->opts->surface_count; i++) {
        const size_t slots = (size_t)call->opts->surfaces[i].groups->count * 2 * sizeof(uint32_t);
        if (slots > most) most = slots;
    }
    return most * (size_t)call->opts->view->width;
}

static iso_status draw_strip(splats_call *call, const iso_view *view, int row, const iso_gbuffer *gbuffer,
                             iso_error *error) {
    iso_gl_engine *engine = call->engine;
    const size_t samples = (size_t)view->width * (size_t)view->height;
    iso_gl_engine_ensure_storage(engine, ISO_GL_STORE_PICTURE, samples * call->planes * sizeof(float));
    iso_gl_picture_clear(engine, call->planes, samples);
    iso_gl_timer_begin(&engine->timer, call->gl, ISO_GL_PASS_DRAW);
    iso_status status = ISO_OK;
    for (int i = 0; i < call->opts->surface_count && status == ISO_OK; i++)
        status = draw_surface(call, i, view, error);
    iso_gl_timer_end(&engine->timer, call->gl);
    ISO_TRY(status);
    ISO_TRY(iso_gl_picture_read(engine, call->planes, gbuffer, (size_t)row * (size_t)view->width, samples,
                                &call->room, error));
    iso_gl_timer_read(&engine->timer, call->gl);
    return iso_gl_check(engine->context, error); /* stop when the context is lost */
}

static iso_status draw_strips(splats_call *call, const iso_gbuffer *gbuffer, iso_error *error) {
    const iso_view *whole = call->opts->view;
    const size_t most = call->engine->max_storage, row = row_bytes(call),
                 fit = (most < STORAGE_BYTES ? most : STORAGE_BYTES) / row;
    int rows = fit < (size_t)whole->height ? (int)fit : whole->height;
    if (rows < STRIP_ROWS_LEAST) rows = STRIP_ROWS_LEAST;
    if ((size_t)rows * row > most)
        return iso_fail(
            error, ISO_ERR_LIMIT,
            "%s: splats in a picture %d pixels wide need storage buffers of %zu bytes, and %s has "
            "%zu at most",
            call->engine->context->name, whole->width, (size_t)rows * row, call->engine->context->renderer,
            most);
    for (int y = 0; y < whole->height; y += rows) {
        const iso_view view = iso_view_rows(whole, y, whole->height - y < rows ? whole->height - y : rows);
        ISO_TRY(draw_strip(call, &view, y, gbuffer, error));
    }
    return ISO_OK;
}

static bool has_colors(const iso_gl_draw_groups_opts *opts) {
    for (int i = 0; i < opts->surface_count; i++)
        if (opts->surfaces[i].points.colors) return true;
    return false;
}

iso_status iso_gl_draw_groups(iso_gl_engine *engine, const iso_gl_draw_groups_opts *opts,
                              iso_gbuffer *gbuffer, iso_error *error) {
    assert(opts->view->width == gbuffer->width && opts->view->height == gbuffer->height);
    assert(opts->surface_count >= 0 && opts->surface_count <= ISO_SURFACE_MAX);
    splats_call call = {
        .engine = engine, .gl = engine->context->gl, .opts = opts, .planes = ISO_GL_PICTURE_PLANES};
    if (has_colors(opts)) {
        call.planes++;
        ISO_TRY(iso_gbuffer_add_color(gbuffer, error));
    }
    ISO_TRY(iso_gl_enter(engine->context, error));
    const iso_status status = draw_strips(&call, gbuffer, error);
    iso_banded_discs_free(&call.discs);
    iso_buffer_free(&call.splats);
    iso_buffer_free(&call.room);
    return iso_gl_leave(engine->context, status, error);
}

uint64_t iso_gl_groups_bytes(const iso_gl_engine *engine, int slots, int width, int height) {
    const size_t storage = engine->max_storage < STORAGE_BYTES ? engine->max_storage : STORAGE_BYTES;
    const uint64_t samples = (uint64_t)width * (uint64_t)height, of_slots = (uint64_t)slots * 8,
                   of_picture = (ISO_GL_PICTURE_PLANES + 1) * sizeof(float),
                   most = storage / (of_slots > of_picture ? of_slots : of_picture);
    return (samples < most ? samples : most) * (of_slots + of_picture);
}
