#include "render/pullpush/pullpush.h"

#include <assert.h>

#include "render/pullpush/kernel.h"
#include "render/pullpush/setup.h"
#include "render/refined/refined.h"

enum {
    BAND_BYTES = 5 << 18, /* of keys that one thread works on: about what a second-level cache holds */
    BANDS_PER_THREAD = 4, /* at least, so that none waits for long */
    BAND_ROWS_LEAST = 16,
    BAND_ROWS_MOST = 128,
    TASKS_PER_THREAD = 8,        /* of a level's rows, */
    TASK_PIXELS_LEAST = 1 << 12, /* or fewer: of so many pixels */
    STRIP_ROWS_LEAST = 64
};

/* A pyramid that would take more is made for a part of the picture at a time. */
static const size_t PYRAMID_BYTES = (size_t)256 << 20;

struct iso_pullpush {
    iso_point_blocks blocks;
    iso_pyramid pyramid;
    iso_refined refined;
};

/* One call. */
typedef struct frame {
    const iso_target *target;
    const iso_point_view *points;
    iso_reconstruction reconstruction;
    const iso_pullpush_kernel *kernel;
    iso_projector projector;
    iso_point_blocks *blocks;
    iso_pyramid *pyramid;
    iso_point_projection projection;
    iso_pullpush_params params;
    int band_rows, band_levels;       /* levels that a band of the base level pulls by itself */
    int level, task_rows, level_rows; /* the step at hand */
} frame;

/* ---- preparation */

/* As high as they may be: blocks of points that lie in two bands are worked on twice. */
static void choose_bands(frame *f) {
    const int threads = iso_pool_threads(f->target->pool),
              bands = threads == 1 ? 1 : threads * BANDS_PER_THREAD;
    const int height = f->pyramid->level[f->pyramid->layout.base].height;
    size_t row = f->pyramid->key_stride * sizeof(int64_t);
    int most = f->pyramid->layout.top - f->pyramid->layout.base;
    f->band_rows = BAND_ROWS_LEAST;
    f->band_levels = 4;
    while (f->band_rows < BAND_ROWS_MOST && (size_t)f->band_rows * 2 * row <= BAND_BYTES &&
           f->band_rows * 2 * bands <= height) {
        f->band_rows *= 2;
        f->band_levels++;
    }
    if (f->band_levels > most) f->band_levels = most;
}

static iso_pyramid_layout choose_layout(const frame *f, const iso_view *view) {
    iso_pyramid_layout layout = iso_pullpush_layout(view, f->blocks->radius);
    if (f->points->radii) layout.planes |= 1u << ISO_PLANE_RADIUS;
    if (f->points->colors) layout.planes |= 7u << ISO_PLANE_RED;
    layout.indexed = layout.planes != 0;
    return layout;
}

static iso_status prepare(frame *f, iso_error *error) {
    const iso_view *view = f->target->view;
    bool cull = f->points->closed && !f->blocks->around_eye;
    iso_pyramid_layout layout = choose_layout(f, view);
    ISO_TRY(iso_pyramid_resize(f->pyramid, &layout, error));
    choose_bands(f);
    f->projection =
        iso_pullpush_projection(&layout, &f->projector, &f->points->transform, f->points->packed, cull);
    f->projection.points = f->points;
    f->projection.pyramid = f->pyramid;
    f->params = iso_pullpush_params_make(&layout, &f->projector, f->points->radius, f->reconstruction, !cull);
    f->params.pyramid = f->pyramid;
    f->params.target = f->target;
    return iso_point_blocks_assign_bands(f->blocks, view, f->pyramid, f->band_rows, cull, error);
}

/* ---- the steps, by rows */

/* Rows of a level's cells (kernel.h). */
static int cell_rows(const iso_pyramid *p, int level) {
    return iso_pyramid_level_of(&p->layout, level - 1).height / 2 + 1;
}

static iso_rows rows_within(int first, int count, int height) {
    return (iso_rows){first, first + count <= height ? first + count - 1 : height - 1};
}

/* A piece of a row of keys. That of the row after next comes towards the cache: the processor foresees few of
 * so many rows. */
static void empty_piece(int64_t *keys, size_t stride) {
    enum { LINE = ISO_ALIGNMENT / sizeof *keys };
    for (int k = 0; k < ISO_KEY_PIECE; k += LINE) __builtin_prefetch(keys + 2 * stride + k, 1, 2);
    for (int k = 0; k < ISO_KEY_PIECE; k++) keys[k] = ISO_KEY_NONE;
}

static void empty_keys(const iso_pyramid *p, iso_rows rows) {
    const size_t stride = p->key_stride, pieces = stride / ISO_KEY_PIECE;
    for (int y = rows.first / 2; y <= rows.last / 2; y++)
        for (size_t i = 0; i < pieces; i++) {
            if (!p->used[(size_t)y * pieces + i]) continue;
            int64_t *upper = p->keys + (size_t)(2 * y) * stride + i * ISO_KEY_PIECE;
            empty_piece(upper, stride);
            empty_piece(upper + stride, stride);
        }
}

