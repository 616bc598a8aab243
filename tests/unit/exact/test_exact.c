/* exact: its pictures against the ray caster's, and against themselves. */
#include <float.h>
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
#include "exact_support.h"
#include "extract_support.h"
#include "view_support.h"

/* ---- volumes and views */

static iso_view make_view(const iso_grid *grid, test_view kind, int size, test_random *random) {
    return test_view_make(grid, kind, size, test_random_direction(random));
}

/* ---- exact against the truth */

/* `most` of what goes wrong, as parts of all hits. */
static void check_verdict(const test_verdict *v, const char *name, double most) {
    print_message("    %s: %zu hits of %zu samples, %zu missing, %zu extra, %zu deep, %zu tinted\n", name,
                  v->hits, v->samples, v->missing, v->extra, v->deep, v->tinted);
    assert_true(v->hits > v->samples / 20);
    const size_t limit = (size_t)(most * (double)v->hits);
    assert_true(v->missing <= limit && v->extra <= limit && v->deep <= limit && v->tinted <= limit);
}

static const iso_type types[] = {ISO_UINT8, ISO_INT16, ISO_UINT16, ISO_FLOAT32};

/* Every voxel on its own: cells have several sheets, rays several roots. */
static void random_grids_equal_raycast(void **state) {
    (void)state;
    static const char *const names[] = {"noise", "levels", "smooth"};
    test_random random = {1};
    for (int pattern = TEST_NOISE; pattern <= TEST_SMOOTH; pattern++) {
        test_verdict verdict = {0};
        for (int round = 0; round < 4 * TEST_TRANSFORMS * TEST_VIEWS; round++) {
            int dims[3];
            test_random_dims(&random, 3, 21, dims);
            iso_grid grid = test_rgrid(dims, types[round % 4]);
            test_set_transform(&grid, round / 4 % TEST_TRANSFORMS);
            grid.rgrid->level_set = round % 3 == 0;
            test_fill(&grid, pattern, &random);
            iso_view view = make_view(&grid, round / 4 / TEST_TRANSFORMS, 72, &random);
            judge(&grid, pattern == TEST_SMOOTH ? 100.3 : 100, &view, &verdict);
            iso_grid_destroy(&grid);
        }
        check_verdict(&verdict, names[pattern], 1e-4);
    }
}

/* A cell with a NaN or infinite corner is empty, and gradients go around such voxels. */
static void cells_that_are_not_finite_are_empty(void **state) {
    (void)state;
    test_random random = {2};
    test_verdict verdict = {0};
    for (int round = 0; round < TEST_TRANSFORMS * TEST_VIEWS; round++) {
        iso_grid grid = test_rgrid((const int[3]){20, 9, 18}, ISO_FLOAT32);
        test_set_transform(&grid, round % TEST_TRANSFORMS);
        test_fill(&grid, TEST_NOISE, &random);
        test_scatter_nonfinite(&grid, &random);
        iso_view view = make_view(&grid, round / TEST_TRANSFORMS, 72, &random);
        judge(&grid, 140, &view, &verdict);
        iso_grid_destroy(&grid);
    }
    check_verdict(&verdict, "with NaN and infinities", 1e-4);
}

/* Values near the ends of what floats hold: differences overflow, products vanish. */
static void any_magnitude_of_values(void **state) {
    (void)state;
    static const double scales[] = {1e36, 1e20, 1e-12, 1e-30, 1e-36};
    test_random random = {3};
    for (size_t i = 0; i < sizeof scales / sizeof *scales; i++) {
        test_verdict verdict = {0};
        iso_grid grid = test_rgrid((const int[3]){12, 11, 13}, ISO_FLOAT32);
        test_fill(&grid, TEST_NOISE, &random);
        float *values = grid.rgrid->data;
        for (int k = 0; k < 12 * 11 * 13; k++) values[k] = (float)((values[k] - 125) * 2.6 * scales[i]);
        iso_view view = make_view(&grid, TEST_PERSPECTIVE, 100, &random);
        judge(&grid, -3 * scales[i], &view, &verdict);
        char name[32];
        snprintf(name, sizeof name, "values up to %g", 325 * scales[i]);
        check_verdict(&verdict, name, 5e-4);
        iso_grid_destroy(&grid);
    }
}

