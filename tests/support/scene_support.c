/* scene_support: points of scenes, views of them, and pictures by pull-push. */
#include "scene_support.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "base/cpu.h"
#include "grids/scenes/scenes.h"

test_scene test_scene_make(const char *name, int size, const iso_points_opts *opts, bool bounded) {
    iso_error error = {0};
    test_scene s = {0};
    iso_scene_opts scene = {.size = size};
    test_ok(iso_scene_create(name, &scene, &s.grid, &s.isovalue, &error), &error);
    iso_points_opts points = opts ? *opts : (iso_points_opts){0};
    points.isovalue = s.isovalue;
    test_ok(iso_point_set_create(&s.grid, &points, &s.set, &error), &error);
    test_ok(iso_point_set_update(s.set, &error), &error);
    if (bounded) test_ok(iso_point_set_bound(s.set, &error), &error);
    s.points = iso_point_set_view(s.set);
    return s;
}

void test_scene_free(test_scene *s) {
    iso_point_set_destroy(s->set);
    iso_grid_destroy(&s->grid);
}

iso_box test_scene_box(const test_scene *scene) {
    const iso_box box = iso_point_view_bounds(&scene->points);
    const iso_affine affine = iso_transform_affine(&scene->points.transform);
    return iso_box_transform(&box, &affine);
}

test_surfaces test_surfaces_make(const char *name, int size, bool floats) {
    iso_error error = {0};
    test_surfaces s = {.set = NULL};
    const iso_points_opts opts = {.primitive = ISO_PRIMITIVE_EDGE, .floats = floats};
    s.scene = test_scene_make(name, size, &opts, false);
    const iso_mesh_opts mesh = {.isovalue = s.scene.isovalue};
    test_ok(iso_mesh_set_create(&s.scene.grid, &mesh, &s.set, &error), &error);
    test_ok(iso_mesh_set_update(s.set, &error), &error);
    s.mesh = iso_mesh_set_view(s.set);
    return s;
}

void test_surfaces_free(test_surfaces *surfaces) {
    iso_mesh_set_destroy(surfaces->set);
    test_scene_free(&surfaces->scene);
}

iso_view test_look_at(const test_scene *s, int side, double zoom, bool orthographic, int width, int height) {
    const iso_affine affine = iso_transform_affine(&s->points.transform);
    const iso_box index = iso_point_view_bounds(&s->points), world = iso_box_transform(&index, &affine);
    iso_camera camera = {
        .view_up = {0, 0, 1}, .view_angle = 30, .orthographic = orthographic, .parallel_scale = 1};
    camera.position = iso_vec3_make(0.3 + side % 3, -1.3, 0.4 * (side / 3) + 0.2);
    iso_camera_fit(&camera, &world, (double)width / height, 1);
    iso_camera_zoom(&camera, zoom);
    return iso_view_make(&camera, width, height);
}

iso_view test_plain_view(int width, int height, bool orthographic, double focal) {
    return (iso_view){.rotation = {1, 0, 0, 0, 1, 0, 0, 0, 1},
                      .focal = focal,
                      .cx = width / 2.0,
                      .cy = height / 2.0,
                      .width = width,
                      .height = height,
                      .orthographic = orthographic,
                      .near = orthographic ? -1e300 : 0.01};
}

iso_gbuffer test_clear_gbuffer(int width, int height, bool colored) {
    iso_gbuffer g;
    assert_int_equal(iso_gbuffer_create(width, height, &g, NULL), ISO_OK);
    if (colored) assert_int_equal(iso_gbuffer_add_color(&g, NULL), ISO_OK);
    for (int axis = 0; axis < 3; axis++)
        memset(g.normal[axis], 0, sizeof(float) * (size_t)width * (size_t)height);
    iso_gbuffer_clear(&g);
    return g;
}

void test_same_rows(const iso_gbuffer *a, int a_row, const iso_gbuffer *b) {
    size_t start = (size_t)a_row * (size_t)a->width, samples = (size_t)b->width * (size_t)b->height;
    assert_memory_equal(a->depth + start, b->depth, samples * sizeof(float));
    assert_memory_equal(a->surface + start, b->surface, samples);
    for (int axis = 0; axis < 3; axis++)
        assert_memory_equal(a->normal[axis] + start, b->normal[axis], samples * sizeof(float));
    if (b->color) assert_memory_equal(a->color + start, b->color, samples * sizeof *b->color);
    if (b->element) assert_memory_equal(a->element + start, b->element, samples * sizeof *b->element);
}

iso_gbuffer test_drawn(const iso_view *view, const iso_point_view *points, const iso_point_surface_opts *opts,
                       iso_pool *pool) {
    iso_error error = {0};
    iso_gbuffer g = test_clear_gbuffer(view->width, view->height, points->colors != NULL);
    const iso_target target = {view, &g, pool, 0, NULL};
    const iso_point_surface_opts gaussian = {.reconstruction = ISO_RECONSTRUCTION_GAUSSIAN};
    test_ok(iso_draw_point_surface(&target, points, opts ? opts : &gaussian, &error), &error);
    return g;
}

void test_variants_of(test_picture *draw, const void *context, const iso_view *view,
                      const iso_gbuffer *wanted) {
    for (int level = ISO_CPU_GENERIC; level <= (int)iso_cpu_supported(); level++)
        for (int threads = 1; threads <= 3; threads++) {
            iso_pool *pool = NULL;
            iso_cpu_limit((iso_cpu_level)level);
            if (threads > 1) assert_int_equal(iso_pool_create(threads, &pool, NULL), ISO_OK);
            iso_gbuffer got = draw(context, view, pool);
            test_same_rows(wanted, 0, &got);
            iso_gbuffer_free(&got);
            iso_pool_destroy(pool);
        }
    iso_cpu_limit(ISO_CPU_AVX512);
}

void test_strips_of(test_picture *draw, const void *context, const iso_view *view, int lowest,
                    const iso_gbuffer *wanted) {
    static const int heights[] = {1, 7, 24, 61};
    for (int h = 0; h < 4; h++)
        for (int y = 0; heights[h] >= lowest && y < view->height; y += heights[h]) {
            const int count = view->height - y < heights[h] ? view->height - y : heights[h];
            const iso_view rows = iso_view_rows(view, y, count);
            iso_gbuffer strip = draw(context, &rows, NULL);
            test_same_rows(wanted, y, &strip);
            iso_gbuffer_free(&strip);
        }
}

typedef struct points_drawing {
    const iso_point_view *points;
    const iso_point_surface_opts *opts;
} points_drawing;

static iso_gbuffer draw_points(const void *context, const iso_view *view, iso_pool *pool) {
    const points_drawing *d = context;
    return test_drawn(view, d->points, d->opts, pool);
}

void test_every_variant(const iso_view *view, const iso_point_view *points,
                        const iso_point_surface_opts *opts, const iso_gbuffer *wanted) {
    const points_drawing d = {points, opts};
    test_variants_of(draw_points, &d, view, wanted);
}

void test_every_strip(const iso_view *view, const iso_point_view *points, const iso_point_surface_opts *opts,
                      const iso_gbuffer *wanted) {
    const points_drawing d = {points, opts};
    test_strips_of(draw_points, &d, view, 7, wanted);
}
