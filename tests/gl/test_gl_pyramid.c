/* What shares the image pyramid of pull-push, by OpenGL against the cpu engine: lines as tubes and ribbons,
 * thin and wide, over a wall; hybrid surfaces; and several sets in one pyramid. Small pictures: software
 * renderers take long. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

#include "base/memory.h"
#include "check_support.h"
#include "gl_support.h"
#include "grids/scenes/scenes.h"
#include "lines_support.h"
#include "render/gl/hybrid.h"
#include "render/gl/lines.h"
#include "render/gl/sets.h"
#include "render/pullpush/hybrid.h"
#include "shapes_support.h"

enum { WIDTH = 120, HEIGHT = 100, VERTICES = 60 };

static const iso_vec3 AWAY = {60, 35, -80};
static test_lines scene;

/* A helix before a straight line that the near plane can cut. */
static void make_lines(double radius) {
    test_lines_start(&scene, 0, 0, 0);
    for (int i = 0; i < VERTICES; i++) {
        double sine, cosine;
        iso_sincos(i * ISO_PI / 15, &sine, &cosine);
        test_lines_add(&scene, 7 * cosine, 7 * sine, i / 6.0 - 5, radius);
    }
    test_lines_end(&scene);
    test_lines_add(&scene, -60, -35, 80, radius);
    test_lines_add(&scene, 62, 36, -83, radius);
    test_lines_end(&scene);
    for (size_t i = 0; i < scene.lines.vertex_count; i++)
        for (int k = 0; k < 3; k++) scene.colors[i][k] = (uint8_t)(50 * k + 2 * i);
}

/* Both engines draw the lines over a wall, whose colour is another one. */
static iso_gbuffer walled(const iso_view *view) {
    iso_gbuffer g = gl_gbuffer(view);
    for (int i = 0; i < view->width * view->height / 2; i++) {
        g.depth[i] = 105;
        for (int k = 0; k < 3; k++) g.normal[k][i] = k == 2 ? -1 : 0;
        g.surface[i] = 0;
    }
    return g;
}

static double compare_lines(iso_gl_engine *engine, const iso_view *view, const iso_shapes_opts *opts,
                            const char *name) {
    iso_error error = {0};
    iso_pyramid_lines *lines;
    iso_gbuffer cpu = walled(view), gl = walled(view);
    test_ok(iso_pyramid_lines_create(&scene.lines, opts, &lines, &error), &error);
    const iso_target by_cpu = {view, &cpu, NULL, 1, NULL}, by_gl = {view, &gl, NULL, 1, NULL};
    test_ok(iso_draw_pyramid_lines(&by_cpu, lines, NULL, &error), &error);
    test_ok(iso_gl_draw_pyramid_lines(engine, &by_gl, lines, NULL, &error), &error);
    const gl_difference d = gl_compare(view, &cpu, &gl);
    size_t seen = 0, colors = 0;
    for (int i = 0; i < view->width * view->height; i++) {
        seen += cpu.surface[i] == 1;
        if (cpu.color && cpu.surface[i] == gl.surface[i]) colors += cpu.color[i] != gl.color[i];
    }
    if (!(seen > 200 && d.psnr >= 43 && colors <= seen / 50))
        fail_msg("%s: %.1f dB; of %zu samples %zu have other colours, %d are of one engine only", name,
                 d.psnr, seen, colors, d.differ);
    printf("%-28s %5.1f dB\n", name, d.psnr);
    iso_pyramid_lines_destroy(lines);
    iso_gbuffer_free(&cpu);
    iso_gbuffer_free(&gl);
    return d.psnr;
}

static void check_lines(iso_gl_engine *engine) {
    static const double pixels[] = {0.5, 4, 20}; /* radii; of the widest the base level is not 0 */
    iso_error error = {0};
    for (int i = 0; i < 6; i++) {
        const bool ribbons = i & 1;
        const double radius = pixels[i / 2] * 24 / HEIGHT;
        make_lines(radius);
        if (i >= 2) scene.lines.colors = scene.colors;
        if (ribbons) test_ok(iso_lines_add_normals(&scene.lines, &error), &error);
        const iso_view view =
            test_shapes_view_sized(scene.lines.origin, AWAY, 24, i >= 4, (int[]){WIDTH, HEIGHT});
        const iso_shapes_opts opts = {.style = ribbons ? ISO_LINE_RIBBON : ISO_LINE_TUBE,
                                      .shading = i == 2 ? ISO_LINE_ILLUMINATED : ISO_LINE_ROUND,
                                      .min_pixels = 1};
        char name[64];
        snprintf(name, sizeof name, "%s of %g pixels", ribbons ? "ribbons" : "tubes", pixels[i / 2]);
        compare_lines(engine, &view, &opts, name);
        if (ribbons) iso_free(scene.lines.normals);
        scene.lines.colors = NULL;
        scene.lines.normals = NULL;
    }
}

