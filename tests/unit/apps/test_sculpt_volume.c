/* isosculpt's volumes while the user drags their isovalue: the levels it slides through, and the surface
 * that a thread makes meanwhile. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "apps/isosculpt/viewport/viewport.h"
#include "grids/rgrid.h"
#include "refused_memory.h"
#include "sculpt_support.h"

enum { WIDTH = 160, HEIGHT = 100 };
static const double SLOW = 1, FAST = 0;

static void put(iso_rgrid *grid, int x, int y, int z, double value) {
    const ptrdiff_t at = x + y * grid->stride_y + z * grid->stride_z;
    switch (grid->type) {
    case ISO_UINT8:
        ((uint8_t *)grid->data)[at] = (uint8_t)value;
        break;
    case ISO_INT16:
        ((int16_t *)grid->data)[at] = (int16_t)(value - 100);
        break;
    case ISO_UINT16:
        ((uint16_t *)grid->data)[at] = (uint16_t)(value * 3);
        break;
    default:
        ((float *)grid->data)[at] = (float)value;
    }
}

static iso_rgrid *make_grid(iso_type type, const int dims[3], const iso_transform *transform) {
    iso_rgrid *grid;
    const iso_rgrid_desc desc = {.dims = {dims[0], dims[1], dims[2]}, .type = type, .transform = transform};
    assert_int_equal(iso_rgrid_create(&desc, &grid, NULL), ISO_OK);
    return grid;
}

/* A ball with noise on it. */
static iso_rgrid *make_volume(iso_type type, const int dims[3]) {
    iso_transform transform = iso_transform_identity();
    const double spacing[3] = {0.5, 0.75, 1.25};
    for (int axis = 0; axis < 3; axis++) {
        transform.spacing[axis] = spacing[axis];
        transform.origin[axis] = 7 - axis;
    }
    iso_rgrid *grid = make_grid(type, dims, &transform);
    uint32_t seed = 5;
    for (int z = 0; z < dims[2]; z++)
        for (int y = 0; y < dims[1]; y++)
            for (int x = 0; x < dims[0]; x++) {
                const double u = x - 0.5 * dims[0], v = y - 0.5 * dims[1], w = z - 0.5 * dims[2];
                put(grid, x, y, z, fmax(240 - 8 * sqrt(u * u + v * v + w * w) + 9 * uniform(&seed), 0));
            }
    return grid;
}

/* ---- levels */

/* Every step-th voxel. */
static iso_rgrid *thin_out(const iso_rgrid *from, int step) {
    int dims[3];
    iso_transform transform = from->transform;
    for (int axis = 0; axis < 3; axis++) {
        dims[axis] = (from->dims[axis] - 1) / step + 1;
        transform.spacing[axis] *= step;
    }
    iso_rgrid *to = make_grid(from->type, dims, &transform);
    const size_t bytes = iso_type_size(from->type);
    for (int z = 0; z < dims[2]; z++)
        for (int y = 0; y < dims[1]; y++)
            for (int x = 0; x < dims[0]; x++)
                memcpy((char *)to->data + (size_t)(x + y * to->stride_y + z * to->stride_z) * bytes,
                       (const char *)from->data +
                           (size_t)(step * (x + y * from->stride_y + z * from->stride_z)) * bytes,
                       bytes);
    return to;
}

