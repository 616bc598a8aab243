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
#include "image/image.h"
#include "render/gl/groups.h"
#include "render/gl/surface.h"
#include "render/groups/coverage.h"

enum { WIDTH = 160, HEIGHT = 120 };
static int bins; /* of depth; 0: none */

static iso_groups groups_of(const iso_point_view *points, int limit) {
    iso_groups groups;
    iso_groups_opts opts = iso_groups_default_opts(NULL);
    opts.limit = limit;
    assert_int_equal(iso_groups_make(points, &opts, &groups, NULL), ISO_OK);
    return groups;
}

static iso_gbuffer by_cpu(const iso_view *view, const iso_point_view *points, const iso_groups *groups) {
    iso_gbuffer g = gl_gbuffer(view);
    iso_gbuffer_clear(&g);
    const iso_target target = {view, &g, NULL, 0, NULL};
    const iso_draw_groups_opts opts = {groups, bins};
    assert_int_equal(iso_draw_groups(&target, points, &opts, NULL), ISO_OK);
    return g;
}

static iso_gbuffer by_gl(iso_gl_engine *engine, const iso_view *view, const iso_point_view *points,
                         const iso_groups *groups) {
    iso_gbuffer g = gl_gbuffer(view);
    iso_error error = {0};
    const iso_gl_grouped_points surface = {*points, groups};
    const iso_gl_draw_groups_opts opts = {view, &surface, 1, NULL, bins};
    test_ok(iso_gl_draw_groups(engine, &opts, &g, &error), &error);
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
                bins = side == 4 ? 30 : 0;
                lowest = fmin(lowest, compare(engine, &view, &points, &groups));
            }
            iso_groups_free(&groups);
            bins = 0;
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

/* ---- translucent */

/* What is drawn: one or two surfaces, and an opaque plane. */
typedef struct translucent {
    iso_splat_layer layers[2];
    int count;
    iso_transparency transparency;
    double plane; /* depth of the plane, mm; 0: none */
    int factor;   /* samples along a side of a pixel */
} translucent;

/* Draws by OpenGL, or with NULL by the cpu. */
static iso_image composite(iso_gl_engine *engine, const translucent *t, const iso_view *view) {
    static const iso_rgb colors[2] = {{200, 120, 60}, {60, 120, 200}};
    iso_image image;
    iso_error error = {0};
    iso_gbuffer g = gl_gbuffer(view);
    iso_gbuffer_clear(&g);
    for (size_t i = 0; i < (size_t)view->width * (size_t)view->height && t->plane > 0; i++) {
        g.depth[i] = (float)t->plane;
        g.surface[i] = 1;
        for (int k = 0; k < 3; k++) g.normal[k][i] = k < 2 ? 0.0f : -1.0f;
    }
    const iso_shading shading = {.colors = colors, .color_count = 2, .background = {30, 40, 50}};
    const iso_strip strip = {view, &g, t->factor, 0};
    const int width = view->width / t->factor, height = view->height / t->factor;
    assert_int_equal(iso_image_create(width, height, &image, NULL), ISO_OK);
    const iso_splat_layers input = {.transparency = t->transparency,
                                    .layers = t->layers,
                                    .count = t->count,
                                    .picture = {.strip = &strip, .shading = &shading, .image = &image}};
    iso_layer_totals totals = {0};
    test_ok(engine ? iso_gl_shade_splat_layers(engine, &input, &totals, &error)
                   : iso_shade_splat_layers(&input, &totals, &error),
            &error);
    assert_true(totals.covered > 100);
    iso_gbuffer_free(&g);
    return image;
}

/* Draws with both engines, and twice by OpenGL; returns the PSNR of all pixels. */
static double compare_composites(iso_gl_engine *engine, const translucent *t, const iso_view *view) {
    iso_image cpu = composite(NULL, t, view), gl = composite(engine, t, view),
              again = composite(engine, t, view);
    const size_t pixels = (size_t)cpu.width * (size_t)cpu.height;
    double squares = 0;
    for (size_t i = 0; i < 4 * pixels; i++) squares += pow(cpu.rgba[i] - gl.rgba[i], 2);
    assert_memory_equal(gl.rgba, again.rgba, 4 * pixels);
    iso_image_free(&cpu);
    iso_image_free(&gl);
    iso_image_free(&again);
    return 10 * log10(255.0 * 255 * 3 * (double)pixels / (squares + 1e-9));
}

