/* Tiled volumes: the same voxels as a whole and chunk by chunk, whatever the tiles, the cache and the
 * threads; the first failure is reported; histograms of sources are those of grids. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "extract/isovalue/isovalue.h"
#include "grids/chunk_walk.h"
#include "grids/volume/tiled.h"

/* A volume whose values are computed from the voxel's place. */
typedef struct made_volume {
    int dims[3], tile[3];
    iso_type type;
    int absent_from;  /* tiles from this layer on are absent; 0: none */
    int failing_from; /* tiles from this number on cannot be read; 0: none */
    int ball;         /* radius of a ball of greater values around the middle; 0: other values */
    atomic_int reads, destroyed;
} made_volume;

enum { ABSENT_VALUE = 7 };

static double value_at(const made_volume *v, int x, int y, int z) {
    const uint32_t mixed = (uint32_t)x * 73856093u ^ (uint32_t)y * 19349663u ^ (uint32_t)z * 83492791u;
    const bool face = x == 0 || y == 0 || z == 0 || x == v->dims[0] - 1 || y == v->dims[1] - 1;
    if (v->absent_from && z / v->tile[2] >= v->absent_from) return ABSENT_VALUE;
    if (v->ball) {
        const int dx = x - v->dims[0] / 2, dy = y - v->dims[1] / 2, dz = z - v->dims[2] / 2;
        return dx * dx + dy * dy + dz * dz < v->ball * v->ball ? 60 + mixed % 50 : 40 - mixed % 40;
    }
    if (face) return 0; /* padding */
    if (v->type == ISO_FLOAT32 && mixed % 97 == 0) return NAN;
    return mixed % 101 + 3;
}

static void store(iso_type type, void *data, size_t at, double value) {
    if (type == ISO_UINT8) ((uint8_t *)data)[at] = (uint8_t)value;
    if (type == ISO_INT16) ((int16_t *)data)[at] = (int16_t)value;
    if (type == ISO_UINT16) ((uint16_t *)data)[at] = (uint16_t)value;
    if (type == ISO_FLOAT32) ((float *)data)[at] = (float)value;
}

static iso_status read_made(void *context, const int index[3], void *target, iso_error *error) {
    made_volume *v = context;
    int tiles[3], origin[3];
    for (int i = 0; i < 3; i++) {
        tiles[i] = (v->dims[i] - 1) / v->tile[i] + 1;
        origin[i] = index[i] * v->tile[i];
    }
    const int number = (index[2] * tiles[1] + index[1]) * tiles[0] + index[0];
    atomic_fetch_add(&v->reads, 1);
    if (v->failing_from && number >= v->failing_from)
        return iso_fail(error, ISO_ERR_IO, "made.file, tile %d: damaged", number);
    size_t at = 0;
    for (int z = 0; z < v->tile[2]; z++)
        for (int y = 0; y < v->tile[1]; y++)
            for (int x = 0; x < v->tile[0]; x++, at++)
                store(v->type, target, at, value_at(v, origin[0] + x, origin[1] + y, origin[2] + z));
    return ISO_OK;
}

static uint64_t next_stored(void *context, uint64_t from, uint64_t end) {
    const made_volume *v = context;
    uint64_t layer = 1;
    for (int i = 0; i < 2; i++) layer *= (uint64_t)((v->dims[i] - 1) / v->tile[i] + 1);
    return v->absent_from && from >= layer * (uint64_t)v->absent_from ? end : from;
}

static void destroy_made(void *context) {
    made_volume *v = context;
    atomic_fetch_add(&v->destroyed, 1);
}

static iso_tiled tiled_of(made_volume *v) {
    iso_tiled tiled = {.type = v->type,
                       .read = read_made,
                       .next_stored = next_stored,
                       .fill = ABSENT_VALUE,
                       .destroy = destroy_made,
                       .context = v};
    memcpy(tiled.dims, v->dims, sizeof v->dims);
    memcpy(tiled.tile, v->tile, sizeof v->tile);
    return tiled;
}

