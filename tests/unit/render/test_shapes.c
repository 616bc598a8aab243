/* Shapes against rays in extended precision: outlines, depths and normals of glyphs of all sizes in the
 * picture and at all distances; and the same bytes for every instruction set, number of threads and strip. */
#include "base/memory.h"
#include "check_support.h"
#include "render/shapes/set.h"
#include "scene_support.h"
#include "shapes_support.h"

/* ---- glyphs */

enum { MOST = 4000 };

typedef struct cloud {
    iso_glyphs glyphs;
    float positions[MOST][3], radii[MOST];
    uint8_t colors[MOST][3];
} cloud;

static void cloud_start(cloud *c, iso_vec3 origin) {
    c->glyphs = (iso_glyphs){.origin = origin, .positions = c->positions, .radii = c->radii};
}

static void add(cloud *c, double x, double y, double z, double radius) {
    const size_t i = c->glyphs.count++;
    assert_true(i < MOST);
    c->positions[i][0] = (float)x, c->positions[i][1] = (float)y, c->positions[i][2] = (float)z;
    c->radii[i] = (float)radius;
    for (int k = 0; k < 3; k++) c->colors[i][k] = (uint8_t)(37 * i + 91 * (size_t)k);
}

/* Random glyphs in the box +-half, with radii from `low` to `high`. */
static void add_random(cloud *c, int count, double half, double low, double high, uint32_t seed) {
    for (int i = 0; i < count; i++) {
        const double x = uniform(&seed), y = uniform(&seed), z = uniform(&seed);
        add(c, half * (2 * x - 1), half * (2 * y - 1), half * (2 * z - 1),
            low + (high - low) * uniform(&seed));
    }
}

static const iso_shapes_opts SPHERES = {.glyph = ISO_GLYPH_SPHERE};

static cloud scene;

static void compare(const iso_view *view, const char *name) {
    const iso_shapes_scene judged = {&scene.glyphs, NULL, SPHERES};
    test_shapes_compare(&judged, view, name);
}

static void compare_views(iso_vec3 away, double height, const char *name) {
    const iso_shapes_scene judged = {&scene.glyphs, NULL, SPHERES};
    test_shapes_compare_views(&judged, away, height, name);
}

static void test_spheres(void **state) {
    (void)state;
    const iso_vec3 away = iso_vec3_make(60, 35, -80), zero = {0};
    cloud_start(&scene, zero); /* about a pixel to ten */
    add_random(&scene, 1500, 10, 0.1, 1, 1);
    compare_views(away, 24, "small spheres");
    cloud_start(&scene, zero); /* below a pixel */
    add_random(&scene, 3000, 10, 0.01, 0.1, 2);
    compare_views(away, 24, "tiny spheres");
    cloud_start(&scene, zero); /* cut by each other */
    add_random(&scene, 200, 5, 1, 6, 3);
    compare_views(away, 24, "large spheres");
    cloud_start(&scene, zero); /* one, up to 10,000 pixels */
    add(&scene, 0, 0, 0, 10);
    compare_views(away, 22, "one sphere");
    add(&scene, 1, 2, -3, 0.5);
    compare_views(iso_vec3_make(0, 0, -10.4), 0.09, "a sphere seen from close");
    cloud_start(&scene, zero); /* clustered, so that blocks are sorted again */
    for (int i = 0; i < 12; i++) {
        add_random(&scene, 200, 0.004 * (1 << i), 0.0002 * (1 << i), 0.0005 * (1 << i), (uint32_t)(90 + i));
    }
    compare_views(away, 2, "clustered spheres");
    cloud_start(&scene, zero); /* in one place: the first is seen */
    for (int i = 0; i < 600; i++) add(&scene, 1, 1, 1, 2);
    compare_views(away, 8, "spheres in one place");
}

static void test_far_spheres(void **state) {
    (void)state;
    const iso_vec3 zero = {0};
    cloud_start(&scene, zero); /* radius / distance down to 1e-5 */
    add_random(&scene, 300, 10, 0.4, 1.5, 4);
    compare_views(iso_vec3_make(4e4, 5e4, -6e4), 24, "distant spheres");
    cloud_start(&scene, iso_vec3_make(1e7, -2e7, 3e7)); /* far from the world's origin */
    add_random(&scene, 500, 10, 0.1, 1.5, 5);
    compare_views(iso_vec3_make(60, 35, -80), 24, "spheres at 1e7 mm");
    cloud_start(&scene, zero); /* metres, kilometres and micrometres in one picture */
    add(&scene, 0, 0, 0, 1e-4);
    add(&scene, 1e6, 0, 2e6, 5e5);
    add_random(&scene, 50, 1e-2, 1e-4, 1e-3, 6);
    compare_views(iso_vec3_make(0.01, 0.02, -0.1), 0.04, "spheres of many sizes");
}

