/* smooth: the isosurfaces of splines against analytic solids, against the ray caster's, and with every
 * instruction set and number of threads. */
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
#include "check_support.h"
#include "grids/spline/spline.h"
#include "scene/method.h"

enum { SIDE = 40, SIZE = 160, VOXELS = SIDE * SIDE * SIDE, SURFACE = 3, PLANE = 7 };
static const float PLANE_DEPTH = 500;
static const double CENTRE[3] = {19.63, 19.27, 19.81};

/* ---- solids: signed distances, below 0 inside */

static double ball(const double p[3], double radius) {
    return sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]) - radius;
}

static double ball_of_8(const double p[3]) {
    return ball(p, 8);
}

static double torus_of_3(const double p[3]) {
    const double ring = hypot(p[0], p[1]) - 10;
    return hypot(ring, p[2]) - 3;
}

/* A ball of radius 14, blurred by a Gaussian of .8 voxel, 0 to 1. */
static double blurred(double r) {
    const double s = 0.8, a = (14 - r) / s, b = (14 + r) / s;
    return 0.5 * (erf(a / sqrt(2)) + erf(b / sqrt(2))) -
           s / (r * sqrt(2 * acos(-1))) * (exp(-a * a / 2) - exp(-b * b / 2));
}

/* The radius of its surface at one half. */
static double blurred_radius(void) {
    double low = 12, high = 16;
    for (int i = 0; i < 60; i++) *(blurred(0.5 * (low + high)) > 0.5 ? &low : &high) = 0.5 * (low + high);
    return low;
}

static double blurred_ball(const double p[3]) {
    return ball(p, blurred_radius());
}

static double noise(uint32_t *state) {
    double sum = -6; /* nearly normal, deviation 1 */
    for (int i = 0; i < 12; i++) {
        *state = *state * 1664525u + 1013904223u;
        sum += (*state >> 8) / 16777216.0;
    }
    return sum;
}

typedef double solid_fn(const double p[3]);
typedef struct solid {
    const char *name;
    solid_fn *distance;
    bool scan;
    double noise;                                      /* of the contrast */
    double position, normal, position_was, normal_was; /* at most; the trilinear surface's, at least */
} solid;

static iso_rgrid *make_grid(const solid *s) {
    static float values[VOXELS];
    static uint8_t scan[VOXELS];
    uint32_t state = 7;
    for (int i = 0; i < VOXELS; i++) {
        const double p[3] = {i % SIDE - CENTRE[0], i / SIDE % SIDE - CENTRE[1],
                             i / (SIDE * SIDE) - CENTRE[2]};
        values[i] = (float)s->distance(p);
        if (!s->scan) continue;
        const double value = 50 + 153 * (blurred(ball(p, 0)) + s->noise * noise(&state));
        scan[i] = (uint8_t)fmin(fmax(round(value), 0), 255);
    }
    const iso_rgrid_desc desc = {
        .dims = {SIDE, SIDE, SIDE}, .type = s->scan ? ISO_UINT8 : ISO_FLOAT32, .level_set = !s->scan};
    iso_rgrid *grid;
    assert_int_equal(iso_rgrid_create(&desc, &grid, NULL), ISO_OK);
    memcpy(grid->data, s->scan ? (void *)scan : (void *)values, VOXELS * iso_type_size(grid->type));
    return grid;
}

static double isovalue_of(const solid *s) {
    return s->scan ? 50 + 153 * 0.5 : 0;
}

static iso_view view_of(double zoom, double turn) {
    iso_box box = {{0, 0, 0}, {SIDE - 1, SIDE - 1, SIDE - 1}};
    iso_camera camera = {.view_angle = 30, .orthographic = true};
    iso_vec3 forward;
    iso_direction_vectors(ISO_FRONT, iso_vec3_make(0, 0, 1), &forward, &camera.view_up);
    camera.position = iso_vec3_scale(forward, -1);
    iso_camera_fit(&camera, &box, 1, 1);
    iso_camera_orbit(&camera, turn, 41);
    iso_camera_zoom(&camera, zoom);
    return iso_view_make(&camera, SIZE, SIZE);
}

