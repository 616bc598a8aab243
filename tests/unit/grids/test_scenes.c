/* Scenes: exact shapes, the two field scenes against plain re-implementations with libm, and the same bytes
 * for every thread count. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/parallel.h"
#include "check_support.h"
#include "grids/scenes/scenes.h"

static iso_grid make(const char *name, const iso_scene_opts *opts) {
    iso_grid grid = {0};
    iso_error error = {0};
    if (iso_scene_create(name, opts, &grid, NULL, &error) != ISO_OK) fail_msg("%s", error.text);
    return grid;
}

/* ---- exact distances */

static double sphere(double side, double x, double y, double z) {
    return sqrt(x * x + y * y + z * z) - 0.4 * side;
}

static double cube(double side, double x, double y, double z) {
    /* The nearest point of the cube, or the nearest face from inside. */
    double h = 0.4 * side, nx = fmin(fmax(x, -h), h), ny = fmin(fmax(y, -h), h), nz = fmin(fmax(z, -h), h);
    double out = sqrt((x - nx) * (x - nx) + (y - ny) * (y - ny) + (z - nz) * (z - nz));
    return out > 0 ? out : -fmin(h - fabs(x), fmin(h - fabs(y), h - fabs(z)));
}

static double torus(double side, double x, double y, double z) {
    double angle = atan2(y, x), cx = 0.3 * side * cos(angle), cy = 0.3 * side * sin(angle);
    return sqrt((x - cx) * (x - cx) + (y - cy) * (y - cy) + z * z) - 0.1 * side;
}

static double cylinder(double side, double x, double y, double z) {
    double length = sqrt(0.35 * 0.35 + 0.25 * 0.25 + 0.9 * 0.9), r = 0.2 * side, h = 0.32 * side;
    double a = (0.35 * x + 0.25 * y + 0.9 * z) / length, s = sqrt(fmax(0, x * x + y * y + z * z - a * a));
    double ns = fmin(s, r), na = fmin(fmax(a, -h), h), out = hypot(s - ns, a - na);
    return out > 0 ? out : -fmin(r - s, h - fabs(a));
}

typedef struct shape {
    const char *name;
    double (*distance)(double side, double x, double y, double z);
} shape;

static const shape shapes[] = {{"sphere", sphere}, {"cube", cube}, {"torus", torus}, {"cylinder", cylinder}};

static double clamped(double d) {
    return fmin(fmax(d, -3), 3);
}

static void solids_are_exact(void **state) {
    (void)state;
    const int sizes[] = {16, 33, 64};
    for (int s = 0; s < 4; s++)
        for (int n = 0; n < 3; n++) {
            iso_scene_opts opts = {.size = sizes[n]};
            iso_grid grid = make(shapes[s].name, &opts);
            assert_non_null(grid.hgrid);
            double centre = sizes[n] / 2 - 0.5;
            int inside = 0;
            for (int z = 0; z < sizes[n]; z++)
                for (int y = 0; y < sizes[n]; y++)
                    for (int x = 0; x < sizes[n]; x++) {
                        double wanted = shapes[s].distance(sizes[n], x - centre, y - centre, z - centre);
                        double got = iso_grid_at(&grid, x, y, z);
                        inside += got < 0;
                        if (fabs(got - clamped(wanted)) > 1e-5)
                            fail_msg("%s %d at %d %d %d: %g, wanted %g", shapes[s].name, sizes[n], x, y, z,
                                     got, clamped(wanted));
                    }
            assert_true(inside > 100);
            iso_grid_destroy(&grid);
        }
}

static void same_voxels(const iso_grid *a, const iso_grid *b) {
    const int *dims = iso_grid_dims(a);
    assert_memory_equal(dims, iso_grid_dims(b), 3 * sizeof *dims);
    for (int z = 0; z < dims[2]; z++)
        for (int y = 0; y < dims[1]; y++)
            for (int x = 0; x < dims[0]; x++)
                if (iso_grid_at(a, x, y, z) != iso_grid_at(b, x, y, z))
                    fail_msg("voxel %d %d %d: %g and %g", x, y, z, (double)iso_grid_at(a, x, y, z),
                             (double)iso_grid_at(b, x, y, z));
}

