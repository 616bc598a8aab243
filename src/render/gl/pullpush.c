/* pullpush: the picture lies in a storage buffer, strip by strip. Each surface is projected to keys,
 * pulled and pushed through the pyramid by compute shaders, and merged into the picture. Same steps as
 * render/pullpush. */
#include "render/gl/pullpush.h"

#include <assert.h>
#include <glad/gl.h>
#include <stddef.h>
#include <string.h>

#include "base/memory.h"
#include "render/gl/discs.h"
#include "render/gl/hybrid.h"
#include "render/gl/output.h"
#include "render/gl/picture.h"
#include "render/gl/shared.h"
#include "render/gl/surface.h"
#include "render/pullpush/setup.h"

enum {
    STRIP_ROWS_LEAST = 64,
    /* A range of points bound as a buffer begins at a multiple of this: an offset that every driver
     * accepts. */
    RANGE_POINTS = 256
};
/* Limit of the storage buffers of the pyramid and the picture; a larger picture is drawn in strips. */
static const size_t STORAGE_BYTES = (size_t)256 << 20;

_Static_assert(ISO_GL_LEVELS == ISO_PYRAMID_TOP + 1, "room for all levels");
_Static_assert(offsetof(iso_gl_pullpush_uniforms, lattice) == 192 &&
                   offsetof(iso_gl_pullpush_uniforms, levels) == 240 &&
                   sizeof(iso_gl_pullpush_uniforms) == 240 + 16 * ISO_GL_LEVELS,
               "layout of std140");
_Static_assert(sizeof(iso_gl_point_block) == 48, "layout of std430");
_Static_assert(RANGE_POINTS * sizeof(iso_point) % 256 == 0 && RANGE_POINTS * sizeof(iso_surfel) % 256 == 0 &&
                   RANGE_POINTS * 3 % 256 == 0,
               "256 is the widest alignment that a driver may ask for");

/* Points and blocks of one dispatch; `first` is a multiple of RANGE_POINTS. */
typedef struct point_range {
    size_t first, end;
    uint32_t block, block_end;
} point_range;

/* The drawing of a picture. */
typedef struct pullpush_call {
    iso_gl_engine *engine;
    const GladGLContext *gl;
    const iso_gl_pullpush_opts *opts;
    size_t storage;                    /* limit of a storage buffer, bytes */
    size_t planes;                     /* of the picture */
    int first;                         /* surface number of the first surface */
    bool over;                         /* the gbuffer holds a picture that is drawn over */
    const iso_gl_triangles *triangles; /* of the only surface, if it is hybrid; else NULL */
    uint8_t order[ISO_SURFACE_MAX];    /* in which surfaces are drawn */
    iso_buffer room;
} pullpush_call;

/* The drawing of one surface in one strip. */
typedef struct pullpush_draw {
    const pullpush_call *call;
    const iso_gl_surface *surface;
    const iso_view *view;
    iso_projector projector;
    iso_pyramid_layout pyramid;
    iso_point_projection projection;
    iso_gl_pullpush_uniforms uniforms;
    size_t keys, pixels; /* pixels of the base level; pixels of all levels above 0 */
    bool cull;
} pullpush_draw;

/* ---- buffers */

static void ensure_storage(const pullpush_call *call, iso_gl_storage which, size_t bytes) {
    iso_gl_engine_ensure_storage(call->engine, which, bytes);
}

static void bind_storage(const pullpush_call *call, GLuint slot, iso_gl_storage which) {
    call->gl->BindBufferBase(GL_SHADER_STORAGE_BUFFER, slot, call->engine->storage[which]);
}

static void fill_buffer(const pullpush_call *call, iso_gl_storage which, size_t bytes, GLuint value) {
    call->gl->ClearNamedBufferSubData(call->engine->storage[which], GL_R32UI, 0, (GLsizeiptr)bytes,
                                      GL_RED_INTEGER, GL_UNSIGNED_INT, &value);
}

/* ---- uniforms and buffers of one surface */

/* Whether surfaces are drawn as discs, without a pyramid. */
static bool draws_discs(iso_reconstruction reconstruction) {
    return reconstruction == ISO_RECONSTRUCTION_CURVED || reconstruction == ISO_RECONSTRUCTION_FLAT ||
           reconstruction == ISO_RECONSTRUCTION_EWA;
}

