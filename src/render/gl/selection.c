/* selection: chooses points with vertex shaders that draw nothing, lists them with a compute shader, and
 * tests blocks against the deepest fronts of squares of pixels, which are read back. */
#include "render/gl/selection.h"

#include <glad/gl.h>
#include <math.h>
#include <string.h>

#include "render/discs/discs_numbers.h"
#include "render/discs/setup.h"
#include "render/gl/pullpush.h"
#include "render/gl/shared.h"

/* Pixels: the largest radius of a small disc. Larger discs are so far apart that few points share a quarter
 * of a pixel. */
static const float SMALL = 1.5f;
/* How far around a block, and how far behind its nearest point, its points can change the picture. A
 * point of a small block can take a cell from a point behind it, whose centre may be two reaches (of 1.5
 * pixels and the filter's 0.6) away and two radii nearer. That point's disc reaches as far again, its
 * ball one radius nearer, and it is averaged with what lies 1.5 radii before it. */
static const double SMALL_AROUND = 7, RADII_BEHIND = 4.5;
/* Pixels: the largest radius of discs that are tested against the fronts; larger ones reach more squares than
 * discs.vert looks at. */
static const float TESTED = 24;
/* Pixels of focal length below which such a disc is not much smaller than its distance. */
static const double FOCAL_LEAST = 64;

/* After so many rounds all blocks of a tile are tested. The list of visible points is made anew for the sums
 * when more than one in MANY of the tested ones was drawn into the fronts after those of before: the
 * fronts then hide more than was known. */
enum { ROUNDS = 4, MANY = 8 };

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

iso_gl_block_kind iso_gl_block_kind_of(const iso_gl_discs_draw *d, const iso_point_block *block) {
    const iso_view *view = d->view;
    const float radius = iso_discs_largest_radius(block) * d->slant;
    const bool small = radius <= SMALL && (view->orthographic || view->focal >= FOCAL_LEAST);
    if (d->cells && small && !iso_gl_is_curved(d, block)) return ISO_GL_DENSE;
    return ISO_GL_TESTED;
}

/* ---- points */

static iso_status use_program(const iso_gl_discs_draw *d, iso_gl_program program, iso_error *error) {
    unsigned name;
    ISO_TRY(iso_gl_engine_program(d->engine, program, &name, error));
    d->gl->UseProgram(name);
    return ISO_OK;
}

static void bind(const iso_gl_discs_draw *d, GLuint slot, iso_gl_storage which) {
    d->gl->BindBufferBase(GL_SHADER_STORAGE_BUFFER, slot, d->engine->storage[which]);
}

/* Makes a buffer of this size, filled with a value. */
static void fill(const iso_gl_discs_draw *d, iso_gl_storage which, size_t bytes, GLuint value) {
    iso_gl_engine_ensure_storage(d->engine, which, bytes);
    d->gl->ClearNamedBufferSubData(d->engine->storage[which], GL_R32UI, 0, (GLsizeiptr)bytes, GL_RED_INTEGER,
                                   GL_UNSIGNED_INT, &value);
}

static void clear_marks(const iso_gl_discs_draw *d, GLuint marks) {
    const GLuint none = 0;
    d->gl->ClearNamedBufferData(marks, GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, &none);
}

static int squares(int pixels) {
    return (pixels + ISO_GL_SQUARE - 1) / ISO_GL_SQUARE;
}

static size_t deepest_bytes(const iso_gl_tile *t) {
    return (size_t)squares(t->width) * (size_t)squares(t->height) * sizeof(float);
}

/* Finds the deepest front of each square of pixels. */
static iso_status find_deepest(const iso_gl_discs_draw *d, const iso_gl_tile *t, iso_error *error) {
    const GladGLContext *gl = d->gl;
    const int across = squares(t->width), down = squares(t->height);
    iso_gl_engine_ensure_storage(d->engine, ISO_GL_STORE_DEEPEST, deepest_bytes(t));
    bind(d, ISO_GL_DEEPEST, ISO_GL_STORE_DEEPEST);
    bind(d, ISO_GL_PICTURE, ISO_GL_STORE_PICTURE);
    gl->BindTextureUnit(ISO_GL_FRONTS, d->engine->discs.fronts);
    ISO_TRY(use_program(d, ISO_GL_FIND_DEEPEST, error));
    gl->DispatchCompute((GLuint)(across + ISO_GL_TILE - 1) / ISO_GL_TILE,
                        (GLuint)(down + ISO_GL_TILE - 1) / ISO_GL_TILE, 1);
    gl->MemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT | GL_SHADER_STORAGE_BARRIER_BIT);
    return ISO_OK;
}

