/* Samples of pictures have the colours of the data at their places, as rays and samples in double
 * precision find them: of volumes of another resolution and place, curvature, distance, depth and normals,
 * by exact and raycast within 1/255, by mesh at its own places; gray outside; ranges. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "extract_support.h"
#include "grids/grid_curvature.h"
#include "grids/ray/ray_tracer.h"
#include "scene/coloring.h"
#include "scene/distances.h"
#include "scene/method.h"

enum { WIDTH = 150, HEIGHT = 120, SIDE = 33 };

static double wave(double x, double y, double z) {
    return 8 - 0.6 * sqrt((x - 16) * (x - 16) + (y - 15) * (y - 15) + (z - 17) * (z - 17)) +
           2 * sin(x / 2.3) + 1.5 * cos(y / 3.1 + z / 4);
}

static iso_grid make_surface_grid(void) {
    iso_grid grid = test_rgrid((const int[3]){SIDE, SIDE, SIDE}, ISO_FLOAT32);
    for (int z = 0; z < SIDE; z++)
        for (int y = 0; y < SIDE; y++)
            for (int x = 0; x < SIDE; x++) test_set(&grid, x, y, z, wave(x, y, z));
    return grid;
}

/* A coarser volume, turned and moved, of integers with a scale; it ends within the surface. */
static iso_grid make_data(void) {
    iso_grid grid = test_rgrid((const int[3]){11, 9, 10}, ISO_INT16);
    iso_transform *t = &grid.rgrid->transform;
    const double direction[9] = {0.8, -0.6, 0, 0.6, 0.8, 0, 0, 0, 1}, spacing[3] = {3, 4, 2.5},
                 origin[3] = {14, -10, 3};
    memcpy(t->direction, direction, sizeof direction);
    memcpy(t->spacing, spacing, sizeof spacing);
    memcpy(t->origin, origin, sizeof origin);
    grid.rgrid->scale = 0.5;
    grid.rgrid->offset = -20;
    test_random random = {.state = 11};
    for (int z = 0; z < 10; z++)
        for (int y = 0; y < 9; y++)
            for (int x = 0; x < 11; x++) test_set(&grid, x, y, z, test_random_int(&random, -200, 200));
    return grid;
}

/* The trilinear value in double, clamped within half a voxel outside. */
static double sample(const iso_grid *grid, iso_vec3 place) {
    const iso_affine affine = iso_transform_affine(iso_grid_transform(grid));
    const iso_vec3 index = iso_affine_point_to_index(&affine, place);
    const double p[3] = {index.x, index.y, index.z};
    double sum = 0, part[3];
    int low[3];
    for (int axis = 0; axis < 3; axis++) {
        const int last = iso_grid_dims(grid)[axis] - 1;
        if (p[axis] < -0.5 - 1e-9 || p[axis] > last + 0.5 + 1e-9) return (double)NAN;
        const double at = fmin(fmax(p[axis], 0), last);
        low[axis] = (int)fmin(floor(at), last - 1);
        part[axis] = at - low[axis];
    }
    for (int i = 0; i < 8; i++) {
        double weight = 1;
        for (int axis = 0; axis < 3; axis++) weight *= i >> axis & 1 ? part[axis] : 1 - part[axis];
        sum += weight * (double)iso_grid_at(grid, low[0] + (i & 1), low[1] + (i >> 1 & 1), low[2] + (i >> 2));
    }
    return iso_grid_physical(grid, sum);
}

typedef struct fixture {
    iso_grid grid, data, other;
    iso_scene_surface surface;
    iso_ray_tracer *tracer;
    iso_distance *distance;
    iso_coloring coloring;
} fixture;

static void set_up(fixture *f, iso_pool *pool) {
    memset(f, 0, sizeof *f);
    f->grid = make_surface_grid();
    f->data = make_data();
    f->surface = (iso_scene_surface){.grid = f->grid, .isovalue = 0.3, .pool = pool};
    assert_int_equal(iso_scene_surface_prepare(&f->surface, ISO_PART_CELLS, NULL), ISO_OK);
    assert_int_equal(iso_scene_surface_prepare(&f->surface, ISO_PART_MESH, NULL), ISO_OK);
    assert_int_equal(iso_scene_surface_prepare(&f->surface, ISO_PART_CASTER, NULL), ISO_OK);
    assert_int_equal(iso_ray_tracer_create(&f->grid, 0.3, NULL, &f->tracer, NULL), ISO_OK);
    assert_int_equal(iso_distance_of_isosurface(&f->grid, 2, NULL, &f->distance, NULL), ISO_OK);
    f->coloring.bar = (iso_color_bar){.map = ISO_COLORMAP_GRAY};
}

