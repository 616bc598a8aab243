/* The solid of points with normals against the solid whose surface they were taken from: whole, with a part
 * of the points missing, and with some normals that face the wrong way. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "check_support.h"
#include "grids/point_solid.h"
#include "grids/rgrid.h"

enum { MOST = 20000 };

static iso_surfel surfels[MOST];
static iso_point_span span;

static iso_point_view view_of_points(void) {
    return (iso_point_view){.surfels = surfels,
                            .spans = &span,
                            .span_count = 1,
                            .transform = iso_transform_identity(),
                            .radius = 0.5};
}

static void add_point(iso_vec3 at, iso_vec3 normal) {
    iso_surfel *to = &surfels[span.count++];
    double p[3], n[3];
    iso_vec3_store(at, p);
    iso_vec3_store(iso_vec3_unit(normal), n);
    for (int axis = 0; axis < 3; axis++) {
        to->position[axis] = (float)p[axis];
        to->normal[axis] = (float)n[axis];
    }
}

/* Distances to the surfaces, below 0 inside. */
static double to_ball(iso_vec3 p) {
    return iso_vec3_length(p) - 20;
}

static double to_torus(iso_vec3 p) {
    const double ring = sqrt(p.x * p.x + p.y * p.y) - 20;
    return sqrt(ring * ring + p.z * p.z) - 8;
}

static void add_ball(uint32_t count, uint32_t *seed) {
    while (span.count < count) {
        const iso_vec3 v = iso_vec3_make(uniform(seed) - 0.5, uniform(seed) - 0.5, uniform(seed) - 0.5);
        if (iso_vec3_length(v) > 0.5 || iso_vec3_length(v) < 0.01) continue;
        add_point(iso_vec3_scale(iso_vec3_unit(v), 20), v);
    }
}

static void add_torus(uint32_t count, uint32_t *seed) {
    while (span.count < count) {
        const double u = 2 * ISO_PI * uniform(seed), v = 2 * ISO_PI * uniform(seed);
        if (uniform(seed) > (20 + 8 * cos(v)) / 28) continue; /* evenly by area */
        const iso_vec3 n = iso_vec3_make(cos(v) * cos(u), cos(v) * sin(u), sin(v));
        add_point(iso_vec3_add(iso_vec3_make(20 * cos(u), 20 * sin(u), 0), iso_vec3_scale(n, 8)), n);
    }
}

static iso_grid sample_points(double voxel, iso_pool *pool) {
    const iso_point_view view = view_of_points();
    const iso_sampling sampling = {.voxel = voxel, .margin = 4, .pool = pool};
    iso_grid grid;
    iso_error error = {0};
    test_ok(iso_grid_from_points("points", &view, &sampling, 0, &grid, &error), &error);
    return grid;
}

/* What the voxels of a grid are to the true solid. */
typedef struct comparison {
    size_t wrong; /* sides of voxels more than `tolerance` mm from the surface */
    double worst; /* |value + distance| of voxels within half a millimetre of the surface, mm */
} comparison;

/* counts: whether a position is compared. */
static comparison compare(const iso_grid *grid, double (*distance)(iso_vec3), double tolerance,
                          bool (*counts)(iso_vec3)) {
    const iso_rgrid *g = grid->rgrid;
    comparison c = {0, 0};
    for (int z = 0; z < g->dims[2]; z++)
        for (int y = 0; y < g->dims[1]; y++)
            for (int x = 0; x < g->dims[0]; x++) {
                const double *o = g->transform.origin, s = g->transform.spacing[0];
                const iso_vec3 p = iso_vec3_make(o[0] + x * s, o[1] + y * s, o[2] + z * s);
                const double d = distance(p),
                             v = (double)((const float *)g->data)[x + y * g->stride_y + z * g->stride_z];
                if (counts && !counts(p)) continue;
                if (fabs(d) > tolerance) c.wrong += (d < 0) != (v > 0);
                if (fabs(d) < 0.5) c.worst = fmax(c.worst, fabs(v + d));
            }
    return c;
}

static void test_whole_surfaces(void **state) {
    (void)state;
    uint32_t seed = 3;
    for (int torus = 0; torus < 2; torus++)
        for (double voxel = 0.5; voxel < 3; voxel *= 2) {
            span.count = 0;
            (torus ? add_torus : add_ball)(MOST, &seed);
            iso_grid grid = sample_points(voxel, NULL);
            const comparison c = compare(&grid, torus ? to_torus : to_ball, 0.2, NULL);
            print_message("%s, voxels of %g mm: worst %.3f mm\n", torus ? "torus" : "ball", voxel, c.worst);
            assert_int_equal(c.wrong, 0);
            assert_true(c.worst < 0.2);
            iso_grid_destroy(&grid);
        }
}

