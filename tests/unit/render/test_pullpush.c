/* Pull-push: against a plain reference, against the ray caster, and against itself in every variant, on any
 * number of threads and in strips. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/cpu.h"
#include "check_support.h"
#include "extract/points/points.h"
#include "extract_support.h"
#include "grids/scenes/scenes.h"
#include "image/image.h"
#include "pullpush_reference.h"
#include "render/point_surface.h"
#include "render/points/point_blocks.h"
#include "render/pullpush/pyramid.h"
#include "render/shading/shading.h"
#include "scene_support.h"
#include "truth/raycast.h"
#include "truth_support.h"
#include "view_support.h"

/* ---- points to draw */

/* The same points as floats, with radii and colours of their own. */
typedef struct painted {
    iso_surfel *surfels;
    float *radii;
    uint8_t (*colors)[3];
    iso_point_view points;
} painted;

static painted paint(const iso_point_view *points, bool floats) {
    size_t count = 0;
    for (size_t s = 0; s < points->span_count; s++) {
        size_t end = points->spans[s].first + points->spans[s].count;
        count = end > count ? end : count;
    }
    painted p = {calloc(count, sizeof *p.surfels), calloc(count, sizeof *p.radii), calloc(count, 3), *points};
    assert_true(p.surfels && p.radii && p.colors);
    for (size_t i = 0; i < count; i++) {
        p.surfels[i] = iso_point_view_get(points, i);
        p.radii[i] = (float)(points->radius * (0.9 + 0.1 * (double)(i % 5)));
        for (int k = 0; k < 3; k++) p.colors[i][k] = (uint8_t)(i * (size_t)(7 + 4 * k));
    }
    if (floats) {
        p.points.packed = NULL;
        p.points.surfels = p.surfels;
    }
    p.points.radii = p.radii;
    p.points.colors = (const uint8_t(*)[3])p.colors;
    return p;
}

static void free_painted(painted *p) {
    free(p->surfels);
    free(p->radii);
    free(p->colors);
}

/* ---- pictures */

static reference_opts layout_of(const iso_view *view, const iso_point_view *points, bool box) {
    reference_opts opts = {
        .box = box, .low_pass = 0.5, .facing = 0.25, .edge = 0, .disc_radii = ISO_DISC_RADII};
    iso_error error = {0};
    iso_point_blocks blocks = {0};
    iso_projector projector = iso_projector_make(view, &points->transform);
    test_ok(iso_point_blocks_make(&blocks, points, &projector, NULL, &error), &error);
    iso_pyramid_levels(blocks.radius, 2, &opts.base, &opts.top);
    opts.guard = iso_pyramid_layout_of(view, opts.base, opts.top).guard;
    opts.cull = points->closed && !blocks.around_eye;
    iso_point_blocks_free(&blocks);
    return opts;
}

/* ---- against the reference */

/* What may differ: pixels where rounding decides whether a point, or an ellipse, is in. */
static void like_reference(const iso_view *view, const iso_point_view *points, bool box) {
    iso_point_surface_opts opts = {.reconstruction =
                                       box ? ISO_RECONSTRUCTION_BOX : ISO_RECONSTRUCTION_GAUSSIAN};
    iso_gbuffer got = test_drawn(view, points, &opts, NULL);
    iso_gbuffer wanted = test_clear_gbuffer(view->width, view->height, points->colors != NULL);
    reference_opts layout = layout_of(view, points, box);
    reference_pullpush(&layout, view, points, &wanted);
    size_t samples = (size_t)view->width * (size_t)view->height, off = 0, seen = test_covered(&wanted);
    assert_true(seen > samples / 50);
    for (size_t i = 0; i < samples; i++) {
        bool a = got.surface[i] != ISO_SURFACE_NONE, b = wanted.surface[i] != ISO_SURFACE_NONE;
        if (a != b) off++;
        if (!a || !b) continue;
        double cosine = 0;
        for (int k = 0; k < 3; k++) cosine += (double)got.normal[k][i] * (double)wanted.normal[k][i];
        bool near = fabsf(got.depth[i] - wanted.depth[i]) < 0.02 * points->radius && cosine > 0.9995;
        for (int k = 0; near && points->colors && k < 3; k++)
            near = abs((int)(got.color[i] >> 8 * k & 255) - (int)(wanted.color[i] >> 8 * k & 255)) <= 1;
        off += !near;
    }
    if (off * 100 > seen)
        fail_msg("%zu of %zu samples differ, base %d, top %d", off, seen, layout.base, layout.top);
    iso_gbuffer_free(&got);
    iso_gbuffer_free(&wanted);
}

