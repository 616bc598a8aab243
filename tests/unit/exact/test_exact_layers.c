/* layers of the exact surface: against every crossing that rays in double precision find, and against
 * themselves. */
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
#include "exact/layers.h"
#include "exact_support.h"
#include "extract_support.h"
#include "truth/raycast_layers.h"
#include "view_support.h"

/* ---- pictures */

enum { SURFACES = 4 };

/* Translucent surfaces of one grid, and perhaps an opaque one, which has the last number. */
typedef struct test_scene {
    const iso_grid *grid;
    int count;
    double isovalue[SURFACES], opaque; /* opaque: an isovalue; NaN: none */
    iso_translucency translucency[SURFACES];
    bool transparent; /* the background */
    int factor;
} test_scene;

typedef struct test_picture {
    iso_image image;
    float *counts, *coverage;
    iso_layer_totals totals;
    size_t retraced;
} test_picture;

static const iso_rgb colors[SURFACES + 1] = {
    {0xE8, 0xB9, 0xA0}, {0x3F, 0x6F, 0xA8}, {0x5B, 0x8E, 0x4B}, {0xC7, 0x7A, 0x3A}, {0xEE, 0xE6, 0xD0}};

static test_picture make_picture(const iso_view *samples, int factor) {
    test_picture picture = {.retraced = 0};
    iso_error error = {0};
    const int width = samples->width / factor, height = samples->height / factor;
    test_ok(iso_image_create(width, height, &picture.image, &error), &error);
    picture.counts = calloc((size_t)(width * height), sizeof *picture.counts);
    picture.coverage = calloc((size_t)(width * height), sizeof *picture.coverage);
    assert_true(picture.counts && picture.coverage);
    return picture;
}

static void free_picture(test_picture *picture) {
    iso_image_free(&picture->image);
    free(picture->counts);
    free(picture->coverage);
}

/* Gives two thirds of the samples a colour of their own; a third of those are of a surface that has been
 * overdrawn and must not count. */
static void color_samples(iso_gbuffer *gbuffer) {
    iso_error error = {0};
    test_ok(iso_gbuffer_add_color(gbuffer, &error), &error);
    for (size_t i = 0; i < (size_t)gbuffer->width * (size_t)gbuffer->height; i++) {
        uint32_t bits; /* the same in every strip */
        memcpy(&bits, &gbuffer->depth[i], sizeof bits);
        const uint32_t number = bits % 3 == 0 ? 0 : bits % 9 == 1 ? SURFACES : SURFACES + 1;
        gbuffer->color[i] = (bits * 2654435761u & 0xffffff) | number << 24;
    }
}

/* The gbuffer of the opaque surface; without planes when there is none. */
static iso_gbuffer opaque_of(const test_scene *scene, const iso_view *view) {
    if (isnan(scene->opaque)) return (iso_gbuffer){.width = view->width, .height = view->height};
    iso_gbuffer gbuffer = empty_picture(view);
    iso_exact *exact = make_exact(scene->grid, scene->opaque, NULL);
    const iso_target target = {view, &gbuffer, NULL, SURFACES, NULL};
    iso_error error = {0};
    test_ok(iso_draw_exact(&target, exact, &error), &error);
    iso_exact_destroy(exact);
    if (scene->count == 2) color_samples(&gbuffer);
    return gbuffer;
}

static iso_shading shading_of(const test_scene *scene) {
    return (iso_shading){colors, SURFACES + 1, {250, 245, 240}, scene->transparent, {0, 0, 0}};
}

static void draw_layers(const test_scene *scene, const iso_strip *strip, iso_pool *pool,
                        test_picture *picture) {
    iso_exact_layer layers[SURFACES];
    const iso_shading shading = shading_of(scene);
    iso_error error = {0};
    for (int i = 0; i < scene->count; i++)
        layers[i] = (iso_exact_layer){make_exact(scene->grid, scene->isovalue[i], NULL), colors[i],
                                      scene->translucency[i], NULL, NULL};
    const iso_exact_layers input = {
        .layers = layers,
        .count = scene->count,
        .picture = {strip, &shading, &picture->image, picture->counts, picture->coverage, pool}};
    iso_exact_layers_totals totals = {.retraced = 0};
    test_ok(iso_shade_exact_layers(&input, &totals, &error), &error);
    picture->totals = totals.layers;
    picture->retraced = totals.retraced;
    for (int i = 0; i < scene->count; i++) iso_exact_destroy((iso_exact *)layers[i].exact);
}

