/* The factors that make groups of discs cover a surface, against areas counted on a fine grid. */
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "render/groups/copies.h"
#include "render/groups/coverage.h"
#include "scene_support.h"

enum { COUNT = 20000, GRID = 900 };
#define SIDE 100.0 /* mm */
#define DISC 1.35

typedef struct plane {
    iso_surfel surfels[COUNT];
    float radii[COUNT];
    iso_point_span span;
    iso_point_view view;
    iso_groups groups;
} plane;

/* Random points in the plane z = 0; `spread`: how many times larger the largest radius is. */
static void make_plane(plane *p, uint32_t count, double spread, int limit) {
    uint32_t seed = 3;
    p->span = (iso_point_span){.count = count};
    for (uint32_t i = 0; i < count; i++) {
        p->surfels[i] = (iso_surfel){.normal = {0, 0, 1}};
        for (int k = 0; k < 2; k++) p->surfels[i].position[k] = (float)(SIDE * (uniform(&seed) - 0.5));
        p->radii[i] = (float)(SIDE / sqrt(count) / (1 - uniform(&seed) * (1 - 1 / spread)));
    }
    p->view = (iso_point_view){.surfels = p->surfels,
                               .radii = p->radii,
                               .spans = &p->span,
                               .span_count = 1,
                               .transform = iso_transform_identity()};
    const iso_groups_opts opts = {.disc = DISC, .limit = limit, .by_number = true};
    assert_int_equal(iso_groups_make(&p->view, &opts, &p->groups, NULL), ISO_OK);
}

static void cover(plane *p, iso_pool *pool) {
    assert_int_equal(iso_groups_cover(&p->view, DISC, pool, &p->groups, NULL), ISO_OK);
}

/* Counts the places of a grid that a group's discs cover, enlarged by a factor; group -1: all groups. */
static size_t count_covered(const plane *p, int group, double factor) {
    static bool covered[GRID][GRID];
    const double step = 1.4 * SIDE / GRID; /* with room around the points for discs that stick out */
    size_t count = 0;
    memset(covered, 0, sizeof covered);
    for (uint32_t i = 0; i < p->span.count; i++) {
        if (group >= 0 && p->groups.group[i] != group &&
            !(p->groups.copies && p->groups.copies[i] >> group & 1))
            continue;
        const double radius = factor * DISC * (double)p->radii[i],
                     x = (double)p->surfels[i].position[0] / step,
                     y = (double)p->surfels[i].position[1] / step, r = radius / step;
        for (int gy = (int)(y - r + GRID / 2); gy <= (int)(y + r + GRID / 2); gy++)
            for (int gx = (int)(x - r + GRID / 2); gx <= (int)(x + r + GRID / 2); gx++) {
                if (gx < 0 || gy < 0 || gx >= GRID || gy >= GRID) continue;
                const double dx = gx - GRID / 2 - x, dy = gy - GRID / 2 - y;
                if (dx * dx + dy * dy < r * r) covered[gy][gx] = true;
            }
    }
    for (int y = 0; y < GRID; y++)
        for (int x = 0; x < GRID; x++) count += covered[y][x];
    return count;
}

static void test_areas(void **state) {
    (void)state;
    static plane p;
    const double spreads[] = {1, 2, 4};
    for (int s = 0; s < 3; s++)
        for (int limit = 2; limit <= 8; limit *= 2) {
            make_plane(&p, COUNT, spreads[s], limit);
            cover(&p, NULL);
            const double all = (double)count_covered(&p, -1, 1);
            for (int k = 0; k < p.groups.count; k++) {
                const double factor = (double)p.groups.widening[k],
                             share = (double)count_covered(&p, k, factor) / all;
                assert_true(factor >= 1 && factor <= ISO_COVERAGE_MOST);
                if (factor > 1 && factor < ISO_COVERAGE_MOST) near(share, 0.97, 0.03);
                if (factor == 1) assert_true(share > 0.95);
                if (factor == ISO_COVERAGE_MOST) assert_true(share < 0.99);
            }
            iso_groups_free(&p.groups);
        }
}

