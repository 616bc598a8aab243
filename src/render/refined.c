#include "render/refined.h"

#include <math.h>
#include <string.h>

#include "render/refined_kernel.h"
#include "render/refined_numbers.h"
#include "render/refined_setup.h"

enum {
    ROWS_LEAST = 16,
    ROWS_MOST = 64,
    SUM_BYTES = 4 << 20, /* of sums that one worker keeps */
    LANES = 16,          /* of the widest vectors */
    CELL_SHIFT_LEAST = 3,
    LAYERS = 4096, /* of depth, which blocks are sorted into */
    LOOKS = 12     /* at what is hidden, while a band is drawn */
};

/* One call. */
typedef struct frame {
    iso_refined_job job;
    const iso_refined_kernel *kernel;
    const iso_point_blocks *blocks;
    iso_refined *workspace;
    int band_rows, bands;
    size_t stride, pixels; /* of a band: in a row, and in all */
    int shift, cells;      /* of what is hidden: see iso_refined_band; cells of a band in all */
    float behind;          /* mm that hidden discs' centres are behind what hides them, at least */
} frame;

/* ---- preparation */

static iso_status set_up_corners(frame *f, const iso_projector *projector, iso_error *error) {
    const iso_point_block *block = f->blocks->blocks.data;
    const double low = (double)f->job.low;
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
    f->job.corner = (const float(*)[3])corner;
    return ISO_OK;
}

/* Surfaces end where their grid does, in the midst of discs. */
static void set_up_border(iso_refined_job *job) {
    const int32_t *dims = job->points->dims;
    job->bordered = dims[0] > 0 && dims[1] > 0 && dims[2] > 0;
    job->per_mm = iso_refined_per_mm(job->normal);
    for (int k = 0; k < 3; k++) job->border[k] = (float)(dims[k] - 1);
}

/* Balls are measured in voxels, of which the largest side is `side` mm. */
static void set_up_metric(iso_refined_job *job, const double spacing[3]) {
    const double side = fmax(spacing[0], fmax(spacing[1], spacing[2]));
    int i = 0;
    job->uneven = spacing[0] != spacing[1] || spacing[1] != spacing[2];
    for (int r = 0; r < 3; r++)
        for (int c = r; c < 3; c++, i++) {
            double sum = 0;
            for (int k = 0; k < 3; k++)
                sum += (double)job->normal[3 * r + k] * (double)job->normal[3 * c + k];
            job->metric[i] = (float)(sum * side * side * (r == c ? 1 : 2));
        }
}

static void set_up_job(frame *f, const iso_projector *projector) {
    iso_refined_job *job = &f->job;
    const iso_view *view = job->target->view;
    job->low = job->points->packed ? ISO_POINT_LOW : 0;
    job->voxels = job->points->packed ? ISO_POINT_STEP : 1;
    for (int k = 0; k < 9; k++) job->step[k] = (float)(projector->matrix[k] * (double)job->voxels);
    memcpy(job->normal, projector->normal, sizeof job->normal);
    job->reach[0] = ISO_REFINED_BALL;
    job->reach[1] = ISO_REFINED_BALL_MORE;
    job->grow_from = ISO_REFINED_GROW_FROM;
    job->grow = 1 / ISO_REFINED_GROW_OVER;
    job->radius = job->points->radius > 0 ? (float)job->points->radius : 0;
    job->focal = (float)view->focal;
    job->slope = view->orthographic ? 0 : (float)(1 / view->focal);
    job->axis[0] = (float)view->cx;
    job->axis[1] = (float)(view->cy + view->above);
    job->slant = iso_refined_slant(view);
    const double *spacing = job->points->transform.spacing;
    set_up_metric(job, spacing);
    if (!job->uneven) job->per_length = (float)spacing[0];
    job->near = view->near < -ISO_NOWHERE ? -ISO_NOWHERE : (float)view->near;
    job->orthographic = view->orthographic;
    job->cull = job->points->closed && !f->blocks->around_eye;
    set_up_border(job);
}

static void choose_bands(frame *f) {
    const iso_view *view = f->job.target->view;
    f->stride = (size_t)(view->width + LANES - 1) / LANES * LANES;
    size_t rows = SUM_BYTES / (f->stride * ISO_SUMS * sizeof(float)) / ROWS_LEAST * ROWS_LEAST;
    f->band_rows = rows < ROWS_LEAST ? ROWS_LEAST : rows > ROWS_MOST ? ROWS_MOST : (int)rows;
    f->bands = (view->height + f->band_rows - 1) / f->band_rows;
    f->pixels = f->stride * (size_t)f->band_rows;
}

