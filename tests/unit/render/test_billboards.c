/* Billboards of glyphs: the same bytes as exact glyphs in parallel views; in perspective, each glyph is the
 * picture of a parallel projection, judged by rays in extended precision; how much too small their outlines
 * are; and the same bytes for every instruction set, number of threads and strip. */
#include <float.h>
#include <math.h>
#include <stdio.h>

#include "check_support.h"
#include "scene_support.h"
#include "shapes_support.h"
#include "view_support.h"

enum { COUNT = 12 };

static float positions[COUNT][3], radii[COUNT], directions[COUNT][3], axes[COUNT][9];
static const iso_vec3 AWAY = {14, 9, -17};

/* Glyphs in a box of 2 * half mm, which are 0.5 to 1.5 mm wide. */
static iso_glyphs random_glyphs(double half, uint32_t seed) {
    for (int i = 0; i < COUNT; i++) {
        radii[i] = (float)(0.5 + uniform(&seed));
        for (int k = 0; k < 3; k++) {
            positions[i][k] = (float)(half * (2 * uniform(&seed) - 1));
            directions[i][k] = (float)(4 * uniform(&seed) - 2);
        }
        for (int k = 0; k < 9; k++)
            axes[i][k] = (float)((k % 4 ? 0.3 : 1.2) * (0.5 + uniform(&seed))); /* not at right angles */
    }
    return (iso_glyphs){
        .positions = positions, .count = COUNT, .radii = radii, .directions = directions, .axes = axes};
}

static iso_shapes_scene scene_of(const iso_glyphs *glyphs, iso_glyph glyph) {
    return (iso_shapes_scene){glyphs, NULL, {.glyph = glyph, .projection = ISO_GLYPH_PROJECTION_BILLBOARD}};
}

static iso_gbuffer drawn(const iso_shapes_scene *scene, const iso_view *view) {
    iso_shapes *shapes = test_shapes_make(scene);
    iso_gbuffer g = test_shapes_drawn(view, shapes, NULL);
    iso_shapes_destroy(shapes);
    return g;
}

static void exact_in_parallel_views(void **state) {
    (void)state;
    const iso_glyphs glyphs = random_glyphs(5, 1);
    const iso_view view = test_shapes_view((iso_vec3){0, 0, 0}, AWAY, 14, true);
    for (iso_glyph glyph = ISO_GLYPH_SPHERE; glyph < ISO_GLYPH_COUNT; glyph++) {
        iso_shapes_scene scene = scene_of(&glyphs, glyph);
        iso_gbuffer billboards = drawn(&scene, &view);
        scene.opts.projection = ISO_GLYPH_PROJECTION_EXACT;
        iso_gbuffer exact = drawn(&scene, &view);
        assert_true(test_covered(&exact) > 100);
        test_same_rows(&exact, 0, &billboards);
        iso_gbuffer_free(&billboards);
        iso_gbuffer_free(&exact);
    }
}

/* The middle of a glyph's solid. */
static iso_vec3 centre_of(iso_glyph glyph, int i) {
    const double half =
        glyph == ISO_GLYPH_CONE || glyph == ISO_GLYPH_CYLINDER || glyph == ISO_GLYPH_ARROW ? 0.5 : 0;
    double at[3];
    for (int k = 0; k < 3; k++) at[k] = (double)positions[i][k] + half * (double)directions[i][k];
    return iso_vec3_make(at[0], at[1], at[2]);
}