/* One group needs no enlarging; threads do not change the factors. */
static void test_threads(void **state) {
    (void)state;
    static plane p;
    iso_pool *pool;
    assert_int_equal(iso_pool_create(3, &pool, NULL), ISO_OK);
    for (int limit = 1; limit < 10; limit += 4) {
        float factors[ISO_GROUPS_MOST];
        make_plane(&p, 3000, 4, limit);
        cover(&p, NULL);
        memcpy(factors, p.groups.widening, sizeof factors);
        cover(&p, pool);
        assert_memory_equal(factors, p.groups.widening, sizeof factors);
        if (limit == 1) assert_true(factors[0] == 1);
        iso_groups_free(&p.groups);
    }
    iso_pool_destroy(pool);
}

/* No points; points that are left out; all points in one place, with normals of both sides and of length 0.
 */
static void test_unusual(void **state) {
    (void)state;
    static plane p;
    make_plane(&p, 0, 1, 4);
    cover(&p, NULL);
    iso_groups_free(&p.groups);
    make_plane(&p, 400, 1, 4);
    for (int i = 0; i < 400; i++) p.radii[i] = i % 3 ? NAN : 0;
    cover(&p, NULL);
    iso_groups_free(&p.groups);
    make_plane(&p, 5000, 1, 4);
    for (int i = 0; i < 5000; i++) {
        p.surfels[i].position[0] = p.surfels[i].position[1] = 0;
        p.surfels[i].normal[2] = (float)(i % 3 - 1);
    }
    cover(&p, NULL);
    for (int k = 0; k < p.groups.count; k++) assert_in_range(p.groups.widening[k] * 1000, 1000, 3000);
    iso_groups_free(&p.groups);
}

/* With copies each group covers nearly what all discs do, without larger discs; their number stays small,
 * none is a copy in its own group, and threads do not change them. */
static void test_copies(void **state) {
    (void)state;
    static plane p;
    iso_pool *pool;
    assert_int_equal(iso_pool_create(3, &pool, NULL), ISO_OK);
    for (int s = 0; s < 2; s++) {
        make_plane(&p, 8000, s ? 4 : 1, 4);
        size_t alone[4];
        const double all = (double)count_covered(&p, -1, 1);
        for (int k = 0; k < 4; k++) alone[k] = count_covered(&p, k, 1);
        assert_int_equal(iso_groups_copy(&p.view, DISC, pool, &p.groups, NULL), ISO_OK);
        for (int k = 0; k < 4; k++) {
            const double share = (double)count_covered(&p, k, 1) / all;
            print_message("group %d covers %.3f, with copies %.3f\n", k, (double)alone[k] / all, share);
            assert_true(share > 0.97 && share > (double)alone[k] / all);
        }
        assert_in_range(p.groups.copy_count, 1, 2 * 8000);
        for (int i = 0; i < 8000; i++) assert_false(p.groups.copies[i] >> p.groups.group[i] & 1);
        uint64_t *copies = p.groups.copies;
        p.groups.copies = NULL;
        assert_int_equal(iso_groups_copy(&p.view, DISC, NULL, &p.groups, NULL), ISO_OK);
        assert_memory_equal(copies, p.groups.copies, 8000 * sizeof *copies);
        iso_free(copies);
        iso_groups_free(&p.groups);
    }
    iso_pool_destroy(pool);
}

/* Many points in one place, facing both ways or not at all, and points that are left out. */
static void test_unusual_copies(void **state) {
    (void)state;
    static plane p;
    make_plane(&p, 5000, 1, 4);
    for (int i = 0; i < 5000; i++) {
        p.surfels[i].position[0] = p.surfels[i].position[1] = 0;
        p.surfels[i].normal[2] = (float)(i % 3 - 1);
        if (i % 7 == 0) p.radii[i] = i % 2 ? NAN : 0;
    }
    assert_int_equal(iso_groups_copy(&p.view, DISC, NULL, &p.groups, NULL), ISO_OK);
    iso_groups_free(&p.groups);
    make_plane(&p, 0, 1, 4);
    assert_int_equal(iso_groups_copy(&p.view, DISC, NULL, &p.groups, NULL), ISO_OK);
    assert_int_equal(p.groups.copy_count, 0);
    iso_groups_free(&p.groups);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_areas), cmocka_unit_test(test_threads),
                                       cmocka_unit_test(test_unusual), cmocka_unit_test(test_copies),
                                       cmocka_unit_test(test_unusual_copies)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
