/* points: edge points against a reference that knows no bricks, foot points on spheres, and sets that follow
 * edits. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/cpu.h"
#include "base/point_bounds.h"
#include "check_support.h"
#include "extract/points/points.h"
#include "extract_support.h"
#include "grids/spans.h"

static const iso_type all_types[] = {ISO_UINT8, ISO_INT16, ISO_UINT16, ISO_FLOAT32};

/* ---- edge points against a reference */

/* The point on edge p, p + axis, in double; 0 when there is none. */
static int reference_point(const iso_grid *grid, const int p[3], int axis, double isovalue, double point[6]) {
    int q[3] = {p[0], p[1], p[2]};
    q[axis]++;
    if (q[axis] >= iso_grid_dims(grid)[axis]) return 0;
    double a = iso_grid_at(grid, p[0], p[1], p[2]), b = iso_grid_at(grid, q[0], q[1], q[2]);
    if (!isfinite(a) || !isfinite(b) || (a >= isovalue) == (b >= isovalue)) return 0;
    double t = (isovalue - a) / (b - a);
    iso_vec3 low = iso_grid_voxel_gradient(grid, p[0], p[1], p[2]);
    iso_vec3 high = iso_grid_voxel_gradient(grid, q[0], q[1], q[2]);
    iso_vec3 g = iso_vec3_add(iso_vec3_scale(low, 1 - t), iso_vec3_scale(high, t));
    double sign = iso_grid_is_level_set(grid) ? 1 : -1;
    if (iso_vec3_length(g) < 1e-9) {
        g = iso_vec3_make(axis == 0, axis == 1, axis == 2);
        if (a >= isovalue) sign = -sign;
    }
    iso_vec3 n = iso_vec3_scale(iso_vec3_unit(g), sign);
    const double made[6] = {
        p[0] + (axis == 0) * t, p[1] + (axis == 1) * t, p[2] + (axis == 2) * t, n.x, n.y, n.z};
    memcpy(point, made, sizeof made);
    return 1;
}

/* Every point of the view, in order, against the reference. */
static void check_edge_points(const iso_grid *grid, double isovalue, const iso_point_view *view) {
    const int *dims = iso_grid_dims(grid);
    int bricks[3];
    iso_grid_bricks(grid, bricks);
    size_t span = 0;
    for (int b = 0; b < bricks[0] * bricks[1] * bricks[2]; b++) {
        const int brick[3] = {b % bricks[0], b / bricks[0] % bricks[1], b / bricks[0] / bricks[1]};
        uint32_t found = 0;
        for (int i = 0; i < 3 * ISO_BRICK_VOXELS; i++) {
            int v = i % ISO_BRICK_VOXELS,
                p[3] = {16 * brick[0] + v % 16, 16 * brick[1] + v / 16 % 16, 16 * brick[2] + v / 256};
            double wanted[6];
            if (p[0] >= dims[0] || p[1] >= dims[1] || p[2] >= dims[2]) continue;
            if (!reference_point(grid, p, i / ISO_BRICK_VOXELS, isovalue, wanted)) continue;
            assert_true(span < view->span_count);
            assert_memory_equal(view->spans[span].brick, brick, sizeof brick);
            assert_true(found < view->spans[span].count);
            iso_surfel got = iso_point_view_get(view, view->spans[span].first + found++);
            for (int k = 0; k < 3; k++) {
                near(16 * brick[k] + got.position[k], wanted[k], 1e-5);
                near(got.normal[k], wanted[3 + k], 1e-3);
            }
        }
        if (!found) continue;
        assert_int_equal(view->spans[span].count, found);
        span++;
    }
    assert_int_equal(view->span_count, span);
}

static void sprinkle_nonfinite(const iso_grid *grid, test_random *random) {
    const int *dims = iso_grid_dims(grid);
    const double odd[] = {NAN, INFINITY, -INFINITY};
    for (int i = 0; i < 1 + dims[0] * dims[1] * dims[2] / 20; i++)
        test_set(grid, test_random_int(random, 0, dims[0] - 1), test_random_int(random, 0, dims[1] - 1),
                 test_random_int(random, 0, dims[2] - 1), odd[test_random_int(random, 0, 2)]);
}

static void edge_points_match_the_reference(void **state) {
    (void)state;
    test_random random = {1};
    for (int round = 0; round < 160; round++) {
        int dims[3];
        test_random_dims(&random, 1, round % 8 == 7 ? 40 : 20, dims);
        iso_grid grid = test_rgrid(dims, all_types[round % 4]);
        test_fill(&grid, (test_pattern)(round / 4 % 3), &random);
        if (grid.rgrid->type == ISO_FLOAT32 && round % 8 == 3) sprinkle_nonfinite(&grid, &random);
        grid.rgrid->level_set = round % 5 == 0;
        const iso_points_opts opts = {.isovalue = 100, .floats = true};
        iso_point_set *set = test_point_set(&grid, &opts);
        iso_point_view view = iso_point_set_view(set);
        check_edge_points(&grid, 100, &view);
        iso_point_set_destroy(set);
        iso_grid_destroy(&grid);
    }
}

