/* selection: chooses points with vertex shaders that draw nothing, lists them with a compute shader, and
 * tests blocks against the deepest fronts of squares of pixels, which are read back. */
#include "render/gl/selection.h"

#include <glad/gl.h>
#include <math.h>
#include <string.h>

#include "render/gl/pullpush.h"
#include "render/gl/shared.h"
#include "render/refined/refined_numbers.h"
#include "render/refined/setup.h"

/* Pixels: the largest radius of a small disc. Larger discs are so far apart that few points share a quarter
 * of a pixel. */
static const float SMALL = 1.5f;
/* How far around a block, and how far behind its nearest point, its points can change the picture. A
 * point of a small block can take a cell from a point behind it, whose centre may be two reaches (of 1.5
 * pixels and the filter's 0.6) away and two radii nearer. That point's disc reaches as far again, its
 * ball one radius nearer, and it is averaged with what lies 1.5 radii before it. */
static const double SMALL_AROUND = 7, RADII_BEHIND = 4.5;
/* Pixels of focal length below which such a disc is not much smaller than its distance. */
static const double FOCAL_LEAST = 64;

/* After so many rounds all blocks of a tile are tested. */
enum { ROUNDS = 4 };

_Static_assert(sizeof(iso_gl_points_command) == 16 && sizeof(iso_gl_mesh_command) == 20, "layout of std430");

static size_t cells_bytes(int width, int height) {
    return (size_t)(width + 2 * ISO_GL_GUARD) * (size_t)(height + 2 * ISO_GL_GUARD) * ISO_GL_PIXEL_CELLS *
           sizeof(uint32_t);
}

static size_t marks_bytes(size_t points) {
    return (points / 32 + 1) * sizeof(uint32_t);
}

uint64_t iso_gl_selection_bytes(int width, int height) {
    return cells_bytes(width, height);
}

bool iso_gl_can_select(const iso_gl_surface *surface, int width, int height) {
    const iso_gl_engine *engine = surface->engine;
    const size_t points = surface->vertices.room;
    return engine->vertex_storage && points <= INT32_MAX &&
           points * sizeof(uint32_t) <= engine->max_storage &&
           cells_bytes(width, height) <= engine->max_storage;
}

bool iso_gl_is_small(const iso_gl_refined_draw *d, const iso_point_block *block) {
    const iso_view *view = d->view;
    return d->flat && iso_refined_largest_radius(block) * d->slant <= SMALL &&
           (view->orthographic || view->focal >= FOCAL_LEAST);
}

/* ---- points */

static iso_status use_program(const iso_gl_refined_draw *d, iso_gl_program program, iso_error *error) {
    unsigned name;
    ISO_TRY(iso_gl_engine_program(d->engine, program, &name, error));
    d->gl->UseProgram(name);
    return ISO_OK;
}

static void bind(const iso_gl_refined_draw *d, GLuint slot, iso_gl_storage which) {
    d->gl->BindBufferBase(GL_SHADER_STORAGE_BUFFER, slot, d->engine->storage[which]);
}

/* Makes a buffer of this size, filled with a value. */
static void fill(const iso_gl_refined_draw *d, iso_gl_storage which, size_t bytes, GLuint value) {
    iso_gl_engine_ensure_storage(d->engine, which, bytes);
    d->gl->ClearNamedBufferSubData(d->engine->storage[which], GL_R32UI, 0, (GLsizeiptr)bytes, GL_RED_INTEGER,
                                   GL_UNSIGNED_INT, &value);
}

/* One of the two passes of refined.vert over the points of small blocks. */
static iso_status scan_points(const iso_gl_refined_draw *d, const iso_gl_tile *t, bool mark,
                              iso_error *error) {
    const int of_surfels = d->surface->surfels ? 2 : 0;
    ISO_TRY(use_program(d, (iso_gl_program)(ISO_GL_SELECT_DEPTHS + of_surfels + mark), error));
    if (!d->surface->has_radii) d->gl->VertexAttrib1f(ISO_GL_RADIUS, (GLfloat)d->surface->radius);
    iso_gl_surface_draw_range(d->surface, 0, t->small_draws);
    d->gl->MemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
    return ISO_OK;
}

