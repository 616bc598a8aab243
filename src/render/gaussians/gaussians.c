/* gaussians: projects Gaussians, sorts them by depth, and composites them band by band. */
#include "render/gaussians/gaussians.h"

#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#include "base/exponential.h"
#include "base/memory.h"
#include "base/numbers.h"
#include "base/radix_sort.h"
#include "render/gaussians/kernel.h"
#include "render/layers/bands.h"
#include "render/view/project.h"

enum {
    CHUNK = 1024,   /* Gaussians that are projected as one task */
    BAND_ROWS = 16, /* about as many rows of samples are composited as one task */
    CHECK = 16,     /* a tile is checked for being finished after this many Gaussians */
    PLANES = 5,     /* of a band */
    DEPTH_BITS = 32 /* of a key of the order */
};

/* A picture of Gaussians. */
typedef struct frame {
    const iso_gaussians *gaussians;
    const iso_layer_picture *picture;
    const iso_view *view;
    double nearest;                 /* depth */
    iso_gaussian_ellipse *ellipses; /* of all Gaussians; those that are not in view have no rows */
    iso_radix_item *items, *spare;
    const iso_radix_item *order; /* `in_view` ellipses by depth */
    size_t in_view;
    int rows; /* of a band */
    size_t bands;
    size_t *starts;   /* where the list of each band begins in `listed` */
    uint32_t *listed; /* ellipses that reach each band, by depth */
    struct worker *workers;
} frame;

/* The memory of a thread. */
typedef struct worker {
    float *planes;
    uint8_t *counts; /* of each tile: Gaussians since it was checked; FINISHED */
    iso_layer_composer composer;
    iso_layer_totals totals;
} worker;

enum { FINISHED = 255 };

/* ---- projection */

/* A symmetric matrix of the picture. */
typedef struct covariance {
    double xx, xy, yy;
} covariance;

static double clamp(double value, double low, double high) {
    return iso_min(iso_max(value, low), high);
}

/* The derivatives of the picture's position by the position in view space. */
static void find_derivatives(const iso_view *view, iso_vec3 at, double j[2][3]) {
    const double f = view->focal, height = view->above + view->height + view->below,
                 cy = view->cy + view->above, w = ISO_GAUSSIAN_OUTSIDE * view->width,
                 h = ISO_GAUSSIAN_OUTSIDE * height;
    memset(j, 0, 6 * sizeof j[0][0]);
    j[0][0] = j[1][1] = view->orthographic ? f : f / at.z;
    if (view->orthographic) return;
    const double u = clamp(at.x / at.z, (-w - view->cx) / f, (view->width + w - view->cx) / f),
                 v = clamp(at.y / at.z, (-h - cy) / f, (height + h - cy) / f);
    j[0][2] = -f * u / at.z;
    j[1][2] = -f * v / at.z;
}

/* The covariance of a Gaussian in the picture. */
static covariance project_axes(const iso_view *view, const float axes[9], iso_vec3 at) {
    double j[2][3];
    covariance v = {(double)ISO_GAUSSIAN_LOW_PASS, 0, (double)ISO_GAUSSIAN_LOW_PASS};
    find_derivatives(view, at, j);
    for (int k = 0; k < 3; k++) {
        const float *a = axes + 3 * k;
        const iso_vec3 axis = iso_view_vector(view, iso_vec3_make((double)a[0], (double)a[1], (double)a[2]));
        const double x = j[0][0] * axis.x + j[0][2] * axis.z, y = j[1][1] * axis.y + j[1][2] * axis.z;
        v.xx += x * x;
        v.xy += x * y;
        v.yy += y * y;
    }
    return v;
}

/* The first and the last sample within `reach` of `centre`, kept within -1 .. side, which is outside. */
static void find_range(double centre, double reach, int side, int32_t *first, int32_t *last) {
    *first = (int32_t)clamp(floor(centre - reach), -1, side);
    *last = (int32_t)clamp(ceil(centre + reach), -1, side);
}

