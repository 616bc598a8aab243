/* gaussians: 3-D Gaussians against a plain renderer in double precision, which multiplies whole matrices and
 * visits every Gaussian at every pixel, and against images that are known; opaque surfaces; the same bytes
 * for every instruction set, number of threads and division into strips. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/cpu.h"
#include "base/memory.h"
#include "check_support.h"
#include "render/gaussians/gaussians.h"
#include "render/view/gbuffer.h"
#include "scene_support.h"

static const iso_rgb BACKGROUND = {31, 33, 41}, OPAQUE = {20, 200, 90};

enum { MOST = 400, WIDTH = 120, HEIGHT = 100 };

/* The Gaussians of a test. */
typedef struct splats {
    float positions[MOST][3], axes[MOST][9], opacities[MOST];
    uint8_t colors[MOST][3];
    iso_gaussians view;
} splats;

static void finish(splats *s, size_t count) {
    s->view = (iso_gaussians){.positions = (const float(*)[3])s->positions,
                              .axes = (const float(*)[9])s->axes,
                              .opacities = s->opacities,
                              .colors = (const uint8_t(*)[3])s->colors,
                              .count = count};
}

/* Three perpendicular vectors of these lengths, in a random direction. */
static void set_axes(float axes[9], const double lengths[3], uint32_t *seed) {
    double a[3][3];
    for (int k = 0; k < 2; k++)
        for (int i = 0; i < 3; i++) a[k][i] = uniform(seed) - 0.5;
    double dot = 0, square = 0;
    for (int i = 0; i < 3; i++) square += a[0][i] * a[0][i];
    for (int i = 0; i < 3; i++) dot += a[0][i] * a[1][i];
    for (int i = 0; i < 3; i++) a[1][i] -= a[0][i] * dot / square;
    for (int i = 0; i < 3; i++)
        a[2][i] = a[0][(i + 1) % 3] * a[1][(i + 2) % 3] - a[0][(i + 2) % 3] * a[1][(i + 1) % 3];
    for (int k = 0; k < 3; k++) {
        const double length = sqrt(a[k][0] * a[k][0] + a[k][1] * a[k][1] + a[k][2] * a[k][2]);
        for (int i = 0; i < 3; i++) axes[3 * k + i] = (float)(a[k][i] / length * lengths[k]);
    }
}

/* A box of Gaussians of all shapes about `depth`. */
static void make_random(splats *s, double depth, double size, uint32_t seed) {
    for (int i = 0; i < MOST; i++) {
        double lengths[3];
        for (int k = 0; k < 3; k++) {
            s->positions[i][k] = (float)((uniform(&seed) - 0.5) * 12 + (k == 2 ? depth : 0));
            lengths[k] = size * pow(10, -1.5 * uniform(&seed));
            s->colors[i][k] = (uint8_t)(255 * uniform(&seed));
        }
        set_axes(s->axes[i], lengths, &seed);
        s->opacities[i] = (float)uniform(&seed);
    }
    finish(s, MOST);
}

/* ---- drawing */

static iso_layer_totals draw_rows(const splats *s, const iso_view *view, int y0, int factor,
                                  const float *opaque, iso_pool *pool, iso_image *image) {
    iso_error error = {0};
    iso_gbuffer g = test_clear_gbuffer(view->width, view->height, false), seen = g;
    const iso_rgb colors[2] = {OPAQUE, OPAQUE};
    const iso_shading shading = {.colors = colors, .color_count = 2, .background = BACKGROUND};
    if (!opaque) seen.depth = NULL;
    for (size_t i = 0; opaque && i < (size_t)view->width * (size_t)view->height; i++) {
        g.depth[i] = opaque[i];
        g.surface[i] = opaque[i] < INFINITY ? 1 : ISO_SURFACE_NONE;
        g.normal[2][i] = -1;
    }
    const iso_strip strip = {view, &seen, factor, y0};
    const iso_layer_picture picture = {.strip = &strip, .shading = &shading, .image = image, .pool = pool};
    iso_layer_totals totals = {0};
    test_ok(iso_shade_gaussians(&s->view, &picture, &totals, &error), &error);
    iso_gbuffer_free(&g);
    return totals;
}