static void dense_is_the_same_field(void **state) {
    (void)state;
    const char *const names[] = {"sphere", "cube", "torus", "cylinder", "head"};
    for (int i = 0; i < 5; i++) {
        iso_scene_opts opts = {.size = 72};
        iso_grid sparse = make(names[i], &opts);
        opts.dense = 1;
        iso_grid dense = make(names[i], &opts);
        assert_non_null(sparse.hgrid);
        assert_non_null(dense.rgrid);
        assert_int_equal(dense.rgrid->type, ISO_FLOAT32);
        assert_true(iso_grid_is_level_set(&dense) && iso_grid_is_level_set(&sparse));
        same_voxels(&sparse, &dense);
        iso_grid_destroy(&sparse);
        iso_grid_destroy(&dense);
    }
}

/* No brick is all band, whatever sticks out of the grid, and a new scene has no history. */
static void level_sets_are_pruned(void **state) {
    (void)state;
    const char *const names[] = {"sphere", "cylinder", "cube", "torus", "head"};
    for (int i = 0; i < 5; i++)
        for (int size = 17; size < 120; size += 17) {
            iso_scene_opts opts = {.size = size};
            iso_grid grid = make(names[i], &opts);
            size_t bricks = iso_hgrid_brick_count(grid.hgrid);
            iso_hgrid_prune(grid.hgrid);
            assert_int_equal(iso_hgrid_brick_count(grid.hgrid), bricks);
            assert_int_equal(iso_change_log_now(grid.hgrid->log), 0);
            iso_grid_destroy(&grid);
        }
}

/* ---- gyroid */

static void gyroid_is_its_formula(void **state) {
    (void)state;
    iso_scene_opts opts = {.size = 40};
    iso_grid grid = make("gyroid", &opts);
    assert_non_null(grid.rgrid);
    assert_int_equal(iso_grid_is_level_set(&grid), 0);
    const double k = 3 * 2 * ISO_PI / 40;
    for (int z = 0; z < 40; z++)
        for (int y = 0; y < 40; y++)
            for (int x = 0; x < 40; x++) {
                double a = k * (x + 0.5), b = k * (y + 0.5), c = k * (z + 0.5);
                double wanted = sin(a) * cos(b) + sin(b) * cos(c) + sin(c) * cos(a);
                assert_true(fabs((double)iso_grid_at(&grid, x, y, z) - wanted) < 1e-6);
            }
    iso_grid_destroy(&grid);
}

/* ---- head */

static const double balls[9][4] = {
    {0, 0, .12, .56},      {0, -.12, -.25, .44},   {0, -.52, -.12, .13},
    {0, -.42, -.55, .22},  {.34, -.12, -.15, .26}, {-.34, -.12, -.15, .26},
    {.62, .05, -.05, .13}, {-.62, .05, -.05, .13}, {0, .05, -.75, .24},
};

/* The head's field at a position in voxels. */
static double head_field(int size, double vx, double vy, double vz) {
    double x = (2 * vx + 1) / size - 1, y = (2 * vy + 1) / size - 1, z = (2 * vz + 1) / size - 1 - .07;
    double d = 0;
    for (int i = 0; i < 9; i++) {
        double q =
            sqrt(pow(x - balls[i][0], 2) + pow(y - balls[i][1], 2) + pow(z - balls[i][2], 2)) - balls[i][3];
        double h = i ? fmax(.12 - fabs(d - q), 0) / .12 : 0;
        d = i ? fmin(d, q) - h * h * .12 * .25 : q;
    }
    const double k = 70;
    return d + .012 * (sin(k * x) * cos(k * y) + sin(k * y) * cos(k * z) + sin(k * z) * cos(k * x));
}

/* Signs everywhere, and no cell is left empty that the surface comes near: outside, the balls' own field is
 * nearly a distance, and the relief changes it by at most 0.018. */