/* Makes the ellipse of a Gaussian at `at` in view space. Returns false if no sample of the view shows it. */
static bool make_ellipse(const frame *f, size_t i, iso_vec3 at, iso_gaussian_ellipse *e) {
    const iso_view *view = f->view;
    const iso_gaussians *g = f->gaussians;
    const double scale = view->orthographic ? view->focal : view->focal / at.z;
    /* relative to sample (0, 0), which is at (0.5, 0.5) */
    const double cx = view->cx + scale * at.x - 0.5, cy = view->cy + view->above + scale * at.y - 0.5;
    const covariance v = project_axes(view, g->axes[i], at);
    const double determinant = v.xx * v.yy - v.xy * v.xy, half_log2_e = 0.72134752044448170;
    /* the exponent at which the opacity is ISO_GAUSSIAN_LEAST, and so half a sample more, for rounding */
    const double most = iso_log2((double)g->opacities[i] / (double)ISO_GAUSSIAN_LEAST) / half_log2_e;
    if (!(fabs(cx) < 1e9 && fabs(cy) < 1e9 && determinant > 0 && isfinite(v.xx) && isfinite(v.yy)))
        return false;
    const int height = view->above + view->height + view->below;
    find_range(cx, sqrt(most * v.xx) + 0.5, view->width, &e->first_x, &e->last_x);
    find_range(cy, sqrt(most * v.yy) + 0.5, height, &e->first_y, &e->last_y);
    e->x = (int32_t)floor(cx), e->y = (int32_t)floor(cy);
    e->fx = (float)(cx - e->x), e->fy = (float)(cy - e->y);
    e->xx = (float)(half_log2_e * v.yy / determinant);
    e->xy = (float)(-2 * half_log2_e * v.xy / determinant);
    e->yy = (float)(half_log2_e * v.xx / determinant);
    e->opacity = g->opacities[i];
    e->depth = (float)at.z;
    const uint8_t one[3] = {g->color.r, g->color.g, g->color.b}, *rgb = g->colors ? g->colors[i] : one;
    for (int k = 0; k < 3; k++) e->color[k] = (float)rgb[k] / 255;
    return e->last_x >= 0 && e->first_x < view->width && e->last_y >= view->above &&
           e->first_y < view->above + view->height;
}

/* Projects a Gaussian; leaves its ellipse without rows if it is not in view. */
static void project(const frame *f, size_t i) {
    const iso_gaussians *g = f->gaussians;
    const float *p = g->positions[i];
    iso_gaussian_ellipse *e = &f->ellipses[i];
    const iso_vec3 world = iso_vec3_add(g->origin, iso_vec3_make((double)p[0], (double)p[1], (double)p[2]));
    const iso_vec3 at = iso_view_point(f->view, world);
    const bool cut = g->clip && !iso_clip_shows(g->clip, world);
    const bool near = !cut && at.z >= f->nearest && at.z < 1e30 && g->opacities[i] >= ISO_GAUSSIAN_LEAST;
    if (near && make_ellipse(f, i, at, e)) return;
    e->first_y = 1;
    e->last_y = 0;
}

static void project_chunk(void *context, size_t chunk, int number) {
    (void)number;
    const frame *f = context;
    const size_t end = (chunk + 1) * CHUNK < f->gaussians->count ? (chunk + 1) * CHUNK : f->gaussians->count;
    for (size_t i = chunk * CHUNK; i < end; i++) project(f, i);
}

/* ---- order */

/* Whole numbers that compare like floats. */
static uint32_t key_of(float depth) {
    uint32_t bits;
    memcpy(&bits, &depth, sizeof bits);
    return bits & 0x80000000u ? ~bits : bits | 0x80000000u;
}

static void sort_ellipses(frame *f) {
    for (size_t i = 0; i < f->gaussians->count; i++)
        if (f->ellipses[i].first_y <= f->ellipses[i].last_y)
            f->items[f->in_view++] = (iso_radix_item){key_of(f->ellipses[i].depth), (uint32_t)i};
    f->order = iso_radix_sort(f->items, f->spare, f->in_view, DEPTH_BITS);
}

/* The bands that an ellipse reaches. */
static iso_rows bands_of(const frame *f, const iso_gaussian_ellipse *e) {
    const int first = e->first_y - f->view->above, last = e->last_y - f->view->above;
    return (iso_rows){(first > 0 ? first : 0) / f->rows,
                      (last < f->view->height ? last : f->view->height - 1) / f->rows};
}