/* The float nearest to an isovalue can lie on the other side of a voxel's value. */
static void isovalues_between_floats_classify_exactly(void **state) {
    (void)state;
    const double isovalues[] = {0.1, 0.7, 300.1, -0.3, 1e-3, 16777217.0};
    for (int i = 0; i < 6; i++)
        for (int step = -2; step <= 2; step++) {
            iso_grid grid = test_rgrid((int[3]){2, 1, 1}, ISO_FLOAT32);
            float *v = grid.rgrid->data, at = (float)isovalues[i];
            for (int k = 0; k < step; k++) at = nextafterf(at, INFINITY);
            for (int k = 0; k > step; k--) at = nextafterf(at, -INFINITY);
            v[0] = at;
            v[1] = (float)(isovalues[i] + fabs(isovalues[i]));
            const iso_points_opts opts = {.isovalue = isovalues[i], .floats = true};
            iso_point_set *set = test_point_set(&grid, &opts);
            iso_point_view view = iso_point_set_view(set);
            assert_int_equal(iso_point_view_count(&view), v[0] < isovalues[i]);
            /* neighbouring floats: the exact fraction still comes out */
            v[1] = nextafterf(v[0], INFINITY);
            iso_point_set_isovalue(set, NAN);
            assert_int_equal(iso_point_set_update(set, NULL), ISO_ERR_USAGE);
            iso_point_set_isovalue(set, isovalues[i]);
            assert_int_equal(iso_point_set_update(set, NULL), ISO_OK);
            view = iso_point_set_view(set);
            check_edge_points(&grid, isovalues[i], &view);
            iso_point_set_destroy(set);
            iso_grid_destroy(&grid);
        }
}

/* A physical isovalue that a scale turns into a voxel's value up to rounding is that value. */
static void scaled_isovalues_hit_their_voxels(void **state) {
    (void)state;
    for (int level = 1; level < 2000; level++) {
        iso_grid grid = test_rgrid((int[3]){2, 1, 1}, ISO_INT16);
        grid.rgrid->scale = 0.1;
        grid.rgrid->offset = -1024.3;
        int16_t *v = grid.rgrid->data;
        v[0] = (int16_t)(level - 1);
        v[1] = (int16_t)level;
        const iso_points_opts opts = {.isovalue = level * 0.1 - 1024.3, .floats = true};
        iso_point_set *set = test_point_set(&grid, &opts);
        iso_point_view view = iso_point_set_view(set);
        assert_int_equal(iso_point_view_count(&view), 1);
        near(iso_point_view_get(&view, 0).position[0], 1, 1e-6);
        iso_point_set_destroy(set);
        iso_grid_destroy(&grid);
    }
}

/* Steep, flat and huge fields have the normals of the same field at a moderate magnitude. */
static void normals_survive_any_magnitude(void **state) {
    (void)state;
    test_random random = {3};
    iso_grid grid = test_rgrid((int[3]){6, 6, 6}, ISO_FLOAT32);
    float *voxels = grid.rgrid->data;
    for (int v = 0; v < 216; v++) voxels[v] = (float)test_random_real(&random, -1, 1);
    const iso_points_opts opts = {.isovalue = 0, .floats = true};
    iso_point_set *moderate = test_point_set(&grid, &opts);
    iso_point_view wanted = iso_point_set_view(moderate);
    size_t count = iso_point_view_count(&wanted);
    assert_true(count > 100);
    const int exponents[] = {-125, -80, 80, 125};
    for (int i = 0; i < 4; i++) {
        for (int v = 0; v < 216; v++) voxels[v] = ldexpf(voxels[v], exponents[i]);
        assert_int_equal(iso_rgrid_mark_changed(grid.rgrid, (int[3]){0, 0, 0}, (int[3]){5, 5, 5}, NULL),
                         ISO_OK);
        iso_point_set *set = test_point_set(&grid, &opts);
        iso_point_view view = iso_point_set_view(set);
        assert_int_equal(iso_point_view_count(&view), count);
        for (size_t k = 0; k < count; k++)
            for (int axis = 0; axis < 3; axis++) {
                near(view.surfels[k].normal[axis], wanted.surfels[k].normal[axis], 1e-3);
                near(view.surfels[k].position[axis], wanted.surfels[k].position[axis], 1e-3);
            }
        for (int v = 0; v < 216; v++) voxels[v] = ldexpf(voxels[v], -exponents[i]);
        iso_point_set_destroy(set);
    }
    iso_point_set_destroy(moderate);
    iso_grid_destroy(&grid);
}

/* ---- spheres */

typedef struct sphere_error {
    double position, normal; /* root mean square; voxels of distance, radians */
    size_t count, rejected;
} sphere_error;

static sphere_error sphere_errors(int size, iso_primitive primitive, int dense) {
    iso_vec3 centre = {size / 2 - 0.37, size / 2 + 0.21, size / 2 - 0.11};
    double radius = 0.35 * size;
    iso_grid grid = test_ball_grid(size, centre, radius, dense);
    const iso_points_opts opts = {.primitive = primitive, .floats = true};
    iso_point_set *set = test_point_set(&grid, &opts);
    iso_point_view view = iso_point_set_view(set);
    sphere_error e = {.rejected = iso_point_set_stats(set).rejected};
    for (size_t s = 0; s < view.span_count; s++)
        for (uint32_t i = 0; i < view.spans[s].count; i++) {
            iso_surfel p = iso_point_view_get(&view, view.spans[s].first + i);
            const int32_t *b = view.spans[s].brick;
            iso_vec3 way = {16 * b[0] + p.position[0] - centre.x, 16 * b[1] + p.position[1] - centre.y,
                            16 * b[2] + p.position[2] - centre.z};
            iso_vec3 n = {p.normal[0], p.normal[1], p.normal[2]};
            e.position += pow(iso_vec3_length(way) - radius, 2);
            double angle = asin(fmin(1, iso_vec3_length(iso_vec3_cross(iso_vec3_unit(way), n))));
            assert_true(iso_vec3_dot(way, n) > 0);
            e.normal += angle * angle;
            e.count++;
        }
    assert_int_equal(e.count, iso_point_set_stats(set).points);
    e.position = sqrt(e.position / (double)e.count);
    e.normal = sqrt(e.normal / (double)e.count);
    iso_point_set_destroy(set);
    iso_grid_destroy(&grid);
    return e;
}

