/* The brick index compared with plain loops over voxels. */
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

#include "base/memory.h"
#include "base/parallel.h"
#include "base/primitives.h"
#include "check_support.h"
#include "grids/brick_index.h"
#include "grids/brick_range.h"
#include "grids/grid.h"
#include "grids/interval_tree.h"

/* ---- grids */

typedef enum values { NOISE, FEW, SMOOTH, WRONG, VALUES } values;

static void set_voxel(iso_rgrid *grid, int x, int y, int z, float value) {
    ptrdiff_t i = x + y * grid->stride_y + z * grid->stride_z;
    switch (grid->type) {
    case ISO_UINT8:
        ((uint8_t *)grid->data)[i] = (uint8_t)value;
        break;
    case ISO_INT16:
        ((int16_t *)grid->data)[i] = (int16_t)value;
        break;
    case ISO_UINT16:
        ((uint16_t *)grid->data)[i] = (uint16_t)value;
        break;
    default:
        ((float *)grid->data)[i] = value;
    }
}

/* Within the type's range. */
static float random_value(iso_type type, values kind, const int at[3], uint64_t *random) {
    static const float least[] = {0, -32768, 0, -5}, most[] = {255, 32767, 65535, 5};
    const float wrong[] = {NAN, INFINITY, -INFINITY, FLT_MAX, -FLT_MAX, -0.0f};
    if (type == ISO_FLOAT32 && kind == WRONG && random_below(random, 40) == 0)
        return wrong[random_below(random, 6)];
    float t = (float)random_below(random, 1 << 24) / (float)(1 << 24);
    if (kind == FEW) t = random_below(random, 3000) ? 0.25f : random_below(random, 2) ? 1 : 0;
    if (kind == SMOOTH) t = (float)((at[0] + at[1] + 2 * at[2]) / 8) / 64.0f + t / 100;
    float value = least[type] + t * (most[type] - least[type]);
    return type == ISO_FLOAT32 ? value : roundf(fminf(value, most[type]));
}

/* A crop, so that strides matter and the voxels around it must not be read. */
static iso_rgrid *make_grid(iso_type type, values kind, const int dims[3], uint64_t *random) {
    iso_rgrid_desc desc = {.type = type};
    int lo[3], hi[3];
    for (int axis = 0; axis < 3; axis++) {
        lo[axis] = (int)random_below(random, 3);
        hi[axis] = lo[axis] + dims[axis] - 1;
        desc.dims[axis] = hi[axis] + 1 + (int)random_below(random, 3);
    }
    iso_rgrid *grid = NULL;
    assert_int_equal(iso_rgrid_create(&desc, &grid, NULL), ISO_OK);
    int at[3];
    for (at[2] = 0; at[2] < desc.dims[2]; at[2]++)
        for (at[1] = 0; at[1] < desc.dims[1]; at[1]++)
            for (at[0] = 0; at[0] < desc.dims[0]; at[0]++)
                set_voxel(grid, at[0], at[1], at[2], random_value(type, kind, at, random));
    assert_int_equal(iso_rgrid_crop(grid, lo, hi, NULL), ISO_OK);
    return grid;
}

static iso_rgrid *random_grid(int round, uint64_t *random) {
    static const int sides[] = {1, 2, 15, 16, 17, 18, 31, 32, 33, 34, 37, 48, 49, 65};
    int dims[3];
    for (int axis = 0; axis < 3; axis++)
        dims[axis] = sides[random_below(random, sizeof sides / sizeof *sides)];
    if (random_below(random, 20) == 0) { /* more bricks along x than are read at a time */
        dims[0] = 1020 + (int)random_below(random, 40);
        dims[1] = 1 + (int)random_below(random, 20);
        dims[2] = 1 + (int)random_below(random, 20);
    }
    return make_grid((iso_type)(round % 4), (values)(round / 4 % VALUES), dims, random);
}

/* ---- the model */