static size_t level_pixels(const iso_pyramid_layout *layout, int number) {
    iso_pyramid_level level = iso_pyramid_level_of(layout, number);
    return (size_t)level.width * (size_t)level.height;
}

static size_t pixels_above(const iso_pyramid_layout *layout) {
    size_t pixels = 0;
    for (int l = 1; l <= layout->top; l++) pixels += level_pixels(layout, l);
    return pixels;
}

static void set_floats(float to[4], const float *from, int count) {
    for (int i = 0; i < count; i++) to[i] = from[i];
}

static void set_uniforms(pullpush_draw *d, int surface) {
    const iso_pyramid_layout *layout = &d->pyramid;
    const iso_point_projection *p = &d->projection;
    const iso_pullpush_params params = iso_pullpush_params_make(
        layout, &d->projector, d->surface->radius, d->surface->dims, d->call->opts->reconstruction, !d->cull);
    iso_gl_pullpush_uniforms *u = &d->uniforms;
    *u = (iso_gl_pullpush_uniforms){
        .axis = {p->column, p->row, p->near, params.scale},
        .disc = {params.radius, params.low_pass, params.facing, params.edge},
        .ray = {params.ray[0], params.ray[1], params.slope},
        .lattice = {layout->base, layout->rows_before, layout->column, layout->row},
        .picture = {d->view->width, d->view->height, d->call->first + surface},
        .flags = {d->view->orthographic, params.kind == ISO_PULLPUSH_TWO_SIDED, d->surface->has_radii,
                  d->surface->has_colors}};
    float *steps[] = {u->step_x, u->step_y, u->step_z}, *normals[] = {u->normal_x, u->normal_y, u->normal_z};
    for (int k = 0; k < 3; k++) {
        set_floats(steps[k], p->step + 3 * k, 3);
        set_floats(normals[k], params.normal + 3 * k, 3);
    }
    set_floats(u->weight, params.weight, 4);
    set_floats(u->border, params.border, 3);
    set_floats(u->eye, params.eye, 3);
    u->border[3] = params.has_border;
    int next = 0;
    for (int l = 0; l <= layout->top; l++) {
        iso_pyramid_level level = iso_pyramid_level_of(layout, l);
        u->levels[l][0] = level.width;
        u->levels[l][1] = level.height;
        u->levels[l][2] = l > 0 ? next : 0;
        next = l > 0 ? next + level.width * level.height : 0;
    }
}

/* Uploads the uniforms of one surface and prepares its buffers. */
static void begin_surface(pullpush_draw *d, int surface) {
    const pullpush_call *call = d->call;
    /* the buffers that are written below may still be used by the shaders of the surface before */
    call->gl->MemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    d->projection = iso_pullpush_projection(&d->pyramid, &d->projector, &d->surface->transform,
                                            !d->surface->surfels, d->cull);
    set_uniforms(d, surface);
    d->keys = level_pixels(&d->pyramid, d->pyramid.base);
    d->pixels = pixels_above(&d->pyramid);
    ensure_storage(call, ISO_GL_STORE_UNIFORMS, sizeof d->uniforms);
    call->gl->NamedBufferSubData(call->engine->storage[ISO_GL_STORE_UNIFORMS], 0, sizeof d->uniforms,
                                 &d->uniforms);
    call->gl->BindBufferBase(GL_UNIFORM_BUFFER, ISO_GL_PULLPUSH,
                             call->engine->storage[ISO_GL_STORE_UNIFORMS]);
    ensure_storage(call, ISO_GL_STORE_KEYS, d->keys * 2 * sizeof(uint32_t));
    const size_t discs = (d->surface->has_colors ? 2 : d->surface->has_radii) * d->keys * sizeof(uint32_t);
    ensure_storage(call, ISO_GL_STORE_DISCS, discs ? discs : sizeof(uint32_t));
    ensure_storage(call, ISO_GL_STORE_TINTS, (d->surface->has_colors ? d->pixels : 1) * 4 * sizeof(float));
    for (int which = ISO_GL_STORE_SHADES; which <= ISO_GL_STORE_ELLIPSES; which++)
        ensure_storage(call, (iso_gl_storage)which, d->pixels * 4 * sizeof(float));
    ensure_storage(call, ISO_GL_STORE_REACHES, d->pixels * sizeof(uint32_t));
    fill_buffer(call, ISO_GL_STORE_KEYS, d->keys * 2 * sizeof(uint32_t), ISO_GL_KEY_NONE);
    if (discs) fill_buffer(call, ISO_GL_STORE_DISCS, discs, ISO_GL_KEY_NONE);
}

