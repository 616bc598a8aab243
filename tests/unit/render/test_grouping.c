#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/point_cells.h"
#include "extract_support.h"
#include "render/groups/grouping.h"
#include "scene_support.h"

enum { MOST = 6000 };

/* A view of points in floats, with the arrays behind it. */
typedef struct cloud {
    iso_surfel surfels[MOST];
    float radii[MOST];
    iso_point_span span;
    iso_point_view view;
} cloud;

/* Random points in a cube of `side` mm with radii 1 .. `spread`, small ones more often. */
static void make_cloud(cloud *c, uint32_t count, double side, double spread, uint32_t seed) {
    c->span = (iso_point_span){.count = count};
    for (uint32_t i = 0; i < count; i++) {
        const double chance = uniform(&seed);
        for (int k = 0; k < 3; k++) {
            c->surfels[i].position[k] = (float)(side * (uniform(&seed) - 0.5));
            c->surfels[i].normal[k] = (float)(uniform(&seed) - 0.5);
        }
        c->radii[i] = (float)(1 / (1 - chance * (1 - 1 / spread)));
    }
    c->view = (iso_point_view){.surfels = c->surfels,
                               .radii = c->radii,
                               .spans = &c->span,
                               .span_count = 1,
                               .transform = iso_transform_identity()};
}

static iso_groups make_groups(const iso_point_view *view, const iso_groups_opts *opts) {
    iso_error error;
    iso_groups groups;
    test_ok(iso_groups_make(view, opts, &groups, &error), &error);
    return groups;
}

/* The centre of a point in mm, and its radius; false for a point that is left out. */
static bool locate(const iso_point_view *view, const iso_point_span *span, size_t index, iso_vec3 *at,
                   double *radius) {
    const iso_affine affine = iso_transform_affine(&view->transform);
    const iso_surfel surfel = iso_point_view_get(view, index);
    *at = iso_affine_vector(&affine, iso_brick_position(span->brick, surfel.position));
    *radius = view->radii ? (double)view->radii[index] : view->radius;
    return iso_vec3_is_finite(*at) && *radius > 0;
}

/* All points of a view, for comparing every pair. */
typedef struct located {
    iso_vec3 *at;
    double *radius;
    uint8_t *group;
    size_t count;
} located;

static located locate_all(const iso_point_view *view, const iso_groups *groups) {
    const size_t most = iso_point_view_count(view);
    located all = {malloc(most * sizeof *all.at), malloc(most * sizeof *all.radius), malloc(most), 0};
    for (size_t s = 0; s < view->span_count; s++)
        for (size_t i = view->spans[s].first; i < view->spans[s].first + view->spans[s].count; i++)
            if (locate(view, &view->spans[s], i, &all.at[all.count], &all.radius[all.count]))
                all.group[all.count++] = groups->group[i];
    return all;
}

static void free_located(located *all) {
    free(all->at);
    free(all->radius);
    free(all->group);
}

/* Counts, over every pair of points, what iso_groups says; pairs whose distance is within rounding of the
 * limit are counted in `doubtful`. */
static void compare_with_all_pairs(const iso_point_view *view, const iso_groups *groups, double factor) {
    located all = locate_all(view, groups);
    size_t joined = 0, conflicts = 0, doubtful = 0;
    for (size_t i = 0; i < all.count; i++)
        for (size_t j = 0; j < i; j++) {
            const double distance = iso_vec3_length(iso_vec3_sub(all.at[i], all.at[j])),
                         reach = factor * (all.radius[i] + all.radius[j]);
            if (fabs(distance - reach) < 1e-5 * reach) doubtful++;
            if (!(distance < reach)) continue;
            joined++;
            conflicts += all.group[i] == all.group[j];
        }
    near((double)groups->joined, (double)joined, (double)doubtful);
    near((double)groups->conflicts, (double)conflicts, (double)doubtful);
    assert_true(joined > all.count / 4);
    assert_true(doubtful < 1 + joined / 1000);
    free_located(&all);
}