static iso_brick_range model_range(const iso_rgrid *grid, const int b[3]) {
    iso_brick_range range = {INFINITY, -INFINITY, true};
    const int *n = grid->dims;
    for (int z = b[2] * 16; z <= b[2] * 16 + 16 && z < n[2]; z++)
        for (int y = b[1] * 16; y <= b[1] * 16 + 16 && y < n[1]; y++)
            for (int x = b[0] * 16; x <= b[0] * 16 + 16 && x < n[0]; x++) {
                float value = iso_rgrid_at(grid, x, y, z);
                if (!isfinite(value)) {
                    range.finite = false;
                    continue;
                }
                range.lo = fminf(range.lo, value);
                range.hi = fmaxf(range.hi, value);
            }
    return range;
}

/* Which row groups have an edge, or a cell of one voxel more, that the isovalue crosses. */
static uint32_t model_groups(const iso_rgrid *grid, const int b[3], float isovalue) {
    const int *n = grid->dims;
    uint32_t below = 0, above = 0;
    for (int z = 0; z <= 16 && b[2] * 16 + z < n[2]; z++)
        for (int y = 0; y <= 16 && b[1] * 16 + y < n[1]; y++)
            for (int x = b[0] * 16; x <= b[0] * 16 + 16 && x < n[0]; x++) {
                float value = iso_rgrid_at(grid, x, b[1] * 16 + y, b[2] * 16 + z);
                if (!isfinite(value)) continue;
                for (int corner = 0; corner < 4; corner++) {
                    int gy = y / 4 - corner % 2, gz = z / 4 - corner / 2;
                    if ((corner % 2 && y % 4) || (corner / 2 && z % 4)) continue;
                    if (gy < 0 || gy > 3 || gz < 0 || gz > 3) continue;
                    *(value < isovalue ? &below : &above) |= 1u << (4 * gz + gy);
                }
            }
    return below & above;
}

/* Never one too few; for narrow integers none too many. */
static void check_groups(const iso_rgrid *grid, const iso_brick_index *index, uint32_t brick,
                         float isovalue) {
    const int nx = (grid->dims[0] - 1) / 16 + 1, ny = (grid->dims[1] - 1) / 16 + 1;
    const int at[3] = {(int)brick % nx, (int)brick / nx % ny, (int)brick / nx / ny};
    const uint32_t model = model_groups(grid, at, isovalue),
                   groups = iso_brick_index_groups(index, brick, isovalue);
    const iso_brick_range range = iso_brick_index_range(index, brick);
    if (model & ~groups)
        fail_msg("brick %u, isovalue %.9g: groups %x, not %x", brick, isovalue, groups, model);
    if (grid->type != ISO_FLOAT32 && range.hi - range.lo <= 255) assert_int_equal(groups, model);
}

/* All bricks' ranges, x fastest. */
static iso_brick_range *model_ranges(const iso_rgrid *grid, size_t *total) {
    int n[3], b[3];
    iso_grid_bricks(&(iso_grid){.rgrid = (iso_rgrid *)grid}, n);
    *total = (size_t)n[0] * (size_t)n[1] * (size_t)n[2];
    iso_brick_range *ranges = calloc(*total, sizeof *ranges);
    size_t i = 0;
    for (b[2] = 0; b[2] < n[2]; b[2]++)
        for (b[1] = 0; b[1] < n[1]; b[1]++)
            for (b[0] = 0; b[0] < n[0]; b[0]++) ranges[i++] = model_range(grid, b);
    return ranges;
}

static bool same_range(const iso_brick_range *a, const iso_brick_range *b) {
    return a->lo == b->lo && a->hi == b->hi && a->finite == b->finite;
}

