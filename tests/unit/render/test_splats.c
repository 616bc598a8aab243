#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "render/groups/disc_hits.h"
#include "render/groups/groups.h"
#include "scene_support.h"
#include "splats_reference.h"
#include "truth_support.h"
#include "view_support.h"

enum { MOST = 64, WIDTH = 150, HEIGHT = 120 };

static iso_gbuffer drawn(const iso_view *view, const iso_point_view *points, const iso_draw_groups_opts *opts,
                         iso_pool *pool) {
    iso_error error = {0};
    iso_gbuffer g = test_clear_gbuffer(view->width, view->height, points->colors != NULL);
    const iso_target target = {view, &g, pool, 0, NULL};
    test_ok(iso_draw_groups(&target, points, opts, &error), &error);
    return g;
}

static iso_gbuffer two_passes(const iso_view *view, const iso_point_view *points) {
    iso_gbuffer g = test_clear_gbuffer(view->width, view->height, points->colors != NULL);
    test_draw_two_passes(view, points, &g);
    return g;
}

/* Points in floats with radii and colours, each in a group of its own: then no slot is shared. */
typedef struct cloud {
    iso_surfel surfels[MOST];
    float radii[MOST];
    uint8_t colors[MOST][3], group[MOST];
    iso_point_span span;
    iso_point_view view;
    iso_groups groups;
    iso_draw_groups_opts opts;
} cloud;

static void make_cloud(cloud *c, uint32_t count, double depth, double radius, uint32_t seed) {
    *c = (cloud){.span = {.count = count}, .groups = {.group = c->group, .count = MOST}};
    for (uint32_t i = 0; i < count; i++) {
        for (int k = 0; k < 3; k++) {
            c->surfels[i].position[k] = (float)((uniform(&seed) - 0.5) * 10 + (k == 2 ? depth : 0));
            c->surfels[i].normal[k] = (float)(uniform(&seed) - 0.5);
            c->colors[i][k] = (uint8_t)random_bits(&seed);
        }
        c->radii[i] = (float)(radius * (0.2 + uniform(&seed)));
        c->group[i] = (uint8_t)i;
    }
    c->opts.groups = &c->groups;
    c->view = (iso_point_view){.surfels = c->surfels,
                               .radii = c->radii,
                               .colors = (const uint8_t(*)[3])c->colors,
                               .spans = &c->span,
                               .span_count = 1,
                               .transform = iso_transform_identity()};
}

/* Rounding may decide whether a pixel is covered, or a disc belongs to its layer, in few pixels only. */
static void same_but_for_rounding(const iso_gbuffer *a, const iso_gbuffer *b) {
    size_t covered = 0, different = 0;
    for (size_t i = 0; i < (size_t)a->width * (size_t)a->height; i++) {
        covered += b->surface[i] != ISO_SURFACE_NONE;
        bool same = a->surface[i] == b->surface[i];
        if (same && b->surface[i] != ISO_SURFACE_NONE) {
            same = fabsf(a->depth[i] - b->depth[i]) < 2e-3f * fabsf(b->depth[i]) + 1e-3f;
            for (int k = 0; k < 3; k++) {
                same &= fabsf(a->normal[k][i] - b->normal[k][i]) < 4e-3f;
                same &= abs((int)(a->color[i] >> 8 * k & 255) - (int)(b->color[i] >> 8 * k & 255)) < 2;
            }
        }
        different += !same;
    }
    assert_true(covered > 500);
    if (different > covered / 500) fail_msg("%zu of %zu pixels differ", different, covered);
}

static void test_alone(void **state) {
    (void)state;
    static cloud c;
    const double depths[] = {20, 6, 300, 3}, radii[] = {1, 0.8, 12, 2};
    for (int k = 0; k < 8; k++) {
        const bool orthographic = k >= 4;
        make_cloud(&c, MOST, depths[k % 4], radii[k % 4], 3 + (uint32_t)k);
        iso_view view = test_plain_view(WIDTH, HEIGHT, orthographic, orthographic ? 12 : 150 + 40 * k);
        if (!orthographic) view.near = 1.5;
        iso_gbuffer got = drawn(&view, &c.view, &c.opts, NULL), wanted = two_passes(&view, &c.view);
        same_but_for_rounding(&got, &wanted);
        iso_gbuffer_free(&got);
        iso_gbuffer_free(&wanted);
    }
}

/* A point that is much smaller than a pixel is still seen. */
static void test_small(void **state) {
    (void)state;
    static cloud c;
    for (uint32_t seed = 0; seed < 40; seed++) {
        make_cloud(&c, 1, 20, 1e-4, seed);
        const iso_view view = test_plain_view(WIDTH, HEIGHT, seed % 2, seed % 2 ? 5 : 90);
        iso_gbuffer got = drawn(&view, &c.view, NULL, NULL);
        assert_in_range(test_covered(&got), 1, 4);
        iso_gbuffer_free(&got);
    }
}