static void hgrids_equal_raycast(void **state) {
    (void)state;
    test_random random = {4};
    test_verdict verdict = {0};
    for (int round = 0; round < TEST_TRANSFORMS * TEST_VIEWS; round++) {
        iso_grid grid = test_random_balls(50, 12, &random);
        test_set_transform(&grid, round % TEST_TRANSFORMS);
        iso_view view = make_view(&grid, round / TEST_TRANSFORMS, 100, &random);
        judge(&grid, round % 2 ? 0 : 0.37, &view, &verdict);
        iso_grid_destroy(&grid);
    }
    check_verdict(&verdict, "balls", 1e-4);
}

/* Rays that run along index axes, between the planes of voxels and in them: directions have zeros. (No steps
 * of 1 / 2^n with isovalues of few digits: rays would meet the isovalue exactly where they pass from cell to
 * cell, everywhere in the picture, which is a state in double and rounding in floats.) */
static void rays_along_axes(void **state) {
    (void)state;
    test_random random = {5};
    test_verdict between = {0}, along = {0};
    for (int round = 0; round < 24; round++) {
        iso_grid grid = test_rgrid((const int[3]){18, 18, 18}, types[round % 4]);
        test_fill(&grid, round % 2 ? TEST_NOISE : TEST_SMOOTH, &random);
        iso_view view = test_axis_view(round % 3, round / 3 % 2, 0.2431, 0.0713, 70);
        judge(&grid, 100.5, &view, &between);
        view = test_axis_view(round % 3, round / 3 % 2, 1.0 / 3, 0, 52);
        judge(&grid, 100.5, &view, &along);
        iso_grid_destroy(&grid);
    }
    check_verdict(&between, "between planes", 1e-4);
    check_verdict(&along, "in planes", 1e-3);
}

/* No cells, no picture; and a plane of voxels is no volume. */
/* The field rises to a ridge in the plane between two cells and falls again; rays a few millionths of a voxel
 * apart meet the ridge from just below the isovalue to just above. */
static void nothing_is_hit_just_below_a_ridge(void **state) {
    (void)state;
    const double step = 1e-6, rounding = 1e-6;
    const int size = 16;
    for (int axis = 0; axis < 3; axis++)
        for (int up = 0; up < 2; up++) {
            const int rising = (axis + 1) % 3, level = (axis + 2) % 3;
            int dims[3], at[3];
            dims[axis] = 3;
            dims[rising] = dims[level] = 2;
            iso_grid grid = test_rgrid(dims, ISO_UINT8);
            uint8_t *voxel = grid.rgrid->data;
            for (at[2] = 0; at[2] < dims[2]; at[2]++)
                for (at[1] = 0; at[1] < dims[1]; at[1]++)
                    for (at[0] = 0; at[0] < dims[0]; at[0]++)
                        *voxel++ = at[axis] != 1 ? 20 : at[rising] ? 50 : 30;
            const iso_view view = test_axis_view(axis, up, step, 0.5 - 8.25 * step, size);
            iso_gbuffer exact = picture_of(&grid, 40, &view, NULL), truth = truth_of(&grid, 40, &view);
            for (int i = 0; i < size * size; i++) {
                const double beyond = (i % size - 8.25) * step; /* of where the ridge is at the isovalue */
                assert_int_equal(truth.surface[i] != ISO_SURFACE_NONE, beyond >= 0);
                if (fabs(beyond) > rounding)
                    assert_int_equal(exact.surface[i] != ISO_SURFACE_NONE, beyond >= 0);
            }
            iso_gbuffer_free(&exact);
            iso_gbuffer_free(&truth);
            iso_grid_destroy(&grid);
        }
}