/* One glyph, judged by itself: its billboard is the parallel projection whose scale is that of its centre. */
static size_t wrong_samples(iso_glyph glyph, int i, const iso_view *view, size_t *covered) {
    iso_glyphs one = {.positions = &positions[i],
                      .count = 1,
                      .radii = &radii[i],
                      .directions = &directions[i],
                      .axes = &axes[i]};
    const iso_shapes_scene scene = scene_of(&one, glyph);
    iso_gbuffer g = drawn(&scene, view);
    iso_view parallel = *view;
    iso_shapes_truth *truth;
    iso_error error = {0};
    parallel.orthographic = true;
    parallel.focal = view->focal / iso_view_point(view, centre_of(glyph, i)).z;
    parallel.near = -DBL_MAX;
    test_ok(iso_shapes_truth_create(&scene, &parallel, &truth, &error), &error);
    size_t wrong = 0;
    for (int s = 0; s < g.width * g.height; s++) {
        const iso_shapes_hit hit = iso_shapes_truth_ray(truth, s % g.width + 0.5, s / g.width + 0.5);
        const iso_vec3 normal = iso_gbuffer_normal(&g, (size_t)s);
        *covered += hit.hit;
        if (hit.hit != isfinite(g.depth[s]))
            wrong++;
        else if (hit.hit)
            wrong +=
                !(fabs((double)g.depth[s] - hit.depth) < 1e-3 &&
                  normal.x * hit.normal[0] + normal.y * hit.normal[1] + normal.z * hit.normal[2] > 0.9999);
    }
    iso_shapes_truth_destroy(truth);
    iso_gbuffer_free(&g);
    return wrong;
}

static void parallel_projection_of_each_glyph(void **state) {
    (void)state;
    random_glyphs(5, 2);
    iso_view view = test_shapes_view((iso_vec3){0, 0, 0}, AWAY, 14, false);
    view = iso_view_scaled(&view, 2);
    for (iso_glyph glyph = ISO_GLYPH_SPHERE; glyph < ISO_GLYPH_COUNT; glyph++) {
        size_t covered = 0, wrong = 0;
        for (int i = 0; i < COUNT; i++) wrong += wrong_samples(glyph, i, &view, &covered);
        assert_true(covered > 500);
        if (wrong > covered / 500 + 2) /* grazing rays, edges */
            fail_msg("glyph %d: %zu of %zu samples are wrong", (int)glyph, wrong, covered);
    }
}

/* The disc of a billboard has (1 - (r / d)^2) of the area that the sphere covers. */
static void too_small_near_the_eye(void **state) {
    (void)state;
    for (int distance = 2; distance <= 10; distance += 4) {
        float origin[1][3] = {{0, 0, 0}}, radius[1] = {1};
        iso_glyphs glyphs = {.positions = origin, .count = 1, .radii = radius};
        iso_shapes_scene scene = scene_of(&glyphs, ISO_GLYPH_SPHERE);
        iso_view view = test_shapes_view((iso_vec3){0, 0, 0}, iso_vec3_make(0, 0, -distance), 2.6, false);
        view = iso_view_scaled(&view, 8);
        iso_gbuffer small = drawn(&scene, &view);
        scene.opts.projection = ISO_GLYPH_PROJECTION_EXACT;
        iso_gbuffer exact = drawn(&scene, &view);
        const double ratio = (double)test_covered(&small) / (double)test_covered(&exact);
        assert_float_equal(ratio, 1 - 1.0 / (distance * distance), 0.004);
        iso_gbuffer_free(&small);
        iso_gbuffer_free(&exact);
    }
}

static void same_bytes_everywhere(void **state) {
    (void)state;
    const iso_glyphs glyphs = random_glyphs(5, 3);
    for (iso_glyph glyph = ISO_GLYPH_SPHERE; glyph < ISO_GLYPH_COUNT; glyph++) {
        const iso_shapes_scene scene = scene_of(&glyphs, glyph);
        iso_shapes *shapes = test_shapes_make(&scene);
        for (int inside = 0; inside < 2; inside++) {
            iso_view view =
                test_shapes_view((iso_vec3){0, 0, 0}, inside ? iso_vec3_make(1, -2, 3) : AWAY, 14, false);
            view = iso_view_scaled(&view, 4);
            test_shapes_variants(shapes, &view);
        }
        iso_shapes_destroy(shapes);
    }
}

static void unknown_projections(void **state) {
    (void)state;
    const iso_glyphs glyphs = random_glyphs(5, 4);
    iso_shapes_opts opts = {.projection = (iso_glyph_projection)2};
    iso_shapes *shapes;
    iso_error error = {0};
    assert_int_equal(iso_shapes_from_glyphs(&glyphs, &opts, &shapes, &error), ISO_ERR_USAGE);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(exact_in_parallel_views), cmocka_unit_test(parallel_projection_of_each_glyph),
        cmocka_unit_test(too_small_near_the_eye),  cmocka_unit_test(same_bytes_everywhere),
        cmocka_unit_test(unknown_projections),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