static void test_no_conflict(void **state) {
    (void)state;
    static cloud c;
    const double spreads[] = {1, 3, 40, 1000}, sides[] = {40, 50, 120, 260};
    for (size_t k = 0; k < 4; k++) {
        make_cloud(&c, 3000, sides[k], spreads[k], 7 + (uint32_t)k);
        iso_groups groups = make_groups(&c.view, &(iso_groups_opts){.disc = 1.2});
        assert_int_equal(groups.conflicts, 0);
        compare_with_all_pairs(&c.view, &groups, 1.2);
        for (uint32_t i = 0; i < c.span.count; i++) assert_true(groups.group[i] < groups.count);
        iso_groups_free(&groups);
    }
}

static int has_most_neighbours(const void *a, const void *b) {
    const uint32_t *x = a, *y = b; /* neighbours, point */
    return x[0] != y[0] ? (x[0] < y[0]) - (x[0] > y[0]) : (x[1] > y[1]) - (x[1] < y[1]);
}

/* The groups of the paper's colouring (Largest First), over every pair of points: those with the most
 * neighbours come first, and get the smallest free number. */
static int count_largest_first(const iso_point_view *view, const iso_groups *groups, double factor) {
    located all = locate_all(view, groups);
    uint32_t(*order)[2] = malloc(all.count * sizeof *order);
    int count = 0;
    for (size_t i = 0; i < all.count; i++) {
        order[i][0] = 0;
        order[i][1] = (uint32_t)i;
        all.group[i] = ISO_GROUPS_MOST;
        for (size_t j = 0; j < all.count; j++)
            order[i][0] += iso_vec3_length(iso_vec3_sub(all.at[i], all.at[j])) <
                           factor * (all.radius[i] + all.radius[j]);
    }
    qsort(order, all.count, sizeof *order, has_most_neighbours);
    for (size_t k = 0; k < all.count; k++) {
        const uint32_t i = order[k][1];
        bool taken[ISO_GROUPS_MOST + 1] = {false};
        int group = 0;
        for (size_t j = 0; j < all.count; j++)
            if (iso_vec3_length(iso_vec3_sub(all.at[i], all.at[j])) <
                factor * (all.radius[i] + all.radius[j]))
                taken[all.group[j]] = true;
        while (taken[group]) group++;
        all.group[i] = (uint8_t)group;
        count = group >= count ? group + 1 : count;
    }
    free(order);
    free_located(&all);
    return count;
}

/* Points are coloured cell by cell; in the order of the paper the groups are as few within 3. */
static void test_largest_first(void **state) {
    (void)state;
    const char *const scenes[] = {"sphere", "gyroid", "head"};
    for (int k = 0; k < 3; k++)
        for (int tenths = 4; tenths <= 10; tenths += 3) {
            test_scene scene = test_scene_make(scenes[k], 24, NULL, false);
            iso_groups groups =
                make_groups(&scene.points, &(iso_groups_opts){.disc = 1.35, .overlap = tenths / 10.0});
            const int paper = count_largest_first(&scene.points, &groups, 1.35 * tenths / 10);
            print_message("%s, c = %.1f: %d groups, largest first %d\n", scenes[k], tenths / 10.0,
                          groups.count, paper);
            assert_in_range(groups.count, paper - 3, paper + 3);
            iso_groups_free(&groups);
            test_scene_free(&scene);
        }
}

static void test_no_conflict_in_a_scene(void **state) {
    (void)state;
    const char *const scenes[] = {"sphere", "gyroid", "head"};
    for (int k = 0; k < 3; k++) {
        test_scene scene = test_scene_make(scenes[k], 40, NULL, false);
        iso_groups groups = make_groups(&scene.points, &(iso_groups_opts){.disc = 1.35});
        compare_with_all_pairs(&scene.points, &groups, 1.35);
        assert_int_equal(groups.conflicts, 0);
        assert_in_range(groups.count, 10, 22);
        iso_groups_free(&groups);
        test_scene_free(&scene);
    }
}

