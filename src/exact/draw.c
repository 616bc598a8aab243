/* draw: draws or paints a surface in bands of rows, distributed over threads. */
#include <stdatomic.h>
#include <string.h>

#include "base/memory.h"
#include "exact/frame.h"
#include "render/shading/phong_vectors.h"

enum {
    BAND_BITS = 1 << 20,  /* upper limit of a band's pixels: their bits (`open`) should stay in cache */
    BANDS_PER_THREAD = 4, /* at least this many, so that threads finish at about the same time */
    LEAST_ROWS = 32       /* fewest rows of a band, as octants are prepared anew in each band they lie in */
};

typedef struct exact_draw {
    iso_exact_frame frame;
    int band_count;
    iso_exact_scratch *scratch; /* by worker */
    atomic_size_t covered;      /* pixels that show the surface; set when a picture is painted */
} exact_draw;

/* Writes the background to the pixels of a band that are still free; returns the number of the others. */
static size_t fill_free_pixels(const exact_draw *draw, const iso_exact_scratch *scratch) {
    const int width = draw->frame.projection.target->gbuffer->width;
    const iso_exact_paint *paint = draw->frame.projection.paint;
    size_t taken = 0;
    for (int y = scratch->rows.first; y <= scratch->rows.last; y++) {
        const uint64_t *row = scratch->open + (ptrdiff_t)(y - scratch->rows.first) * scratch->words;
        int32_t *pixels = paint->pixels + (ptrdiff_t)y * width;
        taken += (size_t)width;
        for (int word = 0; word < scratch->words; word++, pixels += 64) {
            taken -= (size_t)__builtin_popcountll(row[word]);
            for (uint64_t open = row[word]; open;) {
                const int first = __builtin_ctzll(open);
                const uint64_t rest = ~(open >> first);
                const int end = first + (rest ? __builtin_ctzll(rest) : 64);
                for (int x = first; x < end; x++) pixels[x] = paint->empty;
                open &= end < 64 ? ~(uint64_t)0 << end : 0;
            }
        }
    }
    return taken;
}

static void draw_band(void *context, size_t index, int worker) {
    exact_draw *draw = context;
    const iso_exact_projection *projection = &draw->frame.projection;
    iso_exact_scratch *scratch = &draw->scratch[worker];
    iso_exact_frame_draw(
        &draw->frame, iso_band_rows(projection->target->gbuffer->height, draw->band_count, index), scratch);
    if (projection->paint)
        atomic_fetch_add_explicit(&draw->covered, fill_free_pixels(draw, scratch), memory_order_relaxed);
}

static int choose_band_count(const iso_pool *pool, int height, int words) {
    const int threads = iso_pool_threads(pool),
              most = BAND_BITS / 64 / words > 1 ? BAND_BITS / 64 / words : 1;
    int bands = (height + most - 1) / most;
    if (threads > 1 && bands < BANDS_PER_THREAD * threads) bands = BANDS_PER_THREAD * threads;
    const int limit = (height + LEAST_ROWS - 1) / LEAST_ROWS;
    if (most >= LEAST_ROWS && bands > limit) bands = limit;
    return bands;
}

static iso_status draw_bands(exact_draw *draw, iso_error *error) {
    const iso_target *target = draw->frame.projection.target;
    const int width = target->gbuffer->width, height = target->gbuffer->height;
    draw->frame.kernel = iso_exact_kernel_get(iso_cpu_best());
    draw->band_count = choose_band_count(target->pool, height, width / 64 + 2);
    draw->scratch = iso_exact_scratch_create((size_t)iso_pool_threads(target->pool), width,
                                             (height + draw->band_count - 1) / draw->band_count);
    iso_status status = draw->scratch ? iso_exact_frame_start(&draw->frame, error)
                                      : iso_fail(error, ISO_ERR_NOMEM, "out of memory for drawing cells");
    if (status == ISO_OK) iso_parallel_for(target->pool, (size_t)draw->band_count, draw_band, draw);
    iso_exact_frame_free(&draw->frame);
    iso_free(draw->scratch);
    return status;
}

iso_status iso_draw_exact(const iso_target *target, const iso_exact *exact, iso_error *error) {
    if (!exact->sorted || exact->set.span_count == 0) return ISO_OK;
    exact_draw draw = {.frame.projection = iso_exact_projection_make(target, exact)};
    return draw_bands(&draw, error);
}

/* ---- a picture without a gbuffer */

static int32_t pack_rgba(iso_rgb color, int alpha) {
    const uint8_t bytes[4] = {color.r, color.g, color.b, (uint8_t)alpha};
    int32_t word;
    memcpy(&word, bytes, sizeof word);
    return word;
}

iso_status iso_paint_exact(const iso_exact_picture *picture, const iso_exact *exact, size_t *covered,
                           iso_error *error) {
    const iso_view *view = picture->view;
    const iso_shading *shading = picture->shading;
    const iso_rgb color = shading->colors[0], none = {0, 0, 0};
    const size_t width = (size_t)view->width, height = (size_t)view->height;
    float *slopes = iso_alloc((width + ISO_LANES_MAX + height) * sizeof *slopes);
    if (!slopes) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for a picture's rays");
    float *u = slopes, *v = slopes + width + ISO_LANES_MAX;
    for (int x = 0; x < view->width + ISO_LANES_MAX; x++) u[x] = iso_slope_of_column(view, x);
    for (int y = 0; y < view->height; y++) v[y] = iso_slope_of_row(view, y);
    iso_gbuffer size = {.width = view->width, .height = view->height};
    const iso_target target = {.view = view, .gbuffer = &size, .pool = picture->pool};
    const iso_exact_paint paint = {
        .pixels = (int32_t *)picture->image->rgba,
        .u = u,
        .v = v,
        .base = {(float)color.r / 255, (float)color.g / 255, (float)color.b / 255},
        .empty = shading->transparent ? pack_rgba(none, 0) : pack_rgba(shading->background, 255),
    };
    exact_draw draw = {.frame.projection = iso_exact_projection_make(&target, exact)};
    draw.frame.projection.paint = &paint;
    const iso_status status = draw_bands(&draw, error);
    iso_free(slopes);
    if (covered && status == ISO_OK) *covered = atomic_load(&draw.covered);
    return status;
}