/* Cells of hundreds of pixels and more, most of them nearly linear, down to where the eye is close by. */
static void large_cells_equal_raycast(void **state) {
    (void)state;
    static const char *const names[] = {"large smooth cells", "large balls"};
    test_random random = {11};
    for (int kind = 0; kind < 2; kind++) {
        test_verdict verdict = {0};
        for (int round = 0; round < 4 * TEST_VIEWS; round++) {
            int dims[3];
            test_random_dims(&random, 14, 22, dims);
            iso_grid grid = kind ? test_random_balls(26, 3, &random) : test_rgrid(dims, types[round % 4]);
            if (!kind) test_fill(&grid, TEST_SMOOTH, &random);
            test_set_transform(&grid, round % TEST_TRANSFORMS);
            const iso_view whole = make_view(&grid, round % TEST_VIEWS, round % 5 ? 397 : 1500, &random);
            judge(&grid, kind ? 0 : 100.3, &whole, &verdict);
            iso_grid_destroy(&grid);
        }
        check_verdict(&verdict, names[kind], 2e-6);
    }
}

static void thin_grids_are_empty(void **state) {
    (void)state;
    test_random random = {6};
    static const int thin[][3] = {{1, 20, 20}, {20, 1, 20}, {20, 20, 1}, {1, 1, 1}, {17, 1, 33}};
    for (int i = 0; i < 5; i++) {
        iso_grid grid = test_rgrid(thin[i], types[i % 4]);
        test_fill(&grid, TEST_NOISE, &random);
        iso_view view = make_view(&grid, TEST_PERSPECTIVE, 16, &random);
        if (thin[i][1] == 1 && thin[i][0] == 1) view = test_axis_view(1, true, 0.25, 0, 16);
        iso_gbuffer gbuffer = picture_of(&grid, 100, &view, NULL);
        assert_int_equal(test_covered(&gbuffer), 0);
        iso_exact *exact = make_exact(&grid, 100, NULL);
        assert_int_equal(iso_exact_stats(exact).cells, 0);
        const iso_box box = iso_exact_bounds(exact, NULL);
        assert_true(iso_box_is_empty(&box));
        iso_exact_destroy(exact);
        iso_gbuffer_free(&gbuffer);
        iso_grid_destroy(&grid);
    }
    iso_grid grid = test_rgrid((const int[3]){9, 9, 9}, ISO_UINT8),
             empty = test_hgrid((const int[3]){40, 9, 9}, 3);
    iso_view view = make_view(&grid, TEST_PERSPECTIVE, 16, &random);
    iso_gbuffer dense = picture_of(&grid, 100, &view, NULL), sparse = picture_of(&empty, 0, &view, NULL);
    assert_int_equal(test_covered(&dense) + test_covered(&sparse), 0);
    iso_gbuffer_free(&dense);
    iso_gbuffer_free(&sparse);
    iso_grid_destroy(&grid);
    iso_grid_destroy(&empty);
}

/* ---- exact against itself */

static iso_grid smooth_grid(const int dims[3], iso_type type, test_random *random) {
    iso_grid grid = test_rgrid(dims, type);
    test_fill(&grid, TEST_SMOOTH, random);
    return grid;
}

/* A picture drawn in strips of random heights. */
static iso_gbuffer strips_of(const iso_exact *exact, const iso_view *view, test_random *random) {
    iso_gbuffer picture = empty_picture(view);
    for (int y = 0; y < view->height;) {
        int height = test_random_int(random, 1, 40);
        if (y + height > view->height) height = view->height - y;
        iso_view strip = iso_view_rows(view, y, height);
        const size_t first = (size_t)y * (size_t)view->width;
        iso_gbuffer part = {.width = view->width,
                            .height = height,
                            .depth = picture.depth + first,
                            .surface = picture.surface + first};
        for (int axis = 0; axis < 3; axis++) part.normal[axis] = picture.normal[axis] + first;
        draw_exact(exact, &strip, &part, NULL);
        y += height;
    }
    return picture;
}

