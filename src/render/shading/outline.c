/* outline: compares each sample with those on two rings around it. */
#include "render/shading/outline.h"

#include <assert.h>
#include <math.h>

#include "image/annotate.h"
#include "render/view/project.h"
#include "render/view/strip.h"

/* A silhouette is a step of at least this part of the picture's height from the surface to what is behind it;
 * a crease is where normals across a line enclose more than 60 degrees. */
static const float STEP = 0.012f, CREASE = 0.5f;

enum { RINGS = 2, SPOKES = 8 };

/* What the rows have in common. */
typedef struct rows {
    const iso_view *view;
    const iso_gbuffer *gbuffer;
    int first, count, bands;
    int at[RINGS][SPOKES][2]; /* samples from the middle of the rings */
    float step;               /* STEP, mm: in perspective at depth 1 */
} rows;

iso_rgb iso_outline_color(iso_rgb background, bool transparent) {
    const iso_rgb dark = {0x18, 0x18, 0x18}, light = {0xF4, 0xF4, 0xF4};
    return iso_is_dark(background, transparent) ? light : dark;
}

int iso_outline_reach(double width) {
    return (int)ceil(width) + 1;
}

/* The ring with a radius in samples. */
static void make_ring(double radius, int ring[SPOKES][2]) {
    static const double spokes[SPOKES][2] = {{1, 0},  {0.7071, 0.7071},   {0, 1},  {-0.7071, 0.7071},
                                             {-1, 0}, {-0.7071, -0.7071}, {0, -1}, {0.7071, -0.7071}};
    for (int i = 0; i < SPOKES; i++)
        for (int k = 0; k < 2; k++) {
            const double at = spokes[i][k] * radius;
            ring[i][k] = (int)floor(at + 0.5);
        }
}

static bool is_inside(const iso_gbuffer *g, int x, int y) {
    return x >= 0 && x < g->width && y >= 0 && y < g->height;
}

static float cosine(const iso_gbuffer *g, size_t a, size_t b) {
    return g->normal[0][a] * g->normal[0][b] + g->normal[1][a] * g->normal[1][b] +
           g->normal[2][a] * g->normal[2][b];
}

/* Slices and caps that show a volume are not lit, and have normals of 0: one is as flat as a picture. */
static bool is_unlit(const iso_gbuffer *g, size_t a) {
    return g->normal[0][a] == 0 && g->normal[1][a] == 0 && g->normal[2][a] == 0;
}

static bool is_crease(const iso_gbuffer *g, size_t a, size_t b) {
    if (g->surface[a] != g->surface[b] || is_unlit(g, a) != is_unlit(g, b)) return true;
    return !is_unlit(g, a) && cosine(g, a, b) < CREASE;
}

/* Whether a line passes between the sample and the spoke's end. `crease`: creases are looked for, too. */
static bool is_line(const rows *r, int x, int y, const int spoke[2], bool crease) {
    const iso_gbuffer *g = r->gbuffer;
    const int ends[2][2] = {{x + spoke[0], y + spoke[1]}, {x - spoke[0], y - spoke[1]}};
    if (!is_inside(g, ends[0][0], ends[0][1])) return false;
    const size_t own = (size_t)y * (size_t)g->width + (size_t)x,
                 there = (size_t)ends[0][1] * (size_t)g->width + (size_t)ends[0][0];
    if (g->surface[there] == ISO_SURFACE_NONE) return true;
    const float z = g->depth[own], step = r->view->orthographic ? r->step : r->step * z,
                down = g->depth[there] - z;
    float before = 0; /* the slope towards the sample, so that slanted surfaces have no steps */
    if (is_inside(g, ends[1][0], ends[1][1])) {
        const size_t other = (size_t)ends[1][1] * (size_t)g->width + (size_t)ends[1][0];
        before = g->surface[other] == ISO_SURFACE_NONE ? 0 : z - g->depth[other];
    }
    if (down > step && down - before > step) return true;
    if (down < -step || !crease) return false; /* the line lies on the nearer side */
    return is_crease(g, own, there);
}

static void draw_band(void *context, size_t number, int worker) {
    (void)worker;
    const rows *r = context;
    const iso_gbuffer *g = r->gbuffer;
    const iso_rows band = iso_band_rows(r->count, r->bands, number);
    for (int y = r->first + band.first; y <= r->first + band.last; y++)
        for (int x = 0; x < g->width; x++) {
            const size_t sample = (size_t)y * (size_t)g->width + (size_t)x;
            bool ink = false;
            for (int ring = 0; ring < RINGS && !ink && g->surface[sample] != ISO_SURFACE_NONE; ring++)
                for (int i = 0; i < SPOKES && !ink; i++) ink = is_line(r, x, y, r->at[ring][i], ring == 0);
            g->ink[sample] = ink ? 1 : 0;
        }
}

void iso_outline_draw(const iso_view *view, int factor, double width, int first, int last,
                      const iso_gbuffer *gbuffer, iso_pool *pool) {
    assert(gbuffer->ink && factor >= 1 && factor <= ISO_FACTOR_MAX);
    const int count = last - first + 1, bands = iso_band_count(pool, count);
    rows r = {.view = view, .gbuffer = gbuffer, .first = first, .count = count, .bands = bands};
    make_ring(fmax(width * factor / 2, 1), r.at[0]);
    make_ring(fmax(width * factor, 1), r.at[1]);
    r.step = (float)(STEP * (view->height + view->above + view->below) / view->focal);
    iso_parallel_for(pool, (size_t)bands, draw_band, &r);
}