/* ---- points to keys */

/* Whether points of a block may lie in the rows of the pyramid. */
static bool is_wanted(const pullpush_draw *d, const iso_point_block *block) {
    double first = d->pyramid.row - d->view->cy; /* first row, counted from the optical axis */
    return block->seen && !(d->cull && block->back_facing) && block->row[1] >= first &&
           block->row[0] < first + d->pyramid.height;
}

static iso_gl_point_block describe_block(const pullpush_draw *d, const iso_point_block *block, size_t first) {
    const iso_point_projection *p = &d->projection;
    iso_gl_point_block to = {.part = {(unsigned)first, block->count, d->cull && !block->front_facing}};
    double corner[3];
    for (int k = 0; k < 3; k++) corner[k] = block->brick[k] * (double)ISO_BRICK + p->low;
    for (int k = 0; k < 3; k++) {
        const double *m = p->matrix + 3 * k;
        to.origin[k] = (float)(m[0] * corner[0] + m[1] * corner[1] + m[2] * corner[2] + p->origin[k]);
        to.eye[k] = (float)(p->orthographic ? p->eye[k] : (p->eye[k] - corner[k]) * p->per_voxel);
    }
    return to;
}

/* Lists the visible blocks, and ranges of points that contain them and can be bound as one buffer each;
 * returns the number of ranges. */
static size_t gather_blocks(const pullpush_draw *d, iso_gl_point_block *to, point_range *ranges,
                            size_t most_points) {
    const iso_point_blocks *blocks = d->surface->blocks;
    const iso_point_block *block = blocks->blocks.data;
    const iso_gl_span *spans = d->surface->spans.data;
    size_t count = 0;
    uint32_t seen = 0;
    for (size_t i = 0; i < blocks->count; i++) {
        if (!is_wanted(d, &block[i])) continue;
        size_t first = spans[block[i].span].first + block[i].first, end = first + block[i].count;
        point_range *last = count ? &ranges[count - 1] : NULL;
        if (!last || first < last->first || end > last->first + most_points) {
            last = &ranges[count++];
            *last = (point_range){first - first % RANGE_POINTS, end, seen, seen};
        }
        to[seen++] = describe_block(d, &block[i], first - last->first);
        last->block_end = seen;
        if (end > last->end) last->end = end;
    }
    return count;
}

/* Binds a range of points, with their radii and colours. */
static void bind_range(const pullpush_draw *d, const point_range *w) {
    const GladGLContext *gl = d->call->gl;
    size_t item = d->surface->surfels ? sizeof(iso_surfel) : sizeof(iso_point), count = w->end - w->first;
    gl->BindBufferRange(GL_SHADER_STORAGE_BUFFER, ISO_GL_POINTS, d->surface->vertices.name,
                        (GLintptr)(w->first * item), (GLsizeiptr)(count * item));
    if (d->surface->has_radii)
        gl->BindBufferRange(GL_SHADER_STORAGE_BUFFER, ISO_GL_RADII, d->surface->radii.name,
                            (GLintptr)(w->first * sizeof(float)), (GLsizeiptr)(count * sizeof(float)));
    if (d->surface->has_colors)
        gl->BindBufferRange(GL_SHADER_STORAGE_BUFFER, ISO_GL_PAINTS, d->surface->colors.name,
                            (GLintptr)(w->first * 3), (GLsizeiptr)((count * 3 + 3) / 4 * 4));
}

