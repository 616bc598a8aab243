/* pullpush: prepares a picture or a strip of it, and runs the steps (kernel.h) over rows of the
 * pyramid with all threads. Marroquim, Kraus and Cavalcanti 2008, section 3. */
#include "render/pullpush/pullpush.h"

#include <assert.h>

#include "render/pullpush/kernel.h"
#include "render/pullpush/keys.h"
#include "render/pullpush/line_fragments.h"
#include "render/pullpush/line_graph.h"
#include "render/pullpush/polygon_fragments.h"
#include "render/pullpush/set_fragments.h"
#include "render/pullpush/setup.h"

enum {
    BAND_BYTES = 5 << 18, /* keys of a band, at most: about the size of a second-level cache */
    BANDS_PER_THREAD = 4, /* at least, so that no thread waits long for the others */
    BAND_ROWS_LEAST = 16,
    BAND_ROWS_MOST = 128,
    TASKS_PER_THREAD = 8,        /* of a step over the rows of a level, */
    TASK_PIXELS_LEAST = 1 << 12, /* fewer when a task would have fewer pixels than this */
    STRIP_ROWS_LEAST = 64
};

/* Of several sets: ellipses of a smaller radius are none, pixels. */
static const float LEAST_RADIUS = 0.5f;

/* Limit of the pyramid's memory: a larger picture is drawn in strips. */
static const size_t PYRAMID_BYTES = (size_t)256 << 20;

struct iso_pullpush {
    iso_point_blocks blocks;
    /* Of points; of lines and of several sets: a change of a pyramid's planes clears all of its memory, and
     * points and lines take turns in every frame. */
    iso_pyramid pyramid, line_pyramid;
};

/* The drawing of one strip of the picture. */
typedef struct pullpush_call {
    const iso_target *target;
    const iso_point_view *points;
    iso_reconstruction reconstruction;
    const iso_pullpush_steps *steps;
    iso_projector projector;
    iso_point_blocks *blocks;
    iso_line_frame *lines;            /* NULL: points are drawn, with their blocks */
    const iso_pyramid_engine *engine; /* of lines and sets; NULL: the cpu */
    iso_polygons *polygons;           /* NULL, or triangles that are drawn with the points */
    iso_sets_frame *sets;             /* NULL, or all that is drawn */
    const iso_pullpush_keys *given;   /* NULL, or the keys of all points, which are not projected then */
    iso_pyramid *pyramid;
    iso_point_projection projection;
    iso_pullpush_params params;
    int band_rows;   /* rows of the base level in a band */
    int band_levels; /* levels above the base that a band's task pulls: as far as it covers whole rows */
    int level, task_rows, level_rows; /* of the current step: level, rows of a task, rows in all */
} pullpush_call;

/* ---- preparation */

/* Bands are as high as cache and number of threads allow: a block of points is projected once for every band
 * that it covers. */
static void choose_bands(pullpush_call *call) {
    const int threads = iso_pool_threads(call->target->pool),
              bands = threads == 1 ? 1 : threads * BANDS_PER_THREAD;
    const int height = call->pyramid->level[call->pyramid->layout.base].height;
    size_t row = call->pyramid->key_stride * sizeof(int64_t);
    int most = call->pyramid->layout.top - call->pyramid->layout.base;
    call->band_rows = BAND_ROWS_LEAST;
    call->band_levels = 4;
    while (call->band_rows < BAND_ROWS_MOST && (size_t)call->band_rows * 2 * row <= BAND_BYTES &&
           call->band_rows * 2 * bands <= height) {
        call->band_rows *= 2;
        call->band_levels++;
    }
    if (call->band_levels > most) call->band_levels = most;
}

