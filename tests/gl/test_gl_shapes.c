/* Lines and glyphs by OpenGL against those of the cpu engine: every kind, in perspective and parallel views,
 * with the eye among and inside them, cut by the near plane, and far from the origin. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/memory.h"
#include "check_support.h"
#include "gl_support.h"
#include "lines_support.h"
#include "render/gl/shapes.h"
#include "render/gl/surface.h"
#include "render/shapes/set.h"
#include "shapes_support.h"

enum {
    WIDTH = 240,
    HEIGHT = 200,
    GLYPHS = 400,
    FEW = 60, /* where many are traced in double precision */
    VIEWS = 2
};

static const iso_vec3 AWAY = {60, 35, -80};

/* ---- pictures */

/* From nearby the picture is smaller, as many shapes are then traced in double precision, which takes
 * software renderers long. */
static iso_view view_of(iso_vec3 origin, iso_vec3 away, double height, bool parallel) {
    const int part = iso_vec3_length(away) < 30 ? 3 : 1, pixels[2] = {WIDTH / part, HEIGHT / part};
    return test_shapes_view_sized(origin, away, height, parallel, pixels);
}

static iso_gbuffer gbuffer_of(const iso_view *view) {
    iso_gbuffer g = gl_gbuffer(view);
    assert_int_equal(iso_gbuffer_add_elements(&g, NULL), ISO_OK);
    return g;
}

static iso_gbuffer by_cpu(const iso_view *view, const iso_shapes *shapes, iso_shapes_drawn *drawn) {
    iso_gbuffer g = gbuffer_of(view);
    iso_error error = {0};
    const iso_target target = {view, &g, NULL, 1, NULL};
    test_ok(iso_draw_shapes(&target, shapes, drawn, &error), &error);
    return g;
}

static iso_gbuffer by_gl(iso_gl_engine *engine, const iso_view *view, const iso_shapes *shapes,
                         iso_shapes_drawn *drawn) {
    iso_gbuffer g = gbuffer_of(view);
    iso_error error = {0};
    iso_gl_shapes *uploaded;
    test_ok(iso_gl_upload_shapes(engine, shapes, &uploaded, &error), &error);
    const iso_gl_shapes *sets[] = {uploaded};
    const iso_gl_shapes_opts opts = {view, sets, 1, 1};
    test_ok(iso_gl_draw_shapes(engine, &opts, &g, drawn, &error), &error);
    iso_gl_shapes_destroy(uploaded);
    return g;
}

/* Samples that show another element, or the same in another colour. Where two segments of a line meet they
 * share a sphere: rounding decides which of them is seen. */
static size_t count_changed(const iso_gbuffer *a, const iso_gbuffer *b, uint32_t slack) {
    size_t changed = 0;
    for (size_t i = 0; i < (size_t)a->width * (size_t)a->height; i++) {
        if (a->surface[i] == ISO_SURFACE_NONE || b->surface[i] == ISO_SURFACE_NONE) continue;
        bool same = a->element[i] - b->element[i] + slack <= 2 * slack && a->surface[i] == b->surface[i];
        for (int k = 0; k < 32 && a->color && a->element[i] == b->element[i]; k += 8)
            same = same && abs((int)(a->color[i] >> k & 255) - (int)(b->color[i] >> k & 255)) <= 1;
        changed += !same;
    }
    return changed;
}

/* Compares both engines in one view: at least 45 dB, and at most 1 % of the outline's pixels, and two more,
 * in one picture only. Elements and colours are those of the cpu engine but where shapes meet. */
static double compare(iso_gl_engine *engine, const iso_view *view, const iso_shapes *shapes,
                      const char *name) {
    iso_shapes_drawn of_cpu = {0}, of_gl = {0};
    iso_gbuffer cpu = by_cpu(view, shapes, &of_cpu), gl = by_gl(engine, view, shapes, &of_gl);
    const gl_difference d = gl_compare(view, &cpu, &gl);
    const size_t changed = count_changed(&cpu, &gl, iso_shapes_are_lines(shapes)),
                 widened = of_cpu.widened > of_gl.widened ? of_cpu.widened - of_gl.widened
                                                          : of_gl.widened - of_cpu.widened;
    if (!(of_cpu.samples > 500 && d.psnr >= 45 && d.differ <= 2 + d.outline / 100 &&
          changed <= 5 + of_cpu.samples / 200 && widened <= 5 + of_cpu.widened / 200))
        fail_msg(
            "%s: %.1f dB; %zu samples, %zu by OpenGL; %d pixels of %d of the outline differ; %zu samples "
            "have other elements or colours; %zu and %zu are widened",
            name, d.psnr, of_cpu.samples, of_gl.samples, d.differ, d.outline, changed, of_cpu.widened,
            of_gl.widened);
    iso_gbuffer_free(&cpu);
    iso_gbuffer_free(&gl);
    return d.psnr;
}