/* Runs the projection of `kind` (KIND of pullpush_project.comp) over all ranges. */
static iso_status dispatch_projection(const pullpush_draw *d, int kind, const point_range *ranges,
                                      size_t count, iso_error *error) {
    enum { GROUPS = 32768 }; /* work groups in x; every driver allows more */
    const GladGLContext *gl = d->call->gl;
    unsigned program;
    int first = d->surface->surfels ? ISO_GL_PROJECT_SURFELS : ISO_GL_PROJECT_DEPTHS;
    ISO_TRY(iso_gl_engine_program(d->call->engine, (iso_gl_program)(first + kind), &program, error));
    gl->UseProgram(program);
    for (size_t i = 0; i < count; i++) {
        const point_range *w = &ranges[i];
        uint32_t blocks = w->block_end - w->block;
        bind_range(d, w);
        gl->Uniform2ui(ISO_GL_FIRST, w->block, w->block_end);
        gl->DispatchCompute(blocks < GROUPS ? blocks : GROUPS, (blocks + GROUPS - 1) / GROUPS, 1);
    }
    gl->MemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
    return ISO_OK;
}

/* Projects the points of a surface to keys, in as many passes as the driver needs. */
static iso_status project_points(const pullpush_draw *d, iso_buffer *room, iso_error *error) {
    const pullpush_call *call = d->call;
    size_t blocks = d->surface->blocks->count, bytes = blocks * sizeof(iso_gl_point_block);
    size_t item = d->surface->surfels ? sizeof(iso_surfel) : sizeof(iso_point);
    ISO_TRY(iso_buffer_reserve(room, bytes + blocks * sizeof(point_range), 0, error));
    point_range *ranges = (point_range *)((char *)room->data + bytes);
    size_t count = gather_blocks(d, room->data, ranges, call->engine->max_storage / item);
    if (!count) return ISO_OK;
    size_t used = ranges[count - 1].block_end * sizeof(iso_gl_point_block);
    ensure_storage(call, ISO_GL_STORE_BLOCKS, used);
    call->gl->NamedBufferSubData(call->engine->storage[ISO_GL_STORE_BLOCKS], 0, (GLsizeiptr)used, room->data);
    bind_storage(call, ISO_GL_BLOCKS, ISO_GL_STORE_BLOCKS);
    bind_storage(call, ISO_GL_KEYS, ISO_GL_STORE_KEYS);
    bind_storage(call, ISO_GL_DISCS, ISO_GL_STORE_DISCS);
    if (call->engine->wide_atomics) {
        ISO_TRY(dispatch_projection(d, ISO_GL_PROJECT_KEYS - ISO_GL_PROJECT_DEPTHS, ranges, count, error));
    } else {
        ISO_TRY(dispatch_projection(d, 0, ranges, count, error));
        ISO_TRY(
            dispatch_projection(d, ISO_GL_PROJECT_PAYLOADS - ISO_GL_PROJECT_DEPTHS, ranges, count, error));
    }
    if (!d->surface->has_radii && !d->surface->has_colors) return ISO_OK;
    return dispatch_projection(d, ISO_GL_PROJECT_DISCS - ISO_GL_PROJECT_DEPTHS, ranges, count, error);
}

/* ---- pull and push */

/* Dispatches a program over a level of the pyramid, or with level 0 over the picture. */
static iso_status dispatch_level(const pullpush_draw *d, iso_gl_program program, int level,
                                 iso_error *error) {
    const GladGLContext *gl = d->call->gl;
    const int *size = level ? d->uniforms.levels[level] : d->uniforms.picture;
    unsigned name;
    if (d->surface->has_colors) program = (iso_gl_program)(program + ISO_GL_COLORED - ISO_GL_PULL_LEVEL);
    ISO_TRY(iso_gl_engine_program(d->call->engine, program, &name, error));
    gl->UseProgram(name);
    if (level) gl->Uniform1i(ISO_GL_LEVEL, level);
    gl->DispatchCompute((GLuint)(size[0] + ISO_GL_TILE - 1) / ISO_GL_TILE,
                        (GLuint)(size[1] + ISO_GL_TILE - 1) / ISO_GL_TILE, 1);
    gl->MemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
    return ISO_OK;
}