/* dB of splats with groups against two passes over a scene. */
static double psnr(const iso_view *view, const iso_point_view *points, const iso_groups_opts *grouping,
                   int bins, const iso_gbuffer *wanted) {
    iso_groups groups;
    iso_error error;
    test_ok(iso_groups_make(points, grouping, &groups, &error), &error);
    const iso_draw_groups_opts opts = {&groups, bins};
    iso_gbuffer got = drawn(view, points, &opts, NULL);
    const double db = test_psnr(view, &got, wanted);
    assert_int_equal(test_covered(&got), test_covered(wanted));
    iso_gbuffer_free(&got);
    iso_groups_free(&groups);
    return db;
}

static void test_groups(void **state) {
    (void)state;
    const char *const scenes[] = {"sphere", "gyroid", "head"};
    for (int k = 0; k < 3; k++) {
        test_scene scene = test_scene_make(scenes[k], 48, NULL, false); /* unbounded: nothing is culled */
        const iso_view view = test_look_at(&scene, 1, 1, k == 1, 300, 300);
        iso_gbuffer wanted = two_passes(&view, &scene.points);
        iso_groups_opts whole = iso_groups_default_opts(NULL), relaxed = whole, eight = whole;
        whole.limit = relaxed.limit = 0;
        relaxed.overlap = 0.4;
        const double db[] = {psnr(&view, &scene.points, &whole, 0, &wanted),
                             psnr(&view, &scene.points, &eight, 0, &wanted),
                             psnr(&view, &scene.points, &relaxed, 0, &wanted),
                             psnr(&view, &scene.points, &whole, 64, &wanted)};
        printf("%s: %.1f dB, 8 groups %.1f, c = 0.4 %.1f, 64 bins %.1f\n", scenes[k], db[0], db[1], db[2],
               db[3]);
        assert_true(db[0] > 50 && db[1] > 44 && db[2] > 33 && db[3] > 30);
        iso_gbuffer_free(&wanted);
        test_scene_free(&scene);
    }
}

/* The same bytes with several threads and in strips. */
static void test_threads_and_strips(void **state) {
    (void)state;
    test_scene scene = test_scene_make("head", 40, NULL, true);
    for (int bins = 0; bins < 200; bins += 150) {
        const iso_draw_groups_opts opts = {NULL, bins};
        const iso_view view = test_look_at(&scene, 2, 3, bins > 0, 130, 110);
        iso_gbuffer wanted = drawn(&view, &scene.points, &opts, NULL);
        assert_true(test_covered(&wanted) > 1000);
        for (int threads = 2; threads < 5; threads++) {
            iso_pool *pool;
            assert_int_equal(iso_pool_create(threads, &pool, NULL), ISO_OK);
            iso_gbuffer got = drawn(&view, &scene.points, &opts, pool);
            test_same_rows(&wanted, 0, &got);
            iso_gbuffer_free(&got);
            iso_pool_destroy(pool);
        }
        for (int y = 0; y < view.height; y += 31) {
            const iso_view rows = iso_view_rows(&view, y, view.height - y < 31 ? view.height - y : 31);
            iso_gbuffer strip = drawn(&rows, &scene.points, &opts, NULL);
            test_same_rows(&wanted, y, &strip);
            iso_gbuffer_free(&strip);
        }
        iso_gbuffer_free(&wanted);
    }
    test_scene_free(&scene);
}

/* Of a closed surface seen from outside, points that face away change nothing but a few pixels of the
 * silhouette; from inside they are what is seen. */
static void test_culling(void **state) {
    (void)state;
    test_scene scene = test_scene_make("sphere", 40, NULL, true);
    assert_true(scene.points.closed);
    iso_view view = test_look_at(&scene, 0, 1, false, 200, 200);
    iso_point_view open = scene.points;
    open.closed = false;
    for (int inside = 0; inside < 2; inside++) {
        iso_gbuffer culled = drawn(&view, &scene.points, NULL, NULL), all = drawn(&view, &open, NULL, NULL);
        if (inside)
            test_same_rows(&all, 0, &culled);
        else
            assert_true(test_psnr(&view, &culled, &all) > 36);
        assert_true(test_covered(&culled) > 13500);
        iso_gbuffer_free(&culled);
        iso_gbuffer_free(&all);
        const iso_affine affine = iso_transform_affine(&open.transform);
        const iso_box box = iso_point_view_bounds(&open);
        view.eye = iso_affine_point(
            &affine, iso_vec3_scale(iso_vec3_add(box.lo, box.hi), 0.5)); /* the middle of the sphere */
    }
    test_scene_free(&scene);
}