/* c and a limit of groups: fewer groups, and as many conflicts as are told. */
static void test_limits(void **state) {
    (void)state;
    static cloud c;
    make_cloud(&c, 3000, 40, 4, 3);
    iso_groups whole = make_groups(&c.view, &(iso_groups_opts){0}),
               relaxed = make_groups(&c.view, &(iso_groups_opts){.overlap = 0.6}),
               four = make_groups(&c.view, &(iso_groups_opts){.limit = 4}),
               by_number = make_groups(&c.view, &(iso_groups_opts){.limit = 4, .by_number = true}),
               one = make_groups(&c.view, &(iso_groups_opts){.limit = 1});
    compare_with_all_pairs(&c.view, &relaxed, 0.6);
    compare_with_all_pairs(&c.view, &four, 1);
    compare_with_all_pairs(&c.view, &one, 1);
    assert_true(relaxed.count < whole.count);
    assert_int_equal(four.count, 4);
    assert_int_equal(one.count, 1);
    assert_true(one.conflicts == one.joined);
    assert_true(four.conflicts > 0 && four.conflicts < one.conflicts / 4);
    compare_with_all_pairs(&c.view, &by_number, 1);
    assert_true(by_number.conflicts < four.conflicts);
    iso_groups *all[] = {&whole, &relaxed, &four, &by_number, &one};
    for (int k = 0; k < 5; k++) iso_groups_free(all[k]);
}

static void test_opposite_normals(void **state) {
    (void)state;
    static cloud c;
    make_cloud(&c, 2000, 30, 1, 5);
    iso_groups with = make_groups(&c.view, &(iso_groups_opts){0}),
               without = make_groups(&c.view, &(iso_groups_opts){.ignore_opposite = true});
    size_t joined = 0;
    for (uint32_t i = 0; i < c.span.count; i++)
        for (uint32_t j = 0; j < i; j++) {
            double square = 0, cosine = 0;
            for (int k = 0; k < 3; k++) {
                const double d = (double)c.surfels[i].position[k] - (double)c.surfels[j].position[k];
                square += d * d;
                cosine += (double)c.surfels[i].normal[k] * (double)c.surfels[j].normal[k];
            }
            joined += square < 4 && cosine >= 0;
        }
    near((double)without.joined, (double)joined, 2);
    assert_true(without.joined < with.joined && without.conflicts == 0);
    iso_groups_free(&with);
    iso_groups_free(&without);
}

/* Rule 1: overlapping points of a plane share a group unless they are tilted, displaced or coloured. */
static void test_coplanar(void **state) {
    (void)state;
    static cloud c;
    static uint8_t colors[MOST][3];
    const iso_groups_opts coplanar = {.coplanar = 5}, all = {.coplanar = 0};
    for (int what = 0; what < 5; what++) {
        make_cloud(&c, 2, 1, 1, 3);
        for (int i = 0; i < 2; i++)
            c.surfels[i] = (iso_surfel){.position = {(float)i, 0, 0}, .normal = {0, 0, 1}};
        if (what == 1) c.surfels[1].normal[0] = 0.2f;   /* by 11 degrees */
        if (what == 2) c.surfels[1].position[2] = 0.2f; /* out of the plane */
        if (what == 3) c.surfels[1].normal[2] = -1;
        memset(colors, 0, sizeof colors);
        colors[1][2] = 9;
        if (what == 4) c.view.colors = (const uint8_t(*)[3])colors;
        iso_groups without = make_groups(&c.view, &all), with = make_groups(&c.view, &coplanar);
        assert_int_equal(without.count, 2);
        assert_int_equal(with.count, what == 0 ? 1 : 2);
        assert_int_equal(with.joined, what == 0 ? 0 : 1);
        iso_groups_free(&without);
        iso_groups_free(&with);
    }
}