/* Lines are followed in the base level, so that pixels depend on more rows than those of points do. */
static iso_pyramid_layout choose_lines_layout(const iso_line_frame *lines, const iso_view *view) {
    const int more = 2 << iso_pullpush_layout(view, lines->radius).top;
    const int above = more < view->above ? more : view->above,
              below = more < view->below ? more : view->below;
    iso_view wide = *view;
    wide.above -= above;
    wide.height += above + below;
    wide.below -= below;
    iso_pyramid_layout layout = iso_pullpush_layout(&wide, lines->radius);
    layout.row -= above;
    layout.planes =
        1u << ISO_PLANE_RADIUS | 1u << ISO_PLANE_INTERVAL | 63u << ISO_PLANE_SHAPE_XX | 3u << ISO_PLANE_PLACE;
    if (lines->lines->lines.colors) layout.planes |= 7u << ISO_PLANE_RED;
    layout.indexed = 1;
    return layout;
}

static iso_pyramid_layout choose_layout(const pullpush_call *call, const iso_view *view) {
    if (call->given) return iso_pyramid_layout_of(view, call->given->base.base, call->given->base.top);
    if (call->sets) {
        const float radius[2] = {0, call->sets->radius[1]}; /* triangles need the picture's resolution */
        iso_pyramid_layout layout = iso_pullpush_layout(view, radius);
        layout.planes = 1u << ISO_PLANE_RADIUS | 1u << ISO_PLANE_INTERVAL | 63u << ISO_PLANE_SHAPE_XX |
                        1u << ISO_PLANE_SET;
        if (call->sets->colored) layout.planes |= 7u << ISO_PLANE_RED;
        layout.indexed = 1;
        return layout;
    }
    if (call->lines) return choose_lines_layout(call->lines, view);
    if (call->polygons) {
        /* triangles need the picture's resolution */
        const float radius[2] = {0, call->blocks->seen ? call->blocks->radius[1] : 0};
        return iso_pullpush_layout(view, radius);
    }
    iso_pyramid_layout layout = iso_pullpush_layout(view, call->blocks->radius);
    if (call->points->radii) layout.planes |= 1u << ISO_PLANE_RADIUS;
    if (call->points->colors) layout.planes |= 7u << ISO_PLANE_RED;
    layout.indexed = layout.planes != 0;
    return layout;
}

static iso_status prepare_lines(pullpush_call *call, iso_error *error) {
    const iso_pyramid_layout layout = choose_layout(call, call->target->view);
    ISO_TRY(iso_pyramid_resize(call->pyramid, &layout, error));
    choose_bands(call);
    call->band_levels = 0; /* pull needs the fragments of all bands */
    const bool ribbons = call->lines->lines->opts.style == ISO_LINE_RIBBON;
    call->params = iso_pullpush_params_of_intervals(&layout, &call->projector, ISO_RECONSTRUCTION_GAUSSIAN,
                                                    ribbons ? ISO_PULLPUSH_RIBBONS : ISO_PULLPUSH_TUBES);
    call->params.illuminated = call->lines->lines->opts.shading == ISO_LINE_ILLUMINATED;
    call->params.pyramid = call->pyramid;
    call->params.target = call->target;
    call->lines->view = call->target->view;
    return ISO_OK;
}

static iso_status prepare_given(pullpush_call *call, iso_error *error) {
    const iso_pyramid_layout layout = choose_layout(call, call->target->view);
    ISO_TRY(iso_pyramid_resize(call->pyramid, &layout, error));
    choose_bands(call);
    call->params =
        iso_pullpush_params_make(&layout, &call->projector, call->points->radius, call->points->dims,
                                 call->reconstruction, !call->given->base.cull);
    call->params.pyramid = call->pyramid;
    call->params.target = call->target;
    return ISO_OK;
}

