/* Tubes against rays in extended precision: chains of rounded cones of all sizes in the picture, seen from
 * all sides and from inside; least widths and flat caps; and the same bytes for every instruction set, number
 * of threads and strip. */
#include <stdlib.h>
#include <string.h>

#include "check_support.h"
#include "lines_support.h"
#include "scene_support.h"
#include "shapes_support.h"

static test_lines scene;

static void start(double x, double y, double z) {
    test_lines_start(&scene, x, y, z);
}

static void add(double x, double y, double z, double radius) {
    test_lines_add(&scene, x, y, z, radius);
}

static void end_line(void) {
    test_lines_end(&scene);
}

static void add_walk(int count, double half, double step, double low, double high, uint32_t *seed) {
    test_lines_add_walk(&scene, count, half, step, low, high, seed);
}

static void compare_with(const iso_shapes_opts *opts, iso_vec3 away, double height, const char *name) {
    const iso_shapes_scene judged = {NULL, &scene.lines, *opts};
    test_shapes_compare_views(&judged, away, height, name);
}

static void compare_views(iso_vec3 away, double height, const char *name) {
    const iso_shapes_opts opts = {.radius = 0.2};
    compare_with(&opts, away, height, name);
}

static const iso_vec3 AWAY = {60, 35, -80};

static void test_tubes(void **state) {
    (void)state;
    uint32_t seed = 1;
    start(0, 0, 0);
    for (int i = 0; i < 25; i++) add_walk(20, 8, 1.5, 0.1, 0.5, &seed);
    compare_views(AWAY, 24, "tapered tubes");
    scene.lines.radii = NULL;
    compare_views(AWAY, 24, "even tubes");
    start(0, 0, 0); /* smooth and thick */
    for (int i = 0; i <= 120; i++) {
        double sine, cosine;
        iso_sincos(i * 0.2, &sine, &cosine);
        add(6 * cosine, i * 0.1 - 6, 6 * sine, 1.2 + 0.9 * sine * cosine);
    }
    end_line();
    compare_views(AWAY, 24, "helix");
    compare_views(iso_vec3_make(0.1, 60, -0.3), 24, "helix from above");
}

/* Vertices in one place, spheres within spheres, and radii that differ as much as the vertices' distance. */
static void test_degenerate(void **state) {
    (void)state;
    uint32_t seed = 2;
    start(0, 0, 0);
    for (int i = 0; i < 60; i++) {
        double p[3];
        for (int a = 0; a < 3; a++) p[a] = 8 * (2 * uniform(&seed) - 1);
        const double radius = 0.2 + uniform(&seed), other = uniform(&seed), length = 0.8;
        add(p[0], p[1], p[2], radius);
        if (i % 4 == 0) add(p[0], p[1], p[2], other);                             /* in one place */
        if (i % 4 == 1) add(p[0] + 0.5 * length, p[1], p[2], radius + length);    /* held by the second */
        if (i % 4 == 2) add(p[0], p[1] + length, p[2], radius + length);          /* touched from inside */
        if (i % 4 == 3) add(p[0], p[1], p[2] + length, radius + 0.9999 * length); /* nearly */
        add(p[0], p[1], p[2] - 0.5 * length, 0);                                  /* a point */
        end_line();
    }
    add(0, 0, 0, 1);
    end_line(); /* no segment */
    compare_views(AWAY, 24, "degenerate tubes");
}

/* Tubes that point at the eye, exactly and nearly. */
static void test_end_on(void **state) {
    (void)state;
    uint32_t seed = 3;
    const double length = iso_vec3_length(AWAY);
    for (int tapered = 0; tapered < 2; tapered++) {
        start(0, 0, 0);
        for (int i = 0; i < 60; i++) {
            double p[3], q[3];
            const double tilt = i < 10   ? 0
                                : i < 30 ? 1e-4
                                : i < 45 ? 1e-2
                                         : 0.1,
                         reach = 1 + 20 * uniform(&seed);
            const double away[3] = {AWAY.x, AWAY.y, AWAY.z};
            for (int a = 0; a < 3; a++) {
                p[a] = 8 * (2 * uniform(&seed) - 1);
                q[a] = p[a] + reach * ((away[a] - p[a]) / length + tilt * (2 * uniform(&seed) - 1));
            }
            const double radius = 0.1 + 0.8 * uniform(&seed);
            add(p[0], p[1], p[2], radius);
            add(q[0], q[1], q[2], tapered ? 0.1 + 0.8 * uniform(&seed) : radius);
            end_line();
        }
        compare_views(AWAY, 24, tapered ? "tapered tubes, end on" : "tubes, end on");
    }
}