static void strips_equal_the_whole(void **state) {
    (void)state;
    test_random random = {7};
    for (int kind = 0; kind < TEST_VIEWS; kind++) {
        iso_grid grid = smooth_grid((const int[3]){40, 37, 33}, ISO_INT16, &random);
        test_set_transform(&grid, kind % TEST_TRANSFORMS);
        iso_view view = make_view(&grid, kind, 150, &random);
        view.height = 131;
        view.cx += 0.3125;
        view.cy -= 0.28125;
        iso_gbuffer whole = picture_of(&grid, 100, &view, NULL);
        iso_exact *exact = make_exact(&grid, 100, NULL);
        iso_gbuffer parts = strips_of(exact, &view, &random);
        assert_true(test_covered(&whole) > 1000);
        test_same_pictures(&whole, &parts);
        iso_exact_destroy(exact);
        iso_gbuffer_free(&whole);
        iso_gbuffer_free(&parts);
        iso_grid_destroy(&grid);
    }
}

/* At fit, and so large that cells have many pixels; with ties and noise so that every path is taken. */
static void levels_and_threads_give_the_same_bytes(void **state) {
    (void)state;
    test_random random = {8};
    iso_pool *pool;
    iso_error error = {0};
    test_ok(iso_pool_create(3, &pool, &error), &error);
    for (int round = 0; round < 16; round++) {
        const int pattern = round % 3;
        iso_grid grid = round % 4 == 3 ? test_random_balls(60, 14, &random)
                                       : test_rgrid((const int[3]){45, 39, 50}, types[round / 4 % 4]);
        if (grid.rgrid) test_fill(&grid, pattern, &random);
        test_set_transform(&grid, round % TEST_TRANSFORMS);
        const int side = round % 5 == 4 ? 1100 : round % 2 ? 210 : 40;
        iso_view view = make_view(&grid, round / 4 % TEST_VIEWS, side, &random);
        const double isovalue = grid.rgrid ? 100 : 0;
        iso_cpu_limit(ISO_CPU_GENERIC);
        iso_gbuffer wanted = picture_of(&grid, isovalue, &view, NULL);
        for (int level = 0; level <= (int)iso_cpu_supported(); level++)
            for (int threads = 0; threads < 2; threads++) {
                iso_cpu_limit(level);
                iso_gbuffer got = picture_of(&grid, isovalue, &view, threads ? pool : NULL);
                test_same_pictures(&got, &wanted);
                iso_gbuffer_free(&got);
            }
        assert_true(test_covered(&wanted) > 200);
        iso_gbuffer_free(&wanted);
        iso_grid_destroy(&grid);
    }
    iso_cpu_limit(ISO_CPU_AVX512);
    iso_pool_destroy(pool);
}

/* Every voxel is at the isovalue or one of a few steps from it, and the eye looks straight along an axis:
 * rays lie in faces, cells with tied faces share vectors with others, and which ones do depends on the width
 * of vectors and on the rows that are drawn together. */
static void ties_do_not_depend_on_vectors_or_bands(void **state) {
    (void)state;
    test_random random = {9};
    iso_pool *pool;
    iso_error error = {0};
    test_ok(iso_pool_create(3, &pool, &error), &error);
    for (int round = 0; round < 200; round++) {
        int dims[3];
        test_random_dims(&random, 10, 24, dims);
        iso_grid grid = test_rgrid(dims, ISO_UINT8);
        const int steps = test_random_int(&random, 1, 5);
        for (int z = 0; z < dims[2]; z++)
            for (int y = 0; y < dims[1]; y++)
                for (int x = 0; x < dims[0]; x++)
                    test_set(&grid, x, y, z, 100 + test_random_int(&random, -steps, steps));
        const iso_vec3 middle = {dims[0] / 2.0, dims[0] / 2.0, dims[0] / 2.0};
        const double back = (round / 2 % 2 ? 2.2 : -2.2) * dims[0];
        const iso_camera camera = {
            .focal_point = middle,
            .position = iso_vec3_add(middle, iso_vec3_make(round % 2 ? back : 0, round % 2 ? 0 : back, 0)),
            .view_up = {0, 0, 1},
            .view_angle = test_random_int(&random, 20, 50)};
        const int side = test_random_int(&random, 40, 140);
        const iso_view view = iso_view_make(&camera, side, side);
        iso_exact *exact = make_exact(&grid, 100, NULL);
        iso_cpu_limit(ISO_CPU_GENERIC);
        iso_gbuffer wanted = picture_of(&grid, 100, &view, NULL);
        for (int level = 0; level <= (int)iso_cpu_supported(); level++) {
            iso_cpu_limit(level);
            iso_gbuffer got = picture_of(&grid, 100, &view, pool), parts = strips_of(exact, &view, &random);
            test_same_pictures(&got, &wanted);
            test_same_pictures(&parts, &wanted);
            iso_gbuffer_free(&got);
            iso_gbuffer_free(&parts);
        }
        iso_gbuffer_free(&wanted);
        iso_exact_destroy(exact);
        iso_grid_destroy(&grid);
    }
    iso_cpu_limit(ISO_CPU_AVX512);
    iso_pool_destroy(pool);
}

