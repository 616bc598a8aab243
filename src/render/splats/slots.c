/* slots: deferred blending (Zhang and Pajarola 2006, sections 3.2 and 5.1) with one slot for each group in
 * every pixel. The picture is drawn in bands of rows. Drawing a disc is a minimum of 64-bit keys in each
 * pixel that it covers: the order of discs does not matter, so that all threads and GPUs get the same
 * slots. */
#include <assert.h>
#include <string.h>

#include "base/memory.h"
#include "render/splats/discs.h"
#include "render/splats/splats.h"

enum {
    BAND_BYTES = 1 << 20, /* of slots in a band, at most, */
    LEAST_ROWS = 4        /* unless it has so few rows */
};
static const uint64_t NO_DISC = UINT64_MAX;

/* The drawing of one surface. */
typedef struct slots_call {
    const iso_target *target;
    const iso_point_view *points;
    const iso_groups *groups;
    iso_discs discs;
    int slots;       /* of a pixel */
    size_t capacity; /* slots of a band */
    uint64_t *keys;  /* capacity for each worker */
    double bins;     /* 0: none */
} slots_call;

/* A band while it is drawn by one worker: the slots of pixel (x, y) are keys[((y - rows.first) * width +
 * x) * slots ..]. */
typedef struct slots_band {
    const slots_call *call;
    iso_rows rows;
    uint64_t *keys;
} slots_band;

/* ---- keys */

/* A depth as a number that compares like it. */
static uint32_t ordered_bits(float depth) {
    uint32_t bits;
    memcpy(&bits, &depth, sizeof bits);
    return bits >> 31 ? ~bits : bits | 1u << 31;
}

/* Depth in bins (eq. 6) and in each bin the distance from the disc's centre (eq. 10), which stays below 1 so
 * that a rim is not taken for the next bin's centre. */
static uint32_t binned(const slots_call *call, const iso_disc_hit *hit) {
    const double least = (double)call->discs.depth[0], range = (double)call->discs.depth[1] - least,
                 part = range > 0 ? ((double)hit->depth - least) / range : 0,
                 bin = floor((part < 0   ? 0
                              : part > 1 ? 1
                                         : part) *
                             call->bins),
                 distance = sqrt((double)hit->e) * (1 - 1.0 / 4096);
    return (uint32_t)((bin + distance) * (4294967295.0 / (call->bins + 2)));
}

static uint64_t key_of(const slots_call *call, const iso_disc *disc, uint32_t number,
                       const iso_disc_hit *hit) {
    const float thickness = disc->radius * (ISO_SPLATS_THICKNESS / ISO_SPLATS_DISC);
    const uint32_t depth = call->bins > 0 ? binned(call, hit) : ordered_bits(hit->depth + thickness * hit->e);
    return (uint64_t)depth << 32 | number;
}

/* ---- drawing */

static void draw_disc(const slots_band *band, uint32_t number) {
    const slots_call *call = band->call;
    const iso_disc_view *view = &call->discs.view;
    const iso_disc *disc = (const iso_disc *)call->discs.disc.data + number;
    const int width = call->target->gbuffer->width;
    const iso_disc_box within = {{0, width - 1}, band->rows}, box = iso_disc_bounds(view, disc, &within);
    uint64_t *slot = band->keys + call->groups->group[disc->point];
    for (int y = box.rows.first; y <= box.rows.last; y++)
        for (int x = box.columns.first; x <= box.columns.last; x++) {
            iso_disc_hit hit;
            if (!iso_disc_intersect(view, disc, iso_disc_column(view, x), iso_disc_row(view, y), &hit))
                continue;
            const size_t pixel = (size_t)(y - band->rows.first) * (size_t)width + (size_t)x;
            uint64_t *to = slot + pixel * (size_t)call->slots;
            const uint64_t key = key_of(call, disc, number, &hit);
            *to = key < *to ? key : *to;
        }
}

/* ---- resolving */

/* The discs of a pixel's slots, intersected again. */
typedef struct candidates {
    const iso_disc *disc[ISO_GROUPS_MOST];
    iso_disc_hit hit[ISO_GROUPS_MOST];
    int count, front; /* front: the nearest one */
} candidates;

static void find_candidates(const slots_call *call, const uint64_t *keys, float x, float y, candidates *c) {
    c->count = c->front = 0;
    for (int k = 0; k < call->slots; k++) {
        if (keys[k] == NO_DISC) continue;
        const iso_disc *disc = (const iso_disc *)call->discs.disc.data + (uint32_t)keys[k];
        iso_disc_intersect(&call->discs.view, disc, x, y, &c->hit[c->count]);
        c->disc[c->count] = disc;
        if (c->hit[c->count].depth < c->hit[c->front].depth) c->front = c->count;
        c->count++;
    }
}

/* Weighted sums over the discs of a layer. */
typedef struct sums {
    float weight, depth, normal[3], color[3];
} sums;

static void add_disc(const slots_call *call, const iso_disc *disc, const iso_disc_hit *hit, sums *s) {
    const float w = iso_disc_weight(hit->e);
    s->weight += w;
    s->depth += w * hit->depth;
    for (int k = 0; k < 3; k++) s->normal[k] += w * disc->normal[k];
    for (int k = 0; k < 3 && call->points->colors; k++)
        s->color[k] += w * (float)call->points->colors[disc->point][k];
}

