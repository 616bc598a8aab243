#include "render/refined/refined.h"

#include <math.h>
#include <string.h>

#include "render/refined/kernel.h"
#include "render/refined/refined_numbers.h"
#include "render/refined/setup.h"

enum {
    PATCH_WIDTH = 128, /* pixels: a worker's sums stay in the cache that is its own */
    PATCH_HEIGHT = 64,
    LANES = 16, /* of the widest vectors */
    CELL_SHIFT_LEAST = 3,
    LAYERS = 4096, /* of depth, which blocks are sorted into */
    LOOKS = 6,     /* at what is hidden, while a patch is drawn */
    FETCHED = 512  /* points of a block, at most */
};

/* One call. */
typedef struct frame {
    iso_refined_params params;
    const iso_refined_kernel *kernel;
    const iso_point_blocks *blocks;
    iso_refined *workspace;
    int across, down;      /* patches of the picture */
    size_t stride, pixels; /* of a patch: in a row, and in all */
    int shift, wide, high; /* of what is hidden: see iso_refined_patch; cells of a patch */
    float behind;          /* mm that hidden discs' centres are behind what hides them, at least */
} frame;

/* Patches of the picture: columns and rows of them. */
typedef struct patches {
    int16_t first[2], last[2];
} patches;

/* ---- preparation */

static iso_status set_up_corners(frame *f, const iso_projector *projector, iso_error *error) {
    const iso_point_block *block = f->blocks->blocks.data;
    const double low = (double)f->params.low;
    ISO_TRY(iso_buffer_reserve(&f->workspace->corners, f->blocks->count * sizeof(float[3]), 0, error));
    float(*corner)[3] = f->workspace->corners.data;
    for (size_t i = 0; i < f->blocks->count; i++) {
        double at[3];
        for (int k = 0; k < 3; k++) at[k] = block[i].brick[k] * (double)ISO_BRICK + low;
        for (int k = 0; k < 3; k++) {
            const double *m = projector->matrix + 3 * k;
            corner[i][k] = (float)(m[0] * at[0] + m[1] * at[1] + m[2] * at[2] + projector->origin[k]);
        }
    }
    f->params.corner = (const float(*)[3])corner;
    return ISO_OK;
}

/* Surfaces end where their grid does, in the midst of discs. */
static void set_up_border(iso_refined_params *params) {
    const int32_t *dims = params->points->dims;
    params->bordered = dims[0] > 0 && dims[1] > 0 && dims[2] > 0;
    params->per_mm = iso_refined_per_mm(params->normal);
    for (int k = 0; k < 3; k++) params->border[k] = (float)(dims[k] - 1);
}

/* Balls are measured in voxels, of which the largest side is `side` mm. */
static void set_up_metric(iso_refined_params *params, const double spacing[3]) {
    const double side = fmax(spacing[0], fmax(spacing[1], spacing[2]));
    int i = 0;
    params->uneven = spacing[0] != spacing[1] || spacing[1] != spacing[2];
    for (int r = 0; r < 3; r++)
        for (int c = r; c < 3; c++, i++) {
            double sum = 0;
            for (int k = 0; k < 3; k++)
                sum += (double)params->normal[3 * r + k] * (double)params->normal[3 * c + k];
            params->metric[i] = (float)(sum * side * side * (r == c ? 1 : 2));
        }
}

static void set_up_job(frame *f, const iso_projector *projector) {
    iso_refined_params *params = &f->params;
    const iso_view *view = params->target->view;
    params->low = params->points->packed ? ISO_POINT_LOW : 0;
    params->voxels = params->points->packed ? ISO_POINT_STEP : 1;
    for (int k = 0; k < 9; k++) params->step[k] = (float)(projector->matrix[k] * (double)params->voxels);
    memcpy(params->normal, projector->normal, sizeof params->normal);
    params->reach[0] = ISO_REFINED_BALL;
    params->reach[1] = ISO_REFINED_BALL_MORE;
    params->grow_from = ISO_REFINED_GROW_FROM;
    params->grow = 1 / ISO_REFINED_GROW_OVER;
    params->radius = params->points->radius > 0 ? (float)params->points->radius : 0;
    params->focal = (float)view->focal;
    params->slope = view->orthographic ? 0 : (float)(1 / view->focal);
    params->axis[0] = (float)view->cx;
    params->axis[1] = (float)(view->cy + view->above);
    params->slant = iso_refined_slant(view, 0);
    const double *spacing = params->points->transform.spacing;
    set_up_metric(params, spacing);
    if (!params->uneven) params->per_length = (float)spacing[0];
    params->near = view->near < -ISO_NOWHERE ? -ISO_NOWHERE : (float)view->near;
    params->orthographic = view->orthographic;
    params->cull = params->points->closed && !f->blocks->around_eye;
    set_up_border(params);
}