static iso_gbuffer draw(iso_rgrid *grid, double isovalue, iso_filter filter, iso_method method,
                        const iso_view *view, iso_pool *pool) {
    iso_scene_surface surface = {
        .grid = {.rgrid = grid}, .isovalue = isovalue, .pool = pool, .filter = filter};
    const iso_renderer *renderer = iso_renderer_get(method);
    iso_gbuffer to;
    iso_error error = {0};
    assert_int_equal(iso_gbuffer_create(SIZE, SIZE, &to, NULL), ISO_OK);
    iso_gbuffer_clear(&to);
    for (int i = 0; i < SIZE * SIZE && method == ISO_METHOD_EXACT; i++) {
        to.depth[i] = PLANE_DEPTH; /* farther than the solids */
        to.surface[i] = PLANE;
    }
    memset(to.normal[0], 0, SIZE * SIZE * sizeof(float));
    memset(to.normal[1], 0, SIZE * SIZE * sizeof(float));
    memset(to.normal[2], 0, SIZE * SIZE * sizeof(float));
    const iso_part part = method == ISO_METHOD_EXACT ? ISO_PART_CELLS : ISO_PART_CASTER;
    test_ok(iso_scene_surface_update(&surface, part, &error), &error);
    const iso_target target = {.view = view, .gbuffer = &to, .pool = pool, .surface = SURFACE};
    test_ok(iso_renderer_draw(renderer, &surface, &target, &error), &error);
    iso_scene_surface_free(&surface);
    return to;
}

/* Root mean squares over the samples: of the distances from the solid, voxels, and of the normals' angles,
 * degrees. */
static void measure(const iso_gbuffer *g, const iso_view *view, solid_fn *distance, double *position,
                    double *normal) {
    double squares = 0, angles = 0;
    size_t count = 0;
    for (int i = 0; i < SIZE * SIZE; i++) {
        if (g->surface[i] != SURFACE) continue;
        iso_vec3 origin, direction;
        iso_view_ray(view, i % SIZE + 0.5, i / SIZE + 0.5, &origin, &direction);
        const iso_vec3 at = iso_vec3_add(origin, iso_vec3_scale(direction, (double)g->depth[i]));
        const double p[3] = {at.x - CENTRE[0], at.y - CENTRE[1], at.z - CENTRE[2]}, d = distance(p);
        double n[3];
        for (int axis = 0; axis < 3; axis++) {
            double low[3] = {p[0], p[1], p[2]}, high[3] = {p[0], p[1], p[2]};
            low[axis] -= 1e-5;
            high[axis] += 1e-5;
            n[axis] = (distance(high) - distance(low)) / 2e-5;
        }
        const iso_vec3 true_normal = iso_vec3_unit(iso_view_vector(view, iso_vec3_make(n[0], n[1], n[2]))),
                       drawn = iso_gbuffer_normal(g, (size_t)i);
        const double dot = iso_vec3_dot(true_normal, drawn);
        const double angle = acos(fmin(fmax(dot, -1), 1)) * 180 / acos(-1);
        squares += d * d;
        angles += angle * angle;
        count++;
    }
    assert_true(count > 3000);
    *position = sqrt(squares / (double)count);
    *normal = sqrt(angles / (double)count);
}

static const solid SOLIDS[] = {
    {"distances of a ball of radius 8", ball_of_8, false, 0, 0.001, 0.05, 0.015, 0.05},
    {"distances of a torus of radius 3", torus_of_3, false, 0, 0.003, 0.2, 0.02, 0.4},
    {"scan of a ball", blurred_ball, true, 0, 0.008, 0.5, 0.012, 1.5},
    {"scan of a ball, 5 % noise", blurred_ball, true, 0.05, 0.063, 4.5, 0.05, 4},
};
enum { SOLID_COUNT = sizeof SOLIDS / sizeof *SOLIDS };

static void surfaces_are_near_analytic_ones(void **state) {
    (void)state;
    const iso_view view = view_of(1.1, 33);
    for (int i = 0; i < SOLID_COUNT; i++) {
        const solid *s = &SOLIDS[i];
        iso_rgrid *grid = make_grid(s);
        static const iso_filter filters[] = {ISO_FILTER_LINEAR, ISO_FILTER_CUBIC, ISO_FILTER_INTERPOLATING};
        double position[3], normal[3], of_truth[2];
        for (int k = 0; k < 3; k++) {
            iso_gbuffer g = draw(grid, isovalue_of(s), filters[k], ISO_METHOD_EXACT, &view, NULL);
            measure(&g, &view, s->distance, &position[k], &normal[k]);
            iso_gbuffer_free(&g);
        }
        iso_gbuffer g = draw(grid, isovalue_of(s), ISO_FILTER_CUBIC, ISO_METHOD_RAYCAST, &view, NULL);
        measure(&g, &view, s->distance, &of_truth[0], &of_truth[1]);
        iso_gbuffer_free(&g);
        printf(
            "%s: linear %.5f voxel, %.3f deg; cubic %.5f, %.3f (ray caster %.5f, %.3f); interpolating %.5f, "
            "%.3f\n",
            s->name, position[0], normal[0], position[1], normal[1], of_truth[0], of_truth[1], position[2],
            normal[2]);
        assert_true(position[0] > s->position_was && normal[0] > s->normal_was);
        assert_true(position[1] <= s->position && normal[1] <= s->normal);
        assert_true(of_truth[0] <= s->position && of_truth[1] <= s->normal);
        iso_rgrid_destroy(grid);
    }
}

