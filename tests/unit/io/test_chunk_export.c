/* Points and meshes that are written chunk by chunk are those of the whole volume, byte for byte, whatever
 * the size of the chunks: with left-handed transforms, far from 0, beside voxels that are no numbers, and
 * where voxels have exactly the isovalue. */
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
#include "extract_support.h"
#include "io/chunk_export.h"
#include "io/mesh/mesh_write.h"
#include "io/points_write.h"

#define WHOLE ISO_TEST_TMP "/test_chunk_export_whole.ply"
#define CHUNKS ISO_TEST_TMP "/test_chunk_export.ply"

static const int sides[] = {16, 32, 48, 200};
static const iso_type types[] = {ISO_UINT8, ISO_INT16, ISO_UINT16, ISO_FLOAT32};

static void set_transform(iso_rgrid *grid, int kind) {
    iso_transform t = iso_transform_identity();
    t.spacing[0] = 0.7;
    t.spacing[2] = 1.3;
    if (kind == 1) t.direction[0] = -1; /* left-handed */
    if (kind == 2) t.origin[1] = 3e6;   /* coordinates become doubles */
    grid->transform = t;
}

static iso_grid make_volume(int round, test_random *random) {
    int dims[3];
    test_random_dims(random, 20, 75, dims);
    if (round % 7 == 6) dims[round % 3] = 1;
    iso_grid grid = test_rgrid(dims, types[round % 4]);
    test_fill(&grid, (test_pattern)(round % 3), random);
    if (round % 4 == 3) /* a float volume */
        for (int i = 0; i < 40; i++)
            test_set(&grid, test_random_int(random, 0, dims[0] - 1), test_random_int(random, 0, dims[1] - 1),
                     test_random_int(random, 0, dims[2] - 1), i % 2 ? NAN : INFINITY);
    set_transform(grid.rgrid, round % 5);
    return grid;
}

static void write_whole_points(const iso_grid *grid) {
    const iso_points_opts opts = {.isovalue = 100, .primitive = ISO_PRIMITIVE_EDGE, .floats = true};
    iso_point_set *points = NULL;
    assert_int_equal(iso_point_set_create(grid, &opts, &points, NULL), ISO_OK);
    assert_int_equal(iso_point_set_update(points, NULL), ISO_OK);
    const iso_point_view view = iso_point_set_view(points);
    assert_int_equal(iso_points_write_ply(WHOLE, &view, "a comment", NULL), ISO_OK);
    iso_point_set_destroy(points);
}

static void write_whole_mesh(const iso_grid *grid) {
    const iso_mesh_opts opts = {.isovalue = 100};
    iso_mesh_set *mesh = NULL;
    assert_int_equal(iso_mesh_set_create(grid, &opts, &mesh, NULL), ISO_OK);
    assert_int_equal(iso_mesh_set_update(mesh, NULL), ISO_OK);
    const iso_mesh_view view = iso_mesh_set_view(mesh);
    assert_int_equal(iso_mesh_write(WHOLE, &view, "a comment", NULL), ISO_OK);
    iso_mesh_set_destroy(mesh);
}

static void check_same_bytes(void) {
    FILE *whole = fopen(WHOLE, "rb"), *chunks = fopen(CHUNKS, "rb");
    static unsigned char a[1 << 16], b[1 << 16];
    size_t count;
    assert_true(whole && chunks);
    do {
        count = fread(a, 1, sizeof a, whole);
        assert_int_equal(fread(b, 1, sizeof b, chunks), count);
        assert_memory_equal(a, b, count);
    } while (count);
    fclose(whole);
    fclose(chunks);
}

static void files_are_those_of_the_whole(void **state) {
    (void)state;
    test_random random = {77};
    iso_pool *pool = NULL;
    assert_int_equal(iso_pool_create(3, &pool, NULL), ISO_OK);
    uint64_t points = 0, triangles = 0;
    for (int round = 0; round < 40; round++) {
        iso_grid grid = make_volume(round, &random);
        const iso_chunk_source source = iso_chunk_source_of(grid.rgrid);
        const iso_chunk_walk_opts opts = {
            .source = &source, .isovalue = 100, .side = sides[round % 4], .pool = round % 2 ? pool : NULL};
        iso_chunk_walk *walk = NULL;
        iso_chunk_exported exported;
        assert_int_equal(iso_chunk_walk_create(&opts, &walk, NULL), ISO_OK);
        write_whole_points(&grid);
        const iso_cpu_level level = iso_cpu_best();
        iso_cpu_limit((iso_cpu_level)(round % ISO_CPU_LEVELS));
        assert_int_equal(iso_chunk_export_points(walk, CHUNKS, "a comment", &exported, NULL), ISO_OK);
        iso_cpu_limit(level);
        check_same_bytes();
        points += exported.points;
        write_whole_mesh(&grid);
        assert_int_equal(iso_chunk_export_mesh(walk, CHUNKS, "a comment", &exported, NULL), ISO_OK);
        check_same_bytes();
        triangles += exported.triangles;
        iso_chunk_walk_destroy(walk);
        iso_grid_destroy(&grid);
    }
    assert_true(points > 100000 && triangles > 100000);
    iso_pool_destroy(pool);
}

/* A full disk, and a folder that is not there. */
static void failures_are_said(void **state) {
    (void)state;
    test_random random = {3};
    iso_grid grid = test_rgrid((const int[3]){40, 50, 60}, ISO_UINT8);
    test_fill(&grid, TEST_SMOOTH, &random);
    const iso_chunk_source source = iso_chunk_source_of(grid.rgrid);
    const iso_chunk_walk_opts opts = {.source = &source, .isovalue = 100, .side = 32};
    iso_chunk_walk *walk = NULL;
    iso_chunk_exported exported;
    iso_error error = {0};
    assert_int_equal(iso_chunk_walk_create(&opts, &walk, NULL), ISO_OK);
    assert_int_equal(iso_chunk_export_points(walk, "/dev/full", NULL, &exported, &error), ISO_ERR_WRITE);
    assert_int_equal(iso_chunk_export_mesh(walk, "/dev/full", NULL, &exported, &error), ISO_ERR_WRITE);
    assert_int_equal(iso_chunk_export_mesh(walk, ISO_TEST_TMP "/none/a.ply", NULL, &exported, &error),
                     ISO_ERR_WRITE);
    iso_chunk_walk_destroy(walk);
    iso_grid_destroy(&grid);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(files_are_those_of_the_whole),
        cmocka_unit_test(failures_are_said),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