/* Lists the ellipses of each band, nearest first. */
static iso_status list_bands(frame *f, iso_error *error) {
    f->starts = iso_alloc_zero(f->bands + 2, sizeof *f->starts);
    if (!f->starts) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for a picture of Gaussians");
    for (size_t i = 0; i < f->in_view; i++) {
        const iso_rows bands = bands_of(f, &f->ellipses[f->order[i].index]);
        for (int band = bands.first; band <= bands.last; band++) f->starts[band + 2]++;
    }
    for (size_t band = 2; band < f->bands + 2; band++) f->starts[band] += f->starts[band - 1];
    const size_t total = f->starts[f->bands + 1];
    f->listed = iso_alloc((total ? total : 1) * sizeof *f->listed);
    if (!f->listed) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for %zu Gaussians", total);
    for (size_t i = 0; i < f->in_view; i++) {
        const iso_rows bands = bands_of(f, &f->ellipses[f->order[i].index]);
        for (int band = bands.first; band <= bands.last; band++)
            f->listed[f->starts[band + 1]++] = f->order[i].index;
    }
    return ISO_OK;
}

/* ---- bands */

static size_t stride_of(const frame *f) {
    return ((size_t)f->view->width + ISO_GAUSSIAN_TILE - 1) / ISO_GAUSSIAN_TILE * ISO_GAUSSIAN_TILE;
}

/* The band of the worker's planes, with no Gaussians yet. */
static iso_gaussian_band begin_band(const frame *f, const worker *w, int first, int rows) {
    const iso_gbuffer *opaque = f->picture->strip->gbuffer;
    const size_t stride = stride_of(f), plane = stride * (size_t)f->rows;
    float *at[PLANES];
    for (int k = 0; k < PLANES; k++) at[k] = w->planes + (size_t)k * plane;
    memset(w->planes, 0, PLANES * plane * sizeof *w->planes);
    for (size_t i = 0; i < plane; i++) at[3][i] = 1;
    memset(w->counts, 0, stride / ISO_GAUSSIAN_TILE);
    return (iso_gaussian_band){.color = {at[0], at[1], at[2]},
                               .through = at[3],
                               .layers = at[4],
                               .stride = stride,
                               .first = f->view->above + first,
                               .last = f->view->above + first + rows - 1,
                               .depth = opaque->depth ? opaque->depth + (size_t)first * (size_t)opaque->width
                                                      : NULL,
                               .depth_stride = (size_t)opaque->width,
                               .width = f->view->width};
}

/* Adds an ellipse to the tiles that are not finished; returns how many tiles it finished. */
static int add_ellipse(const iso_gaussian_kernel *kernel, const iso_gaussian_ellipse *e,
                       const iso_gaussian_band *band, uint8_t *counts) {
    const int first = e->first_x > 0 ? e->first_x : 0,
              last = e->last_x < band->width ? e->last_x : band->width - 1;
    int finished = 0;
    for (int tile = first / ISO_GAUSSIAN_TILE; tile <= last / ISO_GAUSSIAN_TILE; tile++) {
        if (counts[tile] == FINISHED) continue;
        kernel->add(e, band, tile * ISO_GAUSSIAN_TILE);
        if (++counts[tile] < CHECK) continue;
        counts[tile] = kernel->finished(band, tile * ISO_GAUSSIAN_TILE) ? FINISHED : 0;
        finished += counts[tile] == FINISHED;
    }
    return finished;
}

/* The function iso_layer_row_fn: copies a row of a band. */
static void take_row(const void *context, int row, const iso_layer_line *line, iso_layer_totals *totals) {
    const iso_gaussian_band *band = context;
    const size_t at = (size_t)row * band->stride, bytes = (size_t)band->width * sizeof(float);
    for (int k = 0; k < 3; k++) memcpy(line->color[k], band->color[k] + at, bytes);
    memcpy(line->through, band->through + at, bytes);
    memcpy(line->layers, band->layers + at, bytes);
    for (int x = 0; x < band->width; x++) {
        const int layers = (int)band->layers[at + (size_t)x];
        totals->layers += (size_t)layers;
        if (layers > totals->most) totals->most = layers;
    }
}