static void like_the_reference(void **state) {
    (void)state;
    static const char *const names[] = {"sphere", "gyroid", "cube", "cylinder"};
    static const double zooms[] = {0.5, 1, 4, 14};
    for (int n = 0; n < 4; n++) {
        test_scene s = test_scene_make(names[n], 32, NULL, n != 2);
        for (int z = 0; z < 4; z++) {
            iso_view view = test_look_at(&s, n + z, zooms[z], (n + z) % 3 == 0, 83 + 10 * n, 101);
            like_reference(&view, &s.points, z % 2);
        }
        painted p = paint(&s.points, n % 2);
        iso_view view = test_look_at(&s, n, n % 2 ? 1 : 6, false, 90, 67);
        like_reference(&view, &p.points, n > 1);
        free_painted(&p);
        test_scene_free(&s);
    }
}

/* ---- against itself */

static void same_bytes_everywhere(void **state) {
    (void)state;
    static const char *const names[] = {"gyroid", "sphere", "head"};
    static const double zooms[] = {0.7, 3, 11, 60};
    for (int n = 0; n < 3; n++) {
        test_scene s = test_scene_make(names[n], 40, NULL, n == 1);
        painted p = paint(&s.points, n == 0);
        for (int z = 0; z < 4; z++) {
            iso_view view = test_look_at(&s, n + 2 * z, zooms[z], z == 1, 131 - 9 * n, 143);
            const iso_point_view *points = z == 2 ? &p.points : &s.points;
            iso_gbuffer whole = test_drawn(&view, points, NULL, NULL);
            assert_true(test_covered(&whole) > 100);
            test_every_variant(&view, points, NULL, &whole);
            test_every_strip(&view, points, NULL, &whole);
            iso_gbuffer_free(&whole);
        }
        free_painted(&p);
        test_scene_free(&s);
    }
}

/* Whatever was drawn before. */
static void workspaces_hold_nothing(void **state) {
    (void)state;
    test_scene sphere = test_scene_make("sphere", 40, NULL, true),
               gyroid = test_scene_make("gyroid", 24, NULL, false);
    painted p = paint(&gyroid.points, false);
    iso_point_workspace *workspace;
    assert_int_equal(iso_point_workspace_create(&workspace, NULL), ISO_OK);
    iso_point_surface_opts opts = {.reconstruction = ISO_RECONSTRUCTION_GAUSSIAN, .workspace = workspace};
    uint32_t seed = 3;
    int width = 0, height = 0;
    for (int i = 0; i < 60; i++) {
        const test_scene *s = i % 2 ? &sphere : &gyroid;
        const iso_point_view *points = i % 6 == 2 ? &p.points : &s->points;
        if (i % 4 == 0) { /* memory is laid out anew only when the size changes */
            width = 20 + (int)(100 * uniform(&seed));
            height = 20 + (int)(100 * uniform(&seed));
        }
        iso_view view = test_look_at(s, i % 6, exp(5 * uniform(&seed) - 1), i % 5 == 0, width, height);
        iso_gbuffer fresh = test_drawn(&view, points, NULL, NULL),
                    again = test_drawn(&view, points, &opts, NULL);
        test_same_rows(&fresh, 0, &again);
        iso_gbuffer_free(&fresh);
        iso_gbuffer_free(&again);
    }
    iso_point_workspace_destroy(workspace);
    iso_point_workspace_destroy(NULL);
    free_painted(&p);
    test_scene_free(&sphere);
    test_scene_free(&gyroid);
}

/* Bounds only save work. */
static void bounds_change_nothing(void **state) {
    (void)state;
    test_scene s = test_scene_make("torus", 48, NULL, true);
    assert_true(s.points.closed && s.points.bounds);
    int compared = 0;
    for (int side = 0; side < 6; side++) {
        iso_view view = test_look_at(&s, side, 1 + side, side == 4, 120, 90);
        iso_point_view without = s.points;
        without.bounds = NULL;
        reference_opts a_layout = layout_of(&view, &s.points, false),
                       b_layout = layout_of(&view, &without, false);
        if (a_layout.top != b_layout.top || a_layout.base != b_layout.base)
            continue; /* looser, more levels */
        compared++;
        iso_gbuffer a = test_drawn(&view, &s.points, NULL, NULL), b = test_drawn(&view, &without, NULL, NULL);
        test_same_rows(&a, 0, &b);
        iso_gbuffer_free(&a);
        iso_gbuffer_free(&b);
    }
    assert_true(compared > 0);
    test_scene_free(&s);
}

