/* Pictures of volumes that are visited chunk by chunk, whatever the size of the chunks and the number of
 * parts, have the bytes of pictures of the whole: exact, and pull-push by the box and Gaussian
 * reconstructions. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/cpu.h"
#include "check_support.h"
#include "extract_support.h"
#include "image/camera.h"
#include "scene/bounds.h"
#include "scene/keys_picture.h"
#include "scene/method.h"
#include "scene/point_chunks.h"

enum { WIDTH = 150, HEIGHT = 110 };

static const iso_rgb colors[] = {{0xD9, 0xB3, 0x6C}};
static const int sides[] = {32, 64, 128, 200, 16};
static const int part_counts[] = {1, 2, 3, 5, 8};

/* Smooth waves, which end at the volume's border, or a ball, which is closed. */
static iso_grid make_volume(iso_type type, bool closed, int transform, test_random *random) {
    iso_grid grid = test_rgrid((const int[3]){91, 75, 83}, type);
    if (closed) {
        for (int z = 0; z < 83; z++)
            for (int y = 0; y < 75; y++)
                for (int x = 0; x < 91; x++) {
                    const double d =
                        sqrt((x - 44) * (x - 44) + (y - 38) * (y - 38) * 1.3 + (z - 40) * (z - 40));
                    test_set(&grid, x, y, z, fmax(0, 220 - 5 * d));
                }
    } else {
        test_fill(&grid, TEST_SMOOTH, random);
    }
    iso_transform t = iso_transform_identity();
    if (transform) {
        t.spacing[0] = 0.7;
        t.spacing[2] = 1.3;
        t.origin[1] = -20;
    }
    grid.rgrid->transform = t;
    return grid;
}

static iso_camera camera_of(const iso_grid *grid, int kind, test_random *random) {
    const iso_affine affine = iso_transform_affine(iso_grid_transform(grid));
    const iso_vec3 middle = iso_affine_point(&affine, iso_vec3_make(45, 37, 41));
    iso_camera camera = {
        .focal_point = middle, .view_up = {0.1, 0.2, 1}, .view_angle = 40, .parallel_scale = 45};
    camera.position =
        iso_vec3_add(middle, iso_vec3_scale(test_random_direction(random), kind == 2 ? 20 : 160));
    camera.orthographic = kind == 1;
    if (kind == 2) camera.view_angle = 90; /* from inside */
    return camera;
}

static iso_picture_opts opts_of(const iso_camera *camera, iso_pool *pool) {
    return (iso_picture_opts){.camera = camera,
                              .width = WIDTH,
                              .height = HEIGHT,
                              .samples = 1,
                              .shading = {colors, 1, {9, 8, 7}, 0, {0, 0, 0}},
                              .pool = pool};
}

/* ---- the whole */

typedef struct whole_draw {
    iso_scene_surface surface;
    const iso_renderer *renderer;
} whole_draw;

static iso_status draw_whole(void *context, const iso_view *view, iso_gbuffer *gbuffer, iso_error *error) {
    const whole_draw *whole = context;
    const iso_target target = {view, gbuffer, whole->surface.pool, 0, NULL};
    return iso_renderer_draw(whole->renderer, &whole->surface, &target, error);
}

static void render_whole(const iso_grid *grid, double isovalue, iso_method method, const iso_camera *camera,
                         iso_image *image) {
    whole_draw whole = {{.grid = *grid, .isovalue = isovalue, .bounded = true}, iso_renderer_get(method)};
    iso_picture_opts opts = opts_of(camera, NULL);
    opts.draw = draw_whole;
    opts.draw_context = &whole;
    const iso_part part = method == ISO_METHOD_EXACT ? ISO_PART_CELLS : ISO_PART_POINTS;
    assert_int_equal(iso_scene_surface_prepare(&whole.surface, part, NULL), ISO_OK);
    assert_int_equal(iso_picture_render(&opts, image, NULL, NULL), ISO_OK);
    iso_scene_surface_free(&whole.surface);
}

/* ---- chunks */

static void merge(iso_key_image *image, iso_key_image *part, iso_pool *pool) {
    iso_key_image_minimum(image, part, pool);
    iso_key_image_free(part);
}

static void render_cells(iso_chunk_walk *walk, int parts, const iso_view *view, iso_key_image *keys,
                         iso_pool *pool) {
    assert_int_equal(iso_key_image_allocate(WIDTH, HEIGHT, keys, NULL), ISO_OK);
    for (int part = parts; part >= 1; part--) {
        iso_key_image own;
        assert_int_equal(iso_key_image_allocate(WIDTH, HEIGHT, &own, NULL), ISO_OK);
        const iso_exact_key_picture picture = {view, colors[0], &own, pool, NULL};
        assert_int_equal(iso_exact_chunks_draw(walk, (iso_chunk_share){part, parts}, &picture, NULL), ISO_OK);
        merge(keys, &own, pool);
    }
}