static iso_status prepare_pyramid(pullpush_call *call, iso_error *error) {
    const iso_view *view = call->target->view;
    bool cull = call->points->closed && !call->blocks->around_eye;
    iso_pyramid_layout layout = choose_layout(call, view);
    ISO_TRY(iso_pyramid_resize(call->pyramid, &layout, error));
    choose_bands(call);
    call->projection = iso_pullpush_projection(&layout, &call->projector, &call->points->transform,
                                               call->points->packed, cull);
    call->projection.points = call->points;
    call->projection.pyramid = call->pyramid;
    call->params = iso_pullpush_params_make(&layout, &call->projector, call->points->radius,
                                            call->points->dims, call->reconstruction, !cull);
    if (call->pyramid->index) {
        call->params.radii = call->points->radii;
        call->params.colors = call->points->colors;
    }
    call->params.pyramid = call->pyramid;
    call->params.target = call->target;
    if (call->polygons) ISO_TRY(iso_polygons_rasterize(call->polygons, call->target, &layout, error));
    const iso_level_bands bands = iso_pyramid_bands(call->pyramid, call->band_rows);
    return iso_point_blocks_assign_bands(call->blocks, view, &bands, cull, error);
}

static iso_status prepare_sets(pullpush_call *call, iso_error *error) {
    const iso_pyramid_layout layout = choose_layout(call, call->target->view);
    ISO_TRY(iso_pyramid_resize(call->pyramid, &layout, error));
    choose_bands(call);
    call->params =
        iso_pullpush_params_of_intervals(&layout, &call->projector, call->reconstruction, ISO_PULLPUSH_SETS);
    call->params.pyramid = call->pyramid;
    call->params.target = call->target;
    call->params.least_radius = LEAST_RADIUS;
    if (call->engine) call->band_levels = 0; /* it pulls */
    return iso_sets_frame_prepare(call->sets, call->target, call->pyramid, call->band_rows, error);
}

/* ---- the steps, by rows */

/* Number of rows of cells of a level (see iso_pullpush_steps.push_rows). */
static int cell_rows(const iso_pyramid *p, int level) {
    return iso_pyramid_level_of(&p->layout, level - 1).height / 2 + 1;
}

static iso_rows rows_within(int first, int count, int height) {
    return (iso_rows){first, first + count <= height ? first + count - 1 : height - 1};
}

/* Empties a piece of a row of keys and prefetches the piece two rows below: hardware prefetchers follow fewer
 * rows at a time than are written here. */
static void empty_key_piece(int64_t *keys, size_t stride) {
    enum { LINE = ISO_ALIGNMENT / sizeof *keys };
    for (int k = 0; k < ISO_KEY_PIECE; k += LINE) __builtin_prefetch(keys + 2 * stride + k, 1, 2);
    for (int k = 0; k < ISO_KEY_PIECE; k++) keys[k] = ISO_KEY_NONE;
}

/* Empties the keys of rows, as far as they were used. */
static void empty_keys(const iso_pyramid *p, iso_rows rows) {
    const size_t stride = p->key_stride, pieces = stride / ISO_KEY_PIECE;
    for (int y = rows.first / 2; y <= rows.last / 2; y++)
        for (size_t i = 0; i < pieces; i++) {
            if (!p->used[(size_t)y * pieces + i]) continue;
            int64_t *upper = p->keys + (size_t)(2 * y) * stride + i * ISO_KEY_PIECE;
            empty_key_piece(upper, stride);
            empty_key_piece(upper + stride, stride);
        }
}

/* Notes that any of the keys of rows may be used: pull, which knows, is another engine's. */
static void use_all_keys(const iso_pyramid *p, iso_rows rows) {
    const size_t pieces = p->key_stride / ISO_KEY_PIECE;
    for (int y = rows.first / 2; y <= rows.last / 2; y++) memset(p->used + (size_t)y * pieces, 1, pieces);
}

/* Copies the keys of rows of the pyramid's base level, and gives them their sign. */
static void copy_keys(const pullpush_call *call, iso_rows rows) {
    const iso_pyramid *p = call->pyramid;
    const iso_key_image *from = call->given->keys;
    const int above = p->layout.rows_before >> p->layout.base;
    for (int y = rows.first; y <= rows.last; y++) {
        const uint64_t *source = from->keys + (size_t)(y + above) * (size_t)from->width;
        int64_t *target = p->keys + (size_t)y * p->key_stride;
        for (int x = 0; x < from->width; x++) target[x] = (int64_t)(source[x] ^ (uint64_t)1 << 63);
    }
}