/* One of the passes of discs.vert over the points of some commands, which draw nothing. */
static iso_status scan_points(const iso_gl_discs_draw *d, size_t first, size_t end, iso_gl_program program,
                              iso_error *error) {
    const int of_surfels = d->surface->surfels ? ISO_GL_SELECT_SURFELS - ISO_GL_SELECT_DEPTHS : 0;
    ISO_TRY(use_program(d, (iso_gl_program)(program + of_surfels), error));
    d->gl->BindFramebuffer(GL_FRAMEBUFFER, d->engine->discs.framebuffers[1]); /* draws need one */
    d->gl->Enable(GL_RASTERIZER_DISCARD);
    if (!d->surface->has_radii) d->gl->VertexAttrib1f(ISO_GL_RADIUS, (GLfloat)d->surface->radius);
    iso_gl_surface_draw_range(d->surface, first, end - first);
    d->gl->Disable(GL_RASTERIZER_DISCARD);
    d->gl->MemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
    return ISO_OK;
}

/* Lists the marked points of the commands first .. end - 1. `before`: 0, or marks of points to leave out. */
static iso_status list_marked(const iso_gl_discs_draw *d, size_t first, size_t end, GLuint marks,
                              GLuint before, iso_error *error) {
    const GladGLContext *gl = d->gl;
    if (first == end) return ISO_OK;
    ISO_TRY(use_program(d, ISO_GL_CHOOSE, error));
    gl->BindBufferBase(GL_SHADER_STORAGE_BUFFER, ISO_GL_COMMANDS, d->engine->commands);
    gl->BindBufferBase(GL_SHADER_STORAGE_BUFFER, ISO_GL_MARKED, marks);
    gl->BindBufferBase(GL_SHADER_STORAGE_BUFFER, ISO_GL_MARKED_FRONTS, before ? before : marks);
    bind(d, ISO_GL_CHOSEN, ISO_GL_STORE_CHOSEN);
    bind(d, ISO_GL_ELEMENTS, ISO_GL_STORE_ELEMENTS);
    bind(d, ISO_GL_TOTAL, ISO_GL_STORE_TOTAL);
    gl->Uniform3ui(ISO_GL_DRAWS, (GLuint)first, (GLuint)end, before != 0);
    gl->DispatchCompute((GLuint)(end - first + ISO_GL_GROUP - 1) / ISO_GL_GROUP, 1, 1);
    gl->MemoryBarrier(GL_COMMAND_BARRIER_BIT | GL_ELEMENT_ARRAY_BARRIER_BIT | GL_BUFFER_UPDATE_BARRIER_BIT |
                      GL_SHADER_STORAGE_BARRIER_BIT);
    return ISO_OK;
}

/* Makes room for lists of points, which are empty. */
static void prepare_lists(const iso_gl_discs_draw *d, const iso_gl_tile *t) {
    iso_gl_engine_ensure_storage(d->engine, ISO_GL_STORE_CHOSEN,
                                 d->surface->vertices.room * sizeof(uint32_t));
    iso_gl_engine_ensure_storage(d->engine, ISO_GL_STORE_ELEMENTS,
                                 (t->end[ISO_GL_TESTED] + 1) * sizeof(iso_gl_mesh_command));
    fill(d, ISO_GL_STORE_TOTAL, sizeof(uint32_t), 0);
}

/* Chooses points of small discs by cells. */
static iso_status choose_by_cells(const iso_gl_discs_draw *d, const iso_gl_tile *t, iso_error *error) {
    const size_t dense = t->end[ISO_GL_DENSE];
    if (!dense) return ISO_OK;
    fill(d, ISO_GL_STORE_CELLS, cells_bytes(t->width, t->height), ISO_GL_KEY_NONE);
    fill(d, ISO_GL_STORE_MARKED, marks_bytes(d->surface->vertices.room), 0);
    bind(d, ISO_GL_CELLS, ISO_GL_STORE_CELLS);
    bind(d, ISO_GL_MARKED, ISO_GL_STORE_MARKED);
    ISO_TRY(scan_points(d, 0, dense, ISO_GL_SELECT_DEPTHS, error));
    return scan_points(d, 0, dense, ISO_GL_SELECT_MARKS, error);
}

static iso_status list_dense(const iso_gl_discs_draw *d, const iso_gl_tile *t, iso_error *error) {
    return list_marked(d, 0, t->end[ISO_GL_DENSE], d->engine->storage[ISO_GL_STORE_MARKED], 0, error);
}