static iso_pullpush_base render_points(iso_chunk_walk *walk, int parts, const iso_view *view,
                                       iso_key_image *keys, iso_pool *pool) {
    iso_pullpush_survey survey;
    assert_int_equal(iso_point_chunks_survey(walk, (iso_chunk_share){1, 1}, view, &survey, NULL), ISO_OK);
    const iso_pullpush_base base = iso_pullpush_base_of(&survey, view);
    assert_int_equal(iso_key_image_allocate(base.width, base.height, keys, NULL), ISO_OK);
    for (int part = 1; part <= parts; part++) {
        iso_key_image own;
        assert_int_equal(iso_key_image_allocate(base.width, base.height, &own, NULL), ISO_OK);
        const iso_pullpush_keys picture = {view, base, &own, pool};
        assert_int_equal(iso_point_chunks_draw(walk, (iso_chunk_share){part, parts}, &picture, &survey, NULL),
                         ISO_OK);
        merge(keys, &own, pool);
    }
    return base;
}

static void render_chunks(iso_chunk_walk *walk, int parts, iso_method method, const iso_camera *camera,
                          iso_image *image) {
    const iso_chunk_walk_opts *walked = iso_chunk_walk_opts_of(walk);
    const iso_view view = iso_view_make(camera, WIDTH, HEIGHT);
    const iso_picture_opts opts = opts_of(camera, walked->pool);
    iso_key_image keys;
    iso_merged_keys merged = {.method = method, .transform = walked->source->transform, .image = &keys};
    size_t covered;
    for (int k = 0; k < 3; k++) merged.dims[k] = walked->source->dims[k];
    if (method == ISO_METHOD_EXACT)
        render_cells(walk, parts, &view, &keys, walked->pool);
    else
        merged.base = render_points(walk, parts, &view, &keys, walked->pool);
    assert_int_equal(iso_render_merged_keys(&merged, &opts, image, &covered, NULL), ISO_OK);
    iso_key_image_free(&keys);
}

/* The boxes and numbers of primitives of the whole, and those of its chunks. */
static void check_bounds(const iso_grid *grid, iso_chunk_walk *walk, double isovalue) {
    const iso_affine affine = iso_transform_affine(iso_grid_transform(grid));
    const iso_affine *const affines[] = {NULL, &affine};
    iso_box boxes[2], points_box;
    iso_chunk_bounds bounds = {{1, 1}, affines, 2, boxes, 0};
    iso_scene_surface surface = {.grid = *grid, .isovalue = isovalue, .bounded = true};
    assert_int_equal(iso_scene_surface_prepare(&surface, ISO_PART_CELLS, NULL), ISO_OK);
    assert_int_equal(iso_scene_surface_prepare(&surface, ISO_PART_POINTS, NULL), ISO_OK);
    assert_int_equal(iso_exact_chunks_bounds(walk, &bounds, NULL), ISO_OK);
    assert_int_equal(bounds.primitives, iso_exact_stats(surface.exact).cells);
    for (int i = 0; i < 2; i++) {
        const iso_box box = iso_exact_bounds(surface.exact, affines[i]);
        assert_memory_equal(&box, &boxes[i], sizeof box);
    }
    const iso_point_view view = iso_point_set_view(surface.points);
    assert_int_equal(iso_point_chunks_bounds(walk, &bounds, NULL), ISO_OK);
    assert_int_equal(bounds.primitives, iso_point_view_count(&view));
    points_box = iso_point_view_bounds(&view);
    assert_memory_equal(&points_box, &boxes[0], sizeof points_box);
    iso_scene_surface_free(&surface);
}

static const iso_type types[] = {ISO_UINT8, ISO_INT16, ISO_UINT16, ISO_FLOAT32};
static const iso_method methods[] = {ISO_METHOD_EXACT, ISO_METHOD_PULLPUSH_BOX, ISO_METHOD_PULLPUSH};