static void check_ranges(const iso_brick_index *index, const iso_brick_range *model, size_t total) {
    assert_int_equal(iso_brick_index_bricks(index), total);
    for (uint32_t i = 0; i < total; i++) {
        iso_brick_range range = iso_brick_index_range(index, i);
        if (!same_range(&range, &model[i]))
            fail_msg("brick %u: %g..%g %d, not %g..%g %d", i, range.lo, range.hi, range.finite, model[i].lo,
                     model[i].hi, model[i].finite);
        assert_int_equal(iso_brick_index_finite(index, i), model[i].finite);
    }
}

/* What a query may look at: its answer, an entry too many on each level of the tree, and edited bricks once
 * in their list and once in the tree. */
static void check_query(const iso_rgrid *grid, const iso_brick_range *model, float isovalue,
                        iso_brick_query *query) {
    const iso_brick_index *index = grid->index;
    assert_int_equal(iso_brick_index_query(index, isovalue, query, NULL), ISO_OK);
    const uint32_t *bricks = query->bricks.data;
    size_t found = 0, total = iso_brick_index_bricks(index);
    for (uint32_t i = 0; i < total; i++) {
        bool crosses = model[i].lo < isovalue && model[i].hi >= isovalue;
        assert_int_equal(iso_brick_index_crosses(index, i, isovalue), crosses);
        if (!crosses) continue;
        if (found >= query->count || bricks[found] != i)
            fail_msg("isovalue %.9g: brick %u is missing, %zu found", isovalue, i, query->count);
        check_groups(grid, index, i, isovalue);
        found++;
    }
    assert_int_equal(query->count, found);
    size_t levels = 0;
    while (total >> levels) levels++;
    assert_true(query->visited <= query->count + 2 * iso_brick_index_pending(index) + levels);
}

static float random_isovalue(const iso_rgrid *grid, uint64_t *random) {
    int x = (int)random_below(random, (uint32_t)grid->dims[0]),
        y = (int)random_below(random, (uint32_t)grid->dims[1]);
    float value = iso_rgrid_at(grid, x, y, (int)random_below(random, (uint32_t)grid->dims[2]));
    switch (random_below(random, 5)) {
    case 0:
        return nextafterf(value, INFINITY);
    case 1:
        return nextafterf(value, -INFINITY);
    case 2:
        return value + 0.5f;
    default:
        return value;
    }
}

static void check_queries(const iso_rgrid *grid, const iso_brick_index *index, int count, uint64_t *random) {
    const float fixed[] = {-40000, -6, 0, 255, 255.5f, 70000, FLT_MAX, -FLT_MAX, INFINITY, -INFINITY, NAN};
    size_t total;
    iso_brick_range *model = model_ranges(grid, &total);
    check_ranges(index, model, total);
    iso_brick_query query = {0};
    for (size_t i = 0; i < sizeof fixed / sizeof *fixed; i++) check_query(grid, model, fixed[i], &query);
    for (int i = 0; i < count; i++) check_query(grid, model, random_isovalue(grid, random), &query);
    for (size_t i = 0; i < total && count; i += 1 + total / (size_t)count) {
        check_query(grid, model, model[i].lo, &query);
        check_query(grid, model, model[i].hi, &query);
    }
    iso_brick_query_free(&query);
    free(model);
}

/* ---- tests */

static void ranges_and_queries_match_the_voxels(void **state) {
    (void)state;
    uint64_t random = 1;
    for (int round = 0; round < 160; round++) {
        iso_rgrid *grid = random_grid(round, &random);
        const iso_brick_index *index = NULL;
        assert_int_equal(iso_brick_index_of(grid, NULL, &index, NULL), ISO_OK);
        check_queries(grid, index, 40, &random);
        iso_rgrid_destroy(grid);
    }
}

static int least(int a, int b) {
    return a < b ? a : b;
}