static bool below_the_hole(iso_vec3 p) {
    return p.z < 12;
}

/* Removes the points that do not count. */
static void keep_points(bool (*counts)(iso_vec3)) {
    uint32_t kept = 0;
    for (uint32_t i = 0; i < span.count; i++) {
        const float *p = surfels[i].position;
        if (counts(iso_vec3_make((double)p[0], (double)p[1], (double)p[2]))) surfels[kept++] = surfels[i];
    }
    span.count = kept;
}

/* A ball of which a cap is missing, as in a scan from below: the hole is closed, and nothing else changes. */
static void test_holes_are_closed(void **state) {
    (void)state;
    uint32_t seed = 5;
    span.count = 0;
    add_ball(MOST, &seed);
    keep_points(below_the_hole);
    iso_grid grid = sample_points(1, NULL);
    const comparison c = compare(&grid, to_ball, 1, below_the_hole);
    assert_int_equal(c.wrong, 0);
    const iso_rgrid *g = grid.rgrid;
    const float *v = g->data;
    for (int z = 0; z < g->dims[2]; z++) /* no solid in the faces of the grid */
        for (int y = 0; y < g->dims[1]; y++)
            for (int x = 0; x < g->dims[0]; x++)
                if (x == 0 || y == 0 || z == 0 || x == g->dims[0] - 1 || y == g->dims[1] - 1 ||
                    z == g->dims[2] - 1)
                    assert_true(v[x + y * g->stride_y + z * g->stride_z] < 0);
    iso_grid_destroy(&grid);
}

static void test_some_wrong_normals(void **state) {
    (void)state;
    uint32_t seed = 7;
    span.count = 0;
    add_ball(MOST, &seed);
    for (uint32_t i = 0; i < span.count; i += 50)
        for (int axis = 0; axis < 3; axis++) surfels[i].normal[axis] *= -1;
    iso_grid grid = sample_points(1, NULL);
    assert_int_equal(compare(&grid, to_ball, 1, NULL).wrong, 0);
    iso_grid_destroy(&grid);
}

static void test_threads(void **state) {
    (void)state;
    uint32_t seed = 9;
    iso_pool *pool;
    iso_error error;
    span.count = 0;
    add_torus(4000, &seed);
    iso_grid one = sample_points(1, NULL);
    test_ok(iso_pool_create(3, &pool, &error), &error);
    iso_grid many = sample_points(1, pool);
    const int *d = one.rgrid->dims;
    assert_memory_equal(one.rgrid->data, many.rgrid->data,
                        (size_t)d[0] * (size_t)d[1] * (size_t)d[2] * sizeof(float));
    iso_grid_destroy(&one);
    iso_grid_destroy(&many);
    iso_pool_destroy(pool);
}

static void test_limits(void **state) {
    (void)state;
    uint32_t seed = 9;
    iso_grid grid;
    iso_error error;
    span.count = 0;
    iso_point_view view = view_of_points();
    iso_sampling sampling = {.voxel = 1, .margin = 4};
    assert_int_equal(iso_grid_from_points("points", &view, &sampling, 0, &grid, &error), ISO_ERR_EMPTY);
    add_ball(500, &seed);
    assert_int_equal(iso_grid_from_points("points", &view, &sampling, 1000, &grid, &error), ISO_ERR_LIMIT);
    sampling.voxel = 1e-5;
    assert_int_equal(iso_grid_from_points("points", &view, &sampling, 0, &grid, &error), ISO_ERR_LIMIT);
    sampling.voxel = 0;
    assert_int_equal(iso_grid_from_points("points", &view, &sampling, 0, &grid, &error), ISO_ERR_USAGE);
    for (uint32_t count = 1; count < 9; count++) { /* too few to enclose anything: a volume all the same */
        span.count = count;
        sampling.voxel = 2;
        test_ok(iso_grid_from_points("points", &view, &sampling, 0, &grid, &error), &error);
        iso_grid_destroy(&grid);
    }
    for (span.count = 0; span.count < 100;) add_point(iso_vec3_make(1, 2, 3), iso_vec3_make(0, 0, 1));
    test_ok(iso_grid_from_points("points", &view, &sampling, 0, &grid, &error), &error);
    iso_grid_destroy(&grid);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_whole_surfaces),
        cmocka_unit_test(test_holes_are_closed),
        cmocka_unit_test(test_some_wrong_normals),
        cmocka_unit_test(test_threads),
        cmocka_unit_test(test_limits),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