/* Errors in voxels: the sphere grows in a grid of fixed spacing, so order 2 in the spacing over the radius is
 * order 1 in voxels for positions of linear interpolation, and 2 for normals. */
static void spheres_converge(void **state) {
    (void)state;
    const struct {
        iso_primitive primitive;
        int dense;
        double position_order, normal_order;
    } cases[] = {
        {ISO_PRIMITIVE_EDGE, 0, 0.9, 1.8},          {ISO_PRIMITIVE_EDGE, 1, 0.9, 1.8},
        {ISO_PRIMITIVE_FOOT, 0, -1, 1.8},           {ISO_PRIMITIVE_FOOT, 1, -1, 1.8},
        {ISO_PRIMITIVE_FOOT_ITERATED, 0, 0.9, 1.7}, {ISO_PRIMITIVE_FOOT_ITERATED, 1, 0.9, 1.7},
    };
    for (int c = 0; c < 6; c++) {
        sphere_error last = {0};
        for (int size = 24; size <= 96; size *= 2) {
            sphere_error e = sphere_errors(size, cases[c].primitive, cases[c].dense);
            print_message("%s %s %d: position %.2e voxel, normal %.2e rad, %zu points, %zu rejected\n",
                          iso_primitive_name(cases[c].primitive), cases[c].dense ? "rgrid" : "hgrid", size,
                          e.position, e.normal, e.count, e.rejected);
            assert_int_equal(e.rejected, 0);
            /* the error of eq. 1 is of fourth order in the gradient's: only the rounding of floats is seen */
            if (cases[c].primitive == ISO_PRIMITIVE_FOOT) assert_true(e.position < 2e-6);
            if (last.count) {
                assert_true(log2(last.position / e.position) > cases[c].position_order);
                assert_true(log2(last.normal / e.normal) > cases[c].normal_order);
                double growth = (double)e.count / (double)last.count;
                assert_true(growth > 3.5 && growth < 4.5);
            }
            last = e;
        }
        assert_true(last.position < 0.005 && last.normal < 0.001);
    }
}

static void foot_points_are_rejected_by_the_stated_rules(void **state) {
    (void)state;
    /* two slabs 1.2 voxels thick, around x = 10 and x = 12.3: |g| is small between them */
    iso_grid grid = test_hgrid((int[3]){32, 8, 8}, 3);
    for (int z = 0; z < 8; z++)
        for (int y = 0; y < 8; y++)
            for (int x = 0; x < 32; x++)
                test_set(&grid, x, y, z, fmin(3, fmin(fabs(x - 10.0), fabs(x - 12.3)) - 0.6));
    iso_points_opts opts = {.floats = true};
    iso_point_set *set = test_point_set(&grid, &opts);
    iso_points_stats stats = iso_point_set_stats(set);
    /* x = 8, 9, 13 and 14 have feet; x = 11 lies between the slabs, |g| = 0.15 */
    assert_int_equal(stats.points, 4 * 64);
    assert_int_equal(stats.rejected, 64);
    iso_point_view view = iso_point_set_view(set);
    for (size_t i = 0; i < stats.points; i++) {
        iso_surfel p = iso_point_view_get(&view, i);
        near(p.position[0], p.normal[0] < 0 ? 9.4 : 12.9, 1e-5);
    }
    /* at tau = 1.5 the band [1.5, 3.23) reaches clamped voxels, whose distance is not known */
    iso_point_set_isovalue(set, 1.5);
    assert_int_equal(iso_point_set_update(set, NULL), ISO_OK);
    view = iso_point_set_view(set);
    stats = iso_point_set_stats(set);
    assert_int_equal(stats.points, 0); /* x = 7 and 15 are in the band and have a clamped neighbour */
    assert_int_equal(stats.rejected, 64 * 2 + 64 * (7 + 16));
    iso_point_set_destroy(set);
    iso_grid_destroy(&grid);

    iso_grid dense = test_rgrid((int[3]){8, 8, 8}, ISO_FLOAT32);
    iso_error error = {0};
    opts.primitive = ISO_PRIMITIVE_FOOT;
    assert_int_equal(iso_point_set_create(&dense, &opts, &set, &error), ISO_ERR_USAGE);
    assert_non_null(strstr(error.text, "distance field"));
    opts = (iso_points_opts){.isovalue = INFINITY};
    assert_int_equal(iso_point_set_create(&dense, &opts, &set, &error), ISO_ERR_USAGE);
    iso_grid_destroy(&dense);
}