/* Draws a scene's points from all sides: whole and close, in a parallel view, with several samples a pixel,
 * in front of a plane and cut by one, with a second surface. Lowers `lowest` of the three
 * modes. */
static void compare_scene(iso_gl_engine *engine, const gl_surface *surface, const iso_point_view *points,
                          const iso_groups *groups, double lowest[3]) {
    translucent t = {.factor = 1};
    for (int i = 0; i < 2; i++)
        t.layers[i] = (iso_splat_layer){.points = *points,
                                        .groups = groups,
                                        .color = {200, 120, (uint8_t)(60 + 100 * i)},
                                        .translucency = {.opacity = 0.3f + 0.3f * (float)i}};
    t.layers[1].points.transform.origin[0] += 3;
    /* with colours two of the sides, to save time */
    for (int side = points->colors ? 3 : 0; side < (points->colors ? 5 : GL_SIDES); side++) {
        iso_view view = gl_side_view(&surface->box, side, side == 2, WIDTH, HEIGHT);
        if (side == 1) view.focal *= 5;
        const iso_vec3 middle = iso_vec3_scale(iso_vec3_add(surface->box.lo, surface->box.hi), 0.5);
        const double depth = iso_view_point(&view, middle).z;
        t.factor = side == 3 ? 2 : 1;
        t.count = side == 4 ? 2 : 1;
        t.plane = side == 5 ? depth : side == 3 ? 2 * depth : 0;
        for (int mode = 0; mode < 3; mode++) {
            t.transparency = (iso_transparency)mode;
            t.layers[0].translucency.most_layers = side == 1 ? 2 : 0;
            lowest[mode] = fmin(lowest[mode], compare_composites(engine, &t, &view));
        }
    }
}

static void translucent_scenes(iso_gl_engine *engine) {
    static const char *const names[] = {"gyroid", "head"};
    double lowest[3] = {INFINITY, INFINITY, INFINITY};
    for (int k = 0; k < 2; k++) {
        iso_grid grid;
        double isovalue;
        const iso_scene_opts scene = {.size = 40};
        assert_int_equal(iso_scene_create(names[k], &scene, &grid, &isovalue, NULL), ISO_OK);
        gl_surface surface = gl_surface_make(&grid, isovalue);
        iso_point_view points = iso_point_set_view(surface.packed);
        iso_groups groups = groups_of(&points, k ? 6 : 4);
        assert_int_equal(iso_groups_cover(&points, (double)ISO_GROUPS_DISC, NULL, &groups, NULL), ISO_OK);
        uint8_t(*colors)[3] = malloc(3 * iso_groups_length(&points));
        uint32_t seed = 11;
        for (size_t i = 0; i < iso_groups_length(&points); i++)
            for (int c = 0; c < 3; c++) colors[i][c] = (uint8_t)random_bits(&seed);
        if (k) points.colors = (const uint8_t(*)[3])colors;
        compare_scene(engine, &surface, &points, &groups, lowest);
        free(colors);
        iso_groups_free(&groups);
        gl_surface_free(&surface);
        iso_grid_destroy(&grid);
    }
    printf("translucent: sorted %.1f dB, groups %.1f dB, nearest %.1f dB or more\n", lowest[0], lowest[1],
           lowest[2]);
    for (int mode = 0; mode < 3; mode++) assert_true(lowest[mode] >= 43);
}

/* A picture whose lists of hits are more than the limit of a buffer, which is lowered for it. */
static void translucent_strips(iso_gl_engine *engine) {
    iso_grid grid;
    double isovalue;
    const iso_scene_opts scene = {.size = 24};
    assert_int_equal(iso_scene_create("sphere", &scene, &grid, &isovalue, NULL), ISO_OK);
    gl_surface surface = gl_surface_make(&grid, isovalue);
    const translucent t = {.layers = {{.points = iso_point_set_view(surface.packed),
                                       .color = {200, 120, 60},
                                       .translucency = {.opacity = 0.5f}}},
                           .count = 1,
                           .factor = 1};
    const iso_view view = gl_side_view(&surface.box, 1, false, WIDTH, HEIGHT);
    const size_t most = engine->max_storage;
    engine->max_storage = (size_t)2 << 20;
    assert_true(compare_composites(engine, &t, &view) >= 43);
    engine->max_storage = most;
    gl_surface_free(&surface);
    iso_grid_destroy(&grid);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        gl_each_engine_test(scenes),
        gl_engine_test(colors),
        gl_engine_test(strips),
        gl_engine_test(translucent_scenes),
        gl_engine_test(translucent_strips),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
