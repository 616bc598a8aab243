/* discs: three passes for each tile of the picture. Two draw discs as points or quads with blending: the
 * nearest depths (minimum), then weighted sums over the discs that are not much further behind (addition).
 * A compute shader then resolves the sums into samples. Splatting in two passes: Botsch, Hornung, Zwicker
 * and Kobbelt 2005. */
#include "render/gl/discs.h"

#include <glad/gl.h>
#include <math.h>
#include <string.h>

#include "render/discs/discs_numbers.h"
#include "render/discs/setup.h"
#include "render/gl/selection.h"
#include "render/gl/shared.h"

enum {
    SUMS = 4,
    /* Most samples of a tile; larger pictures are drawn tile by tile. */
    SAMPLES_MOST = 1 << 22,
    SAMPLE_BYTES = (1 + SUMS) * 4 * sizeof(float)
};

_Static_assert(offsetof(iso_gl_discs_uniforms, border) == 96 &&
                   offsetof(iso_gl_discs_uniforms, tile) == 160 && sizeof(iso_gl_discs_uniforms) == 208,
               "layout of std140");
_Static_assert(SUMS == (int)ISO_GL_BLENDS, "state.c saves blending of as many outputs as are blended here");

/* ---- textures */

uint64_t iso_gl_disc_targets_bytes(uint64_t samples) {
    return (samples < SAMPLES_MOST ? samples : SAMPLES_MOST) * SAMPLE_BYTES;
}

void iso_gl_disc_targets_free(iso_gl_disc_targets *discs, const GladGLContext *gl) {
    gl->DeleteTextures(SUMS, discs->sums); /* 0 is ignored */
    gl->DeleteTextures(1, &discs->fronts);
    gl->DeleteFramebuffers(2, discs->framebuffers);
    *discs = (iso_gl_disc_targets){.width = 0};
}