/* Every voxel of the band has a foot point or was rejected, also in bricks that lie wholly in the band. */
static void every_voxel_of_the_band_counts(void **state) {
    (void)state;
    test_random random = {4};
    for (int round = 0; round < 30; round++) {
        int dims[3];
        test_random_dims(&random, 1, 50, dims);
        iso_grid grid = test_rgrid(dims, ISO_FLOAT32);
        grid.rgrid->level_set = 1;
        double slope = test_random_real(&random, 0, 0.3), low = test_random_real(&random, -3, 2);
        double isovalue = test_random_real(&random, -0.2, 0.2);
        size_t wanted = 0;
        for (int i = 0; i < dims[0] * dims[1] * dims[2]; i++) {
            int x = i % dims[0], y = i / dims[0] % dims[1], z = i / dims[0] / dims[1];
            test_set(&grid, x, y, z, low + slope * (x + 0.3 * y));
            double distance = iso_grid_at(&grid, x, y, z) - isovalue;
            wanted += distance >= 0 && distance < sqrt(3);
        }
        const iso_points_opts opts = {.isovalue = isovalue, .primitive = ISO_PRIMITIVE_FOOT};
        iso_point_set *set = test_point_set(&grid, &opts);
        iso_points_stats stats = iso_point_set_stats(set);
        assert_int_equal(stats.points + stats.rejected, wanted);
        iso_point_set_destroy(set);
        iso_grid_destroy(&grid);
    }
}

/* Whether a voxel is on the outer side and a corner of a cell with corners on both, all of them finite. */
static bool is_outer_corner(const iso_grid *grid, const int v[3], double isovalue) {
    const int *dims = iso_grid_dims(grid);
    bool inside = iso_grid_at(grid, v[0], v[1], v[2]) >= isovalue;
    if (inside != (iso_grid_is_level_set(grid) != 0)) return false;
    for (int cell = 0; cell < 8; cell++) {
        const int low[3] = {v[0] - (cell & 1), v[1] - (cell >> 1 & 1), v[2] - (cell >> 2)};
        int count = 0;
        bool exists = true;
        for (int axis = 0; axis < 3; axis++) exists = exists && low[axis] >= 0 && low[axis] + 1 < dims[axis];
        for (int i = 0; i < 8; i++) {
            const float value = iso_grid_at(grid, low[0] + (i & 1), low[1] + (i >> 1 & 1), low[2] + (i >> 2));
            exists = exists && isfinite(value);
            count += value >= isovalue;
        }
        if (exists && count > 0 && count < 8) return true;
    }
    return false;
}

static size_t count_outer_corners(const iso_grid *grid, double isovalue) {
    const int *dims = iso_grid_dims(grid);
    size_t count = 0;
    for (int z = 0; z < dims[2]; z++)
        for (int y = 0; y < dims[1]; y++)
            for (int x = 0; x < dims[0]; x++) count += is_outer_corner(grid, (int[3]){x, y, z}, isovalue);
    return count;
}

/* Eq. 2 on fields that are no distances: the feet lie on the trilinear surface. */
static void iterated_foot_points_lie_on_the_surface(void **state) {
    (void)state;
    test_random random = {5};
    size_t points = 0, rejected = 0;
    for (int round = 0; round < 24; round++) {
        int dims[3];
        test_random_dims(&random, 2, 36, dims);
        iso_grid grid = test_rgrid(dims, all_types[round % 4]);
        test_fill(&grid, TEST_SMOOTH, &random);
        if (round >= 16) /* a surface between two bricks, and nothing else in the upper one */
            for (int i = 0; i < dims[0] * dims[1] * dims[2]; i++) {
                const int v[3] = {i % dims[0], i / dims[0] % dims[1], i / dims[0] / dims[1]};
                test_set(&grid, v[0], v[1], v[2], 180 - 5.1 * v[round % 3]);
            }
        grid.rgrid->level_set = round % 3 == 0;
        const iso_points_opts opts = {
            .isovalue = 100, .floats = true, .primitive = ISO_PRIMITIVE_FOOT_ITERATED};
        iso_point_set *set = test_point_set(&grid, &opts);
        iso_point_view view = iso_point_set_view(set);
        for (size_t s = 0; s < view.span_count; s++)
            for (uint32_t i = 0; i < view.spans[s].count; i++) {
                iso_surfel p = iso_point_view_get(&view, view.spans[s].first + i);
                const int32_t *b = view.spans[s].brick;
                iso_vec3 at = {16 * b[0] + p.position[0], 16 * b[1] + p.position[1],
                               16 * b[2] + p.position[2]};
                iso_vec3 g = iso_grid_gradient(&grid, at);
                near(iso_grid_sample(&grid, at), 100, 1.5e-4 * iso_vec3_length(g) + 1e-4);
                iso_vec3 n = {p.normal[0], p.normal[1], p.normal[2]};
                double sign = grid.rgrid->level_set ? 1 : -1;
                near(iso_vec3_dot(iso_vec3_unit(g), n), sign, 1e-4);
            }
        iso_points_stats stats = iso_point_set_stats(set);
        assert_int_equal(stats.points + stats.rejected, count_outer_corners(&grid, 100));
        points += stats.points;
        rejected += stats.rejected;
        iso_point_set_destroy(set);
        iso_grid_destroy(&grid);
    }
    print_message("%zu iterated foot points, %zu seeds rejected\n", points, rejected);
    assert_true(points > 10000 && rejected < points / 3);
}