static void check_level(const isosculpt_lod *levels, const iso_rgrid *volume, double isovalue) {
    iso_rgrid *thin = thin_out(volume, 1 << isosculpt_lod_level(levels));
    const iso_grid grid = {.rgrid = thin};
    const iso_points_opts opts = {.isovalue = isovalue};
    iso_point_set *wanted;
    assert_int_equal(iso_point_set_create(&grid, &opts, &wanted, NULL), ISO_OK);
    assert_int_equal(iso_point_set_update(wanted, NULL), ISO_OK);
    const iso_point_view a = iso_point_set_view(isosculpt_lod_points(levels)), b = iso_point_set_view(wanted);
    assert_true(iso_point_view_count(&b) > 100);
    assert_int_equal(iso_point_view_count(&a), iso_point_view_count(&b));
    assert_int_equal(a.span_count, b.span_count);
    for (size_t s = 0; s < a.span_count; s++) {
        assert_memory_equal(a.spans[s].brick, b.spans[s].brick, sizeof a.spans[s].brick);
        assert_memory_equal(a.packed + a.spans[s].first, b.packed + b.spans[s].first,
                            b.spans[s].count * sizeof *b.packed);
    }
    assert_memory_equal(&a.transform, &b.transform, sizeof a.transform);
    iso_point_set_destroy(wanted);
    iso_rgrid_destroy(thin);
}

static void levels_are_every_second_voxel(void **state) {
    (void)state;
    static const int dims[][3] = {{70, 65, 60}, {33, 48, 95}};
    static const double isovalues[][2] = {{120, 150}, {20, 50}, {360, 450}, {120, 150}};
    iso_pool *pool;
    assert_int_equal(iso_pool_create(2, &pool, NULL), ISO_OK);
    for (int kind = 0; kind < 8; kind++) {
        const iso_type type = (iso_type)(kind % 4);
        iso_rgrid *volume = make_volume(type, dims[kind / 4]);
        isosculpt_lod *levels;
        assert_int_equal(isosculpt_lod_create(volume, isovalues[type][0], pool, &levels, NULL), ISO_OK);
        assert_int_equal(isosculpt_lod_level(levels), 0); /* it is small */
        for (int level = 0; level < ISOSCULPT_LOD_LEVELS; level++) {
            assert_int_equal(isosculpt_lod_level(levels), level);
            assert_int_equal(isosculpt_lod_update(levels, isovalues[type][level % 2], NULL), ISO_OK);
            check_level(levels, volume, isovalues[type][level % 2]);
            isosculpt_lod_record_times(levels, SLOW, FAST);
        }
        isosculpt_lod_destroy(levels);
        iso_rgrid_destroy(volume);
    }
    iso_pool_destroy(pool);
}

static void levels_go_by_time(void **state) {
    (void)state;
    static const int dims[3] = {40, 40, 40}, flat[3] = {40, 40, 3}, large[3] = {256, 256, 80};
    iso_rgrid *volume = make_volume(ISO_UINT8, dims), *slab = make_volume(ISO_UINT8, flat),
              *block = make_volume(ISO_UINT8, large);
    isosculpt_lod *levels;
    assert_int_equal(isosculpt_lod_create(volume, 120, NULL, &levels, NULL), ISO_OK);
    isosculpt_lod_record_times(levels, FAST, FAST);
    assert_int_equal(isosculpt_lod_level(levels), 0);
    for (int i = 0; i < 5; i++) isosculpt_lod_record_times(levels, FAST, SLOW);
    assert_int_equal(isosculpt_lod_level(levels), ISOSCULPT_LOD_LEVELS - 1);
    isosculpt_lod_record_times(levels, 0.004, 0.004); /* fast enough, and the finer one would not be */
    assert_int_equal(isosculpt_lod_level(levels), ISOSCULPT_LOD_LEVELS - 1);
    isosculpt_lod_record_times(levels, 0.001, 0.004);
    assert_int_equal(isosculpt_lod_level(levels), ISOSCULPT_LOD_LEVELS - 2);
    for (int i = 0; i < ISOSCULPT_LOD_LEVELS; i++) isosculpt_lod_record_times(levels, FAST, 0.004);
    assert_int_equal(isosculpt_lod_level(levels), 0);
    isosculpt_lod_destroy(levels);
    assert_int_equal(isosculpt_lod_create(slab, 120, NULL, &levels, NULL), ISO_OK);
    isosculpt_lod_record_times(levels, SLOW, SLOW);
    assert_int_equal(isosculpt_lod_level(levels), 0); /* it has no coarser one */
    isosculpt_lod_destroy(levels);
    assert_int_equal(isosculpt_lod_create(block, 120, NULL, &levels, NULL), ISO_OK);
    assert_int_equal(isosculpt_lod_level(levels), 1); /* 5 million voxels would be slow */
    isosculpt_lod_destroy(levels);
    iso_rgrid_destroy(volume);
    iso_rgrid_destroy(slab);
    iso_rgrid_destroy(block);
}

