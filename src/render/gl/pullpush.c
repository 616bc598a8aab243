#include "render/gl/pullpush.h"

#include <assert.h>
#include <glad/gl.h>
#include <stddef.h>
#include <string.h>

#include "base/memory.h"
#include "render/gl/output.h"
#include "render/gl/refined.h"
#include "render/gl/shared.h"
#include "render/gl/surface.h"
#include "render/pullpush/setup.h"

enum {
    STRIP_ROWS_LEAST = 64,
    /* Windows of points begin at a multiple of this: bytes that any driver takes as an offset. */
    WINDOW_POINTS = 256
};
/* No storage buffer of the pyramid or the picture need be larger: a larger picture is made in strips. */
static const size_t STORAGE_BYTES = (size_t)256 << 20;

_Static_assert(ISO_GL_LEVELS == ISO_PYRAMID_TOP + 1, "as many levels as there can be");
_Static_assert(offsetof(iso_gl_pullpush, lattice) == 160 && offsetof(iso_gl_pullpush, levels) == 208 &&
                   sizeof(iso_gl_pullpush) == 208 + 16 * ISO_GL_LEVELS,
               "std140 has it like this");
_Static_assert(sizeof(iso_gl_block) == 48, "std430 has it like this");
_Static_assert(WINDOW_POINTS * sizeof(iso_point) % 256 == 0 &&
                   WINDOW_POINTS * sizeof(iso_surfel) % 256 == 0 && WINDOW_POINTS * 3 % 256 == 0,
               "256 is the widest alignment that a driver may ask for");

/* Points of one dispatch, from a multiple of WINDOW_POINTS on, and its blocks. */
typedef struct window {
    size_t first, end;
    uint32_t block, block_end;
} window;

typedef struct frame {
    iso_gl_engine *engine;
    const GladGLContext *gl;
    const iso_gl_pullpush_opts *opts;
    size_t storage; /* bytes that a storage buffer of ours may have */
    size_t planes;  /* of the picture */
    iso_buffer room;
} frame;

/* One surface of a strip. */
typedef struct drawing {
    const frame *frame;
    const iso_gl_surface *shape;
    const iso_view *view;
    iso_projector projector;
    iso_pyramid_shape pyramid;
    iso_point_projection projection;
    iso_gl_pullpush uniforms;
    size_t keys, pixels; /* of the base level; of the levels above 0 */
    bool cull;
} drawing;

/* ---- buffers */

static void need_buffer(const frame *f, iso_gl_storage which, size_t bytes) {
    iso_gl_engine_need(f->engine, which, bytes);
}

static void bind(const frame *f, GLuint slot, iso_gl_storage which) {
    f->gl->BindBufferBase(GL_SHADER_STORAGE_BUFFER, slot, f->engine->storage[which]);
}

static void fill_buffer(const frame *f, iso_gl_storage which, size_t bytes, GLuint value) {
    f->gl->ClearNamedBufferSubData(f->engine->storage[which], GL_R32UI, 0, (GLsizeiptr)bytes, GL_RED_INTEGER,
                                   GL_UNSIGNED_INT, &value);
}

/* ---- what is drawn */

/* Points without colours, where refined was asked for. */
static bool is_refined(const frame *f, const iso_gl_surface *shape) {
    return f->opts->reconstruction == ISO_RECONSTRUCTION_REFINED && !shape->has_colors;
}

static size_t level_pixels(const iso_pyramid_shape *shape, int number) {
    iso_pyramid_level level = iso_pyramid_level_of(shape, number);
    return (size_t)level.width * (size_t)level.height;
}

static size_t pixels_above(const iso_pyramid_shape *shape) {
    size_t pixels = 0;
    for (int l = 1; l <= shape->top; l++) pixels += level_pixels(shape, l);
    return pixels;
}

static void set_floats(float to[4], const float *from, int count) {
    for (int i = 0; i < count; i++) to[i] = from[i];
}