static void project_band(const pullpush_call *call, size_t band, iso_rows rows) {
    const iso_pyramid *p = call->pyramid;
    empty_keys(p, rows);
    if (call->given) {
        copy_keys(call, rows);
        return;
    }
    if (call->sets) {
        iso_set_fragments_project(call->sets, p, band, rows);
        if (call->engine) use_all_keys(p, rows);
        return;
    }
    if (call->lines) {
        iso_line_fragments_project(call->lines, p, rows);
        iso_line_graph_count_rows(p, rows);
        return;
    }
    const size_t *start = call->blocks->start.data;
    const uint32_t *order = call->blocks->order.data;
    const iso_block_list list = {call->blocks->blocks.data, order + start[band],
                                 start[band + 1] - start[band]};
    iso_pullpush_project_get()(&call->projection, &list, rows);
    if (call->polygons) iso_polygon_fragments_project(call->polygons, p, rows);
}

/* Fetches radius and colour of the point of each pixel of a band, by the point's number. */
static void fetch_attributes(const pullpush_call *call, iso_rows rows) {
    const iso_pyramid *p = call->pyramid;
    const iso_pyramid_level *level = &p->level[p->layout.base];
    for (int y = rows.first; y <= rows.last; y++) {
        const int64_t *keys = p->keys + (size_t)y * p->key_stride;
        const int32_t *index = p->index + (size_t)y * p->key_stride;
        for (int x = 0; x < level->width; x++) {
            if (keys[x] == ISO_KEY_NONE) continue;
            size_t at = (size_t)y * level->stride + (size_t)x, point = (size_t)index[x];
            if (call->points->radii)
                level->plane[ISO_PLANE_RADIUS][at] = ISO_DISC_RADII * fmaxf(call->points->radii[point], 0);
            for (int k = 0; call->points->colors && k < 3; k++)
                level->plane[ISO_PLANE_RED + k][at] = call->points->colors[point][k];
        }
    }
}

/* Task: projects the points into a band of the base level, and pulls the rows of the levels above that
 * depend on this band alone. */
static void project_and_pull_band(void *context, size_t band, int worker) {
    (void)worker;
    const pullpush_call *call = context;
    const iso_pyramid *p = call->pyramid;
    int base = p->layout.base;
    iso_rows rows = rows_within((int)band * call->band_rows, call->band_rows, p->level[base].height);
    project_band(call, band, rows);
    if (call->lines) return;
    if (call->sets && call->engine) return;
    if (p->index && !call->sets) fetch_attributes(call, rows);
    if (base > 0) call->steps->unpack_keys(&call->params, rows);
    for (int i = 1; i <= call->band_levels; i++) {
        const iso_pyramid_level *level = &p->level[base + i];
        call->steps->pull_rows(
            &call->params, base + i,
            rows_within((int)band * (call->band_rows >> i), call->band_rows >> i, level->height));
    }
}

static void pull_rows(void *context, size_t index, int worker) {
    (void)worker;
    const pullpush_call *call = context;
    call->steps->pull_rows(&call->params, call->level,
                           rows_within((int)index * call->task_rows, call->task_rows, call->level_rows));
}

static void make_ellipse_rows(void *context, size_t index, int worker) {
    (void)worker;
    const pullpush_call *call = context;
    call->steps->make_ellipses(&call->params, call->level,
                               rows_within((int)index * call->task_rows, call->task_rows, call->level_rows));
}

static void push_rows(void *context, size_t index, int worker) {
    (void)worker;
    const pullpush_call *call = context;
    call->steps->push_rows(&call->params, call->level,
                           rows_within((int)index * call->task_rows, call->task_rows, call->level_rows));
}

/* Task: pushes to level 1 and draws each row of level 1's cells as soon as the two rows of pixels beside it
 * exist, while these are in the cache. The rows of cells between two tasks are drawn afterwards, by
 * finish_rows_between_tasks. */