/* What exact draws, without and behind which there is a far plane, against the ray caster's picture. Returns
 * the number of samples beyond 1e-3 voxel. */
static int compare_pictures(const solid *s, iso_rgrid *grid, iso_filter filter, double zoom, double turn,
                            int *hits) {
    iso_view view = view_of(zoom, turn);
    iso_gbuffer a = draw(grid, isovalue_of(s), filter, ISO_METHOD_EXACT, &view, NULL),
                b = draw(grid, isovalue_of(s), filter, ISO_METHOD_RAYCAST, &view, NULL);
    int missing = 0, extra = 0, deep = 0, tilted = 0, found = 0;
    double farthest = 0;
    for (int k = 0; k < SIZE * SIZE; k++) {
        const bool has[2] = {a.surface[k] == SURFACE, b.surface[k] == SURFACE};
        missing += !has[0] && has[1];
        extra += has[0] && !has[1];
        if (!has[0]) assert_true(a.surface[k] == PLANE && a.depth[k] == PLANE_DEPTH);
        if (!has[0] || !has[1]) continue;
        found++;
        const double off = fabs((double)a.depth[k] - (double)b.depth[k]);
        farthest = fmax(farthest, off);
        deep += off > 1e-3;
        tilted +=
            iso_vec3_dot(iso_gbuffer_normal(&a, (size_t)k), iso_gbuffer_normal(&b, (size_t)k)) < 0.99999;
    }
    if (missing || extra || deep || tilted)
        printf(
            "%s, %s, %.1f pixels a voxel, turned by %.0f: of %d samples %d missing, %d extra, %d beyond 1e-3 "
            "voxel (%.2g), %d tilted\n",
            s->name, iso_filter_names[filter], view.focal, turn, found, missing, extra, deep, farthest,
            tilted);
    assert_true(missing == 0 && extra == 0 && tilted <= 5);
    *hits += found;
    iso_gbuffer_free(&a);
    iso_gbuffer_free(&b);
    return deep;
}

static void exact_draws_what_the_ray_caster_draws(void **state) {
    (void)state;
    static const double zooms[] = {0.4, 1.7, 9};
    int hits = 0, deep = 0;
    for (int i = 0; i < SOLID_COUNT; i++) {
        iso_rgrid *grid = make_grid(&SOLIDS[i]);
        for (int k = 0; k < 12; k++)
            deep += compare_pictures(&SOLIDS[i], grid, k % 2 ? ISO_FILTER_CUBIC : ISO_FILTER_INTERPOLATING,
                                     zooms[k / 2 % 3], 33 + 50 * k + 17 * i, &hits);
        iso_rgrid_destroy(grid);
    }
    printf("%d samples of 48 pictures, none missing, %d beyond 1e-3 voxel\n", hits, deep);
    assert_true(hits > 400000 && deep <= 10);
}

static bool same(const iso_gbuffer *a, const iso_gbuffer *b) {
    const size_t bytes = SIZE * SIZE * sizeof(float);
    return memcmp(a->depth, b->depth, bytes) == 0 && memcmp(a->normal[0], b->normal[0], bytes) == 0 &&
           memcmp(a->normal[1], b->normal[1], bytes) == 0 && memcmp(a->normal[2], b->normal[2], bytes) == 0 &&
           memcmp(a->surface, b->surface, SIZE * SIZE) == 0;
}

