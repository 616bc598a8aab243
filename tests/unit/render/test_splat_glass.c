/* The map of crossings of glass whose surface is given by points: balls, one in or behind another. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "render/groups/coverage.h"
#include "render/groups/disc_layers.h"
#include "scene_support.h"

enum { BALL = 6000, PIXELS = 120 };

/* Balls of points with normals outwards. */
typedef struct balls {
    iso_surfel surfels[2 * BALL];
    float radii[2 * BALL];
    iso_point_span span;
    iso_point_view points;
    iso_groups groups;
} balls;

/* Adds points, spread evenly by the golden angle. */
static void add_ball(balls *b, double x, double y, double z, double radius) {
    for (int i = 0; i < BALL; i++) {
        const double up = 1 - (2 * i + 1.0) / BALL, around = sqrt(1 - up * up), angle = 2.399963229728653 * i,
                     normal[3] = {around * cos(angle), around * sin(angle), up}, center[3] = {x, y, z};
        b->radii[b->span.count] = (float)(radius * sqrt(4 * 3.14159265 / BALL));
        iso_surfel *s = &b->surfels[b->span.count++];
        for (int k = 0; k < 3; k++) {
            s->normal[k] = (float)normal[k];
            s->position[k] = (float)(center[k] + radius * normal[k]);
        }
    }
    b->points = (iso_point_view){.surfels = b->surfels,
                                 .radii = b->radii,
                                 .spans = &b->span,
                                 .span_count = 1,
                                 .transform = iso_transform_identity()};
}

static iso_glass_map make_map(balls *b, const iso_view *view, iso_transparency how, iso_pool *pool) {
    iso_error error = {0};
    iso_glass_map map;
    const iso_groups_opts grouping = iso_splat_layers_grouping(NULL);
    test_ok(iso_glass_map_create(view, &map, &error), &error);
    iso_groups_free(&b->groups);
    test_ok(iso_groups_make(&b->points, &grouping, &b->groups, &error), &error);
    test_ok(iso_groups_cover(&b->points, grouping.disc, NULL, &b->groups, &error), &error);
    test_ok(iso_groups_map_glass(&b->points, &b->groups, how, &map, pool, &error), &error);
    return map;
}

static const iso_glass_crossings *middle_of(const iso_glass_map *map) {
    return &map->crossings[PIXELS / 2 * PIXELS + PIXELS / 2];
}

static void assert_near(float value, double wanted, double tolerance) {
    if (!(fabs((double)value - wanted) <= tolerance)) fail_msg("%g is not %g", (double)value, wanted);
}

/* A ball, seen by parallel rays: thicknesses are its chords. */
static void test_ball(void **state) {
    (void)state;
    static balls b;
    memset(&b, 0, sizeof b);
    add_ball(&b, 0, 0, 20, 5);
    const iso_view view = test_plain_view(PIXELS, PIXELS, true, 10);
    iso_glass_map map = make_map(&b, &view, ISO_TRANSPARENCY_SORTED, NULL);
    int seen = 0;
    for (int i = 0; i < PIXELS * PIXELS; i++) {
        const double x = (i % PIXELS + 0.5 - view.cx) / 10, y = (i / PIXELS + 0.5 - view.cy) / 10,
                     square = 25 - x * x - y * y;
        if (square < 1) continue; /* rims are a disc's width thick */
        const iso_glass_crossings *c = &map.crossings[i];
        seen++;
        assert_int_equal(c->layers, 2);
        assert_int_equal(c->inside, 0);
        assert_near(c->thickness, 2 * sqrt(square), 0.05);
        assert_near(c->depth[0], 20 - sqrt(square), 0.05);
        for (int k = 0; k < 2; k++) {
            const double side = k ? sqrt(square) : -sqrt(square), normal[3] = {x / 5, y / 5, side / 5};
            for (int axis = 0; axis < 3; axis++) assert_near(c->normal[k][axis], normal[axis], 0.05);
        }
    }
    assert_true(seen > 6000);
    assert_int_equal(map.crossings[0].layers, 0);
    assert_true(map.crossings[0].depth[0] > 1e30f);
    iso_glass_map_free(&map);
    iso_groups_free(&b.groups);
}