static void push_and_finish_rows(void *context, size_t index, int worker) {
    (void)worker;
    const pullpush_call *call = context;
    iso_rows rows = rows_within((int)index * call->task_rows, call->task_rows, call->level_rows);
    int end = cell_rows(call->pyramid, 1);
    for (int y = rows.first; y <= rows.last; y++) {
        call->steps->push_rows(&call->params, 2, (iso_rows){y, y});
        /* this made rows 2y - 1 and 2y of level 1 */
        int first = y > rows.first ? 2 * y - 1 : 2 * y, last = 2 * y < end ? 2 * y : end - 1;
        call->steps->finish_samples(&call->params, (iso_rows){first, last});
    }
}

static void finish_rows_between_tasks(void *context, size_t index, int worker) {
    (void)worker;
    const pullpush_call *call = context;
    iso_rows rows = rows_within((int)index * call->task_rows, call->task_rows, call->level_rows);
    int after = 2 * rows.last + 1;
    if (rows.first > 0)
        call->steps->finish_samples(&call->params, (iso_rows){2 * rows.first - 1, 2 * rows.first - 1});
    if (rows.last == call->level_rows - 1 && after < cell_rows(call->pyramid, 1))
        call->steps->finish_samples(&call->params, (iso_rows){after, after});
}

static void finish_rows(void *context, size_t index, int worker) {
    (void)worker;
    const pullpush_call *call = context;
    call->steps->finish_samples(&call->params,
                                rows_within((int)index * call->task_rows, call->task_rows, call->level_rows));
}

/* Runs a step over `rows` rows of pixels or cells of level `number`, with all threads. */
static void run_over_rows(pullpush_call *call, int number, int rows, iso_task *task) {
    const int threads = iso_pool_threads(call->target->pool);
    int least = (int)(TASK_PIXELS_LEAST / call->pyramid->level[number].stride) + 1;
    int tasks = threads == 1 ? 1 : threads * TASKS_PER_THREAD;
    call->level = number;
    call->level_rows = rows;
    call->task_rows = (rows + tasks - 1) / tasks;
    if (call->task_rows < least) call->task_rows = least;
    tasks = (rows + call->task_rows - 1) / call->task_rows;
    iso_parallel_for(call->target->pool, (size_t)tasks, task, call);
}

static void run_over_level(pullpush_call *call, int number, iso_task *task) {
    run_over_rows(call, number, call->pyramid->level[number].height, task);
}

static void run_over_cells(pullpush_call *call, int number, iso_task *task) {
    run_over_rows(call, number, cell_rows(call->pyramid, number), task);
}

static void make_line_rows(void *context, size_t index, int worker) {
    (void)worker;
    const pullpush_call *call = context;
    const iso_rows rows = rows_within((int)index * call->task_rows, call->task_rows, call->level_rows);
    iso_line_graph_make_rows(&call->params, rows);
    if (call->level > 0) call->steps->unpack_keys(&call->params, rows);
}

static void link_line_rows(void *context, size_t index, int worker) {
    (void)worker;
    const pullpush_call *call = context;
    iso_line_graph_link_rows(&call->params,
                             rows_within((int)index * call->task_rows, call->task_rows, call->level_rows));
}

static iso_status reconstruct_surface(pullpush_call *call, iso_error *error) {
    const iso_pyramid_layout *layout = &call->pyramid->layout;
    int bands = (call->pyramid->level[layout->base].height + call->band_rows - 1) / call->band_rows;
    iso_parallel_for(call->target->pool, (size_t)bands, project_and_pull_band, call);
    if (call->lines) {
        ISO_TRY(iso_line_graph_reserve(call->pyramid, error));
        run_over_level(call, layout->base, make_line_rows);
        run_over_level(call, layout->base, link_line_rows);
    }
    if (call->engine) return call->engine->draw(call->engine->context, &call->params, error);
    for (int level = layout->base + call->band_levels + 1; level <= layout->top; level++)
        run_over_level(call, level, pull_rows);
    run_over_level(call, layout->top, make_ellipse_rows);
    for (int level = layout->top; level > 2; level--) run_over_cells(call, level, push_rows);
    if (layout->top == 1) {
        run_over_cells(call, 1, finish_rows);
    } else {
        run_over_cells(call, 2, push_and_finish_rows);
        run_over_cells(call, 2, finish_rows_between_tasks);
    }
    return ISO_OK;
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
    iso_pyramid_free(&pullpush->line_pyramid);
    iso_free(pullpush);
}

