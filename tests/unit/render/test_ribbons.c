/* Ribbons against rays in extended precision, as tubes are (test_tubes.c): flat, twisted, of all sizes in the
 * picture, from their edges and from near; normals of lines that have none; and the same bytes for every
 * instruction set, number of threads and strip. */
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "check_support.h"
#include "lines_support.h"
#include "scene_support.h"
#include "shapes_support.h"

static test_lines scene;
static float normals[TEST_LINES_VERTICES][3];
static const iso_vec3 AWAY = {60, 35, -80};

/* Random unit vectors as normals. */
static void add_random_normals(uint32_t *seed) {
    for (size_t i = 0; i < scene.lines.vertex_count; i++) {
        iso_vec3 n = {2 * uniform(seed) - 1, 2 * uniform(seed) - 1, 2 * uniform(seed) - 1.0};
        n = iso_vec3_unit(n);
        normals[i][0] = (float)n.x, normals[i][1] = (float)n.y, normals[i][2] = (float)n.z;
    }
    scene.lines.normals = normals;
}

/* Replaces the normals by those that the library makes. */
static void add_smooth_normals(void) {
    iso_error error = {0};
    scene.lines.normals = NULL;
    test_ok(iso_lines_add_normals(&scene.lines, &error), &error);
    memcpy(normals, scene.lines.normals, scene.lines.vertex_count * sizeof *normals);
    iso_free(scene.lines.normals);
    scene.lines.normals = normals;
}

static iso_shapes_scene scene_of(double min_pixels) {
    return (iso_shapes_scene){
        NULL, &scene.lines, {.radius = 0.4, .style = ISO_LINE_RIBBON, .min_pixels = min_pixels}};
}

static void compare_views(iso_vec3 away, double height, double min_pixels, const char *name) {
    const iso_shapes_scene judged = scene_of(min_pixels);
    test_shapes_compare_views(&judged, away, height, name);
}

static void add_walks(int count, int steps, double step, double low, double high, uint32_t *seed) {
    for (int i = 0; i < count; i++) test_lines_add_walk(&scene, steps, 8, step, low, high, seed);
}

static void test_ribbons(void **state) {
    (void)state;
    uint32_t seed = 1;
    test_lines_start(&scene, 0, 0, 0);
    add_walks(25, 20, 3, 0.3, 0.9, &seed);
    add_smooth_normals();
    compare_views(AWAY, 24, 0, "ribbons");
    add_random_normals(&seed);
    compare_views(AWAY, 24, 0, "twisted ribbons");
    scene.lines.radii = NULL;
    compare_views(AWAY, 24, 0, "ribbons of one width");
    test_lines_start(&scene, 0, 0, 0);
    for (int i = 0; i <= 120; i++) {
        double sine, cosine;
        iso_sincos(i * 0.2, &sine, &cosine);
        test_lines_add(&scene, 6 * cosine, i * 0.1 - 6, 6 * sine, 1.2 + 0.9 * sine * cosine);
    }
    test_lines_end(&scene);
    add_smooth_normals();
    compare_views(AWAY, 24, 0, "ribbon along a helix");
}

/* A flat ribbon seen from its edge shows nothing; turned a little, it is where it should be. */
static void test_edges(void **state) {
    (void)state;
    test_lines_start(&scene, 0, 0, 0);
    for (int i = 0; i < 40; i++) {
        test_lines_add(&scene, -8, 0.4 * i - 8, 0.1 * i, 1);
        test_lines_add(&scene, 8, 0.4 * i - 8, 0.1 * i, 1);
        test_lines_end(&scene);
    }
    for (size_t i = 0; i < scene.lines.vertex_count; i++)
        for (int a = 0; a < 3; a++) normals[i][a] = a == 1;
    scene.lines.normals = normals;
    const iso_shapes_scene judged = scene_of(0);
    for (int tilt = 0; tilt < 6; tilt++) {
        const double angles[] = {0, 1e-7, 1e-4, 1e-2, 0.1, 0.5};
        iso_view view =
            test_shapes_view(scene.lines.origin, iso_vec3_make(0, 30 * angles[tilt], -30), 20, true);
        test_shapes_compare(&judged, &view, "ribbons from their edges");
    }
    compare_views(iso_vec3_make(30, 0.01, 1), 24, 0, "ribbons end on");
}