/* Cells are as large as discs, which so lie in their own and the eight around it. */
static void set_up_hiding(frame *f) {
    const float most =
        f->blocks->radius[1] / ISO_DISC_RADII * (ISO_REFINED_BALL + ISO_REFINED_BALL_MORE) * f->job.slant;
    f->shift = CELL_SHIFT_LEAST;
    while (f->shift < 16 && most > (float)(1 << f->shift)) f->shift++;
    const size_t side = (size_t)1 << f->shift;
    f->cells = (int)((f->stride + side - 1) >> f->shift) * (int)((f->band_rows + side - 1) >> f->shift);
    /* A disc may reach towards the eye by its radius, and joins what is 1.5 radii before it; where that was
     * turned, what faces the eye takes its place from as far behind. */
    const float radius = f->job.radius * (ISO_REFINED_BALL + ISO_REFINED_BALL_MORE);
    f->behind = f->job.points->radii ? ISO_NOWHERE : (f->job.cull ? 2.6f : 4.1f) * radius;
}

/* Bands first .. last that a block's discs can reach. */
static iso_rows bands_of(const frame *f, const iso_point_block *block) {
    const iso_view *view = f->job.target->view;
    const double reach = iso_refined_reach(block) * f->job.slant + 2;
    const double first = floor((block->row[0] + view->cy - reach) / f->band_rows),
                 last = floor((block->row[1] + view->cy + reach) / f->band_rows);
    if (!block->seen || (f->job.cull && block->averted) || !(first < f->bands && last >= 0))
        return (iso_rows){0, -1};
    return (iso_rows){first < 0 ? 0 : (int)first, last < f->bands ? (int)last : f->bands - 1};
}

/* Sorts the blocks by depth, as their corners have it: what is in front comes first and hides the rest. All
 * of them take part, so that a strip of a picture has them in the same order. */
static iso_status sort(frame *f, uint32_t **sorted, iso_error *error) {
    const float(*corner)[3] = f->job.corner;
    const size_t count = f->blocks->count;
    ISO_TRY(iso_buffer_reserve(&f->workspace->sorted, count * sizeof **sorted, 0, error));
    *sorted = f->workspace->sorted.data;
    size_t start[LAYERS + 1] = {0};
    float least = INFINITY, most = -INFINITY;
    for (size_t i = 0; i < count; i++) {
        least = fminf(least, corner[i][2]);
        most = fmaxf(most, corner[i][2]);
    }
    const float scale = most > least ? (LAYERS - 1) / (most - least) : 0;
    for (size_t i = 0; i < count; i++) start[(size_t)((corner[i][2] - least) * scale) + 1]++;
    for (size_t k = 1; k <= LAYERS; k++) start[k] += start[k - 1];
    for (size_t i = 0; i < count; i++)
        (*sorted)[start[(size_t)((corner[i][2] - least) * scale)]++] = (uint32_t)i;
    return ISO_OK;
}

/* Lists the blocks of each band, sorted: band b's are order[start[b]] .. order[start[b + 1] - 1]. */
static iso_status deal(frame *f, iso_error *error) {
    const iso_point_block *block = f->blocks->blocks.data;
    iso_refined *w = f->workspace;
    const size_t bands = (size_t)f->bands;
    ISO_TRY(iso_buffer_reserve(&w->start, (bands + 2) * sizeof(size_t), 0, error));
    uint32_t *sorted;
    ISO_TRY(sort(f, &sorted, error));
    size_t *start = w->start.data;
    memset(start, 0, (bands + 2) * sizeof(size_t));
    for (size_t i = 0; i < f->blocks->count; i++) {
        const iso_rows in = bands_of(f, &block[i]);
        for (int b = in.first; b <= in.last; b++) start[b + 2]++;
    }
    for (size_t b = 0; b < bands; b++) start[b + 2] += start[b + 1];
    ISO_TRY(iso_buffer_reserve(&w->order, (start[bands + 1] + 1) * sizeof(uint32_t), 0, error));
    uint32_t *order = w->order.data;
    for (size_t i = 0; i < f->blocks->count; i++) {
        const iso_rows in = bands_of(f, &block[sorted[i]]);
        for (int b = in.first; b <= in.last; b++) order[start[b + 1]++] = sorted[i];
    }
    return ISO_OK;
}