static void levels_agree(void **state) {
    (void)state;
    uint64_t random = 2;
    for (int round = 0; round < 80; round++) {
        iso_rgrid *grid = random_grid(round, &random);
        int n = (grid->dims[0] - 1) / ISO_BRICK + 1;
        const int last[3] = {0, (grid->dims[1] - 1) / ISO_BRICK, (grid->dims[2] - 1) / ISO_BRICK};
        const int from[3] = {(int)random_below(&random, (uint32_t)n),
                             (int)random_below(&random, (uint32_t)last[1] + 1),
                             (int)random_below(&random, (uint32_t)last[2] + 1)};
        int most[2];
        iso_brick_batch_max(grid, most);
        iso_brick_reading *generic = NULL;
        for (int level = 0; level <= (int)iso_cpu_supported(); level++) {
            iso_brick_reading *readings = calloc(ISO_BATCH_BRICKS, sizeof *readings);
            iso_brick_batch batch = {{from[0], from[1], from[2]},
                                     {least(most[0], n - from[0]), least(most[1], last[1] + 1 - from[1])}};
            iso_brick_ranges(grid, (iso_cpu_level)level, &batch, readings);
            for (int i = 0; i < batch.count[0] * batch.count[1]; i++) {
                const int at[3] = {from[0] + i % batch.count[0], from[1] + i / batch.count[0], from[2]};
                iso_brick_range model = model_range(grid, at);
                assert_true(same_range(&readings[i].range, &model));
            }
            if (!generic) generic = readings;
            for (int i = 0; i < ISO_BATCH_BRICKS; i++)
                assert_memory_equal(&readings[i].groups, &generic[i].groups, sizeof generic[i].groups);
            if (readings != generic) free(readings);
        }
        free(generic);
        iso_rgrid_destroy(grid);
    }
}

/* The whole answer, not only its set of bricks. */
static void threads_agree(void **state) {
    (void)state;
    uint64_t random = 3;
    for (int round = 0; round < 24; round++) {
        iso_rgrid *grid = random_grid(round, &random);
        iso_brick_index *alone = NULL;
        assert_int_equal(iso_brick_index_create(grid, NULL, &alone, NULL), ISO_OK);
        static const int threads[] = {1, 2, 7};
        for (int i = 0; i < 3; i++) {
            iso_pool *pool = NULL;
            assert_int_equal(iso_pool_create(threads[i], &pool, NULL), ISO_OK);
            iso_brick_index *index = NULL;
            assert_int_equal(iso_brick_index_create(grid, pool, &index, NULL), ISO_OK);
            assert_int_equal(iso_brick_index_bytes(index), iso_brick_index_bytes(alone));
            assert_true(iso_brick_index_bytes(index) <= iso_brick_index_estimate(grid->dims));
            size_t total;
            iso_brick_range *model = model_ranges(grid, &total);
            check_ranges(index, model, total);
            free(model);
            iso_brick_index_destroy(index);
            iso_pool_destroy(pool);
        }
        iso_brick_index_destroy(alone);
        iso_rgrid_destroy(grid);
    }
}

/* A box of one value or of noise; its changes are recorded as one box, or voxel by voxel. */
static void edit(iso_rgrid *grid, uint64_t *random) {
    int lo[3], hi[3], at[3], size = 1 + (int)random_below(random, random_below(random, 8) ? 4 : 30);
    for (int axis = 0; axis < 3; axis++) {
        lo[axis] = (int)random_below(random, (uint32_t)grid->dims[axis]);
        if (random_below(random, 3) == 0)
            lo[axis] = lo[axis] / ISO_BRICK * ISO_BRICK; /* what neighbours see */
        hi[axis] = lo[axis] + size <= grid->dims[axis] ? lo[axis] + size - 1 : grid->dims[axis] - 1;
    }
    bool flat = random_below(random, 2);
    float value = iso_rgrid_at(grid, 0, 0, 0);
    for (at[2] = lo[2]; at[2] <= hi[2]; at[2]++)
        for (at[1] = lo[1]; at[1] <= hi[1]; at[1]++)
            for (at[0] = lo[0]; at[0] <= hi[0]; at[0]++) {
                float noise = random_value(grid->type, WRONG, at, random);
                set_voxel(grid, at[0], at[1], at[2], flat ? value : noise);
            }
    assert_int_equal(iso_rgrid_mark_changed(grid, lo, hi, NULL), ISO_OK);
}