/* Eq. 2 voxel by voxel, on the whole grid; false: the voxel has no foot. */
static bool reference_foot(const iso_grid *grid, double isovalue, const int voxel[3], iso_vec3 *foot) {
    const int *dims = iso_grid_dims(grid);
    const iso_vec3 seed = iso_vec3_make(voxel[0], voxel[1], voxel[2]);
    iso_vec3 p = seed;
    for (int step = 0; step <= 10; step++) {
        const double excess = iso_grid_sample(grid, p) - isovalue;
        const iso_vec3 g = iso_grid_gradient(grid, p), way = iso_vec3_sub(p, seed);
        const double squared = iso_vec3_dot(g, g);
        if (!(iso_vec3_dot(way, way) < 4) || p.x < 0 || p.y < 0 || p.z < 0 || p.x > dims[0] - 1 ||
            p.y > dims[1] - 1 || p.z > dims[2] - 1 || !(squared > 0) || !isfinite(excess))
            return false;
        *foot = p;
        if (fabs(excess) <= 1e-4 * sqrt(squared)) return true;
        p = iso_vec3_sub(p, iso_vec3_scale(g, excess / squared));
    }
    return false;
}

/* Feet that are found from the surroundings of a brick are those of the whole grid, bit for bit: at borders,
 * along axes of one voxel, and beside voxels that are not finite. */
static void iterated_foot_points_are_those_of_the_whole(void **state) {
    (void)state;
    test_random random = {8};
    size_t points = 0;
    for (int round = 0; round < 16; round++) {
        int dims[3];
        test_random_dims(&random, 2, 40, dims);
        if (round % 4 == 3) dims[round / 4 % 3] = 1;
        iso_grid grid = test_rgrid(dims, ISO_FLOAT32);
        test_fill(&grid, round % 2 ? TEST_NOISE : TEST_SMOOTH, &random);
        if (round % 4 > 1) test_scatter_nonfinite(&grid, &random);
        const iso_points_opts opts = {100, ISO_PRIMITIVE_FOOT_ITERATED, .floats = true};
        iso_point_set *set = test_point_set(&grid, &opts);
        const iso_point_view view = iso_point_set_view(set);
        for (size_t s = 0; s < view.span_count; s++) {
            const iso_point_span *span = &view.spans[s];
            uint32_t found = 0;
            for (int i = 0; i < ISO_BRICK_VOXELS; i++) {
                const int v[3] = {16 * span->brick[0] + i % 16, 16 * span->brick[1] + i / 16 % 16,
                                  16 * span->brick[2] + i / 256};
                iso_vec3 foot = {0, 0, 0};
                if (v[0] >= dims[0] || v[1] >= dims[1] || v[2] >= dims[2]) continue;
                if (!is_outer_corner(&grid, v, 100) || !reference_foot(&grid, 100, v, &foot)) continue;
                assert_true(found < span->count);
                const iso_surfel got = iso_point_view_get(&view, span->first + found++);
                const double wanted[3] = {foot.x, foot.y, foot.z};
                for (int k = 0; k < 3; k++)
                    assert_true(got.position[k] == (float)(wanted[k] - 16 * span->brick[k]));
            }
            assert_int_equal(found, span->count);
            points += found;
        }
        iso_point_set_destroy(set);
        iso_grid_destroy(&grid);
    }
    assert_true(points > 5000);
}

/* ---- sets */

static void packed_points_are_the_floats_packed(void **state) {
    (void)state;
    iso_grid grid = test_ball_grid(40, iso_vec3_make(20.2, 19.7, 20.4), 13, 0);
    grid.hgrid->transform.spacing[1] = 3;
    for (int primitive = ISO_PRIMITIVE_EDGE; primitive <= ISO_PRIMITIVE_FOOT_ITERATED; primitive++) {
        iso_points_opts opts = {.primitive = (iso_primitive)primitive};
        iso_point_set *packed = test_point_set(&grid, &opts);
        opts.floats = true;
        iso_point_set *floats = test_point_set(&grid, &opts);
        iso_point_view a = iso_point_set_view(packed), b = iso_point_set_view(floats);
        assert_null(a.surfels);
        assert_null(b.packed);
        near(a.radius, 3 * sqrt(2) / 2, 1e-12);
        size_t count = iso_point_view_count(&a);
        assert_true(count > 1000);
        assert_int_equal(iso_point_view_count(&b), count);
        assert_int_equal(a.span_count, b.span_count);
        assert_memory_equal(a.spans, b.spans, a.span_count * sizeof *a.spans);
        for (size_t i = 0; i < count; i++)
            assert_int_equal(a.packed[i].bits, iso_point_pack(&b.surfels[i]).bits);
        iso_point_set_destroy(packed);
        iso_point_set_destroy(floats);
    }
    iso_grid_destroy(&grid);
}

static void same_bytes_for_any_thread_count(void **state) {
    (void)state;
    test_random random = {11};
    iso_grid grid = test_rgrid((int[3]){70, 50, 90}, ISO_UINT8);
    test_fill(&grid, TEST_SMOOTH, &random);
    const int threads[] = {2, 7};
    for (int primitive = ISO_PRIMITIVE_EDGE; primitive <= ISO_PRIMITIVE_FOOT_ITERATED; primitive++) {
        if (primitive == ISO_PRIMITIVE_FOOT) continue;
        iso_points_opts opts = {.isovalue = 100, .primitive = (iso_primitive)primitive, .curvature = true};
        iso_point_set *one = test_point_set(&grid, &opts);
        iso_point_view a = iso_point_set_view(one);
        for (int t = 0; t < 2; t++) {
            assert_int_equal(iso_pool_create(threads[t], &opts.pool, NULL), ISO_OK);
            iso_point_set *many = test_point_set(&grid, &opts);
            iso_point_view b = iso_point_set_view(many);
            assert_int_equal(a.span_count, b.span_count);
            assert_memory_equal(a.spans, b.spans, a.span_count * sizeof *a.spans);
            assert_memory_equal(a.packed, b.packed, iso_point_view_count(&a) * sizeof *a.packed);
            assert_memory_equal(a.curvatures, b.curvatures, iso_point_view_count(&a) * sizeof *a.curvatures);
            assert_int_equal(iso_point_set_stats(one).rejected, iso_point_set_stats(many).rejected);
            iso_point_set_destroy(many);
            iso_pool_destroy(opts.pool);
        }
        iso_point_set_destroy(one);
    }
    iso_grid_destroy(&grid);
}