/* ---- what it looks like */

enum { SHEET = 80 };

typedef struct sheet {
    iso_surfel surfels[SHEET * SHEET];
    iso_point_span span;
    iso_point_view points;
} sheet;

/* Points one apart in the plane z = depth + slope * x, around (0, 0); the normal towards the eye, or away.
 */
static void make_sheet(sheet *s, double depth, double slope, double sign) {
    double length = sqrt(1 + slope * slope);
    for (int i = 0; i < SHEET * SHEET; i++) {
        double x = i % SHEET - SHEET / 2 + 0.5, y = i / SHEET - SHEET / 2 + 0.5;
        s->surfels[i] = (iso_surfel){
            {(float)x, (float)y, (float)(depth + slope * x)},
            {(float)(sign * slope / length), 0, (float)(-sign / length)},
        };
    }
    s->span = (iso_point_span){.count = SHEET * SHEET};
    s->points = (iso_point_view){.surfels = s->surfels,
                                 .spans = &s->span,
                                 .span_count = 1,
                                 .transform = iso_transform_identity(),
                                 .radius = sqrt(0.5)};
}

/* Checks a picture of the sheet: apart from its rim it covers every pixel but one in a thousand, and its
 * depths are within `tolerance` of the plane's. Lengths are in distances of neighbouring points. */
static void check_sheet(const sheet *s, const iso_view *view, double depth, double slope, double tolerance) {
    iso_gbuffer g = test_drawn(view, &s->points, NULL, NULL);
    const float *n = s->surfels[0].normal;
    size_t inside = 0, missing = 0;
    for (int j = 0; j < view->height; j++)
        for (int i = 0; i < view->width; i++) {
            double u = (i + 0.5 - view->cx) / view->focal, v = (j + 0.5 - view->cy) / view->focal;
            double z = view->orthographic ? depth + slope * u : depth / (1 - slope * u);
            double x = view->orthographic ? u : u * z, y = view->orthographic ? v : v * z;
            if (fabs(x) > SHEET / 2 - 2 || fabs(y) > SHEET / 2 - 2) continue;
            size_t at = (size_t)j * (size_t)view->width + (size_t)i;
            inside++;
            if (g.surface[at] != 0) {
                missing++;
                continue;
            }
            if (!(fabs(g.depth[at] - z) <= tolerance))
                fail_msg("depth %g instead of %g at %d %d", (double)g.depth[at], z, i, j);
            for (int k = 0; k < 3; k++) assert_true(fabsf(g.normal[k][at] - n[k]) < 0.002f);
        }
    assert_true(inside > 500);
    if (missing * 1000 > inside) fail_msg("%zu holes among %zu", missing, inside);
    iso_gbuffer_free(&g);
}

static void planes_have_few_holes(void **state) {
    (void)state;
    static const double focals[] = {0.4, 1, 2.7, 9, 31, 120};
    sheet *s = malloc(sizeof *s);
    assert_non_null(s);
    for (int k = 0; k < 6; k++)
        for (int tilt = 0; tilt < 3; tilt++)
            for (int away = 0; away < 2; away++) {
                double slope = 0.35 * tilt, depth = 100;
                make_sheet(s, depth, slope, away ? -1 : 1);
                double tolerance = 1e-4 + 0.8 * slope; /* points in a pixel are nearest or averaged */
                iso_view flat = test_plain_view(150, 140, true, focals[k]);
                iso_view deep = test_plain_view(150, 140, false, focals[k] * depth);
                check_sheet(s, &flat, depth, slope, tolerance + slope / focals[k]);
                check_sheet(s, &deep, depth, slope, (tolerance + slope / focals[k]) * 2);
            }
    free(s);
}

/* A rectangular grid of points on a plane that is tilted by `degrees`, seen in parallel with `pitch` pixels
 * between neighbouring points. Returns how many of a million pixels are open, 3 such distances or more inside
 * the plane's outline, which is notched at a slant. */