static void updates_follow_edits(void **state) {
    (void)state;
    uint64_t random = 4;
    iso_pool *pool = NULL;
    assert_int_equal(iso_pool_create(3, &pool, NULL), ISO_OK);
    for (int round = 0; round < 32; round++) {
        iso_rgrid *grid = random_grid(round, &random);
        const iso_brick_index *index = NULL;
        assert_int_equal(iso_brick_index_of(grid, pool, &index, NULL), ISO_OK);
        for (int step = 0; step < 20; step++) {
            assert_true(iso_brick_index_current(index));
            for (int edits = 1 + (int)random_below(&random, 5); edits; edits--) edit(grid, &random);
            assert_false(iso_brick_index_current(index));
            const iso_brick_index *same = NULL;
            assert_int_equal(iso_brick_index_of(grid, step % 2 ? pool : NULL, &same, NULL), ISO_OK);
            assert_ptr_equal(same, index);
            check_queries(grid, index, 4, &random);
        }
        iso_rgrid_destroy(grid);
    }
    iso_pool_destroy(pool);
}

/* Small edits all over a larger grid: the list beside the tree grows, is bounded, and is emptied. */
static void the_list_of_edited_bricks_is_bounded(void **state) {
    (void)state;
    uint64_t random = 5;
    iso_rgrid *grid = make_grid(ISO_UINT8, FEW, (const int[3]){161, 160, 163}, &random);
    const iso_brick_index *index = NULL;
    assert_int_equal(iso_brick_index_of(grid, NULL, &index, NULL), ISO_OK);
    size_t before = 0, most = 0, rebuilds = 0, bricks = iso_brick_index_bricks(index);
    for (int step = 0; step < 300; step++) {
        edit(grid, &random);
        assert_int_equal(iso_brick_index_of(grid, NULL, NULL, NULL), ISO_OK);
        size_t pending = iso_brick_index_pending(index);
        assert_true(pending <= bricks / 32 + 64);
        rebuilds += pending < before;
        before = pending;
        most = pending > most ? pending : most;
        if (step % 10 == 0) check_queries(grid, index, 2, &random);
    }
    assert_true(most > 32 && rebuilds > 2);
    iso_rgrid_destroy(grid);
}

/* Voxels changed without a word to the log: only what the log names may be read again. */
static void untouched_bricks_are_not_read(void **state) {
    (void)state;
    uint64_t random = 6;
    const int dims[3] = {80, 80, 80};
    iso_rgrid *grid = make_grid(ISO_INT16, SMOOTH, dims, &random);
    const iso_brick_index *index = NULL;
    assert_int_equal(iso_brick_index_of(grid, NULL, &index, NULL), ISO_OK);
    size_t total;
    iso_brick_range *before = model_ranges(grid, &total);
    for (int i = 0; i < 80; i++) /* the least value of all, in every brick */
        for (int j = 0; j < 80; j++)
            for (int k = 0; k < 80; k++) set_voxel(grid, i, j, k, -32768);
    const int inner[3] = {33, 35, 40}, corner[3] = {64, 66, 48};
    assert_int_equal(iso_rgrid_mark_changed(grid, inner, inner, NULL), ISO_OK);
    assert_int_equal(iso_rgrid_mark_changed(grid, corner, corner, NULL), ISO_OK);
    assert_int_equal(iso_brick_index_of(grid, NULL, NULL, NULL), ISO_OK);
    for (uint32_t i = 0; i < total; i++) {
        const int b[3] = {(int)(i % 5), (int)(i / 5 % 5), (int)(i / 25)};
        bool read = b[0] == 2 && b[1] == 2 && b[2] == 2;
        read |= (b[0] == 3 || b[0] == 4) && b[1] == 4 && (b[2] == 2 || b[2] == 3);
        iso_brick_range model = {-32768, -32768, true}, range = iso_brick_index_range(index, i);
        assert_true(same_range(&range, read ? &model : &before[i]));
    }
    free(before);
    iso_rgrid_destroy(grid);
}