static iso_status pull_levels(const pullpush_draw *d, iso_error *error) {
    const iso_pyramid_layout *layout = &d->pyramid;
    if (layout->base > 0) ISO_TRY(dispatch_level(d, ISO_GL_UNPACK, layout->base, error));
    for (int level = layout->base + 1; level <= layout->top; level++)
        ISO_TRY(dispatch_level(d, level == 1 ? ISO_GL_PULL_KEYS : ISO_GL_PULL_LEVEL, level, error));
    return ISO_OK;
}

static iso_status push_levels(const pullpush_draw *d, iso_error *error) {
    for (int level = d->pyramid.top - 1; level >= 1; level--)
        ISO_TRY(dispatch_level(d, ISO_GL_PUSH, level, error));
    return ISO_OK;
}

static iso_status reconstruct_surface(const pullpush_draw *d, iso_buffer *room, iso_error *error) {
    const pullpush_call *call = d->call;
    iso_gl_timer *timer = &call->engine->timer;
    iso_gl_timer_begin(timer, call->gl, ISO_GL_PASS_PROJECT);
    iso_status status = project_points(d, room, error);
    iso_gl_timer_end(timer, call->gl);
    ISO_TRY(status);
    if (call->triangles)
        ISO_TRY(iso_gl_triangles_add(call->engine, call->triangles, d->view, &d->pyramid, error));
    bind_storage(call, ISO_GL_SHADES, ISO_GL_STORE_SHADES);
    bind_storage(call, ISO_GL_RANGES, ISO_GL_STORE_RANGES);
    bind_storage(call, ISO_GL_ELLIPSES, ISO_GL_STORE_ELLIPSES);
    bind_storage(call, ISO_GL_REACHES, ISO_GL_STORE_REACHES);
    bind_storage(call, ISO_GL_TINTS, ISO_GL_STORE_TINTS);
    bind_storage(call, ISO_GL_PICTURE, ISO_GL_STORE_PICTURE);
    iso_gl_timer_begin(timer, call->gl, ISO_GL_PASS_PULL);
    status = pull_levels(d, error);
    iso_gl_timer_end(timer, call->gl);
    ISO_TRY(status);
    iso_gl_timer_begin(timer, call->gl, ISO_GL_PASS_PUSH);
    status = push_levels(d, error);
    iso_gl_timer_end(timer, call->gl);
    ISO_TRY(status);
    iso_gl_timer_begin(timer, call->gl, ISO_GL_PASS_FINISH);
    status = dispatch_level(d, ISO_GL_FINISH, 0, error);
    iso_gl_timer_end(timer, call->gl);
    if (!call->triangles || status != ISO_OK) return status;
    return iso_gl_triangles_finish(call->engine, d->view, error);
}

/* ---- the picture */

static pullpush_draw draw_of(const pullpush_call *call, int number, const iso_view *view) {
    const iso_gl_surface *surface = call->opts->surfaces[number];
    const iso_point_blocks *blocks = surface->blocks;
    const float all[2] = {0, blocks->radius[1]}; /* triangles need the picture's resolution */
    return (pullpush_draw){.call = call,
                           .surface = surface,
                           .view = view,
                           .projector = iso_projector_make(view, &surface->transform),
                           .pyramid = iso_pullpush_layout(view, call->triangles ? all : blocks->radius),
                           .cull = surface->closed && !blocks->around_eye};
}

/* View space z of the surface's nearest point. */
static float nearest_depth(const iso_gl_surface *surface) {
    const iso_point_block *block = surface->blocks->blocks.data;
    float nearest = INFINITY;
    for (size_t i = 0; i < surface->blocks->count; i++)
        if (block[i].seen) nearest = fminf(nearest, block[i].depth[0]);
    return nearest;
}

/* Sets call->order: surfaces as discs from the nearest on, as what is hidden by those before is left out. */
static void sort_surfaces(pullpush_call *call) {
    const iso_gl_pullpush_opts *opts = call->opts;
    float depth[ISO_SURFACE_MAX];
    for (int i = 0; i < opts->surface_count; i++) {
        const float own = draws_discs(opts->reconstruction) ? nearest_depth(opts->surfaces[i]) : 0;
        int at = i;
        for (; at > 0 && depth[at - 1] > own; at--) {
            depth[at] = depth[at - 1];
            call->order[at] = call->order[at - 1];
        }
        depth[at] = own;
        call->order[at] = (uint8_t)i;
    }
}

