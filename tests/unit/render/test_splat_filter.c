/* Flat discs: their low-pass filter against aliasing, on a zone plate of a million coloured surfels,
 * against the mean of the analytic pattern over each pixel; and that it makes no silhouette grow. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "extract/points/points.h"
#include "scene_support.h"

/* ---- the zone plate: concentric rings of a plane through (0, 0, DISTANCE), tilted around the x axis */

enum { SIDE = 1000, TILE = 20, DISTANCE = 5000, PICTURE = 200, STEPS = 3 };

typedef struct plate {
    iso_surfel *surfels;
    uint8_t (*colors)[3];
    iso_point_span spans[SIDE / TILE * (SIDE / TILE)];
    double cosine, sine; /* of the tilt */
    iso_point_view points;
} plate;

/* The brightness at a position in the plane, mm. Rings are half a mm wide, as surfels are far apart, at 500
 * mm. */
static double brightness(double x, double y) {
    return 127.5 + 127.5 * cos(ISO_PI * (x * x + y * y) / SIDE);
}

static void add_surfel(plate *p, size_t i, double x, double y) {
    p->surfels[i] = (iso_surfel){{(float)x, (float)(y * p->cosine), (float)(DISTANCE + y * p->sine)},
                                 {0, (float)p->sine, (float)-p->cosine}};
    memset(p->colors[i], (int)(brightness(x, y) + 0.5), 3);
}

/* Surfels 1 mm apart. */
static plate *make_plate(double tilt) {
    plate *p = calloc(1, sizeof *p);
    assert_non_null(p);
    p->surfels = calloc(SIDE * SIDE, sizeof *p->surfels);
    p->colors = calloc(SIDE * SIDE, sizeof *p->colors);
    assert_true(p->surfels && p->colors);
    p->cosine = cos(tilt);
    p->sine = sin(tilt);
    size_t count = 0, span = 0;
    for (int top = 0; top < SIDE; top += TILE)
        for (int left = 0; left < SIDE; left += TILE) {
            p->spans[span++] = (iso_point_span){.count = TILE * TILE, .first = count};
            for (int i = 0; i < TILE * TILE; i++)
                add_surfel(p, count++, left + i % TILE + 0.5 - SIDE / 2.0, top + i / TILE + 0.5 - SIDE / 2.0);
        }
    p->points = (iso_point_view){.surfels = p->surfels,
                                 .colors = (const uint8_t(*)[3])p->colors,
                                 .spans = p->spans,
                                 .span_count = span,
                                 .transform = iso_transform_identity(),
                                 .radius = sqrt(0.5)};
    return p;
}

static void free_plate(plate *p) {
    free(p->surfels);
    free(p->colors);
    free(p);
}

/* Returns the mean brightness of a pixel, of 64 rays; below 0 when some miss the plate. */
static double pixel_brightness(const plate *p, const iso_view *view, int column, int row) {
    double sum = 0;
    for (int i = 0; i < 64; i++) {
        const double u = (column + (i % 8 + 0.5) / 8 - view->cx) / view->focal,
                     v = (row + (i / 8 + 0.5) / 8 - view->cy) / view->focal;
        const double z = view->orthographic ? 1 : DISTANCE / (1 - v * p->sine / p->cosine), x = u * z,
                     y = v * z / p->cosine;
        if (!(fabs(x) < SIDE / 2.0 - 2 && fabs(y) < SIDE / 2.0 - 2)) return -1;
        sum += brightness(x, y);
    }
    return sum / 64;
}

/* How far pictures are from the truth, and how much that changes when the picture moves by a quarter of a
 * pixel: root mean squares, of 255. */
typedef struct errors {
    double all, flicker;
} errors;

static iso_view view_of_step(const plate *p, double pixels, bool orthographic, int step) {
    iso_view view = test_plain_view(PICTURE, PICTURE, orthographic, pixels * (orthographic ? 1 : DISTANCE));
    view.cx = PICTURE / 2.0 - 200 * pixels + 0.25 * step;
    view.cy = PICTURE / 2.0 - 120 * pixels * p->cosine + 0.175 * step;
    return view;
}