iso_status iso_gl_select_first(const iso_gl_discs_draw *d, const iso_gl_tile *t, iso_error *error) {
    prepare_lists(d, t);
    ISO_TRY(choose_by_cells(d, t, error));
    ISO_TRY(list_dense(d, t, error));
    return list_marked(d, t->end[ISO_GL_DENSE], t->end[ISO_GL_TESTED], d->surface->seen->fronts[1], 0, error);
}

/* Marks the points that the fronts do not hide, and those that make fronts. */
static iso_status mark_visible(const iso_gl_discs_draw *d, const iso_gl_tile *t, iso_error *error) {
    d->gl->BindBufferBase(GL_SHADER_STORAGE_BUFFER, ISO_GL_MARKED_FRONTS, d->surface->seen->fronts[0]);
    bind(d, ISO_GL_MARKED, ISO_GL_STORE_VISIBLE);
    bind(d, ISO_GL_DEEPEST, ISO_GL_STORE_DEEPEST);
    d->gl->BindTextureUnit(ISO_GL_FRONTS, d->engine->discs.fronts);
    return scan_points(d, t->end[ISO_GL_DENSE], t->end[ISO_GL_TESTED], ISO_GL_SELECT_VISIBLE, error);
}

iso_status iso_gl_select_revealed(const iso_gl_discs_draw *d, const iso_gl_tile *t, iso_error *error) {
    const iso_gl_seen *seen = d->surface->seen;
    ISO_TRY(find_deepest(d, t, error));
    ISO_TRY(mark_visible(d, t, error));
    fill(d, ISO_GL_STORE_TOTAL, sizeof(uint32_t), 0);
    return list_marked(d, t->end[ISO_GL_DENSE], t->end[ISO_GL_TESTED], seen->fronts[0], seen->fronts[1],
                       error);
}

iso_status iso_gl_select_last(const iso_gl_discs_draw *d, const iso_gl_tile *t, iso_error *error) {
    prepare_lists(d, t);
    ISO_TRY(list_dense(d, t, error));
    if (t->stale && t->end[ISO_GL_TESTED] > t->end[ISO_GL_DENSE]) {
        clear_marks(d, d->surface->seen->fronts[0]);
        clear_marks(d, d->engine->storage[ISO_GL_STORE_VISIBLE]);
        ISO_TRY(mark_visible(d, t, error));
    }
    return list_marked(d, t->end[ISO_GL_DENSE], t->end[ISO_GL_TESTED],
                       d->engine->storage[ISO_GL_STORE_VISIBLE], 0, error);
}

/* The first and last square along an axis that a block can reach; none if first > last. */
static void squares_of(const int32_t pixels[2], double axis, double around, int size, int range[2]) {
    const double first = pixels[0] + axis - around, last = pixels[1] + 1 + axis + around;
    range[0] = first > 0 ? (int)(first < size ? first : size) / ISO_GL_SQUARE : 0;
    range[1] = last < 0 ? -1 : (int)(last < size - 1 ? last : size - 1) / ISO_GL_SQUARE;
    if (first >= size) range[1] = range[0] - 1;
}

/* ---- whether it pays */

/* Costs in the time of a fragment, 0.03 microseconds of one core: of a disc in one of the two passes beside
 * its fragments; of the tests of a disc against the fronts; of a pixel of the picture, for squares and their
 * reading back. Measured with llvmpipe by tests/bench/gl_selection.c. */
static const double DISC_COST = 16, TEST_COST = 4.6, PIXEL_COST = 1;
/* Pixels that a disc of radius 1 adds to what is covered: discs overlap 3.7 times, and a surface is seen at
 * an angle of 60 degrees on average. Share of the squares that blocks meet which is covered. */
static const double AREA = 0.425, COVERED = 0.85;
/* Discs for each pixel that is covered that are drawn into the fronts, where there was a frame before. */
static const double FRONTS = 1.8;

/* The blocks that a picture may show. */
typedef struct block_sums {
    double points, cost, area; /* number; of one pass over them; pixels of surface, in front of each other */
    double squares;            /* of the picture that they meet */
} block_sums;

/* Marks the squares of the picture that the block's discs may cover, and counts those that had no mark. */
static void cover_squares(const iso_view *view, const iso_point_block *block, uint8_t *covered,
                          block_sums *sums) {
    const int height = view->above + view->height + view->below;
    int x[2], y[2];
    squares_of(block->column, view->cx, 0, view->width, x);
    squares_of(block->row, view->cy + view->above, 0, height, y);
    for (int v = y[0]; v <= y[1]; v++)
        for (int u = x[0]; u <= x[1]; u++) {
            uint8_t *square = covered + (size_t)v * (size_t)squares(view->width) + (size_t)u;
            sums->squares += !*square;
            *square = 1;
        }
}

