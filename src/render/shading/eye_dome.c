/* eye_dome: distributes the rows over threads; the kernel is eye_dome_body.inc. */
#include "render/shading/eye_dome.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "base/exponential.h"
#include "base/simd.h"
#include "render/view/project.h"
#include "render/view/strip.h"

enum {
    TILE = 512, /* columns whose light is found together */
    SIDE = ISO_EYE_DOME_REACH * ISO_FACTOR_MAX,
    ROWS = 2 * ISO_EYE_DOME_RINGS + 1, /* of depths that a row of light needs */
    STRIDE = TILE + 2 * SIDE + ISO_LANES_MAX
};

/* What the rows have in common. */
typedef struct rows {
    const iso_view *view;
    const iso_gbuffer *gbuffer;
    int factor, first, last, bands;
} rows;

/* The depths around a part of a row: row ISO_EYE_DOME_RINGS is the row itself, and the others are those 1, 2,
 * 4 pixels above and below it. A part begins SIDE columns before its first sample. */
typedef float depths[ROWS][STRIDE];

/* The distance in pixels of row `number` from the row whose light is found. */
static int distance_of(int number) {
    const int step = number - ISO_EYE_DOME_RINGS;
    return step < 0 ? -(1 << (-step - 1)) : step > 0 ? 1 << (step - 1) : 0;
}

/* Copies depths from column x on, INFINITY where the gbuffer has none. */
static void copy_depths(const rows *r, int x, int y, depths around) {
    const iso_gbuffer *g = r->gbuffer;
    const int first = x - SIDE, from = first > 0 ? first : 0,
              to = first + STRIDE < g->width ? first + STRIDE : g->width;
    for (int number = 0; number < ROWS; number++) {
        const int row = y + r->factor * distance_of(number);
        float *copy = around[number];
        for (int i = 0; i < STRIDE; i++) copy[i] = INFINITY;
        if (row >= 0 && row < g->height)
            memcpy(copy + (from - first), g->depth + (size_t)row * (size_t)g->width + from,
                   (size_t)(to - from) * sizeof *copy);
    }
}

#define ISO_KERNEL_BODY "render/shading/eye_dome_body.inc"
#include "base/kernel_levels.inc"

/* Finds the light of `count` samples: part[i] of sample i of the row in the middle of `around`. */
typedef void light_fn(const rows *r, const depths around, int count, float *part);

static light_fn *light_of(iso_cpu_level level) {
    return ISO_KERNEL(light, level);
}

static void light_band(void *context, size_t number, int worker) {
    (void)worker;
    const rows *r = context;
    light_fn *light = light_of(iso_cpu_best());
    const iso_rows band = iso_band_rows(r->last - r->first + 1, r->bands, number);
    depths around;
    float part[TILE + ISO_LANES_MAX];
    for (int y = r->first + band.first; y <= r->first + band.last; y++)
        for (int x = 0; x < r->gbuffer->width; x += TILE) {
            const int left = r->gbuffer->width - x, count = left < TILE ? left : TILE;
            copy_depths(r, x, y, around);
            light(r, around, count, part);
            memcpy(r->gbuffer->light + (size_t)y * (size_t)r->gbuffer->width + x, part,
                   (size_t)count * sizeof *part);
        }
}

void iso_eye_dome_light(const iso_view *view, int factor, int first, int last, const iso_gbuffer *gbuffer,
                        iso_pool *pool) {
    assert(gbuffer->light && factor >= 1 && factor <= ISO_FACTOR_MAX);
    const int bands = iso_band_count(pool, last - first + 1);
    rows r = {view, gbuffer, factor, first, last, bands};
    iso_parallel_for(pool, (size_t)bands, light_band, &r);
}
