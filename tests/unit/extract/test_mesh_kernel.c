/* mesh_kernel: every instruction set gives the bytes of the plain Marching Cubes, brick by brick, from whole
 * grids and from windows, and reads nothing outside the grid. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <sys/mman.h>
#include <unistd.h>

#include <cmocka.h>

#include "extract/mesh/mesh_run.h"
#include "extract_support.h"

static const iso_type all_types[] = {ISO_UINT8, ISO_INT16, ISO_UINT16, ISO_FLOAT32};

/* A grid whose voxels end (or begin) at a page that must not be read. */
typedef struct guarded {
    iso_grid grid;
    char *map;
    size_t bytes;
} guarded;

static guarded guarded_grid(const int dims[3], iso_type type, bool at_end) {
    size_t page = (size_t)sysconf(_SC_PAGESIZE),
           bytes = (size_t)dims[0] * (size_t)dims[1] * (size_t)dims[2] * iso_type_size(type);
    size_t inner = (bytes + page - 1) / page * page;
    guarded made = {.bytes = inner + 2 * page};
    made.map = mmap(NULL, made.bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    assert_ptr_not_equal(made.map, MAP_FAILED);
    assert_int_equal(mprotect(made.map, page, PROT_NONE), 0);
    assert_int_equal(mprotect(made.map + page + inner, page, PROT_NONE), 0);
    const iso_rgrid_desc desc = {.dims = {dims[0], dims[1], dims[2]},
                                 .type = type,
                                 .data = made.map + page + (at_end ? inner - bytes : 0)};
    assert_int_equal(iso_rgrid_create(&desc, &made.grid.rgrid, NULL), ISO_OK);
    return made;
}

static void guarded_destroy(guarded *grid) {
    iso_grid_destroy(&grid->grid);
    munmap(grid->map, grid->bytes);
}

typedef struct bench_of_tests {
    iso_brick_window window;
    iso_brick_mesh plain, made[ISO_EDGE_BRICKS];
    iso_edge_words words;
    iso_mesh_block block;
    char window_scratch[1 << 18];
} bench_of_tests;

static void same_bytes(const void *a, const void *b, size_t bytes) {
    if (bytes) assert_memory_equal(a, b, bytes);
}

static void same_meshes(const iso_brick_mesh *a, const iso_brick_mesh *b) {
    assert_int_equal(a->owned_count, b->owned_count);
    assert_int_equal(a->vertex_count, b->vertex_count);
    assert_int_equal(a->triangle_count, b->triangle_count);
    same_bytes(a->keys, b->keys, a->vertex_count * sizeof *a->keys);
    same_bytes(a->vertices, b->vertices, a->vertex_count * sizeof *a->vertices);
    same_bytes(a->triangles, b->triangles, a->triangle_count * sizeof *a->triangles);
}

/* The wanted bricks of a block, by the kernel into bench->made. */
static void make_block(const iso_mesh_context *context, int number, bench_of_tests *bench) {
    iso_mesh_block *block = &bench->block;
    iso_mesh_output output = {0};
    for (int k = 0; k < ISO_EDGE_BRICKS; k++) {
        output.vertices[k] = bench->made[k].vertices;
        output.keys[k] = bench->made[k].keys;
        output.triangles[k] = bench->made[k].triangles;
    }
    context->kernel->list_block(&context->source, &bench->words, number, block);
    iso_mesh_kernel_build(context->kernel, context->edges, &context->source, block, &output);
    for (int k = 0; k < ISO_EDGE_BRICKS; k++) {
        bench->made[k].owned_count = block->own[k];
        bench->made[k].vertex_count = block->own[k] + block->far[k];
        bench->made[k].triangle_count = block->triangles[k];
    }
}

static void check_block(const iso_grid *grid, const iso_mesh_context *context, int number,
                        bench_of_tests *bench, size_t *triangles) {
    int bricks[3];
    iso_grid_bricks(grid, bricks);
    make_block(context, number, bench);
    for (int k = 0; k < ISO_EDGE_BRICKS; k++) {
        const int *origin = bench->block.origin;
        const int brick[3] = {origin[0] / ISO_BRICK + k, origin[1] / ISO_BRICK, origin[2] / ISO_BRICK};
        if (!(bench->block.bricks >> k & 1)) {
            assert_int_equal(bench->made[k].vertex_count + bench->made[k].triangle_count, 0);
            continue;
        }
        if (brick[0] >= bricks[0]) continue;
        iso_brick_window_fill(grid, brick, &bench->window);
        iso_marching_cubes(&bench->window, &context->surface, &bench->plain);
        same_meshes(&bench->made[k], &bench->plain);
        *triangles += bench->plain.triangle_count;
        iso_mesh_run_window(context, &bench->window, bench->window_scratch, &bench->made[k]);
        same_meshes(&bench->made[k], &bench->plain);
    }
}

/* All blocks of a grid at one instruction set, `wanted` bricks of each. */
static size_t check_grid(const iso_grid *grid, double isovalue, iso_cpu_level level, unsigned wanted,
                         bench_of_tests *bench) {
    const iso_threshold surface = iso_threshold_of(grid, isovalue);
    iso_mesh_context context;
    iso_mesh_context_init(&context, grid, &surface);
    context.kernel = iso_mesh_kernel_get(level);
    context.edges = iso_edge_kernel_get(grid->rgrid->type, level);
    context.window_edges = iso_edge_kernel_get(ISO_FLOAT32, level);
    assert_true(iso_mesh_run_scratch_bytes() <= sizeof bench->window_scratch);
    size_t triangles = 0;
    const int *dims = grid->rgrid->dims;
    for (int z = 0; z < dims[2]; z += ISO_BRICK)
        for (int y = 0; y < dims[1]; y += ISO_BRICK) {
            const int origin[3] = {0, y, z};
            bench->words.blocks = (dims[0] + ISO_EDGE_BLOCK_X - 1) / ISO_EDGE_BLOCK_X;
            for (int b = 0; b < bench->words.blocks; b++) bench->words.active[b] = ISO_EDGE_WHOLE;
            context.edges->classify_voxels(&context.source, origin, &bench->words);
            for (int b = 0; b < bench->words.blocks; b++) {
                memcpy(bench->block.origin, (int[3]){b * ISO_EDGE_BLOCK_X, y, z}, sizeof(int[3]));
                bench->block.bricks = wanted;
                check_block(grid, &context, b, bench, &triangles);
            }
        }
    return triangles;
}

static void random_grid_is_the_same(test_random *random, int round, bench_of_tests *bench,
                                    size_t *triangles) {
    int dims[3];
    test_random_dims(random, 1, round % 5 ? 20 : 40, dims);
    if (round % 3) dims[0] = test_random_int(random, 1, 150);
    for (int axis = 0; axis < 3; axis++) /* the sizes around a brick's and a block's end */
        if (test_random_int(random, 0, 3) == 0)
            dims[axis] = (axis ? 16 : 16 * test_random_int(random, 1, 5)) + test_random_int(random, -1, 2);
    guarded grid = guarded_grid(dims, all_types[round % 4], round / 4 % 2);
    test_fill(&grid.grid, (test_pattern)(round / 4 % 3), random);
    grid.grid.rgrid->level_set = round / 2 % 2;
    const double isovalues[] = {100, 100.1, 75, 112.3456789};
    for (int level = 0; level <= (int)iso_cpu_supported(); level++)
        *triangles += check_grid(&grid.grid, isovalues[round / 8 % 4], (iso_cpu_level)level,
                                 round % 7 ? 15 : 1 + (unsigned)round / 7 % 15, bench);
    guarded_destroy(&grid);
}

static void every_variant_gives_the_plain_bytes(void **state) {
    (void)state;
    test_random random = {1};
    bench_of_tests *bench = malloc(sizeof *bench);
    size_t triangles = 0;
    for (int round = 0; round < 320; round++) random_grid_is_the_same(&random, round, bench, &triangles);
    assert_true(triangles > 100000);
    free(bench);
}

/* Floats of any size: gradients whose squares or inverses leave the range of floats. */
static void magnitudes_make_no_difference(void **state) {
    (void)state;
    test_random random = {2};
    bench_of_tests *bench = malloc(sizeof *bench);
    const float scales[] = {0x1p-149f, 0x1p-140f, 0x1p-126f, 0x1p-80f, 0x1p60f, 0x1p90f};
    for (int i = 0; i < 6; i++) {
        iso_grid grid = test_rgrid((int[3]){37, 18, 17}, ISO_FLOAT32);
        for (int v = 0; v < 37 * 18 * 17; v++)
            ((float *)grid.rgrid->data)[v] = scales[i] * (float)test_random_int(&random, -7, 7);
        for (int level = 0; level <= (int)iso_cpu_supported(); level++)
            assert_true(check_grid(&grid, 0.3 * scales[i], (iso_cpu_level)level, 15, bench) > 1000);
        iso_grid_destroy(&grid);
    }
    free(bench);
}

/* What a set makes of voxels that are not finite, where plain bricks and the kernel's lie side by side. */
static void plain_bricks_fit_the_others(void **state) {
    (void)state;
    test_random random = {3};
    bench_of_tests *bench = malloc(sizeof *bench);
    for (int round = 0; round < 20; round++) {
        iso_grid grid = test_rgrid((int[3]){90, 50, 34}, ISO_FLOAT32);
        test_fill(&grid, TEST_SMOOTH, &random);
        for (int i = 0; i < 3; i++)
            test_set(&grid, test_random_int(&random, 0, 89), test_random_int(&random, 0, 49),
                     test_random_int(&random, 0, 33),
                     i == 0   ? NAN
                     : i == 1 ? INFINITY
                              : -1e35);
        iso_mesh_set *set = NULL;
        assert_int_equal(iso_mesh_set_create(&grid, &(iso_mesh_opts){.isovalue = 100.1}, &set, NULL), ISO_OK);
        assert_int_equal(iso_mesh_set_update(set, NULL), ISO_OK);
        iso_mesh_view view = iso_mesh_set_view(set);
        const iso_threshold surface = iso_threshold_of(&grid, 100.1);
        assert_true(view.span_count > 20);
        for (size_t s = 0; s < view.span_count; s++) {
            const iso_mesh_span *span = &view.spans[s];
            iso_brick_window_fill(&grid, span->brick, &bench->window);
            iso_marching_cubes(&bench->window, &surface, &bench->plain);
            assert_int_equal(span->vertex_count, bench->plain.vertex_count);
            assert_int_equal(span->owned_count, bench->plain.owned_count);
            assert_int_equal(span->triangle_count, bench->plain.triangle_count);
            same_bytes(view.vertices + span->first_vertex, bench->plain.vertices,
                       span->vertex_count * sizeof(iso_surfel));
            same_bytes(view.triangles + span->first_triangle, bench->plain.triangles,
                       span->triangle_count * sizeof(uint16_t[3]));
        }
        iso_mesh_set_destroy(set);
        iso_grid_destroy(&grid);
    }
    free(bench);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_variant_gives_the_plain_bytes),
        cmocka_unit_test(magnitudes_make_no_difference),
        cmocka_unit_test(plain_bricks_fit_the_others),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