static iso_status draw_strip(pullpush_call *call, const iso_view *view, int row, const iso_gl_output *to,
                             iso_error *error) {
    const size_t samples = (size_t)view->width * (size_t)view->height;
    ensure_storage(call, ISO_GL_STORE_PICTURE, samples * call->planes * sizeof(float));
    if (call->over)
        ISO_TRY(iso_gl_picture_write(call->engine, call->planes, to->gbuffer,
                                     (size_t)row * (size_t)view->width, samples, &call->room, error));
    else
        iso_gl_picture_clear(call->engine, call->planes, samples);
    for (int k = 0; k < call->opts->surface_count; k++) {
        const int i = call->order[k];
        const iso_gl_surface *surface = call->opts->surfaces[i];
        if (surface->blocks->seen == 0 && !call->triangles) continue;
        if (draws_discs(call->opts->reconstruction)) {
            const iso_reconstruction how = call->opts->reconstruction;
            const iso_gl_discs_style style = {.flat = how != ISO_RECONSTRUCTION_CURVED,
                                              .widened = how == ISO_RECONSTRUCTION_EWA,
                                              .selection = call->opts->selection};
            ISO_TRY(iso_gl_draw_discs(surface, view, call->first + i, style, NULL, &call->room, error));
            continue;
        }
        pullpush_draw d = draw_of(call, i, view);
        begin_surface(&d, i);
        ISO_TRY(reconstruct_surface(&d, &call->room, error));
    }
    if (to->gbuffer)
        ISO_TRY(iso_gl_picture_read(call->engine, call->planes, to->gbuffer,
                                    (size_t)row * (size_t)view->width, samples, &call->room, error));
    else
        ISO_TRY(iso_gl_canvas_shade(to, true, view, 0, row, error));
    iso_gl_timer_read(&call->engine->timer, call->gl);
    return ISO_OK;
}

/* Bytes of the largest storage buffer that a strip of this many rows needs. */
static size_t strip_bytes(const pullpush_call *call, int rows) {
    const iso_view view = iso_view_rows(call->opts->view, 0, rows);
    size_t most = (size_t)view.width * (size_t)view.height * call->planes * sizeof(float);
    for (int i = 0; i < call->opts->surface_count; i++) {
        const iso_gl_surface *surface = call->opts->surfaces[i];
        if ((surface->blocks->seen == 0 && !call->triangles) || draws_discs(call->opts->reconstruction))
            continue;
        const pullpush_draw d = draw_of(call, i, &view);
        const size_t keys = level_pixels(&d.pyramid, d.pyramid.base) * 2 * sizeof(uint32_t);
        const size_t pixels = pixels_above(&d.pyramid) * 4 * sizeof(float);
        if (keys > most) most = keys;
        if (pixels > most) most = pixels;
    }
    return most;
}

static iso_status draw_strips(pullpush_call *call, const iso_gl_output *to, iso_error *error) {
    const iso_view *whole = call->opts->view;
    int rows = whole->height, factor = iso_gl_output_factor(to);
    while (rows > STRIP_ROWS_LEAST && strip_bytes(call, rows) > call->storage) {
        rows = (rows + 1) / 2;
        rows += (factor - rows % factor) % factor;
    }
    if (strip_bytes(call, rows) > call->engine->max_storage)
        return iso_fail(
            error, ISO_ERR_LIMIT,
            "%s: pull-push of a picture %d pixels wide needs storage buffers of %zu bytes, and %s "
            "has %zu at most",
            call->engine->context->name, whole->width, strip_bytes(call, rows),
            call->engine->context->renderer, call->engine->max_storage);
    for (int y = 0; y < whole->height; y += rows) {
        iso_view view = iso_view_rows(whole, y, whole->height - y < rows ? whole->height - y : rows);
        ISO_TRY(draw_strip(call, &view, y, to, error));
        ISO_TRY(iso_gl_check(call->engine->context, error)); /* stop when the context is lost */
    }
    return ISO_OK;
}