enum { INTERVALS = 100000 };

static void random_intervals(float *lo, float *hi, int kind, uint64_t *random) {
    for (int i = 0; i < INTERVALS; i++) {
        float value = (float)random_below(random, kind == 0 ? 200 : 1 << 24) - (kind == 2 ? 1 << 23 : 0);
        lo[i] = value;
        hi[i] = value + (float)random_below(random, kind == 1 ? 1 << 20 : 50); /* empty ones as well */
        if (random_below(random, 500) == 0) lo[i] = INFINITY, hi[i] = -INFINITY;
        if (random_below(random, 500) == 0) lo[i] = -0.0f, hi[i] = 0;
    }
}

/* Far more intervals than answers, alike and spread: the work follows the answers. */
static void queries_cost_what_they_answer(void **state) {
    (void)state;
    uint64_t random = 9;
    float *lo = malloc(INTERVALS * sizeof *lo), *hi = malloc(INTERVALS * sizeof *hi);
    uint8_t *seen = malloc(INTERVALS);
    iso_interval_tree tree = {0};
    for (int kind = 0; kind < 3; kind++) {
        random_intervals(lo, hi, kind, &random);
        assert_int_equal(iso_interval_tree_build(&tree, lo, hi, INTERVALS, NULL), ISO_OK);
        for (int round = 0; round < 60; round++) {
            uint32_t any = random_below(&random, INTERVALS);
            float value = round % 3 == 0 ? lo[any] : round % 3 == 1 ? hi[any] : hi[any] + 0.5f;
            iso_interval_run runs[ISO_INTERVAL_RUNS];
            size_t looks = 0, answers = 0;
            memset(seen, 0, INTERVALS);
            int count = iso_interval_tree_query(&tree, value, runs, &looks);
            for (int r = 0; r < count; r++)
                for (size_t k = 0; k < runs[r].count; k++, answers++)
                    assert_int_equal(seen[runs[r].ends[k].interval]++, 0);
            for (int i = 0; i < INTERVALS; i++)
                if (seen[i] != (lo[i] < value && hi[i] >= value)) fail_msg("%g: interval %d", value, i);
            assert_true(looks >= answers && looks <= answers + 17); /* 2^17 > INTERVALS */
        }
    }
    iso_interval_tree_free(&tree);
    free(lo);
    free(hi);
    free(seen);
}

static void a_crop_drops_the_index(void **state) {
    (void)state;
    uint64_t random = 7;
    iso_rgrid *grid = make_grid(ISO_FLOAT32, NOISE, (const int[3]){40, 40, 40}, &random);
    assert_int_equal(iso_brick_index_of(grid, NULL, NULL, NULL), ISO_OK);
    assert_non_null(grid->index);
    assert_int_equal(iso_rgrid_crop(grid, (const int[3]){3, 5, 7}, (const int[3]){30, 39, 20}, NULL), ISO_OK);
    assert_null(grid->index);
    const iso_brick_index *index = NULL;
    assert_int_equal(iso_brick_index_of(grid, NULL, &index, NULL), ISO_OK);
    check_queries(grid, index, 20, &random);
    iso_rgrid_destroy(grid);
}

