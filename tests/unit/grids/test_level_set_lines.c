/* level sets of lines: against the least distance to many balls along every segment. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "check_support.h"
#include "extract_support.h"
#include "grids/level_set.h"

enum { LINES = 6, VERTICES = 5, BALLS = 1200 };

typedef struct tubes {
    float vertices[LINES * VERTICES][3], radii[LINES * VERTICES];
    size_t starts[LINES + 1];
    iso_lines lines;
} tubes;

/* Random lines; in each one segment whose first ball holds the second, and two vertices at one place. */
static void make_tubes(tubes *t, test_random *random) {
    for (int i = 0; i < LINES * VERTICES; i++) {
        for (int k = 0; k < 3; k++) t->vertices[i][k] = (float)test_random_real(random, 0, 40);
        t->radii[i] = (float)test_random_real(random, 1, 5);
        if (i % VERTICES == 2) {
            for (int k = 0; k < 3; k++) t->vertices[i][k] = t->vertices[i - 1][k] + 0.3f;
            t->radii[i] = fmaxf(t->radii[i - 1] / 3, 0.9f);
        }
        if (i % VERTICES == 4) memcpy(t->vertices[i], t->vertices[i - 1], sizeof t->vertices[i]);
    }
    for (int i = 0; i <= LINES; i++) t->starts[i] = (size_t)(i * VERTICES);
    t->lines = (iso_lines){.origin = {1000, -50, 3},
                           .vertices = t->vertices,
                           .starts = t->starts,
                           .vertex_count = LINES * VERTICES,
                           .line_count = LINES,
                           .radii = t->radii};
}

/* The distance to balls along all segments, mm. */
static double distance_to_balls(const tubes *t, const double p[3], double least_radius) {
    double least = INFINITY;
    for (int line = 0; line < LINES; line++)
        for (int i = line * VERTICES; i < (line + 1) * VERTICES - 1; i++)
            for (int ball = 0; ball <= BALLS; ball++) {
                const double part = (double)ball / BALLS;
                double square = 0;
                for (int k = 0; k < 3; k++) {
                    const double a = (double)t->vertices[i][k], b = (double)t->vertices[i + 1][k],
                                 d = p[k] - (a + (b - a) * part);
                    square += d * d;
                }
                const double ra = fmax((double)t->radii[i], least_radius),
                             rb = fmax((double)t->radii[i + 1], least_radius);
                least = fmin(least, sqrt(square) - (ra + (rb - ra) * part));
            }
    return least;
}

static iso_hgrid *convert(const tubes *t, double voxel, iso_pool *pool, size_t *widened) {
    const iso_sampling sampling = {.voxel = voxel, .margin = 4, .pool = pool};
    iso_hgrid *grid = NULL;
    iso_error error = {0};
    test_ok(iso_level_set_from_lines("lines", &t->lines, 1, &sampling, &grid, widened, &error), &error);
    return grid;
}

static void distances_are_those_of_balls(void **state) {
    (void)state;
    static tubes t;
    test_random random = {5};
    for (int round = 0; round < 3; round++) {
        const double voxel = round == 2 ? 3 : 0.8; /* 3 mm: some radii are below a voxel */
        size_t widened, checked = 0;
        make_tubes(&t, &random);
        iso_hgrid *grid = convert(&t, voxel, NULL, &widened);
        assert_int_equal(widened > 0, round == 2);
        for (int i = 0; i < 2000; i++) {
            int at[3];
            double p[3];
            const double lines[3] = {t.lines.origin.x, t.lines.origin.y, t.lines.origin.z};
            for (int k = 0; k < 3; k++) {
                at[k] = test_random_int(&random, 0, grid->dims[k] - 1);
                p[k] = grid->transform.origin[k] + voxel * at[k] - lines[k];
            }
            const double got = (double)iso_hgrid_at(grid, at[0], at[1], at[2]);
            const double wanted = fmin(fmax(distance_to_balls(&t, p, voxel) / voxel, -3), 3);
            assert_true(fabs(got - wanted) < 2e-3); /* balls between the 1200 of a segment are missing */
            checked += fabs(wanted) < 3;
        }
        assert_true(checked > 150);
        iso_hgrid_destroy(grid);
    }
}

static void threads_give_the_same_values(void **state) {
    (void)state;
    static tubes t;
    test_random random = {9};
    iso_pool *pool;
    iso_error error = {0};
    test_ok(iso_pool_create(3, &pool, &error), &error);
    make_tubes(&t, &random);
    iso_hgrid *one = convert(&t, 0.7, NULL, NULL), *three = convert(&t, 0.7, pool, NULL);
    for (int z = 0; z < one->dims[2]; z++)
        for (int y = 0; y < one->dims[1]; y++)
            for (int x = 0; x < one->dims[0]; x++)
                assert_true(iso_hgrid_at(one, x, y, z) == iso_hgrid_at(three, x, y, z));
    iso_hgrid_destroy(one);
    iso_hgrid_destroy(three);
    iso_pool_destroy(pool);
}

static void what_cannot_be_converted_is_refused(void **state) {
    (void)state;
    static tubes t;
    test_random random = {2};
    iso_hgrid *grid = NULL;
    make_tubes(&t, &random);
    iso_sampling sampling = {.voxel = 0, .margin = 4};
    assert_int_equal(iso_level_set_from_lines("lines", &t.lines, 1, &sampling, &grid, NULL, NULL),
                     ISO_ERR_USAGE);
    sampling.voxel = 1e-3;
    assert_int_equal(iso_level_set_from_lines("lines", &t.lines, 1, &sampling, &grid, NULL, NULL),
                     ISO_ERR_LIMIT);
    sampling.voxel = 1;
    const iso_lines none = {.line_count = 0};
    assert_int_equal(iso_level_set_from_lines("lines", &none, 1, &sampling, &grid, NULL, NULL),
                     ISO_ERR_EMPTY);
    assert_null(grid);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(distances_are_those_of_balls),
        cmocka_unit_test(threads_give_the_same_values),
        cmocka_unit_test(what_cannot_be_converted_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
