/* eye_dome: distributes the rows over threads; the kernel is eye_dome_kernel.c. */
#include "render/shading/eye_dome.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "base/kernel_units.h"
#include "render/shading/eye_dome_kernel.h"
#include "render/view/project.h"
#include "render/view/strip.h"

/* Copies depths from column x on, INFINITY where the gbuffer has none. */
static void copy_depths(const light_rows *r, int x, int y, depths around) {
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

static void light_band(void *context, size_t number, int worker) {
    (void)worker;
    const light_rows *r = context;
    light_fn *light = ISO_KERNEL_UNIT(iso_eye_dome_light_samples, iso_cpu_best());
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
    light_rows r = {view, gbuffer, factor, first, last, bands};
    iso_parallel_for(pool, (size_t)bands, light_band, &r);
}