static void test_near_spheres(void **state) {
    (void)state;
    const iso_vec3 zero = {0};
    cloud_start(&scene, zero); /* the eye among and within them */
    add_random(&scene, 400, 10, 0.5, 4, 7);
    compare_views(iso_vec3_make(0.5, 0.2, -0.3), 1.5, "eye inside");
    compare_views(iso_vec3_make(4, -3, 5), 12, "eye among spheres");
    for (int plane = 0; plane < 2; plane++) { /* the near plane through them */
        iso_view view = test_shapes_view(zero, iso_vec3_make(0, 3, -20), 20, plane);
        view.near = 17;
        compare(&view, plane ? "cut, parallel" : "cut, perspective");
    }
}

/* A sphere so large in the picture that it is traced in double precision, half a thousandth of a millimetre
 * in front of what the gbuffer shows, at depths below 0. */
static void test_negative_depths(void **state) {
    (void)state;
    enum { SIDE = 40 };
    const iso_vec3 zero = {0};
    cloud_start(&scene, zero);
    add(&scene, 0, 0, -700, 300);
    const iso_view view = {.rotation = {1, 0, 0, 0, 1, 0, 0, 0, 1},
                           .focal = 100,
                           .cx = SIDE / 2,
                           .cy = SIDE / 2,
                           .width = SIDE,
                           .height = SIDE,
                           .orthographic = true,
                           .near = -1e300};
    iso_shapes *shapes = NULL;
    iso_gbuffer g;
    iso_error error = {0};
    test_ok(iso_shapes_from_glyphs(&scene.glyphs, &SPHERES, &shapes, &error), &error);
    test_ok(iso_gbuffer_create(SIDE, SIDE, &g, &error), &error);
    for (int i = 0; i < SIDE * SIDE; i++) {
        g.depth[i] = -999.9995f;
        g.surface[i] = 0;
    }
    const iso_target target = {&view, &g, NULL, 1, NULL};
    test_ok(iso_draw_shapes(&target, shapes, NULL, &error), &error);
    for (int i = 0; i < SIDE * SIDE; i++) assert_int_equal(g.surface[i], 1);
    iso_gbuffer_free(&g);
    iso_shapes_destroy(shapes);
}

/* A set takes at most 16 bytes a glyph. */
static void test_memory(void **state) {
    (void)state;
    const iso_vec3 zero = {0};
    cloud_start(&scene, zero);
    add_random(&scene, 3000, 10, 0.01, 0.1, 2);
    iso_shapes *shapes = NULL;
    iso_error error = {0};
    test_ok(iso_shapes_from_glyphs(&scene.glyphs, &SPHERES, &shapes, &error), &error);
    const iso_shapes_totals totals = iso_shapes_stats(shapes);
    const size_t fixed = 1024; /* the set itself, and values that may be read past the end */
    assert_int_equal(totals.shapes, 3000);
    if (totals.bytes > fixed + 16 * totals.shapes)
        fail_msg("%zu bytes of %zu glyphs", totals.bytes, totals.shapes);
    iso_shapes_destroy(shapes);
}

/* Spheres of few radii are drawn like those of many, which a far one of each of many radii makes of them. */
static void test_few_radii(void **state) {
    (void)state;
    const iso_vec3 zero = {0};
    iso_error error = {0};
    iso_gbuffer pictures[2];
    iso_view view = test_shapes_view(zero, iso_vec3_make(60, 35, -80), 24, 0);
    cloud_start(&scene, zero);
    for (int i = 0; i < 2000; i++) {
        add_random(&scene, 1, 10, 1, 1, (uint32_t)i + 1);
        scene.radii[i] = 0.1f * (float)(1 + i % 7);
    }
    for (int k = 0; k < 2; k++) {
        iso_shapes *shapes;
        test_ok(iso_shapes_from_glyphs(&scene.glyphs, &SPHERES, &shapes, &error), &error);
        assert_true((shapes->size != NULL) == (k == 0));
        pictures[k] = test_clear_gbuffer(view.width, view.height, false);
        const iso_target target = {.view = &view, .gbuffer = &pictures[k]};
        test_ok(iso_draw_shapes(&target, shapes, NULL, &error), &error);
        iso_shapes_destroy(shapes);
        for (int i = 0; i < 300; i++) add(&scene, 1e5, 1e5, 1e5, 1 + 0.01 * i);
    }
    test_same_rows(&pictures[0], 0, &pictures[1]);
    for (int k = 0; k < 2; k++) iso_gbuffer_free(&pictures[k]);
}