static double open_pixels(double degrees, double pitch) {
    const double c = cos(degrees * ISO_PI / 180), t = sin(degrees * ISO_PI / 180);
    const int side = pitch < 2 ? 240 : 80;
    iso_surfel *surfels = malloc((size_t)(side * side) * sizeof *surfels);
    assert_non_null(surfels);
    for (int i = 0; i < side * side; i++) {
        const double u = i % side - 0.5 * side + 0.21, v = i / side - 0.5 * side - 0.13;
        surfels[i] = (iso_surfel){{(float)u, (float)(v * c), (float)(200 + v * t)}, {0, (float)t, (float)-c}};
    }
    iso_point_span span = {.count = (uint32_t)(side * side)};
    iso_point_view points = {.surfels = surfels,
                             .spans = &span,
                             .span_count = 1,
                             .transform = iso_transform_identity(),
                             .radius = sqrt(0.5)};
    const iso_view view = test_plain_view(180, 170, true, pitch);
    const iso_point_surface_opts opts = {.reconstruction = ISO_RECONSTRUCTION_GAUSSIAN};
    iso_gbuffer g = test_drawn(&view, &points, &opts, NULL);
    size_t inside = 0, open = 0;
    for (int i = 0; i < view.width * view.height; i++) {
        const double x = (i % view.width + 0.5 - view.cx) / pitch,
                     y = (i / view.width + 0.5 - view.cy) / pitch;
        if (fabs(x) > 0.5 * side - 3 || fabs(y) > 0.5 * side * c - 3) continue;
        inside++;
        open += g.surface[i] == ISO_SURFACE_NONE;
    }
    assert_true(inside > 500);
    iso_gbuffer_free(&g);
    free(surfels);
    return 1e6 * (double)open / (double)inside;
}

/* Planes of points at every tilt are closed, from many points a pixel to many pixels a point. */
static void tilted_planes_are_closed(void **state) {
    (void)state;
    static const double tilts[] = {0, 30, 60, 72, 80}, pitches[] = {0.63, 1, 2, 4, 10, 32, 100};
    for (int t = 0; t < 5; t++)
        for (int p = 0; p < 7; p++) {
            const double open = open_pixels(tilts[t], pitches[p]);
            if (open > 500)
                fail_msg("%g pixels in a million open, %g degrees, %g pixels", open, tilts[t], pitches[p]);
        }
}

static void single_points(void **state) {
    (void)state;
    iso_surfel surfel = {{0.3f, -0.2f, 10}, {0, 0, -1}};
    iso_point_span span = {.count = 1};
    iso_point_view points = {.surfels = &surfel,
                             .spans = &span,
                             .span_count = 1,
                             .transform = iso_transform_identity(),
                             .radius = 1};
    for (int k = 0; k < 5; k++) {
        double radius = 0.25 * (1 << 2 * k); /* pixels */
        iso_view view = test_plain_view(201, 199, false, 10 * radius);
        iso_gbuffer g = test_drawn(&view, &points, NULL, NULL);
        double x = 0.3 * radius + view.cx, y = -0.2 * radius + view.cy;
        double area = ISO_PI * (ISO_DISC_RADII * ISO_DISC_RADII * radius * radius + 0.5);
        size_t seen = test_covered(&g), own = (size_t)(floor(y) * view.width + floor(x));
        assert_int_equal(g.surface[own], 0);
        assert_true(fabsf(g.depth[own] - 10) < 1e-5f);
        assert_true((double)seen < area * 1.1 + 5 && (double)seen > area * 0.95 - 3);
        for (int i = 0; i < view.width * view.height; i++)
            if (g.surface[i] == 0) {
                double dx = i % view.width + 0.5 - x, dy = i / view.width + 0.5 - y;
                assert_true(dx * dx + dy * dy < area / ISO_PI + 4 * sqrt(area / ISO_PI) + 4);
            }
        iso_gbuffer_free(&g);
    }
    points.span_count = 0;
    iso_view view = test_plain_view(40, 30, false, 10);
    iso_gbuffer g = test_drawn(&view, &points, NULL, NULL);
    assert_int_equal(test_covered(&g), 0);
    iso_gbuffer_free(&g);
    points.span_count = 1;
    span.count = 0;
    g = test_drawn(&view, &points, NULL, NULL);
    assert_int_equal(test_covered(&g), 0);
    iso_gbuffer_free(&g);
}