static void project_band(const frame *f, size_t band, iso_rows rows) {
    const iso_pyramid *p = f->pyramid;
    const size_t *start = f->blocks->start.data;
    const uint32_t *order = f->blocks->order.data;
    const iso_block_list list = {f->blocks->blocks.data, order + start[band], start[band + 1] - start[band]};
    empty_keys(p, rows);
    f->kernel->project(&f->projection, &list, rows);
}

/* What the band's points have besides their keys, from their numbers. */
static void fetch_attributes(const frame *f, iso_rows rows) {
    const iso_pyramid *p = f->pyramid;
    const iso_pyramid_level *level = &p->level[p->layout.base];
    for (int y = rows.first; y <= rows.last; y++) {
        const int64_t *keys = p->keys + (size_t)y * p->key_stride;
        const int32_t *index = p->index + (size_t)y * p->key_stride;
        for (int x = 0; x < level->width; x++) {
            if (keys[x] == ISO_KEY_NONE) continue;
            size_t at = (size_t)y * level->stride + (size_t)x, point = (size_t)index[x];
            if (f->points->radii)
                level->plane[ISO_PLANE_RADIUS][at] = ISO_DISC_RADII * fmaxf(f->points->radii[point], 0);
            for (int k = 0; f->points->colors && k < 3; k++)
                level->plane[ISO_PLANE_RED + k][at] = f->points->colors[point][k];
        }
    }
}

/* A band of the base level, and what it covers of the levels above as far as that is whole rows. */
static void do_band(void *context, size_t band, int worker) {
    (void)worker;
    const frame *f = context;
    const iso_pyramid *p = f->pyramid;
    int base = p->layout.base;
    iso_rows rows = rows_within((int)band * f->band_rows, f->band_rows, p->level[base].height);
    project_band(f, band, rows);
    if (p->index) fetch_attributes(f, rows);
    if (base > 0) f->kernel->unpack(&f->params, rows);
    for (int i = 1; i <= f->band_levels; i++) {
        const iso_pyramid_level *level = &p->level[base + i];
        f->kernel->pull(&f->params, base + i,
                        rows_within((int)band * (f->band_rows >> i), f->band_rows >> i, level->height));
    }
}

static void pull_rows(void *context, size_t index, int worker) {
    (void)worker;
    const frame *f = context;
    f->kernel->pull(&f->params, f->level,
                    rows_within((int)index * f->task_rows, f->task_rows, f->level_rows));
}

static void fit_rows(void *context, size_t index, int worker) {
    (void)worker;
    const frame *f = context;
    f->kernel->ellipses(&f->params, f->level,
                        rows_within((int)index * f->task_rows, f->task_rows, f->level_rows));
}

static void push_rows(void *context, size_t index, int worker) {
    (void)worker;
    const frame *f = context;
    f->kernel->push(&f->params, f->level,
                    rows_within((int)index * f->task_rows, f->task_rows, f->level_rows));
}

/* A row of level 1's cells is drawn as soon as the two rows of pixels it lies between are there, so that they
 * are still in the cache: those inside a task by the task, the ones between tasks afterwards. */
static void push_and_finish(void *context, size_t index, int worker) {
    (void)worker;
    const frame *f = context;
    iso_rows rows = rows_within((int)index * f->task_rows, f->task_rows, f->level_rows);
    int end = cell_rows(f->pyramid, 1);
    for (int y = rows.first; y <= rows.last; y++) {
        f->kernel->push(&f->params, 2, (iso_rows){y, y});
        /* rows 2y - 1 and 2y of pixels are new */
        int first = y > rows.first ? 2 * y - 1 : 2 * y, last = 2 * y < end ? 2 * y : end - 1;
        f->kernel->finish(&f->params, (iso_rows){first, last});
    }
}

static void finish_between(void *context, size_t index, int worker) {
    (void)worker;
    const frame *f = context;
    iso_rows rows = rows_within((int)index * f->task_rows, f->task_rows, f->level_rows);
    int after = 2 * rows.last + 1;
    if (rows.first > 0) f->kernel->finish(&f->params, (iso_rows){2 * rows.first - 1, 2 * rows.first - 1});
    if (rows.last == f->level_rows - 1 && after < cell_rows(f->pyramid, 1))
        f->kernel->finish(&f->params, (iso_rows){after, after});
}

static void finish_rows(void *context, size_t index, int worker) {
    (void)worker;
    const frame *f = context;
    f->kernel->finish(&f->params, rows_within((int)index * f->task_rows, f->task_rows, f->level_rows));
}

/* Runs a step over rows of a level. */
static void for_rows(frame *f, int number, int rows, iso_task *task) {
    const int threads = iso_pool_threads(f->target->pool);
    int least = (int)(TASK_PIXELS_LEAST / f->pyramid->level[number].stride) + 1;
    int tasks = threads == 1 ? 1 : threads * TASKS_PER_THREAD;
    f->level = number;
    f->level_rows = rows;
    f->task_rows = (rows + tasks - 1) / tasks;
    if (f->task_rows < least) f->task_rows = least;
    tasks = (rows + f->task_rows - 1) / f->task_rows;
    iso_parallel_for(f->target->pool, (size_t)tasks, task, f);
}