static void test_threads(void **state) {
    (void)state;
    static cloud c;
    make_cloud(&c, MOST, 60, 30, 11);
    iso_groups one = make_groups(&c.view, &(iso_groups_opts){.limit = 6});
    for (int threads = 2; threads < 8; threads += 3) {
        iso_pool *pool;
        assert_int_equal(iso_pool_create(threads, &pool, NULL), ISO_OK);
        iso_groups several = make_groups(&c.view, &(iso_groups_opts){.limit = 6, .pool = pool});
        assert_memory_equal(one.group, several.group, MOST);
        assert_int_equal(one.conflicts, several.conflicts);
        iso_groups_free(&several);
        iso_pool_destroy(pool);
    }
    iso_groups_free(&one);
}

/* Updates groups, fails the test unless they are those of coloring everything, and returns how many points
 * were colored again. */
static size_t follow(iso_groups *groups, const iso_point_view *view, const iso_groups_opts *opts) {
    iso_error error;
    test_ok(iso_groups_update(view, opts, groups, &error), &error);
    iso_groups whole = make_groups(view, opts);
    for (size_t s = 0; s < view->span_count; s++)
        assert_memory_equal(groups->group + view->spans[s].first, whole.group + view->spans[s].first,
                            view->spans[s].count);
    assert_int_equal(groups->count, whole.count);
    assert_int_equal(groups->joined, whole.joined);
    assert_int_equal(groups->conflicts, whole.conflicts);
    const size_t computed = groups->computed;
    assert_true(computed <= whole.computed);
    iso_groups_free(&whole);
    return computed;
}

/* Changes a few points of a cloud near a random place: moves them, changes their radii, moves them to other
 * indices, removes one or adds one. */
static void edit_cloud(cloud *c, uint32_t *seed) {
    const uint32_t center = (uint32_t)(uniform(seed) * c->span.count);
    const double chance = uniform(seed);
    const iso_surfel at = c->surfels[center];
    for (uint32_t i = 0; i < c->span.count; i++) {
        double square = 0;
        for (int k = 0; k < 3; k++)
            square += pow((double)c->surfels[i].position[k] - (double)at.position[k], 2);
        if (square > 9) continue;
        if (chance < 0.4) c->surfels[i].position[i % 3] += 0.3f;
        if (chance > 0.3 && chance < 0.6) c->radii[i] *= 1.2f;
    }
    const uint32_t last = c->span.count - 1;
    if (chance >= 0.6 && chance < 0.8) {
        c->surfels[center] = c->surfels[last];
        c->radii[center] = c->radii[last];
        c->span.count = last;
    } else if (chance >= 0.8 && c->span.count < MOST) {
        c->surfels[c->span.count] = at;
        c->radii[c->span.count] = 1;
        c->surfels[c->span.count++].position[0] += 0.5f;
    }
}

static void test_updates(void **state) {
    (void)state;
    static cloud c;
    iso_pool *pool;
    assert_int_equal(iso_pool_create(3, &pool, NULL), ISO_OK);
    const double spreads[] = {1, 1, 3, 40}, sides[] = {120, 90, 150, 300};
    for (uint32_t k = 0; k < 4; k++) {
        uint32_t seed = 41 + k;
        const iso_groups_opts opts = {
            .disc = 1.35, .limit = k % 2 ? 8 : 0, .by_number = k == 3, .pool = k % 2 ? pool : NULL};
        iso_groups groups = {0};
        size_t computed = 0;
        make_cloud(&c, MOST - 10, sides[k], spreads[k], 37 + k);
        assert_int_equal(follow(&groups, &c.view, &opts), c.span.count);
        assert_int_equal(follow(&groups, &c.view, &opts), 0);
        for (int edit = 0; edit < 60; edit++) {
            edit_cloud(&c, &seed);
            computed += follow(&groups, &c.view, &opts);
        }
        print_message("spread %g: an edit colors %.0f of %u points again\n", spreads[k], computed / 60.0,
                      c.span.count);
        assert_true(computed > 60);
        if (k == 0) assert_true(computed < 60 * c.span.count / 2);
        iso_groups_free(&groups);
    }
    iso_pool_destroy(pool);
}

