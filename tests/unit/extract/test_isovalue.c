/* isovalue: histograms against a count that knows no threads, padding, and the thresholds of Otsu by brute
 * force. */
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
#include "extract/isovalue/isovalue.h"
#include "extract_support.h"
#include "grids/brick_index.h"

static const iso_type all_types[] = {ISO_UINT8, ISO_INT16, ISO_UINT16, ISO_FLOAT32};

static iso_histogram histogram_of(const iso_grid *grid, iso_pool *pool) {
    iso_histogram histogram;
    iso_error error = {0};
    if (iso_histogram_compute(grid, pool, &histogram, &error) != ISO_OK) fail_msg("%s", error.text);
    return histogram;
}

/* Bins, counts and range of the voxels that are not padding, one voxel at a time. */
static void check_bins(const iso_grid *grid, const iso_histogram *h) {
    const int *dims = iso_grid_dims(grid);
    double scale = grid->rgrid ? grid->rgrid->scale : 1, offset = grid->rgrid ? grid->rgrid->offset : 0;
    bool floats = grid->hgrid || grid->rgrid->type == ISO_FLOAT32;
    uint64_t bins[ISO_HISTOGRAM_BINS] = {0}, counted = 0, padding = 0, nonfinite = 0;
    double low = INFINITY, high = -INFINITY;
    for (int z = 0; z < dims[2]; z++)
        for (int y = 0; y < dims[1]; y++)
            for (int x = 0; x < dims[0]; x++) {
                double value = iso_grid_at(grid, x, y, z) * scale + offset;
                if (!isfinite(value)) {
                    nonfinite++;
                    continue;
                }
                if (h->padding && value == h->padding_value) {
                    padding++;
                    continue;
                }
                int bin = h->width > 0 ? (int)floor((value - h->low) / h->width + (floats ? 0 : 1e-6)) : 0;
                bins[bin > 255 ? 255 : bin]++;
                counted++;
                low = fmin(low, value);
                high = fmax(high, value);
            }
    assert_int_equal(h->counted, counted);
    assert_int_equal(h->padding, padding);
    assert_int_equal(h->nonfinite, nonfinite);
    near(h->low, low, 1e-9);
    near(h->high, high, 1e-9);
    for (int bin = 0; bin < ISO_HISTOGRAM_BINS; bin++) {
        if (floats) /* a value next to a bin's border may round to either side */
            near((double)h->bins[bin], (double)bins[bin], 2);
        else
            assert_int_equal(h->bins[bin], bins[bin]);
    }
}

/* The same when the grid has an index, which has counted integers and knows the range of floats. */
static void check_indexed(const iso_grid *grid, iso_pool *pool, const iso_histogram *wanted) {
    iso_grid copy = {0};
    assert_int_equal(iso_grid_copy(grid, NULL, &copy, NULL), ISO_OK);
    if (copy.rgrid) assert_int_equal(iso_brick_index_with_counts(copy.rgrid, pool, NULL), ISO_OK);
    const iso_histogram indexed = histogram_of(&copy, pool);
    assert_memory_equal(&indexed, wanted, sizeof indexed);
    iso_grid_destroy(&copy);
}

/* The same for several threads and for every instruction set, with and without an index. */
static void check_variants(const iso_grid *grid, iso_pool *pool, const iso_histogram *wanted) {
    for (int level = 0; level < ISO_CPU_LEVELS; level++) {
        iso_cpu_limit((iso_cpu_level)level);
        iso_histogram one = histogram_of(grid, NULL), many = histogram_of(grid, pool);
        assert_memory_equal(&one, wanted, sizeof one);
        assert_memory_equal(&many, wanted, sizeof many);
        check_indexed(grid, level ? pool : NULL, wanted);
    }
    iso_cpu_limit(ISO_CPU_AVX512);
}

static void histograms_count_every_voxel(void **state) {
    (void)state;
    test_random random = {1};
    iso_pool *pool = NULL;
    assert_int_equal(iso_pool_create(3, &pool, NULL), ISO_OK);
    for (int round = 0; round < 60; round++) {
        int dims[3];
        test_random_dims(&random, 1, 30, dims);
        iso_grid grid = test_rgrid(dims, all_types[round % 4]);
        test_fill(&grid, (test_pattern)(round / 4 % 3), &random);
        if (round % 4 != 0)
            for (int i = 0; i < 5; i++) /* a wide range: bins of many levels */
                test_set(&grid, 0, 0, test_random_int(&random, 0, dims[2] - 1), 30000);
        if (round % 4 == 3)
            test_set(&grid, dims[0] / 2, dims[1] / 2, dims[2] / 2, round % 8 == 3 ? NAN : INFINITY);
        if (round % 2) {
            grid.rgrid->scale = 0.25;
            grid.rgrid->offset = -1024;
        }
        if (round % 4 == 3 && dims[0] * dims[1] * dims[2] == 1) continue;
        iso_histogram one = histogram_of(&grid, NULL);
        check_variants(&grid, pool, &one);
        check_bins(&grid, &one);
        iso_grid_destroy(&grid);
    }
    iso_grid sparse = test_ball_grid(50, iso_vec3_make(20, 25, 30), 12, 0);
    iso_histogram h = histogram_of(&sparse, pool);
    check_variants(&sparse, pool, &h);
    check_bins(&sparse, &h);
    assert_true(h.padding > 50 * 50 * 6 && h.padding_value == 3);
    iso_grid_destroy(&sparse);
    iso_pool_destroy(pool);
}