static iso_volume_info info_of(const made_volume *v) {
    iso_volume_info info = {.type = v->type, .scale = 1, .transform = iso_transform_identity()};
    memcpy(info.dims, v->dims, sizeof v->dims);
    info.bytes = (uint64_t)v->dims[0] * (uint64_t)v->dims[1] * (uint64_t)v->dims[2] * iso_type_size(v->type);
    return info;
}

static const int shapes[][2][3] = {{{70, 50, 60}, {16, 16, 16}}, {{70, 50, 60}, {70, 50, 1}},
                                   {{70, 50, 60}, {7, 50, 11}},  {{35, 80, 41}, {64, 64, 64}},
                                   {{1, 1, 90}, {3, 2, 4}},      {{70, 50, 60}, {70, 50, 20}}};
enum { SHAPES = sizeof shapes / sizeof *shapes };

static made_volume make_volume(int shape, iso_type type) {
    made_volume v = {.type = type};
    memcpy(v.dims, shapes[shape][0], sizeof v.dims);
    memcpy(v.tile, shapes[shape][1], sizeof v.tile);
    return v;
}

static bool is_same(double a, double b) {
    return a == b || (isnan(a) && isnan(b));
}

static void expect_voxels(const made_volume *v, const iso_rgrid *grid, const int first[3], const int end[3],
                          const int origin[3]) {
    for (int z = first[2]; z < end[2]; z++)
        for (int y = first[1]; y < end[1]; y++)
            for (int x = first[0]; x < end[0]; x++) {
                const double got = (double)iso_rgrid_at(grid, x - origin[0], y - origin[1], z - origin[2]);
                if (!is_same(got, value_at(v, x, y, z)))
                    fail_msg("voxel %d %d %d: %g, expected %g", x, y, z, got, value_at(v, x, y, z));
            }
}

static const iso_chunk_turns all = {0, 1};

static iso_pool *pool_of(int threads) {
    iso_pool *pool = NULL;
    assert_int_equal(iso_pool_create(threads, &pool, NULL), ISO_OK);
    return pool;
}

/* ---- the whole */

static iso_grid read_whole(made_volume *v, const iso_volume_opts *opts) {
    iso_tiled tiled = tiled_of(v);
    iso_volume_info info = info_of(v);
    iso_grid grid = {0};
    assert_int_equal(iso_tiled_read_grid("made.file", opts, &tiled, &info, &grid, NULL), ISO_OK);
    iso_tiled_close(&tiled);
    assert_int_equal(info.note_count, v->absent_from && v->absent_from * v->tile[2] < v->dims[2]);
    return grid;
}

static void test_whole(void **state) {
    const int zero[3] = {0, 0, 0};
    (void)state;
    for (int shape = 0; shape < SHAPES; shape++)
        for (int threads = 1; threads <= 7; threads += 3)
            for (int type = ISO_UINT8; type <= ISO_FLOAT32; type++) {
                made_volume v = make_volume(shape, (iso_type)type);
                v.absent_from = shape % 2;
                const iso_volume_opts opts = {.pool = pool_of(threads), .mapped = threads == 4};
                iso_grid grid = read_whole(&v, &opts);
                expect_voxels(&v, grid.rgrid, zero, v.dims, zero);
                assert_int_equal(atomic_load(&v.destroyed), 1);
                iso_grid_destroy(&grid);
                iso_pool_destroy(opts.pool);
            }
}