/* Points behind, on both sides of, and far beyond the near plane; some that are no points. */
static void near_plane(void **state) {
    (void)state;
    enum { MANY = 6000 };
    iso_surfel *surfels = calloc(MANY, sizeof *surfels);
    assert_non_null(surfels);
    uint32_t seed = 11;
    for (int i = 0; i < MANY; i++) {
        double distance = i % 3 ? 6 * uniform(&seed) - 2 : exp(30 * uniform(&seed) - 15);
        surfels[i] =
            (iso_surfel){{(float)(4 * uniform(&seed) - 2), (float)(4 * uniform(&seed) - 2), (float)distance},
                         {(float)(uniform(&seed) - 0.5), (float)(uniform(&seed) - 0.5), -0.3f}};
    }
    surfels[7].position[1] = NAN;
    surfels[8].position[2] = INFINITY;
    surfels[9].normal[0] = NAN;
    surfels[10] = (iso_surfel){{0, 0, 1}, {0, 0, 0}};
    iso_point_span span = {.count = MANY};
    iso_point_view points = {.surfels = surfels,
                             .spans = &span,
                             .span_count = 1,
                             .transform = iso_transform_identity(),
                             .radius = 0.05};
    for (int orthographic = 0; orthographic < 2; orthographic++) {
        iso_view view = test_plain_view(120, 100, orthographic, 60);
        view.near = 1.5;
        iso_gbuffer g = test_drawn(&view, &points, NULL, NULL);
        assert_true(test_covered(&g) > 3000);
        for (size_t i = 0; i < 120 * 100; i++) {
            if (g.surface[i] == ISO_SURFACE_NONE) continue;
            assert_true(g.depth[i] >= 1.5f && g.depth[i] < 1e30f);
            float square = 0;
            for (int k = 0; k < 3; k++) square += g.normal[k][i] * g.normal[k][i];
            assert_true(fabsf(square - 1) < 1e-4f);
        }
        test_every_variant(&view, &points, NULL, &g);
        test_every_strip(&view, &points, NULL, &g);
        iso_gbuffer_free(&g);
    }
    free(surfels);
}

/* From inside: what is behind the eye is not there, what is before it is, and has no holes. */
static void eye_inside(void **state) {
    (void)state;
    test_scene s = test_scene_make("sphere", 48, NULL, true);
    iso_affine affine = iso_transform_affine(&s.points.transform);
    iso_vec3 center = iso_affine_point(&affine, iso_vec3_make(23.5, 23.5, 23.5));
    iso_camera camera = {.position = center, .view_up = {0, 0, 1}, .view_angle = 60};
    camera.focal_point = iso_vec3_add(center, iso_vec3_make(0.3, 1, 0.2));
    iso_view view = iso_view_make(&camera, 128, 128);
    iso_gbuffer g = test_drawn(&view, &s.points, NULL, NULL);
    assert_int_equal(test_covered(&g), 128 * 128);
    for (size_t i = 0; i < 128 * 128; i++) {
        assert_true(g.depth[i] > 14 && g.depth[i] < 20);
        assert_true(g.normal[2][i] > 0.5f); /* out of the solid, away from the eye */
    }
    test_every_strip(&view, &s.points, NULL, &g);
    iso_gbuffer_free(&g);
    test_scene_free(&s);
}

/* ---- over what is there */

static void nearer_surfaces_win(void **state) {
    (void)state;
    sheet *front = malloc(sizeof *front), *back = malloc(sizeof *back);
    assert_true(front && back);
    make_sheet(front, 50, 0, 1);
    make_sheet(back, 60, 0, 1);
    const iso_point_surface_opts opts = {.reconstruction = ISO_RECONSTRUCTION_GAUSSIAN};
    iso_view view = test_plain_view(60, 60, true, 3);
    view.cx = 15; /* the sheet at the left */
    view.cy = 200;
    iso_view other = view;
    iso_gbuffer a = test_clear_gbuffer(60, 60, false), b = test_clear_gbuffer(60, 60, false);
    other.cx = 45;
    for (int order = 0; order < 2; order++) {
        iso_gbuffer *g = order ? &b : &a;
        for (int k = 0; k < 2; k++) {
            bool near = (k == 0) == (order == 0);
            iso_target target = {near ? &view : &other, g, NULL, near ? 3 : 9, NULL};
            assert_int_equal(
                iso_draw_point_surface(&target, near ? &front->points : &back->points, &opts, NULL), ISO_OK);
        }
    }
    test_same_rows(&a, 0, &b);
    iso_gbuffer alone = test_clear_gbuffer(60, 60, false);
    iso_target target = {&view, &alone, NULL, 3, NULL};
    assert_int_equal(iso_draw_point_surface(&target, &front->points, &opts, NULL), ISO_OK);
    for (size_t i = 0; i < 3600; i++)
        assert_int_equal(a.surface[i], alone.surface[i] == 3 ? 3 : a.surface[i] == 9 ? 9 : ISO_SURFACE_NONE);
    iso_gbuffer_free(&a);
    iso_gbuffer_free(&b);
    iso_gbuffer_free(&alone);
    free(front);
    free(back);
}