static void choose_patches(frame *f) {
    const iso_view *view = f->params.target->view;
    f->across = (view->width + PATCH_WIDTH - 1) / PATCH_WIDTH;
    f->down = (view->height + PATCH_HEIGHT - 1) / PATCH_HEIGHT;
    const int width = view->width < PATCH_WIDTH ? view->width : PATCH_WIDTH,
              height = view->height < PATCH_HEIGHT ? view->height : PATCH_HEIGHT;
    f->stride = (size_t)(width + LANES - 1) / LANES * LANES;
    f->pixels = f->stride * (size_t)((height + 3) / 4 * 4); /* (whole tiles) */
}

/* Cells are as large as discs, which so lie in their own and the eight around it. */
static void set_up_hiding(frame *f) {
    const float most =
        f->blocks->radius[1] / ISO_DISC_RADII * (ISO_REFINED_BALL + ISO_REFINED_BALL_MORE) * f->params.slant;
    f->shift = CELL_SHIFT_LEAST;
    while (f->shift < 16 && most > (float)(1 << f->shift)) f->shift++;
    const size_t side = (size_t)1 << f->shift;
    f->wide = (int)((f->stride + side - 1) >> f->shift);
    f->high = (int)((f->pixels / f->stride + side - 1) >> f->shift);
    /* A disc may reach towards the eye by its radius, and joins what is 1.5 radii before it; where that was
     * turned, what faces the eye takes its place from as far behind. */
    const float radius = f->params.radius * (ISO_REFINED_BALL + ISO_REFINED_BALL_MORE);
    f->behind = f->params.points->radii ? ISO_NOWHERE : (f->params.cull ? 2.6f : 4.1f) * radius;
}

/* The patches that a block's discs can reach. */
static patches patches_of(const frame *f, const iso_point_block *block) {
    const iso_view *view = f->params.target->view;
    const double reach = (double)(iso_refined_reach(block) * f->params.slant + 2);
    const int most[2] = {f->across, f->down}, size[2] = {PATCH_WIDTH, PATCH_HEIGHT};
    patches in = {{0, 0}, {-1, -1}};
    if (!block->seen || (f->params.cull && block->back_facing)) return in;
    for (int k = 0; k < 2; k++) {
        const int32_t *range = k ? block->row : block->column;
        const double axis = k ? view->cy : view->cx;
        const double first = (range[0] + axis - reach) / size[k], last = (range[1] + axis + reach) / size[k];
        if (!(first < most[k] && last >= 0)) return (patches){{0, 0}, {-1, -1}};
        in.first[k] = (int16_t)(first < 0 ? 0 : first);
        in.last[k] = (int16_t)(last < most[k] ? last : most[k] - 1);
    }
    return in;
}

/* Sorts the blocks by depth, as their corners have it: what is in front comes first and hides the rest. All
 * of them take part, so that a strip of a picture has them in the same order. */
static iso_status sort(frame *f, uint32_t **sorted, iso_error *error) {
    const float(*corner)[3] = f->params.corner;
    const size_t count = f->blocks->count;
    ISO_TRY(iso_buffer_reserve(&f->workspace->sorted, count * sizeof **sorted, 0, error));
    *sorted = f->workspace->sorted.data;
    size_t start[LAYERS + 1] = {0};
    float least = INFINITY, most = -INFINITY;
    for (size_t i = 0; i < count; i++) {
        least = corner[i][2] < least ? corner[i][2] : least;
        most = corner[i][2] > most ? corner[i][2] : most;
    }
    const float scale = most > least ? (LAYERS - 1) / (most - least) : 0;
    for (size_t i = 0; i < count; i++) start[(size_t)((corner[i][2] - least) * scale) + 1]++;
    for (size_t k = 1; k <= LAYERS; k++) start[k] += start[k - 1];
    for (size_t i = 0; i < count; i++)
        (*sorted)[start[(size_t)((corner[i][2] - least) * scale)]++] = (uint32_t)i;
    return ISO_OK;
}

