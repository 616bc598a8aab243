/* Eye-dome lighting: against a plain computation in double precision, on surfaces whose light is known, in
 * strips of a picture, and with every instruction set and number of threads. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/cpu.h"
#include "check_support.h"
#include "render/picture.h"
#include "render/shading/eye_dome.h"
#include "scene_support.h"

enum { WIDTH = 531, HEIGHT = 40 };

static iso_gbuffer make_gbuffer(int width, int height) {
    iso_gbuffer g = test_clear_gbuffer(width, height, false);
    assert_int_equal(iso_gbuffer_add_plane(&g, &g.light, NULL), ISO_OK);
    return g;
}

/* Heaps of depths, with holes. */
static iso_gbuffer make_heaps(uint32_t seed) {
    iso_gbuffer g = make_gbuffer(WIDTH, HEIGHT);
    for (int i = 0; i < WIDTH * HEIGHT; i++)
        if (uniform(&seed) > 0.2) g.depth[i] = (float)(20 + 0.3 * uniform(&seed) + (i / 7 % 5 == 0 ? 4 : 0));
    return g;
}

static double plain_light(const iso_gbuffer *g, const iso_view *view, int factor, int x, int y) {
    double sum = 0;
    const double z = (double)g->depth[y * g->width + x],
                 pixels = view->focal / factor / (view->orthographic ? 1 : z);
    for (int ring = 1; ring <= 4; ring *= 2)
        for (int dy = -1; dy <= 1; dy++)
            for (int dx = -1; dx <= 1; dx++) {
                const int nx = x + dx * ring * factor, ny = y + dy * ring * factor;
                if ((!dx && !dy) || nx < 0 || ny < 0 || nx >= g->width || ny >= g->height) continue;
                const double d = z - (double)g->depth[ny * g->width + nx],
                             s = d > 0 ? d * pixels / ring / (dx && dy ? sqrt(2) : 1) : 0;
                sum += s / (1 + s);
            }
    return pow(2, -3.5 * sum / 24);
}

static void test_plain(void **state) {
    (void)state;
    for (int factor = 1; factor <= 8; factor += 2)
        for (int orthographic = 0; orthographic < 2; orthographic++) {
            iso_gbuffer g = make_heaps(4 + (uint32_t)factor);
            const iso_view view = test_plain_view(WIDTH, HEIGHT, orthographic, orthographic ? 12 : 300);
            iso_eye_dome_light(&view, factor, 0, HEIGHT - 1, &g, NULL);
            int seen = 0;
            for (int i = 0; i < WIDTH * HEIGHT; i++) {
                if (!(g.depth[i] < INFINITY)) continue;
                const double wanted = plain_light(&g, &view, factor, i % WIDTH, i / WIDTH);
                if (fabs((double)g.light[i] - wanted) > 2e-5)
                    fail_msg("%d: %g, not %g", i, (double)g.light[i], wanted);
                seen += wanted < 0.8;
            }
            assert_true(seen > 1000);
            iso_gbuffer_free(&g);
        }
}

/* A plane across the view is fully lit; so is a plate before it; beside the plate the plane is darker, and
 * the nearer the darker. The same in metres. */
static void test_known(void **state) {
    (void)state;
    for (int k = 0; k < 2; k++) {
        const double unit = k ? 1e-3 : 1;
        iso_gbuffer g = make_gbuffer(WIDTH, HEIGHT);
        iso_view view = test_plain_view(WIDTH, HEIGHT, true, 10 / unit);
        for (int i = 0; i < WIDTH * HEIGHT; i++) g.depth[i] = (float)((i % WIDTH < 100 ? 30 : 50) * unit);
        iso_eye_dome_light(&view, 1, 0, HEIGHT - 1, &g, NULL);
        const float *row = g.light + 20 * WIDTH;
        assert_true(row[99] == 1 && row[50] == 1 && row[104] == 1 && row[0] == 1);
        for (int x = 100; x < 104; x++) assert_true(row[x] <= row[x + 1] && row[x] < 1);
        assert_true(fabs((double)row[100] - pow(2, -3.5 * 9 / 24)) < 0.01);
        iso_gbuffer_free(&g);
    }
}