static test_picture picture_of_layers(const test_scene *scene, const iso_view *view, iso_pool *pool) {
    test_picture picture = make_picture(view, scene->factor);
    iso_gbuffer opaque = opaque_of(scene, view);
    const iso_strip strip = {view, &opaque, scene->factor, 0};
    draw_layers(scene, &strip, pool, &picture);
    if (opaque.depth) iso_gbuffer_free(&opaque);
    return picture;
}

static test_picture truth_of_layers(const test_scene *scene, const iso_view *view) {
    iso_raycast_layer layers[SURFACES];
    test_picture picture = make_picture(view, scene->factor);
    iso_gbuffer opaque = opaque_of(scene, view);
    const iso_strip strip = {view, &opaque, scene->factor, 0};
    const iso_shading shading = shading_of(scene);
    iso_error error = {0};
    for (int i = 0; i < scene->count; i++) {
        iso_raycaster *caster;
        test_ok(iso_raycaster_create(scene->grid, scene->isovalue[i], NULL, &caster, &error), &error);
        layers[i] = (iso_raycast_layer){caster, colors[i], scene->translucency[i], NULL, NULL};
    }
    const iso_raycast_layers input = {
        layers, scene->count, {&strip, &shading, &picture.image, picture.counts, picture.coverage, NULL}};
    iso_shade_raycast_layers(&input, &picture.totals);
    for (int i = 0; i < scene->count; i++) iso_raycaster_destroy((iso_raycaster *)layers[i].caster);
    if (opaque.depth) iso_gbuffer_free(&opaque);
    return picture;
}

/* ---- against the truth */

typedef struct layers_verdict {
    size_t pixels, covered, layers, retraced;
    size_t miscounted; /* pixels with another number of layers */
    size_t tinted;     /* of the others, those whose colour differs by more than 1 / 255, or alpha by 2e-3 */
    double squares;    /* of the differences of all colours, in 1 / 255 */
} layers_verdict;

static void judge_layers(const test_scene *scene, const iso_view *view, layers_verdict *verdict) {
    test_picture picture = picture_of_layers(scene, view, NULL), truth = truth_of_layers(scene, view);
    const int pixels = picture.image.width * picture.image.height;
    for (int i = 0; i < pixels; i++) {
        int most = 0;
        for (int k = 0; k < 4; k++) {
            const int off = abs(picture.image.rgba[4 * i + k] - truth.image.rgba[4 * i + k]);
            verdict->squares += off * off;
            if (off > most) most = off;
        }
        const bool miscounted = picture.counts[i] != truth.counts[i],
                   tinted = most > 1 || fabsf(picture.coverage[i] - truth.coverage[i]) > 2e-3f;
        verdict->miscounted += miscounted;
        verdict->tinted += !miscounted && tinted;
    }
    verdict->pixels += (size_t)pixels;
    verdict->covered += truth.totals.covered;
    verdict->layers += truth.totals.layers;
    verdict->retraced += picture.retraced;
    free_picture(&picture);
    free_picture(&truth);
}

/* `most` of what goes wrong: counts as parts of all pixels with layers, colours as parts of all layers. */
static void check_layers(const layers_verdict *v, const char *name, double most) {
    print_message("    %s: %zu pixels, %zu covered, %.2f layers, %zu miscounted, %zu tinted, %zu retraced, "
                  "%.1f dB\n",
                  name, v->pixels, v->covered, (double)v->layers / (double)v->covered, v->miscounted,
                  v->tinted, v->retraced, 10 * log10(255.0 * 255 * 4 * (double)v->pixels / v->squares));
    assert_true(v->covered > v->pixels / 20 && v->layers > v->covered);
    assert_true(v->miscounted <= (size_t)(most * (double)v->covered));
    assert_true(v->tinted <= (size_t)(most * (double)v->layers));
}

static const iso_type types[] = {ISO_UINT8, ISO_INT16, ISO_UINT16, ISO_FLOAT32};

static iso_view make_view(const iso_grid *grid, test_view kind, int size, test_random *random) {
    return test_view_make(grid, kind, size, test_random_direction(random));
}

/* One surface, two that interleave, over an opaque one; by angle, constant, absorbing, the first few layers,
 * without those right before the opaque one. */
static test_scene make_scene(const iso_grid *grid, int round) {
    test_scene scene = {
        .grid = grid, .count = 1 + round % 3, .opaque = NAN, .factor = round % 5 == 4 ? 2 : 1};
    const double middle = grid->rgrid ? 100 : 0, step = grid->rgrid ? 20.3 : -0.8;
    for (int i = 0; i < scene.count; i++) {
        scene.isovalue[i] = middle + i * step;
        scene.translucency[i] = (iso_translucency){.opacity = 0.05f + 0.3f * (float)((round + i) % 4),
                                                   .constant = round / 2 % 2 == 1,
                                                   .absorption_length = round % 7 == 3 ? 30 : 0,
                                                   .most_layers = round % 6 == 5 ? 2 + i : 0,
                                                   .gap = round % 8 == 5 ? 2 : 0};
    }
    if (round % 4 == 1) scene.opaque = middle + 1.7 * step;
    scene.transparent = round % 8 >= 6;
    return scene;
}