static void chunks_are_the_whole(void **state) {
    (void)state;
    test_random random = {21};
    iso_pool *pool = NULL;
    assert_int_equal(iso_pool_create(2, &pool, NULL), ISO_OK);
    for (int round = 0; round < 16; round++) {
        iso_grid grid = make_volume(types[round % 4], round / 4 % 2, round % 3, &random);
        const double isovalue = round / 4 % 2 ? 70.5 : 100.3;
        const iso_chunk_source source = iso_chunk_source_of(grid.rgrid);
        const iso_chunk_walk_opts opts = {.source = &source,
                                          .isovalue = isovalue,
                                          .side = sides[round % 5],
                                          .pool = round % 2 ? pool : NULL};
        iso_chunk_walk *walk = NULL;
        assert_int_equal(iso_chunk_walk_create(&opts, &walk, NULL), ISO_OK);
        if (round % 2) check_bounds(&grid, walk, isovalue);
        for (size_t i = 0; i < 3; i++) {
            const iso_camera camera = camera_of(&grid, (round + (int)i) % 3, &random);
            iso_image whole, image;
            assert_int_equal(iso_image_create(WIDTH, HEIGHT, &whole, NULL), ISO_OK);
            assert_int_equal(iso_image_create(WIDTH, HEIGHT, &image, NULL), ISO_OK);
            render_whole(&grid, isovalue, methods[i], &camera, &whole);
            const iso_cpu_level level = iso_cpu_best();
            iso_cpu_limit((iso_cpu_level)(round % ISO_CPU_LEVELS));
            render_chunks(walk, part_counts[round % 5], methods[i], &camera, &image);
            iso_cpu_limit(level);
            assert_memory_equal(whole.rgba, image.rgba, WIDTH * HEIGHT * 4);
            iso_image_free(&whole);
            iso_image_free(&image);
        }
        iso_chunk_walk_destroy(walk);
        iso_grid_destroy(&grid);
    }
    iso_pool_destroy(pool);
}

/* Shares are disjoint, and together all crossed chunks; no share is much larger than the others. */
typedef struct count_visit {
    int seen[64];
    int count;
} count_visit;

static iso_status count(void *context, const iso_chunk_visit *visit, iso_error *error) {
    (void)error;
    count_visit *counted = context;
    counted->seen[visit->number]++;
    counted->count++;
    return ISO_OK;
}

static void shares_are_fair(void **state) {
    (void)state;
    test_random random = {5};
    iso_grid grid = make_volume(ISO_UINT8, false, 0, &random);
    const iso_chunk_source source = iso_chunk_source_of(grid.rgrid);
    const iso_chunk_walk_opts opts = {.source = &source, .isovalue = 100.3, .side = 32};
    count_visit all = {0};
    iso_chunk_walk *walk = NULL;
    assert_int_equal(iso_chunk_walk_create(&opts, &walk, NULL), ISO_OK);
    assert_int_equal(iso_chunk_walk_visit(walk, (iso_chunk_share){1, 1}, count, &all, NULL), ISO_OK);
    assert_true(all.count > 20);
    for (int parts = 2; parts <= 40; parts += 3) {
        count_visit each = {0};
        for (int part = 1; part <= parts; part++) {
            const int before = each.count;
            assert_int_equal(iso_chunk_walk_visit(walk, (iso_chunk_share){part, parts}, count, &each, NULL),
                             ISO_OK);
            assert_true(each.count - before <= all.count / parts + 4);
        }
        assert_memory_equal(each.seen, all.seen, sizeof all.seen);
    }
    iso_chunk_walk_destroy(walk);
    iso_grid_destroy(&grid);
}

static int cancel(void *context, double fraction) {
    (void)context;
    return fraction > 0.3;
}

static iso_status refuse(void *context, const iso_chunk_visit *visit, iso_error *error) {
    (void)context, (void)visit;
    return iso_fail(error, ISO_ERR_IO, "as asked");
}

static void failures_end_a_visit(void **state) {
    (void)state;
    test_random random = {6};
    iso_grid grid = make_volume(ISO_UINT8, false, 0, &random);
    const iso_chunk_source source = iso_chunk_source_of(grid.rgrid);
    iso_chunk_walk_opts opts = {.source = &source, .isovalue = 100.3, .side = 32, .progress = cancel};
    count_visit some = {0};
    iso_chunk_walk *walk = NULL;
    iso_error error = {0};
    assert_int_equal(iso_chunk_walk_create(&opts, &walk, NULL), ISO_OK);
    assert_int_equal(iso_chunk_walk_visit(walk, (iso_chunk_share){1, 1}, count, &some, &error), ISO_ERR_IO);
    assert_true(some.count > 0 && some.count < 20);
    assert_int_equal(iso_chunk_walk_visit(walk, (iso_chunk_share){1, 1}, refuse, NULL, &error), ISO_ERR_IO);
    assert_string_equal(error.text, "as asked");
    iso_chunk_walk_destroy(walk);
    opts.isovalue = NAN;
    assert_int_equal(iso_chunk_walk_create(&opts, &walk, NULL), ISO_ERR_USAGE);
    iso_grid_destroy(&grid);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(chunks_are_the_whole),
        cmocka_unit_test(shares_are_fair),
        cmocka_unit_test(failures_end_a_visit),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