static void add_block(block_sums *sums, const iso_point_block *block) {
    const double square = (double)(block->radius[0] * block->radius[1]),
                 fragments = 4 * square + 2 * sqrt(square) + 1;
    sums->points += block->count;
    sums->cost += block->count * (DISC_COST + fragments);
    sums->area += block->count * AREA * square;
}

iso_status iso_gl_selection_pays(const iso_gl_discs_draw *d, iso_buffer *room, bool *pays, iso_error *error) {
    const iso_view *view = d->view;
    const int height = view->above + view->height + view->below;
    const size_t bytes = (size_t)squares(view->width) * (size_t)squares(height);
    const iso_point_block *block = d->surface->blocks->blocks.data;
    block_sums sums = {.points = 0};
    ISO_TRY(iso_buffer_reserve(room, bytes, 0, error));
    memset(room->data, 0, bytes);
    for (size_t i = 0; i < d->surface->blocks->count; i++) {
        if (!block[i].seen || (d->cull && block[i].back_facing)) continue;
        if (iso_discs_largest_radius(&block[i]) * d->slant > TESTED) continue;
        add_block(&sums, &block[i]);
        cover_squares(view, &block[i], room->data, &sums);
    }
    const double covered = COVERED * ISO_GL_SQUARE * ISO_GL_SQUARE * sums.squares,
                 visible = fmin(1, covered / fmax(sums.area, 1)), test = TEST_COST * sums.points,
                 pixels = PIXEL_COST * (d->area.columns.last + 1 - d->area.columns.first) *
                          (d->area.rows.last + 1 - d->area.rows.first);
    /* Without a frame before, all discs are drawn into the fronts. */
    const bool known = d->surface->seen->count > 0;
    const double fronts = known ? fmin(visible, FRONTS * covered / fmax(sums.points, 1)) : 1;
    *pays = test + pixels + (fronts + visible) * sums.cost < 2 * sums.cost;
    return ISO_OK;
}

/* ---- blocks */

/* Depths of a part of the view that begins at (x, y): the greatest of each square, which is `more` mm less
 * than what hides. */
typedef struct square_depths {
    int x, y, width, height;
    const float *greatest;
    double more;
} square_depths;

/* Whether nothing that the block's points can change is visible. */
static bool is_hidden(const iso_gl_discs_draw *d, const iso_point_block *block, bool dense,
                      const square_depths *depths) {
    const iso_view *view = d->view;
    const double pixel =
        view->orthographic ? 1 / view->focal : (double)block->depth[1] / view->focal; /* mm */
    double radius = (double)iso_discs_largest_radius(block), around = radius * (double)d->slant + 2;
    if (block->clipped) return false;
    if (dense) {
        radius = (double)SMALL;
        around = SMALL_AROUND;
    }
    const double front = (double)block->depth[0] - depths->more -
                         1.01 * pixel * (RADII_BEHIND * radius + (double)ISO_DISCS_LOW_PASS_DEPTH);
    int x[2], y[2];
    squares_of(block->column, view->cx - depths->x, around, depths->width, x);
    squares_of(block->row, view->cy - depths->y, around, depths->height, y);
    for (int v = y[0]; v <= y[1]; v++)
        for (int u = x[0]; u <= x[1]; u++)
            if (!((double)depths->greatest[v * squares(depths->width) + u] < front)) return false;
    return true;
}

_Static_assert(ISO_GL_SQUARE == ISO_DEPTH_CELL, "squares are the lowest level of pyramids of depths");

bool iso_gl_is_behind(const iso_gl_discs_draw *d, const iso_point_block *block) {
    if (!d->before) return false;
    const square_depths depths = {
        0, 0, d->view->width, d->view->height, d->before->level[0], 1.001 * d->thickness};
    return is_hidden(d, block, false, &depths);
}

/* The number of points that are tested one by one. */
static uint64_t count_tested(const iso_gl_discs_draw *d, const iso_gl_tile *t) {
    const iso_point_block *blocks = d->surface->blocks->blocks.data;
    uint64_t points = 0;
    for (size_t i = 0; i < t->block_count; i++)
        if (t->blocks[i].tested && t->blocks[i].kind == ISO_GL_TESTED)
            points += blocks[t->blocks[i].number].count;
    return points;
}