static void head_cells_are_chosen_rightly(void **state) {
    (void)state;
    for (int size = 18; size <= 78; size += 5) {
        iso_scene_opts opts = {.size = size};
        iso_grid grid = make("head", &opts);
        int inside = 0, close = 0;
        for (int z = 0; z < size; z++)
            for (int y = 0; y < size; y++)
                for (int x = 0; x < size; x++) {
                    double f = head_field(size, x, y, z);
                    if (fabs(f) < 1e-6) continue;
                    float d = iso_grid_at(&grid, x, y, z);
                    int near = f > 0 && (f + 2 * 0.018) * size / 2 < 2.5;
                    inside += d < 0;
                    close += near;
                    if ((f < 0) != (d < 0) || (near && fabsf(d) >= 3))
                        fail_msg("head %d, voxel %d %d %d: field %g, distance %g", size, x, y, z, f,
                                 (double)d);
                }
        assert_true(inside > size * size * size / 10 && close > 100);
        iso_grid_destroy(&grid);
    }
}

/* Distance from a voxel to the nearest change of sign, found by brute force on a grid of 1/8 voxel. */
static double brute_distance(int size, const int v[3]) {
    enum { STEPS = 8, REACH = 4 * STEPS };
    static char negative[2 * REACH + 1][2 * REACH + 1][2 * REACH + 1];
    for (int z = 0; z <= 2 * REACH; z++)
        for (int y = 0; y <= 2 * REACH; y++)
            for (int x = 0; x <= 2 * REACH; x++)
                negative[z][y][x] =
                    head_field(size, v[0] + (double)(x - REACH) / STEPS, v[1] + (double)(y - REACH) / STEPS,
                               v[2] + (double)(z - REACH) / STEPS) < 0;
    double best = 1e30;
    for (int z = 0; z <= 2 * REACH; z++)
        for (int y = 0; y <= 2 * REACH; y++)
            for (int x = 0; x <= 2 * REACH; x++) {
                int changes[3] = {x < 2 * REACH && negative[z][y][x] != negative[z][y][x + 1],
                                  y < 2 * REACH && negative[z][y][x] != negative[z][y + 1][x],
                                  z < 2 * REACH && negative[z][y][x] != negative[z + 1][y][x]};
                for (int axis = 0; axis < 3; axis++) {
                    if (!changes[axis]) continue;
                    double p[3] = {x - REACH, y - REACH, z - REACH};
                    p[axis] += 0.5;
                    best = fmin(best, sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]) / STEPS);
                }
            }
    return best;
}

static void head_distances_are_distances(void **state) {
    (void)state;
    const int size = 512;
    iso_scene_opts opts = {.size = size};
    iso_grid grid = make("head", &opts);
    uint64_t random = 3;
    double sum = 0, worst = 0;
    int count = 0;
    while (count < 40) {
        int v[3];
        for (int axis = 0; axis < 3; axis++) v[axis] = (int)random_below(&random, (uint32_t)size);
        double d = fabs((double)iso_grid_at(&grid, v[0], v[1], v[2]));
        if (d > 2.9 && random_below(&random, 20000)) continue;
        double wanted = fmin(brute_distance(size, v), 3);
        sum += fabs(d - wanted);
        worst = fmax(worst, fabs(d - wanted));
        count++;
    }
    /* The brute force is good to about a sixteenth of a voxel itself. */
    print_message("head %d: distance error mean %.4f, worst %.4f voxels\n", size, sum / count, worst);
    assert_true(sum / count < 0.04 && worst < 0.15);
    iso_grid_destroy(&grid);
}

static void head_gradients_are_unit(void **state) {
    (void)state;
    iso_scene_opts opts = {.size = 512};
    iso_grid grid = make("head", &opts);
    const int *dims = iso_grid_dims(&grid);
    double sum = 0;
    size_t count = 0, off = 0;
    for (int z = 0; z < dims[2]; z += 2)
        for (int y = 0; y < dims[1]; y += 3)
            for (int x = 0; x < dims[0]; x++) {
                if (fabsf(iso_grid_at(&grid, x, y, z)) >= 2) continue;
                double error = fabs(iso_vec3_length(iso_grid_voxel_gradient(&grid, x, y, z)) - 1);
                sum += error;
                off += error > 0.1;
                count++;
            }
    print_message("head 512: | |grad| - 1 | is %.4f on average, above 0.1 for %.2f %%\n", sum / (double)count,
                  100.0 * (double)off / (double)count);
    assert_true(count > 100000);
    assert_true(sum / (double)count < 0.01 && off * 50 < count);
    iso_grid_destroy(&grid);
}

/* ---- ct */

static double step(double a, double b, double x) {
    double t = fmin(fmax((x - a) / (b - a), 0), 1);
    return t * t * (3 - 2 * t);
}