/* The same in perspective and parallel views, whole and close. */
static void compare_views(iso_gl_engine *engine, iso_shapes *shapes, iso_vec3 origin, iso_vec3 away,
                          double height, const char *name) {
    double lowest[VIEWS] = {INFINITY, INFINITY};
    for (int parallel = 0; parallel < VIEWS; parallel++)
        for (int close = 0; close < 2; close++) {
            const iso_view view = view_of(origin, away, height / (1 + 5 * close), parallel);
            lowest[parallel] = fmin(lowest[parallel], compare(engine, &view, shapes, name));
        }
    printf("%-34s %5.1f dB perspective, %5.1f dB parallel\n", name, lowest[0], lowest[1]);
    iso_shapes_destroy(shapes);
}

/* ---- glyphs */

static float positions[GLYPHS][3], radii[GLYPHS], directions[GLYPHS][3], axes[GLYPHS][9];
static uint8_t colors[GLYPHS][3];
static iso_glyphs glyphs;

/* Glyphs in the box +-half, with sizes between low and high. */
static void scatter(double x, double y, double z, double half, double low, double high) {
    uint32_t seed = 11;
    glyphs = (iso_glyphs){.count = GLYPHS,
                          .origin = iso_vec3_make(x, y, z),
                          .positions = positions,
                          .radii = radii,
                          .directions = directions,
                          .axes = axes,
                          .colors = colors};
    for (int i = 0; i < GLYPHS; i++) {
        radii[i] = (float)(low + (high - low) * uniform(&seed) * uniform(&seed));
        for (int a = 0; a < 3; a++) {
            positions[i][a] = (float)(half * (2 * uniform(&seed) - 1));
            colors[i][a] = (uint8_t)random_bits(&seed);
            directions[i][a] = (float)(4 * (double)radii[i] * (2 * uniform(&seed) - 1));
        }
        for (int k = 0; k < 9; k++) axes[i][k] = (float)(2 * (double)radii[i] * (2 * uniform(&seed) - 1));
    }
}

static iso_shapes *glyphs_as(iso_glyph glyph, iso_glyph_projection projection) {
    const iso_shapes_opts opts = {.glyph = glyph, .projection = projection};
    iso_shapes *shapes;
    iso_error error = {0};
    test_ok(iso_shapes_from_glyphs(&glyphs, &opts, &shapes, &error), &error);
    return shapes;
}

static void spheres(iso_gl_engine *engine) {
    scatter(0, 0, 0, 10, 0.1, 1.5);
    compare_views(engine, glyphs_as(ISO_GLYPH_SPHERE, 0), glyphs.origin, AWAY, 26, "spheres");
    compare_views(engine, glyphs_as(ISO_GLYPH_SPHERE, ISO_GLYPH_PROJECTION_BILLBOARD), glyphs.origin, AWAY,
                  26, "billboards of spheres");
    compare_views(engine, glyphs_as(ISO_GLYPH_SPHERE, 0), glyphs.origin, iso_vec3_make(4e4, 5e4, -6e4), 26,
                  "spheres from afar");
    compare_views(engine, glyphs_as(ISO_GLYPH_SPHERE, 0), glyphs.origin, iso_vec3_make(4, -3, 5), 12,
                  "spheres, eye among them");
    scatter(1e7, -2e7, 3e7, 10, 0.1, 1.5);
    compare_views(engine, glyphs_as(ISO_GLYPH_SPHERE, 0), glyphs.origin, AWAY, 26, "spheres at 1e7 mm");
}

/* ---- lines */

static test_lines lines;

static void walk(double x, double y, double z, double low, double high) {
    uint32_t seed = 5;
    test_lines_start(&lines, x, y, z);
    for (int i = 0; i < 60; i++) test_lines_add_walk(&lines, 20, 9, 1.8, low, high, &seed);
    for (size_t i = 0; i < lines.lines.vertex_count; i++)
        for (int a = 0; a < 3; a++) lines.colors[i][a] = (uint8_t)random_bits(&seed);
    lines.lines.colors = lines.colors;
}

static iso_shapes *lines_as(const iso_shapes_opts *opts) {
    iso_shapes *shapes;
    iso_error error = {0};
    test_ok(iso_shapes_from_lines(&lines.lines, opts, &shapes, &error), &error);
    return shapes;
}