static void test_same_bytes(void **state) {
    (void)state;
    const iso_vec3 zero = {0};
    cloud_start(&scene, zero);
    add_random(&scene, 2000, 10, 0.05, 1, 8);
    add_random(&scene, 10, 10, 3, 5, 9);
    for (int i = 0; i < 600; i++) add(&scene, 1, 1, 1, 2);
    iso_error error = {0};
    iso_shapes *shapes;
    test_ok(iso_shapes_from_glyphs(&scene.glyphs, &SPHERES, &shapes, &error), &error);
    for (int parallel = 0; parallel < 2; parallel++)
        for (int close = 0; close < 2; close++) {
            const iso_vec3 away = close ? iso_vec3_make(1, 2, -4) : iso_vec3_make(60, 35, -80);
            iso_view view = test_shapes_view(zero, away, close ? 5 : 24, parallel);
            view = iso_view_scaled(&view, 4); /* several bins */
            test_shapes_variants(shapes, &view);
        }
    iso_shapes_destroy(shapes);
}

/* What is in the gbuffer hides shapes, and is kept where depths are equal; colours are those of the glyphs.
 */
static void test_layers(void **state) {
    (void)state;
    const iso_vec3 zero = {0};
    cloud_start(&scene, zero);
    scene.glyphs.colors = scene.colors;
    add_random(&scene, 300, 10, 0.5, 2, 10);
    iso_error error = {0};
    iso_shapes *shapes;
    test_ok(iso_shapes_from_glyphs(&scene.glyphs, &SPHERES, &shapes, &error), &error);
    const iso_view view = test_shapes_view(zero, iso_vec3_make(60, 35, -80), 24, false);
    iso_gbuffer alone = test_shapes_drawn(&view, shapes, NULL),
                g = test_clear_gbuffer(view.width, view.height, true);
    for (int i = 0; i < view.width * view.height; i++)
        if (i % 3) { /* in front of, or exactly where the shapes are */
            g.depth[i] = i % 3 == 1 ? 1 : alone.depth[i];
            g.surface[i] = 7;
        }
    const iso_target target = {&view, &g, NULL, 3, NULL};
    test_ok(iso_draw_shapes(&target, shapes, NULL, &error), &error);
    const iso_shapes_scene judged = {&scene.glyphs, NULL, SPHERES};
    iso_shapes_truth *truth;
    test_ok(iso_shapes_truth_create(&judged, &view, &truth, &error), &error);
    for (int i = 0; i < view.width * view.height; i++) {
        const bool seen = i % 3 == 0 && isfinite(alone.depth[i]);
        assert_int_equal(g.surface[i], i % 3 ? 7 : seen ? 3 : ISO_SURFACE_NONE);
        if (!seen) continue;
        const size_t shape = iso_shapes_truth_ray(truth, i % view.width + 0.5, (i / view.width) + 0.5).shape;
        const uint8_t *rgb = scene.colors[shape];
        assert_int_equal(g.color[i], rgb[0] | rgb[1] << 8 | rgb[2] << 16 | 4u << 24);
    }
    iso_shapes_truth_destroy(truth);
    iso_gbuffer_free(&alone);
    iso_gbuffer_free(&g);
    iso_shapes_destroy(shapes);
}

/* Very many spheres that each cover the picture, in front of the eye and around it: most are skipped. */
static void test_many_large(void **state) {
    (void)state;
    enum { MANY = 200000 };
    iso_glyphs many = {.positions = iso_alloc(MANY * sizeof *many.positions), .count = MANY};
    assert_non_null(many.positions);
    for (int around = 0; around < 2; around++) {
        uint32_t seed = 12;
        for (size_t i = 0; i < MANY; i++)
            for (int a = 0; a < 3; a++) many.positions[i][a] = (float)(10 * uniform(&seed) - 5);
        const iso_vec3 away = around ? iso_vec3_make(3, 4, -5) : iso_vec3_make(60, 35, -80);
        const iso_view view = test_shapes_view(many.origin, away, around ? 1 : 10, false);
        const iso_shapes_scene judged = {&many, NULL, {.radius = 40}};
        iso_shapes *shapes = test_shapes_make(&judged);
        iso_gbuffer g = test_shapes_drawn(&view, shapes, NULL);
        iso_shapes_truth *truth;
        iso_error error = {0};
        test_ok(iso_shapes_truth_create(&judged, &view, &truth, &error), &error);
        for (int i = 0; i < 4; i++) {
            const int x = (i * 17 + 3) % view.width, y = (i * 29 + 5) % view.height;
            near((double)g.depth[y * view.width + x], iso_shapes_truth_ray(truth, x + 0.5, y + 0.5).depth,
                 1e-3);
        }
        iso_shapes_truth_destroy(truth);
        iso_gbuffer_free(&g);
        iso_shapes_destroy(shapes);
    }
    iso_glyphs_free(&many);
}