static void set_uniforms(drawing *d, int surface) {
    const iso_pyramid_shape *shape = &d->pyramid;
    const iso_point_projection *p = &d->projection;
    const iso_reconstruction_job job =
        iso_pullpush_job(shape, &d->projector, d->shape->radius, d->frame->opts->reconstruction, !d->cull);
    iso_gl_pullpush *u = &d->uniforms;
    *u = (iso_gl_pullpush){
        .axis = {p->column, p->row, p->near, job.scale},
        .disc = {job.radius, job.low_pass, job.facing, job.edge},
        .ray = {job.ray[0], job.ray[1], job.slope},
        .lattice = {shape->base, shape->rows_before, shape->column, shape->row},
        .picture = {d->view->width, d->view->height, surface},
        .flags = {d->view->orthographic, job.two_sided, d->shape->has_radii, d->shape->has_colors}};
    float *steps[] = {u->step_x, u->step_y, u->step_z}, *normals[] = {u->normal_x, u->normal_y, u->normal_z};
    for (int k = 0; k < 3; k++) {
        set_floats(steps[k], p->step + 3 * k, 3);
        set_floats(normals[k], job.normal + 3 * k, 3);
    }
    set_floats(u->weight, job.weight, 4);
    int next = 0;
    for (int l = 0; l <= shape->top; l++) {
        iso_pyramid_level level = iso_pyramid_level_of(shape, l);
        u->levels[l][0] = level.width;
        u->levels[l][1] = level.height;
        u->levels[l][2] = l > 0 ? next : 0;
        next = l > 0 ? next + level.width * level.height : 0;
    }
}

static void begin(drawing *d, int surface) {
    const frame *f = d->frame;
    d->projection = iso_pullpush_projection(&d->pyramid, &d->projector, &d->shape->transform,
                                            !d->shape->surfels, d->cull);
    set_uniforms(d, surface);
    d->keys = level_pixels(&d->pyramid, d->pyramid.base);
    d->pixels = pixels_above(&d->pyramid);
    need_buffer(f, ISO_GL_STORE_UNIFORMS, sizeof d->uniforms);
    f->gl->NamedBufferSubData(f->engine->storage[ISO_GL_STORE_UNIFORMS], 0, sizeof d->uniforms, &d->uniforms);
    f->gl->BindBufferBase(GL_UNIFORM_BUFFER, ISO_GL_PULLPUSH, f->engine->storage[ISO_GL_STORE_UNIFORMS]);
    need_buffer(f, ISO_GL_STORE_KEYS, d->keys * 2 * sizeof(uint32_t));
    const size_t discs = (d->shape->has_colors ? 2 : d->shape->has_radii) * d->keys * sizeof(uint32_t);
    need_buffer(f, ISO_GL_STORE_DISCS, discs ? discs : sizeof(uint32_t));
    need_buffer(f, ISO_GL_STORE_TINTS, (d->shape->has_colors ? d->pixels : 1) * 4 * sizeof(float));
    for (int which = ISO_GL_STORE_SHADES; which <= ISO_GL_STORE_SHAPES; which++)
        need_buffer(f, (iso_gl_storage)which, d->pixels * 4 * sizeof(float));
    need_buffer(f, ISO_GL_STORE_ENDS, d->pixels * sizeof(uint32_t));
    fill_buffer(f, ISO_GL_STORE_KEYS, d->keys * 2 * sizeof(uint32_t), ISO_GL_KEY_NONE);
    if (discs) fill_buffer(f, ISO_GL_STORE_DISCS, discs, ISO_GL_KEY_NONE);
}

/* ---- points to keys */

static bool is_wanted(const drawing *d, const iso_point_block *block) {
    double first = d->pyramid.row - d->view->cy; /* from the optical axis */
    return block->seen && !(d->cull && block->averted) && block->row[1] >= first &&
           block->row[0] < first + d->pyramid.height;
}

static iso_gl_block describe(const drawing *d, const iso_point_block *block, size_t first) {
    const iso_point_projection *p = &d->projection;
    iso_gl_block to = {.part = {(unsigned)first, block->count, d->cull && !block->facing}};
    double corner[3];
    for (int k = 0; k < 3; k++) corner[k] = block->brick[k] * (double)ISO_BRICK + p->low;
    for (int k = 0; k < 3; k++) {
        const double *m = p->matrix + 3 * k;
        to.origin[k] = (float)(m[0] * corner[0] + m[1] * corner[1] + m[2] * corner[2] + p->origin[k]);
        to.eye[k] = (float)(p->orthographic ? p->eye[k] : (p->eye[k] - corner[k]) * p->per_voxel);
    }
    return to;
}

