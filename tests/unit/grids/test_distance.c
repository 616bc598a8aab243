/* Distances from the trilinear surface of a field are those that an exhaustive search of its cells finds:
 * two balls, two tori, two scans turned by 1 degree. Those from a mesh are exact; signs. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/memory.h"
#include "extract_support.h"
#include "grids/grid_curvature.h"
#include "scene/distances.h"

enum { SIDE = 40 };

/* ---- an exhaustive search */

typedef struct search {
    const iso_grid *grid;
    iso_affine affine;
    double isovalue;
    iso_vec3 p; /* in the world */
    double best;
} search;

/* A box in a cell, in index coordinates, with the field at its corners. */
typedef struct cube {
    double lo[3], side, corner[8];
} cube;

static iso_vec3 place_of(const search *s, const cube *c, double x, double y, double z) {
    return iso_affine_point(
        &s->affine, iso_vec3_make(c->lo[0] + x * c->side, c->lo[1] + y * c->side, c->lo[2] + z * c->side));
}

/* The distance of a ball around the cube, from below. */
static double least_distance(const search *s, const cube *c) {
    const iso_vec3 middle = place_of(s, c, 0.5, 0.5, 0.5);
    double radius = 0;
    for (int i = 0; i < 8; i++)
        radius =
            fmax(radius, iso_vec3_length(iso_vec3_sub(place_of(s, c, i & 1, i >> 1 & 1, i >> 2), middle)));
    return iso_vec3_length(iso_vec3_sub(middle, s->p)) - radius;
}

static double trilinear(const double v[8], double x, double y, double z) {
    const double a = v[0] + x * (v[1] - v[0]), b = v[2] + x * (v[3] - v[2]), c = v[4] + x * (v[5] - v[4]),
                 d = v[6] + x * (v[7] - v[6]), e = a + y * (b - a), f = c + y * (d - c);
    return e + z * (f - e);
}

/* Divides a cube that the surface may cross; the field in it lies between its values at the corners. */
static void search_cube(search *s, const cube *c, int depth) {
    double least = INFINITY, most = -INFINITY;
    for (int i = 0; i < 8; i++) {
        least = fmin(least, c->corner[i]);
        most = fmax(most, c->corner[i]);
    }
    if (least > 0 || most < 0) return;
    const double distance = least_distance(s, c);
    if (distance >= s->best) return;
    if (depth == 13) {
        s->best = fmax(distance, 0);
        return;
    }
    cube parts[8];
    int order[8];
    double distances[8];
    for (int i = 0; i < 8; i++) {
        parts[i].side = c->side / 2;
        const int at[3] = {i & 1, i >> 1 & 1, i >> 2};
        for (int axis = 0; axis < 3; axis++) parts[i].lo[axis] = c->lo[axis] + at[axis] * c->side / 2;
        for (int k = 0; k < 8; k++)
            parts[i].corner[k] = trilinear(c->corner, (at[0] + (k & 1)) / 2.0, (at[1] + (k >> 1 & 1)) / 2.0,
                                           (at[2] + (k >> 2)) / 2.0);
        distances[i] = least_distance(s, &parts[i]);
        int k = i;
        for (; k > 0 && distances[order[k - 1]] > distances[i]; k--) order[k] = order[k - 1];
        order[k] = i;
    }
    for (int i = 0; i < 8; i++) search_cube(s, &parts[order[i]], depth + 1);
}

/* The distance, without a sign, within 1e-3 of a voxel's diagonal. `above`: a distance that is too large. */
static double search_all(search *s, double above) {
    const int *dims = iso_grid_dims(s->grid);
    s->best = above;
    for (int z = 0; z + 1 < dims[2]; z++)
        for (int y = 0; y + 1 < dims[1]; y++)
            for (int x = 0; x + 1 < dims[0]; x++) {
                cube c = {.lo = {x, y, z}, .side = 1};
                for (int i = 0; i < 8; i++)
                    c.corner[i] = (double)iso_grid_at(s->grid, x + (i & 1), y + (i >> 1 & 1), z + (i >> 2)) -
                                  s->isovalue;
                search_cube(s, &c, 0);
            }
    return s->best;
}

/* ---- fields */

typedef double field_function(double x, double y, double z);

static double ball(double x, double y, double z) {
    const double a = x - 19.3, b = y - 18.6, c = z - 20.1;
    return 12.4 - sqrt(a * a + b * b + c * c);
}

static double border_ball(double x, double y, double z) {
    return 20 - sqrt((x + 4) * (x + 4) + (y - 5) * (y - 5) + (z - 5) * (z - 5));
}