/* Other options, a surface that grows by far, and no points at all: everything is colored again. */
static void test_updates_of_everything(void **state) {
    (void)state;
    static cloud c;
    make_cloud(&c, 3000, 60, 2, 43);
    iso_groups groups = {0};
    follow(&groups, &c.view, &(iso_groups_opts){0});
    assert_int_equal(follow(&groups, &c.view, &(iso_groups_opts){.limit = 5}), 3000);
    assert_int_equal(follow(&groups, &c.view, &(iso_groups_opts){.limit = 5, .by_number = true}), 3000);
    assert_true(follow(&groups, &c.view, &(iso_groups_opts){.disc = 1.1, .limit = 5}) > 2900);
    const iso_groups_opts opposite = {.ignore_opposite = true}, coplanar = {.coplanar = 30};
    follow(&groups, &c.view, &coplanar);
    follow(&groups, &c.view, &opposite);
    for (int i = 0; i < 3000; i += 7)
        for (int k = 0; k < 3; k++) c.surfels[i].normal[k] *= -1;
    follow(&groups, &c.view, &opposite);
    follow(&groups, &c.view, &(iso_groups_opts){0});
    c.surfels[17].position[1] = -500;
    follow(&groups, &c.view, &(iso_groups_opts){0});
    c.surfels[17].position[1] = NAN;
    follow(&groups, &c.view, &(iso_groups_opts){0});
    c.span.count = 0;
    assert_int_equal(follow(&groups, &c.view, &(iso_groups_opts){0}), 0);
    c.span.count = 100;
    assert_int_equal(follow(&groups, &c.view, &(iso_groups_opts){0}), 99);
    iso_groups_free(&groups);
}

/* Random strokes on the grids of scenes: the points of other bricks keep their groups. */
static void test_updates_of_a_grid(void **state) {
    (void)state;
    test_random random = {47};
    for (int dense = 0; dense < 2; dense++) {
        iso_grid grid = test_ball_grid(100, iso_vec3_make(50, 50, 50), 40, dense);
        const iso_points_opts of_points = {.curvature = true};
        iso_point_set *set = test_point_set(&grid, &of_points);
        iso_groups groups = {0};
        size_t computed = 0, all = 0;
        for (int edit = 0; edit < 40; edit++) {
            if (edit) test_random_edit(&grid, &random);
            assert_int_equal(iso_point_set_update(set, NULL), ISO_OK);
            const iso_point_view view = iso_point_set_view(set);
            const size_t again = follow(&groups, &view, &(iso_groups_opts){.disc = 1.35, .limit = 8});
            computed += edit ? again : 0;
            all += edit ? iso_point_view_count(&view) : 0;
        }
        print_message("%.1f %% of the points are colored again\n", 100.0 * (double)computed / (double)all);
        assert_true(computed > 0 && computed < all / 4);
        iso_groups_free(&groups);
        iso_point_set_destroy(set);
        iso_grid_destroy(&grid);
    }
}

/* A changed point changes groups around it only: within 8 blocks of 8 cells, each two radii wide. */
static void test_locality(void **state) {
    (void)state;
    static cloud c;
    const float near_by = 8 * 8 * 2;
    make_cloud(&c, MOST, 100, 1, 13);
    for (uint32_t i = 0; i < MOST; i++) { /* along a rod, so that much of it is farther away */
        c.surfels[i].position[0] *= 20;
        for (int k = 1; k < 3; k++) c.surfels[i].position[k] *= 0.06f;
    }
    iso_groups before = make_groups(&c.view, &(iso_groups_opts){0});
    size_t near_count = 0;
    for (uint32_t i = 0; i < MOST; i++)
        if (fabsf(c.surfels[i].position[0]) < 3) c.surfels[i].position[1] += 0.5f, near_count++;
    iso_groups after = make_groups(&c.view, &(iso_groups_opts){0});
    size_t changed = 0;
    for (uint32_t i = 0; i < MOST; i++) {
        changed += before.group[i] != after.group[i];
        if (fabsf(c.surfels[i].position[0]) > 3 + near_by) assert_int_equal(before.group[i], after.group[i]);
    }
    assert_true(near_count > 5 && changed > 0);
    iso_groups_free(&before);
    iso_groups_free(&after);
}