/* Lists the blocks of each patch, sorted: patch p's are order[start[p]] .. order[start[p + 1] - 1]. */
static iso_status deal(frame *f, iso_error *error) {
    const iso_point_block *block = f->blocks->blocks.data;
    iso_refined *w = f->workspace;
    const size_t count = f->blocks->count, all = (size_t)f->across * (size_t)f->down;
    ISO_TRY(iso_buffer_reserve(&w->start, (all + 2) * sizeof(size_t), 0, error));
    ISO_TRY(iso_buffer_reserve(&w->reached, count * sizeof(patches), 0, error));
    uint32_t *sorted;
    ISO_TRY(sort(f, &sorted, error));
    size_t *start = w->start.data;
    patches *reached = w->reached.data;
    memset(start, 0, (all + 2) * sizeof(size_t));
    for (size_t i = 0; i < count; i++) {
        const patches in = reached[i] = patches_of(f, &block[i]);
        for (int y = in.first[1]; y <= in.last[1]; y++)
            for (int x = in.first[0]; x <= in.last[0]; x++) start[y * f->across + x + 2]++;
    }
    for (size_t p = 0; p < all; p++) start[p + 2] += start[p + 1];
    ISO_TRY(iso_buffer_reserve(&w->order, (start[all + 1] + 1) * sizeof(uint32_t), 0, error));
    uint32_t *order = w->order.data;
    for (size_t i = 0; i < count; i++) {
        const patches in = reached[sorted[i]];
        for (int y = in.first[1]; y <= in.last[1]; y++)
            for (int x = in.first[0]; x <= in.last[0]; x++) order[start[y * f->across + x + 1]++] = sorted[i];
    }
    return ISO_OK;
}

/* ---- patches */

/* A patch as it is drawn. */
typedef struct drawing {
    iso_refined_patch patch;
    const uint32_t *order; /* its blocks */
    size_t count;
    bool tiles;
    float *hidden, *deepest; /* of its cells; `hidden` of all of them at least `least` */
    float least;
} drawing;

static size_t worker_bytes(const frame *f) {
    return (f->pixels * (ISO_SUMS + 1) + 2 * (size_t)(f->wide * f->high)) * sizeof(float);
}

static drawing start_patch(const frame *f, size_t number, int worker) {
    const size_t *start = f->workspace->start.data;
    const iso_view *view = f->params.target->view;
    const int x = (int)number % f->across * PATCH_WIDTH, y = (int)number / f->across * PATCH_HEIGHT;
    float *sums = (float *)((char *)f->workspace->memory.data + (size_t)worker * worker_bytes(f)),
          *front = sums + f->pixels * ISO_SUMS, *hidden = front + f->pixels;
    for (size_t i = 0; i < f->pixels; i++) front[i] = ISO_NOWHERE;
    return (drawing){
        .patch = {.first = {x, y},
                  .last = {(x + PATCH_WIDTH < view->width ? x + PATCH_WIDTH : view->width) - 1,
                           (y + PATCH_HEIGHT < view->height ? y + PATCH_HEIGHT : view->height) - 1},
                  .stride = f->stride,
                  .tiles = f->stride / ISO_REFINED_TILE,
                  .sums = sums,
                  .front = front,
                  .shift = f->shift,
                  .cells = f->wide},
        .order = (const uint32_t *)f->workspace->order.data + start[number],
        .count = start[number + 1] - start[number],
        .hidden = hidden,
        .deepest = hidden + f->wide * f->high,
        .least = ISO_NOWHERE};
}

/* How its discs are best added. */
static void choose_way(const frame *f, drawing *d) {
    const iso_point_block *block = f->blocks->blocks.data;
    float most = 0;
    d->patch.flat = true;
    for (size_t i = 0; i < d->count; i++) {
        const iso_point_block *b = &block[d->order[i]];
        most = b->radius[1] > most ? b->radius[1] : most;
        d->patch.flat &= !iso_refined_use_curvature(&f->params, b);
    }
    const iso_point_block largest = {.radius = {0, most}};
    d->tiles = 2 * iso_refined_reach(&largest) * f->params.slant + 1 > ISO_REFINED_BOX;
}

static float larger(float a, float b) {
    return a > b ? a : b;
}

/* What is hidden by all that the patch has so far: what is behind all of a cell and those around it. */
static void look(const frame *f, drawing *d) {
    const int wide = f->wide, high = f->high;
    for (int i = 0; i < wide * high; i++) d->deepest[i] = -ISO_NOWHERE;
    (d->tiles ? f->kernel->survey_tiles : f->kernel->survey_pixels)(&d->patch, d->deepest);
    for (int y = 0; y < high; y++) {
        const float *from = d->deepest + y * wide;
        for (int x = 0; x < wide; x++)
            d->hidden[y * wide + x] =
                larger(larger(from[x > 0 ? x - 1 : x], from[x]), from[x + 1 < wide ? x + 1 : x]);
    }
    memcpy(d->deepest, d->hidden, (size_t)(wide * high) * sizeof *d->hidden);
    d->least = ISO_NOWHERE;
    for (int y = 0; y < high; y++) {
        const float *from = d->deepest + y * wide, *above = y > 0 ? from - wide : from,
                    *below = y + 1 < high ? from + wide : from;
        for (int x = 0; x < wide; x++) {
            const float hidden = larger(larger(above[x], from[x]), below[x]) + f->behind;
            d->hidden[y * wide + x] = hidden;
            d->least = hidden < d->least ? hidden : d->least;
        }
    }
}