static void test_first_failure(void **state) {
    (void)state;
    for (int threads = 1; threads <= 7; threads++) {
        made_volume v = make_volume(0, ISO_UINT8);
        v.failing_from = 13;
        const iso_volume_opts opts = {.pool = pool_of(threads)};
        iso_tiled tiled = tiled_of(&v);
        iso_volume_info info = info_of(&v);
        iso_grid grid = {0};
        iso_error error = {0};
        assert_int_equal(iso_tiled_read_grid("made.file", &opts, &tiled, &info, &grid, &error), ISO_ERR_IO);
        assert_string_equal(error.text, "made.file, tile 13: damaged");
        assert_null(grid.rgrid);
        iso_tiled_close(&tiled);
        iso_pool_destroy(opts.pool);
    }
}

static int cancel_later(void *context, double fraction) {
    (void)context;
    return fraction > 0.3;
}

static void test_cancelled(void **state) {
    (void)state;
    made_volume v = make_volume(0, ISO_UINT8);
    const iso_volume_opts opts = {.progress = cancel_later};
    iso_tiled tiled = tiled_of(&v);
    iso_volume_info info = info_of(&v);
    iso_grid grid = {0};
    iso_error error = {0};
    assert_int_equal(iso_tiled_read_grid("made.file", &opts, &tiled, &info, &grid, &error), ISO_ERR_IO);
    assert_non_null(strstr(error.text, "cancelled"));
    assert_true(atomic_load(&v.reads) < 40);
    iso_tiled_close(&tiled);
}

/* ---- chunks */

static iso_rgrid *make_tiled_grid(made_volume *v, uint64_t limit) {
    const iso_volume_opts opts = {.max_memory = limit};
    iso_tiled tiled = tiled_of(v);
    const iso_volume_info info = info_of(v);
    iso_grid grid = {0};
    assert_int_equal(iso_tiled_make_grid("made.file", &opts, &tiled, &info, &grid, NULL), ISO_OK);
    iso_tiled_close(&tiled);
    assert_true(iso_tiled_is(grid.rgrid));
    return grid.rgrid;
}

typedef struct chunk_check {
    const made_volume *volume;
    const int *crop; /* the volume's voxel that is the grid's first */
    size_t voxels;
} chunk_check;

static iso_status check_chunk(void *context, const iso_rgrid *grid, const int first[3], bool constant,
                              iso_error *error) {
    chunk_check *check = context;
    (void)constant;
    int from[3], end[3];
    (void)error;
    for (int i = 0; i < 3; i++) {
        from[i] = check->crop[i] + first[i];
        end[i] = from[i] + grid->dims[i];
    }
    expect_voxels(check->volume, grid, from, end, from);
    check->voxels += (size_t)grid->dims[0] * (size_t)grid->dims[1] * (size_t)grid->dims[2];
    return ISO_OK;
}

/* A chunk in the middle with its halo. */
static void expect_halo(const made_volume *v, const iso_chunk_source *source, iso_pool *pool) {
    const iso_brick_box box = {{1, 1, 1}, {2, 3, 2}};
    iso_grid_chunk chunk;
    iso_rgrid *grid = NULL;
    int first[3], end[3], origin[3];
    if (!iso_grid_chunk_make(source->dims, &source->transform, &box, &chunk)) return;
    assert_int_equal(source->read(source->context, &chunk, pool, &grid, NULL), ISO_OK);
    iso_grid_chunk_voxels(&chunk, first, end);
    for (int i = 0; i < 3; i++) origin[i] = chunk.origin[i] * ISO_BRICK;
    expect_voxels(v, grid, first, end, origin);
    iso_rgrid_destroy(grid);
}