static void bytes_are_the_same_everywhere(void **state) {
    (void)state;
    iso_pool *pool;
    assert_int_equal(iso_pool_create(3, &pool, NULL), ISO_OK);
    const iso_view view = view_of(2, 33);
    for (int i = 0; i < SOLID_COUNT; i++)
        for (iso_filter filter = ISO_FILTER_CUBIC; filter <= ISO_FILTER_INTERPOLATING; filter++) {
            iso_rgrid *grid = make_grid(&SOLIDS[i]);
            const double isovalue = isovalue_of(&SOLIDS[i]);
            iso_cpu_limit(ISO_CPU_GENERIC);
            iso_gbuffer first = draw(grid, isovalue, filter, ISO_METHOD_EXACT, &view, NULL);
            for (int level = ISO_CPU_GENERIC; level <= ISO_CPU_AVX512; level++) {
                iso_cpu_limit((iso_cpu_level)level);
                iso_gbuffer other = draw(grid, isovalue, filter, ISO_METHOD_EXACT, &view, pool);
                assert_true(same(&first, &other));
                iso_gbuffer_free(&other);
            }
            iso_gbuffer_free(&first);
            iso_rgrid_destroy(grid);
        }
    iso_cpu_limit(ISO_CPU_AVX512);
    iso_pool_destroy(pool);
}

/* ---- the spline itself */

static iso_spline *spline_of(iso_rgrid *grid, iso_filter filter) {
    iso_spline *spline;
    iso_error error = {0};
    test_ok(iso_spline_create(&(iso_grid){.rgrid = grid}, filter, NULL, &spline, &error), &error);
    return spline;
}

static double cubic(double x, double y, double z) {
    return 3 + x - 2 * y + 0.5 * z * x + 0.02 * x * x * y - 0.01 * z * z * z + 0.03 * x * y * z;
}

static void cubic_polynomials_are_reproduced(void **state) {
    (void)state;
    const iso_rgrid_desc desc = {.dims = {12, 13, 14}, .type = ISO_FLOAT32};
    iso_rgrid *grid;
    assert_int_equal(iso_rgrid_create(&desc, &grid, NULL), ISO_OK);
    for (int i = 0; i < 12 * 13 * 14; i++)
        ((float *)grid->data)[i] = (float)cubic(i % 12, i / 12 % 13, i / (12 * 13));
    iso_spline *spline = spline_of(grid, ISO_FILTER_CUBIC);
    const int cell[3] = {4, 5, 6};
    const double local[3] = {0.3, 0.8, 0.45};
    double c[ISO_SPLINE_COEFFICIENTS], gradient[3];
    assert_true(iso_spline_cell(spline, cell, false, c));
    assert_true(fabs(iso_spline_value(c, local, gradient) - cubic(4.3, 5.8, 6.45)) < 1e-4);
    assert_true(fabs(gradient[1] - (cubic(4.3, 5.8 + 1e-4, 6.45) - cubic(4.3, 5.8 - 1e-4, 6.45)) / 2e-4) <
                1e-3);
    iso_spline_destroy(spline);
    spline = spline_of(grid, ISO_FILTER_INTERPOLATING);
    assert_true(iso_spline_cell(spline, (int[3]){0, 12 - 2, 3}, false, c));
    assert_true(fabs(iso_spline_value(c, (double[3]){0, 0, 0}, gradient) - cubic(0, 10, 3)) < 1e-3);
    iso_spline_destroy(spline);
    iso_rgrid_destroy(grid);
}

static void samples_are_values(void **state) {
    (void)state;
    iso_rgrid *grid = make_grid(&SOLIDS[3]);
    for (iso_filter filter = ISO_FILTER_CUBIC; filter <= ISO_FILTER_INTERPOLATING; filter++) {
        iso_spline *spline = spline_of(grid, filter);
        static iso_spline_samples samples;
        for (int block = 0; block < 125; block++) { /* also at the border, where voxels are mirrored */
            const int at[3] = {block % 5, block / 5 % 5, block / 25};
            iso_spline_sample(spline, at, samples);
            for (int i = 0; i < 8000; i += 37) {
                double p[3] = {at[0] * 8 - 1 + i % 20 * 0.5, at[1] * 8 - 1 + i / 20 % 20 * 0.5,
                               at[2] * 8 - 1 + i / 400 * 0.5},
                       c[ISO_SPLINE_COEFFICIENTS], gradient[3];
                int cell[3];
                for (int k = 0; k < 3; k++) p[k] -= cell[k] = (int)fmin(fmax(floor(p[k]), 0), SIDE - 2);
                if (fmin(fmin(p[0], p[1]), p[2]) < 0 || fmax(fmax(p[0], p[1]), p[2]) > 1) continue;
                assert_true(iso_spline_cell(spline, cell, false, c));
                assert_true(fabs(iso_spline_value(c, p, gradient) - (double)samples[i]) < 1e-3);
            }
        }
        iso_spline_destroy(spline);
    }
    iso_rgrid_destroy(grid);
}