static void test_far_and_near(void **state) {
    (void)state;
    uint32_t seed = 4;
    start(0, 0, 0);
    for (int i = 0; i < 6; i++) add_walk(12, 6, 3, 0.4, 1.2, &seed);
    compare_views(iso_vec3_make(4e4, 5e4, -6e4), 24, "distant tubes");
    compare_views(iso_vec3_make(0.5, 0.2, -0.3), 1.5, "tubes, eye inside");
    compare_views(iso_vec3_make(4, -3, 5), 12, "tubes, eye among them");
    const iso_shapes_scene judged = {NULL, &scene.lines, {.caps = ISO_CAPS_FLAT}};
    for (int parallel = 0; parallel < 2; parallel++) {
        iso_view view = test_shapes_view(scene.lines.origin, iso_vec3_make(0, 3, -20), 20, parallel);
        view.near = 17;
        test_shapes_compare(&judged, &view, parallel ? "cut tubes, parallel" : "cut tubes, perspective");
    }
    start(1e7, -2e7, 3e7);
    for (int i = 0; i < 15; i++) add_walk(20, 8, 2, 0.1, 0.6, &seed);
    compare_views(AWAY, 24, "tubes at 1e7 mm");
}

static void test_caps(void **state) {
    (void)state;
    uint32_t seed = 5;
    const iso_shapes_opts flat = {.radius = 0.8, .caps = ISO_CAPS_FLAT};
    start(0, 0, 0);
    for (int i = 0; i < 40; i++) add_walk(1 + i % 3, 8, 6, 0.2, 1.4, &seed);
    compare_with(&flat, AWAY, 24, "flat caps");
    scene.lines.radii = NULL;
    compare_with(&flat, AWAY, 24, "flat caps of even tubes");
}

/* Lines that are narrower than a pixel, wholly or partly. */
static void test_widths(void **state) {
    (void)state;
    uint32_t seed = 6;
    const iso_shapes_opts one = {.min_pixels = 1}, three = {.min_pixels = 3, .radius = 1e-3};
    start(0, 0, 0);
    for (int i = 0; i < 20; i++) add_walk(20, 8, 2, 0, 0.3, &seed);
    compare_with(&one, AWAY, 24, "a pixel wide");
    compare_with(&one, iso_vec3_make(4, -3, 5), 12, "a pixel wide, eye among them");
    scene.lines.radii = NULL;
    compare_with(&three, AWAY, 24, "three pixels wide");

    const iso_shapes_scene drawn = {NULL, &scene.lines, three}, thick = {NULL, &scene.lines, {.radius = 3}};
    for (int i = 0; i < 2; i++) { /* widened samples are counted */
        iso_shapes *shapes = test_shapes_make(i ? &thick : &drawn);
        const iso_view view = test_shapes_view(scene.lines.origin, AWAY, 24, false);
        iso_gbuffer g = test_clear_gbuffer(view.width, view.height, false);
        const iso_target target = {&view, &g, NULL, 3, NULL};
        iso_shapes_drawn count = {0};
        size_t seen = 0;
        assert_int_equal(iso_draw_shapes(&target, shapes, &count, NULL), ISO_OK);
        for (int k = 0; k < view.width * view.height; k++) seen += g.surface[k] == 3;
        assert_int_equal(count.samples, seen);
        assert_int_equal(count.widened, i ? 0 : seen);
        iso_gbuffer_free(&g);
        iso_shapes_destroy(shapes);
    }
}

static void test_same_bytes(void **state) {
    (void)state;
    uint32_t seed = 7;
    start(0, 0, 0);
    for (int i = 0; i < 80; i++) add_walk(1 + i % 30, 8, 1.5, 0, 0.7, &seed);
    for (int i = 0; i < 4; i++) add_walk(3, 8, 4, 1, 2, &seed);
    const iso_shapes_scene drawn = {NULL, &scene.lines, {.min_pixels = 2, .caps = ISO_CAPS_FLAT}};
    iso_shapes *shapes = test_shapes_make(&drawn);
    for (int parallel = 0; parallel < 2; parallel++)
        for (int close = 0; close < 2; close++) {
            const iso_vec3 away = close ? iso_vec3_make(1, 2, -4) : AWAY;
            iso_view view = test_shapes_view(scene.lines.origin, away, close ? 5 : 24, parallel);
            view = iso_view_scaled(&view, 4);
            test_shapes_variants(shapes, &view);
        }
    iso_shapes_destroy(shapes);
}