static sums add_front(const slots_call *call, const candidates *c) {
    const iso_disc_hit *front = &c->hit[c->front];
    sums s = {0};
    for (int i = 0; i < c->count; i++) {
        const float thickness = c->disc[i]->radius * (ISO_SPLATS_THICKNESS / ISO_SPLATS_DISC);
        if (c->hit[i].away == front->away && c->hit[i].depth <= front->depth + thickness)
            add_disc(call, c->disc[i], &c->hit[i], &s);
    }
    return s;
}

static void write_sample(const slots_call *call, const sums *s, size_t at) {
    const iso_gbuffer *g = call->target->gbuffer;
    const float depth = s->depth / s->weight, *n = s->normal,
                length = sqrtf(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    if (!(depth < g->depth[at])) return;
    g->depth[at] = depth;
    g->surface[at] = call->target->surface;
    for (int k = 0; k < 3; k++) g->normal[k][at] = length > 0 ? n[k] / length : k == 2 ? -1.0f : 0.0f;
    if (!call->points->colors) return;
    uint32_t color = 0;
    for (int k = 0; k < 3; k++) color |= (uint32_t)(s->color[k] / s->weight + 0.5f) << 8 * k;
    g->color[at] = color | (uint32_t)(call->target->surface + 1) << 24;
}

static void resolve_row(const slots_band *band, int y) {
    const slots_call *call = band->call;
    const iso_disc_view *view = &call->discs.view;
    const int width = call->target->gbuffer->width;
    const uint64_t *keys = band->keys + (size_t)(y - band->rows.first) * (size_t)(width * call->slots);
    for (int x = 0; x < width; x++, keys += call->slots) {
        candidates c;
        find_candidates(call, keys, iso_disc_column(view, x), iso_disc_row(view, y), &c);
        if (c.count == 0) continue;
        const sums s = add_front(call, &c);
        write_sample(call, &s, (size_t)y * (size_t)width + (size_t)x);
    }
}

/* ---- bands */

static void draw_band(void *context, size_t index, int worker) {
    const slots_call *call = context;
    const int first = (int)index * call->discs.band_rows, left = call->target->gbuffer->height - first,
              count = left < call->discs.band_rows ? left : call->discs.band_rows;
    const slots_band band = {call, {first, first + count - 1}, call->keys + (size_t)worker * call->capacity};
    const size_t *start = (const size_t *)call->discs.start.data + index;
    const uint32_t *order = call->discs.order.data;
    memset(band.keys, 0xff, call->capacity * sizeof *band.keys); /* NO_DISC */
    for (size_t i = start[0]; i < start[1]; i++) draw_disc(&band, order[i]);
    for (int y = first; y < first + count; y++) resolve_row(&band, y);
}

/* Rows of a band: as many as fit, but few enough that all threads get bands. */
static int band_rows(const slots_call *call) {
    const int height = call->target->gbuffer->height, threads = iso_pool_threads(call->target->pool),
              share = (height + 4 * threads - 1) / (4 * threads);
    const size_t row = (size_t)call->target->gbuffer->width * (size_t)call->slots * sizeof(uint64_t),
                 fit = BAND_BYTES / row;
    const int rows = fit < (size_t)share ? (int)fit : share;
    return rows < LEAST_ROWS ? LEAST_ROWS : rows;
}

static iso_status draw_bands(slots_call *call, iso_error *error) {
    iso_pool *pool = call->target->pool;
    const int height = call->target->gbuffer->height, rows = band_rows(call);
    ISO_TRY(iso_discs_project(&call->discs, call->target->view, call->points, ISO_SPLATS_DISC, pool, error));
    ISO_TRY(iso_discs_assign(&call->discs, height, rows, false, error));
    call->capacity = (size_t)rows * (size_t)call->target->gbuffer->width * (size_t)call->slots;
    call->keys = iso_alloc((size_t)iso_pool_threads(pool) * call->capacity * sizeof *call->keys);
    if (!call->keys) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for slots of splats");
    iso_parallel_for(pool, (size_t)call->discs.bands, draw_band, call);
    iso_free(call->keys);
    return ISO_OK;
}

static iso_status draw_groups(const iso_target *target, const iso_point_view *points,
                              const iso_groups *groups, int bins, iso_error *error) {
    slots_call call = {
        .target = target, .points = points, .groups = groups, .slots = groups->count, .bins = bins};
    if (groups->count == 0) return ISO_OK;
    if (points->colors) ISO_TRY(iso_gbuffer_add_color(target->gbuffer, error));
    const iso_status status = draw_bands(&call, error);
    iso_discs_free(&call.discs);
    return status;
}

iso_groups_opts iso_splats_grouping(iso_pool *pool) {
    return (iso_groups_opts){.disc = (double)ISO_SPLATS_DISC, .limit = ISO_SPLATS_GROUPS, .pool = pool};
}

iso_status iso_draw_splats(const iso_target *target, const iso_point_view *points,
                           const iso_splats_opts *opts, iso_error *error) {
    assert(target->view->width == target->gbuffer->width && target->view->height == target->gbuffer->height);
    const int bins = opts ? opts->bins : 0;
    if (opts && opts->groups) return draw_groups(target, points, opts->groups, bins, error);
    const iso_groups_opts grouping = iso_splats_grouping(target->pool);
    iso_groups groups;
    ISO_TRY(iso_groups_make(points, &grouping, &groups, error));
    const iso_status status = draw_groups(target, points, &groups, bins, error);
    iso_groups_free(&groups);
    return status;
}