/* A picture without a gbuffer, of every path, level and number of threads; factor: samples along a pixel's
 * side, of which the view has whole pixels. */
static void same_when_painted(const iso_grid *grid, double isovalue, const iso_view *view, int factor,
                              const iso_shading *shading, iso_pool *pool) {
    iso_image wanted, got;
    iso_error error = {0};
    size_t covered = 0;
    const int width = view->width / factor, height = view->height / factor;
    test_ok(iso_image_create(width, height, &wanted, &error), &error);
    test_ok(iso_image_create(width, height, &got, &error), &error);
    iso_gbuffer gbuffer = empty_picture(view);
    iso_exact *exact = make_exact(grid, isovalue, NULL);
    const iso_target target = {.view = view, .gbuffer = &gbuffer};
    test_ok(iso_draw_exact(&target, exact, &error), &error);
    const iso_strip strip = {.view = view, .gbuffer = &gbuffer, .factor = factor};
    iso_shade(shading, &strip, &wanted, NULL);
    const size_t bytes = (size_t)width * (size_t)height * 4;
    for (int level = 0; level <= (int)iso_cpu_supported(); level++)
        for (int threads = 0; threads < 2; threads++) {
            iso_cpu_limit(level);
            memset(got.rgba, 0x5a, bytes);
            const iso_exact_picture canvas = {view, shading, &got, threads ? pool : NULL, NULL, factor};
            test_ok(iso_paint_exact(&canvas, exact, &covered, &error), &error);
            assert_memory_equal(got.rgba, wanted.rgba, bytes);
            assert_int_equal(covered, test_covered(&gbuffer));
        }
    iso_cpu_limit(ISO_CPU_AVX512);
    iso_exact_destroy(exact);
    iso_gbuffer_free(&gbuffer);
    iso_image_free(&wanted);
    iso_image_free(&got);
}

static void painted_pictures_are_shaded_gbuffers(void **state) {
    (void)state;
    test_random random = {12};
    iso_pool *pool;
    iso_error error = {0};
    const iso_rgb colors[] = {{200, 120, 40}, {1, 2, 3}};
    test_ok(iso_pool_create(3, &pool, &error), &error);
    for (int round = 0; round < 4 * TEST_VIEWS; round++) {
        iso_grid grid = round % 4 == 3 ? test_random_balls(60, 14, &random)
                                       : test_rgrid((const int[3]){23, 19, 26}, types[round / 4 % 4]);
        if (grid.rgrid) test_fill(&grid, round % 3, &random);
        test_set_transform(&grid, round % TEST_TRANSFORMS);
        iso_view view = make_view(&grid, round % TEST_VIEWS, round % 2 ? 417 : 40, &random);
        view.width += round % 5;
        const iso_shading shading = {colors, 2, {9, 8, 7}, round % 2, {0, 0, 0}};
        const double isovalue = grid.rgrid ? 100 : 0;
        same_when_painted(&grid, isovalue, &view, 1, &shading, pool);
        same_when_painted(&grid, 1e9, &view, 1, &shading, pool); /* nothing is there */
        const int factor = 2 + round % (ISO_FACTOR_MAX - 1);
        iso_view samples = iso_view_scaled(&view, factor);
        same_when_painted(&grid, isovalue, &samples, factor, &shading, pool);
        iso_grid_destroy(&grid);
    }
    iso_pool_destroy(pool);
}

