#include "render/refined.h"

#include <math.h>
#include <string.h>

#include "render/refined_kernel.h"

enum {
    ROWS_LEAST = 16,
    ROWS_MOST = 64,
    SUM_BYTES = 4 << 20, /* of sums that one worker keeps */
    LANES = 16           /* of the widest vectors */
};

/* The ball of a disc, in the point's own radii: one voxel for extracted points. */
static const float BALL_RADII = 1.42f;
static const float SMALL = 2.5f; /* pixels */

/* One call. */
typedef struct frame {
    iso_refined_job job;
    const iso_refined_kernel *kernel;
    const iso_point_blocks *blocks;
    iso_refined *workspace;
    int band_rows, bands;
    size_t stride, tiles;
    size_t key_bytes, disc_bytes, sum_bytes, used_bytes, worker_bytes; /* of one worker */
} frame;

bool iso_refined_can(const iso_point_blocks *blocks) {
    return blocks->count <= (size_t)1 << (32 - ISO_REFINED_POINT_BITS);
}

/* ---- preparation */

static iso_status set_up_corners(frame *f, const iso_projector *projector, iso_error *error) {
    const iso_point_block *block = f->blocks->blocks.data;
    const double low = f->job.points->packed ? -2 : 0;
    ISO_TRY(iso_buffer_reserve(&f->workspace->corners, f->blocks->count * sizeof(float[3]), 0, error));
    float(*corner)[3] = f->workspace->corners.data;
    for (size_t i = 0; i < f->blocks->count; i++) {
        if (!block[i].seen) continue;
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

static void set_up_job(frame *f, const iso_projector *projector) {
    iso_refined_job *job = &f->job;
    const iso_view *view = job->target->view;
    const double step = job->points->packed ? 20.0 / 16384 : 1;
    for (int k = 0; k < 9; k++) job->step[k] = (float)(projector->matrix[k] * step);
    memcpy(job->normal, projector->normal, sizeof job->normal);
    job->reach = BALL_RADII;
    job->radius = job->points->radius > 0 ? (float)job->points->radius * BALL_RADII : 0;
    job->focal = (float)view->focal;
    job->slope = view->orthographic ? 0 : (float)(1 / view->focal);
    job->axis[0] = (float)view->cx;
    job->axis[1] = (float)(view->cy + view->above);
    job->near = view->near < -ISO_NOWHERE ? -ISO_NOWHERE : (float)view->near;
    job->orthographic = view->orthographic;
    job->cull = job->points->closed && !f->blocks->around_eye;
    job->small = SMALL;
}

static void choose_bands(frame *f) {
    const iso_view *view = f->job.target->view;
    const size_t columns = (size_t)(view->width + LANES - 1) / LANES * LANES;
    f->stride = columns + ISO_REFINED_LEFT + 2 * LANES;
    f->tiles = columns / ISO_REFINED_TILE;
    size_t rows = SUM_BYTES / (columns * ISO_SUMS * sizeof(float)) / ROWS_LEAST * ROWS_LEAST;
    f->band_rows = rows < ROWS_LEAST ? ROWS_LEAST : rows > ROWS_MOST ? ROWS_MOST : (int)rows;
    f->bands = (view->height + f->band_rows - 1) / f->band_rows;
    const size_t rows_of_keys = (size_t)(f->band_rows + 2 * ISO_REFINED_WINDOW);
    f->key_bytes = rows_of_keys * f->stride * sizeof(int64_t);
    f->disc_bytes = (size_t)ISO_DISC_VALUES * ISO_REFINED_RING * f->stride * sizeof(float);
    f->sum_bytes = columns * (size_t)f->band_rows * ISO_SUMS * sizeof(float);
    f->used_bytes = f->tiles * (size_t)f->band_rows;
    f->worker_bytes = (f->key_bytes + f->disc_bytes + f->sum_bytes + f->used_bytes + 63) & ~(size_t)63;
}

/* Projected radii of a block's discs, a little widened. */
static float disc_radius(const iso_point_block *block, int end) {
    return block->radius[end] * (BALL_RADII / ISO_DISC_RADII) * (end ? 1.001f : 0.999f);
}

/* Bands first .. last that a block's discs can reach. */
static iso_rows bands_of(const frame *f, const iso_point_block *block) {
    const iso_view *view = f->job.target->view;
    const double wide = view->orthographic ? 0 : (fabs(view->cx) + view->width) / view->focal,
                 tall = view->orthographic ? 0 : (fabs(view->cy) + view->height + view->above) / view->focal;
    double reach =
        disc_radius(block, 1) * 1.02 * sqrt(1 + wide * wide + tall * tall) + ISO_REFINED_WINDOW + 1;
    const double first = floor((block->row[0] + view->cy - reach) / f->band_rows),
                 last = floor((block->row[1] + view->cy + reach) / f->band_rows);
    if (!block->seen || !(first < f->bands && last >= 0)) return (iso_rows){0, -1};
    return (iso_rows){first < 0 ? 0 : (int)first, last < f->bands ? (int)last : f->bands - 1};
}

/* Lists the blocks of each band, in their order: band b's are order[start[b]] .. order[start[b + 1] - 1]. */
static iso_status deal(frame *f, iso_error *error) {
    const iso_point_block *block = f->blocks->blocks.data;
    iso_refined *w = f->workspace;
    const size_t bands = (size_t)f->bands;
    ISO_TRY(iso_buffer_reserve(&w->start, (bands + 2) * sizeof(size_t), 0, error));
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
        const iso_rows in = bands_of(f, &block[i]);
        for (int b = in.first; b <= in.last; b++) order[start[b + 1]++] = (uint32_t)i;
    }
    return ISO_OK;
}

/* ---- bands */

static iso_refined_band worker_band(const frame *f, int worker, iso_rows rows) {
    char *memory = (char *)f->workspace->memory.data + (size_t)worker * f->worker_bytes;
    iso_refined_band band = {.rows = rows, .stride = f->stride, .tiles = f->tiles, .keys = (int64_t *)memory};
    float *plane = (float *)(memory + f->key_bytes);
    for (int k = 0; k < ISO_DISC_VALUES; k++, plane += ISO_REFINED_RING * f->stride) band.disc[k] = plane;
    band.sums = plane;
    band.used = (uint8_t *)plane + f->sum_bytes;
    return band;
}

static bool project(const frame *f, const iso_refined_band *band, const uint32_t *order, size_t count) {
    const iso_point_block *block = f->blocks->blocks.data;
    bool any = false;
    const size_t keys = (size_t)(band->rows.last - band->rows.first + 1 + 2 * ISO_REFINED_WINDOW) * f->stride;
    for (size_t i = 0; i < count; i++) {
        if (disc_radius(&block[order[i]], 0) >= SMALL) continue;
        for (size_t k = 0; k < keys && !any; k++) band->keys[k] = ISO_KEY_NONE;
        any = true;
        f->kernel->project(&f->job, band, order[i]);
    }
    return any;
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
    const bool small = project(f, &band, order, count);
    bool large = false;
    for (size_t i = 0; i < count && !large; i++) large = disc_radius(&block[order[i]], 1) >= SMALL;
    if (large) memset(band.used, 0, f->used_bytes);
    if (small) f->kernel->gather(&f->job, &band, large);
    if (!large) return;
    for (size_t i = 0; i < count; i++)
        if (disc_radius(&block[order[i]], 1) >= SMALL) f->kernel->splat(&f->job, &band, order[i]);
    f->kernel->finish(&f->job, &band);
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
    ISO_TRY(set_up_corners(&f, &projector, error));
    ISO_TRY(deal(&f, error));
    const size_t workers = (size_t)iso_pool_threads(target->pool);
    ISO_TRY(iso_buffer_reserve(&workspace->memory, workers * f.worker_bytes, 0, error));
    iso_parallel_for(target->pool, (size_t)f.bands, do_band, &f);
    return ISO_OK;
}

void iso_refined_free(iso_refined *workspace) {
    iso_buffer_free(&workspace->corners);
    iso_buffer_free(&workspace->order);
    iso_buffer_free(&workspace->start);
    iso_buffer_free(&workspace->memory);
}