static void test_unusable_points(void **state) {
    (void)state;
    static cloud c;
    const iso_view view = test_plain_view(WIDTH, HEIGHT, false, 150);
    make_cloud(&c, 12, 20, 1, 5);
    c.span.count = 8;
    iso_gbuffer wanted = drawn(&view, &c.view, &c.opts, NULL);
    c.span.count = 12;
    c.surfels[8].position[0] = NAN;
    c.surfels[9].position[2] = INFINITY;
    c.radii[10] = NAN;
    c.surfels[11].position[2] = -3;
    iso_gbuffer got = drawn(&view, &c.view, &c.opts, NULL);
    test_same_rows(&wanted, 0, &got);
    iso_gbuffer_free(&got);
    iso_gbuffer_free(&wanted);
    make_cloud(&c, 1, 20, 1, 5);
    memset(c.surfels[0].normal, 0, sizeof c.surfels[0].normal); /* faces the viewer */
    got = drawn(&view, &c.view, &c.opts, NULL);
    assert_true(test_covered(&got) > 50);
    iso_gbuffer_free(&got);
    c.span.count = 0;
    got = drawn(&view, &c.view, NULL, NULL);
    assert_int_equal(test_covered(&got), 0);
    iso_gbuffer_free(&got);
}

/* The next hit that is expected of a disc, pixel by pixel. */
typedef struct expected_hits {
    const iso_banded_discs *discs;
    const iso_disc *disc;
    uint8_t seen[HEIGHT][WIDTH];
    int count;
} expected_hits;

static void check_hits(void *context, const iso_disc_hits *hits, int count) {
    expected_hits *e = context;
    const iso_disc_view *view = &e->discs->view;
    for (int i = 0; i < count; i++) {
        const int x = hits->column[i], y = hits->row[i];
        iso_disc_hit hit;
        assert_true(iso_disc_intersect(view, e->disc, iso_disc_column(view, x), iso_disc_row(view, y), &hit));
        assert_memory_equal(&hits->depth[i], &hit.depth, sizeof hit.depth);
        assert_memory_equal(&hits->e[i], &hit.e, sizeof hit.e);
        assert_int_equal(hits->away[i], hit.away);
        assert_int_equal(e->seen[y][x]++, 0);
    }
    e->count += count;
}

/* Counts the pixels that a disc covers, each by itself. */
static int count_covered(const iso_disc_view *view, const iso_disc *disc) {
    int count = 0;
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH; x++) {
            iso_disc_hit hit;
            count += iso_disc_intersect(view, disc, iso_disc_column(view, x), iso_disc_row(view, y), &hit);
        }
    return count;
}

/* Discs of many sizes, some behind the near plane in part: in vectors, their hits have the bits that
 * single pixels have, at every level. */
static void test_hits(void **state) {
    (void)state;
    static cloud c;
    iso_error error;
    for (int run = 0; run < 12; run++) {
        const iso_view view = test_plain_view(WIDTH, HEIGHT, run % 2, run % 2 ? 5 : 90);
        iso_banded_discs discs = {0};
        int all = 0;
        make_cloud(&c, MOST, run < 6 ? 4 : 40, run < 4 ? 0.05 : run < 8 ? 1 : 8, (uint32_t)run + 1);
        test_ok(iso_banded_discs_project(&discs, &view, &c.view, 1, NULL, &error), &error);
        for (int level = 0; level < ISO_CPU_LEVELS; level++) {
            iso_cpu_limit((iso_cpu_level)level);
            for (uint32_t i = 0; i < MOST; i++) {
                const iso_rows *rows = (const iso_rows *)discs.rows.data + i;
                expected_hits e = {.discs = &discs, .disc = (const iso_disc *)discs.disc.data + i};
                const iso_disc_box picture = {{0, WIDTH - 1}, {0, HEIGHT - 1}};
                if (rows->first > rows->last) continue;
                iso_disc_visit_hits(&discs, e.disc, &picture, check_hits, &e);
                assert_int_equal(e.count, count_covered(&discs.view, e.disc));
                all += e.count;
            }
        }
        iso_cpu_limit(ISO_CPU_AVX512);
        assert_true(all > 0);
        iso_banded_discs_free(&discs);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_alone),   cmocka_unit_test(test_small),
        cmocka_unit_test(test_groups),  cmocka_unit_test(test_threads_and_strips),
        cmocka_unit_test(test_culling), cmocka_unit_test(test_unusable_points),
        cmocka_unit_test(test_hits),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