iso_status iso_gl_select_points(const iso_gl_refined_draw *d, const iso_gl_tile *t, iso_error *error) {
    const size_t points = d->surface->vertices.room;
    if (!t->small_draws) return ISO_OK;
    if (d->engine->storage_bytes[ISO_GL_STORE_CHOSEN] < points * sizeof(uint32_t))
        ISO_TRY(iso_gl_check_memory(d->engine, points * sizeof(uint32_t) + marks_bytes(points), error));
    fill(d, ISO_GL_STORE_CELLS, cells_bytes(t->width, t->height), ISO_GL_KEY_NONE);
    fill(d, ISO_GL_STORE_MARKED, marks_bytes(points), 0);
    bind(d, ISO_GL_CELLS, ISO_GL_STORE_CELLS);
    bind(d, ISO_GL_MARKED, ISO_GL_STORE_MARKED);
    d->gl->BindFramebuffer(GL_FRAMEBUFFER, d->engine->discs.framebuffers[0]); /* draws need one */
    d->gl->Enable(GL_RASTERIZER_DISCARD);
    iso_status status = scan_points(d, t, false, error);
    if (status == ISO_OK) status = scan_points(d, t, true, error);
    d->gl->Disable(GL_RASTERIZER_DISCARD);
    ISO_TRY(status);
    return iso_gl_list_chosen(d, t, error);
}

iso_status iso_gl_list_chosen(const iso_gl_refined_draw *d, const iso_gl_tile *t, iso_error *error) {
    const GladGLContext *gl = d->gl;
    iso_gl_engine *engine = d->engine;
    fill(d, ISO_GL_STORE_TOTAL, sizeof(uint32_t), 0);
    if (!t->small_draws) return ISO_OK;
    iso_gl_engine_ensure_storage(engine, ISO_GL_STORE_CHOSEN, d->surface->vertices.room * sizeof(uint32_t));
    iso_gl_engine_ensure_storage(engine, ISO_GL_STORE_ELEMENTS, t->small_draws * sizeof(iso_gl_mesh_command));
    ISO_TRY(use_program(d, ISO_GL_CHOOSE, error));
    gl->BindBufferBase(GL_SHADER_STORAGE_BUFFER, ISO_GL_COMMANDS, engine->commands);
    bind(d, ISO_GL_MARKED, ISO_GL_STORE_MARKED);
    bind(d, ISO_GL_CHOSEN, ISO_GL_STORE_CHOSEN);
    bind(d, ISO_GL_ELEMENTS, ISO_GL_STORE_ELEMENTS);
    bind(d, ISO_GL_TOTAL, ISO_GL_STORE_TOTAL);
    gl->Uniform1ui(ISO_GL_DRAWS, (GLuint)t->small_draws);
    gl->DispatchCompute((GLuint)(t->small_draws + ISO_GL_GROUP - 1) / ISO_GL_GROUP, 1, 1);
    gl->MemoryBarrier(GL_COMMAND_BARRIER_BIT | GL_ELEMENT_ARRAY_BARRIER_BIT | GL_BUFFER_UPDATE_BARRIER_BIT);
    return ISO_OK;
}

/* ---- blocks */

static int squares(int pixels) {
    return (pixels + ISO_GL_SQUARE - 1) / ISO_GL_SQUARE;
}

/* Reads the deepest front of each square of pixels back, into `room`. */
static iso_status find_deepest(const iso_gl_refined_draw *d, const iso_gl_tile *t, iso_buffer *room,
                               iso_error *error) {
    const GladGLContext *gl = d->gl;
    const int across = squares(t->width), down = squares(t->height);
    const size_t bytes = (size_t)across * (size_t)down * sizeof(float);
    ISO_TRY(iso_buffer_reserve(room, bytes, 0, error));
    iso_gl_engine_ensure_storage(d->engine, ISO_GL_STORE_DEEPEST, bytes);
    bind(d, ISO_GL_DEEPEST, ISO_GL_STORE_DEEPEST);
    gl->BindTextureUnit(ISO_GL_FRONTS, d->engine->discs.fronts);
    ISO_TRY(use_program(d, ISO_GL_FIND_DEEPEST, error));
    gl->DispatchCompute((GLuint)(across + ISO_GL_TILE - 1) / ISO_GL_TILE,
                        (GLuint)(down + ISO_GL_TILE - 1) / ISO_GL_TILE, 1);
    gl->MemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    gl->GetNamedBufferSubData(d->engine->storage[ISO_GL_STORE_DEEPEST], 0, (GLsizeiptr)bytes, room->data);
    return ISO_OK;
}