/* ---- the surface that is made meanwhile */

static void draw(isosculpt_viewport *view, bool moving) {
    iso_error error = {0};
    if (isosculpt_viewport_draw(view, WIDTH, HEIGHT, moving, &error) != ISO_OK) fail_msg("%s", error.text);
}

static void refine(isosculpt_viewport *view) {
    while (view->quality != ISOSCULPT_QUALITY_FINE)
        assert_int_equal(isosculpt_viewport_refine(view, NULL), ISO_OK);
}

static void open_view(isosculpt_viewport *view, iso_rgrid *volume, double isovalue, iso_pool *pool) {
    const iso_grid grid = {.rgrid = volume};
    assert_int_equal(isosculpt_viewport_init_grid(view, &grid, isovalue, pool, NULL), ISO_OK);
}

static void wait_for(isosculpt_viewport *view) {
    while (isosculpt_viewport_is_preparing(view)) usleep(1000);
}

/* What is drawn of a surface that a thread has made is what is drawn of one that is made at once. */
static void check_rest(isosculpt_viewport *view, iso_rgrid *volume, iso_pool *pool) {
    isosculpt_viewport other;
    open_view(&other, volume, 100, pool);
    isosculpt_viewport_set_isovalue(&other, view->isovalue);
    other.camera = view->camera;
    other.mode = view->mode;
    draw(&other, false);
    draw(view, false);
    assert_int_equal(view->quality, ISOSCULPT_QUALITY_REST);
    assert_memory_equal(view->image.rgba, other.image.rgba, 4 * WIDTH * HEIGHT);
    refine(view);
    refine(&other);
    assert_memory_equal(view->image.rgba, other.image.rgba, 4 * WIDTH * HEIGHT);
    assert_int_equal(isosculpt_viewport_point_count(view), isosculpt_viewport_point_count(&other));
    isosculpt_viewport_free(&other);
}

static void surfaces_are_made_while_the_isovalue_is_dragged(void **state) {
    (void)state;
    static const int dims[3] = {70, 65, 60};
    iso_pool *pool;
    isosculpt_viewport view;
    assert_int_equal(iso_pool_create(2, &pool, NULL), ISO_OK);
    iso_rgrid *volume = make_volume(ISO_INT16, dims);
    open_view(&view, volume, 20, pool);
    for (int method = 0; method < ISOSCULPT_METHODS; method++)
        for (int step = 0; step < 4; step++) {
            view.mode.method = isosculpt_methods[method];
            view.sliding = true;
            isosculpt_viewport_set_isovalue(&view, 10 + 7 * step + method);
            draw(&view, true);
            assert_int_equal(view.quality, ISOSCULPT_QUALITY_MOVING);
            assert_false(isosculpt_viewport_is_ready(&view));
            assert_int_equal(isosculpt_viewport_prepare(&view, NULL, NULL), ISO_OK);
            for (int i = 0; i < step; i++) { /* the isovalue is dragged on and back */
                isosculpt_viewport_set_isovalue(&view, 30 + i);
                draw(&view, true);
                isosculpt_viewport_orbit(&view, 3, 1);
            }
            isosculpt_viewport_set_isovalue(&view, 10 + 7 * step + method);
            draw(&view, true);
            view.sliding = false;
            wait_for(&view);
            assert_true(isosculpt_viewport_is_ready(&view));
            check_rest(&view, volume, pool);
        }
    isosculpt_viewport_set_isovalue(&view, 33);
    assert_int_equal(isosculpt_viewport_prepare(&view, NULL, NULL), ISO_OK);
    isosculpt_viewport_free(&view); /* waits */
    iso_rgrid_destroy(volume);
    iso_pool_destroy(pool);
}