static void random_grids_equal_raycast(void **state) {
    (void)state;
    static const char *const names[] = {"noise", "levels", "smooth"};
    test_random random = {1};
    for (int pattern = TEST_NOISE; pattern <= TEST_SMOOTH; pattern++) {
        layers_verdict verdict = {0};
        for (int round = 0; round < 4 * TEST_TRANSFORMS * TEST_VIEWS; round++) {
            int dims[3];
            test_random_dims(&random, 3, 21, dims);
            iso_grid grid = test_rgrid(dims, types[round % 4]);
            test_set_transform(&grid, round / 4 % TEST_TRANSFORMS);
            grid.rgrid->level_set = round % 3 == 0;
            test_fill(&grid, pattern, &random);
            const test_scene scene = make_scene(&grid, round);
            iso_view view = make_view(&grid, round / 4 / TEST_TRANSFORMS, 72, &random);
            judge_layers(&scene, &view, &verdict);
            iso_grid_destroy(&grid);
        }
        check_layers(&verdict, names[pattern], 1e-4);
    }
}

static void hgrids_equal_raycast(void **state) {
    (void)state;
    test_random random = {4};
    layers_verdict verdict = {0};
    for (int round = 0; round < 2 * TEST_TRANSFORMS * TEST_VIEWS; round++) {
        iso_grid grid = test_random_balls(50, 12, &random);
        test_set_transform(&grid, round % TEST_TRANSFORMS);
        const test_scene scene = make_scene(&grid, round);
        iso_view view = make_view(&grid, round / TEST_TRANSFORMS % TEST_VIEWS, 100, &random);
        judge_layers(&scene, &view, &verdict);
        iso_grid_destroy(&grid);
    }
    check_layers(&verdict, "balls", 1e-4);
}

/* Cells with a NaN or infinite corner are empty: solids end there without a crossing. */
static void cells_that_are_not_finite_are_empty(void **state) {
    (void)state;
    test_random random = {2};
    layers_verdict verdict = {0};
    for (int round = 0; round < TEST_TRANSFORMS * TEST_VIEWS; round++) {
        iso_grid grid = test_rgrid((const int[3]){20, 9, 18}, ISO_FLOAT32);
        test_set_transform(&grid, round % TEST_TRANSFORMS);
        test_fill(&grid, TEST_NOISE, &random);
        test_scatter_nonfinite(&grid, &random);
        const test_scene scene = make_scene(&grid, round);
        iso_view view = make_view(&grid, round / TEST_TRANSFORMS, 72, &random);
        judge_layers(&scene, &view, &verdict);
        iso_grid_destroy(&grid);
    }
    check_layers(&verdict, "with NaN and infinities", 1e-4);
}

/* Rays along index axes: in the planes of voxels they lie in faces of cells. */
static void rays_along_axes(void **state) {
    (void)state;
    test_random random = {5};
    layers_verdict between = {0}, along = {0};
    for (int round = 0; round < 24; round++) {
        iso_grid grid = test_rgrid((const int[3]){18, 18, 18}, types[round % 4]);
        test_fill(&grid, round % 2 ? TEST_NOISE : TEST_SMOOTH, &random);
        test_scene scene = make_scene(&grid, round);
        for (int i = 0; i < scene.count; i++) scene.isovalue[i] += 0.5;
        iso_view view = test_axis_view(round % 3, round / 3 % 2, 0.2431, 0.0713, 70);
        judge_layers(&scene, &view, &between);
        view = test_axis_view(round % 3, round / 3 % 2, 1.0 / 3, 0, 52);
        judge_layers(&scene, &view, &along);
        iso_grid_destroy(&grid);
    }
    check_layers(&between, "between planes", 1e-4);
    check_layers(&along, "in planes", 1e-3);
}