/* NaN where brain meets bone: the value jumps there, and rounding may take either side. */
static double ct_field(int size, double gy, int ix, int iy, int iz) {
    double X = 2 * (ix + .5) / size - 1, Y = 2 * (iy + .5) / size - 1, Z = 2 * (iz + .5) / size - 1;
    double r = sqrt(X * X / .64 + Y * Y / .81 + Z * Z / (.86 * .86)), e = 2.4 / size;
    double wobble = .02 * sin(9 * X) * sin(8 * Y + 1) * sin(7 * Z + 2), bo = .92 + wobble,
           bi = .8 + 1.5 * wobble;
    if (fabs(r - bi) < 1e-6) return NAN;
    double bone = (1 - step(bo - e, bo + e, r)) * step(bi - e, bi + e, r);
    double g = sin(gy * X) * cos(gy * Y) + sin(gy * Y) * cos(gy * Z) + sin(gy * Z) * cos(gy * X);
    double pore = (1 - step(bo - .02 - e, bo - .02 + e, r)) * step(bi + .02 - e, bi + .02 + e, r);
    bone *= 1 - .8 * pore * step(.2, .2 + gy * e * 1.5, g);
    double face = step(.1, .2, -Y) * (1 - step(bi - .05 - e, bi - .05 + e, r)) * step(-.1, 0, -Z - .1),
           k = .8 * gy;
    double g2 = fabs(sin(k * X) * cos(k * Y) + sin(k * Y) * cos(k * Z) + sin(k * Z) * cos(k * X));
    bone = fmax(bone, face * (1 - step(.25 - k * e, .25 + k * e, g2)));
    return 8 + 52 * (1 - step(1 - e, 1 + e, r)) + 135 * bone + (r < bi ? 15 * (1 - bone) : 0);
}

static void ct_is_its_formula(void **state) {
    (void)state;
    const double frequencies[] = {0, 12};
    for (int i = 0; i < 2; i++) {
        iso_scene_opts opts = {.size = 75, .noise = -1, .detail = frequencies[i]};
        iso_grid grid = make("ct", &opts);
        assert_int_equal(grid.rgrid->type, ISO_UINT8);
        int bone = 0;
        for (int z = 0; z < 75; z++)
            for (int y = 0; y < 75; y++)
                for (int x = 0; x < 75; x++) {
                    double wanted = ct_field(75, i ? 12 : 29, x, y, z), got = iso_grid_at(&grid, x, y, z);
                    bone += got >= 127.5;
                    if (fabs(got - wanted) > 0.51)
                        fail_msg("voxel %d %d %d: %g, wanted %g", x, y, z, got, wanted);
                }
        assert_true(bone > 10000);
        iso_grid_destroy(&grid);
    }
}

/* Mean, deviation and the correlation of neighbours of the noise, which the filter [1 2 1]/4 makes 2/3. */
static void ct_noise_is_as_stated(void **state) {
    (void)state;
    const double deviations[] = {0, 12};
    for (int i = 0; i < 2; i++) {
        iso_scene_opts opts = {.size = 80, .noise = -1};
        iso_grid clean = make("ct", &opts);
        opts.noise = deviations[i];
        iso_grid noisy = make("ct", &opts);
        double sum = 0, squares = 0, products[3] = {0}, count = 0;
        for (int z = 20; z < 60; z++)
            for (int y = 5; y < 75; y++)
                for (int x = 20; x < 60; x++) {
#define NOISE(x, y, z) ((double)iso_grid_at(&noisy, x, y, z) - (double)iso_grid_at(&clean, x, y, z))
                    double n = NOISE(x, y, z);
                    if (iso_grid_at(&clean, x, y, z) < 50) continue; /* clipped at 0 */
                    sum += n;
                    squares += n * n;
                    products[0] += n * NOISE(x + 1, y, z);
                    products[1] += n * NOISE(x, y + 1, z);
                    products[2] += n * NOISE(x, y, z + 1);
#undef NOISE
                    count++;
                }
        double wanted = i ? 12 : 5, deviation = sqrt(squares / count);
        assert_true(fabs(sum / count) < 0.15 * wanted);
        if (fabs(deviation - wanted) > 0.05 * wanted) fail_msg("noise %g, wanted %g", deviation, wanted);
        for (int axis = 0; axis < 3; axis++)
            if (fabs(products[axis] / squares - 2.0 / 3) > 0.03)
                fail_msg("correlation along axis %d is %g", axis, products[axis] / squares);
        iso_grid_destroy(&clean);
        iso_grid_destroy(&noisy);
    }
}

