#include "render/gbuffer.h"

#include <math.h>
#include <string.h>

#include "base/memory.h"

enum { SAMPLE_BYTES = 5 * sizeof(float) + 1 }; /* of all planes */

iso_status iso_gbuffer_create(int width, int height, iso_gbuffer *gbuffer, iso_error *error) {
    size_t samples;
    if (width < 1 || height < 1 || !iso_size_multiply((size_t)width, (size_t)height, &samples) ||
        samples > SIZE_MAX / SAMPLE_BYTES)
        return iso_fail(error, ISO_ERR_NOMEM, "a buffer of %dx%d samples is impossible", width, height);
    iso_gbuffer made = {.width = width,
                        .height = height,
                        .depth = iso_alloc(samples * sizeof(float)),
                        .surface = iso_alloc(samples),
                        .samples = samples};
    for (int axis = 0; axis < 3; axis++) made.normal[axis] = iso_alloc(samples * sizeof(float));
    if (!made.depth || !made.normal[0] || !made.normal[1] || !made.normal[2] || !made.surface) {
        iso_gbuffer_free(&made);
        return iso_fail(error, ISO_ERR_NOMEM, "out of memory for %dx%d samples", width, height);
    }
    *gbuffer = made;
    return ISO_OK;
}

iso_status iso_gbuffer_add_color(iso_gbuffer *gbuffer, iso_error *error) {
    if (gbuffer->color) return ISO_OK;
    gbuffer->color = iso_alloc_zero(gbuffer->samples, sizeof *gbuffer->color);
    if (!gbuffer->color)
        return iso_fail(error, ISO_ERR_NOMEM, "out of memory for the colours of %zu samples",
                        gbuffer->samples);
    return ISO_OK;
}

void iso_gbuffer_free(iso_gbuffer *gbuffer) {
    iso_free(gbuffer->depth);
    for (int axis = 0; axis < 3; axis++) iso_free(gbuffer->normal[axis]);
    iso_free(gbuffer->surface);
    iso_free(gbuffer->color);
    *gbuffer = (iso_gbuffer){0};
}

static void clear_samples(iso_gbuffer *gbuffer, size_t first, size_t count) {
    float *depth = gbuffer->depth + first;
    for (size_t i = 0; i < count; i++) depth[i] = INFINITY;
    memset(gbuffer->surface + first, ISO_SURFACE_NONE, count);
    if (gbuffer->color) memset(gbuffer->color + first, 0, count * sizeof *gbuffer->color);
}

void iso_gbuffer_clear(iso_gbuffer *gbuffer) {
    clear_samples(gbuffer, 0, (size_t)gbuffer->width * (size_t)gbuffer->height);
}

/* Bands of samples, not of rows. */
static const size_t BAND = (size_t)1 << 19;

static void clear_band(void *context, size_t band, int worker) {
    (void)worker;
    iso_gbuffer *gbuffer = context;
    size_t samples = (size_t)gbuffer->width * (size_t)gbuffer->height, left = samples - band * BAND;
    clear_samples(gbuffer, band * BAND, left < BAND ? left : BAND);
}

void iso_gbuffer_clear_bands(iso_gbuffer *gbuffer, iso_pool *pool) {
    size_t samples = (size_t)gbuffer->width * (size_t)gbuffer->height;
    iso_parallel_for(pool, (samples + BAND - 1) / BAND, clear_band, gbuffer);
}