static iso_status check_framebuffer(const iso_gl_discs_draw *d, GLuint framebuffer, iso_error *error) {
    if (d->gl->CheckNamedFramebufferStatus(framebuffer, GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE)
        return ISO_OK;
    return iso_fail(error, ISO_ERR_BACKEND, "%s: no framebuffer for the sums of %d x %d pixels",
                    d->engine->context->name, d->engine->discs.width, d->engine->discs.height);
}

static iso_status ensure_discs(const iso_gl_discs_draw *d, int width, int height, iso_error *error) {
    static const GLenum outputs[SUMS] = {GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1, GL_COLOR_ATTACHMENT2,
                                         GL_COLOR_ATTACHMENT3};
    const GladGLContext *gl = d->gl;
    iso_gl_disc_targets *discs = &d->engine->discs;
    if (discs->fronts && discs->width >= width && discs->height >= height) return ISO_OK;
    iso_gl_disc_targets_free(discs, gl);
    discs->width = width;
    discs->height = height;
    gl->CreateFramebuffers(2, discs->framebuffers);
    discs->fronts = iso_gl_make_texture(gl, GL_RGBA32F, width, height);
    gl->NamedFramebufferTexture(discs->framebuffers[0], GL_COLOR_ATTACHMENT0, discs->fronts, 0);
    for (int i = 0; i < SUMS; i++) {
        discs->sums[i] = iso_gl_make_texture(gl, GL_RGBA32F, width, height);
        gl->NamedFramebufferTexture(discs->framebuffers[1], outputs[i], discs->sums[i], 0);
    }
    gl->NamedFramebufferDrawBuffers(discs->framebuffers[1], SUMS, outputs);
    iso_status status = ISO_OK;
    for (int i = 0; i < 2 && status == ISO_OK; i++)
        status = check_framebuffer(d, discs->framebuffers[i], error);
    if (status != ISO_OK) iso_gl_disc_targets_free(discs, gl);
    return status;
}

/* ---- uniforms and visible blocks */

/* The largest thickness of the surface's discs, mm. */
static double thickness_of(const iso_gl_surface *surface) {
    const iso_gl_span *spans = surface->spans.data;
    double radius = 0;
    for (size_t s = 0; s < surface->span_count; s++) radius = fmax(radius, spans[s].radius);
    return (double)ISO_DISCS_THICKNESS * (double)(ISO_DISCS_BALL + ISO_DISCS_BALL_MORE) * radius;
}

static void upload_uniforms(const iso_gl_discs_draw *d, const iso_gl_tile *t) {
    const iso_projector *p = &d->projector;
    const iso_view *view = d->view;
    const iso_gl_surface *surface = d->surface;
    const double *spacing = surface->transform.spacing;
    const bool anisotropic = spacing[0] != spacing[1] || spacing[1] != spacing[2];
    const double voxels = surface->surfels ? 1 : ISO_POINT_STEP;
    const int margin = iso_gl_engine_margin(d->engine);
    const bool bordered = surface->dims[0] > 0 && surface->dims[1] > 0 && surface->dims[2] > 0;
    iso_gl_discs_uniforms u = {
        .axis = {(float)(view->cx - t->x), (float)(view->cy - t->y),
                 view->near < -ISO_NOWHERE ? -ISO_NOWHERE : (float)view->near, (float)view->focal},
        .sizes = {view->orthographic ? 0 : (float)(1 / view->focal), iso_discs_voxels_per_mm(p->normal),
                  anisotropic ? (float)fmax(spacing[0], fmax(spacing[1], spacing[2])) : 0,
                  (float)(1.001 * d->thickness)},
        .screen = {(float)(t->width + 2 * margin), (float)(t->height + 2 * margin), (float)margin,
                   (float)d->engine->max_point},
        .tile = {t->width, t->height, t->x, t->y},
        .picture = {view->width, view->height, d->number, d->color},
        .flags = {view->orthographic, d->cull, surface->has_colors, d->widened}};
    float *steps[] = {u.step_x, u.step_y, u.step_z}, *normals[] = {u.normal_x, u.normal_y, u.normal_z};
    u.step_x[3] = surface->radii_scale;
    u.step_y[3] = iso_discs_slant(view, 0);
    for (int k = 0; k < 3; k++) {
        for (int i = 0; i < 3; i++) steps[k][i] = (float)(p->matrix[3 * k + i] * voxels);
        memcpy(normals[k], p->normal + 3 * k, 3 * sizeof *normals[k]);
        u.border[k] = (float)(surface->dims[k] - 1);
    }
    u.border[3] = bordered;
    iso_gl_engine_ensure_storage(d->engine, ISO_GL_STORE_DISC_UNIFORMS, sizeof u);
    const GLuint name = d->engine->storage[ISO_GL_STORE_DISC_UNIFORMS];
    d->gl->NamedBufferSubData(name, 0, sizeof u, &u);
    d->gl->BindBufferBase(GL_UNIFORM_BUFFER, ISO_GL_DISC_UNIFORMS, name);
}

/* Whether discs of a block may reach the tile's rows. */
static bool is_visible(const iso_gl_discs_draw *d, const iso_point_block *block, const iso_gl_tile *t) {
    const double reach = iso_discs_largest_radius(block) * d->slant + 2, cy = d->view->cy - t->y;
    return block->seen && !(d->cull && block->back_facing) && block->row[1] + cy + reach >= 0 &&
           block->row[0] + cy - reach <= t->height && !iso_gl_is_behind(d, block);
}

/* The part of the view that the surface's discs can cover. */
static iso_area area_of(const iso_gl_discs_draw *d) {
    const iso_view *view = d->view;
    const iso_point_block *block = d->surface->blocks->blocks.data;
    const int size[2] = {view->width, view->height};
    const double axis[2] = {view->cx, view->cy};
    double low[2] = {size[0], size[1]}, high[2] = {-1, -1};
    for (size_t i = 0; i < d->surface->blocks->count; i++, block++) {
        const double reach = (double)(iso_discs_largest_radius(block) * d->slant + 2);
        const int32_t *pixels[2] = {block->column, block->row};
        if (!block->seen || (d->cull && block->back_facing)) continue;
        for (int k = 0; k < 2; k++) {
            low[k] = block->clipped ? 0 : iso_min(low[k], pixels[k][0] + axis[k] - reach);
            high[k] = block->clipped ? size[k] - 1 : iso_max(high[k], pixels[k][1] + 1 + axis[k] + reach);
        }
    }
    iso_area area = {{0, -1}, {0, -1}, 0};
    iso_rows *const to[2] = {&area.columns, &area.rows};
    for (int k = 0; k < 2; k++)
        *to[k] = (iso_rows){(int)iso_max(low[k], 0), (int)iso_min(high[k], size[k] - 1)};
    return area;
}

bool iso_gl_is_curved(const iso_gl_discs_draw *d, const iso_point_block *block) {
    return !d->flat && d->surface->has_curvatures && !d->surface->has_colors &&
           block->radius[1] >= ISO_DISCS_FLAT_RADIUS;
}

static bool is_filtered(const iso_gl_discs_draw *d, const iso_point_block *block) {
    return d->flat && iso_discs_is_filtered(block);
}

/* The per-instance data of a block. */
static iso_gl_instance instance_of(const iso_gl_discs_draw *d, const iso_point_block *block) {
    const iso_projector *p = &d->projector;
    const double low = d->surface->surfels ? 0 : ISO_POINT_LOW;
    iso_gl_instance to = {.place = {[3] = 0}};
    if (is_filtered(d, block))
        to.place[3] = -1;
    else if (iso_gl_is_curved(d, block))
        to.place[3] = 1;
    double at[3];
    for (int k = 0; k < 3; k++) at[k] = block->brick[k] * (double)ISO_BRICK + low;
    for (int k = 0; k < 3; k++) {
        const double *m = p->matrix + 3 * k;
        to.origin[k] = (float)(m[0] * at[0] + m[1] * at[1] + m[2] * at[2] + p->origin[k]);
        to.place[k] = (float)at[k];
    }
    return to;
}

/* Whether the largest disc of a block, drawn as a square of twice its reach, exceeds the driver's point
 * size. */
static bool is_wide(const iso_gl_discs_draw *d, const iso_point_block *block) {
    const double beside = is_filtered(d, block) ? 2.1 * (double)ISO_DISCS_LOW_PASS : 0;
    return 2.1 * iso_discs_largest_radius(block) * d->slant + beside + 1 > d->engine->max_point;
}

/* Lists the blocks that a tile's rows show, and makes room for their draw commands, in memory of `room`. */
static iso_status find_blocks(const iso_gl_discs_draw *d, iso_gl_tile *t, iso_buffer *room,
                              iso_error *error) {
    const iso_point_blocks *blocks = d->surface->blocks;
    const iso_point_block *block = blocks->blocks.data;
    const size_t each =
        sizeof(iso_gl_points_command) + sizeof(iso_gl_instance) + sizeof(iso_gl_tile_block) + sizeof(bool);
    ISO_TRY(iso_buffer_reserve(room, blocks->count * each, 0, error));
    t->commands = room->data;
    t->instances = (iso_gl_instance *)(t->commands + blocks->count);
    t->blocks = (iso_gl_tile_block *)(t->instances + blocks->count);
    t->wide = (bool *)(t->blocks + blocks->count);
    for (size_t i = 0; i < blocks->count; i++) {
        if (!is_visible(d, &block[i], t)) continue;
        const iso_gl_block_kind kind = d->select ? iso_gl_block_kind_of(d, &block[i]) : ISO_GL_WHOLE;
        t->blocks[t->block_count++] = (iso_gl_tile_block){.number = (uint32_t)i, .kind = kind};
    }
    return ISO_OK;
}

/* Adds the draw commands of the blocks of a kind that are to be drawn into the fronts; with `visible` of
 * those that have been and are not hidden. */
static void list_blocks(const iso_gl_discs_draw *d, iso_gl_tile *t, int kind, bool visible) {
    const iso_point_block *blocks = d->surface->blocks->blocks.data;
    const iso_gl_span *spans = d->surface->spans.data;
    for (size_t i = 0; i < t->block_count; i++) {
        const iso_gl_tile_block *of = &t->blocks[i];
        const iso_point_block *block = &blocks[of->number];
        if (of->kind != kind || !(visible ? of->tested && !of->hidden : of->fresh)) continue;
        const uint32_t first = (uint32_t)(spans[block->span].first + block->first);
        t->commands[t->draws] = (iso_gl_points_command){block->count, 1, first, (uint32_t)t->draws};
        t->wide[t->draws] = is_wide(d, block);
        t->instances[t->draws++] = instance_of(d, block);
    }
}

/* Makes and uploads draw commands; `visible` as of list_blocks. */
static void make_commands(const iso_gl_discs_draw *d, iso_gl_tile *t, bool visible) {
    t->draws = 0;
    for (int kind = 0; kind < ISO_GL_BLOCK_KINDS; kind++) {
        list_blocks(d, t, kind, visible);
        t->end[kind] = t->draws;
    }
    iso_gl_surface_command(d->surface, t->draws, t->commands, t->instances);
}

/* ---- passes */

static iso_status use_program(const iso_gl_discs_draw *d, iso_gl_program program, iso_error *error) {
    unsigned name;
    if (d->surface->surfels && program < ISO_GL_DISCS_OF_SURFELS)
        program = (iso_gl_program)(program + ISO_GL_DISCS_OF_SURFELS - ISO_GL_FRONT_POINTS);
    ISO_TRY(iso_gl_engine_program(d->engine, program, &name, error));
    d->gl->UseProgram(name);
    return ISO_OK;
}

/* Draws discs into the bound framebuffer: by `program` those that fit into points, by the next program
 * (quads) the others. */
static iso_status draw_discs(const iso_gl_discs_draw *d, const iso_gl_tile *t, iso_gl_program program,
                             iso_error *error) {
    ISO_TRY(use_program(d, program, error));
    if (!d->surface->has_radii) d->gl->VertexAttrib1f(ISO_GL_RADIUS, (GLfloat)d->surface->radius);
    const size_t listed = t->end[ISO_GL_TESTED];
    iso_gl_surface_draw_chosen(d->surface, 0, listed);
    iso_gl_surface_draw_range(d->surface, listed, t->draws - listed);
    bool quads = false;
    for (size_t i = 0; i < t->draws; i++) {
        if (!t->wide[i]) continue;
        if (!quads) ISO_TRY(use_program(d, (iso_gl_program)(program + 1), error));
        quads = true;
        iso_gl_surface_draw_quads(d->surface, t->commands[i].first, t->commands[i].count, &t->instances[i]);
    }
    return ISO_OK;
}

/* Sets the state of a pass over discs into a framebuffer. */
static void begin_pass(const iso_gl_discs_draw *d, const iso_gl_tile *t, int framebuffer) {
    const GladGLContext *gl = d->gl;
    const int margin = iso_gl_engine_margin(d->engine);
    gl->BindFramebuffer(GL_FRAMEBUFFER, d->engine->discs.framebuffers[framebuffer]);
    gl->ClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
    gl->Viewport(-margin, -margin, t->width + 2 * margin, t->height + 2 * margin);
    gl->Enable(GL_SCISSOR_TEST);
    gl->Scissor(0, 0, t->width, t->height);
    gl->Disable(GL_DEPTH_TEST);
    gl->Enable(GL_PROGRAM_POINT_SIZE);
    gl->Enable(GL_BLEND);
}

/* First pass: the nearest depths. In later rounds they are added to, if possible. */
static iso_status find_fronts(const iso_gl_discs_draw *d, const iso_gl_tile *t, iso_error *error) {
    const GladGLContext *gl = d->gl;
    const GLfloat nowhere[4] = {ISO_NOWHERE, ISO_NOWHERE, ISO_NOWHERE, ISO_NOWHERE};
    begin_pass(d, t, 0);
    gl->BlendEquationi(0, GL_MIN);
    if (!t->rounds || !t->grows) gl->ClearBufferfv(GL_COLOR, 0, nowhere);
    return draw_discs(d, t, ISO_GL_FRONT_POINTS, error);
}

/* And those of points that have become visible. */
static iso_status add_fronts(const iso_gl_discs_draw *d, const iso_gl_tile *t, iso_error *error) {
    begin_pass(d, t, 0);
    d->gl->BlendEquationi(0, GL_MIN);
    ISO_TRY(use_program(d, ISO_GL_FRONT_POINTS, error));
    if (!d->surface->has_radii) d->gl->VertexAttrib1f(ISO_GL_RADIUS, (GLfloat)d->surface->radius);
    iso_gl_surface_draw_chosen(d->surface, t->end[ISO_GL_DENSE],
                               t->end[ISO_GL_TESTED] - t->end[ISO_GL_DENSE]);
    return ISO_OK;
}

/* Second pass: weighted sums over the discs near the front. */
static iso_status add_discs(const iso_gl_discs_draw *d, const iso_gl_tile *t, iso_error *error) {
    const GladGLContext *gl = d->gl;
    const GLfloat nothing[4] = {0};
    begin_pass(d, t, 1);
    for (int i = 0; i < SUMS; i++) {
        gl->BlendEquationi((GLuint)i, GL_FUNC_ADD);
        gl->BlendFunci((GLuint)i, GL_ONE, GL_ONE);
        gl->ClearBufferfv(GL_COLOR, i, nothing);
    }
    gl->BindTextureUnit(ISO_GL_FRONTS, d->engine->discs.fronts);
    return draw_discs(d, t, ISO_GL_ADD_POINTS, error);
}

/* Third pass: from sums to samples of the picture. */
static iso_status resolve_tile(const iso_gl_discs_draw *d, const iso_gl_tile *t, iso_error *error) {
    const GladGLContext *gl = d->gl;
    for (int i = 0; i < SUMS; i++) gl->BindTextureUnit(ISO_GL_SUMS + (GLuint)i, d->engine->discs.sums[i]);
    gl->BindBufferBase(GL_SHADER_STORAGE_BUFFER, ISO_GL_PICTURE, d->engine->storage[ISO_GL_STORE_PICTURE]);
    ISO_TRY(use_program(d, ISO_GL_RESOLVE, error));
    gl->DispatchCompute((GLuint)(t->width + ISO_GL_TILE - 1) / ISO_GL_TILE,
                        (GLuint)(t->height + ISO_GL_TILE - 1) / ISO_GL_TILE, 1);
    gl->MemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
    return ISO_OK;
}

typedef iso_status pass_function(const iso_gl_discs_draw *d, const iso_gl_tile *t, iso_error *error);

static iso_status run_pass(const iso_gl_discs_draw *d, const iso_gl_tile *t, iso_gl_pass pass,
                           pass_function *run, iso_error *error) {
    iso_gl_timer *timer = &d->engine->timer;
    iso_gl_timer_begin(timer, d->gl, pass);
    const iso_status status = run(d, t, error);
    iso_gl_timer_end(timer, d->gl);
    d->gl->Disable(GL_BLEND);
    return status;
}

/* Finds the fronts of a tile; with selection those of visible points, first of those that made them before,
 * then of those that may change these, from more blocks until the fronts hide all others. */
static iso_status make_fronts(const iso_gl_discs_draw *d, iso_gl_tile *t, iso_buffer *room,
                              iso_error *error) {
    for (size_t revealed = 1; revealed;) {
        revealed = 0;
        make_commands(d, t, false);
        if (d->select) ISO_TRY(run_pass(d, t, ISO_GL_PASS_SELECT, iso_gl_select_first, error));
        ISO_TRY(run_pass(d, t, ISO_GL_PASS_FRONT, find_fronts, error));
        if (!d->select) continue;
        if (t->end[ISO_GL_TESTED] > t->end[ISO_GL_DENSE]) {
            ISO_TRY(run_pass(d, t, ISO_GL_PASS_SELECT, iso_gl_select_revealed, error));
            ISO_TRY(run_pass(d, t, ISO_GL_PASS_FRONT, add_fronts, error));
        }
        ISO_TRY(iso_gl_find_hidden(d, t, room, &revealed, error));
    }
    if (!d->select) return ISO_OK;
    make_commands(d, t, true);
    return run_pass(d, t, ISO_GL_PASS_SELECT, iso_gl_select_last, error);
}

static iso_status draw_tile(const iso_gl_discs_draw *d, iso_gl_tile *t, iso_buffer *room, iso_error *error) {
    iso_buffer squares = {.data = NULL};
    ISO_TRY(find_blocks(d, t, room, error));
    if (!t->block_count) return ISO_OK;
    upload_uniforms(d, t);
    ISO_TRY(iso_gl_selection_begin(d, t, error));
    const iso_status status = make_fronts(d, t, &squares, error);
    iso_buffer_free(&squares);
    ISO_TRY(status);
    ISO_TRY(run_pass(d, t, ISO_GL_PASS_ADD, add_discs, error));
    ISO_TRY(run_pass(d, t, ISO_GL_PASS_RESOLVE, resolve_tile, error));
    if (d->select) iso_gl_selection_end(d, t);
    return ISO_OK;
}

/* Sets d->select. By software renderers selection has been measured to pay; not so by GPUs. */
static iso_status choose_selection(iso_gl_discs_draw *d, iso_point_selection selection, iso_buffer *room,
                                   int width, int height, iso_error *error) {
    d->select = selection != ISO_SELECTION_ALL && iso_gl_can_select(d->surface, width, height);
    d->cells = selection == ISO_SELECTION_VISIBLE && !d->widened; /* AUTO draws the picture of all points */
    if (!d->select || selection == ISO_SELECTION_VISIBLE) return ISO_OK;
    d->select = iso_gl_renderer_is_software(d->engine->context->renderer);
    return d->select ? iso_gl_selection_pays(d, room, &d->select, error) : ISO_OK;
}

iso_status iso_gl_draw_discs(const iso_gl_surface *surface, const iso_view *view, int number,
                             iso_gl_discs_style style, const iso_area *area, iso_buffer *room,
                             iso_error *error) {
    iso_gl_engine *engine = surface->engine;
    iso_gl_discs_draw d = {.engine = engine,
                           .gl = engine->context->gl,
                           .surface = surface,
                           .view = view,
                           .projector = iso_projector_make(view, &surface->transform),
                           .slant = iso_discs_slant(view, engine->max_point / 2),
                           .cull = surface->closed && !surface->blocks->around_eye,
                           .flat = style.flat,
                           .widened = style.widened,
                           .number = number,
                           .before = style.before,
                           .thickness = thickness_of(surface)};
    if (style.color) d.color = style.color->r | style.color->g << 8 | style.color->b << 16 | 1 << 24;
    const int side = engine->max_side, width = view->width < side ? view->width : side;
    int height = SAMPLES_MOST / width;
    if (height > side) height = side;
    if (height > view->height) height = view->height;
    d.area = area ? *area : area_of(&d);
    if (iso_area_is_empty(&d.area)) return ISO_OK;
    ISO_TRY(choose_selection(&d, style.selection, room, width, height, error));
    ISO_TRY(ensure_discs(&d, width, height, error));
    const iso_rows columns = d.area.columns, rows = d.area.rows;
    for (int y = rows.first; y <= rows.last; y += height)
        for (int x = columns.first; x <= columns.last; x += width) {
            const bool first = x == columns.first && y == rows.first;
            iso_gl_tile t = {.x = x, .y = y, .width = width, .height = height};
            if (t.width > columns.last + 1 - x) t.width = columns.last + 1 - x;
            if (t.height > rows.last + 1 - y) t.height = rows.last + 1 - y;
            t.first = first && !view->above;
            t.whole =
                t.first && !view->below && t.width == columns.last + 1 - x && t.height == rows.last + 1 - y;
            ISO_TRY(draw_tile(&d, &t, room, error));
            ISO_TRY(iso_gl_check(engine->context, error)); /* stop when the context is lost */
        }
    return ISO_OK;
}