static errors measure(const plate *p, double pixels, bool orthographic, iso_reconstruction reconstruction) {
    static double error[STEPS][PICTURE * PICTURE];
    errors e = {0, 0};
    size_t count = 0, pairs = 0;
    for (int step = 0; step < STEPS; step++) {
        const iso_view view = view_of_step(p, pixels, orthographic, step);
        iso_gbuffer g =
            test_drawn(&view, &p->points, &(iso_point_surface_opts){.reconstruction = reconstruction}, NULL);
        for (int i = 0; i < PICTURE * PICTURE; i++) {
            const double truth = pixel_brightness(p, &view, i % PICTURE, i / PICTURE);
            error[step][i] = NAN;
            if (truth < 0) continue;
            assert_true(g.surface[i] != ISO_SURFACE_NONE); /* no holes */
            error[step][i] = (double)(g.color[i] & 255) - truth;
            e.all += error[step][i] * error[step][i];
            count++;
            if (!step || isnan(error[step - 1][i])) continue;
            const double change = error[step][i] - error[step - 1][i];
            e.flicker += change * change;
            pairs++;
        }
        iso_gbuffer_free(&g);
    }
    assert_true(count > STEPS * PICTURE * PICTURE / 16);
    return (errors){sqrt(e.all / (double)count), sqrt(e.flicker / (double)pairs)};
}

/* Surfels of a quarter of a pixel to one, seen from the front or tilted. */
static void zone_plates_are_filtered(void **state) {
    (void)state;
    static const double tilts[] = {0, 60, 80}, pixels[] = {0.25, 0.5, 1};
    double gain = 0;
    int cases = 0;
    for (int t = 0; t < 3; t++) {
        plate *p = make_plate(tilts[t] * ISO_PI / 180);
        for (int z = 0; z < 3; z++) {
            if (t < 2 && z == 2) continue; /* discs a pixel apart: little to filter */
            const bool orthographic = (t + z) % 2;
            const errors plain = measure(p, pixels[z], orthographic, ISO_RECONSTRUCTION_ONEPASS),
                         filtered = measure(p, pixels[z], orthographic, ISO_RECONSTRUCTION_FLAT);
            const double decibel = 20 * log10(plain.all / filtered.all),
                         change = filtered.flicker / plain.flicker;
            printf("tilt %.0f, %.2f pixels: %.1f dB, %.1f better; flicker %.2f\n", tilts[t], pixels[z],
                   20 * log10(255 / filtered.all), decibel, change);
            assert_true(decibel > 8 && change < 1.0 / 3);
            gain += decibel;
            cases++;
        }
        free_plate(p);
    }
    assert_true(gain / cases > 13);
}

/* The mean of a pixel's points is nearer than filtered discs where all pixels have many points, on the whole.
 */
static void means_of_many_points(void **state) {
    (void)state;
    static const double tilts[] = {0, 60, 80};
    double gain = 0;
    for (int t = 0; t < 3; t++) {
        plate *p = make_plate(tilts[t] * ISO_PI / 180);
        const errors filtered = measure(p, 0.25, t % 2, ISO_RECONSTRUCTION_FLAT),
                     mean = measure(p, 0.25, t % 2, ISO_RECONSTRUCTION_MEAN);
        printf("tilt %.0f: %.1f dB, of discs %.1f; flicker %.2f of theirs\n", tilts[t],
               20 * log10(255 / mean.all), 20 * log10(255 / filtered.all), mean.flicker / filtered.flicker);
        gain += 20 * log10(filtered.all / mean.all) / 3;
        free_plate(p);
    }
    assert_true(gain > 1);
}

/* ---- silhouettes, and the same bytes everywhere */

static const iso_reconstruction ways[] = {ISO_RECONSTRUCTION_FLAT, ISO_RECONSTRUCTION_ONEPASS,
                                          ISO_RECONSTRUCTION_EWA, ISO_RECONSTRUCTION_MEAN};

static size_t count_samples(const iso_gbuffer *g) {
    size_t count = 0;
    for (size_t i = 0; i < (size_t)g->width * (size_t)g->height; i++)
        count += g->surface[i] != ISO_SURFACE_NONE;
    return count;
}