static void follow(const iso_grid *grid, const iso_points_opts *opts, iso_point_set *followed) {
    assert_int_equal(iso_point_set_update(followed, NULL), ISO_OK);
    iso_point_set *fresh = test_point_set(grid, opts);
    iso_point_view a = iso_point_set_view(followed), b = iso_point_set_view(fresh);
    test_same_points(&a, &b);
    iso_point_set_destroy(fresh);
}

static void check_followed_edits(const iso_grid *grid, iso_primitive primitive, int edits, uint64_t seed) {
    test_random random = {seed};
    const iso_points_opts opts = {.isovalue = iso_grid_is_level_set(grid) ? 0 : 100,
                                  .primitive = primitive,
                                  .floats = seed % 2,
                                  .curvature = true};
    iso_point_set *followed = test_point_set(grid, &opts);
    for (int edit = 0; edit < edits; edit++) {
        int together = test_random_int(&random, 1, 3);
        for (int i = 0; i < together; i++) test_random_edit(grid, &random);
        follow(grid, &opts, followed);
    }
    iso_point_set_destroy(followed);
}

static void following_edits_equals_extracting_everything(void **state) {
    (void)state;
    test_random random = {21};
    const int dims[3] = {45, 33, 52};
    for (int type = 0; type < 4; type++)
        for (int primitive = ISO_PRIMITIVE_EDGE; primitive <= ISO_PRIMITIVE_FOOT_ITERATED; primitive++) {
            if (primitive == ISO_PRIMITIVE_FOOT) continue;
            iso_grid grid = test_rgrid(dims, all_types[type]);
            test_fill(&grid, type % 2 ? TEST_SMOOTH : TEST_NOISE, &random);
            bool slow = primitive == ISO_PRIMITIVE_FOOT_ITERATED;
            check_followed_edits(&grid, (iso_primitive)primitive, slow ? 15 : 60, (uint64_t)type);
            iso_grid_destroy(&grid);
        }
    for (int dense = 0; dense < 2; dense++)
        for (int primitive = ISO_PRIMITIVE_EDGE; primitive <= ISO_PRIMITIVE_FOOT_ITERATED; primitive++) {
            iso_grid grid = test_ball_grid(60, iso_vec3_make(30, 30, 30), 20, dense);
            check_followed_edits(&grid, (iso_primitive)primitive, 60, (uint64_t)(7 + dense));
            iso_grid_destroy(&grid);
        }
}

/* The change of one voxel, near the corners of bricks where halos matter: none is too narrow. */
static void single_voxels_are_followed(void **state) {
    (void)state;
    test_random random = {31};
    for (int primitive = ISO_PRIMITIVE_EDGE; primitive <= ISO_PRIMITIVE_FOOT_ITERATED; primitive++) {
        iso_grid grid = test_rgrid((int[3]){36, 35, 34}, ISO_FLOAT32);
        test_fill(&grid, TEST_SMOOTH, &random);
        grid.rgrid->level_set = primitive == ISO_PRIMITIVE_FOOT;
        const iso_points_opts opts = {
            .isovalue = 100, .primitive = (iso_primitive)primitive, .floats = true, .curvature = true};
        iso_point_set *followed = test_point_set(&grid, &opts);
        for (int edit = 0; edit < (primitive == ISO_PRIMITIVE_FOOT_ITERATED ? 40 : 200); edit++) {
            int v[3];
            for (int axis = 0; axis < 3; axis++) {
                v[axis] = 16 * test_random_int(&random, 0, 2) + test_random_int(&random, -4, 3);
                v[axis] = v[axis] < 0 ? 0 : v[axis] > 33 ? 33 : v[axis];
            }
            /* within the band of distances too, or few foot points would see the change */
            test_set(&grid, v[0], v[1], v[2], test_random_real(&random, 50, edit % 2 ? 150 : 101));
            assert_int_equal(iso_rgrid_mark_changed(grid.rgrid, v, v, NULL), ISO_OK);
            follow(&grid, &opts, followed);
            assert_true(iso_point_set_stats(followed).bricks <= 8);
        }
        iso_point_set_destroy(followed);
        iso_grid_destroy(&grid);
    }
}

