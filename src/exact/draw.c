/* draw: lists the visible octants front to back, then draws bands of rows, distributed over threads. Every
 * worker draws all octants that are visible in its band. */
#include <stdatomic.h>
#include <string.h>

#include "base/memory.h"
#include "exact/kernel.h"
#include "render/shading/phong_vectors.h"

enum {
    SPANS_PER_TASK = 64,
    BAND_BITS = 1 << 20,  /* upper limit of a band's pixels: their bits (`open`) should stay in cache */
    BANDS_PER_THREAD = 4, /* at least this many, so that threads finish at about the same time */
    LEAST_ROWS = 32       /* fewest rows of a band, as octants are prepared anew in each band they lie in */
};

typedef struct exact_draw {
    iso_exact_projection projection;
    const iso_exact_kernel *kernel;
    uint32_t *order; /* spans front to back */
    size_t span_count;
    /* the visible octants of the spans of task t, from index t * SPANS_PER_TASK * ISO_EXACT_OCTANTS on */
    iso_exact_visible *visible;
    int *visible_count; /* number of visible octants, by task */
    size_t task_count;
    int band_count, words;      /* words: 64-bit words of free-pixel bits in a row */
    iso_exact_scratch *scratch; /* by worker */
    uint64_t *open;             /* free-pixel bits: open_words words for each worker */
    size_t open_words;
    atomic_size_t covered; /* pixels that show the surface; set when a picture is painted */
} exact_draw;

static size_t task_count(const iso_exact *exact) {
    if (!exact->sorted) return 0;
    return (exact->set.span_count + SPANS_PER_TASK - 1) / SPANS_PER_TASK;
}

static int brick_split(int cells) {
    return cells >= 0 ? cells / ISO_BRICK : -1;
}

static void order_spans(exact_draw *draw) {
    const iso_exact *exact = draw->projection.exact;
    const uint32_t *rows = exact->rows.data, *order = exact->order.data;
    const int *bricks = exact->set.bricks;
    int split[3];
    for (int axis = 0; axis < 3; axis++) split[axis] = brick_split(draw->projection.split[axis]);
    size_t count = 0;
    for (int k = 0; k < bricks[2]; k++)
        for (int j = 0; j < bricks[1]; j++) {
            const size_t row = (size_t)iso_exact_front_to_back(k, bricks[2], split[2]) * (size_t)bricks[1] +
                               (size_t)iso_exact_front_to_back(j, bricks[1], split[1]);
            uint32_t middle = rows[row];
            while (middle < rows[row + 1] && iso_exact_spans(exact)[order[middle]].brick[0] < split[0])
                middle++;
            for (uint32_t i = middle; i < rows[row + 1]; i++) draw->order[count++] = order[i];
            for (uint32_t i = middle; i > rows[row]; i--) draw->order[count++] = order[i - 1];
        }
    draw->span_count = count;
}

static void list_task_octants(void *context, size_t index, int worker) {
    (void)worker;
    exact_draw *draw = context;
    iso_exact_visible *visible = draw->visible + index * SPANS_PER_TASK * ISO_EXACT_OCTANTS;
    size_t end = (index + 1) * SPANS_PER_TASK;
    if (end > draw->span_count) end = draw->span_count;
    int count = 0;
    for (size_t i = index * SPANS_PER_TASK; i < end; i++)
        count += iso_exact_list_visible_octants(&draw->projection, draw->order[i], visible + count);
    draw->visible_count[index] = count;
}

static void start_band(exact_draw *draw, iso_exact_scratch *scratch, size_t band) {
    const int width = draw->projection.target->gbuffer->width;
    scratch->rows = iso_band_rows(draw->projection.target->gbuffer->height, draw->band_count, band);
    scratch->words = draw->words;
    scratch->hits.count = scratch->hits.slots = 0;
    scratch->pairs = scratch->general = scratch->windows = 0;
    scratch->patch.count = scratch->patch.runs = 0;
    for (int y = 0; y <= scratch->rows.last - scratch->rows.first; y++) {
        uint64_t *row = scratch->open + (size_t)y * (size_t)draw->words;
        for (int word = 0; word < draw->words; word++) row[word] = word < width / 64 ? ~(uint64_t)0 : 0;
        if (width % 64) row[width / 64] = ((uint64_t)1 << width % 64) - 1;
    }
}