/* Large cells fill whole words of the picture's rows; 8 rows of a narrow and of a wide picture. */
static void any_size_of_picture(void **state) {
    (void)state;
    test_random random = {9};
    static const int sizes[][2] = {{1, 1},  {1, 90},    {63, 2},   {64, 64},
                                   {65, 3}, {16384, 8}, {7, 3000}, {700, 650}};
    iso_grid grid = smooth_grid((const int[3]){10, 9, 8}, ISO_FLOAT32, &random);
    test_verdict verdict = {0};
    for (int i = 0; i < 8; i++) {
        iso_view view = make_view(&grid, i % TEST_VIEWS, 512, &random);
        const double factor = fmin(sizes[i][0], sizes[i][1]) > 500 ? 3 : 1;
        view.focal *= factor;
        view.width = sizes[i][0];
        view.height = sizes[i][1];
        view.cx = 0.5 * view.width;
        view.cy = 0.5 * view.height;
        judge(&grid, 100, &view, &verdict);
    }
    check_verdict(&verdict, "sizes", 1e-4);
    iso_grid_destroy(&grid);
}

static void same_as_new(const iso_grid *grid, const iso_exact *exact, const iso_view *view) {
    iso_exact *fresh = make_exact(grid, 100, NULL);
    iso_gbuffer got = empty_picture(view), wanted = empty_picture(view);
    draw_exact(exact, view, &got, NULL);
    draw_exact(fresh, view, &wanted, NULL);
    test_same_pictures(&got, &wanted);
    assert_int_equal(iso_exact_stats(exact).cells, iso_exact_stats(fresh).cells);
    const iso_box a = iso_exact_bounds(exact, NULL), b = iso_exact_bounds(fresh, NULL);
    assert_memory_equal(&a, &b, sizeof a);
    iso_exact_destroy(fresh);
    iso_gbuffer_free(&got);
    iso_gbuffer_free(&wanted);
}

static void updates_equal_rebuilding(void **state) {
    (void)state;
    test_random random = {10};
    iso_error error = {0};
    iso_pool *pool;
    test_ok(iso_pool_create(3, &pool, &error), &error);
    for (int kind = 0; kind < 4; kind++) {
        iso_grid grid = kind == 3 ? test_random_balls(60, 6, &random)
                                  : smooth_grid((const int[3]){70, 50, 40}, types[kind + 1], &random);
        const double isovalue = kind == 3 ? 0 : 100;
        iso_exact *exact = make_exact(&grid, isovalue, kind % 2 ? pool : NULL);
        iso_view view = make_view(&grid, kind % 2, 90, &random);
        size_t partial = 0;
        for (int round = 0; round < 12; round++) {
            for (int edits = test_random_int(&random, 1, 3); edits; edits--) test_random_edit(&grid, &random);
            test_ok(iso_exact_update(exact, &error), &error);
            partial += iso_exact_stats(exact).bricks < 20;
            if (isovalue == 100) {
                same_as_new(&grid, exact, &view);
            } else {
                iso_gbuffer got = empty_picture(&view), wanted = picture_of(&grid, 0, &view, NULL);
                draw_exact(exact, &view, &got, NULL);
                test_same_pictures(&got, &wanted);
                iso_gbuffer_free(&got);
                iso_gbuffer_free(&wanted);
            }
        }
        assert_true(partial > 6); /* not everything, every time */
        iso_exact_set_isovalue(exact, isovalue + 0.5);
        test_ok(iso_exact_update(exact, &error), &error);
        iso_gbuffer got = empty_picture(&view), wanted = picture_of(&grid, isovalue + 0.5, &view, NULL);
        draw_exact(exact, &view, &got, NULL);
        test_same_pictures(&got, &wanted);
        iso_gbuffer_free(&got);
        iso_gbuffer_free(&wanted);
        iso_exact_destroy(exact);
        iso_grid_destroy(&grid);
    }
    iso_pool_destroy(pool);
}