/* Most bricks lose their points, then one gains more than any hole holds: all blocks slide together. */
static void sliding_keeps_the_points(void **state) {
    (void)state;
    test_random random = {33};
    iso_grid grid = test_rgrid((int[3]){96, 96, 96}, ISO_UINT8);
    uint8_t *voxels = grid.rgrid->data;
    for (int i = 0; i < 96 * 96 * 96; i++) voxels[i] = test_random_int(&random, 0, 15) ? 0 : 200;
    const iso_points_opts opts = {.isovalue = 100, .floats = true};
    iso_point_set *followed = test_point_set(&grid, &opts);
    iso_point_view before = iso_point_set_view(followed);
    size_t last = before.spans[before.span_count - 1].first;
    for (int brick = 0; brick < 216; brick++) {
        if (brick % 4 == 3) continue;
        const int lo[3] = {brick % 6 * 16, brick / 6 % 6 * 16, brick / 36 * 16};
        const int hi[3] = {lo[0] + 15, lo[1] + 15, lo[2] + 15};
        for (int i = 0; i < ISO_BRICK_VOXELS; i++)
            test_set(&grid, lo[0] + i % 16, lo[1] + i / 16 % 16, lo[2] + i / 256,
                     brick < 200 ? 0 : test_random_int(&random, 0, 255));
        assert_int_equal(iso_rgrid_mark_changed(grid.rgrid, lo, hi, NULL), ISO_OK);
        follow(&grid, &opts, followed);
    }
    iso_point_view after = iso_point_set_view(followed);
    size_t moved = SIZE_MAX;
    for (size_t i = 0; i < after.span_count; i++)
        if (after.spans[i].brick[0] == 5 && after.spans[i].brick[1] == 5 && after.spans[i].brick[2] == 5)
            moved = after.spans[i].first;
    assert_true(moved < last); /* the last brick was not edited, so only a slide can have moved it */
    iso_point_set_destroy(followed);
    iso_grid_destroy(&grid);
}

static void few_bricks_are_extracted(void **state) {
    (void)state;
    iso_grid grid = test_rgrid((int[3]){96, 96, 96}, ISO_UINT8);
    test_random random = {41};
    test_fill(&grid, TEST_NOISE, &random);
    const iso_points_opts opts = {.isovalue = 100};
    iso_point_set *set = test_point_set(&grid, &opts);
    assert_int_equal(iso_point_set_stats(set).bricks, 216);
    assert_int_equal(iso_point_set_update(set, NULL), ISO_OK);
    assert_int_equal(iso_point_set_stats(set).bricks, 0);
    const struct {
        int voxel[3];
        size_t bricks;
    } cases[] = {{{40, 40, 40}, 1}, {{33, 40, 40}, 2}, {{34, 40, 40}, 1}, {{47, 40, 40}, 2},
                 {{46, 40, 40}, 1}, {{32, 32, 32}, 8}, {{0, 0, 0}, 1},    {{95, 95, 95}, 1}};
    for (int c = 0; c < 8; c++) {
        const int *v = cases[c].voxel;
        assert_int_equal(iso_rgrid_mark_changed(grid.rgrid, v, v, NULL), ISO_OK);
        assert_int_equal(iso_point_set_update(set, NULL), ISO_OK);
        assert_int_equal(iso_point_set_stats(set).bricks, cases[c].bricks);
    }
    iso_point_set_destroy(set);
    iso_grid_destroy(&grid);
}

/* ---- memory */

static size_t extent_of(const iso_point_view *view) {
    size_t extent = 0;
    for (size_t i = 0; i < view->span_count; i++) {
        size_t end = view->spans[i].first + view->spans[i].count;
        if (end > extent) extent = end;
    }
    return extent;
}

static void thousands_of_edits_take_bounded_memory(void **state) {
    (void)state;
    iso_grid grid = test_rgrid((int[3]){64, 64, 64}, ISO_UINT8);
    const iso_points_opts opts = {.isovalue = 100};
    iso_point_set *set = test_point_set(&grid, &opts);
    test_random random = {51};
    size_t worst = 0, peak = 0;
    for (int edit = 0; edit < 6000; edit++) {
        int lo[3], hi[3], noise = test_random_int(&random, 0, 1);
        for (int axis = 0; axis < 3; axis++) {
            lo[axis] = test_random_int(&random, 0, 59);
            hi[axis] = lo[axis] + test_random_int(&random, 0, 63 - lo[axis] < 15 ? 63 - lo[axis] : 15);
        }
        for (int z = lo[2]; z <= hi[2]; z++)
            for (int y = lo[1]; y <= hi[1]; y++)
                for (int x = lo[0]; x <= hi[0]; x++)
                    test_set(&grid, x, y, z, noise ? test_random_real(&random, 0, 200) : 0);
        assert_int_equal(iso_rgrid_mark_changed(grid.rgrid, lo, hi, NULL), ISO_OK);
        assert_int_equal(iso_point_set_update(set, NULL), ISO_OK);
        iso_point_view view = iso_point_set_view(set);
        size_t extent = extent_of(&view), count = iso_point_view_count(&view);
        if (extent > worst) worst = extent;
        if (count > peak) peak = count;
        /* a block is at most 2.25 times its points, the array twice its blocks, and there is a slack */
        assert_true(extent <= 5 * peak + 2 * ISO_SPAN_HEAP_SLACK);
        for (size_t i = 0; i < view.span_count; i++) assert_true(view.spans[i].count > 0);
    }
    iso_point_view view = iso_point_set_view(set);
    iso_point_set *fresh = test_point_set(&grid, &opts);
    iso_point_view wanted = iso_point_set_view(fresh);
    test_same_points(&view, &wanted);
    print_message("6000 edits: at most %zu points of space, %zu points at the end\n", worst,
                  iso_point_view_count(&view));
    iso_point_set_destroy(fresh);
    iso_point_set_destroy(set);
    iso_grid_destroy(&grid);
}

/* ---- bounds */