/* Views in which some, all and none of a torus's bricks are points. */
static void check_hybrid(iso_gl_engine *engine) {
    iso_error error = {0};
    iso_grid grid;
    double isovalue;
    const iso_scene_opts scene_opts = {.size = 48, .dense = true};
    test_ok(iso_scene_create("torus", &scene_opts, &grid, &isovalue, &error), &error);
    gl_surface s = gl_surface_make(&grid, isovalue);
    const iso_point_view points = iso_point_set_view(s.packed);
    const iso_mesh_view mesh = iso_mesh_set_view(s.mesh);
    for (int i = 0; i < 3; i++) {
        iso_view view = gl_side_view(&s.box, i, i == 2, WIDTH * 2 / 3, HEIGHT * 2 / 3);
        iso_gbuffer cpu = walled(&view), gl = walled(&view);
        view.focal *= (double[]){1.7, 1, 4}[i];
        iso_hybrid_parts parts;
        test_ok(iso_hybrid_parts_make(&view, &points, &mesh, 0, &parts, &error), &error);
        assert_true((parts.points.span_count > 0) == (i < 2) && (parts.mesh.span_count > 0) == (i != 1));
        iso_hybrid_parts_free(&parts);
        const iso_target by_cpu = {&view, &cpu, NULL, 1, NULL}, by_gl = {&view, &gl, NULL, 1, NULL};
        test_ok(iso_draw_hybrid(&by_cpu, &points, &mesh, NULL, &error), &error);
        test_ok(iso_gl_draw_hybrid(engine, &by_gl, &points, &mesh, &error), &error);
        const gl_difference d = gl_compare(&view, &cpu, &gl);
        printf("hybrid, view %d                %5.1f dB\n", i, d.psnr);
        if (!(d.psnr >= 43)) fail_msg("hybrid, view %d: %.1f dB, %d pixels differ", i, d.psnr, d.differ);
        iso_gbuffer_free(&cpu);
        iso_gbuffer_free(&gl);
    }
    gl_surface_free(&s);
    iso_grid_destroy(&grid);
}

/* Two surfaces that intersect, one of them hybrid, and coloured ribbons beside and through them, in one
 * pyramid: from three sides, from near, and in parallel projection. */
static void check_sets(iso_gl_engine *engine) {
    static const char *const names[] = {"sphere", "gyroid"};
    iso_error error = {0};
    iso_grid grid[2];
    gl_surface s[2];
    iso_point_view points[2];
    iso_pyramid_lines *ribbons;
    for (int i = 0; i < 2; i++) {
        double isovalue;
        const iso_scene_opts scene_opts = {.size = 48, .dense = true};
        test_ok(iso_scene_create(names[i], &scene_opts, &grid[i], &isovalue, &error), &error);
        s[i] = gl_surface_make(&grid[i], isovalue);
        points[i] = iso_point_set_view(s[i].packed);
    }
    const iso_mesh_view mesh = iso_mesh_set_view(s[1].mesh);
    const iso_vec3 low = s[0].box.lo, high = s[0].box.hi;
    test_lines_start(&scene, 0, 0, 0);
    for (int i = 0; i < VERTICES; i++) {
        double sine, cosine, part = (double)i / (VERTICES - 1);
        iso_sincos(4 * ISO_PI * part, &sine, &cosine);
        test_lines_add(&scene, low.x + (high.x - low.x) * (0.5 + 0.6 * cosine),
                       low.y + (high.y - low.y) * (0.5 + 0.6 * sine), low.z + (high.z - low.z) * part,
                       0.02 * (high.x - low.x));
    }
    test_lines_end(&scene);
    for (size_t i = 0; i < scene.lines.vertex_count; i++)
        for (int k = 0; k < 3; k++) scene.colors[i][k] = (uint8_t)(50 * k + 2 * i);
    scene.lines.colors = scene.colors;
    test_ok(iso_lines_add_normals(&scene.lines, &error), &error);
    test_ok(iso_pyramid_lines_create(&scene.lines,
                                     &(iso_shapes_opts){.style = ISO_LINE_RIBBON, .min_pixels = 1}, &ribbons,
                                     &error),
            &error);
    for (int i = 0; i < 4; i++) {
        iso_view view = gl_side_view(&s[0].box, i % 3, i == 2, WIDTH, HEIGHT);
        if (i == 3) view.focal *= 3;
        iso_gbuffer cpu = walled(&view), gl = walled(&view);
        const iso_pyramid_set sets[] = {{.surface = 1, .points = &points[0]},
                                        {.surface = 2, .points = &points[1], .mesh = i & 1 ? &mesh : NULL},
                                        {.surface = 3, .ribbons = ribbons}};
        const iso_target by_cpu = {&view, &cpu, NULL, 0, NULL}, by_gl = {&view, &gl, NULL, 0, NULL};
        test_ok(iso_draw_pyramid_sets(&by_cpu, sets, 3, NULL, &error), &error);
        test_ok(iso_gl_draw_pyramid_sets(engine, &by_gl, sets, 3, NULL, &error), &error);
        const gl_difference d = gl_compare(&view, &cpu, &gl);
        int seen[4] = {0}, colors = 0;
        for (int k = 0; k < view.width * view.height; k++) {
            if (cpu.surface[k] < 4) seen[cpu.surface[k]]++;
            for (int byte = 0; byte < 32 && cpu.surface[k] == gl.surface[k]; byte += 8)
                colors += abs((int)(cpu.color[k] >> byte & 255) - (int)(gl.color[k] >> byte & 255)) > 1;
        }
        printf("sets, view %d                  %5.1f dB\n", i, d.psnr);
        if (!(d.psnr >= 43 && seen[1] > 200 && seen[2] > 200 && seen[3] > 50 && colors < 10))
            fail_msg("sets, view %d: %.1f dB, %d pixels and %d colours differ; %d, %d and %d seen", i, d.psnr,
                     d.differ, colors, seen[1], seen[2], seen[3]);
        iso_gbuffer_free(&cpu);
        iso_gbuffer_free(&gl);
    }
    iso_pyramid_lines_destroy(ribbons);
    iso_free(scene.lines.normals);
    scene.lines.colors = NULL;
    scene.lines.normals = NULL;
    for (int i = 0; i < 2; i++) {
        gl_surface_free(&s[i]);
        iso_grid_destroy(&grid[i]);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {gl_engine_test(check_lines), gl_engine_test(check_hybrid),
                                       gl_engine_test(check_sets)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
