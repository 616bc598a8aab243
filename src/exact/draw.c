/* draw: draws or paints a surface in bands of rows, distributed over threads. */
#include <stdatomic.h>

#include "base/kernel_units.h"
#include "base/memory.h"
#include "exact/frame.h"
#include "render/shading/phong_vectors.h"

enum {
    BAND_BITS = 1 << 20,    /* upper limit of a band's pixels: their bits (`open`) should stay in cache */
    BAND_SAMPLES = 1 << 18, /* and if samples are averaged, for these */
    BANDS_PER_THREAD = 4,   /* at least this many, so that threads finish at about the same time */
    LEAST_ROWS = 32         /* fewest rows of a band, as octants are prepared anew in each band they lie in */
};

typedef struct exact_draw {
    iso_exact_frame frame;
    iso_rows rows; /* that are drawn */
    int band_count;
    iso_exact_scratch *scratch; /* by worker */
    iso_exact_single *singles;  /* by worker, of a key image */
    atomic_size_t covered;      /* samples that show the surface; set when a picture is painted */
    /* A picture of several samples a pixel, else NULL and 1; `samples` has `room` items for each worker. */
    const iso_exact_picture *averaged;
    int factor;
    int32_t *samples;
    size_t room;
} exact_draw;

/* Writes the background to the pixels of a band that are still free; returns the number of the others. */
static size_t fill_free_pixels(const iso_exact_projection *projection, const iso_exact_scratch *scratch) {
    const int width = projection->target->gbuffer->width;
    const iso_exact_paint *paint = projection->paint;
    size_t taken = 0;
    for (int y = scratch->rows.first; y <= scratch->rows.last; y++) {
        const uint64_t *row = scratch->open + (ptrdiff_t)(y - scratch->rows.first) * scratch->words;
        int32_t *pixels = paint->pixels + ((ptrdiff_t)y * width - paint->skipped);
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

/* Draws a band into the gbuffer or the picture. */
static void draw_rows(exact_draw *draw, const iso_exact_frame *frame, iso_rows band, int worker) {
    const iso_exact_paint *paint = frame->projection.paint;
    iso_exact_scratch *scratch = &draw->scratch[worker];
    iso_exact_frame_draw(frame, band, scratch);
    if (paint && paint->pixels)
        atomic_fetch_add_explicit(&draw->covered, fill_free_pixels(&frame->projection, scratch),
                                  memory_order_relaxed);
}

/* Draws a band of samples, and averages them to pixels while they are in the cache. */
static void average_rows(exact_draw *draw, iso_rows band, int worker) {
    const iso_exact_picture *picture = draw->averaged;
    iso_exact_frame frame = draw->frame;
    iso_exact_paint paint = *frame.projection.paint;
    paint.pixels = draw->samples + (size_t)worker * draw->room;
    paint.skipped = (ptrdiff_t)band.first * picture->view->width;
    frame.projection.paint = &paint;
    draw_rows(draw, &frame, band, worker);
    const iso_shaded_samples shaded = {paint.pixels, draw->factor, band.first / draw->factor,
                                       (band.last + 1 - band.first) / draw->factor};
    iso_average_samples(picture->shading, &shaded, picture->image);
}

static void draw_band(void *context, size_t index, int worker) {
    exact_draw *draw = context;
    const int factor = draw->factor, first = draw->rows.first;
    const iso_rows pixels = iso_band_rows((draw->rows.last - first + 1) / factor, draw->band_count, index),
                   band = {first + factor * pixels.first, first + factor * pixels.last + factor - 1};
    if (draw->averaged)
        average_rows(draw, band, worker);
    else
        draw_rows(draw, &draw->frame, band, worker);
}

static int choose_band_count(const iso_pool *pool, int height, int words, int pixels) {
    const int threads = iso_pool_threads(pool), most = pixels / 64 / words > 1 ? pixels / 64 / words : 1;
    int bands = (height + most - 1) / most;
    if (threads > 1 && bands < BANDS_PER_THREAD * threads) bands = BANDS_PER_THREAD * threads;
    const int limit = (height + LEAST_ROWS - 1) / LEAST_ROWS;
    if (most >= LEAST_ROWS && bands > limit) bands = limit;
    return bands;
}

/* Sets draw->rows; false: nothing is to be drawn. */
static bool choose_rows(exact_draw *draw) {
    const iso_exact_projection *projection = &draw->frame.projection;
    int pixels[4];
    draw->rows = (iso_rows){0, projection->target->gbuffer->height - 1};
    if (!projection->paint || !projection->paint->keys) return true;
    if (!iso_exact_frame_limit(&draw->frame, pixels)) return false;
    draw->rows = (iso_rows){pixels[2], pixels[3]};
    return true;
}

static iso_status draw_started_frame(exact_draw *draw, iso_error *error) {
    const iso_target *target = draw->frame.projection.target;
    const int width = target->gbuffer->width, height = draw->rows.last - draw->rows.first + 1,
              pixel_rows = height / draw->factor,
              bands = choose_band_count(target->pool, height, width / 64 + 2,
                                        draw->averaged ? BAND_SAMPLES : BAND_BITS);
    const size_t workers = (size_t)iso_pool_threads(target->pool);
    draw->band_count = bands < pixel_rows ? bands : pixel_rows;
    const int rows = (pixel_rows + draw->band_count - 1) / draw->band_count * draw->factor;
    draw->room = (size_t)rows * (size_t)width;
    if (draw->averaged) draw->samples = iso_alloc(workers * draw->room * sizeof *draw->samples);
    const bool keys = draw->frame.projection.paint && draw->frame.projection.paint->keys;
    if (keys) draw->singles = iso_alloc(workers * sizeof *draw->singles);
    draw->scratch = iso_exact_scratch_create(workers, width, rows);
    const bool ready = draw->scratch && (draw->samples || !draw->averaged) && (draw->singles || !keys);
    for (size_t worker = 0; ready && keys && worker < workers; worker++)
        draw->scratch[worker].single = &draw->singles[worker];
    if (ready) iso_parallel_until(target->pool, (size_t)draw->band_count, draw_band, draw);
    iso_free(draw->scratch);
    iso_free(draw->singles);
    iso_free(draw->samples);
    return ready ? ISO_OK : iso_fail(error, ISO_ERR_NOMEM, "out of memory for drawing cells");
}

static iso_status draw_bands(exact_draw *draw, iso_error *error) {
    draw->frame.kernel = ISO_KERNEL_UNIT(iso_exact_kernel, iso_cpu_best());
    iso_status status = iso_exact_frame_start(&draw->frame, error);
    if (status == ISO_OK && choose_rows(draw)) status = draw_started_frame(draw, error);
    iso_exact_frame_free(&draw->frame);
    return status;
}

iso_status iso_draw_exact(const iso_target *target, const iso_exact *exact, iso_error *error) {
    if (!exact->sorted || exact->set.span_count == 0) return ISO_OK;
    exact_draw draw = {.frame.projection = iso_exact_projection_make(target, exact), .factor = 1};
    return draw_bands(&draw, error);
}

/* ---- pictures without a gbuffer */

/* Draws by `paint`, of which the caller has set what is written to. */
static iso_status paint(const iso_target *target, iso_exact_paint *paint, iso_rgb color, exact_draw *draw,
                        iso_error *error) {
    const iso_view *view = target->view;
    const size_t width = (size_t)view->width, height = (size_t)view->height;
    float *slopes = iso_alloc((width + ISO_LANES_MAX + height) * sizeof *slopes);
    if (!slopes) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for a picture's rays");
    float *u = slopes, *v = slopes + width + ISO_LANES_MAX;
    for (int x = 0; x < view->width + ISO_LANES_MAX; x++) u[x] = iso_slope_of_column(view, x);
    for (int y = 0; y < view->height; y++) v[y] = iso_slope_of_row(view, y);
    paint->u = u;
    paint->v = v;
    paint->base[0] = (float)color.r / 255;
    paint->base[1] = (float)color.g / 255;
    paint->base[2] = (float)color.b / 255;
    draw->frame.projection.paint = paint;
    const iso_status status = draw_bands(draw, error);
    iso_free(slopes);
    return status;
}

iso_status iso_paint_exact(const iso_exact_picture *picture, const iso_exact *exact, size_t *covered,
                           iso_error *error) {
    const iso_shading *shading = picture->shading;
    iso_gbuffer size = {.width = picture->view->width, .height = picture->view->height};
    const iso_target target = {
        .view = picture->view, .gbuffer = &size, .pool = picture->pool, .clip = picture->clip};
    iso_exact_paint to = {.pixels = (int32_t *)picture->image->rgba, .empty = iso_shading_empty(shading)};
    exact_draw draw = {.frame.projection = iso_exact_projection_make(&target, exact), .factor = 1};
    if (picture->factor > 1) {
        draw.factor = picture->factor;
        draw.averaged = picture;
        to.empty = 0; /* of a sample */
    }
    const iso_status status = paint(&target, &to, shading->colors[0], &draw, error);
    if (covered && status == ISO_OK) *covered = atomic_load(&draw.covered);
    return status;
}

iso_status iso_draw_exact_keys(const iso_exact_key_picture *picture, const iso_exact *exact,
                               iso_error *error) {
    iso_gbuffer size = {.width = picture->view->width, .height = picture->view->height};
    const iso_target target = {
        .view = picture->view, .gbuffer = &size, .pool = picture->pool, .clip = picture->clip};
    iso_exact_paint to = {.keys = picture->keys->keys};
    if (picture->keys->height == ISO_KEY_PLANES * size.height)
        to.depths = to.keys + (size_t)size.width * (size_t)size.height;
    exact_draw draw = {.frame.projection = iso_exact_projection_make(&target, exact), .factor = 1};
    return paint(&target, &to, picture->color, &draw, error);
}
