/* strip: averages the samples of each pixel into depth, normal and coverage, and finds its ids. */
#include "render/view/strip.h"

#include <assert.h>
#include <math.h>

/* Sums over the covered samples of a pixel. */
typedef struct sums {
    double depth, normal[3]; /* view space */
    int covered;
    size_t nearest; /* sample; if there is one */
} sums;

static sums sums_of(const iso_strip *strip, int x, int y) {
    const iso_gbuffer *g = strip->gbuffer;
    sums s = {0};
    for (int j = y * strip->factor; j < (y + 1) * strip->factor; j++)
        for (int i = x * strip->factor; i < (x + 1) * strip->factor; i++) {
            size_t sample = (size_t)j * (size_t)g->width + (size_t)i;
            if (g->surface[sample] == ISO_SURFACE_NONE) continue;
            if (!s.covered || g->depth[sample] < g->depth[s.nearest]) s.nearest = sample;
            s.depth += (double)g->depth[sample];
            for (int axis = 0; axis < 3; axis++) s.normal[axis] += (double)g->normal[axis][sample];
            s.covered++;
        }
    return s;
}

static iso_vec3 world_normal(const iso_view *view, const double n[3]) {
    const double *r = view->rotation;
    double length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    if (!(length > 0)) return (iso_vec3){0};
    return iso_vec3_make((r[0] * n[0] + r[3] * n[1] + r[6] * n[2]) / length,
                         (r[1] * n[0] + r[4] * n[1] + r[7] * n[2]) / length,
                         (r[2] * n[0] + r[5] * n[1] + r[8] * n[2]) / length);
}

typedef struct measure {
    const iso_strip *strip;
    iso_aov *aov;
} measure;

static void write_ids(const iso_gbuffer *g, const sums *s, iso_aov *aov, size_t pixel) {
    aov->ids[ISO_ID_SURFACE][pixel] = s->covered ? g->surface[s->nearest] + 1u : 0;
    aov->ids[ISO_ID_ELEMENT][pixel] = s->covered && g->element ? g->element[s->nearest] : 0;
    aov->ids[ISO_ID_SEGMENT][pixel] = 0;
}

static void measure_row(void *context, size_t row, int worker) {
    (void)worker;
    const measure *m = context;
    iso_aov *aov = m->aov;
    size_t pixel = ((size_t)m->strip->y0 + row) * (size_t)aov->width;
    for (int x = 0; x < aov->width; x++, pixel++) {
        sums s = sums_of(m->strip, x, (int)row);
        iso_vec3 n = world_normal(m->strip->view, s.normal);
        aov->depth[pixel] = s.covered ? (float)(s.depth / s.covered) : INFINITY;
        aov->normal[0][pixel] = (float)n.x;
        aov->normal[1][pixel] = (float)n.y;
        aov->normal[2][pixel] = (float)n.z;
        aov->coverage[pixel] = (float)s.covered / (float)(m->strip->factor * m->strip->factor);
        if (aov->ids[0]) write_ids(m->strip->gbuffer, &s, aov, pixel);
    }
}

void iso_strip_measure(const iso_strip *strip, iso_aov *aov, iso_pool *pool) {
    assert(aov->width * strip->factor == strip->gbuffer->width);
    measure m = {strip, aov};
    iso_parallel_for(pool, (size_t)(strip->gbuffer->height / strip->factor), measure_row, &m);
}