static void a_voxel_that_is_not_finite_empties_cells(void **state) {
    (void)state;
    iso_rgrid *grid = make_grid(&SOLIDS[0]);
    const iso_view view = view_of(1.1, 33);
    iso_gbuffer whole = draw(grid, 0, ISO_FILTER_CUBIC, ISO_METHOD_EXACT, &view, NULL);
    ((float *)grid->data)[(20 * SIDE + 12) * SIDE + 20] = NAN; /* on the surface, in front */
    iso_gbuffer a = draw(grid, 0, ISO_FILTER_CUBIC, ISO_METHOD_EXACT, &view, NULL),
                b = draw(grid, 0, ISO_FILTER_CUBIC, ISO_METHOD_RAYCAST, &view, NULL);
    int holes = 0, differ = 0;
    for (int i = 0; i < SIZE * SIZE; i++) {
        holes += a.surface[i] != whole.surface[i] || a.depth[i] > whole.depth[i] + 1;
        differ += fabsf(a.depth[i] - fminf(b.depth[i], PLANE_DEPTH)) > 1e-3f;
    }
    printf("%d samples of the hole, %d differ from the ray caster's\n", holes, differ);
    assert_true(holes > 150 && differ <= holes / 100);
    iso_error error = {0};
    iso_spline *spline;
    assert_int_equal(
        iso_spline_create(&(iso_grid){.rgrid = grid}, ISO_FILTER_INTERPOLATING, NULL, &spline, &error),
        ISO_ERR_USAGE);
    iso_gbuffer_free(&whole);
    iso_gbuffer_free(&a);
    iso_gbuffer_free(&b);
    iso_rgrid_destroy(grid);
}

static void add_distance(const int32_t brick[3], const iso_surfel *surfel, double *squares, double *normals) {
    double p[3], length = 0, n[3];
    for (int i = 0; i < 3; i++) {
        p[i] = (double)surfel->position[i] + 16.0 * brick[i] - CENTRE[i];
        n[i] = (double)surfel->normal[i];
        length += p[i] * p[i];
    }
    const double d = ball_of_8(p), dot = (p[0] * n[0] + p[1] * n[1] + p[2] * n[2]) / sqrt(length);
    *squares += d * d;
    *normals += fabs(1 - dot);
}

static void vertices_and_points_are_moved_to_the_surface(void **state) {
    (void)state;
    iso_rgrid *grid = make_grid(&SOLIDS[0]);
    iso_scene_surface surface = {.grid = {.rgrid = grid}, .filter = ISO_FILTER_CUBIC, .floats = true};
    iso_error error = {0};
    double squares[2] = {0}, normals[2] = {0};
    size_t count[2] = {0};
    for (int part = 0; part < 2; part++) {
        test_ok(iso_scene_surface_update(&surface, part ? ISO_PART_POINTS : ISO_PART_MESH, &error), &error);
        test_ok(iso_scene_surface_smooth(&surface, part ? ISO_PART_POINTS : ISO_PART_MESH, &error), &error);
    }
    const iso_mesh_view mesh = iso_mesh_set_view(surface.mesh);
    for (size_t s = 0; s < mesh.span_count; s++)
        for (uint32_t k = 0; k < mesh.spans[s].vertex_count; k++, count[0]++)
            add_distance(mesh.spans[s].brick, &mesh.vertices[mesh.spans[s].first_vertex + k], &squares[0],
                         &normals[0]);
    const iso_point_view points = iso_scene_surface_points(&surface);
    for (size_t s = 0; s < points.span_count; s++)
        for (uint32_t k = 0; k < points.spans[s].count; k++, count[1]++)
            add_distance(points.spans[s].brick, &points.surfels[points.spans[s].first + k], &squares[1],
                         &normals[1]);
    for (int part = 0; part < 2; part++) {
        printf("%zu vertices or points: %.5f voxel, cosines of normals off by %.2g\n", count[part],
               sqrt(squares[part] / (double)count[part]), normals[part] / (double)count[part]);
        assert_true(count[part] > 900 && squares[part] / (double)count[part] < 1e-6 &&
                    normals[part] / (double)count[part] < 1e-6);
    }
    iso_scene_surface_free(&surface);
    iso_rgrid_destroy(grid);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(cubic_polynomials_are_reproduced),
        cmocka_unit_test(samples_are_values),
        cmocka_unit_test(surfaces_are_near_analytic_ones),
        cmocka_unit_test(exact_draws_what_the_ray_caster_draws),
        cmocka_unit_test(bytes_are_the_same_everywhere),
        cmocka_unit_test(vertices_and_points_are_moved_to_the_surface),
        cmocka_unit_test(a_voxel_that_is_not_finite_empties_cells),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