static void test_far_and_near(void **state) {
    (void)state;
    uint32_t seed = 4;
    test_lines_start(&scene, 0, 0, 0);
    add_walks(6, 12, 3, 0.4, 1.2, &seed);
    add_random_normals(&seed);
    compare_views(iso_vec3_make(4e4, 5e4, -6e4), 24, 0, "distant ribbons");
    compare_views(iso_vec3_make(0.5, 0.2, -0.3), 1.5, 0, "ribbons around the eye");
    compare_views(iso_vec3_make(4, -3, 5), 12, 0, "ribbons, eye among them");
    const iso_shapes_scene judged = scene_of(0);
    for (int parallel = 0; parallel < 2; parallel++) {
        iso_view view = test_shapes_view(scene.lines.origin, iso_vec3_make(0, 3, -20), 20, parallel);
        view.near = 17;
        test_shapes_compare(&judged, &view, "ribbons through the near plane");
    }
    test_lines_start(&scene, 1e7, -2e7, 3e7);
    add_walks(15, 20, 2, 0.2, 0.9, &seed);
    add_smooth_normals();
    compare_views(AWAY, 24, 0, "ribbons at 1e7 mm");
}

static void test_widths(void **state) {
    (void)state;
    uint32_t seed = 6;
    test_lines_start(&scene, 0, 0, 0);
    add_walks(20, 20, 3, 0, 0.3, &seed);
    add_smooth_normals();
    compare_views(AWAY, 24, 2, "ribbons of two pixels");
    compare_views(iso_vec3_make(4, -3, 5), 12, 2, "ribbons of two pixels, eye among them");
}

/* Both sides of a ribbon face the eye. */
static void test_sides(void **state) {
    (void)state;
    uint32_t seed = 7;
    test_lines_start(&scene, 0, 0, 0);
    add_walks(25, 20, 3, 0.3, 0.9, &seed);
    add_random_normals(&seed);
    const iso_shapes_scene drawn = scene_of(0);
    iso_shapes *shapes = test_shapes_make(&drawn);
    for (int i = 0; i < 4; i++) {
        iso_view view =
            test_shapes_view(scene.lines.origin, i < 2 ? AWAY : iso_vec3_make(1, 2, -4), 24, i % 2);
        view = iso_view_scaled(&view, 3);
        iso_gbuffer g = test_shapes_drawn(&view, shapes, NULL);
        size_t seen = 0;
        for (int k = 0; k < g.width * g.height; k++) {
            if (g.surface[k] == ISO_SURFACE_NONE) continue;
            const double u = view.orthographic ? 0 : (k % g.width + 0.5 - view.cx) / view.focal,
                         v = view.orthographic ? 0 : (k / g.width + 0.5 - view.cy) / view.focal;
            assert_true((double)g.normal[0][k] * u + (double)g.normal[1][k] * v + (double)g.normal[2][k] <
                        1e-5);
            seen++;
        }
        assert_true(seen > 100);
        iso_gbuffer_free(&g);
        test_shapes_variants(shapes, &view);
    }
    iso_shapes_destroy(shapes);
}