/* The first and last square along an axis that a block can reach; none if first > last. */
static void squares_of(const int32_t pixels[2], double axis, double around, int size, int range[2]) {
    const double first = pixels[0] + axis - around, last = pixels[1] + 1 + axis + around;
    range[0] = first > 0 ? (int)(first < size ? first : size) / ISO_GL_SQUARE : 0;
    range[1] = last < 0 ? -1 : (int)(last < size - 1 ? last : size - 1) / ISO_GL_SQUARE;
    if (first >= size) range[1] = range[0] - 1;
}

/* Whether nothing that the block's points can change is visible. */
static bool is_hidden(const iso_gl_refined_draw *d, const iso_gl_tile *t, const iso_gl_tile_block *b,
                      const float *deepest) {
    const iso_point_block *block = (const iso_point_block *)d->surface->blocks->blocks.data + b->number;
    const iso_view *view = d->view;
    const double pixel =
        view->orthographic ? 1 / view->focal : (double)block->depth[1] / view->focal; /* mm */
    double radius = (double)iso_refined_largest_radius(block), around = radius * (double)d->slant + 2;
    if (block->clipped) return false;
    if (b->small) {
        radius = (double)SMALL;
        around = SMALL_AROUND;
    }
    const double front =
        (double)block->depth[0] - 1.01 * pixel * (RADII_BEHIND * radius + (double)ISO_REFINED_LOW_PASS_DEPTH);
    int x[2], y[2];
    squares_of(block->column, view->cx - t->x, around, t->width, x);
    squares_of(block->row, view->cy - t->y, around, t->height, y);
    for (int v = y[0]; v <= y[1]; v++)
        for (int u = x[0]; u <= x[1]; u++)
            if (!((double)deepest[v * squares(t->width) + u] < front)) return false;
    return true;
}

iso_status iso_gl_find_hidden(const iso_gl_refined_draw *d, iso_gl_tile *t, iso_buffer *room,
                              size_t *revealed, iso_error *error) {
    ISO_TRY(find_deepest(d, t, room, error));
    *revealed = 0;
    for (size_t i = 0; i < t->block_count; i++) {
        iso_gl_tile_block *block = &t->blocks[i];
        block->hidden = is_hidden(d, t, block, room->data);
        *revealed += !block->hidden && !block->tested && !d->engine->keep_holes;
    }
    const bool all = ++t->rounds == ROUNDS;
    for (size_t i = 0; i < t->block_count && *revealed; i++)
        t->blocks[i].tested = all || !t->blocks[i].hidden;
    return ISO_OK;
}

/* ---- the frame before */

iso_selection_counts iso_gl_engine_selection(const iso_gl_engine *engine) {
    return engine->selection;
}

void iso_gl_selection_begin(const iso_gl_refined_draw *d, iso_gl_tile *t) {
    const iso_gl_seen *seen = d->surface->seen;
    const uint8_t *flags = seen->flags.data;
    const bool known = d->select && t->whole && seen->count && seen->count == d->surface->blocks->count;
    for (size_t i = 0; i < t->block_count; i++) t->blocks[i].tested = !known || flags[t->blocks[i].number];
}

/* Adds the points of the tile's blocks to the engine's counts. */
static void count_points(const iso_gl_refined_draw *d, const iso_gl_tile *t) {
    const iso_point_block *blocks = d->surface->blocks->blocks.data;
    iso_selection_counts *counts = &d->engine->selection;
    uint32_t chosen;
    for (size_t i = 0; i < d->surface->blocks->count && !t->x && !t->y && !d->view->above; i++)
        counts->points += blocks[i].count;
    for (size_t i = 0; i < t->block_count; i++)
        if (t->blocks[i].tested) counts->tested += blocks[t->blocks[i].number].count;
    for (size_t i = t->small_draws; i < t->draws; i++) counts->drawn += t->commands[i].count;
    d->gl->GetNamedBufferSubData(d->engine->storage[ISO_GL_STORE_TOTAL], 0, sizeof chosen, &chosen);
    counts->drawn += chosen;
}

void iso_gl_selection_end(const iso_gl_refined_draw *d, const iso_gl_tile *t) {
    iso_gl_seen *seen = d->surface->seen;
    const size_t count = d->surface->blocks->count;
    count_points(d, t);
    seen->count = 0;
    if (!t->whole || iso_buffer_reserve(&seen->flags, count, 0, NULL) != ISO_OK) return;
    uint8_t *flags = seen->flags.data;
    memset(flags, 0, count);
    for (size_t i = 0; i < t->block_count; i++)
        flags[t->blocks[i].number] = t->blocks[i].tested && !t->blocks[i].hidden;
    seen->count = count;
}