static void check_bounds(const iso_point_view *view, const iso_point_bounds *bounds, size_t first,
                         size_t count) {
    iso_point_bounds wanted;
    for (int k = 0; k < 3; k++) {
        wanted.lo[k] = wanted.normal_lo[k] = INFINITY;
        wanted.hi[k] = wanted.normal_hi[k] = -INFINITY;
    }
    for (size_t i = first; i < first + count; i++) {
        iso_surfel s = iso_point_view_get(view, i);
        const float *p = s.position, *n = s.normal;
        if (!isfinite(p[0]) || !isfinite(p[1]) || !isfinite(p[2])) continue;
        float sum = fabsf(n[0]) + fabsf(n[1]) + fabsf(n[2]);
        for (int k = 0; k < 3; k++) {
            wanted.lo[k] = fminf(wanted.lo[k], p[k]);
            wanted.hi[k] = fmaxf(wanted.hi[k], p[k]);
            if (!(sum > 0 && sum < INFINITY)) continue;
            wanted.normal_lo[k] = fminf(wanted.normal_lo[k], n[k] / sum);
            wanted.normal_hi[k] = fmaxf(wanted.normal_hi[k], n[k] / sum);
        }
    }
    for (int k = 0; k < 3; k++) {
        if (!(wanted.lo[k] <= wanted.hi[k])) {
            assert_true(bounds->lo[k] > bounds->hi[k]);
            continue;
        }
        near(bounds->lo[k], wanted.lo[k], 1e-6);
        near(bounds->hi[k], wanted.hi[k], 1e-6);
        near(bounds->normal_lo[k], wanted.normal_lo[k], 1e-6);
        near(bounds->normal_hi[k], wanted.normal_hi[k], 1e-6);
    }
}

static void bounds_enclose_tightly(void **state) {
    (void)state;
    enum { MANY = 200 };
    test_random random = {17};
    iso_surfel surfels[MANY];
    iso_point packed[MANY];
    for (int i = 0; i < MANY; i++) {
        for (int k = 0; k < 3; k++) {
            surfels[i].position[k] = (float)test_random_real(&random, -2, 17.9);
            surfels[i].normal[k] = (float)test_random_real(&random, -1, 1);
        }
        packed[i] = iso_point_pack(&surfels[i]);
        if (i % 13 == 5) surfels[i].position[i % 3] = i % 2 ? NAN : -INFINITY;
        if (i % 17 == 3) memset(surfels[i].normal, 0, sizeof surfels[i].normal);
    }
    for (int level = ISO_CPU_GENERIC; level <= (int)iso_cpu_supported(); level++) {
        iso_cpu_limit((iso_cpu_level)level);
        for (int floats = 0; floats < 2; floats++)
            for (size_t count = 0; count < 40; count++) {
                iso_point_view view = {.packed = floats ? NULL : packed, .surfels = floats ? surfels : NULL};
                iso_point_bounds bounds;
                size_t first = (size_t)test_random_int(&random, 0, MANY - (int)count);
                iso_point_bounds_find(&view, first, count, &bounds);
                check_bounds(&view, &bounds, first, count);
            }
    }
    iso_cpu_limit(ISO_CPU_AVX512);
}

static void bounds_follow_edits(void **state) {
    (void)state;
    for (int sparse = 0; sparse < 2; sparse++)
        for (int threads = 1; threads <= 2; threads++) {
            iso_pool *pool = NULL;
            if (threads > 1) assert_int_equal(iso_pool_create(threads, &pool, NULL), ISO_OK);
            iso_grid grid = test_ball_grid(70, iso_vec3_make(34, 35, 33), 20, !sparse);
            iso_points_opts opts = {.primitive = sparse ? ISO_PRIMITIVE_FOOT : ISO_PRIMITIVE_EDGE,
                                    .pool = pool};
            iso_point_set *set = test_point_set(&grid, &opts);
            test_random random = {(uint64_t)(5 + sparse)};
            for (int edit = 0; edit < 25; edit++) {
                if (edit) test_random_edit(&grid, &random);
                assert_int_equal(iso_point_set_update(set, NULL), ISO_OK);
                assert_null(iso_point_set_view(set).bounds);
                if (edit % 4 == 3) continue; /* not asked for every time */
                assert_int_equal(iso_point_set_bound(set, NULL), ISO_OK);
                iso_point_view view = iso_point_set_view(set);
                for (size_t i = 0; i < view.span_count; i++)
                    check_bounds(&view, &view.bounds[i], view.spans[i].first, view.spans[i].count);
            }
            iso_point_set_destroy(set);
            iso_grid_destroy(&grid);
            iso_pool_destroy(pool);
        }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(edge_points_match_the_reference),
        cmocka_unit_test(isovalues_between_floats_classify_exactly),
        cmocka_unit_test(scaled_isovalues_hit_their_voxels),
        cmocka_unit_test(normals_survive_any_magnitude),
        cmocka_unit_test(spheres_converge),
        cmocka_unit_test(foot_points_are_rejected_by_the_stated_rules),
        cmocka_unit_test(every_voxel_of_the_band_counts),
        cmocka_unit_test(iterated_foot_points_lie_on_the_surface),
        cmocka_unit_test(iterated_foot_points_are_those_of_the_whole),
        cmocka_unit_test(packed_points_are_the_floats_packed),
        cmocka_unit_test(same_bytes_for_any_thread_count),
        cmocka_unit_test(following_edits_equals_extracting_everything),
        cmocka_unit_test(single_voxels_are_followed),
        cmocka_unit_test(sliding_keeps_the_points),
        cmocka_unit_test(few_bricks_are_extracted),
        cmocka_unit_test(thousands_of_edits_take_bounded_memory),
        cmocka_unit_test(bounds_enclose_tightly),
        cmocka_unit_test(bounds_follow_edits),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