static void tubes(iso_gl_engine *engine) {
    const iso_vec3 origin = {0, 0, 0};
    const iso_shapes_opts usual = {.radius = 0.3, .min_pixels = 1},
                          flat = {.radius = 0.3, .caps = ISO_CAPS_FLAT},
                          thin = {.radius = 1e-3, .min_pixels = 3};
    walk(0, 0, 0, 0.1, 0.9);
    compare_views(engine, lines_as(&usual), origin, AWAY, 26, "tapered tubes");
    compare_views(engine, lines_as(&flat), origin, AWAY, 26, "tubes with flat caps");
    compare_views(engine, lines_as(&usual), origin, iso_vec3_make(4, -3, 5), 12, "tubes, eye among them");
    walk(0, 0, 0, 0.4, 1.5);
    compare_views(engine, lines_as(&usual), origin, iso_vec3_make(0.5, 0.2, -0.3), 1.5, "tubes, eye inside");
    lines.lines.radii = NULL;
    compare_views(engine, lines_as(&usual), origin, AWAY, 26, "even tubes");
    compare_views(engine, lines_as(&thin), origin, AWAY, 26, "lines three pixels wide");
    walk(1e7, -2e7, 3e7, 0.1, 0.9);
    compare_views(engine, lines_as(&usual), lines.lines.origin, AWAY, 26, "tubes at 1e7 mm");
}

static void ribbons(iso_gl_engine *engine) {
    const iso_vec3 origin = {0, 0, 0};
    const iso_shapes_opts usual = {.radius = 0.3, .min_pixels = 1, .style = ISO_LINE_RIBBON};
    iso_error error = {0};
    walk(0, 0, 0, 0.1, 0.9);
    test_ok(iso_lines_add_normals(&lines.lines, &error), &error);
    compare_views(engine, lines_as(&usual), origin, AWAY, 26, "ribbons");
    compare_views(engine, lines_as(&usual), origin, iso_vec3_make(4, -3, 5), 12, "ribbons, eye among them");
    lines.lines.origin = iso_vec3_make(1e7, -2e7, 3e7);
    compare_views(engine, lines_as(&usual), lines.lines.origin, AWAY, 26, "ribbons at 1e7 mm");
    iso_free(lines.lines.normals);
    lines.lines.normals = NULL;
}

static void solids(iso_gl_engine *engine) {
    static const char *const names[ISO_GLYPH_COUNT] = {
#define NAME(id, text) text,
        ISO_GLYPHS(NAME)
#undef NAME
    };
    const iso_vec3 origin = {0, 0, 0};
    for (iso_glyph glyph = ISO_GLYPH_CONE; glyph < ISO_GLYPH_COUNT; glyph++) {
        char name[64];
        snprintf(name, sizeof name, "%s", names[glyph]);
        scatter(0, 0, 0, 10, 0.2, 1.2);
        compare_views(engine, glyphs_as(glyph, 0), origin, AWAY, 26, name);
        snprintf(name, sizeof name, "%s, eye among them", names[glyph]);
        compare_views(engine, glyphs_as(glyph, 0), origin, iso_vec3_make(6, -4, 7), 12, name);
        snprintf(name, sizeof name, "%s at 1e7 mm, billboards", names[glyph]);
        scatter(1e7, -2e7, 3e7, 10, 0.2, 1.2);
        compare_views(engine, glyphs_as(glyph, ISO_GLYPH_PROJECTION_BILLBOARD), glyphs.origin, AWAY, 26,
                      name);
    }
}

/* ---- what holds for all kinds */

/* The near plane through shapes. */
static void cut_by_near_plane(iso_gl_engine *engine) {
    const iso_shapes_opts opts = {.radius = 0.5, .caps = ISO_CAPS_FLAT};
    for (int parallel = 0; parallel < VIEWS; parallel++) {
        iso_view view = view_of(iso_vec3_make(0, 0, 0), iso_vec3_make(0, 3, -20), 20, parallel);
        view.near = 17;
        walk(0, 0, 0, 0.4, 1.5);
        lines.lines.line_count = FEW / 4;
        iso_shapes *shapes = lines_as(&opts);
        double lowest = compare(engine, &view, shapes, "cut tubes");
        iso_shapes_destroy(shapes);
        scatter(0, 0, 0, 8, 0.5, 2.5);
        glyphs.count = FEW;
        for (iso_glyph glyph = ISO_GLYPH_SPHERE; glyph < ISO_GLYPH_COUNT; glyph++) {
            shapes = glyphs_as(glyph, 0);
            lowest = fmin(lowest, compare(engine, &view, shapes, "cut glyphs"));
            iso_shapes_destroy(shapes);
        }
        printf("cut by the near plane, %-11s %5.1f dB\n", parallel ? "parallel" : "perspective", lowest);
    }
}

