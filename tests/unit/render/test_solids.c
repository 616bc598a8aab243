/* Cones, cylinders, arrows, ellipsoids, discs and boxes against rays in extended precision, of all sizes in
 * the picture, seen from all sides and from inside; and the same bytes for every instruction set, number of
 * threads and strip. */
#include <stdio.h>

#include "check_support.h"
#include "scene_support.h"
#include "shapes_support.h"

enum { MOST = 1500 };

typedef struct cloud {
    iso_glyphs glyphs;
    float positions[MOST][3], radii[MOST], directions[MOST][3], axes[MOST][9];
} cloud;

static cloud scene;

static const char *const NAMES[ISO_GLYPH_COUNT] = {
#define NAME(id, text) text,
    ISO_GLYPHS(NAME)
#undef NAME
};

static const iso_vec3 AWAY = {60, 35, -80};

static void start(double x, double y, double z) {
    scene.glyphs = (iso_glyphs){.origin = iso_vec3_make(x, y, z),
                                .positions = scene.positions,
                                .radii = scene.radii,
                                .directions = scene.directions,
                                .axes = scene.axes};
}

/* A glyph of about `size` mm; `aspect`: its length by its width, or a random number of at most that. */
static void add(iso_vec3 at, double size, double aspect, uint32_t *seed) {
    const size_t i = scene.glyphs.count++;
    iso_vec3 x, y, z;
    assert_true(i < MOST);
    do z = iso_vec3_make(uniform(seed) - 0.5, uniform(seed) - 0.5, uniform(seed) - 0.5);
    while (iso_vec3_length(z) < 0.1);
    z = iso_vec3_unit(z);
    x = iso_vec3_unit(iso_vec3_cross(z, iso_vec3_make(0.3, 0.5, 0.8)));
    y = iso_vec3_cross(z, x);
    const double lengths[3] = {size / aspect, size / aspect * (0.5 + uniform(seed)), size};
    const iso_vec3 axes[3] = {x, y, z};
    const double position[3] = {at.x, at.y, at.z};
    for (int k = 0; k < 3; k++) {
        double out[3];
        iso_vec3_store(iso_vec3_scale(axes[k], lengths[k]), out);
        for (int a = 0; a < 3; a++) scene.axes[i][3 * k + a] = (float)out[a];
        for (int a = 0; a < 3 && k == 2; a++) scene.directions[i][a] = (float)(2 * out[a]);
        scene.positions[i][k] = (float)position[k];
    }
    scene.radii[i] = (float)lengths[0];
}

static void add_random(int count, double half, double low, double high, double aspect, uint32_t seed) {
    for (int i = 0; i < count; i++) {
        const iso_vec3 at = iso_vec3_make(half * (2 * uniform(&seed) - 1), half * (2 * uniform(&seed) - 1),
                                          half * (2 * uniform(&seed) - 1));
        add(at, low + (high - low) * uniform(&seed), 1 + (aspect - 1) * uniform(&seed), &seed);
    }
}

static iso_shapes_scene judged(iso_glyph glyph) {
    return (iso_shapes_scene){&scene.glyphs, NULL, {.glyph = glyph}};
}

static void compare_views(iso_vec3 away, double height, const char *name) {
    char text[96];
    for (iso_glyph glyph = ISO_GLYPH_CONE; glyph < ISO_GLYPH_COUNT; glyph++) {
        const iso_shapes_scene set = judged(glyph);
        snprintf(text, sizeof text, "%s, %s", NAMES[glyph], name);
        test_shapes_compare_views(&set, away, height, text);
    }
}

static void test_solids(void **state) {
    (void)state;
    start(0, 0, 0);
    add_random(60, 9, 0.3, 2, 5, 1);
    compare_views(AWAY, 24, "small");
    start(0, 0, 0);
    add_random(20, 8, 2, 5, 40, 2); /* thin */
    compare_views(AWAY, 24, "thin");
    start(0, 0, 0);
    add_random(20, 8, 0.05, 0.2, 0.05, 3); /* flat */
    compare_views(AWAY, 24, "flat");
}

static void test_far_and_near(void **state) {
    (void)state;
    start(0, 0, 0);
    add_random(14, 8, 0.7, 3, 4, 4);
    compare_views(iso_vec3_make(4e4, 5e4, -6e4), 24, "distant");
    compare_views(iso_vec3_make(0.5, 0.2, -0.3), 1.5, "eye inside");
    compare_views(iso_vec3_make(4, -3, 5), 12, "eye among them");
    start(1e7, -2e7, 3e7);
    add_random(20, 8, 0.3, 2, 4, 5);
    compare_views(AWAY, 24, "at 1e7 mm");
    start(0, 0, 0); /* up to 10,000 pixels */
    uint32_t seed = 6;
    add(iso_vec3_make(0, 0, 0), 10, 2, &seed);
    compare_views(AWAY, 0.6, "large");
}