static void test_bad_glyphs(void **state) {
    (void)state;
    const iso_vec3 zero = {0};
    const float bad[] = {NAN, INFINITY, -1, 0};
    cloud_start(&scene, zero);
    add_random(&scene, 20, 5, 1, 2, 11);
    for (int i = 0; i < 4; i++) add(&scene, 0, 0, 0, (double)bad[i]);
    for (int i = 0; i < 2; i++) add(&scene, 0, (double)bad[i], 0, 1);
    iso_error error = {0};
    iso_shapes *shapes;
    test_ok(iso_shapes_from_glyphs(&scene.glyphs, &SPHERES, &shapes, &error), &error);
    assert_int_equal(iso_shapes_stats(shapes).shapes, 20);
    assert_int_equal(iso_shapes_stats(shapes).skipped, 6);
    iso_shapes_destroy(shapes);
    scene.glyphs.radii = NULL;
    assert_int_equal(iso_shapes_from_glyphs(&scene.glyphs, &SPHERES, &shapes, &error), ISO_ERR_USAGE);
    const iso_shapes_opts negative = {.radius = -1}, infinite = {.radius = 1, .scale = INFINITY};
    assert_int_equal(iso_shapes_from_glyphs(&scene.glyphs, &negative, &shapes, &error), ISO_ERR_USAGE);
    assert_int_equal(iso_shapes_from_glyphs(&scene.glyphs, &infinite, &shapes, &error), ISO_ERR_USAGE);
    scene.glyphs.count = 0; /* nothing is drawn */
    const iso_shapes_opts one = {.radius = 1};
    test_ok(iso_shapes_from_glyphs(&scene.glyphs, &one, &shapes, &error), &error);
    const iso_box bounds = iso_shapes_bounds(shapes);
    assert_true(iso_box_is_empty(&bounds));
    const iso_view view = test_shapes_view(zero, iso_vec3_make(0, 0, -10), 5, false);
    iso_gbuffer g = test_shapes_drawn(&view, shapes, NULL);
    iso_gbuffer_free(&g);
    iso_shapes_destroy(shapes);
}

/* Checks the set's bounds along three vectors against its spheres: they hold every sphere, and no more. */
static void check_bounds_along(const iso_glyphs *glyphs, const iso_vec3 vectors[3]) {
    iso_shapes *shapes = NULL;
    iso_error error = {0};
    test_ok(iso_shapes_from_glyphs(glyphs, &SPHERES, &shapes, &error), &error);
    const iso_box box = iso_shapes_bounds_along(shapes, vectors);
    double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (size_t i = 0; i < glyphs->count; i++)
        for (int k = 0; k < 3; k++) {
            const float *p = glyphs->positions[i];
            const iso_vec3 at = {glyphs->origin.x + (double)p[0], glyphs->origin.y + (double)p[1],
                                 glyphs->origin.z + (double)p[2]};
            const double middle = iso_vec3_dot(at, vectors[k]),
                         reach = (double)glyphs->radii[i] * iso_vec3_length(vectors[k]);
            low[k] = fmin(low[k], middle - reach);
            high[k] = fmax(high[k], middle + reach);
        }
    const double got_low[3] = {box.lo.x, box.lo.y, box.lo.z}, got_high[3] = {box.hi.x, box.hi.y, box.hi.z};
    for (int k = 0; k < 3; k++) {
        assert_true(got_low[k] <= low[k] + 1e-4 && got_low[k] > low[k] - 1e-3);
        assert_true(got_high[k] >= high[k] - 1e-4 && got_high[k] < high[k] + 1e-3);
    }
    iso_shapes_destroy(shapes);
}

/* Bounds in a turned and scaled space, of many blocks, and of one on one side of the origin. */
static void test_bounds_along(void **state) {
    (void)state;
    const iso_vec3 vectors[3] = {{0.6, 0.8, 0}, {-1.6, 1.2, 0}, {0, 0.5, 0.5}};
    cloud_start(&scene, iso_vec3_make(300, -20, 7));
    add_random(&scene, 2000, 50, 0.2, 1, 3);
    check_bounds_along(&scene.glyphs, vectors);
    cloud_start(&scene, (iso_vec3){0});
    add(&scene, 0, 0, 0, 1);
    add(&scene, 10, 4, -2, 0.5);
    check_bounds_along(&scene.glyphs, vectors);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_spheres),      cmocka_unit_test(test_far_spheres),
        cmocka_unit_test(test_near_spheres), cmocka_unit_test(test_same_bytes),
        cmocka_unit_test(test_few_radii),    cmocka_unit_test(test_layers),
        cmocka_unit_test(test_many_large),   cmocka_unit_test(test_bad_glyphs),
        cmocka_unit_test(test_bounds_along), cmocka_unit_test(test_negative_depths),
        cmocka_unit_test(test_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