/* The cells along an axis that a block's centres are in, or nearest to. */
static void cells_of(const frame *f, const drawing *d, const iso_point_block *block, int axis, int range[2]) {
    const iso_view *view = f->params.target->view;
    const int32_t *pixels = axis ? block->row : block->column;
    const double from = (axis ? view->cy : view->cx) - d->patch.first[axis];
    const int last = (d->patch.last[axis] - d->patch.first[axis]) >> f->shift;
    for (int end = 0; end < 2; end++) {
        const double at = (pixels[end] + from) / (1 << f->shift);
        range[end] = at < 0 ? 0 : at > last ? last : (int)at;
    }
}

/* Whether all of a block is hidden, or (`some`) some of it may be. */
static bool is_hidden(const frame *f, const drawing *d, const iso_point_block *block, bool *some) {
    *some = block->depth[1] > d->least;
    if (!*some) return false;
    int x[2], y[2];
    float least = ISO_NOWHERE, most = -ISO_NOWHERE;
    cells_of(f, d, block, 0, x);
    cells_of(f, d, block, 1, y);
    for (int v = y[0]; v <= y[1]; v++)
        for (int u = x[0]; u <= x[1]; u++) {
            const float hidden = d->hidden[v * f->wide + u];
            least = hidden < least ? hidden : least;
            most = hidden > most ? hidden : most;
        }
    *some = block->depth[1] > least;
    return block->depth[0] > most;
}

static void fetch(const void *items, size_t bytes) {
    for (size_t at = 0; at < bytes; at += 64) __builtin_prefetch((const char *)items + at);
}

/* The next block into the cache: blocks are too short for what processors foresee. */
static void fetch_block(const frame *f, const iso_point_block *block) {
    const iso_point_view *points = f->params.points;
    const size_t count = block->count < FETCHED ? block->count : FETCHED;
    if (!points->packed) return;
    fetch(points->packed + block->first, count * sizeof *points->packed);
    if (iso_refined_use_curvature(&f->params, block))
        fetch(points->curvatures + block->first, count * sizeof *points->curvatures);
}

static void do_patch(void *context, size_t number, int worker) {
    const frame *f = context;
    const iso_point_block *block = f->blocks->blocks.data;
    const size_t *start = f->workspace->start.data;
    if (start[number] == start[number + 1]) return;
    drawing d = start_patch(f, number, worker);
    choose_way(f, &d);
    const size_t rounds = d.count / LOOKS + 1;
    for (size_t i = 0; i < d.count; i++) {
        bool some;
        if (i + 1 < d.count) fetch_block(f, &block[d.order[i + 1]]);
        if (i && i % rounds == 0) look(f, &d);
        if (is_hidden(f, &d, &block[d.order[i]], &some)) continue;
        d.patch.hidden = some ? d.hidden : NULL;
        (d.tiles ? f->kernel->splat : f->kernel->scatter)(&f->params, &d.patch, d.order[i]);
    }
    (d.tiles ? f->kernel->finish_tiles : f->kernel->finish_pixels)(&f->params, &d.patch);
}

iso_status iso_refined_draw(iso_refined *workspace, const iso_target *target, const iso_point_view *points,
                            const iso_point_blocks *blocks, iso_error *error) {
    frame f = {.params = {.target = target, .points = points, .blocks = blocks->blocks.data},
               .kernel = iso_refined_kernel_get(iso_cpu_best()),
               .blocks = blocks,
               .workspace = workspace};
    const iso_projector projector = iso_projector_make(target->view, &points->transform);
    set_up_job(&f, &projector);
    choose_patches(&f);
    set_up_hiding(&f);
    ISO_TRY(set_up_corners(&f, &projector, error));
    ISO_TRY(deal(&f, error));
    const size_t workers = (size_t)iso_pool_threads(target->pool);
    ISO_TRY(iso_buffer_reserve(&workspace->memory, workers * worker_bytes(&f), 0, error));
    iso_parallel_for(target->pool, (size_t)f.across * (size_t)f.down, do_patch, &f);
    return ISO_OK;
}

void iso_refined_free(iso_refined *workspace) {
    iso_buffer_free(&workspace->corners);
    iso_buffer_free(&workspace->sorted);
    iso_buffer_free(&workspace->reached);
    iso_buffer_free(&workspace->order);
    iso_buffer_free(&workspace->start);
    iso_buffer_free(&workspace->memory);
}
