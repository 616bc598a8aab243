/* What is measured of solids whose measures geometry knows: volume, area, the nearest places, thickness. */
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>

#include <cmocka.h>

#include "check_support.h"
#include "scene/measure.h"
#include "session_support.h"

static double random_between(uint32_t *seed, double low, double high) {
    return low + (high - low) * uniform(seed);
}

static iso_grid make(iso_solid kind, iso_vec3 size, double round, double voxel, iso_journal_start *start) {
    const iso_start_solid solid = {kind, size, round};
    iso_grid grid = {.rgrid = NULL};
    iso_error error = {0};
    if (iso_start_with_solid(&solid, voxel, start, &error) != ISO_OK) fail_msg("%s", error.text);
    assert_int_equal(iso_session_solid(start, &grid.hgrid, NULL), ISO_OK);
    return grid;
}

static iso_measured_place measure(const iso_grid *grid, double x, double y, double z) {
    iso_measured_place place;
    iso_error error = {0};
    if (iso_measure_place(grid, iso_vec3_make(x, y, z), NULL, &place, &error) != ISO_OK)
        fail_msg("%s", error.text);
    return place;
}

static void check_solid(const iso_grid *grid, double volume, double area, iso_vec3 size) {
    iso_solid_measures m;
    assert_int_equal(iso_measure_solid(grid, NULL, &m, NULL), ISO_OK);
    const iso_vec3 box = iso_vec3_sub(m.box.hi, m.box.lo);
    print_message("volume %.1f of %.1f, area %.1f of %.1f\n", m.volume, volume, m.area, area);
    assert_true(fabs(m.volume / volume - 1) < 0.003 && fabs(m.area / area - 1) < 0.012);
    assert_true(iso_vec3_length(iso_vec3_sub(box, size)) < 0.1);
    assert_int_equal(m.pieces, 1);
}

static void balls(void **state) {
    (void)state;
    iso_journal_start start;
    const double r = 20;
    iso_grid grid = make(ISO_SOLID_SPHERE, iso_vec3_make(2 * r, 0, 0), 0, 0.5, &start);
    check_solid(&grid, 4 * ISO_PI / 3 * r * r * r, 4 * ISO_PI * r * r, iso_vec3_make(2 * r, 2 * r, 2 * r));
    uint32_t seed = 4;
    for (int i = 0; i < 40; i++) { /* from far and near, inside and outside */
        iso_vec3 p = {random_between(&seed, -1, 1), random_between(&seed, -1, 1),
                      random_between(&seed, -1, 1)};
        p = iso_vec3_scale(iso_vec3_unit(p),
                           i % 2 ? random_between(&seed, 8, 40) : random_between(&seed, 19.7, 20.3));
        const iso_measured_place place = measure(&grid, p.x, p.y, p.z);
        const iso_vec3 wanted = iso_vec3_scale(iso_vec3_unit(p), r);
        const double off = iso_vec3_length(iso_vec3_sub(place.position, wanted)),
                     away = iso_vec3_length(iso_vec3_sub(place.position, p));
        assert_true(fabs(away - fabs(iso_vec3_length(p) - r)) < 0.005 && off < (i % 2 ? 0.6 : 0.03));
        assert_true(iso_vec3_dot(place.normal, iso_vec3_unit(place.position)) > 0.9999);
        assert_true(fabs(place.thickness - 2 * r) < 0.03);
    }
    iso_grid_destroy(&grid);
}

/* The nearest place is as far away as the solid's distance says, and the box is as thick as its sides. */
static void boxes(void **state) {
    (void)state;
    iso_journal_start start;
    const iso_start_solid solid = {ISO_SOLID_BOX, {40, 30, 20}, 0};
    iso_grid grid = make(ISO_SOLID_BOX, solid.size, 0, 0.5, &start);
    check_solid(&grid, 24000, 2 * (1200 + 600 + 800), solid.size);
    assert_true(fabs(measure(&grid, 3, 4, 10.2).thickness - 20) < 0.01);
    assert_true(fabs(measure(&grid, 3, -35, 2).thickness - 30) < 0.01);
    assert_true(fabs(measure(&grid, -19, 3, 2).thickness - 40) < 0.01);
    uint32_t seed = 9;
    for (int i = 0; i < 40; i++) {
        const iso_vec3 p = {random_between(&seed, -30, 30), random_between(&seed, -30, 30),
                            random_between(&seed, -30, 30)};
        const double away = iso_vec3_length(iso_vec3_sub(measure(&grid, p.x, p.y, p.z).position, p));
        const double wanted = fabs(iso_start_solid_distance(&solid, p));
        if (fabs(away - wanted) > 0.35) /* (edges and corners are cut off) */
            fail_msg("%g %g %g: %g away, not %g", p.x, p.y, p.z, away, wanted);
    }
    iso_grid_destroy(&grid);
}

/* Through the hole of a ring a ray goes on: the thickness is that of the tube. */
static void rings(void **state) {
    (void)state;
    iso_journal_start start;
    iso_grid grid = make(ISO_SOLID_TORUS, iso_vec3_make(50, 0, 14), 0, 0.5, &start);
    assert_true(fabs(measure(&grid, 25, 0, 0).thickness - 14) < 0.02);
    assert_true(fabs(measure(&grid, 11, 0, 0).thickness - 14) < 0.02);
    assert_true(fabs(measure(&grid, 0, -18, 7).thickness - 14) < 0.02);
    iso_grid_destroy(&grid);
}

/* What the border of the grid cuts off is capped; a ray that leaves the grid says so. */
static void cut_solids(void **state) {
    (void)state;
    iso_journal_start start = {
        .source = "ball", .voxel_size = 1, .dims = {64, 64, 32}, .origin = {-31.5, -31.5, 0}, .radius = 20};
    iso_grid grid = {.rgrid = NULL};
    iso_solid_measures m;
    assert_int_equal(iso_session_solid(&start, &grid.hgrid, NULL), ISO_OK);
    assert_int_equal(iso_measure_solid(&grid, NULL, &m, NULL), ISO_OK);
    const double half = 2 * ISO_PI / 3 * 8000;
    assert_true(fabs(m.volume / half - 1) < 0.01 && fabs(m.area / (3 * ISO_PI * 400) - 1) < 0.02);
    assert_true(isinf(measure(&grid, 0, 0, 20).thickness));
    iso_grid_destroy(&grid);
    const int dims[3] = {32, 32, 32};
    assert_int_equal(iso_hgrid_create(dims, 0, NULL, &grid.hgrid, NULL), ISO_OK);
    assert_int_equal(iso_measure_solid(&grid, NULL, &m, NULL), ISO_ERR_EMPTY);
    iso_measured_place place;
    assert_int_equal(iso_measure_place(&grid, iso_vec3_make(1, 2, 3), NULL, &place, NULL), ISO_ERR_EMPTY);
    iso_grid_destroy(&grid);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(balls), cmocka_unit_test(boxes),
                                       cmocka_unit_test(rings), cmocka_unit_test(cut_solids)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