/* The filter covers the pixels that discs cover without it; EWA's covers more. */
static void silhouettes_do_not_grow(void **state) {
    (void)state;
    static const char *const names[] = {"sphere", "gyroid", "head"};
    static const double zooms[] = {0.15, 0.6, 2};
    for (int n = 0; n < 9; n++) {
        test_scene s = test_scene_make(names[n % 3], 48, &(iso_points_opts){0}, true);
        const iso_view view = test_look_at(&s, n, zooms[n / 3], n % 2, 120, 110);
        iso_gbuffer g[3];
        for (int k = 0; k < 3; k++)
            g[k] = test_drawn(&view, &s.points, &(iso_point_surface_opts){.reconstruction = ways[k]}, NULL);
        assert_true(count_samples(&g[0]) > 20);
        assert_memory_equal(g[0].surface, g[1].surface, (size_t)view.width * (size_t)view.height);
        assert_true(count_samples(&g[2]) > count_samples(&g[0]));
        for (int k = 0; k < 3; k++) iso_gbuffer_free(&g[k]);
        test_scene_free(&s);
    }
}

static void same_bytes_everywhere(void **state) {
    (void)state;
    static const double zooms[] = {0.3, 1, 3, 12};
    for (int n = 0; n < 12; n++) {
        test_scene s =
            test_scene_make(n % 2 ? "gyroid" : "head", 40, &(iso_points_opts){.curvature = true}, true);
        const size_t count = iso_point_view_count(&s.points);
        uint8_t(*colors)[3] = calloc(count, sizeof *colors);
        assert_non_null(colors);
        for (size_t i = 0; i < count; i++)
            for (size_t k = 0; k < 3; k++) colors[i][k] = (uint8_t)(i * (k + 3) / 5);
        if (n % 4 > 1) s.points.colors = (const uint8_t(*)[3])colors;
        if (n / 2 % 2) s.points.closed = false;
        const iso_view view = test_look_at(&s, n, zooms[n / 3], n % 3 == 1, 131, 143);
        const iso_point_surface_opts opts = {.reconstruction = ways[n % 4]};
        iso_gbuffer whole = test_drawn(&view, &s.points, &opts, NULL);
        assert_true(count_samples(&whole) > 100);
        test_every_variant(&view, &s.points, &opts, &whole);
        test_every_strip(&view, &s.points, &opts, &whole);
        iso_gbuffer_free(&whole);
        free(colors);
        test_scene_free(&s);
    }
}

/* A noisy sphere whose discs of many radii lie in front of each other: drawn in another order, in two passes,
 * the same pixels show the same but for rounding. */
static void order_does_not_matter(void **state) {
    (void)state;
    enum { COUNT = 6000, SPAN = 500 };
    static iso_surfel surfels[2][COUNT];
    static float radii[2][COUNT];
    static iso_point_span spans[COUNT / SPAN];
    uint32_t seed = 5;
    for (int i = 0; i < COUNT; i++) {
        iso_surfel *s = &surfels[0][i];
        double n[3], square = 0;
        for (int k = 0; k < 3; k++) {
            n[k] = 2 * uniform(&seed) - 1;
            square += n[k] * n[k];
        }
        const double scale = 1 / sqrt(fmax(square, 0.01)), away = 10 + uniform(&seed);
        for (int k = 0; k < 3; k++) {
            s->position[k] = (float)(n[k] * scale * away + 20);
            s->normal[k] = (float)(n[k] * scale + 0.5 * uniform(&seed));
        }
        radii[0][i] = (float)(0.1 + 0.8 * uniform(&seed) * uniform(&seed));
    }
    for (int i = 0; i < COUNT; i++) {
        surfels[1][i] = surfels[0][COUNT - 1 - i];
        radii[1][i] = radii[0][COUNT - 1 - i];
    }
    for (size_t i = 0; i < COUNT / SPAN; i++) spans[i] = (iso_point_span){.count = SPAN, .first = i * SPAN};
    /* small discs are added to pixels, large ones to tiles; then centres; then discs of one radius */
    for (int n = 0; n < 12; n++) {
        const bool centres = n / 4 == 1, one_radius = n / 4 == 2;
        const iso_reconstruction way = centres ? ISO_RECONSTRUCTION_MEAN : ISO_RECONSTRUCTION_FLAT;
        iso_gbuffer g[2];
        iso_view view;
        for (int k = 0; k < 2; k++) {
            const iso_point_view points = {.surfels = surfels[k],
                                           .radii = one_radius ? NULL : radii[k],
                                           .radius = 0.5,
                                           .overlapping = true,
                                           .spans = spans,
                                           .span_count = COUNT / SPAN,
                                           .transform = iso_transform_identity(),
                                           .dims = {41, 41, 41},
                                           .closed = n % 4 == 3};
            const test_scene s = {.points = points};
            view = test_look_at(&s, n, n % 2 ? 6 : 1, n % 4 == 2, 130, 110);
            g[k] = test_drawn(&view, &points, &(iso_point_surface_opts){.reconstruction = way}, NULL);
            const iso_point_surface_opts all = {.reconstruction = way, .selection = ISO_SELECTION_ALL};
            iso_gbuffer hidden = test_drawn(&view, &points, &all, NULL);
            test_same_rows(&g[k], 0, &hidden);
            iso_gbuffer_free(&hidden);
        }
        const size_t count = (size_t)view.width * (size_t)view.height;
        assert_true(count_samples(&g[0]) > (centres ? 40 : 1000));
        assert_memory_equal(g[0].surface, g[1].surface, count);
        for (size_t i = 0; i < count; i++) {
            if (g[0].surface[i] == ISO_SURFACE_NONE) continue;
            assert_true(fabsf(g[0].depth[i] - g[1].depth[i]) < 1e-3f);
            for (int k = 0; k < 3; k++) assert_true(fabsf(g[0].normal[k][i] - g[1].normal[k][i]) < 2e-3f);
        }
        for (int k = 0; k < 2; k++) iso_gbuffer_free(&g[k]);
    }
}