/* Cells of hundreds of pixels and more: outlines, patches and pairs of large cells. */
static void large_cells_equal_raycast(void **state) {
    (void)state;
    static const char *const names[] = {"large smooth cells", "large noisy cells", "large balls"};
    test_random random = {11};
    for (int kind = 0; kind < 3; kind++) {
        layers_verdict verdict = {0};
        for (int round = 0; round < 2 * TEST_VIEWS; round++) {
            int dims[3];
            test_random_dims(&random, kind == 1 ? 5 : 14, kind == 1 ? 9 : 22, dims);
            iso_grid grid =
                kind == 2 ? test_random_balls(26, 3, &random) : test_rgrid(dims, types[round % 4]);
            if (kind < 2) test_fill(&grid, kind ? TEST_NOISE : TEST_SMOOTH, &random);
            test_set_transform(&grid, round % TEST_TRANSFORMS);
            const test_scene scene = make_scene(&grid, round);
            const iso_view view = make_view(&grid, round % TEST_VIEWS, round % 5 ? 298 : 700, &random);
            judge_layers(&scene, &view, &verdict);
            iso_grid_destroy(&grid);
        }
        check_layers(&verdict, names[kind], 2e-5);
    }
}

/* ---- against themselves */

static void same_pictures(const test_picture *a, const test_picture *b) {
    const size_t pixels = (size_t)(a->image.width * a->image.height);
    assert_memory_equal(a->image.rgba, b->image.rgba, 4 * pixels);
    assert_memory_equal(a->counts, b->counts, pixels * sizeof *a->counts);
    assert_memory_equal(a->coverage, b->coverage, pixels * sizeof *a->coverage);
    assert_int_equal(a->totals.layers, b->totals.layers);
    assert_int_equal(a->totals.most, b->totals.most);
}

/* The thread sanitizer takes many times as long: it sees smaller pictures, and of the tests only the one
 * that has threads. */
#ifdef __SANITIZE_THREAD__
enum { THREADS_ONLY = 1, LARGE_PICTURE = 300 };
#else
enum { THREADS_ONLY = 0, LARGE_PICTURE = 1100 };
#endif

/* With ties and noise, so small and so large that every path is taken; and all layers of the shallow ones. */
static void levels_and_threads_give_the_same_bytes(void **state) {
    (void)state;
    test_random random = {8};
    iso_pool *pool;
    iso_error error = {0};
    test_ok(iso_pool_create(3, &pool, &error), &error);
    for (int round = 0; round < 16; round++) {
        iso_grid grid = round % 4 == 3 ? test_random_balls(60, 14, &random)
                                       : test_rgrid((const int[3]){45, 39, 50}, types[round / 4 % 4]);
        if (grid.rgrid) test_fill(&grid, round % 3, &random);
        test_set_transform(&grid, round % TEST_TRANSFORMS);
        const test_scene scene = make_scene(&grid, round);
        iso_view view = make_view(&grid, round / 4 % TEST_VIEWS,
                                  round % 5 == 4 ? LARGE_PICTURE
                                  : round % 2    ? 210
                                                 : 40,
                                  &random);
        iso_cpu_limit(ISO_CPU_GENERIC);
        test_picture wanted = picture_of_layers(&scene, &view, NULL);
        for (int level = 0; level <= (int)iso_cpu_supported(); level++)
            for (int threads = 0; threads < 2; threads++) {
                iso_cpu_limit(level);
                test_picture got = picture_of_layers(&scene, &view, threads ? pool : NULL);
                same_pictures(&got, &wanted);
                free_picture(&got);
            }
        assert_true(wanted.totals.covered > 200);
        free_picture(&wanted);
        iso_grid_destroy(&grid);
    }
    iso_cpu_limit(ISO_CPU_AVX512);
    iso_pool_destroy(pool);
}

/* Strips of random heights, whose bands begin at other rows. */
static void strips_equal_the_whole(void **state) {
    (void)state;
    test_random random = {7};
    for (int round = 0; round < 2 * TEST_VIEWS; round++) {
        iso_grid grid = test_rgrid((const int[3]){40, 37, 33}, ISO_INT16);
        test_fill(&grid, round % 3, &random);
        test_set_transform(&grid, round % TEST_TRANSFORMS);
        test_scene scene = make_scene(&grid, round);
        scene.factor = 1 + round % 2;
        iso_view view = make_view(&grid, round % TEST_VIEWS, 150, &random);
        test_picture whole = picture_of_layers(&scene, &view, NULL),
                     parts = make_picture(&view, scene.factor);
        const int rows = view.height / scene.factor;
        for (int y = 0, height; y < rows; y += height) {
            height = test_random_int(&random, 1, 40);
            if (y + height > rows) height = rows - y;
            const iso_view part = iso_view_rows(&view, y * scene.factor, height * scene.factor);
            iso_gbuffer opaque = opaque_of(&scene, &part);
            const iso_strip strip = {&part, &opaque, scene.factor, y};
            const size_t before = parts.totals.layers;
            draw_layers(&scene, &strip, NULL, &parts);
            parts.totals.layers += before;
            if (opaque.depth) iso_gbuffer_free(&opaque);
        }
        parts.totals.most = whole.totals.most;
        same_pictures(&whole, &parts);
        free_picture(&whole);
        free_picture(&parts);
        iso_grid_destroy(&grid);
    }
}