/* Draws rows first .. first + count - 1 of the picture; the bytes are those of drawing all rows at once. */
static iso_status draw_rows(pullpush_call *call, const iso_target *whole, int first, int count,
                            iso_error *error) {
    const iso_gbuffer *all = whole->gbuffer;
    size_t skip = (size_t)first * (size_t)all->width;
    iso_view view = iso_view_rows(whole->view, first, count);
    iso_gbuffer rows = *all;
    rows.height = count;
    rows.depth += skip;
    rows.surface += skip;
    if (rows.color) rows.color += skip;
    for (int axis = 0; axis < 3; axis++) rows.normal[axis] += skip;
    iso_target target = {&view, &rows, whole->pool, whole->surface, whole->clip};
    call->target = &target;
    call->projector.view = &view;
    ISO_TRY(call->sets    ? prepare_sets(call, error)
            : call->lines ? prepare_lines(call, error)
            : call->given ? prepare_given(call, error)
                          : prepare_pyramid(call, error));
    call->steps = iso_pullpush_steps_get(call->params.kind);
    ISO_TRY(reconstruct_surface(call, error));
    if (call->polygons) iso_polygons_draw(call->polygons, call->target, &call->pyramid->layout);
    return ISO_OK;
}

/* Rows of a strip: as many as PYRAMID_BYTES allows, but not fewer than about STRIP_ROWS_LEAST / 2. */
static int rows_at_once(const pullpush_call *call, const iso_view *view) {
    int rows = view->height;
    for (; rows > STRIP_ROWS_LEAST; rows = (rows + 1) / 2) {
        iso_view strip = iso_view_rows(view, 0, rows);
        iso_pyramid_layout layout = choose_layout(call, &strip);
        if (iso_pyramid_bytes(&layout) <= PYRAMID_BYTES) break;
    }
    return rows;
}

static iso_status draw_strips(pullpush_call *call, const iso_target *target, iso_error *error) {
    const int height = target->view->height, rows = rows_at_once(call, target->view);
    for (int first = 0; first < height; first += rows)
        ISO_TRY(draw_rows(call, target, first, height - first < rows ? height - first : rows, error));
    return ISO_OK;
}

/* `polygons`: triangles that are drawn with the points; NULL: none. */
static iso_status draw_surface(const iso_target *target, const iso_point_view *points, iso_polygons *polygons,
                               const iso_pullpush_opts *opts, iso_error *error) {
    assert(target->view->width == target->gbuffer->width && target->view->height == target->gbuffer->height);
    iso_pullpush once = {0}, *workspace = opts->workspace ? opts->workspace : &once;
    pullpush_call call = {.points = points,
                          .reconstruction = opts->reconstruction,
                          .projector = iso_projector_make(target->view, &points->transform),
                          .blocks = &workspace->blocks,
                          .polygons = polygons,
                          .pyramid = &workspace->pyramid};
    iso_status status = iso_point_blocks_make(call.blocks, points, &call.projector, target->pool, error);
    if (status == ISO_OK && (call.blocks->seen || polygons)) {
        if (points->colors) status = iso_gbuffer_add_color(target->gbuffer, error);
        if (status == ISO_OK) status = draw_strips(&call, target, error);
    }
    iso_point_blocks_free(&once.blocks);
    iso_pyramid_free(&once.pyramid);
    return status;
}

iso_status iso_draw_pullpush(const iso_target *target, const iso_point_view *points,
                             const iso_pullpush_opts *opts, iso_error *error) {
    return draw_surface(target, points, NULL, opts, error);
}