/* Axes along the view and across it, where numbers are exactly 0. */
static void test_aligned(void **state) {
    (void)state;
    for (int axis = 0; axis < 3; axis++) {
        start(0, 0, 0);
        for (int i = 0; i < 3; i++)
            for (int k = 0; k < 9; k++) {
                scene.axes[i][k] = k % 4 ? 0 : 1 + 0.5F * (float)(k / 4);
                scene.directions[i][k % 3] = k % 3 == i ? 2 : 0;
                scene.positions[i][k % 3] = k % 3 == i ? 3 : 0;
            }
        for (int i = 0; i < 3; i++) scene.radii[i] = 0.7F;
        scene.glyphs.count = 3;
        const double away[3] = {axis == 0 ? 50 : 0, axis == 1 ? 50 : 0, axis == 2 ? 50 : 0};
        compare_views(iso_vec3_make(away[0], away[1], away[2]), 12, "aligned");
    }
}

/* Without radii and axes, sizes follow from directions, from one radius and from the scale. */
static void test_sizes(void **state) {
    (void)state;
    start(0, 0, 0);
    add_random(20, 8, 0.7, 2, 4, 7);
    scene.glyphs.radii = NULL;
    scene.glyphs.axes = NULL;
    for (iso_glyph glyph = ISO_GLYPH_CONE; glyph < ISO_GLYPH_COUNT; glyph++) {
        iso_shapes_scene set = judged(glyph);
        const bool directed = glyph <= ISO_GLYPH_ARROW;
        set.opts.scale = 1.7;
        set.opts.radius = directed ? 0 : 0.6;
        test_shapes_compare_views(&set, AWAY, 24, NAMES[glyph]);
        set.opts.radius = 0.3;
        if (directed) test_shapes_compare_views(&set, AWAY, 24, NAMES[glyph]);
    }
}

static void test_same_bytes(void **state) {
    (void)state;
    start(0, 0, 0);
    add_random(300, 9, 0.1, 1.5, 5, 8);
    add_random(8, 9, 2, 4, 3, 9);
    for (iso_glyph glyph = ISO_GLYPH_CONE; glyph < ISO_GLYPH_COUNT; glyph++) {
        const iso_shapes_scene set = judged(glyph);
        iso_shapes *shapes = test_shapes_make(&set);
        for (int parallel = 0; parallel < 2; parallel++) {
            const iso_vec3 away = parallel ? AWAY : iso_vec3_make(4, -3, 5);
            iso_view view = test_shapes_view(scene.glyphs.origin, away, 20, parallel);
            view = iso_view_scaled(&view, 4);
            test_shapes_variants(shapes, &view);
        }
        iso_shapes_destroy(shapes);
    }
}

static void test_bad_solids(void **state) {
    (void)state;
    iso_error error = {0};
    iso_shapes *shapes;
    start(0, 0, 0);
    add_random(20, 8, 0.5, 2, 4, 10);
    for (int k = 0; k < 9; k++) {
        scene.directions[3][k % 3] = 0;                  /* no direction */
        scene.axes[4][k] = scene.axes[4][k % 3];         /* axes in a line */
        scene.axes[5][k] = k < 3 ? scene.axes[5][k] : 0; /* a needle */
        scene.axes[6][k] = 0;                            /* nothing */
        scene.axes[7][k] = k < 6 ? scene.axes[7][k] : 0; /* flat */
        scene.directions[8][k % 3] = k % 3 ? 1 : NAN;
        scene.axes[9][k] = k == 5 ? INFINITY : scene.axes[9][k];
    }
    for (iso_glyph glyph = ISO_GLYPH_CONE; glyph < ISO_GLYPH_COUNT; glyph++) {
        const iso_shapes_scene set = judged(glyph);
        shapes = test_shapes_make(&set);
        const bool axes = glyph == ISO_GLYPH_ELLIPSOID || glyph == ISO_GLYPH_BOX;
        assert_int_equal(iso_shapes_stats(shapes).skipped, axes ? 3 : 2);
        const iso_view view = test_shapes_view(scene.glyphs.origin, AWAY, 24, false);
        iso_gbuffer g = test_shapes_drawn(&view, shapes, NULL);
        iso_gbuffer_free(&g);
        iso_shapes_destroy(shapes);
    }
    scene.glyphs.directions = NULL;
    scene.glyphs.axes = NULL;
    scene.glyphs.radii = NULL;
    for (iso_glyph glyph = ISO_GLYPH_CONE; glyph < ISO_GLYPH_COUNT; glyph++) {
        const iso_shapes_opts opts = {.glyph = glyph};
        assert_int_equal(iso_shapes_from_glyphs(&scene.glyphs, &opts, &shapes, &error), ISO_ERR_USAGE);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_solids), cmocka_unit_test(test_far_and_near), cmocka_unit_test(test_aligned),
        cmocka_unit_test(test_sizes),  cmocka_unit_test(test_same_bytes),   cmocka_unit_test(test_bad_solids),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