/* Writes the background to the pixels of a band that are still free; returns the number of the others. */
static size_t fill_free_pixels(const exact_draw *draw, const iso_exact_scratch *scratch) {
    const int width = draw->projection.target->gbuffer->width;
    const iso_exact_paint *paint = draw->projection.paint;
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
    iso_exact_scratch *scratch = &draw->scratch[worker];
    start_band(draw, scratch, index);
    for (size_t task = 0; task < draw->task_count; task++) {
        const iso_exact_visible *visible = draw->visible + task * SPANS_PER_TASK * ISO_EXACT_OCTANTS;
        draw->kernel->draw(&draw->projection, visible, draw->visible_count[task], scratch);
    }
    draw->kernel->flush(&draw->projection, scratch);
    if (draw->projection.paint)
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

static iso_status alloc_draw(exact_draw *draw, iso_error *error) {
    const iso_gbuffer *gbuffer = draw->projection.target->gbuffer;
    const size_t workers = (size_t)iso_pool_threads(draw->projection.target->pool);
    const iso_exact *exact = draw->projection.exact;
    draw->task_count = task_count(exact);
    draw->words = gbuffer->width / 64 + 2;
    draw->band_count = choose_band_count(draw->projection.target->pool, gbuffer->height, draw->words);
    const size_t rows = (size_t)((gbuffer->height + draw->band_count - 1) / draw->band_count);
    draw->open_words = rows * (size_t)draw->words;
    draw->order = iso_alloc(exact->set.span_count * sizeof *draw->order);
    draw->visible = iso_alloc(draw->task_count * SPANS_PER_TASK * ISO_EXACT_OCTANTS * sizeof *draw->visible);
    draw->visible_count = iso_alloc(draw->task_count * sizeof *draw->visible_count);
    draw->scratch = iso_alloc(workers * sizeof *draw->scratch);
    draw->open = iso_alloc(workers * draw->open_words * sizeof *draw->open);
    if (!draw->order || !draw->visible || !draw->visible_count || !draw->scratch || !draw->open)
        return iso_fail(error, ISO_ERR_NOMEM, "out of memory for drawing %zu bricks of cells",
                        exact->set.span_count);
    for (size_t worker = 0; worker < workers; worker++)
        draw->scratch[worker].open = draw->open + worker * draw->open_words;
    return ISO_OK;
}

static void free_draw(exact_draw *draw) {
    iso_free(draw->order);
    iso_free(draw->visible);
    iso_free(draw->visible_count);
    iso_free(draw->scratch);
    iso_free(draw->open);
}

static iso_status draw_bands(exact_draw *draw, iso_error *error) {
    iso_pool *pool = draw->projection.target->pool;
    draw->kernel = iso_exact_kernel_get(iso_cpu_best());
    draw->projection.gradients = iso_exact_gradients_get(&draw->projection.exact->grid, iso_cpu_best());
    iso_status status = alloc_draw(draw, error);
    if (status == ISO_OK) {
        if (draw->task_count) order_spans(draw);
        iso_parallel_for(pool, draw->task_count, list_task_octants, draw);
        iso_parallel_for(pool, (size_t)draw->band_count, draw_band, draw);
    }
    free_draw(draw);
    return status;
}

iso_status iso_draw_exact(const iso_target *target, const iso_exact *exact, iso_error *error) {
    if (!exact->sorted || exact->set.span_count == 0) return ISO_OK;
    exact_draw draw = {.projection = iso_exact_projection_make(target, exact)};
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
    exact_draw draw = {.projection = iso_exact_projection_make(&target, exact)};
    draw.projection.paint = &paint;
    const iso_status status = draw_bands(&draw, error);
    iso_free(slopes);
    if (covered && status == ISO_OK) *covered = atomic_load(&draw.covered);
    return status;
}