static void draw_band(void *context, size_t number, int thread) {
    const frame *f = context;
    worker *w = &f->workers[thread];
    const iso_gaussian_kernel *kernel = iso_gaussian_kernel_get(iso_cpu_best());
    const int first = (int)number * f->rows, left = f->view->height - first,
              rows = left < f->rows ? left : f->rows;
    const iso_gaussian_band band = begin_band(f, w, first, rows);
    int open = (int)(band.stride / ISO_GAUSSIAN_TILE);
    for (size_t i = f->starts[number]; i < f->starts[number + 1] && open > 0; i++)
        open -= add_ellipse(kernel, &f->ellipses[f->listed[i]], &band, w->counts);
    iso_layers_finish(f->picture, first, rows, take_row, &band, &w->composer, &w->totals);
}

/* ---- pictures */

static iso_status make_workers(frame *f, int count, iso_error *error) {
    const size_t stride = stride_of(f);
    f->workers = iso_alloc_zero((size_t)count, sizeof *f->workers);
    iso_status status = f->workers ? ISO_OK : ISO_ERR_NOMEM;
    for (int i = 0; i < count && status == ISO_OK; i++) {
        worker *w = &f->workers[i];
        w->planes = iso_alloc(PLANES * stride * (size_t)f->rows * sizeof *w->planes);
        w->counts = iso_alloc(stride / ISO_GAUSSIAN_TILE);
        status = w->planes && w->counts ? iso_layer_composer_reserve(&w->composer, f->picture->image->width,
                                                                     f->picture->strip->factor, error)
                                        : ISO_ERR_NOMEM;
    }
    return status == ISO_OK ? ISO_OK
                            : iso_fail(error, ISO_ERR_NOMEM, "out of memory for a picture of Gaussians");
}

static void free_frame(frame *f, int workers) {
    for (int i = 0; f->workers && i < workers; i++) {
        iso_free(f->workers[i].planes);
        iso_free(f->workers[i].counts);
        iso_layer_composer_free(&f->workers[i].composer);
    }
    iso_free(f->workers);
    iso_free(f->ellipses);
    iso_free(f->items);
    iso_free(f->spare);
    iso_free(f->starts);
    iso_free(f->listed);
}

static iso_status draw_frame(frame *f, int workers, iso_error *error) {
    iso_pool *pool = f->picture->pool;
    const size_t count = f->gaussians->count;
    f->ellipses = iso_alloc(count * sizeof *f->ellipses);
    f->items = iso_alloc(count * sizeof *f->items);
    f->spare = iso_alloc(count * sizeof *f->spare);
    if (!f->ellipses || !f->items || !f->spare)
        return iso_fail(error, ISO_ERR_NOMEM, "out of memory for %zu Gaussians", count);
    ISO_TRY(make_workers(f, workers, error));
    iso_parallel_for(pool, (count + CHUNK - 1) / CHUNK, project_chunk, f);
    sort_ellipses(f);
    ISO_TRY(list_bands(f, error));
    iso_parallel_until(pool, f->bands, draw_band, f);
    return ISO_OK;
}

iso_status iso_shade_gaussians(const iso_gaussians *gaussians, const iso_layer_picture *picture,
                               iso_layer_totals *totals, iso_error *error) {
    const iso_view *view = picture->strip->view;
    const int workers = iso_pool_threads(picture->pool);
    if (gaussians->count > UINT32_MAX) return iso_fail(error, ISO_ERR_LIMIT, "2^32 Gaussians or more");
    frame f = {.gaussians = gaussians,
               .picture = picture,
               .view = view,
               .nearest = view->orthographic ? view->near : ISO_GAUSSIAN_NEAREST * view->near,
               .rows = iso_layer_band_rows(picture->strip, BAND_ROWS)};
    f.bands = (size_t)((view->height + f.rows - 1) / f.rows);
    const iso_status status = draw_frame(&f, workers, error);
    for (int i = 0; i < workers && status == ISO_OK; i++) iso_layer_totals_add(totals, &f.workers[i].totals);
    free_frame(&f, workers);
    return status;
}

double iso_gaussians_size(const float (*axes)[9], size_t count) {
    enum { SAMPLES = 4096 };
    const size_t step = count / SAMPLES + 1;
    double sizes[SAMPLES];
    size_t found = 0;
    for (size_t i = 0; i < count && found < SAMPLES; i += step) {
        double square = 0;
        for (int k = 0; k < 9; k++) square += (double)axes[i][k] * (double)axes[i][k];
        sizes[found++] = sqrt(square / 3);
    }
    qsort(sizes, found, sizeof *sizes, iso_compare_doubles);
    return found && sizes[found / 2] > 0 ? sizes[found / 2] : 1;
}
