/* Splats by OpenGL against those of the cpu engine. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "check_support.h"
#include "gl_support.h"
#include "grids/scenes/scenes.h"
#include "render/gl/splats.h"

enum { WIDTH = 260, HEIGHT = 200 };

static iso_groups groups_of(const iso_point_view *points, int limit) {
    iso_groups groups;
    iso_groups_opts opts = iso_splats_grouping(NULL);
    opts.limit = limit;
    assert_int_equal(iso_groups_make(points, &opts, &groups, NULL), ISO_OK);
    return groups;
}

static iso_gbuffer by_cpu(const iso_view *view, const iso_point_view *points, const iso_groups *groups) {
    iso_gbuffer g = gl_gbuffer(view);
    iso_gbuffer_clear(&g);
    const iso_target target = {view, &g, NULL, 0};
    const iso_splats_opts opts = {groups, 0};
    assert_int_equal(iso_draw_splats(&target, points, &opts, NULL), ISO_OK);
    return g;
}

static iso_gbuffer by_gl(iso_gl_engine *engine, const iso_view *view, const iso_point_view *points,
                         const iso_groups *groups) {
    iso_gbuffer g = gl_gbuffer(view);
    iso_error error = {0};
    const iso_gl_splats surface = {*points, groups};
    const iso_gl_splats_opts opts = {view, &surface, 1, NULL};
    test_ok(iso_gl_draw_splats(engine, &opts, &g, &error), &error);
    return g;
}

/* Compares both engines in one view, and two drawings by the same engine. Returns the PSNR. */
static double compare(iso_gl_engine *engine, const iso_view *view, const iso_point_view *points,
                      const iso_groups *groups) {
    iso_gbuffer cpu = by_cpu(view, points, groups), gl = by_gl(engine, view, points, groups),
                again = by_gl(engine, view, points, groups);
    const gl_difference d = gl_compare(view, &cpu, &gl);
    assert_true(d.outline > 200);
    assert_true(d.differ * 50 <= d.outline);
    assert_true(d.psnr >= 43);
    const size_t samples = (size_t)view->width * (size_t)view->height;
    assert_memory_equal(gl.depth, again.depth, samples * sizeof(float));
    assert_memory_equal(gl.surface, again.surface, samples);
    iso_gbuffer_free(&cpu);
    iso_gbuffer_free(&gl);
    iso_gbuffer_free(&again);
    return d.psnr;
}

static void scenes(iso_gl_engine *engine) {
    static const char *const names[] = {"gyroid", "head"};
    double lowest = INFINITY;
    for (int k = 0; k < 2; k++) {
        iso_grid grid;
        double isovalue;
        const iso_scene_opts scene = {.size = 40};
        assert_int_equal(iso_scene_create(names[k], &scene, &grid, &isovalue, NULL), ISO_OK);
        gl_surface surface = gl_surface_make(&grid, isovalue);
        for (int floats = 0; floats < 2; floats++) {
            const iso_point_view points = iso_point_set_view(floats ? surface.floats : surface.packed);
            iso_groups groups = groups_of(&points, floats ? 64 : 6);
            for (int side = 0; side < GL_SIDES; side += 2) {
                const iso_view view = gl_side_view(&surface.box, side, side == 2, WIDTH, HEIGHT);
                lowest = fmin(lowest, compare(engine, &view, &points, &groups));
            }
            iso_groups_free(&groups);
        }
        gl_surface_free(&surface);
        iso_grid_destroy(&grid);
    }
    printf("%.1f dB or more\n", lowest);
}

/* Discs of all sizes, some behind and around the near plane, with colours; and no discs at all. */
static void colors(iso_gl_engine *engine) {
    enum { COUNT = 300 };
    static iso_surfel surfels[COUNT];
    static float radii[COUNT];
    static uint8_t colors[COUNT][3];
    uint32_t seed = 9;
    for (int i = 0; i < COUNT; i++) {
        for (int k = 0; k < 3; k++) {
            surfels[i].position[k] = (float)((uniform(&seed) - 0.5) * 10 + (k == 2 ? 8 : 0));
            surfels[i].normal[k] = (float)(uniform(&seed) - 0.5);
            colors[i][k] = (uint8_t)random_bits(&seed);
        }
        radii[i] = (float)(0.02 + 0.7 * uniform(&seed) * uniform(&seed));
    }
    iso_point_span span = {.count = COUNT};
    const iso_point_view points = {.surfels = surfels,
                                   .radii = radii,
                                   .colors = (const uint8_t(*)[3])colors,
                                   .spans = &span,
                                   .span_count = 1,
                                   .transform = iso_transform_identity()};
    const iso_view view = {.rotation = {1, 0, 0, 0, 1, 0, 0, 0, 1},
                           .focal = 200,
                           .cx = WIDTH / 2,
                           .cy = HEIGHT / 2,
                           .width = WIDTH,
                           .height = HEIGHT,
                           .near = 4};
    iso_groups groups = groups_of(&points, 20);
    compare(engine, &view, &points, &groups);
    iso_gbuffer cpu = by_cpu(&view, &points, &groups), gl = by_gl(engine, &view, &points, &groups);
    size_t different = 0;
    for (size_t i = 0; i < WIDTH * HEIGHT; i++)
        for (int k = 0; k < 3 && cpu.surface[i] == 0; k++)
            if (abs((int)(cpu.color[i] >> 8 * k & 255) - (int)(gl.color[i] >> 8 * k & 255)) > 1) different++;
    assert_true(different < WIDTH * HEIGHT / 500);
    iso_gbuffer_free(&cpu);
    iso_gbuffer_free(&gl);
    span.count = 0;
    gl = by_gl(engine, &view, &points, &groups);
    for (size_t i = 0; i < WIDTH * HEIGHT; i++) assert_int_equal(gl.surface[i], ISO_SURFACE_NONE);
    iso_gbuffer_free(&gl);
    iso_groups_free(&groups);
}

/* A picture in strips: its slots are more than the limit of a buffer. */
static void strips(iso_gl_engine *engine) {
    iso_grid grid;
    double isovalue;
    const iso_scene_opts scene = {.size = 24};
    assert_int_equal(iso_scene_create("sphere", &scene, &grid, &isovalue, NULL), ISO_OK);
    gl_surface surface = gl_surface_make(&grid, isovalue);
    const iso_point_view points = iso_point_set_view(surface.packed);
    iso_groups groups = groups_of(&points, 8);
    groups.count = 64; /* empty ones */
    const iso_view view = gl_side_view(&surface.box, 1, false, 1100, 700);
    compare(engine, &view, &points, &groups);
    iso_groups_free(&groups);
    gl_surface_free(&surface);
    iso_grid_destroy(&grid);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        gl_engine_test(scenes),
        gl_engine_test(colors),
        gl_engine_test(strips),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