/* ---- colours */

static void colors_come_through(void **state) {
    (void)state;
    sheet *s = malloc(sizeof *s);
    uint8_t(*colors)[3] = malloc(SHEET * SHEET * sizeof *colors);
    assert_true(s && colors);
    make_sheet(s, 50, 0, 1);
    for (int i = 0; i < SHEET * SHEET; i++) {
        bool left = i % SHEET < SHEET / 2;
        memcpy(colors[i], left ? (const uint8_t[3]){255, 10, 0} : (const uint8_t[3]){0, 20, 200}, 3);
    }
    s->points.colors = (const uint8_t(*)[3])colors;
    for (int k = 0; k < 3; k++) {
        iso_view view = test_plain_view(96, 64, true, k == 0 ? 1.0 : k == 1 ? 4.0 : 40.0);
        iso_gbuffer g = test_drawn(&view, &s->points, NULL, NULL);
        assert_non_null(g.color);
        for (int i = 0; i < 96 * 64; i++) {
            if (g.surface[i] == ISO_SURFACE_NONE) continue;
            double x = (i % 96 + 0.5 - view.cx) / view.focal;
            uint32_t wanted = x < 0 ? 255 | 10 << 8 | 1 << 24 : 20 << 8 | 200 << 16 | 1 << 24;
            if (fabs(x) > 4) assert_int_equal(g.color[i], wanted);
            assert_int_equal(g.color[i] >> 24, 1);
        }
        iso_gbuffer_free(&g);
    }
    free(colors);
    free(s);
}

/* A picture of points that are all of one colour is that of a surface of this colour. */
static void colors_are_shaded(void **state) {
    (void)state;
    test_scene s = test_scene_make("sphere", 32, NULL, true);
    painted p = paint(&s.points, false);
    p.points.radii = NULL;
    size_t count = iso_point_view_count(&s.points);
    for (size_t i = 0; i < count; i++) memcpy(p.colors[i], (const uint8_t[3]){30, 200, 90}, 3);
    iso_view view = test_look_at(&s, 1, 1, false, 75, 63); /* no whole number of vectors */
    iso_gbuffer g[2] = {test_drawn(&view, &p.points, NULL, NULL), test_drawn(&view, &s.points, NULL, NULL)};
    assert_null(g[1].color);
    iso_image image[2][2];
    for (int k = 0; k < 2; k++)
        for (int factor = 1; factor <= 3; factor += 2) {
            const iso_rgb color = k ? (iso_rgb){30, 200, 90} : (iso_rgb){1, 2, 3};
            const iso_shading shading = {.colors = &color, .color_count = 1, .background = {9, 9, 9}};
            iso_image *to = &image[k][factor / 2];
            iso_strip strip = {&view, &g[k], factor, 0};
            assert_int_equal(iso_image_create(75 / factor, 63 / factor, to, NULL), ISO_OK);
            iso_shade(&shading, &strip, to, NULL);
        }
    assert_memory_equal(image[0][0].rgba, image[1][0].rgba, 75 * 63 * 4);
    assert_memory_equal(image[0][1].rgba, image[1][1].rgba, 25 * 21 * 4);
    for (int k = 0; k < 2; k++) {
        iso_gbuffer_free(&g[k]);
        iso_image_free(&image[k][0]);
        iso_image_free(&image[k][1]);
    }
    free_painted(&p);
    test_scene_free(&s);
}