/* A band with more fragments than its memory holds is cut in two, and those if need be: rows of a picture so
 * wide that this happens, drawn at once and by a few rows, which have room. */
static void full_bands_are_cut(void **state) {
    (void)state;
    test_random random = {12};
    iso_grid grid = test_rgrid((const int[3]){80, 80, 80}, ISO_UINT8);
    test_fill(&grid, TEST_NOISE, &random);
    test_scene scene = {.grid = &grid, .count = 1, .isovalue = {100}, .opaque = NAN, .factor = 1};
    scene.translucency[0] = (iso_translucency){.opacity = 0.01f, .constant = true};
    const iso_view whole = make_view(&grid, TEST_PERSPECTIVE, 4096, &random),
                   rows = iso_view_rows(&whole, 2032, 32);
    test_picture at_once = picture_of_layers(&scene, &rows, NULL), parts = make_picture(&rows, 1);
    const size_t chunks = at_once.totals.layers / (ISO_LAYER_GROUP * ISO_LAYER_CHUNK);
    assert_true(chunks * sizeof(iso_layer_chunk) > ISO_EXACT_LAYERS_BYTES);
    for (int y = 0; y < 32; y += 8) {
        const iso_view part = iso_view_rows(&whole, 2032 + y, 8);
        const iso_gbuffer size = {.width = part.width, .height = part.height};
        const iso_strip strip = {&part, &size, 1, y};
        const size_t before = parts.totals.layers;
        draw_layers(&scene, &strip, NULL, &parts);
        parts.totals.layers += before;
    }
    parts.totals.most = at_once.totals.most;
    same_pictures(&at_once, &parts);
    free_picture(&at_once);
    free_picture(&parts);
    iso_grid_destroy(&grid);
}

/* A ball in the middle of a volume: two layers in every pixel, and light that falls off by the chord. */
static void a_ball_absorbs_by_its_chord(void **state) {
    (void)state;
    const int size = 128;
    const double radius = 50.3;
    const iso_vec3 centre = iso_vec3_make(63.4, 63.7, 63.2);
    iso_grid grid = test_ball_grid(size, centre, radius, 1);
    test_scene scene = {.grid = &grid, .count = 1, .opaque = NAN, .factor = 1, .transparent = true};
    scene.translucency[0] = (iso_translucency){.opacity = 0, .absorption_length = 40};
    const iso_view view = test_axis_view(2, true, 0.5, 0.1, 240);
    test_picture picture = picture_of_layers(&scene, &view, NULL);
    double worst = 0;
    for (int y = 0; y < view.height; y++)
        for (int x = 0; x < view.width; x++) {
            const double dx = 0.1 + 0.5 * x - centre.x, dy = 0.1 + 0.5 * y - centre.y,
                         square = radius * radius - dx * dx - dy * dy;
            const double chord = square > 0 ? 2 * sqrt(square) : 0;
            const int at = y * view.width + x;
            if (chord < 20) continue; /* near the silhouette a small error of the field is a long way */
            assert_int_equal((int)picture.counts[at], 2);
            const double through = 1 - (double)picture.coverage[at];
            worst = fmax(worst, fabs(-40 * log(through) - chord) / (2 * radius));
        }
    print_message("    chords differ by up to %.2g of the diameter\n", worst);
    assert_true(worst < 1e-3);
    free_picture(&picture);
    iso_grid_destroy(&grid);
}

int main(void) {
    const struct CMUnitTest threads[] = {cmocka_unit_test(levels_and_threads_give_the_same_bytes)};
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(random_grids_equal_raycast),
        cmocka_unit_test(hgrids_equal_raycast),
        cmocka_unit_test(cells_that_are_not_finite_are_empty),
        cmocka_unit_test(rays_along_axes),
        cmocka_unit_test(large_cells_equal_raycast),
        cmocka_unit_test(levels_and_threads_give_the_same_bytes),
        cmocka_unit_test(strips_equal_the_whole),
        cmocka_unit_test(full_bands_are_cut),
        cmocka_unit_test(a_ball_absorbs_by_its_chord),
    };
    return THREADS_ONLY ? cmocka_run_group_tests(threads, NULL, NULL)
                        : cmocka_run_group_tests(tests, NULL, NULL);
}