static iso_image drawn(const splats *s, const iso_view *view) {
    iso_image image;
    assert_int_equal(iso_image_create(view->width, view->height, &image, NULL), ISO_OK);
    draw_rows(s, view, 0, 1, NULL, NULL, &image);
    return image;
}

/* ---- the reference */

typedef struct reference {
    double depth, x, y, inverse[3]; /* of the covariance: xx, xy, yy */
    int index;
} reference;

static int by_depth(const void *left, const void *right) {
    const reference *a = left, *b = right;
    if ((float)a->depth != (float)b->depth) return (float)a->depth < (float)b->depth ? -1 : 1;
    return a->index - b->index;
}

static double limit(double value, double low, double high) {
    return value < low ? low : value > high ? high : value;
}

/* Projects a Gaussian by products of whole matrices; the view's axes are the world's. */
static bool refer(const splats *s, int i, const iso_view *view, reference *r) {
    const double f = view->focal, x = (double)s->positions[i][0], y = (double)s->positions[i][1],
                 z = (double)s->positions[i][2];
    if (z < (view->orthographic ? view->near : 200 * view->near)) return false;
    double u = x / z, v = y / z, j[2][3] = {{f, 0, 0}, {0, f, 0}}, cov[3][3] = {{0}}, out[2][2] = {{0}};
    const double wide = view->width * 0.15, high = view->height * 0.15;
    u = limit(u, (-wide - view->cx) / f, (view->width + wide - view->cx) / f);
    v = limit(v, (-high - view->cy) / f, (view->height + high - view->cy) / f);
    if (!view->orthographic) {
        j[0][0] = j[1][1] = f / z;
        j[0][2] = -f / z * u;
        j[1][2] = -f / z * v;
    }
    for (int a = 0; a < 3; a++)
        for (int b = 0; b < 3; b++)
            for (int k = 0; k < 3; k++)
                cov[a][b] += (double)s->axes[i][3 * k + a] * (double)s->axes[i][3 * k + b];
    for (int p = 0; p < 2; p++)
        for (int q = 0; q < 2; q++)
            for (int a = 0; a < 3; a++)
                for (int b = 0; b < 3; b++) out[p][q] += j[p][a] * cov[a][b] * j[q][b];
    out[0][0] += 0.3;
    out[1][1] += 0.3;
    const double det = out[0][0] * out[1][1] - out[0][1] * out[1][0];
    r->inverse[0] = out[1][1] / det;
    r->inverse[1] = -out[0][1] / det;
    r->inverse[2] = out[0][0] / det;
    r->depth = z;
    r->x = view->cx + (view->orthographic ? f * x : f * x / z);
    r->y = view->cy + (view->orthographic ? f * y : f * y / z);
    r->index = i;
    return true;
}

static void refer_pixel(const splats *s, const reference *list, int count, int x, int y, double rgb[3]) {
    double through = 1;
    for (int k = 0; k < 3; k++) rgb[k] = 0;
    for (int i = 0; i < count && through >= 1.0 / 512; i++) {
        const double dx = x + 0.5 - list[i].x, dy = y + 0.5 - list[i].y, *m = list[i].inverse;
        const double q = m[0] * dx * dx + 2 * m[1] * dx * dy + m[2] * dy * dy,
                     alpha = (double)s->opacities[list[i].index] * exp(-q / 2);
        if (alpha < 1.0 / 255) continue;
        for (int k = 0; k < 3; k++) rgb[k] += through * alpha * s->colors[list[i].index][k];
        through *= 1 - alpha;
    }
    rgb[0] += through * BACKGROUND.r;
    rgb[1] += through * BACKGROUND.g;
    rgb[2] += through * BACKGROUND.b;
}