/* ---- the same for every thread count */

static uint64_t fold(uint64_t hash, const void *data, size_t bytes) {
    const unsigned char *c = data;
    for (size_t i = 0; i < bytes; i++) hash = (hash ^ c[i]) * 1099511628211u;
    return hash;
}

/* Of the bytes that are stored, brick numbers included. */
static uint64_t hash_grid(const iso_grid *grid) {
    uint64_t hash = 14695981039346656037u;
    if (grid->rgrid) {
        size_t voxels =
            (size_t)grid->rgrid->dims[0] * (size_t)grid->rgrid->dims[1] * (size_t)grid->rgrid->dims[2];
        return fold(hash, grid->rgrid->data, voxels * iso_type_size(grid->rgrid->type));
    }
    const iso_hgrid *h = grid->hgrid;
    size_t cells = iso_hgrid_cell_count(h);
    hash = fold(hash, h->cell, cells * sizeof *h->cell);
    for (size_t i = 0; i < cells; i++)
        if (h->cell[i] >= 0)
            hash = fold(hash, iso_hgrid_brick(h, h->cell[i]), ISO_BRICK_VOXELS * sizeof(float));
    return hash;
}

static void same_bytes_for_any_thread_count(void **state) {
    (void)state;
    const int threads[] = {2, 7};
    for (const char *const *name = iso_scene_names(); *name; name++)
        for (int dense = 0; dense < 2; dense++) {
            iso_scene_opts opts = {.size = 83, .dense = dense};
            iso_grid grid = make(*name, &opts);
            uint64_t wanted = hash_grid(&grid);
            iso_grid_destroy(&grid);
            for (int t = 0; t < 2; t++) {
                assert_int_equal(iso_pool_create(threads[t], &opts.pool, NULL), ISO_OK);
                grid = make(*name, &opts);
                iso_pool_destroy(opts.pool);
                if (hash_grid(&grid) != wanted) fail_msg("%s differs with %d threads", *name, threads[t]);
                iso_grid_destroy(&grid);
            }
        }
}

/* ---- names */

static void names_and_defaults(void **state) {
    (void)state;
    iso_error error = {0};
    iso_grid grid = {0};
    assert_int_equal(iso_scene_create("teapot", NULL, &grid, NULL, &error), ISO_ERR_USAGE);
    assert_non_null(strstr(error.text, "teapot"));
    const int sizes[] = {64, 64, 32, 128, 128, 128, 128, 128};
    int count = 0;
    for (const char *const *name = iso_scene_names(); *name; name++, count++) {
        assert_non_null(strstr(error.text, *name));
        double isovalue = -1;
        assert_int_equal(iso_scene_create(*name, NULL, &grid, &isovalue, NULL), ISO_OK);
        assert_true(isovalue == (strcmp(*name, "ct") == 0 ? 127.5 : strcmp(*name, "organs") == 0 ? 0.5 : 0));
        assert_int_equal(iso_grid_dims(&grid)[2], sizes[count]);
        iso_grid_destroy(&grid);
    }
    assert_int_equal(count, 8);
    const int bad[] = {15, -1, 2049};
    for (int i = 0; i < 3; i++) {
        iso_scene_opts opts = {.size = bad[i]};
        assert_int_equal(iso_scene_create("sphere", &opts, &grid, NULL, NULL), ISO_ERR_USAGE);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(solids_are_exact),
        cmocka_unit_test(dense_is_the_same_field),
        cmocka_unit_test(level_sets_are_pruned),
        cmocka_unit_test(gyroid_is_its_formula),
        cmocka_unit_test(head_cells_are_chosen_rightly),
        cmocka_unit_test(head_distances_are_distances),
        cmocka_unit_test(head_gradients_are_unit),
        cmocka_unit_test(ct_is_its_formula),
        cmocka_unit_test(ct_noise_is_as_stated),
        cmocka_unit_test(same_bytes_for_any_thread_count),
        cmocka_unit_test(names_and_defaults),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