/* Normals that the library makes are unit, perpendicular to the line, and do not turn where it does not. */
static void test_normals(void **state) {
    (void)state;
    uint32_t seed = 8;
    static float tangents[TEST_LINES_VERTICES][3];
    test_lines_start(&scene, 0, 0, 0);
    add_walks(40, 50, 2, 0, 1, &seed);
    for (int i = 0; i < 50; i++) test_lines_add(&scene, i, 0.3 * i, i % 7 ? -0.2 * i : -0.2 * (i - 1), 1);
    test_lines_end(&scene);
    for (int i = 0; i < 10; i++) test_lines_add(&scene, i / 4, 2, 1, 1); /* repeated vertices */
    test_lines_end(&scene);
    for (int i = 0; i < 9; i++) test_lines_add(&scene, i % 2, 0, 0, 1); /* to and fro */
    test_lines_end(&scene);
    add_smooth_normals();
    iso_lines_tangents(&scene.lines, tangents[0], 3);
    for (size_t i = 0; i < scene.lines.vertex_count; i++) {
        double square = 0, along = 0;
        for (int a = 0; a < 3; a++) {
            square += (double)normals[i][a] * (double)normals[i][a];
            along += (double)normals[i][a] * (double)tangents[i][a];
        }
        near(square, 1, 1e-5);
        near(along, 0, 1e-5);
    }
    /* A closed plane curve: its normals stay in one place relative to the plane. */
    test_lines_start(&scene, 0, 0, 0);
    for (int i = 0; i <= 200; i++) {
        double sine, cosine;
        iso_sincos(i * ISO_PI / 50, &sine, &cosine);
        test_lines_add(&scene, 5 * cosine, 3 * sine, 0, 1);
    }
    test_lines_end(&scene);
    add_smooth_normals();
    for (int i = 0; i <= 200; i++) near((double)normals[i][2], (double)normals[0][2], 1e-4);
}

/* A set takes at most 24 bytes a segment. */
static void test_memory(void **state) {
    (void)state;
    test_lines_start(&scene, 0, 0, 0);
    for (int i = 0; i < 3000; i++) test_lines_add(&scene, i % 70, i / 70, 0, 1);
    test_lines_end(&scene);
    for (int i = 0; i < 3000; i++)
        for (int a = 0; a < 3; a++) normals[i][a] = a == 2;
    scene.lines.normals = normals;
    const iso_shapes_scene drawn = scene_of(0);
    iso_shapes *shapes = test_shapes_make(&drawn);
    const iso_shapes_totals totals = iso_shapes_stats(shapes);
    const size_t fixed = 1024; /* the set itself */
    assert_int_equal(totals.shapes, 2999);
    if (totals.bytes > fixed + 24 * totals.shapes)
        fail_msg("%zu bytes of %zu segments", totals.bytes, totals.shapes);
    iso_shapes_destroy(shapes);
}

static void test_bad_ribbons(void **state) {
    (void)state;
    iso_error error = {0};
    iso_shapes *shapes;
    test_lines_start(&scene, 0, 0, 0);
    for (int k = 0; k < 6; k++) test_lines_add(&scene, k, 0, 0, 0.3);
    test_lines_end(&scene);
    const iso_shapes_scene drawn = scene_of(0);
    assert_int_equal(iso_shapes_from_lines(&scene.lines, &drawn.opts, &shapes, &error), ISO_ERR_USAGE);
    for (int k = 0; k < 6; k++)
        for (int a = 0; a < 3; a++) normals[k][a] = k != 1 && a == (k == 4 ? 0 : 1);
    scene.lines.normals = normals; /* 0 at one vertex, along the line at another */
    shapes = test_shapes_make(&drawn);
    assert_int_equal(iso_shapes_stats(shapes).shapes, 1);
    assert_int_equal(iso_shapes_stats(shapes).skipped, 4);
    iso_shapes_destroy(shapes);
    for (int k = 0; k < 6; k++) scene.vertices[k][0] = 0; /* all vertices in one place */
    shapes = test_shapes_make(&drawn);
    assert_int_equal(iso_shapes_stats(shapes).shapes, 0);
    iso_shapes_destroy(shapes);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_ribbons),      cmocka_unit_test(test_edges),
        cmocka_unit_test(test_far_and_near), cmocka_unit_test(test_widths),
        cmocka_unit_test(test_sides),        cmocka_unit_test(test_normals),
        cmocka_unit_test(test_bad_ribbons),  cmocka_unit_test(test_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