/* When a surface is ready for an isovalue that is not the current one any more, the next one is made. */
static void what_was_made_for_nothing_is_made_anew(void **state) {
    (void)state;
    static const int dims[3] = {50, 50, 50};
    isosculpt_viewport view;
    iso_rgrid *volume = make_volume(ISO_UINT8, dims);
    open_view(&view, volume, 100, NULL);
    isosculpt_viewport_set_isovalue(&view, 110);
    assert_int_equal(isosculpt_viewport_prepare(&view, NULL, NULL), ISO_OK);
    isosculpt_viewport_set_isovalue(&view, 150);
    wait_for(&view);
    assert_false(isosculpt_viewport_is_ready(&view));
    draw(&view, true);
    assert_int_equal(view.quality, ISOSCULPT_QUALITY_MOVING);
    assert_int_equal(isosculpt_viewport_prepare(&view, NULL, NULL), ISO_OK);
    wait_for(&view);
    assert_true(isosculpt_viewport_is_ready(&view));
    check_rest(&view, volume, NULL);
    isosculpt_viewport_set_isovalue(&view, 90); /* no surface is made in the background */
    check_rest(&view, volume, NULL);
    isosculpt_viewport_free(&view);
    iso_rgrid_destroy(volume);
}

/* Asked for again, a picture that moves waits for no surface either. */
static void pictures_that_move_do_not_wait(void **state) {
    (void)state;
    static const int dims[3] = {50, 50, 50};
    isosculpt_viewport view;
    iso_rgrid *volume = make_volume(ISO_UINT8, dims);
    open_view(&view, volume, 100, NULL);
    isosculpt_viewport_set_isovalue(&view, 110);
    for (int i = 0; i < 2; i++) {
        draw(&view, true);
        assert_int_equal(view.quality, ISOSCULPT_QUALITY_MOVING);
        assert_false(isosculpt_viewport_is_ready(&view));
    }
    check_rest(&view, volume, NULL);
    isosculpt_viewport_free(&view);
    iso_rgrid_destroy(volume);
}

/* A thread that runs out of memory leaves the surface to the next drawing, and is not started again and
 * again.
 */
static void a_surface_that_could_not_be_made_is_made_when_it_is_drawn(void **state) {
    (void)state;
    static const int dims[3] = {50, 50, 50};
    isosculpt_viewport view;
    iso_rgrid *volume = make_volume(ISO_UINT8, dims);
    int failed = 0, refused = 0;
    open_view(&view, volume, 100, NULL);
    draw(&view, false);
    for (long calls = 0;; calls++) {
        iso_error error = {0};
        isosculpt_viewport_set_isovalue(&view, 101 + 0.25 * (double)calls);
        test_refuse_memory_after(calls);
        const iso_status status = isosculpt_viewport_prepare(&view, NULL, &error);
        wait_for(&view);
        const long refusals = test_refusals();
        test_grant_memory();
        refused += status != ISO_OK;
        if (status == ISO_OK) assert_true(isosculpt_viewport_is_ready(&view));
        failed += status == ISO_OK && refusals > 0;
        check_rest(&view, volume, NULL);
        if (!refusals) break;
    }
    assert_true(refused > 0 && failed > 5);
    isosculpt_viewport_free(&view);
    iso_rgrid_destroy(volume);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(levels_are_every_second_voxel),
        cmocka_unit_test(levels_go_by_time),
        cmocka_unit_test(surfaces_are_made_while_the_isovalue_is_dragged),
        cmocka_unit_test(what_was_made_for_nothing_is_made_anew),
        cmocka_unit_test(pictures_that_move_do_not_wait),
        cmocka_unit_test(a_surface_that_could_not_be_made_is_made_when_it_is_drawn),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