iso_status iso_pullpush_draw_merged(const iso_target *target, const iso_pullpush_keys *picture,
                                    const iso_point_view *points, iso_reconstruction reconstruction,
                                    iso_error *error) {
    iso_pyramid pyramid = {0};
    pullpush_call call = {.points = points,
                          .reconstruction = reconstruction,
                          .projector = iso_projector_make(target->view, &points->transform),
                          .given = picture,
                          .pyramid = &pyramid};
    const iso_status status = draw_strips(&call, target, error);
    iso_pyramid_free(&pyramid);
    return status;
}

iso_status iso_draw_points_and_polygons(const iso_target *target, const iso_point_view *points,
                                        iso_polygons *polygons, iso_pullpush *workspace, iso_error *error) {
    const iso_pullpush_opts opts = {ISO_RECONSTRUCTION_GAUSSIAN, workspace};
    return draw_surface(target, points, polygons, &opts, error);
}

iso_status iso_draw_pyramid_lines_by(const iso_pyramid_engine *engine, const iso_target *target,
                                     const iso_pyramid_lines *lines, iso_pullpush *workspace,
                                     iso_error *error) {
    const iso_transform world = iso_transform_identity();
    iso_pullpush once = {0};
    iso_line_frame frame;
    ISO_TRY(iso_line_frame_make(lines, target, &frame, error));
    pullpush_call call = {.lines = &frame,
                          .engine = engine,
                          .projector = iso_projector_make(target->view, &world),
                          .pyramid = workspace ? &workspace->line_pyramid : &once.line_pyramid};
    iso_status status = ISO_OK;
    if (frame.radius[0] <= frame.radius[1]) {
        if (lines->lines.colors) status = iso_gbuffer_add_color(target->gbuffer, error);
        if (status == ISO_OK) status = draw_strips(&call, target, error);
    }
    iso_line_frame_free(&frame);
    iso_pyramid_free(&once.line_pyramid);
    return status;
}

iso_status iso_draw_pyramid_lines(const iso_target *target, const iso_pyramid_lines *lines,
                                  iso_pullpush *workspace, iso_error *error) {
    return iso_draw_pyramid_lines_by(NULL, target, lines, workspace, error);
}

static iso_status draw_sets(const iso_pyramid_engine *engine, const iso_target *target, iso_sets_frame *frame,
                            iso_reconstruction reconstruction, iso_pyramid *pyramid, iso_error *error) {
    pullpush_call call = {.sets = frame,
                          .engine = engine,
                          .reconstruction = reconstruction,
                          .projector = frame->projector,
                          .pyramid = pyramid};
    if (frame->radius[0] > frame->radius[1] && !frame->polygons.count) return ISO_OK;
    if (frame->colored) ISO_TRY(iso_gbuffer_add_color(target->gbuffer, error));
    return draw_strips(&call, target, error);
}

iso_status iso_draw_pyramid_sets_by(const iso_pyramid_engine *engine, const iso_target *target,
                                    const iso_pyramid_set *sets, size_t count, const iso_pullpush_opts *opts,
                                    iso_error *error) {
    iso_pullpush once = {0};
    iso_sets_frame frame;
    iso_status status = iso_sets_frame_make(sets, count, target, &frame, error);
    if (status == ISO_OK)
        status =
            draw_sets(engine, target, &frame, opts ? opts->reconstruction : ISO_RECONSTRUCTION_GAUSSIAN,
                      opts && opts->workspace ? &opts->workspace->line_pyramid : &once.line_pyramid, error);
    iso_sets_frame_free(&frame);
    iso_pyramid_free(&once.line_pyramid);
    return status;
}

iso_status iso_draw_pyramid_sets(const iso_target *target, const iso_pyramid_set *sets, size_t count,
                                 const iso_pullpush_opts *opts, iso_error *error) {
    return iso_draw_pyramid_sets_by(NULL, target, sets, count, opts, error);
}