static void test_unusable_points(void **state) {
    (void)state;
    static cloud c;
    make_cloud(&c, 500, 20, 2, 17);
    c.surfels[3].position[1] = NAN;
    c.surfels[4].position[2] = INFINITY;
    c.radii[5] = 0;
    c.radii[6] = -1;
    c.radii[7] = NAN;
    iso_groups groups = make_groups(&c.view, &(iso_groups_opts){0});
    compare_with_all_pairs(&c.view, &groups, 1);
    for (int i = 3; i < 8; i++) assert_int_equal(groups.group[i], 0);
    iso_groups_free(&groups);
    c.span.count = 0;
    groups = make_groups(&c.view, &(iso_groups_opts){0});
    assert_int_equal(groups.count, 0);
    iso_groups_free(&groups);
    make_cloud(&c, 200, 0, 1, 19); /* all in one place: as many groups as there are */
    groups = make_groups(&c.view, &(iso_groups_opts){0});
    assert_int_equal(groups.count, ISO_GROUPS_MOST);
    compare_with_all_pairs(&c.view, &groups, 1);
    iso_groups_free(&groups);
    make_cloud(&c, 300, 8, 1, 23); /* far away from each other and from the origin, relative to their size */
    for (int i = 0; i < 300; i++) c.surfels[i].position[0] += i % 2 ? 1e7f : -3e7f;
    groups = make_groups(&c.view, &(iso_groups_opts){0});
    assert_int_equal(groups.conflicts, 0);
    iso_groups_free(&groups);
}

/* A few points far away do not put all others into one cell, which would take minutes; and points that all
 * overlap are looked at in part. */
static void test_outliers(void **state) {
    (void)state;
    static cloud c;
    make_cloud(&c, 3000, 10, 1, 29);
    for (int i = 0; i < 3000; i++) c.radii[i] = 0.2f;
    for (int i = 0; i < 5; i++) c.surfels[i].position[0] = i < 3 ? 1e6f : -3e6f;
    for (int k = 1; k < 3; k++) c.surfels[1].position[k] = c.surfels[0].position[k];
    iso_point_cells cells = {0};
    assert_int_equal(iso_point_cells_make(&cells, &c.view, 1, NULL), ISO_OK);
    assert_true(cells.cell_count > 2000);
    iso_point_cells_free(&cells);
    iso_groups groups = make_groups(&c.view, &(iso_groups_opts){0});
    compare_with_all_pairs(&c.view, &groups, 1);
    assert_int_equal(groups.conflicts, 0);
    assert_true(groups.group[0] != groups.group[1]);
    iso_groups_free(&groups);
    make_cloud(&c, MOST, 0, 1, 31);
    groups = make_groups(&c.view, &(iso_groups_opts){.limit = 4});
    assert_int_equal(groups.count, 4);
    assert_true(groups.joined < (size_t)MOST * 4096);
    iso_groups_free(&groups);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_no_conflict),       cmocka_unit_test(test_no_conflict_in_a_scene),
        cmocka_unit_test(test_largest_first),     cmocka_unit_test(test_limits),
        cmocka_unit_test(test_opposite_normals),  cmocka_unit_test(test_coplanar),
        cmocka_unit_test(test_threads),           cmocka_unit_test(test_locality),
        cmocka_unit_test(test_unusable_points),   cmocka_unit_test(test_outliers),
        cmocka_unit_test(test_updates),           cmocka_unit_test(test_updates_of_everything),
        cmocka_unit_test(test_updates_of_a_grid),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