static void check_picture(const splats *s, const iso_view *view) {
    static reference list[MOST];
    int count = 0;
    iso_image image = drawn(s, view);
    size_t different = 0, seen = 0;
    for (int i = 0; i < (int)s->view.count; i++) count += refer(s, i, view, &list[count]);
    qsort(list, (size_t)count, sizeof *list, by_depth);
    for (int y = 0; y < view->height; y++)
        for (int x = 0; x < view->width; x++) {
            double rgb[3], most = 0;
            const uint8_t *pixel = image.rgba + 4 * ((size_t)y * (size_t)view->width + (size_t)x);
            refer_pixel(s, list, count, x, y, rgb);
            for (int k = 0; k < 3; k++) most = fmax(most, fabs(rgb[k] - pixel[k]));
            /* a contribution at the least opacity that counts may fall on either side of it */
            if (most > 2) fail_msg("pixel %d %d: %g levels from the reference", x, y, most);
            different += most > 0.51;
            seen += fabs(rgb[0] - BACKGROUND.r) > 2;
        }
    assert_true(seen > 1000);
    if (different > seen / 500) fail_msg("%zu of %zu pixels differ", different, seen);
    iso_image_free(&image);
}

static void test_reference(void **state) {
    (void)state;
    static splats s;
    for (uint32_t k = 0; k < 6; k++) {
        const bool orthographic = k % 3 == 2;
        make_random(&s, k % 3 == 1 ? 4 : 25, k < 3 ? 1 : 0.2, 7 + k);
        iso_view view = test_plain_view(WIDTH, HEIGHT, orthographic, orthographic ? 9 : 190);
        if (!orthographic) view.near = 0.01;
        check_picture(&s, &view);
    }
}

/* ---- images that are known */

/* Spheres are round, as wide as their standard deviation and the low-pass say, and hide each other in their
 * order, whatever it is in the file. */
static void test_spheres(void **state) {
    (void)state;
    static splats s;
    const double sigma[2] = {0.6, 0.02}, depth[2] = {24, 12}, opacity[2] = {0.7, 0.5};
    for (int i = 0; i < 2; i++) {
        const double lengths[3] = {sigma[i], sigma[i], sigma[i]};
        uint32_t seed = 3;
        set_axes(s.axes[i], lengths, &seed);
        s.positions[i][2] = (float)depth[i];
        s.opacities[i] = (float)opacity[i];
        memcpy(s.colors[i], i ? (const uint8_t[3]){0, 90, 250} : (const uint8_t[3]){250, 90, 0}, 3);
    }
    finish(&s, 2);
    for (int k = 0; k < 2; k++) {
        const bool orthographic = k == 1;
        iso_view view = test_plain_view(WIDTH, HEIGHT, orthographic, orthographic ? 10 : 200);
        view.near = orthographic ? view.near : 0.01;
        iso_image image = drawn(&s, &view);
        for (int y = 0; y < HEIGHT; y++)
            for (int x = 0; x < WIDTH; x++) {
                const double dx = x + 0.5 - view.cx, dy = y + 0.5 - view.cy, square = dx * dx + dy * dy;
                double alpha[2], rgb[3];
                for (int i = 0; i < 2; i++) {
                    const double scale = orthographic ? 10 : 200 / depth[i],
                                 variance = scale * scale * sigma[i] * sigma[i] + 0.3;
                    alpha[i] = opacity[i] * exp(-square / variance / 2);
                    if (alpha[i] < 1.0 / 255) alpha[i] = 0;
                }
                const uint8_t back[3] = {BACKGROUND.r, BACKGROUND.g, BACKGROUND.b};
                for (int c = 0; c < 3; c++) {
                    rgb[c] = alpha[1] * s.colors[1][c] +
                             (1 - alpha[1]) * (alpha[0] * s.colors[0][c] + (1 - alpha[0]) * back[c]);
                    const int got = image.rgba[4 * (y * WIDTH + x) + c];
                    if (fabs(got - rgb[c]) > 0.51) fail_msg("%d %d: %d, not %g", x, y, got, rgb[c]);
                }
            }
        iso_image_free(&image);
    }
}