/* The blocks that are drawn, and windows of points which hold them and are no larger than what can be bound.
 */
static size_t gather(const drawing *d, iso_gl_block *to, window *windows, size_t most_points) {
    const iso_point_blocks *blocks = d->shape->blocks;
    const iso_point_block *block = blocks->blocks.data;
    const iso_gl_span *spans = d->shape->spans.data;
    size_t count = 0;
    uint32_t seen = 0;
    for (size_t i = 0; i < blocks->count; i++) {
        if (!is_wanted(d, &block[i])) continue;
        size_t first = spans[block[i].span].first + block[i].first, end = first + block[i].count;
        window *last = count ? &windows[count - 1] : NULL;
        if (!last || first < last->first || end > last->first + most_points) {
            last = &windows[count++];
            *last = (window){first - first % WINDOW_POINTS, end, seen, seen};
        }
        to[seen++] = describe(d, &block[i], first - last->first);
        last->block_end = seen;
        if (end > last->end) last->end = end;
    }
    return count;
}

static void bind_window(const drawing *d, const window *w) {
    const GladGLContext *gl = d->frame->gl;
    size_t item = d->shape->surfels ? sizeof(iso_surfel) : sizeof(iso_point), count = w->end - w->first;
    gl->BindBufferRange(GL_SHADER_STORAGE_BUFFER, ISO_GL_POINTS, d->shape->vertices.name,
                        (GLintptr)(w->first * item), (GLsizeiptr)(count * item));
    if (d->shape->has_radii)
        gl->BindBufferRange(GL_SHADER_STORAGE_BUFFER, ISO_GL_RADII, d->shape->radii.name,
                            (GLintptr)(w->first * sizeof(float)), (GLsizeiptr)(count * sizeof(float)));
    if (d->shape->has_colors)
        gl->BindBufferRange(GL_SHADER_STORAGE_BUFFER, ISO_GL_PAINTS, d->shape->colors.name,
                            (GLintptr)(w->first * 3), (GLsizeiptr)((count * 3 + 3) / 4 * 4));
}

static iso_status project(const drawing *d, int kind, const window *windows, size_t count, iso_error *error) {
    enum { GROUPS = 32768 }; /* in a row: every driver has more */
    const GladGLContext *gl = d->frame->gl;
    unsigned program;
    int first = d->shape->surfels ? ISO_GL_PROJECT_SURFELS : ISO_GL_PROJECT_DEPTHS;
    ISO_TRY(iso_gl_engine_program(d->frame->engine, (iso_gl_program)(first + kind), &program, error));
    gl->UseProgram(program);
    for (size_t i = 0; i < count; i++) {
        const window *w = &windows[i];
        uint32_t blocks = w->block_end - w->block;
        bind_window(d, w);
        gl->Uniform2ui(ISO_GL_FIRST, w->block, w->block_end);
        gl->DispatchCompute(blocks < GROUPS ? blocks : GROUPS, (blocks + GROUPS - 1) / GROUPS, 1);
    }
    gl->MemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
    return ISO_OK;
}

static iso_status project_all(const drawing *d, iso_buffer *room, iso_error *error) {
    const frame *f = d->frame;
    size_t blocks = d->shape->blocks->count, bytes = blocks * sizeof(iso_gl_block);
    size_t item = d->shape->surfels ? sizeof(iso_surfel) : sizeof(iso_point);
    ISO_TRY(iso_buffer_reserve(room, bytes + blocks * sizeof(window), 0, error));
    window *windows = (window *)((char *)room->data + bytes);
    size_t count = gather(d, room->data, windows, f->engine->max_storage / item);
    if (!count) return ISO_OK;
    size_t used = windows[count - 1].block_end * sizeof(iso_gl_block);
    need_buffer(f, ISO_GL_STORE_BLOCKS, used);
    f->gl->NamedBufferSubData(f->engine->storage[ISO_GL_STORE_BLOCKS], 0, (GLsizeiptr)used, room->data);
    bind(f, ISO_GL_BLOCKS, ISO_GL_STORE_BLOCKS);
    bind(f, ISO_GL_KEYS, ISO_GL_STORE_KEYS);
    bind(f, ISO_GL_DISCS, ISO_GL_STORE_DISCS);
    if (f->engine->wide_atomics) {
        ISO_TRY(project(d, ISO_GL_PROJECT_KEYS - ISO_GL_PROJECT_DEPTHS, windows, count, error));
    } else {
        ISO_TRY(project(d, 0, windows, count, error));
        ISO_TRY(project(d, ISO_GL_PROJECT_PAYLOADS - ISO_GL_PROJECT_DEPTHS, windows, count, error));
    }
    if (!d->shape->has_radii && !d->shape->has_colors) return ISO_OK;
    return project(d, ISO_GL_PROJECT_DISCS - ISO_GL_PROJECT_DEPTHS, windows, count, error);
}

