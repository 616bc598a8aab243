/* gbuffer: one allocation for depths, normals and surface numbers, others for colours and elements. */
#include "render/view/gbuffer.h"

#include <math.h>
#include <string.h>

#include "base/memory.h"

enum { SAMPLE_BYTES = 5 * sizeof(float) + 1 }; /* of all planes */

/* Unused bytes between planes. The values of one sample are used together: without a gap of an odd number of
 * cache lines, those of a picture of 1024 x 1024 samples would all map to the same cache sets. */
enum { GAP = 5 * ISO_ALIGNMENT };

static size_t plane_bytes(size_t samples) {
    return (samples * sizeof(float) + ISO_ALIGNMENT - 1) / ISO_ALIGNMENT * ISO_ALIGNMENT + GAP;
}

/* The planes share one allocation, which begins with the depths. */
iso_status iso_gbuffer_create(int width, int height, iso_gbuffer *gbuffer, iso_error *error) {
    size_t samples;
    if (width < 1 || height < 1 || !iso_size_multiply((size_t)width, (size_t)height, &samples) ||
        samples > (SIZE_MAX - 8 * (GAP + ISO_ALIGNMENT)) / SAMPLE_BYTES)
        return iso_fail(error, ISO_ERR_NOMEM, "a buffer of %dx%d samples is impossible", width, height);
    const size_t bytes = plane_bytes(samples);
    char *block = iso_alloc(4 * bytes + samples);
    if (!block) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for %dx%d samples", width, height);
    *gbuffer = (iso_gbuffer){.width = width, .height = height, .depth = (float *)block, .samples = samples};
    for (int axis = 0; axis < 3; axis++)
        gbuffer->normal[axis] = (float *)(block + (size_t)(1 + axis) * bytes);
    gbuffer->surface = (uint8_t *)(block + 4 * bytes);
    return ISO_OK;
}

/* Allocates a plane of zeros unless it exists. */
static iso_status add_plane(const iso_gbuffer *gbuffer, uint32_t **plane, const char *what,
                            iso_error *error) {
    if (!*plane) *plane = iso_alloc_zero(gbuffer->samples, sizeof **plane);
    if (*plane) return ISO_OK;
    return iso_fail(error, ISO_ERR_NOMEM, "out of memory for the %s of %zu samples", what, gbuffer->samples);
}

iso_status iso_gbuffer_add_color(iso_gbuffer *gbuffer, iso_error *error) {
    return add_plane(gbuffer, &gbuffer->color, "colours", error);
}

iso_status iso_gbuffer_add_elements(iso_gbuffer *gbuffer, iso_error *error) {
    return add_plane(gbuffer, &gbuffer->element, "elements", error);
}

iso_status iso_gbuffer_add_plane(const iso_gbuffer *gbuffer, float **plane, iso_error *error) {
    if (!*plane) *plane = iso_alloc(gbuffer->samples * sizeof **plane);
    if (*plane) return ISO_OK;
    return iso_fail(error, ISO_ERR_NOMEM, "out of memory for the light of %zu samples", gbuffer->samples);
}

void iso_gbuffer_free(iso_gbuffer *gbuffer) {
    iso_free(gbuffer->depth);
    iso_free(gbuffer->color);
    iso_free(gbuffer->element);
    iso_free(gbuffer->light);
    iso_free(gbuffer->ambient);
    iso_free(gbuffer->key);
    iso_free(gbuffer->ink);
    *gbuffer = (iso_gbuffer){0};
}

enum {
    LINE = ISO_ALIGNMENT / sizeof(float), /* depths of a cache line */
    AHEAD = 4096 / sizeof(float)          /* a page ahead: hardware prefetchers stop at the end of a page */
};

static void clear_depths(float *depth, size_t count) {
    for (size_t line = 0; line < count; line += LINE) {
        const size_t end = line + LINE < count ? line + LINE : count;
        __builtin_prefetch(depth + line + AHEAD, 1, 2);
        for (size_t i = line; i < end; i++) depth[i] = INFINITY;
    }
}

static void clear_samples(iso_gbuffer *gbuffer, size_t first, size_t count) {
    clear_depths(gbuffer->depth + first, count);
    memset(gbuffer->surface + first, ISO_SURFACE_NONE, count);
    if (gbuffer->color) memset(gbuffer->color + first, 0, count * sizeof *gbuffer->color);
    if (gbuffer->element) memset(gbuffer->element + first, 0, count * sizeof *gbuffer->element);
}

void iso_gbuffer_clear(iso_gbuffer *gbuffer) {
    clear_samples(gbuffer, 0, (size_t)gbuffer->width * (size_t)gbuffer->height);
}

/* Samples that one task clears. */
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