/* Of equal points the first shows, in whatever order spans come. */
static void equal_points_have_an_order(void **state) {
    (void)state;
    iso_surfel surfels[3] = {{{1, 1, 20}, {0, 0, -1}}, {{1, 1, 20}, {0, 0, -1}}, {{1, 1, 20}, {0, 0, -1}}};
    const uint8_t colors[3][3] = {{1, 2, 3}, {4, 5, 6}, {7, 8, 9}};
    iso_point_span spans[3] = {{.count = 1, .first = 0}, {.count = 1, .first = 1}, {.count = 1, .first = 2}};
    iso_point_view points = {.surfels = surfels,
                             .spans = spans,
                             .span_count = 3,
                             .colors = colors,
                             .transform = iso_transform_identity(),
                             .radius = 0.01};
    iso_view view = test_plain_view(32, 32, true, 1);
    for (int order = 0; order < 3; order++) {
        iso_point_span first = spans[0];
        spans[0] = spans[order];
        spans[order] = first;
        iso_gbuffer g = test_drawn(&view, &points, NULL, NULL);
        assert_int_equal(g.color[17 * 32 + 17], 1 | 2 << 8 | 3 << 16 | 1 << 24);
        iso_gbuffer_free(&g);
    }
}

/* ---- open and closed */

static void closed_is_known(void **state) {
    (void)state;
    iso_error error = {0};
    const iso_vec3 middle = {20, 20, 20}, edge = {20, 20, 6};
    for (int dense = 0; dense < 2; dense++)
        for (int open = 0; open < 2; open++)
            for (int primitive = ISO_PRIMITIVE_EDGE; primitive <= ISO_PRIMITIVE_FOOT_ITERATED; primitive++) {
                iso_grid grid = test_ball_grid(41, open ? edge : middle, 12.3, dense);
                iso_points_opts opts = {.primitive = (iso_primitive)primitive};
                iso_point_set *set;
                test_ok(iso_point_set_create(&grid, &opts, &set, &error), &error);
                test_ok(iso_point_set_update(set, &error), &error);
                assert_false(iso_point_set_view(set).closed);
                test_ok(iso_point_set_bound(set, &error), &error);
                assert_int_equal(iso_point_set_view(set).closed, !open);
                test_ok(iso_point_set_update(set, &error), &error);
                assert_null(iso_point_set_view(set).bounds);
                iso_point_set_destroy(set);
                iso_grid_destroy(&grid);
            }
    /* a hole in the data is a hole in the surface */
    iso_grid grid = test_ball_grid(41, middle, 12.3, 1);
    test_set(&grid, 20, 32, 20, NAN);
    iso_points_opts opts = {.primitive = ISO_PRIMITIVE_EDGE};
    iso_point_set *set;
    test_ok(iso_point_set_create(&grid, &opts, &set, &error), &error);
    test_ok(iso_point_set_update(set, &error), &error);
    test_ok(iso_point_set_bound(set, &error), &error);
    assert_false(iso_point_set_view(set).closed);
    iso_point_set_destroy(set);
    iso_grid_destroy(&grid);
}

/* Half a ball, looked into: its inside is there; said to be closed, it is not. */
static void open_surfaces_show_their_inside(void **state) {
    (void)state;
    iso_grid grid = test_ball_grid(41, iso_vec3_make(20, 0, 20), 15, 1);
    iso_points_opts opts = {0};
    test_scene s = {.grid = grid};
    iso_error error = {0};
    test_ok(iso_point_set_create(&grid, &opts, &s.set, &error), &error);
    test_ok(iso_point_set_update(s.set, &error), &error);
    test_ok(iso_point_set_bound(s.set, &error), &error);
    s.points = iso_point_set_view(s.set);
    /* along +y, onto the open side at y = 0 */
    iso_camera camera = {.position = {20, -50, 20},
                         .focal_point = {20, 0, 20},
                         .view_up = {0, 0, 1},
                         .view_angle = 30,
                         .orthographic = true,
                         .parallel_scale = 20};
    iso_view view = iso_view_make(&camera, 100, 100);
    iso_gbuffer open = test_drawn(&view, &s.points, NULL, NULL);
    iso_point_view closed = s.points;
    closed.closed = true;
    iso_gbuffer shut = test_drawn(&view, &closed, NULL, NULL);
    assert_true(test_covered(&open) > 3000);
    assert_true(test_covered(&shut) < test_covered(&open) / 4);
    size_t inside = 0;
    for (size_t i = 0; i < 10000; i++) inside += open.surface[i] == 0 && open.normal[2][i] > 0.3f;
    assert_true(inside > 2000);
    iso_gbuffer_free(&open);
    iso_gbuffer_free(&shut);
    test_scene_free(&s);
}