/* ---- pull and push */

/* Runs a program over a level (or, 0, over the picture). */
static iso_status run(const drawing *d, iso_gl_program program, int level, iso_error *error) {
    const GladGLContext *gl = d->frame->gl;
    const int *size = level ? d->uniforms.levels[level] : d->uniforms.picture;
    unsigned name;
    if (d->shape->has_colors) program = (iso_gl_program)(program + ISO_GL_COLORED - ISO_GL_PULL_LEVEL);
    ISO_TRY(iso_gl_engine_program(d->frame->engine, program, &name, error));
    gl->UseProgram(name);
    if (level) gl->Uniform1i(ISO_GL_LEVEL, level);
    gl->DispatchCompute((GLuint)(size[0] + ISO_GL_TILE - 1) / ISO_GL_TILE,
                        (GLuint)(size[1] + ISO_GL_TILE - 1) / ISO_GL_TILE, 1);
    gl->MemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
    return ISO_OK;
}

static iso_status pull(const drawing *d, iso_error *error) {
    const iso_pyramid_shape *shape = &d->pyramid;
    if (shape->base > 0) ISO_TRY(run(d, ISO_GL_UNPACK, shape->base, error));
    for (int level = shape->base + 1; level <= shape->top; level++)
        ISO_TRY(run(d, level == 1 ? ISO_GL_PULL_KEYS : ISO_GL_PULL_LEVEL, level, error));
    return ISO_OK;
}

static iso_status push(const drawing *d, iso_error *error) {
    for (int level = d->pyramid.top - 1; level >= 1; level--) ISO_TRY(run(d, ISO_GL_PUSH, level, error));
    return ISO_OK;
}

static iso_status reconstruct(const drawing *d, iso_buffer *room, iso_error *error) {
    const frame *f = d->frame;
    iso_gl_timer *timer = &f->engine->timer;
    iso_gl_timer_begin(timer, f->gl, ISO_GL_PASS_PROJECT);
    iso_status status = project_all(d, room, error);
    iso_gl_timer_end(timer, f->gl);
    ISO_TRY(status);
    bind(f, ISO_GL_SHADES, ISO_GL_STORE_SHADES);
    bind(f, ISO_GL_RANGES, ISO_GL_STORE_RANGES);
    bind(f, ISO_GL_SHAPES, ISO_GL_STORE_SHAPES);
    bind(f, ISO_GL_ENDS, ISO_GL_STORE_ENDS);
    bind(f, ISO_GL_TINTS, ISO_GL_STORE_TINTS);
    bind(f, ISO_GL_PICTURE, ISO_GL_STORE_PICTURE);
    iso_gl_timer_begin(timer, f->gl, ISO_GL_PASS_PULL);
    status = pull(d, error);
    iso_gl_timer_end(timer, f->gl);
    ISO_TRY(status);
    iso_gl_timer_begin(timer, f->gl, ISO_GL_PASS_PUSH);
    status = push(d, error);
    iso_gl_timer_end(timer, f->gl);
    ISO_TRY(status);
    iso_gl_timer_begin(timer, f->gl, ISO_GL_PASS_FINISH);
    status = run(d, ISO_GL_FINISH, 0, error);
    iso_gl_timer_end(timer, f->gl);
    return status;
}

/* ---- the picture */