/* Updates the point blocks of all surfaces for the view; the result holds for every strip. */
static iso_status set_views(const iso_gl_pullpush_opts *opts, iso_error *error) {
    for (int i = 0; i < opts->surface_count; i++) {
        const iso_gl_surface *surface = opts->surfaces[i];
        assert(!surface->mesh);
        iso_projector projector = iso_projector_make(opts->view, &surface->transform);
        ISO_TRY(iso_point_blocks_set_view(surface->blocks, surface->closed, &surface->transform, &projector,
                                          error));
    }
    return ISO_OK;
}

/* Limit of a storage buffer, bytes. */
static size_t storage_of(const iso_gl_engine *engine) {
    return engine->max_storage < STORAGE_BYTES ? engine->max_storage : STORAGE_BYTES;
}

uint64_t iso_gl_pullpush_bytes(const iso_gl_engine *engine, iso_reconstruction reconstruction, int width,
                               int height) {
    enum {
        PICTURE = (ISO_GL_PICTURE_PLANES + 1) * sizeof(float),
        BASE = (2 + 2) * sizeof(uint32_t),                /* keys; radii and colours */
        ABOVE = 4 * 4 * sizeof(float) + sizeof(uint32_t), /* shades, ranges, ellipses, tints; reaches */
        SAMPLE = PICTURE + BASE + (ABOVE + 2) / 3         /* the levels above 0 have a third of the pixels */
    };
    const uint64_t samples = (uint64_t)width * (uint64_t)height, most = storage_of(engine) / PICTURE;
    if (draws_discs(reconstruction))
        return (samples < most ? samples : most) * PICTURE + iso_gl_disc_targets_bytes(samples);
    return (samples < most ? samples : most) * SAMPLE;
}

static bool has_colors(const iso_gl_pullpush_opts *opts) {
    for (int i = 0; i < opts->surface_count; i++)
        if (opts->surfaces[i]->has_colors) return true;
    return false;
}

/* `how`: its members first, over and triangles. */
static iso_status draw_picture(iso_gl_engine *engine, const iso_gl_pullpush_opts *opts,
                               const pullpush_call *how, const iso_gl_output *to, iso_error *error) {
    assert(opts->surface_count >= 0 && how->first >= 0 &&
           opts->surface_count <= ISO_SURFACE_MAX - how->first);
    ISO_TRY(set_views(opts, error));
    pullpush_call call = *how;
    call.engine = engine;
    call.gl = engine->context->gl;
    call.opts = opts;
    call.planes = ISO_GL_PICTURE_PLANES;
    if (has_colors(opts)) {
        call.planes++;
        if (to->gbuffer) ISO_TRY(iso_gbuffer_add_color(to->gbuffer, error));
    }
    ISO_TRY(iso_gl_enter(engine->context, error));
    call.storage = storage_of(engine);
    sort_surfaces(&call);
    iso_status status = draw_strips(&call, to, error);
    iso_buffer_free(&call.room);
    return iso_gl_leave(engine->context, status, error);
}

iso_status iso_gl_draw_pullpush_to(iso_gl_engine *engine, const iso_gl_pullpush_opts *opts,
                                   const iso_gl_output *to, iso_error *error) {
    return draw_picture(engine, opts, &(pullpush_call){.first = 0}, to, error);
}

iso_status iso_gl_draw_pullpush_over(iso_gl_engine *engine, const iso_gl_pullpush_opts *opts, int first,
                                     const iso_gl_triangles *triangles, iso_gbuffer *gbuffer,
                                     iso_error *error) {
    const pullpush_call how = {.first = first, .over = true, .triangles = triangles};
    return draw_picture(engine, opts, &how, &(iso_gl_output){.gbuffer = gbuffer}, error);
}

iso_status iso_gl_draw_pullpush(iso_gl_engine *engine, const iso_gl_pullpush_opts *opts, iso_gbuffer *gbuffer,
                                iso_error *error) {
    assert(opts->view->width == gbuffer->width && opts->view->height == gbuffer->height);
    return iso_gl_draw_pullpush_to(engine, opts, &(iso_gl_output){.gbuffer = gbuffer}, error);
}