/* A picture in parts, as when it is larger than the driver can draw, and strips of it are the same
 * picture. */
static void parts(iso_gl_engine *engine) {
    const iso_shapes_opts usual = {.radius = 0.3, .min_pixels = 1};
    const int whole = engine->max_side;
    walk(0, 0, 0, 0.1, 0.9);
    iso_shapes *shapes = lines_as(&usual);
    for (int parallel = 0; parallel < VIEWS; parallel++) {
        const iso_view view = view_of(lines.lines.origin, AWAY, 20, parallel);
        iso_gbuffer cpu = by_cpu(&view, shapes, NULL);
        engine->max_side = 77;
        iso_gbuffer gl = by_gl(engine, &view, shapes, NULL);
        engine->max_side = whole;
        gl_difference d = gl_compare(&view, &cpu, &gl);
        assert_true(d.psnr >= 45 && d.differ <= 3);
        iso_gbuffer_free(&cpu);
        iso_gbuffer_free(&gl);
        const iso_view strip = iso_view_rows(&view, 61, 80);
        cpu = by_cpu(&strip, shapes, NULL);
        gl = by_gl(engine, &strip, shapes, NULL);
        d = gl_compare(&strip, &cpu, &gl);
        assert_true(d.outline > 100 && d.psnr >= 45 && d.differ <= 3);
        iso_gbuffer_free(&cpu);
        iso_gbuffer_free(&gl);
    }
    iso_shapes_destroy(shapes);
}

/* Several sets and an earlier surface in one picture: the nearest is seen, and is counted. */
static void several_sets(iso_gl_engine *engine) {
    const iso_shapes_opts usual = {.radius = 0.3, .min_pixels = 1};
    const iso_view view = view_of(iso_vec3_make(0, 0, 0), AWAY, 24, false);
    iso_error error = {0};
    iso_gl_shapes *uploaded[2];
    iso_shapes_drawn drawn[2] = {{0}};
    size_t shown[2] = {0}, wrong = 0;
    scatter(0, 0, 0, 10, 0.1, 1.5);
    walk(0, 0, 0, 0.1, 0.9);
    iso_shapes *sets[2] = {glyphs_as(ISO_GLYPH_SPHERE, 0), lines_as(&usual)};
    iso_gbuffer cpu = gbuffer_of(&view), gl = gbuffer_of(&view);
    for (size_t i = 0; i < (size_t)WIDTH * HEIGHT / 3; i++) { /* a wall before the upper third */
        cpu.depth[i] = gl.depth[i] = 95;
        cpu.surface[i] = gl.surface[i] = 0;
        for (int a = 0; a < 3; a++) cpu.normal[a][i] = gl.normal[a][i] = a == 2 ? -1 : 0;
    }
    for (int i = 0; i < 2; i++) {
        const iso_target target = {&view, &cpu, NULL, (uint8_t)(i + 1), NULL};
        test_ok(iso_draw_shapes(&target, sets[i], NULL, &error), &error);
        test_ok(iso_gl_upload_shapes(engine, sets[i], &uploaded[i], &error), &error);
    }
    const iso_gl_shapes_opts opts = {&view, (const iso_gl_shapes *const *)uploaded, 2, 1};
    test_ok(iso_gl_draw_shapes(engine, &opts, &gl, drawn, &error), &error);
    for (size_t i = 0; i < (size_t)WIDTH * HEIGHT; i++) {
        wrong += cpu.surface[i] != gl.surface[i];
        for (int k = 0; k < 2; k++) shown[k] += gl.surface[i] == k + 1;
    }
    assert_true(wrong <= 10 && shown[0] > 1000 && shown[1] > 1000);
    for (int i = 0; i < 2; i++) {
        assert_true(drawn[i].samples == shown[i]);
        iso_gl_shapes_destroy(uploaded[i]);
        iso_shapes_destroy(sets[i]);
    }
    iso_gbuffer_free(&cpu);
    iso_gbuffer_free(&gl);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        gl_each_engine_test(spheres),           gl_each_engine_test(tubes),
        gl_each_engine_test(ribbons),           gl_each_engine_test(solids),
        gl_each_engine_test(cut_by_near_plane), gl_each_engine_test(parts),
        gl_each_engine_test(several_sets),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