iso_status iso_gl_find_hidden(const iso_gl_discs_draw *d, iso_gl_tile *t, iso_buffer *room, size_t *revealed,
                              iso_error *error) {
    const size_t bytes = deepest_bytes(t);
    uint32_t drawn;
    ISO_TRY(iso_buffer_reserve(room, bytes, 0, error));
    ISO_TRY(find_deepest(d, t, error));
    d->gl->GetNamedBufferSubData(d->engine->storage[ISO_GL_STORE_DEEPEST], 0, (GLsizeiptr)bytes, room->data);
    d->gl->GetNamedBufferSubData(d->engine->storage[ISO_GL_STORE_TOTAL], 0, sizeof drawn, &drawn);
    const iso_point_block *blocks = d->surface->blocks->blocks.data;
    const square_depths depths = {t->x, t->y, t->width, t->height, room->data, 0};
    t->stale |= drawn > count_tested(d, t) / MANY;
    *revealed = 0;
    for (size_t i = 0; i < t->block_count; i++) {
        iso_gl_tile_block *block = &t->blocks[i];
        block->hidden = is_hidden(d, &blocks[block->number], block->kind == ISO_GL_DENSE, &depths);
        *revealed += !block->hidden && !block->tested && !d->engine->keep_holes;
    }
    const bool all = ++t->rounds == ROUNDS;
    for (size_t i = 0; i < t->block_count && *revealed; i++) {
        const bool tested = all || !t->blocks[i].hidden;
        t->blocks[i].fresh = tested && !(t->grows && t->blocks[i].tested);
        t->blocks[i].tested = tested;
    }
    return ISO_OK;
}

/* ---- the frame before */

iso_selection_counts iso_gl_engine_selection(const iso_gl_engine *engine) {
    return engine->selection;
}

/* The marks of the last picture become those of the picture before, and the new ones are cleared; where the
 * points' buffer has been replaced, both are. After an edit the bits may be those of other points: they only
 * decide what is drawn first. */
static iso_status turn_marks(const iso_gl_discs_draw *d, iso_error *error) {
    iso_gl_seen *seen = d->surface->seen;
    const size_t points = d->surface->vertices.room;
    const GLuint last = seen->fronts[0];
    if (seen->room == points) {
        seen->fronts[0] = seen->fronts[1];
        seen->fronts[1] = last;
        clear_marks(d, seen->fronts[0]);
        return ISO_OK;
    }
    ISO_TRY(iso_gl_check_memory(d->engine, points * sizeof(uint32_t) + 4 * marks_bytes(points), error));
    d->gl->DeleteBuffers(2, seen->fronts); /* 0 is ignored */
    d->gl->CreateBuffers(2, seen->fronts);
    for (int i = 0; i < 2; i++) {
        d->gl->NamedBufferStorage(seen->fronts[i], (GLsizeiptr)marks_bytes(points), NULL,
                                  GL_DYNAMIC_STORAGE_BIT);
        clear_marks(d, seen->fronts[i]);
    }
    seen->room = points;
    return ISO_OK;
}

iso_status iso_gl_selection_begin(const iso_gl_discs_draw *d, iso_gl_tile *t, iso_error *error) {
    if (d->select) ISO_TRY(turn_marks(d, error));
    if (d->select) fill(d, ISO_GL_STORE_VISIBLE, marks_bytes(d->surface->vertices.room), 0);
    t->grows = true;
    const iso_gl_seen *seen = d->surface->seen;
    const uint8_t *flags = seen->flags.data;
    const bool known = d->select && t->whole && seen->count && seen->count == d->surface->blocks->count;
    for (size_t i = 0; i < t->block_count; i++) {
        iso_gl_tile_block *block = &t->blocks[i];
        block->fresh = block->tested = !known || flags[block->number];
        t->grows &= block->kind != ISO_GL_DENSE;
    }
    return ISO_OK;
}

/* Adds the points of the tile's blocks to the engine's counts. */
static void count_points(const iso_gl_discs_draw *d, const iso_gl_tile *t) {
    const iso_point_block *blocks = d->surface->blocks->blocks.data;
    iso_selection_counts *counts = &d->engine->selection;
    uint32_t chosen;
    for (size_t i = 0; i < d->surface->blocks->count && t->first; i++) counts->points += blocks[i].count;
    for (size_t i = 0; i < t->block_count; i++)
        if (t->blocks[i].tested) counts->tested += blocks[t->blocks[i].number].count;
    for (size_t i = t->end[ISO_GL_TESTED]; i < t->draws; i++) counts->drawn += t->commands[i].count;
    d->gl->GetNamedBufferSubData(d->engine->storage[ISO_GL_STORE_TOTAL], 0, sizeof chosen, &chosen);
    counts->drawn += chosen;
}

void iso_gl_selection_end(const iso_gl_discs_draw *d, const iso_gl_tile *t) {
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