/* Over what is there, in any order: the nearest of several surfaces stays, and so does what lies in front. */
static void surfaces_are_drawn_over_each_other(void **state) {
    (void)state;
    test_random random = {11};
    iso_error error = {0};
    iso_grid grid = smooth_grid((const int[3]){40, 40, 40}, ISO_UINT8, &random);
    iso_view view = make_view(&grid, TEST_PERSPECTIVE, 120, &random);
    const double isovalues[] = {140, 100, 60};
    iso_gbuffer exact_picture = empty_picture(&view), truth = empty_picture(&view),
                back = empty_picture(&view);
    for (int i = 0; i < 3; i++) {
        iso_exact *exact = make_exact(&grid, isovalues[i], NULL),
                  *last = make_exact(&grid, isovalues[2 - i], NULL);
        iso_raycaster *caster;
        test_ok(iso_raycaster_create(&grid, isovalues[i], NULL, &caster, &error), &error);
        iso_target target = {&view, &exact_picture, NULL, (uint8_t)i, NULL};
        test_ok(iso_draw_exact(&target, exact, &error), &error);
        target.gbuffer = &truth;
        test_ok(iso_draw_raycast(&target, caster, &error), &error);
        target.gbuffer = &back;
        target.surface = (uint8_t)(2 - i);
        test_ok(iso_draw_exact(&target, last, &error), &error);
        iso_raycaster_destroy(caster);
        iso_exact_destroy(exact);
        iso_exact_destroy(last);
    }
    test_same_pictures(&exact_picture, &back);
    size_t wrong = 0, seen[3] = {0};
    for (int i = 0; i < view.width * view.height; i++) {
        wrong += exact_picture.surface[i] != truth.surface[i];
        if (truth.surface[i] < 3) seen[truth.surface[i]]++;
    }
    assert_true(seen[0] > 50 && seen[1] > 50 && seen[2] > 50);
    assert_int_equal(wrong, 0);
    iso_gbuffer_free(&exact_picture);
    iso_gbuffer_free(&truth);
    iso_gbuffer_free(&back);
    iso_grid_destroy(&grid);
}

/* ---- what is kept */

static size_t crossed_cells(const iso_grid *grid, float isovalue) {
    const int *dims = iso_grid_dims(grid);
    size_t count = 0;
    for (int z = 0; z + 1 < dims[2]; z++)
        for (int y = 0; y + 1 < dims[1]; y++)
            for (int x = 0; x + 1 < dims[0]; x++) {
                int inside = 0, finite = 0;
                for (int i = 0; i < 8; i++) {
                    float value = iso_grid_at(grid, x + (i & 1), y + (i >> 1 & 1), z + (i >> 2));
                    inside += value >= isovalue;
                    finite += isfinite(value) != 0;
                }
                count += finite == 8 && inside > 0 && inside < 8;
            }
    return count;
}

static void exactly_the_crossed_cells_are_kept(void **state) {
    (void)state;
    test_random random = {12};
    for (int round = 0; round < 40; round++) {
        int dims[3];
        test_random_dims(&random, 2, 40, dims);
        iso_grid grid =
            round % 5 == 4 ? test_random_balls(40, 9, &random) : test_rgrid(dims, types[round % 4]);
        if (grid.rgrid) test_fill(&grid, round % 3, &random);
        if (grid.rgrid && grid.rgrid->type == ISO_FLOAT32)
            for (int i = 0; i < 5; i++)
                ((float *)grid.rgrid->data)[test_random_int(&random, 0, dims[0] * dims[1] * dims[2] - 1)] =
                    NAN;
        const double isovalue = grid.hgrid ? 0 : round % 2 ? 100 : 99.5;
        iso_exact *exact = make_exact(&grid, isovalue, NULL);
        assert_int_equal(iso_exact_stats(exact).cells, crossed_cells(&grid, (float)isovalue));
        iso_exact_destroy(exact);
        iso_grid_destroy(&grid);
    }
}

static void same_box(const iso_box *a, const iso_box *b) {
    const double x[6] = {a->lo.x, a->lo.y, a->lo.z, a->hi.x, a->hi.y, a->hi.z};
    const double y[6] = {b->lo.x, b->lo.y, b->lo.z, b->hi.x, b->hi.y, b->hi.z};
    for (int i = 0; i < 6; i++)
        if (!(fabs(x[i] - y[i]) < 1e-5)) fail_msg("bound %d: %.9g, not %.9g", i, x[i], y[i]);
}