static void tear_down(fixture *f) {
    iso_distance_destroy(f->distance);
    iso_ray_tracer_destroy(f->tracer);
    iso_scene_surface_free(&f->surface);
    iso_grid_destroy(&f->grid);
    iso_grid_destroy(&f->data);
}

static void set_source(fixture *f, iso_color_source source) {
    static const double ranges[][2] = {{-100, 60}, {-0.2, 0.3}, {-1, 5}, {60, 100}, {0, 1}};
    f->coloring.source = source;
    f->coloring.distance = f->distance;
    f->coloring.bar.low = ranges[source][0];
    f->coloring.bar.high = ranges[source][1];
    iso_coloring_set_grid(&f->coloring, source == ISO_COLOR_BY_VOLUME ? &f->data : &f->grid);
}

static iso_camera camera_of(double zoom) {
    const iso_vec3 middle = {16, 15, 17};
    iso_camera camera = {.focal_point = {19, 14, 20}, .view_up = {0, 0, 1}, .view_angle = 30 / zoom};
    camera.position = iso_vec3_add(middle, iso_vec3_make(60, -45, 25));
    return camera;
}

/* The color that a sample is to have, which the ray of its middle hits; false: it hits nothing. */
static bool wanted_color(const fixture *f, const iso_view *view, int x, int y, double wanted[3]) {
    iso_vec3 origin, direction;
    iso_ray ray;
    iso_ray_hit hit;
    iso_view_ray(view, x + 0.5, y + 0.5, &origin, &direction);
    if (!iso_ray_start(f->tracer, origin, direction, view->near, &ray) ||
        !iso_ray_next(f->tracer, &ray, &hit))
        return false;
    const iso_vec3 place = iso_vec3_add(origin, iso_vec3_scale(direction, hit.t));
    const iso_affine affine = iso_transform_affine(iso_grid_transform(&f->grid));
    const iso_vec3 n = iso_ray_hit_normal(f->tracer, &ray, &hit);
    iso_nearby nearby = {0};
    double number = hit.t;
    if (f->coloring.source == ISO_COLOR_BY_NORMAL) {
        wanted[0] = (n.x + 1) * 127.5, wanted[1] = (n.y + 1) * 127.5, wanted[2] = (n.z + 1) * 127.5;
        return true;
    }
    if (f->coloring.source == ISO_COLOR_BY_VOLUME) number = sample(&f->data, place);
    if (f->coloring.source == ISO_COLOR_BY_CURVATURE)
        number = iso_grid_mean_curvature(&f->grid, &affine, place);
    if (f->coloring.source == ISO_COLOR_BY_DISTANCE) number = iso_distance_at(f->distance, place, &nearby);
    const double at = (number - f->coloring.bar.low) / (f->coloring.bar.high - f->coloring.bar.low);
    wanted[0] = wanted[1] = wanted[2] = isnan(number) ? 128 : fmin(fmax(at, 0), 1) * 255;
    return true;
}

/* Returns how many samples are wrong by more than `most`; *seen: how many show the surface by both. */
static int count_wrong(const fixture *f, iso_method method, double zoom, double most, int *seen,
                       iso_pool *pool) {
    const iso_camera camera = camera_of(zoom);
    const iso_view view = iso_view_make(&camera, WIDTH, HEIGHT);
    const iso_coloring *const colorings[] = {&f->coloring};
    iso_gbuffer gbuffer;
    int wrong = 0;
    assert_int_equal(iso_gbuffer_create(WIDTH, HEIGHT, &gbuffer, NULL), ISO_OK);
    iso_gbuffer_clear(&gbuffer);
    const iso_target target = {&view, &gbuffer, pool, 0, NULL};
    assert_int_equal(iso_renderer_draw(iso_renderer_get(method), &f->surface, &target, NULL), ISO_OK);
    assert_int_equal(iso_colorings_paint(colorings, 1, &view, &gbuffer, pool, NULL), ISO_OK);
    *seen = 0;
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH; x++) {
            const size_t at = (size_t)y * WIDTH + (size_t)x;
            double wanted[3];
            if (gbuffer.surface[at] != 0 || !wanted_color(f, &view, x, y, wanted)) continue;
            ++*seen;
            assert_int_equal(gbuffer.color[at] >> 24, 1);
            double off = 0;
            for (int k = 0; k < 3; k++) off = fmax(off, fabs((gbuffer.color[at] >> 8 * k & 255) - wanted[k]));
            wrong += off > most;
        }
    iso_gbuffer_free(&gbuffer);
    return wrong;
}

