/* exact out of memory: every refusal is an error, what can still be drawn is sound, and the next try makes up
 * for it. Calls for memory are refused from a chosen one on (the linker's --wrap). */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "exact_support.h"
#include "extract_support.h"
#include "refused_memory.h"

static iso_view front_view(const iso_grid *grid) {
    const int *dims = iso_grid_dims(grid);
    const iso_box box = {{0, 0, 0}, {dims[0] - 1, dims[1] - 1, dims[2] - 1}};
    iso_camera camera = {.position = {-1, -2, 0.7}, .view_up = {0, 0, 1}, .view_angle = 30};
    iso_camera_fit(&camera, &box, 1, 1);
    return iso_view_make(&camera, 64, 64);
}

static void same_depths(const iso_grid *grid, const iso_exact *exact) {
    const iso_view view = front_view(grid);
    iso_gbuffer got = empty_picture(&view), wanted = picture_of(grid, 100, &view, NULL);
    draw_exact(exact, &view, &got, NULL);
    assert_memory_equal(got.depth, wanted.depth, sizeof(float) * 64 * 64);
    iso_gbuffer_free(&got);
    iso_gbuffer_free(&wanted);
}

static iso_grid noisy_grid(test_random *random) {
    iso_grid grid = test_rgrid((const int[3]){70, 50, 40}, ISO_UINT8);
    test_fill(&grid, TEST_SMOOTH, random);
    return grid;
}

/* It draws what it has, and all of the grid after the next update. */
static void still_serves(const iso_grid *grid, iso_exact *exact) {
    const iso_view view = front_view(grid);
    iso_gbuffer gbuffer = empty_picture(&view);
    draw_exact(exact, &view, &gbuffer, NULL);
    iso_gbuffer_free(&gbuffer);
    assert_int_equal(iso_exact_update(exact, NULL), ISO_OK);
    same_depths(grid, exact);
}

/* Creating and filling, refused at the first call for memory, then at the second, and so on in growing steps.
 */
static void first_updates_fail_cleanly(void **state) {
    (void)state;
    test_random random = {1};
    bool failed = true;
    for (long call = 0; failed; call += 1 + call / 16) {
        iso_grid grid = noisy_grid(&random);
        const iso_exact_opts opts = {.isovalue = 100};
        iso_exact *exact = NULL;
        test_refuse_memory_after(call);
        iso_status status = iso_exact_create(&grid, &opts, &exact, NULL);
        if (status == ISO_OK) status = iso_exact_update(exact, NULL);
        test_grant_memory();
        failed = status != ISO_OK;
        assert_true(status == ISO_OK || status == ISO_ERR_NOMEM);
        if (exact) still_serves(&grid, exact);
        iso_exact_destroy(exact);
        iso_grid_destroy(&grid);
        assert_true(call < 5000);
    }
}

static void later_updates_make_up(void **state) {
    (void)state;
    test_random random = {2};
    iso_grid grid = noisy_grid(&random);
    iso_exact *exact = make_exact(&grid, 100, NULL);
    for (long call = 0; call < 12; call++) {
        test_random_edit(&grid, &random);
        test_refuse_memory_after(call);
        const iso_status status = iso_exact_update(exact, NULL);
        test_grant_memory();
        assert_true(status == ISO_OK || status == ISO_ERR_NOMEM);
        still_serves(&grid, exact);
    }
    iso_exact_destroy(exact);
    iso_grid_destroy(&grid);
}

static void drawing_fails_cleanly(void **state) {
    (void)state;
    test_random random = {3};
    iso_grid grid = noisy_grid(&random);
    iso_exact *exact = make_exact(&grid, 100, NULL);
    const iso_view view = front_view(&grid);
    iso_gbuffer gbuffer = empty_picture(&view);
    const iso_target target = {&view, &gbuffer, NULL, 0, NULL};
    bool failed = true;
    for (long call = 0; failed; call++) {
        test_refuse_memory_after(call);
        const iso_status status = iso_draw_exact(&target, exact, NULL);
        test_grant_memory();
        failed = status != ISO_OK;
        assert_true(status == ISO_OK || status == ISO_ERR_NOMEM);
        for (int i = 0; i < 64 * 64 && failed; i++) assert_true(gbuffer.depth[i] == (float)INFINITY);
        assert_true(call < 20);
    }
    iso_gbuffer_free(&gbuffer);
    iso_exact_destroy(exact);
    iso_grid_destroy(&grid);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(first_updates_fail_cleanly),
        cmocka_unit_test(later_updates_make_up),
        cmocka_unit_test(drawing_fails_cleanly),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