/* ---- bands */

static size_t worker_bytes(const frame *f) {
    return (f->pixels * (ISO_SUMS + 1) + 2 * (size_t)f->cells) * sizeof(float);
}

static iso_refined_band worker_band(const frame *f, int worker, iso_rows rows) {
    char *memory = (char *)f->workspace->memory.data + (size_t)worker * worker_bytes(f);
    float *sums = (float *)memory, *front = sums + f->pixels * ISO_SUMS;
    return (iso_refined_band){.rows = rows,
                              .stride = f->stride,
                              .tiles = f->stride / ISO_REFINED_TILE,
                              .sums = sums,
                              .front = front,
                              .hidden = front + f->pixels,
                              .shift = f->shift,
                              .cells = (int)((f->stride - 1) >> f->shift) + 1};
}

/* What is hidden by all that the band has so far. */
static void look(const frame *f, const iso_refined_band *band, bool tiles) {
    float *hidden = band->front + f->pixels, *deepest = hidden + f->cells;
    const int wide = band->cells, high = f->cells / wide;
    for (int i = 0; i < f->cells; i++) deepest[i] = -ISO_NOWHERE;
    (tiles ? f->kernel->survey_tiles : f->kernel->survey_pixels)(band, deepest);
    for (int y = 0; y < high; y++)
        for (int x = 0; x < wide; x++) {
            float most = -ISO_NOWHERE;
            for (int v = y > 0 ? y - 1 : 0; v <= y + 1 && v < high; v++)
                for (int u = x > 0 ? x - 1 : 0; u <= x + 1 && u < wide; u++)
                    most = fmaxf(most, deepest[v * wide + u]);
            hidden[y * wide + x] = most + f->behind;
        }
}

static void do_band(void *context, size_t number, int worker) {
    const frame *f = context;
    const iso_point_block *block = f->blocks->blocks.data;
    const size_t *start = f->workspace->start.data;
    const uint32_t *order = (const uint32_t *)f->workspace->order.data + start[number];
    const size_t count = start[number + 1] - start[number];
    if (!count) return;
    const int first = (int)number * f->band_rows, height = f->job.target->view->height;
    const iso_rows rows = {first, (first + f->band_rows < height ? first + f->band_rows : height) - 1};
    const iso_refined_band band = worker_band(f, worker, rows);
    float most = 0;
    for (size_t i = 0; i < count; i++) most = fmaxf(most, iso_refined_reach(&block[order[i]]));
    const bool tiles = 2 * most * f->job.slant + 1 > ISO_REFINED_BOX;
    const size_t rounds = count / LOOKS + 1;
    for (size_t i = 0; i < f->pixels; i++) band.front[i] = ISO_NOWHERE;
    for (size_t i = 0; i < count; i++) {
        if (i % rounds == 0) look(f, &band, tiles);
        (tiles ? f->kernel->splat : f->kernel->scatter)(&f->job, &band, order[i]);
    }
    (tiles ? f->kernel->finish_tiles : f->kernel->finish_pixels)(&f->job, &band);
}

iso_status iso_refined_draw(iso_refined *workspace, const iso_target *target, const iso_point_view *points,
                            const iso_point_blocks *blocks, iso_error *error) {
    frame f = {.job = {.target = target, .points = points, .blocks = blocks->blocks.data},
               .kernel = iso_refined_kernel_get(iso_cpu_best()),
               .blocks = blocks,
               .workspace = workspace};
    const iso_projector projector = iso_projector_make(target->view, &points->transform);
    set_up_job(&f, &projector);
    choose_bands(&f);
    set_up_hiding(&f);
    ISO_TRY(set_up_corners(&f, &projector, error));
    ISO_TRY(deal(&f, error));
    const size_t workers = (size_t)iso_pool_threads(target->pool);
    ISO_TRY(iso_buffer_reserve(&workspace->memory, workers * worker_bytes(&f), 0, error));
    iso_parallel_for(target->pool, (size_t)f.bands, do_band, &f);
    return ISO_OK;
}

void iso_refined_free(iso_refined *workspace) {
    iso_buffer_free(&workspace->corners);
    iso_buffer_free(&workspace->sorted);
    iso_buffer_free(&workspace->order);
    iso_buffer_free(&workspace->start);
    iso_buffer_free(&workspace->memory);
}