static void padding_is_left_out(void **state) {
    (void)state;
    test_random random = {3};
    for (int t = 0; t < 4; t++)
        for (int high = 0; high < 2; high++) {
            iso_grid grid = test_rgrid((int[3]){20, 18, 16}, all_types[t]);
            double pad = high ? 255 : 0;
            for (int z = 0; z < 16; z++)
                for (int y = 0; y < 18; y++)
                    for (int x = 0; x < 20; x++) {
                        bool face = !x || !y || !z || x == 19 || y == 17 || z == 15;
                        bool padded = face && test_random_int(&random, 0, 9) < 7;
                        test_set(&grid, x, y, z, padded ? pad : test_random_int(&random, 50, 200));
                    }
            iso_histogram h = histogram_of(&grid, NULL);
            assert_true(h.padding > 0);
            near(h.padding_value, pad, 0);
            near(h.low, 50, 0);
            near(h.high, 200, 0);
            near(high ? h.maximum : h.minimum, pad, 0);
            near(high ? h.minimum : h.maximum, high ? 50 : 200, 0);
            check_bins(&grid, &h);
            /* below half of the faces nothing is padding */
            for (int z = 0; z < 16; z++)
                for (int y = 0; y < 18; y++)
                    for (int x = 0; x < 10; x++) test_set(&grid, x, y, z, 100);
            h = histogram_of(&grid, NULL);
            assert_int_equal(h.padding, 0);
            iso_grid_destroy(&grid);
        }
}

/* Padding by the rule itself: whether more than half of the voxels on the faces have the extreme value. */
static bool is_padded(const iso_grid *grid, double extreme) {
    const int *dims = iso_grid_dims(grid);
    long faces = 0, extremes = 0;
    for (int z = 0; z < dims[2]; z++)
        for (int y = 0; y < dims[1]; y++)
            for (int x = 0; x < dims[0]; x++) {
                if (x && y && z && x < dims[0] - 1 && y < dims[1] - 1 && z < dims[2] - 1) continue;
                faces++;
                extremes += iso_grid_at(grid, x, y, z) == extreme;
            }
    return 2 * extremes > faces;
}

/* Some faces padded and some not: every face counts, each voxel of it once. */
static void every_face_counts_for_padding(void **state) {
    (void)state;
    test_random random = {9};
    int padded = 0;
    for (int round = 0; round < 300; round++) {
        int dims[3];
        test_random_dims(&random, 3, 36, dims);
        iso_grid grid = round % 5 == 4 ? test_hgrid(dims, 3) : test_rgrid(dims, all_types[round % 4]);
        double extreme = grid.hgrid ? 3 : 0;
        uint32_t faces = test_random_next(&random);
        for (int z = 0; z < dims[2]; z++)
            for (int y = 0; y < dims[1]; y++)
                for (int x = 0; x < dims[0]; x++) {
                    const bool on[6] = {!x, !y, !z, x == dims[0] - 1, y == dims[1] - 1, z == dims[2] - 1};
                    bool pad = false;
                    for (int f = 0; f < 6; f++) pad = pad || (on[f] && (faces >> f & 1));
                    /* an hgrid's empty cells are padding too */
                    if (grid.hgrid && (faces >> (6 + x / 16 + 2 * (y / 16) + 4 * (z / 16)) & 1)) continue;
                    test_set(&grid, x, y, z,
                             pad          ? extreme
                             : grid.hgrid ? (x + y + z) % 3 - 1
                                          : 1 + (x + y + z) % 3);
                }
        iso_histogram h = histogram_of(&grid, NULL);
        if (!h.padding && h.maximum - h.minimum < 2) { /* one value beside the padding, or none */
            iso_grid_destroy(&grid);
            continue;
        }
        double found = grid.hgrid ? h.maximum : h.minimum;
        bool wanted = found == extreme && is_padded(&grid, extreme);
        if (found == extreme) assert_int_equal(h.padding > 0, wanted);
        padded += wanted;
        iso_grid_destroy(&grid);
    }
    assert_true(padded > 60 && padded < 240);
}