static iso_value_counts *model_counts(const iso_rgrid *grid) {
    iso_value_counts *counts = calloc(1, sizeof *counts);
    const int *n = grid->dims;
    for (int z = 0; z < n[2]; z++)
        for (int y = 0; y < n[1]; y++)
            for (int x = 0; x < n[0]; x++) {
                const int at = (int)iso_rgrid_at(grid, x, y, z) + (grid->type == ISO_INT16 ? 32768 : 0);
                counts->all[at]++;
                counts->faces[at] += !x || !y || !z || x == n[0] - 1 || y == n[1] - 1 || z == n[2] - 1;
            }
    return counts;
}

static void values_are_counted_with_the_index(void **state) {
    (void)state;
    uint64_t random = 9;
    iso_pool *pool = NULL;
    assert_int_equal(iso_pool_create(3, &pool, NULL), ISO_OK);
    for (int round = 0; round < 48; round++) {
        iso_rgrid *grid = random_grid(round, &random);
        assert_null(iso_brick_index_counts(grid));
        assert_int_equal(iso_brick_index_with_counts(grid, round % 3 ? pool : NULL, NULL), ISO_OK);
        const iso_value_counts *counts = iso_brick_index_counts(grid);
        if (grid->type == ISO_FLOAT32) {
            assert_null(counts);
        } else {
            iso_value_counts *model = model_counts(grid), *alone = NULL;
            assert_memory_equal(counts, model, sizeof *model);
            assert_int_equal(iso_value_counts_create(grid, 0, grid->dims[2], pool, &alone, NULL), ISO_OK);
            assert_memory_equal(alone, model, sizeof *model);
            iso_free(alone);
            free(model);
            iso_brick_index *same = NULL;
            assert_int_equal(iso_brick_index_create(grid, NULL, &same, NULL), ISO_OK);
            for (size_t i = 0; i < iso_brick_index_bricks(same); i++) {
                const iso_brick_range wanted = iso_brick_index_range(same, (uint32_t)i),
                                      got = iso_brick_index_range(grid->index, (uint32_t)i);
                assert_true(same_range(&got, &wanted));
            }
            iso_brick_index_destroy(same);
            edit(grid, &random);
            assert_null(iso_brick_index_counts(grid));
            assert_int_equal(iso_brick_index_with_counts(grid, pool, NULL), ISO_OK);
            assert_null(iso_brick_index_counts(grid));
        }
        iso_rgrid_destroy(grid);
    }
    iso_pool_destroy(pool);
}

/* iso_grid_brick_may_cross with an index, without one, and with one that lags. */
static void quick_tests_agree(void **state) {
    (void)state;
    uint64_t random = 8;
    for (int round = 0; round < 32; round++) {
        iso_grid grid = {.rgrid = random_grid(round, &random)};
        if (round & 1) assert_int_equal(iso_brick_index_of(grid.rgrid, NULL, NULL, NULL), ISO_OK);
        if (round & 2) edit(grid.rgrid, &random);
        int n[3], b[3];
        iso_grid_bricks(&grid, n);
        float isovalue = random_isovalue(grid.rgrid, &random);
        for (b[2] = 0; b[2] < n[2]; b[2]++)
            for (b[1] = 0; b[1] < n[1]; b[1]++)
                for (b[0] = 0; b[0] < n[0]; b[0]++) {
                    iso_brick_range range = model_range(grid.rgrid, b);
                    assert_int_equal(iso_grid_brick_may_cross(&grid, b, isovalue),
                                     range.lo < isovalue && range.hi >= isovalue);
                }
        iso_grid_destroy(&grid);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(ranges_and_queries_match_the_voxels),
        cmocka_unit_test(levels_agree),
        cmocka_unit_test(threads_agree),
        cmocka_unit_test(updates_follow_edits),
        cmocka_unit_test(the_list_of_edited_bricks_is_bounded),
        cmocka_unit_test(untouched_bricks_are_not_read),
        cmocka_unit_test(queries_cost_what_they_answer),
        cmocka_unit_test(a_crop_drops_the_index),
        cmocka_unit_test(values_are_counted_with_the_index),
        cmocka_unit_test(quick_tests_agree),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