/* ---- against the truth */

static void near_the_truth(void **state) {
    (void)state;
    /* decibels over the union of both silhouettes; holes in a thousand; pixels of dilation; measured: see
     * the margins */
    static const struct {
        const char *name;
        int size;
        double zoom, decibels, holes, wider;
    } cases[] = {{"sphere", 64, 1, 40.5, 0.2, 0.1}, {"sphere", 64, 5, 54, 0.1, 0.2},
                 {"sphere", 64, 20, 57, 0.1, 0.2},  {"cylinder", 64, 1, 25, 0.2, 1.2},
                 {"torus", 96, 1, 36.2, 0.1, 0.06}, {"gyroid", 48, 1, 22, 0.1, 0.7},
                 {"gyroid", 48, 4, 25.5, 0.1, 0.3}, {"cube", 32, 1.5, 33, 0.2, 2.3}};
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        iso_error error = {0};
        test_scene s = test_scene_make(cases[k].name, cases[k].size, NULL, true);
        iso_view view = test_look_at(&s, (int)k % 6, cases[k].zoom, false, 300, 300);
        iso_gbuffer got = test_drawn(&view, &s.points, NULL, NULL),
                    truth = test_clear_gbuffer(300, 300, false);
        iso_raycaster *caster;
        test_ok(iso_raycaster_create(&s.grid, s.isovalue, NULL, &caster, &error), &error);
        iso_target target = {&view, &truth, NULL, 0, NULL};
        test_ok(iso_draw_raycast(&target, caster, &error), &error);
        size_t inside, missing = test_holes(&truth, &got, &inside);
        double decibels = test_psnr(&view, &truth, &got), wider = test_dilation(&truth, &got);
        print_message("%-8s zoom %4g: %.1f dB, %.2f holes in a thousand, %.2f pixels wider\n", cases[k].name,
                      cases[k].zoom, decibels, 1e3 * (double)missing / (double)inside, wider);
        assert_true(wider < cases[k].wider);
        assert_true(decibels > cases[k].decibels);
        assert_true(1e3 * (double)missing < cases[k].holes * (double)inside);
        iso_raycaster_destroy(caster);
        iso_gbuffer_free(&got);
        iso_gbuffer_free(&truth);
        test_scene_free(&s);
    }
}

/* A picture wider than the library draws at once. */
static void large_pictures(void **state) {
    (void)state;
    test_scene s = test_scene_make("torus", 32, NULL, true);
    iso_view view = test_look_at(&s, 1, 1, false, 6000, 2200);
    iso_pool *pool;
    assert_int_equal(iso_pool_create(2, &pool, NULL), ISO_OK);
    iso_gbuffer whole = test_drawn(&view, &s.points, NULL, pool);
    iso_view rows = iso_view_rows(&view, 1000, 200);
    iso_gbuffer strip = test_drawn(&rows, &s.points, NULL, pool);
    assert_true(test_covered(&strip) > 100000);
    test_same_rows(&whole, 1000, &strip);
    iso_gbuffer_free(&whole);
    iso_gbuffer_free(&strip);
    iso_pool_destroy(pool);
    test_scene_free(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(like_the_reference),
        cmocka_unit_test(same_bytes_everywhere),
        cmocka_unit_test(workspaces_hold_nothing),
        cmocka_unit_test(bounds_change_nothing),
        cmocka_unit_test(planes_have_few_holes),
        cmocka_unit_test(tilted_planes_are_closed),
        cmocka_unit_test(single_points),
        cmocka_unit_test(near_plane),
        cmocka_unit_test(eye_inside),
        cmocka_unit_test(nearer_surfaces_win),
        cmocka_unit_test(colors_come_through),
        cmocka_unit_test(colors_are_shaded),
        cmocka_unit_test(equal_points_have_an_order),
        cmocka_unit_test(closed_is_known),
        cmocka_unit_test(open_surfaces_show_their_inside),
        cmocka_unit_test(near_the_truth),
        cmocka_unit_test(large_pictures),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