/* The box of edge points, in index coordinates and in world ones. */
static void bounds_are_those_of_points(void **state) {
    (void)state;
    test_random random = {13};
    iso_error error = {0};
    for (int round = 0; round < 24; round++) {
        int dims[3];
        test_random_dims(&random, 2, 50, dims);
        iso_grid grid =
            round % 6 == 5 ? test_random_balls(40, 3, &random) : test_rgrid(dims, types[round % 4]);
        if (grid.rgrid) test_fill(&grid, round % 3, &random);
        test_set_transform(&grid, round % TEST_TRANSFORMS);
        const double isovalue = grid.rgrid ? 100 : 0;
        const iso_points_opts opts = {.isovalue = isovalue, .primitive = ISO_PRIMITIVE_EDGE, .floats = true};
        iso_point_set *points;
        test_ok(iso_point_set_create(&grid, &opts, &points, &error), &error);
        test_ok(iso_point_set_update(points, &error), &error);
        const iso_point_view view = iso_point_set_view(points);
        const iso_affine affine = iso_transform_affine(iso_grid_transform(&grid));
        iso_exact *exact = make_exact(&grid, isovalue, NULL);
        iso_box wanted = iso_point_view_bounds(&view), got = iso_exact_bounds(exact, NULL);
        same_box(&got, &wanted);
        wanted = iso_box_empty();
        for (size_t s = 0; s < view.span_count; s++)
            for (uint32_t i = 0; i < view.spans[s].count; i++) {
                const iso_surfel surfel = iso_point_view_get(&view, view.spans[s].first + i);
                const int32_t *brick = view.spans[s].brick;
                iso_box_add(&wanted,
                            iso_affine_point(&affine, iso_vec3_make(16.0 * brick[0] + surfel.position[0],
                                                                    16.0 * brick[1] + surfel.position[1],
                                                                    16.0 * brick[2] + surfel.position[2])));
            }
        got = iso_exact_bounds(exact, &affine);
        same_box(&got, &wanted);
        iso_exact_destroy(exact);
        iso_point_set_destroy(points);
        iso_grid_destroy(&grid);
    }
}

static void isovalues_must_be_finite(void **state) {
    (void)state;
    iso_grid grid = test_rgrid((const int[3]){4, 4, 4}, ISO_UINT8);
    iso_exact *exact = NULL;
    iso_exact_opts opts = {.isovalue = NAN};
    assert_int_equal(iso_exact_create(&grid, &opts, &exact, NULL), ISO_ERR_USAGE);
    assert_null(exact);
    opts.isovalue = 1;
    assert_int_equal(iso_exact_create(&grid, &opts, &exact, NULL), ISO_OK);
    iso_exact_set_isovalue(exact, INFINITY);
    assert_int_equal(iso_exact_update(exact, NULL), ISO_ERR_USAGE);
    iso_exact_destroy(exact);
    iso_exact_destroy(NULL);
    iso_grid_destroy(&grid);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(random_grids_equal_raycast),
        cmocka_unit_test(cells_that_are_not_finite_are_empty),
        cmocka_unit_test(any_magnitude_of_values),
        cmocka_unit_test(hgrids_equal_raycast),
        cmocka_unit_test(rays_along_axes),
        cmocka_unit_test(nothing_is_hit_just_below_a_ridge),
        cmocka_unit_test(large_cells_equal_raycast),
        cmocka_unit_test(thin_grids_are_empty),
        cmocka_unit_test(strips_equal_the_whole),
        cmocka_unit_test(levels_and_threads_give_the_same_bytes),
        cmocka_unit_test(ties_do_not_depend_on_vectors_or_bands),
        cmocka_unit_test(painted_pictures_are_shaded_gbuffers),
        cmocka_unit_test(any_size_of_picture),
        cmocka_unit_test(updates_equal_rebuilding),
        cmocka_unit_test(surfaces_are_drawn_over_each_other),
        cmocka_unit_test(exactly_the_crossed_cells_are_kept),
        cmocka_unit_test(bounds_are_those_of_points),
        cmocka_unit_test(isovalues_must_be_finite),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