static void test_chunks(void **state) {
    const int zero[3] = {0, 0, 0};
    (void)state;
    for (int shape = 0; shape < SHAPES; shape++)
        for (uint64_t limit = 1 << 10; limit <= 1 << 24; limit <<= 7)
            for (int threads = 1; threads <= 3; threads++) {
                made_volume v = make_volume(shape, threads == 1 ? ISO_INT16 : ISO_FLOAT32);
                iso_pool *pool = pool_of(threads);
                iso_rgrid *grid = make_tiled_grid(&v, limit);
                const iso_chunk_source source = iso_tiled_source(grid);
                chunk_check check = {.volume = &v, .crop = zero};
                for (int side = 16; side <= 48; side += 16)
                    assert_int_equal(
                        iso_chunk_source_visit(&source, side, all, pool, check_chunk, &check, NULL), ISO_OK);
                assert_int_equal(check.voxels, 3 * (size_t)v.dims[0] * (size_t)v.dims[1] * (size_t)v.dims[2]);
                expect_halo(&v, &source, pool);
                iso_rgrid_destroy(grid);
                assert_int_equal(atomic_load(&v.destroyed), 1);
                iso_pool_destroy(pool);
            }
}

static void test_cropped(void **state) {
    (void)state;
    made_volume v = make_volume(2, ISO_UINT16);
    iso_rgrid *grid = make_tiled_grid(&v, 1 << 20);
    const int lo[3] = {9, 17, 23}, hi[3] = {66, 44, 59};
    assert_int_equal(iso_rgrid_crop(grid, lo, hi, NULL), ISO_OK);
    const iso_chunk_source source = iso_tiled_source(grid);
    chunk_check check = {.volume = &v, .crop = lo};
    assert_int_equal(iso_chunk_source_visit(&source, 32, all, NULL, check_chunk, &check, NULL), ISO_OK);
    assert_int_equal(check.voxels, 58 * 28 * 37);
    iso_rgrid_destroy(grid);
}

static void test_cache_saves_reading(void **state) {
    const int zero[3] = {0, 0, 0};
    (void)state;
    made_volume v = make_volume(0, ISO_UINT8);
    iso_rgrid *grid = make_tiled_grid(&v, 1 << 24);
    const iso_chunk_source source = iso_tiled_source(grid);
    chunk_check check = {.volume = &v, .crop = zero};
    for (int i = 0; i < 2; i++)
        assert_int_equal(iso_chunk_source_visit(&source, 16, all, NULL, check_chunk, &check, NULL), ISO_OK);
    assert_int_equal(atomic_load(&v.reads), 5 * 4 * 4); /* each tile once */
    iso_rgrid_destroy(grid);
}

/* A chunk that is visited has the voxels of the windows of its crossed bricks; their tiles are noted. */
typedef struct walk_check {
    const made_volume *volume;
    bool touched[1000]; /* by tile */
} walk_check;

static iso_status check_bricks(void *context, const iso_chunk_visit *visit, iso_error *error) {
    walk_check *check = context;
    const made_volume *v = check->volume;
    const iso_brick_box *box = &visit->chunk->box;
    const iso_brick_range *range = visit->chunk->ranges;
    (void)error;
    for (int z = box->first[2]; z < box->end[2]; z++)
        for (int y = box->first[1]; y < box->end[1]; y++)
            for (int x = box->first[0]; x < box->end[0]; x++, range++) {
                const int brick[3] = {x, y, z};
                int first[3], end[3], origin[3], tiles[3];
                if (!(range->lo < 50 && 50 <= range->hi)) continue;
                for (int i = 0; i < 3; i++) {
                    first[i] = brick[i] ? 16 * brick[i] - 1 : 0;
                    end[i] = 16 * brick[i] + 18 < v->dims[i] ? 16 * brick[i] + 18 : v->dims[i];
                    origin[i] = 16 * visit->chunk->origin[i];
                    tiles[i] = (v->dims[i] - 1) / v->tile[i] + 1;
                }
                expect_voxels(v, visit->grid, first, end, origin);
                for (int k = first[2] / v->tile[2]; k <= (end[2] - 1) / v->tile[2]; k++)
                    for (int j = first[1] / v->tile[1]; j <= (end[1] - 1) / v->tile[1]; j++)
                        for (int i = first[0] / v->tile[0]; i <= (end[0] - 1) / v->tile[0]; i++)
                            check->touched[(k * tiles[1] + j) * tiles[0] + i] = true;
            }
    return ISO_OK;
}