static double torus(double x, double y, double z) {
    const double a = sqrt((x - 19.3) * (x - 19.3) + (y - 18.6) * (y - 18.6)) - 10.7, b = z - 20.1;
    return 4.3 - sqrt(a * a + b * b);
}

static double scan(double x, double y, double z) {
    return 10 * sin(x / 3.1) * cos(y / 4.3) + 8 * sin(z / 3.7 + x / 9) + 4 * cos(y * z / 150);
}

static iso_grid make_field(field_function *function) {
    iso_grid grid = test_rgrid((const int[3]){SIDE, SIDE, SIDE}, ISO_FLOAT32);
    for (int z = 0; z < SIDE; z++)
        for (int y = 0; y < SIDE; y++)
            for (int x = 0; x < SIDE; x++) test_set(&grid, x, y, z, function(x, y, z));
    return grid;
}

/* Turns a grid about the z axis by `angle` degrees, around its middle. */
static void turn(iso_grid *grid, double angle) {
    double sine, cosine;
    iso_transform *t = &grid->rgrid->transform;
    iso_sincos(angle * ISO_PI / 180, &sine, &cosine);
    const double direction[9] = {cosine, -sine, 0, sine, cosine, 0, 0, 0, 1}, middle = (SIDE - 1) / 2.0;
    memcpy(t->direction, direction, sizeof direction);
    t->origin[0] = middle - (cosine * t->spacing[0] - sine * t->spacing[1]) * middle;
    t->origin[1] = middle - (sine * t->spacing[0] + cosine * t->spacing[1]) * middle;
}

/* Compares distances from a field at random points with those of the search. near: the points are so near
 * to vertices of the surface; else anywhere. */
static void compare(const iso_grid *grid, double isovalue, double near, int count, double tolerance) {
    iso_distance *distance;
    iso_weld weld;
    test_random random = {.state = 7};
    iso_nearby last = {0};
    assert_int_equal(iso_distance_of_isosurface(grid, isovalue, NULL, &distance, NULL), ISO_OK);
    assert_int_equal(iso_isosurface_mesh(grid, isovalue, NULL, &weld, NULL), ISO_OK);
    search s = {.grid = grid,
                .affine = iso_transform_affine(iso_grid_transform(grid)),
                .isovalue = iso_grid_stored(grid, isovalue)};
    double worst = 0;
    for (int i = 0; i < count; i++) {
        const float *v =
            weld.vertices[(size_t)test_random_int(&random, 0, (int)weld.vertex_count - 1)].position;
        const iso_vec3 vertex =
            iso_affine_point(&s.affine, iso_vec3_make((double)v[0], (double)v[1], (double)v[2]));
        s.p = near > 0 ? iso_vec3_add(vertex, iso_vec3_scale(test_random_direction(&random),
                                                             test_random_real(&random, 0, near)))
                       : iso_vec3_make(test_random_real(&random, -10, SIDE + 10),
                                       test_random_real(&random, -10, SIDE + 10),
                                       test_random_real(&random, -10, SIDE + 10));
        const double found = fabs(iso_distance_at(distance, s.p, &last));
        worst = fmax(worst, fabs(found - search_all(&s, found + 0.01)));
    }
    if (worst > tolerance) fail_msg("distances are wrong by %g", worst);
    iso_nearby_free(&last);
    iso_weld_free(&weld);
    iso_distance_destroy(distance);
}

static void distances_are_those_of_the_trilinear_surface(void **state) {
    (void)state;
    field_function *const fields[] = {ball, torus, scan};
    for (size_t i = 0; i < sizeof fields / sizeof *fields; i++) {
        iso_grid grid = make_field(fields[i]);
        compare(&grid, 0, 0, 6, 1e-3);
        compare(&grid, 0, 3, 15, 1e-3);
        turn(&grid, 1);
        compare(&grid, 0, 2, 15, 1e-3);
        grid.rgrid->transform.spacing[0] = 0.6;
        grid.rgrid->transform.spacing[2] = 2.5;
        turn(&grid, 37);
        compare(&grid, 0, 3, 8, 1e-3);
        iso_grid_destroy(&grid);
    }
}

