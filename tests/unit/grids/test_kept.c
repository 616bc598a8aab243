/* kept: pictures of what is kept equal those of the whole, for every isovalue of the range. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/memory.h"
#include "exact_support.h"
#include "extract_support.h"
#include "grids/kept.h"
#include "view_support.h"

static iso_grid kept_of(const iso_grid *grid, double low, double high, size_t *kept, iso_pool *pool) {
    iso_grid made = test_rgrid(grid->rgrid->dims, grid->rgrid->type);
    made.rgrid->transform = grid->rgrid->transform;
    made.rgrid->scale = grid->rgrid->scale;
    made.rgrid->offset = grid->rgrid->offset;
    made.rgrid->level_set = grid->rgrid->level_set;
    assert_int_equal(iso_kept_copy(grid->rgrid, low, high, made.rgrid->data, kept, pool, NULL), ISO_OK);
    return made;
}

/* Volumes of every type, scaled or not, level sets, with NaN and infinities; ranges wide, narrow and of one
 * isovalue; isovalues within and at both ends, which noise of whole numbers hits. */
static void pictures_stay_the_same(void **state) {
    (void)state;
    static const iso_type types[] = {ISO_UINT8, ISO_INT16, ISO_UINT16, ISO_FLOAT32};
    test_random random = {7};
    size_t covered = 0, replaced = 0;
    for (int round = 0; round < 240; round++) {
        int dims[3];
        test_random_dims(&random, 2, 37, dims);
        iso_grid grid = test_rgrid(dims, types[round % 4]);
        test_set_transform(&grid, round / 4 % TEST_TRANSFORMS);
        test_fill(&grid, (test_pattern)(round / 12 % 3), &random);
        grid.rgrid->level_set = round % 5 == 0;
        if (grid.rgrid->type == ISO_FLOAT32 && round % 3) test_scatter_nonfinite(&grid, &random);
        if (round % 7 == 0) {
            grid.rgrid->scale = 0.37;
            grid.rgrid->offset = -11.3;
        }
        double ends[2];
        for (int i = 0; i < 2; i++) {
            const double stored =
                round % 2 ? test_random_int(&random, 90, 110) : test_random_real(&random, 60, 140);
            ends[i] = stored * grid.rgrid->scale + grid.rgrid->offset;
        }
        const double low = fmin(ends[0], ends[1]), high = round % 6 ? fmax(ends[0], ends[1]) : low;
        size_t kept;
        iso_grid small = kept_of(&grid, low, high, &kept, NULL);
        for (int i = 0; i < 4; i++) {
            const double isovalue = i == 0 ? low : i == 1 ? high : test_random_real(&random, low, high);
            const iso_view view =
                test_view_make(&grid, (test_view)(i % TEST_VIEWS), 56, test_random_direction(&random));
            iso_gbuffer whole = picture_of(&grid, isovalue, &view, NULL),
                        part = picture_of(&small, isovalue, &view, NULL);
            test_same_pictures(&whole, &part);
            covered += test_covered(&whole);
            iso_gbuffer_free(&whole);
            iso_gbuffer_free(&part);
        }
        replaced += (size_t)dims[0] * (size_t)dims[1] * (size_t)dims[2] - kept;
        iso_grid_destroy(&grid);
        iso_grid_destroy(&small);
    }
    print_message("    %zu samples show a surface, %zu voxels were replaced\n", covered, replaced);
    assert_true(covered > 200000 && replaced > 100000);
}

/* Of a smooth surface little is kept, all else is one of two values, and threads change nothing. */
static void little_is_kept(void **state) {
    (void)state;
    const int n = 64;
    iso_grid grid = test_ball_grid(n, (iso_vec3){31.2, 30.7, 32.1}, 20, 1);
    iso_pool *pool;
    size_t kept, also, others = 0, count = (size_t)n * (size_t)n * (size_t)n;
    assert_int_equal(iso_pool_create(3, &pool, NULL), ISO_OK);
    iso_grid small = kept_of(&grid, -0.2, 0.2, &kept, NULL), same = kept_of(&grid, -0.2, 0.2, &also, pool);
    const float *voxels = small.rgrid->data, *before = grid.rgrid->data;
    count = (size_t)grid.rgrid->dims[0] * (size_t)grid.rgrid->dims[1] * (size_t)grid.rgrid->dims[2];
    for (size_t i = 0; i < count; i++) {
        const double was = before[i], is = voxels[i];
        assert_true((was < -0.2) == (is < -0.2) && (was >= 0.2) == (is >= 0.2));
        others += voxels[i] != before[i];
    }
    assert_memory_equal(voxels, same.rgrid->data, count * sizeof *voxels);
    assert_int_equal(kept, also);
    print_message("    %zu of %zu voxels kept\n", kept, count);
    assert_true(kept > 15000 && kept < 45000 && others > count / 2);
    iso_grid_destroy(&grid);
    iso_grid_destroy(&small);
    iso_grid_destroy(&same);
    iso_pool_destroy(pool);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pictures_stay_the_same),
        cmocka_unit_test(little_is_kept),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