/* Walks through chunks read each tile once, with a cache that does not hold them all; walks that know which
 * bricks the surface crosses read no other tiles than these need, some of them again. */
static void test_walks(void **state) {
    static const int volumes[][2][3] = {{{240, 200, 230}, {32, 32, 32}},
                                        {{230, 190, 210}, {48, 32, 64}},
                                        {{200, 230, 170}, {40, 25, 50}},
                                        {{250, 170, 190}, {64, 64, 64}}};
    (void)state;
    for (int i = 0; i < 4; i++)
        for (int threads = 1; threads <= 3; threads += 2) {
            made_volume v = {.type = ISO_UINT8, .ball = 40};
            memcpy(v.dims, volumes[i][0], sizeof v.dims);
            memcpy(v.tile, volumes[i][1], sizeof v.tile);
            iso_pool *pool = pool_of(threads);
            iso_rgrid *grid = make_tiled_grid(&v, 14 << 20);
            const iso_chunk_source source = iso_tiled_source(grid);
            const iso_chunk_walk_opts opts = {.source = &source, .isovalue = 50, .side = 64, .pool = pool};
            walk_check check = {.volume = &v};
            iso_chunk_walk *walk = NULL;
            int tiles = 1, touched = 0;
            for (int axis = 0; axis < 3; axis++) tiles *= (v.dims[axis] - 1) / v.tile[axis] + 1;
            assert_int_equal(iso_chunk_walk_create(&opts, &walk, NULL), ISO_OK);
            assert_int_equal(iso_chunk_walk_visit(walk, (iso_chunk_share){1, 1}, check_bricks, &check, NULL),
                             ISO_OK);
            assert_int_equal(atomic_load(&v.reads), tiles);
            assert_int_equal(iso_chunk_walk_visit(walk, (iso_chunk_share){1, 1}, check_bricks, &check, NULL),
                             ISO_OK);
            for (int t = 0; t < tiles; t++) touched += check.touched[t];
            const int again = atomic_load(&v.reads) - tiles;
            if (!(again * 10 <= touched * 12 && touched < tiles))
                fail_msg("volume %d: %d tiles, %d touched, %d read again", i, tiles, touched, again);
            assert_int_equal(iso_chunk_walk_stats(walk).bytes_decoded,
                             (tiles + again) * v.tile[0] * v.tile[1] * v.tile[2]);
            iso_chunk_walk_destroy(walk);
            iso_rgrid_destroy(grid);
            iso_pool_destroy(pool);
        }
}

/* Chunks of all cuts make up the volume, none is empty, and where tiles are not larger than chunks each but
 * the last ends less than a brick before the last voxel that needs no further tile. */
static void test_cuts(void **state) {
    (void)state;
    for (int tile = 0; tile <= 150; tile += tile < 40 ? 1 : 11)
        for (int in_tile = 0; in_tile < (tile ? tile : 1); in_tile += 1 + tile / 7)
            for (int side = 16; side <= 128; side *= 2)
                for (int dim = 1; dim < 400; dim += 37) {
                    const iso_chunk_source source = {
                        .dims = {dim, 1, 1}, .tile = {tile, tile, tile}, .in_tile = {in_tile, 0, 0}};
                    iso_chunk_cuts cuts;
                    iso_chunk_cuts_make(&source, side, &cuts);
                    assert_int_equal(iso_chunk_cut(&cuts, 0, 0), 0);
                    assert_int_equal(iso_chunk_cut(&cuts, 0, cuts.counts[0]), (dim - 1) / 16 + 1);
                    for (int n = 0; n < cuts.counts[0]; n++) {
                        const int first = iso_chunk_cut(&cuts, 0, n), end = iso_chunk_cut(&cuts, 0, n + 1);
                        assert_in_range(end - first, 1, cuts.most[0]);
                        for (int b = first; b < end; b++) assert_int_equal(iso_chunk_with(&cuts, 0, b), n);
                        if (!tile || tile > side || n + 1 == cuts.counts[0]) continue;
                        const int needs = 16 * end + ISO_CHUNK_ABOVE, left = (needs + in_tile) % tile;
                        assert_in_range(left ? tile - left : 0, 0, 15);
                    }
                }
}