/* Colours are interpolated along segments. */
static void test_colors(void **state) {
    (void)state;
    const uint8_t colors[2][3] = {{10, 200, 30}, {210, 0, 30}};
    start(0, 0, 0);
    add(-5, 0, 0, 1);
    add(5, 0, 0, 1);
    end_line();
    memcpy(scene.colors, colors, sizeof colors);
    scene.lines.colors = scene.colors;
    const iso_shapes_scene drawn = {NULL, &scene.lines, {.radius = 0}};
    iso_shapes *shapes = test_shapes_make(&drawn);
    const iso_camera camera = {
        .position = {0, 0, -10}, .view_up = {0, 1, 0}, .parallel_scale = 6, .orthographic = 1};
    const iso_view view = iso_view_make(&camera, 120, 120); /* 10 pixels a mm; x runs to the left */
    iso_gbuffer g = test_clear_gbuffer(120, 120, true);
    const iso_target target = {&view, &g, NULL, 3, NULL};
    assert_int_equal(iso_draw_shapes(&target, shapes, NULL, NULL), ISO_OK);
    for (int x = 0; x < 120; x++) {
        const double along = (view.rotation[0] < 0 ? 59.5 - x : x - 59.5) / 100 + 0.5, t = along < 0 ? 0
                                                                                           : along > 1
                                                                                               ? 1
                                                                                               : along;
        const uint32_t word = g.color[60 * 120 + x];
        if (g.surface[60 * 120 + x] != 3) continue;
        for (int k = 0; k < 3; k++)
            near(word >> 8 * k & 255, colors[0][k] + t * (colors[1][k] - colors[0][k]), 0.51);
        assert_int_equal(word >> 24, 4);
    }
    iso_gbuffer_free(&g);
    iso_shapes_destroy(shapes);
}

/* Along a tapered tube, colours run from one vertex to the other without a jump where the cone ends and a
 * vertex's sphere begins. */
static void test_colors_of_cones(void **state) {
    (void)state;
    start(0, 0, 0);
    add(-4, 0, 0, 0.5);
    add(4, 0, 0, 3);
    end_line();
    memset(scene.colors[0], 0, sizeof scene.colors[0]);
    memset(scene.colors[1], 200, sizeof scene.colors[1]);
    scene.lines.colors = scene.colors;
    const iso_shapes_scene drawn = {NULL, &scene.lines, {.radius = 0}};
    iso_shapes *shapes = test_shapes_make(&drawn);
    const iso_camera camera = {
        .position = {0, 0, -10}, .view_up = {0, 1, 0}, .parallel_scale = 8, .orthographic = 1};
    const iso_view view = iso_view_make(&camera, 160, 160);
    iso_gbuffer g = test_clear_gbuffer(160, 160, true);
    const iso_target target = {&view, &g, NULL, 3, NULL};
    assert_int_equal(iso_draw_shapes(&target, shapes, NULL, NULL), ISO_OK);
    int pairs = 0, least = 255, most = 0;
    for (size_t i = 80 * 160; i < 81 * 160 - 1; i++) {
        const int here = (int)(g.color[i] & 255), next = (int)(g.color[i + 1] & 255);
        if (g.surface[i] != 3 || g.surface[i + 1] != 3) continue;
        assert_true(abs(next - here) <= 5);
        least = here < least ? here : least;
        most = here > most ? here : most;
        pairs++;
    }
    assert_true(pairs > 100 && least == 0 && most == 200);
    iso_gbuffer_free(&g);
    iso_shapes_destroy(shapes);
}

static void test_bad_lines(void **state) {
    (void)state;
    const float bad[] = {NAN, INFINITY, -1};
    iso_error error = {0};
    start(0, 0, 0);
    for (int i = 0; i < 3; i++) { /* two of four segments are left out */
        for (int k = 0; k < 5; k++) add(k, i, 0, 0.3);
        end_line();
        scene.radii[5 * i + 2] = bad[i];
    }
    for (int k = 0; k < 3; k++) add(k, 5, 0, k < 2 ? 0 : 0.1); /* one of two */
    end_line();
    const iso_shapes_scene drawn = {NULL, &scene.lines, {.radius = 1}};
    iso_shapes *shapes = test_shapes_make(&drawn);
    assert_int_equal(iso_shapes_stats(shapes).shapes, 7);
    assert_int_equal(iso_shapes_stats(shapes).skipped, 7);
    const iso_view view = test_shapes_view(scene.lines.origin, AWAY, 24, false);
    iso_gbuffer g = test_shapes_drawn(&view, shapes, NULL);
    iso_gbuffer_free(&g);
    iso_shapes_destroy(shapes);
    scene.lines.radii = NULL;
    const iso_shapes_opts none = {.radius = 0}, negative = {.radius = 1, .min_pixels = -1};
    assert_int_equal(iso_shapes_from_lines(&scene.lines, &none, &shapes, &error), ISO_ERR_USAGE);
    assert_int_equal(iso_shapes_from_lines(&scene.lines, &negative, &shapes, &error), ISO_ERR_USAGE);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_tubes),      cmocka_unit_test(test_degenerate),
        cmocka_unit_test(test_end_on),     cmocka_unit_test(test_far_and_near),
        cmocka_unit_test(test_caps),       cmocka_unit_test(test_widths),
        cmocka_unit_test(test_same_bytes), cmocka_unit_test(test_colors),
        cmocka_unit_test(test_bad_lines),  cmocka_unit_test(test_colors_of_cones),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