static void samples_have_the_colors_of_the_data(void **state) {
    (void)state;
    iso_pool *pool;
    fixture f;
    int seen;
    assert_int_equal(iso_pool_create(2, &pool, NULL), ISO_OK);
    set_up(&f, pool);
    for (int source = ISO_COLOR_BY_VOLUME; source <= (int)ISO_COLOR_BY_NORMAL; source++)
        for (double zoom = 1; zoom < 20; zoom *= 4) {
            set_source(&f, (iso_color_source)source);
            assert_int_equal(count_wrong(&f, ISO_METHOD_EXACT, zoom, 1, &seen, pool), 0);
            assert_true(seen > 2000);
            assert_int_equal(count_wrong(&f, ISO_METHOD_RAYCAST, zoom, 1, &seen, NULL), 0);
            const int wrong = count_wrong(&f, ISO_METHOD_MESH, zoom, 24, &seen, pool);
            assert_true(wrong < seen / 10);
        }
    tear_down(&f);
    iso_pool_destroy(pool);
}

static void ranges_leave_out_two_percent(void **state) {
    (void)state;
    fixture f;
    size_t points, found;
    set_up(&f, NULL);
    const iso_mesh_view mesh = iso_mesh_set_view(f.surface.mesh);
    set_source(&f, ISO_COLOR_BY_VOLUME);
    assert_int_equal(iso_coloring_find_range(&f.coloring, &mesh, NULL, NULL, &points, &found, NULL), ISO_OK);
    assert_true(points > 1000 && found < points && found > points / 4);
    size_t below = 0, above = 0, inside = 0;
    const iso_affine affine = iso_transform_affine(&mesh.transform);
    for (size_t s = 0; s < mesh.span_count; s++)
        for (uint32_t i = 0; i < mesh.spans[s].owned_count; i++) {
            const iso_vec3 index = iso_brick_position(mesh.spans[s].brick,
                                                      mesh.vertices[mesh.spans[s].first_vertex + i].position);
            const double number = sample(&f.data, iso_affine_point(&affine, index));
            below += number < f.coloring.bar.low;
            above += number > f.coloring.bar.high;
            inside += !isnan(number);
        }
    assert_int_equal(inside, found);
    assert_true(below <= found / 50 + 1 && below >= found / 50 - 1 && above <= found / 50 + 1 &&
                above >= found / 50 - 1);
    set_source(&f, ISO_COLOR_BY_DISTANCE);
    assert_int_equal(iso_coloring_find_range(&f.coloring, &mesh, NULL, NULL, &points, &found, NULL), ISO_OK);
    /* a surface at a smaller isovalue lies outside of the other, and all numbers have one sign */
    assert_true(f.coloring.bar.low == 0 && f.coloring.bar.high > 0);
    assert_int_equal(iso_coloring_usual_map(ISO_COLOR_BY_DISTANCE, &f.coloring.bar), ISO_COLORMAP_VIRIDIS);
    /* a plane passes through the surface */
    iso_grid half = test_rgrid((const int[3]){SIDE, SIDE, SIDE}, ISO_FLOAT32);
    for (int i = 0; i < SIDE * SIDE * SIDE; i++)
        test_set(&half, i % SIDE, i / SIDE % SIDE, i / (SIDE * SIDE), i % SIDE);
    iso_distance_destroy(f.distance);
    assert_int_equal(iso_distance_of_isosurface(&half, 0.4 * SIDE, NULL, &f.distance, NULL), ISO_OK);
    set_source(&f, ISO_COLOR_BY_DISTANCE);
    assert_int_equal(iso_coloring_find_range(&f.coloring, &mesh, NULL, NULL, &points, &found, NULL), ISO_OK);
    assert_true(f.coloring.bar.low == -f.coloring.bar.high && f.coloring.bar.high > 0);
    assert_int_equal(iso_coloring_usual_map(ISO_COLOR_BY_DISTANCE, &f.coloring.bar), ISO_COLORMAP_COOLWARM);
    iso_grid_destroy(&half);
    f.data.rgrid->transform.origin[0] = 500;
    set_source(&f, ISO_COLOR_BY_VOLUME);
    assert_int_equal(iso_coloring_find_range(&f.coloring, &mesh, NULL, NULL, &points, &found, NULL), ISO_OK);
    assert_int_equal(found, 0);
    tear_down(&f);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(samples_have_the_colors_of_the_data),
        cmocka_unit_test(ranges_leave_out_two_percent),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