/* Those behind the eye, with no opacity, or with sizes that are no numbers, are left out. */
static void test_left_out(void **state) {
    (void)state;
    static splats s;
    make_random(&s, 20, 1, 5);
    for (int i = 0; i < MOST; i++) {
        if (i % 4 == 0) s.positions[i][2] = -20;
        if (i % 4 == 1) s.opacities[i] = i % 8 == 1 ? 0 : (float)NAN;
        if (i % 4 == 2) s.axes[i][4] = (float)(i % 8 == 2 ? NAN : INFINITY);
        if (i % 4 == 3) s.positions[i][0] = 1e30f;
    }
    iso_view view = test_plain_view(WIDTH, HEIGHT, false, 190);
    view.near = 0.01;
    iso_image image;
    assert_int_equal(iso_image_create(WIDTH, HEIGHT, &image, NULL), ISO_OK);
    const iso_layer_totals totals = draw_rows(&s, &view, 0, 1, NULL, NULL, &image);
    assert_int_equal(totals.layers, 0);
    assert_int_equal(totals.covered, 0);
    for (int i = 0; i < WIDTH * HEIGHT; i++) assert_int_equal(image.rgba[4 * i], BACKGROUND.r);
    iso_image_free(&image);
}

/* An opaque surface hides what lies behind it and is seen through what lies before it. */
static void test_opaque(void **state) {
    (void)state;
    static splats s;
    static float depth[WIDTH * HEIGHT];
    make_random(&s, 25, 1, 5);
    iso_view view = test_plain_view(WIDTH, HEIGHT, false, 190);
    view.near = 0.01;
    iso_image image;
    assert_int_equal(iso_image_create(WIDTH, HEIGHT, &image, NULL), ISO_OK);
    const iso_layer_totals all = draw_rows(&s, &view, 0, 1, NULL, NULL, &image);
    const float depths[3] = {1, 25, 1e6f};
    size_t before = 0;
    for (int k = 0; k < 3; k++) {
        for (int i = 0; i < WIDTH * HEIGHT; i++) depth[i] = depths[k];
        const iso_layer_totals totals = draw_rows(&s, &view, 0, 1, depth, NULL, &image);
        assert_int_equal(totals.covered, WIDTH * HEIGHT);
        if (k == 0) assert_int_equal(totals.layers, 0);
        if (k == 2) assert_int_equal(totals.layers, all.layers);
        assert_true(k == 0 || totals.layers > before);
        before = totals.layers;
    }
    iso_image_free(&image);
}

/* ---- the same bytes */

static void test_variants(void **state) {
    (void)state;
    static splats s;
    make_random(&s, 12, 1, 31);
    iso_view view = test_plain_view(WIDTH, HEIGHT, false, 190);
    view.near = 0.01;
    view = iso_view_scaled(&view, 3);
    const size_t bytes = 4 * WIDTH * HEIGHT;
    iso_image wanted, got;
    assert_int_equal(iso_image_create(WIDTH, HEIGHT, &wanted, NULL), ISO_OK);
    assert_int_equal(iso_image_create(WIDTH, HEIGHT, &got, NULL), ISO_OK);
    draw_rows(&s, &view, 0, 3, NULL, NULL, &wanted);
    for (iso_cpu_level level = ISO_CPU_GENERIC; level <= ISO_CPU_AVX512; level++) {
        iso_cpu_limit(level);
        draw_rows(&s, &view, 0, 3, NULL, NULL, &got);
        assert_memory_equal(got.rgba, wanted.rgba, bytes);
    }
    for (int threads = 2; threads < 4; threads++) {
        iso_pool *pool;
        assert_int_equal(iso_pool_create(threads, &pool, NULL), ISO_OK);
        draw_rows(&s, &view, 0, 3, NULL, pool, &got);
        assert_memory_equal(got.rgba, wanted.rgba, bytes);
        iso_pool_destroy(pool);
    }
    memset(got.rgba, 0, bytes);
    for (int y = 0; y < HEIGHT; y += 23) {
        const int rows = HEIGHT - y < 23 ? HEIGHT - y : 23;
        const iso_view part = iso_view_rows(&view, 3 * y, 3 * rows);
        draw_rows(&s, &part, y, 3, NULL, NULL, &got);
    }
    assert_memory_equal(got.rgba, wanted.rgba, bytes);
    iso_image_free(&wanted);
    iso_image_free(&got);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_reference), cmocka_unit_test(test_spheres),  cmocka_unit_test(test_left_out),
        cmocka_unit_test(test_opaque),    cmocka_unit_test(test_variants),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