static void for_level(frame *f, int number, iso_task *task) {
    for_rows(f, number, f->pyramid->level[number].height, task);
}

static void for_cells(frame *f, int number, iso_task *task) {
    for_rows(f, number, cell_rows(f->pyramid, number), task);
}

static void reconstruct(frame *f) {
    const iso_pyramid_layout *layout = &f->pyramid->layout;
    int bands = (f->pyramid->level[layout->base].height + f->band_rows - 1) / f->band_rows;
    iso_parallel_for(f->target->pool, (size_t)bands, do_band, f);
    for (int level = layout->base + f->band_levels + 1; level <= layout->top; level++)
        for_level(f, level, pull_rows);
    for_level(f, layout->top, fit_rows);
    for (int level = layout->top; level > 2; level--) for_cells(f, level, push_rows);
    if (layout->top == 1) {
        for_cells(f, 1, finish_rows);
    } else {
        for_cells(f, 2, push_and_finish);
        for_cells(f, 2, finish_between);
    }
}

/* ---- the interface */

iso_status iso_pullpush_create(iso_pullpush **pullpush, iso_error *error) {
    iso_pullpush *made = iso_alloc_zero(1, sizeof *made);
    if (!made) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for pull-push");
    *pullpush = made;
    return ISO_OK;
}

void iso_pullpush_destroy(iso_pullpush *pullpush) {
    if (!pullpush) return;
    iso_point_blocks_free(&pullpush->blocks);
    iso_pyramid_free(&pullpush->pyramid);
    iso_refined_free(&pullpush->refined);
    iso_free(pullpush);
}

/* Rows first .. first + count - 1 of the picture: the same as when all are drawn at once. */
static iso_status draw_rows(frame *f, const iso_target *whole, int first, int count, iso_error *error) {
    const iso_gbuffer *all = whole->gbuffer;
    size_t skip = (size_t)first * (size_t)all->width;
    iso_view view = iso_view_rows(whole->view, first, count);
    iso_gbuffer rows = *all;
    rows.height = count;
    rows.depth += skip;
    rows.surface += skip;
    if (rows.color) rows.color += skip;
    for (int axis = 0; axis < 3; axis++) rows.normal[axis] += skip;
    iso_target target = {&view, &rows, whole->pool, whole->surface};
    f->target = &target;
    f->projector.view = &view;
    ISO_TRY(prepare(f, error));
    reconstruct(f);
    return ISO_OK;
}

/* Rows that fit into PYRAMID_BYTES, or few. */
static int rows_at_once(const frame *f, const iso_view *view) {
    int rows = view->height;
    for (; rows > STRIP_ROWS_LEAST; rows = (rows + 1) / 2) {
        iso_view strip = iso_view_rows(view, 0, rows);
        iso_pyramid_layout layout = choose_layout(f, &strip);
        if (iso_pyramid_bytes(&layout) <= PYRAMID_BYTES) break;
    }
    return rows;
}

static iso_status draw(iso_pullpush *workspace, const iso_target *target, const iso_point_view *points,
                       iso_reconstruction reconstruction, iso_error *error) {
    const iso_view *view = target->view;
    frame f = {.points = points,
               .reconstruction = reconstruction,
               .kernel = iso_pullpush_kernel_get(iso_cpu_best()),
               .projector = iso_projector_make(view, &points->transform),
               .blocks = &workspace->blocks,
               .pyramid = &workspace->pyramid};
    ISO_TRY(iso_point_blocks_make(f.blocks, points, &f.projector, target->pool, error));
    if (f.blocks->seen == 0) return ISO_OK;
    if (points->colors) ISO_TRY(iso_gbuffer_add_color(target->gbuffer, error));
    if (reconstruction == ISO_RECONSTRUCTION_REFINED && !points->colors)
        return iso_refined_draw(&workspace->refined, target, points, f.blocks, error);
    int rows = rows_at_once(&f, view);
    for (int first = 0; first < view->height; first += rows)
        ISO_TRY(
            draw_rows(&f, target, first, view->height - first < rows ? view->height - first : rows, error));
    return ISO_OK;
}

iso_status iso_draw_pullpush(const iso_target *target, const iso_point_view *points,
                             const iso_pullpush_opts *opts, iso_error *error) {
    assert(target->view->width == target->gbuffer->width && target->view->height == target->gbuffer->height);
    iso_pullpush once = {0}, *workspace = opts && opts->workspace ? opts->workspace : &once;
    iso_status status =
        draw(workspace, target, points, opts ? opts->reconstruction : ISO_RECONSTRUCTION_REFINED, error);
    iso_point_blocks_free(&once.blocks);
    iso_pyramid_free(&once.pyramid);
    iso_refined_free(&once.refined);
    return status;
}