static void masks_and_constants(void **state) {
    (void)state;
    for (int t = 0; t < 4; t++) {
        iso_grid grid = test_rgrid((int[3]){9, 9, 9}, all_types[t]);
        double candidates[3];
        iso_histogram h = histogram_of(&grid, NULL);
        near(h.low, h.high, 0);
        assert_int_equal(h.counted, 729);
        assert_int_equal(iso_isovalue_suggest(&grid, &h, candidates), 0);
        test_set(&grid, 4, 4, 4, 255); /* a mask: both values count, the border's too */
        h = histogram_of(&grid, NULL);
        assert_int_equal(h.padding, 0);
        assert_int_equal(iso_isovalue_suggest(&grid, &h, candidates), 1);
        near(candidates[0], 127.5, 1.1);
        iso_grid_destroy(&grid);
    }
    iso_grid grid = test_rgrid((int[3]){3, 3, 3}, ISO_FLOAT32);
    for (int i = 0; i < 27; i++) ((float *)grid.rgrid->data)[i] = i % 2 ? NAN : INFINITY;
    iso_histogram h;
    iso_error error = {0};
    assert_int_equal(iso_histogram_compute(&grid, NULL, &h, &error), ISO_ERR_EMPTY);
    assert_non_null(strstr(error.text, "NaN"));
    iso_grid_destroy(&grid);
    iso_grid ball = test_ball_grid(20, iso_vec3_make(10, 10, 10), 5, 1);
    double candidates[3];
    h = histogram_of(&ball, NULL);
    assert_int_equal(iso_isovalue_suggest(&ball, &h, candidates), 1);
    near(candidates[0], 0, 0);
    iso_grid_destroy(&ball);
}

/* Between-class variance of the voxels themselves, for thresholds a <= b. */
static double variance_between(const iso_grid *grid, double a, double b) {
    const int *dims = iso_grid_dims(grid);
    double weight[3] = {0}, sum[3] = {0}, total = 0, all = 0;
    for (int i = 0; i < dims[0] * dims[1] * dims[2]; i++) {
        double value = iso_grid_at(grid, i % dims[0], i / dims[0] % dims[1], i / dims[0] / dims[1]);
        int class = value < a ? 0 : value < b ? 1 : 2;
        weight[class]++;
        sum[class] += value;
        total += value;
        all++;
    }
    double variance = 0;
    for (int c = 0; c < 3; c++)
        if (weight[c] > 0) variance += weight[c] * pow(sum[c] / weight[c] - total / all, 2);
    return variance / all;
}

/* Three heaps of values, noise on the faces so that nothing is padding: no threshold is better than ours. */
static void suggestions_are_otsus(void **state) {
    (void)state;
    test_random random = {5};
    for (int t = 0; t < 4; t++) {
        iso_grid grid = test_rgrid((int[3]){14, 15, 16}, all_types[t]);
        for (int i = 0; i < 14 * 15 * 16; i++) {
            double r = 0;
            for (int k = 0; k < 4; k++) r += test_random_real(&random, -8, 8);
            int heap = test_random_int(&random, 0, 9);
            double value = (heap < 5 ? 40 : heap < 8 ? 110 : 190) + r;
            test_set(&grid, i % 14, i / 14 % 15, i / 210, value);
        }
        iso_histogram h = histogram_of(&grid, NULL);
        double candidates[3];
        assert_int_equal(iso_isovalue_suggest(&grid, &h, candidates), 3);
        double one = variance_between(&grid, candidates[0], candidates[0]);
        double two = variance_between(&grid, candidates[1], candidates[2]);
        assert_true(candidates[1] < candidates[2]);
        double tolerance = t == 3 ? 1e-3 : 1e-9; /* bins of floats are coarser than the values */
        for (double a = 1.5; a < 250; a++) {
            assert_true(variance_between(&grid, a, a) <= one * (1 + tolerance));
            for (double b = a + 1; b < 250; b += 7)
                assert_true(variance_between(&grid, a, b) <= two * (1 + tolerance));
        }
        for (int i = 0; i < 3; i++)
            if (t != 3) near(candidates[i] - floor(candidates[i]), 0.5, 0);
        assert_true(candidates[1] > 60 && candidates[1] < 90 && candidates[2] > 130 && candidates[2] < 170);
        /* the same thresholds in physical units */
        grid.rgrid->scale = 2;
        grid.rgrid->offset = -100;
        double scaled[3];
        h = histogram_of(&grid, NULL);
        assert_int_equal(iso_isovalue_suggest(&grid, &h, scaled), 3);
        for (int i = 0; i < 3; i++) near(scaled[i], 2 * candidates[i] - 100, 1e-9);
        iso_grid_destroy(&grid);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(histograms_count_every_voxel),  cmocka_unit_test(padding_is_left_out),
        cmocka_unit_test(every_face_counts_for_padding), cmocka_unit_test(masks_and_constants),
        cmocka_unit_test(suggestions_are_otsus),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