/* Distances from a ball are those of its centre less its radius, below 0 inside. */
static void distances_have_signs(void **state) {
    (void)state;
    iso_grid grid = make_field(ball);
    iso_distance *distance;
    assert_int_equal(iso_distance_of_isosurface(&grid, 0, NULL, &distance, NULL), ISO_OK);
    test_random random = {.state = 5};
    for (int i = 0; i < 300; i++) {
        const double r = test_random_real(&random, 3, 30);
        const iso_vec3 p =
            iso_vec3_add(iso_vec3_make(19.3, 18.6, 20.1), iso_vec3_scale(test_random_direction(&random), r));
        iso_nearby nearby = {0};
        const double found = iso_distance_at(distance, p, &nearby);
        /* linear interpolation of the distance is wrong by at most 3 / (8 r) at the surface */
        assert_true(fabs(found - (r - 12.4)) < 3 / (8 * 11.4));
    }
    iso_distance_destroy(distance);
    assert_int_equal(iso_distance_of_isosurface(&grid, 50, NULL, &distance, NULL), ISO_ERR_EMPTY);
    iso_grid_destroy(&grid);
}

static void distances_from_a_mesh_are_exact(void **state) {
    (void)state;
    float vertices[4][3] = {{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {0, 0, 4}};
    uint32_t triangles[4][3] = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
    const iso_triangles mesh = {vertices, triangles, 4, 4, NULL}, none = {vertices, triangles, 4, 0, NULL};
    iso_distance *distance;
    iso_nearby nearby = {0};
    assert_int_equal(iso_distance_of_mesh(&none, &distance, NULL), ISO_ERR_EMPTY);
    assert_int_equal(iso_distance_of_mesh(&mesh, &distance, NULL), ISO_OK);
    assert_true(fabs(iso_distance_at(distance, iso_vec3_make(1, 1, -2), &nearby) - 2) < 1e-12);
    assert_true(fabs(iso_distance_at(distance, iso_vec3_make(1, 1, 0.25), &nearby) + 0.25) < 1e-12);
    assert_true(fabs(iso_distance_at(distance, iso_vec3_make(4, 4, 4), &nearby) - 8 / sqrt(3)) < 1e-12);
    assert_true(fabs(iso_distance_at(distance, iso_vec3_make(-3, -4, 0), &nearby) - 5) < 1e-12);
    iso_distance_destroy(distance);
}

static void curvature_is_that_of_a_ball_and_a_torus(void **state) {
    (void)state;
    iso_grid grid = make_field(ball);
    iso_transform *t = &grid.rgrid->transform;
    t->spacing[0] = t->spacing[1] = t->spacing[2] = 0.5;
    const iso_affine affine = iso_transform_affine(t);
    test_random random = {.state = 3};
    for (int i = 0; i < 100; i++) {
        const iso_vec3 p = iso_vec3_add(iso_vec3_make(19.3, 18.6, 20.1),
                                        iso_vec3_scale(test_random_direction(&random), 12.4));
        assert_true(fabs(iso_grid_mean_curvature(&grid, &affine, p) * 6.2 - 1) < 0.01);
    }
    iso_grid_destroy(&grid);
    grid = make_field(border_ball);
    const iso_affine whole = iso_transform_affine(iso_grid_transform(&grid));
    for (double x = 0; x < 2; x += 0.25) { /* as far as the border the ball goes on */
        const double y = sqrt(20 * 20 - (x + 4) * (x + 4)) * sqrt(0.5);
        const double found = iso_grid_mean_curvature(&grid, &whole, iso_vec3_make(x, 5 + y, 5 + y));
        assert_true(found * 20 > 0.4 && found * 20 < 1.1);
    }
    iso_grid_destroy(&grid);
    grid = make_field(torus);
    const iso_affine own = iso_transform_affine(iso_grid_transform(&grid));
    const double outer = 0.5 * (1 / 4.3 + 1 / 15.0), inner = 0.5 * (1 / 4.3 - 1 / 6.4);
    assert_true(fabs(iso_grid_mean_curvature(&grid, &own, iso_vec3_make(19.3 + 15, 18.6, 20.1)) / outer - 1) <
                0.06);
    assert_true(
        fabs(iso_grid_mean_curvature(&grid, &own, iso_vec3_make(19.3 + 6.4, 18.6, 20.1)) / inner - 1) < 0.2);
    test_set(&grid, 20, 20, 20, (double)NAN);
    assert_true(isnan(iso_grid_mean_curvature(&grid, &own, iso_vec3_make(20.5, 20.5, 20.5))));
    iso_grid_destroy(&grid);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(distances_are_those_of_the_trilinear_surface),
        cmocka_unit_test(distances_have_signs),
        cmocka_unit_test(distances_from_a_mesh_are_exact),
        cmocka_unit_test(curvature_is_that_of_a_ball_and_a_torus),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