static void test_absent_chunks(void **state) {
    (void)state;
    made_volume v = make_volume(0, ISO_UINT8);
    v.absent_from = 2;
    iso_rgrid *grid = make_tiled_grid(&v, 1 << 20);
    const iso_chunk_source source = iso_tiled_source(grid);
    for (int z = 0; z < 4; z++) {
        const iso_brick_box box = {{0, 0, z}, {1, 2, z + 1}};
        iso_grid_chunk chunk;
        float value = 0;
        assert_true(iso_grid_chunk_make(source.dims, &source.transform, &box, &chunk));
        /* the voxels below layer 2 of bricks are not absent */
        assert_int_equal(source.is_constant(source.context, &chunk, &value), z == 3);
        if (z == 3) assert_true(value == ABSENT_VALUE);
    }
    assert_int_equal(atomic_load(&v.reads), 0);
    iso_rgrid_destroy(grid);
}

static void test_failing_chunk(void **state) {
    (void)state;
    made_volume v = make_volume(0, ISO_UINT8);
    v.failing_from = 21;
    iso_rgrid *grid = make_tiled_grid(&v, 1 << 20);
    const iso_chunk_source source = iso_tiled_source(grid);
    iso_error error = {0};
    size_t count;
    iso_pool *pool = pool_of(3);
    assert_int_equal(iso_chunk_source_count_nonfinite(&source, 64, pool, &count, &error), ISO_ERR_IO);
    assert_string_equal(error.text, "made.file, tile 21: damaged");
    iso_pool_destroy(pool);
    iso_rgrid_destroy(grid);
}

/* ---- values */

static void test_histograms(void **state) {
    (void)state;
    for (int shape = 0; shape < SHAPES; shape++)
        for (int type = ISO_UINT8; type <= ISO_FLOAT32; type++) {
            made_volume v = make_volume(shape, (iso_type)type);
            const iso_volume_opts opts = {.pool = pool_of(2)};
            iso_grid whole = read_whole(&v, &opts);
            iso_rgrid *tiles = make_tiled_grid(&v, 1 << 16);
            const iso_chunk_source source = iso_tiled_source(tiles);
            const iso_ranks alone = {.size = 1};
            iso_histogram wanted, got;
            size_t nonfinite;
            memset(&wanted, 0, sizeof wanted);
            memset(&got, 0, sizeof got);
            assert_int_equal(iso_histogram_compute(&whole, opts.pool, &wanted, NULL), ISO_OK);
            assert_int_equal(iso_histogram_of_source(&source, 32, &alone, opts.pool, &got, NULL), ISO_OK);
            assert_memory_equal(&got, &wanted, sizeof got);
            assert_int_equal(iso_chunk_source_count_nonfinite(&source, 32, opts.pool, &nonfinite, NULL),
                             ISO_OK);
            assert_int_equal(nonfinite, iso_grid_count_nonfinite(&whole, NULL));
            iso_rgrid_destroy(tiles);
            iso_grid_destroy(&whole);
            iso_pool_destroy(opts.pool);
        }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_whole),         cmocka_unit_test(test_first_failure),
        cmocka_unit_test(test_cancelled),     cmocka_unit_test(test_chunks),
        cmocka_unit_test(test_cropped),       cmocka_unit_test(test_cache_saves_reading),
        cmocka_unit_test(test_absent_chunks), cmocka_unit_test(test_failing_chunk),
        cmocka_unit_test(test_walks),         cmocka_unit_test(test_cuts),
        cmocka_unit_test(test_histograms)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