static void clear_picture(const frame *f, size_t samples) {
    const float far = INFINITY;
    const GLuint none = ISO_SURFACE_NONE;
    const size_t plane = samples * sizeof(float);
    GLuint picture = f->engine->storage[ISO_GL_STORE_PICTURE];
    fill_buffer(f, ISO_GL_STORE_PICTURE, f->planes * plane, 0);
    f->gl->ClearNamedBufferSubData(picture, GL_R32F, 0, (GLsizeiptr)plane, GL_RED, GL_FLOAT, &far);
    f->gl->ClearNamedBufferSubData(picture, GL_R32UI, (GLintptr)(4 * plane), (GLsizeiptr)plane,
                                   GL_RED_INTEGER, GL_UNSIGNED_INT, &none);
}

static iso_status read_picture(frame *f, const iso_gbuffer *to, size_t start, size_t samples,
                               iso_error *error) {
    const GladGLContext *gl = f->gl;
    const size_t bytes = samples * sizeof(float);
    float *planes[4] = {to->depth, to->normal[0], to->normal[1], to->normal[2]};
    GLuint picture = f->engine->storage[ISO_GL_STORE_PICTURE];
    ISO_TRY(iso_buffer_reserve(&f->room, bytes, 0, error));
    gl->MemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    for (int k = 0; k < 4; k++)
        gl->GetNamedBufferSubData(picture, (GLintptr)((size_t)k * bytes), (GLsizeiptr)bytes,
                                  planes[k] + start);
    gl->GetNamedBufferSubData(picture, (GLintptr)(4 * bytes), (GLsizeiptr)bytes, f->room.data);
    const uint32_t *surfaces = f->room.data;
    for (size_t i = 0; i < samples; i++) to->surface[start + i] = (uint8_t)surfaces[i];
    if (f->planes > ISO_GL_PICTURE_PLANES)
        gl->GetNamedBufferSubData(picture, (GLintptr)(5 * bytes), (GLsizeiptr)bytes, to->color + start);
    return ISO_OK;
}

static drawing drawing_of(const frame *f, int number, const iso_view *view) {
    const iso_gl_surface *shape = f->opts->shapes[number];
    const iso_point_blocks *blocks = shape->blocks;
    return (drawing){.frame = f,
                     .shape = shape,
                     .view = view,
                     .projector = iso_projector_make(view, &shape->transform),
                     .pyramid = iso_pullpush_shape(view, blocks->radius),
                     .cull = shape->closed && !blocks->around_eye};
}

static iso_status draw_strip(frame *f, const iso_view *view, int row, const iso_gl_output *to,
                             iso_error *error) {
    const size_t samples = (size_t)view->width * (size_t)view->height;
    need_buffer(f, ISO_GL_STORE_PICTURE, samples * f->planes * sizeof(float));
    clear_picture(f, samples);
    for (int i = 0; i < f->opts->shape_count; i++) {
        const iso_gl_surface *shape = f->opts->shapes[i];
        if (shape->blocks->seen == 0) continue;
        if (is_refined(f, shape)) {
            ISO_TRY(iso_gl_draw_refined(shape, view, i, &f->room, error));
            continue;
        }
        drawing d = drawing_of(f, i, view);
        begin(&d, i);
        ISO_TRY(reconstruct(&d, &f->room, error));
    }
    if (to->gbuffer)
        ISO_TRY(read_picture(f, to->gbuffer, (size_t)row * (size_t)view->width, samples, error));
    else
        ISO_TRY(iso_gl_canvas_shade(to, true, view, 0, row, error));
    iso_gl_timer_read(&f->engine->timer, f->gl);
    return ISO_OK;
}

/* The largest storage buffer that a strip of so many rows needs. */
static size_t strip_bytes(const frame *f, int rows) {
    const iso_view view = iso_view_rows(f->opts->view, 0, rows);
    size_t most = (size_t)view.width * (size_t)view.height * f->planes * sizeof(float);
    for (int i = 0; i < f->opts->shape_count; i++) {
        const iso_gl_surface *shape = f->opts->shapes[i];
        if (shape->blocks->seen == 0 || is_refined(f, shape)) continue;
        const drawing d = drawing_of(f, i, &view);
        const size_t keys = level_pixels(&d.pyramid, d.pyramid.base) * 2 * sizeof(uint32_t);
        const size_t pixels = pixels_above(&d.pyramid) * 4 * sizeof(float);
        if (keys > most) most = keys;
        if (pixels > most) most = pixels;
    }
    return most;
}