static void test_variants(void **state) {
    (void)state;
    iso_gbuffer g = make_heaps(9);
    const iso_view view = test_plain_view(WIDTH, HEIGHT, false, 300);
    const size_t bytes = WIDTH * HEIGHT * sizeof(float);
    float *wanted = malloc(bytes);
    iso_eye_dome_light(&view, 2, 0, HEIGHT - 1, &g, NULL);
    memcpy(wanted, g.light, bytes);
    for (iso_cpu_level level = ISO_CPU_GENERIC; level <= ISO_CPU_AVX512; level++) {
        memset(g.light, 0, bytes);
        iso_cpu_limit(level);
        iso_eye_dome_light(&view, 2, 0, HEIGHT - 1, &g, NULL);
        assert_memory_equal(g.light, wanted, bytes);
    }
    iso_pool *pool;
    assert_int_equal(iso_pool_create(3, &pool, NULL), ISO_OK);
    memset(g.light, 0, bytes);
    iso_eye_dome_light(&view, 2, 0, HEIGHT - 1, &g, pool);
    assert_memory_equal(g.light, wanted, bytes);
    iso_pool_destroy(pool);
    free(wanted);
    iso_gbuffer_free(&g);
}

/* ---- pictures */

/* Draws waves whose depth depends on the place in the whole picture only. */
static iso_status draw_waves(void *context, const iso_view *view, iso_gbuffer *g, iso_error *error) {
    (void)error;
    ++*(int *)context;
    for (int y = 0; y < view->height; y++)
        for (int x = 0; x < view->width; x++) {
            const size_t i = (size_t)y * (size_t)view->width + (size_t)x;
            const int phase = (x / 3 + 7 * ((y + view->above) / 5)) % 11;
            g->depth[i] = phase == 10 ? INFINITY : 40 + 0.01f * (float)(phase * phase);
            g->surface[i] = phase == 10 ? ISO_SURFACE_NONE : 0;
            for (int axis = 0; axis < 3; axis++) g->normal[axis][i] = axis == 2 ? -1 : 0;
        }
    return ISO_OK;
}

/* A picture of so many samples that it is drawn in two strips, against the same drawn at once. */
static void test_strips(void **state) {
    (void)state;
    enum { W = 300, H = 830, FACTOR = 8 };
    const iso_rgb color = {200, 150, 90};
    const iso_shading shading = {.colors = &color, .color_count = 1, .background = {10, 20, 30}};
    const iso_view pixels = test_plain_view(W, H, false, 200), view = iso_view_scaled(&pixels, FACTOR);
    iso_image got, wanted;
    size_t covered, all;
    int strips = 0;
    assert_int_equal(iso_image_create(W, H, &got, NULL), ISO_OK);
    assert_int_equal(iso_image_create(W, H, &wanted, NULL), ISO_OK);
    const iso_picture_opts opts = {.view = &pixels,
                                   .width = W,
                                   .height = H,
                                   .samples = FACTOR * FACTOR,
                                   .shading = shading,
                                   .lighting = ISO_LIGHTING_EYE_DOME,
                                   .draw = draw_waves,
                                   .draw_context = &strips};
    assert_int_equal(iso_picture_render(&opts, &got, &covered, NULL), ISO_OK);
    assert_int_equal(strips, 2);
    iso_gbuffer g = make_gbuffer(W * FACTOR, H * FACTOR);
    draw_waves(&strips, &view, &g, NULL);
    iso_eye_dome_light(&view, FACTOR, 0, H * FACTOR - 1, &g, NULL);
    const iso_strip strip = {&view, &g, FACTOR, 0};
    all = iso_shade(&shading, &strip, &wanted, NULL);
    assert_int_equal(covered, all);
    assert_memory_equal(got.rgba, wanted.rgba, 4 * W * H);
    iso_gbuffer_free(&g);
    iso_image_free(&got);
    iso_image_free(&wanted);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_plain),
        cmocka_unit_test(test_known),
        cmocka_unit_test(test_variants),
        cmocka_unit_test(test_strips),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