/* A ball in a ball counts as surfaces, but the solid is that of the outer one; balls behind each other are
 * two solids. */
static void test_solids(void **state) {
    (void)state;
    static balls b;
    const iso_view view = test_plain_view(PIXELS, PIXELS, false, 150);
    for (int nested = 0; nested < 2; nested++) {
        memset(&b, 0, sizeof b);
        add_ball(&b, 0, 0, 20, 5);
        add_ball(&b, 0, 0, nested ? 20 : 28, 2);
        iso_glass_map map = make_map(&b, &view, ISO_TRANSPARENCY_SORTED, NULL),
                      counted = make_map(&b, &view, ISO_TRANSPARENCY_NEAREST, NULL);
        const iso_glass_crossings *c = middle_of(&map), *n = middle_of(&counted);
        assert_int_equal(c->layers, 4);
        assert_near(c->thickness, nested ? 10 : 14, 0.1);
        assert_near(c->depth[0], 15, 0.05);
        assert_near(c->depth[1], 25, 0.05);
        assert_near(c->normal[1][2], 1, 0.01);
        assert_int_equal(n->layers, 4); /* by the opacity that groups accumulate */
        assert_near(n->depth[0], 15, 0.05);
        assert_near(n->normal[0][2], -1, 0.01);
        assert_true(n->thickness == 0 && n->depth[1] > 1e30f);
        size_t differ = 0, shown = 0;
        for (int i = 0; i < PIXELS * PIXELS; i++) {
            shown += map.crossings[i].layers > 0;
            differ += map.crossings[i].layers != counted.crossings[i].layers;
        }
        if (differ * 10 > shown) fail_msg("%zu of %zu pixels have other numbers of layers", differ, shown);
        iso_glass_map_free(&map);
        iso_glass_map_free(&counted);
        iso_groups_free(&b.groups);
    }
}

/* A sheet seen from behind bends rays as its front does. */
static void test_far_sides(void **state) {
    (void)state;
    static balls b;
    memset(&b, 0, sizeof b);
    add_ball(&b, 0, 0, 20, 5);
    uint32_t kept = 0; /* all have the same radius */
    for (int i = 0; i < BALL; i++)
        if (b.surfels[i].normal[2] > 0) b.surfels[kept++] = b.surfels[i];
    b.span.count = kept;
    const iso_view view = test_plain_view(PIXELS, PIXELS, false, 150);
    iso_glass_map map = make_map(&b, &view, ISO_TRANSPARENCY_SORTED, NULL);
    const iso_glass_crossings *c = middle_of(&map);
    assert_int_equal(c->layers, 1);
    assert_near(c->depth[0], 25, 0.05);
    assert_true(c->thickness == 0 && c->depth[1] > 1e30f);
    iso_glass_map_free(&map);
    iso_groups_free(&b.groups);
}

static void test_threads(void **state) {
    (void)state;
    static balls b;
    memset(&b, 0, sizeof b);
    add_ball(&b, 0, 0, 20, 5);
    add_ball(&b, 1, 0, 22, 4);
    const iso_view view = test_plain_view(PIXELS, PIXELS, false, 150);
    iso_pool *pool = NULL;
    assert_int_equal(iso_pool_create(5, &pool, NULL), ISO_OK);
    for (int how = 0; how < 2; how++) {
        const iso_transparency transparency = how ? ISO_TRANSPARENCY_NEAREST : ISO_TRANSPARENCY_SORTED;
        iso_glass_map one = make_map(&b, &view, transparency, NULL),
                      five = make_map(&b, &view, transparency, pool);
        assert_memory_equal(one.crossings, five.crossings, PIXELS * PIXELS * sizeof *one.crossings);
        iso_glass_map_free(&one);
        iso_glass_map_free(&five);
    }
    iso_pool_destroy(pool);
    iso_groups_free(&b.groups);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_ball), cmocka_unit_test(test_solids),
                                       cmocka_unit_test(test_far_sides), cmocka_unit_test(test_threads)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