static iso_status draw_strips(frame *f, const iso_gl_output *to, iso_error *error) {
    const iso_view *whole = f->opts->view;
    int rows = whole->height, factor = iso_gl_output_factor(to);
    while (rows > STRIP_ROWS_LEAST && strip_bytes(f, rows) > f->storage) {
        rows = (rows + 1) / 2;
        rows += (factor - rows % factor) % factor;
    }
    if (strip_bytes(f, rows) > f->engine->max_storage)
        return iso_fail(
            error, ISO_ERR_LIMIT,
            "%s: pull-push of a picture %d pixels wide needs storage buffers of %zu bytes, and %s "
            "has %zu at most",
            f->engine->context->name, whole->width, strip_bytes(f, rows), f->engine->context->renderer,
            f->engine->max_storage);
    for (int y = 0; y < whole->height; y += rows) {
        iso_view view = iso_view_rows(whole, y, whole->height - y < rows ? whole->height - y : rows);
        ISO_TRY(draw_strip(f, &view, y, to, error));
        ISO_TRY(iso_gl_check(f->engine->context, error)); /* nothing comes after a loss */
    }
    return ISO_OK;
}

/* The same for every strip. */
static iso_status look(const iso_gl_pullpush_opts *opts, iso_error *error) {
    for (int i = 0; i < opts->shape_count; i++) {
        const iso_gl_surface *shape = opts->shapes[i];
        assert(!shape->mesh);
        iso_projector projector = iso_projector_make(opts->view, &shape->transform);
        ISO_TRY(iso_point_blocks_look(shape->blocks, shape->closed, &shape->transform, &projector, error));
    }
    return ISO_OK;
}

static size_t storage_of(const iso_gl_engine *engine) {
    return engine->max_storage < STORAGE_BYTES ? engine->max_storage : STORAGE_BYTES;
}

uint64_t iso_gl_pullpush_bytes(const iso_gl_engine *engine, iso_reconstruction reconstruction, int width,
                               int height) {
    enum {
        PICTURE = (ISO_GL_PICTURE_PLANES + 1) * sizeof(float),
        BASE = (2 + 2) * sizeof(uint32_t),                /* keys; radii and colours */
        ABOVE = 4 * 4 * sizeof(float) + sizeof(uint32_t), /* shades, ranges, shapes, tints; ends */
        SAMPLE = PICTURE + BASE + (ABOVE + 2) / 3         /* of levels above 0: a third of a pixel */
    };
    const uint64_t samples = (uint64_t)width * (uint64_t)height, most = storage_of(engine) / PICTURE;
    if (reconstruction == ISO_RECONSTRUCTION_REFINED)
        return (samples < most ? samples : most) * PICTURE + iso_gl_discs_bytes(samples);
    return (samples < most ? samples : most) * SAMPLE;
}

static bool has_colors(const iso_gl_pullpush_opts *opts) {
    for (int i = 0; i < opts->shape_count; i++)
        if (opts->shapes[i]->has_colors) return true;
    return false;
}

iso_status iso_gl_draw_pullpush_to(iso_gl_engine *engine, const iso_gl_pullpush_opts *opts,
                                   const iso_gl_output *to, iso_error *error) {
    assert(opts->shape_count >= 0 && opts->shape_count <= ISO_SURFACE_MAX);
    ISO_TRY(look(opts, error));
    frame f = {.engine = engine, .gl = engine->context->gl, .opts = opts, .planes = ISO_GL_PICTURE_PLANES};
    if (has_colors(opts)) {
        f.planes++;
        if (to->gbuffer) ISO_TRY(iso_gbuffer_add_color(to->gbuffer, error));
    }
    ISO_TRY(iso_gl_enter(engine->context, error));
    f.storage = storage_of(engine);
    iso_status status = draw_strips(&f, to, error);
    iso_buffer_free(&f.room);
    return iso_gl_leave(engine->context, status, error);
}

iso_status iso_gl_draw_pullpush(iso_gl_engine *engine, const iso_gl_pullpush_opts *opts, iso_gbuffer *gbuffer,
                                iso_error *error) {
    assert(opts->view->width == gbuffer->width && opts->view->height == gbuffer->height);
    return iso_gl_draw_pullpush_to(engine, opts, &(iso_gl_output){.gbuffer = gbuffer}, error);
}