/* Discs of more than 5 pixels look the same without the filter. */
static void large_discs_are_not_filtered(void **state) {
    (void)state;
    test_scene s = test_scene_make("sphere", 40, &(iso_points_opts){0}, true);
    for (int n = 0; n < 3; n++) {
        const iso_view view = test_look_at(&s, n, 5 + 4 * n, false, 150, 140);
        iso_gbuffer a = test_drawn(&view, &s.points,
                                   &(iso_point_surface_opts){.reconstruction = ISO_RECONSTRUCTION_CURVED},
                                   NULL),
                    b = test_drawn(&view, &s.points,
                                   &(iso_point_surface_opts){.reconstruction = ISO_RECONSTRUCTION_FLAT},
                                   NULL);
        test_same_rows(&a, 0, &b);
        iso_gbuffer_free(&a);
        iso_gbuffer_free(&b);
    }
    test_scene_free(&s);
}

/* Ever larger discs of one radius leave no pixel empty: from some radius on they are added to tiles instead
 * of to pixels, and from another on they are not filtered. */
static void discs_of_every_size_are_drawn(void **state) {
    (void)state;
    enum { SIZE = 48, FIRST_SPAN = SIDE / TILE / 2 * (SIDE / TILE) + SIDE / TILE / 2 - 1 };
    plate *p = make_plate(0);
    float *radii = malloc(SIDE * SIDE * sizeof *radii);
    assert_non_null(radii);
    for (int i = 0; i < SIDE * SIDE; i++) radii[i] = (float)p->points.radius;
    p->points.spans += FIRST_SPAN; /* 2 x 1 tiles below the picture's centre */
    p->points.span_count = 2;
    for (int n = 0; n < 800; n++) {
        const bool orthographic = n % 4 > 1;
        const double pixels = 5 + n * 0.0035;
        iso_view view = test_plain_view(SIZE, SIZE, orthographic, pixels * (orthographic ? 1 : DISTANCE));
        view.cy = SIZE / 2.0 - TILE / 2.0 * pixels;
        p->points.radii = n % 2 ? radii : NULL;
        iso_gbuffer g = test_drawn(
            &view, &p->points, &(iso_point_surface_opts){.reconstruction = ISO_RECONSTRUCTION_FLAT}, NULL);
        assert_int_equal(count_samples(&g), SIZE * SIZE);
        iso_gbuffer_free(&g);
    }
    free(radii);
    free_plate(p);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(zone_plates_are_filtered),      cmocka_unit_test(means_of_many_points),
        cmocka_unit_test(order_does_not_matter),         cmocka_unit_test(silhouettes_do_not_grow),
        cmocka_unit_test(same_bytes_everywhere),         cmocka_unit_test(large_discs_are_not_filtered),
        cmocka_unit_test(discs_of_every_size_are_drawn),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
