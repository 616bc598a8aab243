/* groups: draws opaque splats in bands of rows. */
#include "render/groups/groups.h"

#include <assert.h>

#include "base/memory.h"
#include "render/groups/slots.h"

enum {
    BAND_BYTES = 1 << 20, /* largest size of a band's slots in bytes, */
    LEAST_ROWS = 4        /* unless the band has this many rows or fewer */
};

/* The drawing of one surface. */
typedef struct splats_call {
    const iso_target *target;
    iso_slots slots;
    iso_banded_discs discs;
    size_t capacity; /* slots of a band */
    uint64_t *keys;  /* capacity for each worker */
} splats_call;

static void write_sample(const splats_call *call, const iso_splat_sums *sums, size_t at) {
    const iso_gbuffer *g = call->target->gbuffer;
    const float depth = sums->depth / sums->weight;
    float normal[3];
    uint8_t rgb[3];
    if (!(depth < g->depth[at])) return;
    iso_splat_normal(sums, normal);
    g->depth[at] = depth;
    g->surface[at] = call->target->surface;
    for (int k = 0; k < 3; k++) g->normal[k][at] = normal[k];
    if (!call->slots.points->colors) return;
    iso_splat_color(sums, rgb);
    g->color[at] =
        rgb[0] | (uint32_t)rgb[1] << 8 | (uint32_t)rgb[2] << 16 | (uint32_t)(call->target->surface + 1) << 24;
}

static void resolve_row(const splats_call *call, const iso_slots_band *band, int y) {
    const iso_disc_view *view = &call->discs.view;
    const size_t width = (size_t)call->slots.width, slots = (size_t)call->slots.groups->count;
    const uint64_t *keys = band->keys + (size_t)(y - band->rows.first) * width * slots;
    for (size_t x = 0; x < width; x++, keys += slots) {
        iso_splat_sums sums;
        float front;
        if (iso_slots_resolve(&call->slots, keys, iso_disc_column(view, (int)x), iso_disc_row(view, y), &sums,
                              &front))
            write_sample(call, &sums, (size_t)y * width + x);
    }
}

static void draw_band(void *context, size_t index, int worker) {
    const splats_call *call = context;
    const iso_slots_band band = {.slots = &call->slots,
                                 .rows = iso_banded_discs_band(&call->discs, index),
                                 .keys = call->keys + (size_t)worker * call->capacity};
    const size_t *start = (const size_t *)call->discs.start.data + index;
    const uint32_t *order = call->discs.order.data;
    iso_slots_clear(&band);
    for (size_t i = start[0]; i < start[1]; i++) iso_slots_draw(&band, order[i]);
    for (int y = band.rows.first; y <= band.rows.last; y++) resolve_row(call, &band, y);
}

/* Returns the number of rows of a band: as many as fit into memory, but few enough for all threads to get
 * bands. */
static int band_rows(const splats_call *call) {
    const int height = call->target->gbuffer->height, threads = iso_pool_threads(call->target->pool),
              share = (height + 4 * threads - 1) / (4 * threads);
    const size_t row = (size_t)call->slots.width * (size_t)call->slots.groups->count * sizeof(uint64_t),
                 fit = BAND_BYTES / row;
    const int rows = fit < (size_t)share ? (int)fit : share;
    return rows < LEAST_ROWS ? LEAST_ROWS : rows;
}

static iso_status draw_bands(splats_call *call, iso_error *error) {
    const iso_target *target = call->target;
    const int rows = band_rows(call);
    ISO_TRY(iso_banded_discs_project(&call->discs, target->view, call->slots.points, ISO_GROUPS_DISC,
                                     target->pool, error));
    ISO_TRY(
        iso_banded_discs_assign(&call->discs, target->gbuffer->height, rows, ISO_DISC_ORDER_GIVEN, error));
    call->capacity = (size_t)rows * (size_t)call->slots.width * (size_t)call->slots.groups->count;
    call->keys = iso_alloc((size_t)iso_pool_threads(target->pool) * call->capacity * sizeof *call->keys);
    if (!call->keys) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for slots of splats");
    iso_parallel_for(target->pool, (size_t)call->discs.bands, draw_band, call);
    iso_free(call->keys);
    return ISO_OK;
}

static iso_status draw_groups(const iso_target *target, const iso_point_view *points,
                              const iso_groups *groups, int bins, iso_error *error) {
    iso_point_view opaque = *points;
    splats_call call = {.target = target,
                        .slots = {.points = &opaque,
                                  .groups = groups,
                                  .width = target->gbuffer->width,
                                  .bins = bins,
                                  .cut = target->clip && target->clip->count ? target : NULL}};
    opaque.opacities = NULL; /* colours are not weighted by them */
    call.slots.discs = &call.discs;
    if (groups->count == 0) return ISO_OK;
    if (points->colors) ISO_TRY(iso_gbuffer_add_color(target->gbuffer, error));
    const iso_status status = draw_bands(&call, error);
    iso_banded_discs_free(&call.discs);
    return status;
}

iso_groups_opts iso_groups_default_opts(iso_pool *pool) {
    return (iso_groups_opts){.disc = (double)ISO_GROUPS_DISC, .limit = ISO_GROUPS_DEFAULT, .pool = pool};
}

iso_status iso_draw_groups(const iso_target *target, const iso_point_view *points,
                           const iso_draw_groups_opts *opts, iso_error *error) {
    assert(target->view->width == target->gbuffer->width && target->view->height == target->gbuffer->height);
    const int bins = opts ? opts->bins : 0;
    if (opts && opts->groups) return draw_groups(target, points, opts->groups, bins, error);
    const iso_groups_opts grouping = iso_groups_default_opts(target->pool);
    iso_groups groups;
    ISO_TRY(iso_groups_make(points, &grouping, &groups, error));
    const iso_status status = draw_groups(target, points, &groups, bins, error);
    iso_groups_free(&groups);
    return status;
}
