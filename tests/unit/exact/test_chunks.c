/* chunks: pictures drawn chunk by chunk into key images are the bytes of the whole picture, for every
 * partition, order and number of key images. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/cpu.h"
#include "check_support.h"
#include "exact_support.h"
#include "extract_support.h"
#include "grids/grid_chunk.h"
#include "render/view/key_image.h"
#include "view_support.h"

enum { MOST_CHUNKS = 64, SIZE = 96 };

static const iso_rgb colors[] = {{0xD9, 0xB3, 0x6C}};

/* What is drawn: one surface in one view. */
typedef struct subject {
    const iso_grid *grid;
    double isovalue;
    const iso_view *view;
    iso_pool *pool;
    iso_shading shading;
} subject;

static iso_image paint_whole(const subject *s, size_t *covered) {
    iso_image image = {0};
    iso_exact *exact = make_exact(s->grid, s->isovalue, s->pool);
    const iso_exact_picture picture = {s->view, &s->shading, &image, s->pool, NULL, 1};
    assert_int_equal(iso_image_create(s->view->width, s->view->height, &image, NULL), ISO_OK);
    assert_int_equal(iso_paint_exact(&picture, exact, covered, NULL), ISO_OK);
    iso_exact_destroy(exact);
    return image;
}

/* ---- partitions of a whole into boxes of bricks */

typedef struct partition {
    iso_brick_box box[MOST_CHUNKS];
    int count;
} partition;

/* Cuts random boxes in two until there are `count` (fewer, if all boxes are single bricks). */
static void cut_bricks(const iso_grid *grid, int count, test_random *random, partition *p) {
    *p = (partition){.count = 1};
    iso_grid_bricks(grid, p->box[0].end);
    for (int tries = 0; tries < 20 * count && p->count < count; tries++) {
        iso_brick_box *box = &p->box[test_random_int(random, 0, p->count - 1)];
        const int axis = test_random_int(random, 0, 2), length = box->end[axis] - box->first[axis];
        if (length < 2) continue;
        const int at = box->first[axis] + test_random_int(random, 1, length - 1);
        p->box[p->count] = *box;
        p->box[p->count++].first[axis] = at;
        box->end[axis] = at;
    }
}

/* ---- chunks */

/* A copy of the voxels that a chunk needs, and of nothing else: all other voxels of its grid are noise. */
static iso_rgrid *copy_chunk(const iso_rgrid *whole, const iso_grid_chunk *chunk, test_random *random) {
    iso_rgrid *grid = NULL;
    int first[3], end[3];
    const iso_rgrid_desc desc = {.dims = {chunk->size[0], chunk->size[1], chunk->size[2]},
                                 .type = whole->type,
                                 .scale = whole->scale,
                                 .offset = whole->offset,
                                 .level_set = whole->level_set};
    assert_int_equal(iso_rgrid_create(&desc, &grid, NULL), ISO_OK);
    const iso_grid handle = {.rgrid = grid};
    test_fill(&handle, TEST_NOISE, random);
    iso_grid_chunk_voxels(chunk, first, end);
    const size_t bytes = iso_type_size(whole->type), row = (size_t)(end[0] - first[0]) * bytes;
    for (int z = first[2]; z < end[2]; z++)
        for (int y = first[1]; y < end[1]; y++) {
            const ptrdiff_t from = first[0] + y * whole->stride_y + z * whole->stride_z;
            const ptrdiff_t to = first[0] - ISO_BRICK * chunk->origin[0] +
                                 (y - ISO_BRICK * chunk->origin[1]) * grid->stride_y +
                                 (z - ISO_BRICK * chunk->origin[2]) * grid->stride_z;
            memcpy((char *)grid->data + to * (ptrdiff_t)bytes,
                   (const char *)whole->data + from * (ptrdiff_t)bytes, row);
        }
    return grid;
}

/* Extracts and draws one chunk; adds its box in the world to `bounds`. */
static void draw_chunk(const subject *s, const iso_brick_box *box, bool copied, iso_key_image *keys,
                       iso_box *bounds) {
    static test_random random = {99};
    const iso_rgrid *whole = s->grid->rgrid;
    iso_grid_chunk chunk;
    iso_grid grid = {0};
    iso_exact *exact = NULL;
    assert_true(iso_grid_chunk_make(whole->dims, &whole->transform, box, &chunk));
    if (copied)
        grid.rgrid = copy_chunk(whole, &chunk, &random);
    else
        assert_int_equal(iso_grid_chunk_view(whole, &chunk, &grid.rgrid, NULL), ISO_OK);
    const iso_exact_opts opts = {.isovalue = s->isovalue, .pool = s->pool, .chunk = &chunk};
    assert_int_equal(iso_exact_create(&grid, &opts, &exact, NULL), ISO_OK);
    assert_int_equal(iso_exact_update(exact, NULL), ISO_OK);
    const iso_exact_key_picture picture = {s->view, s->shading.colors[0], keys, s->pool, NULL};
    assert_int_equal(iso_draw_exact_keys(&picture, exact, NULL), ISO_OK);
    const iso_affine affine = iso_transform_affine(&whole->transform);
    const iso_box own = iso_exact_bounds(exact, &affine);
    if (own.lo.x <= own.hi.x) {
        iso_box_add(bounds, own.lo);
        iso_box_add(bounds, own.hi);
    }
    iso_exact_destroy(exact);
    iso_grid_destroy(&grid);
}

/* Draws all chunks in random order into `parts` key images, and merges these in random order. */
static iso_image paint_chunks(const subject *s, const partition *p, int parts, test_random *random,
                              iso_box *bounds, size_t *covered) {
    iso_key_image keys[8];
    int order[MOST_CHUNKS];
    iso_image image = {0};
    *bounds = iso_box_empty();
    for (int i = 0; i < parts; i++)
        assert_int_equal(iso_key_image_allocate(s->view->width, s->view->height, &keys[i], NULL), ISO_OK);
    for (int i = 0; i < p->count; i++) {
        const int j = test_random_int(random, 0, i);
        order[i] = order[j];
        order[j] = i;
    }
    for (int i = 0; i < p->count; i++)
        draw_chunk(s, &p->box[order[i]], i % 2, &keys[test_random_int(random, 0, parts - 1)], bounds);
    const int first = test_random_int(random, 0, parts - 1);
    for (int i = 0; i < parts; i++)
        if (i != first) iso_key_image_minimum(&keys[first], &keys[i], s->pool);
    assert_int_equal(iso_image_create(s->view->width, s->view->height, &image, NULL), ISO_OK);
    *covered = iso_key_image_paint(&keys[first], iso_shading_empty(&s->shading), &image, s->pool);
    for (int i = 0; i < parts; i++) iso_key_image_free(&keys[i]);
    return image;
}

static void check_same(const subject *s, int chunks, int parts, test_random *random) {
    size_t covered = 0, covered_by_chunks = 0;
    partition p;
    iso_box bounds, whole_bounds;
    cut_bricks(s->grid, chunks, random, &p);
    iso_image whole = paint_whole(s, &covered);
    iso_image image = paint_chunks(s, &p, parts, random, &bounds, &covered_by_chunks);
    assert_int_equal(covered, covered_by_chunks);
    assert_memory_equal(whole.rgba, image.rgba, (size_t)whole.width * (size_t)whole.height * 4);
    iso_exact *exact = make_exact(s->grid, s->isovalue, s->pool);
    const iso_affine affine = iso_transform_affine(&s->grid->rgrid->transform);
    whole_bounds = iso_exact_bounds(exact, &affine);
    assert_memory_equal(&whole_bounds, &bounds, sizeof bounds);
    iso_exact_destroy(exact);
    iso_image_free(&whole);
    iso_image_free(&image);
}

static const iso_type types[] = {ISO_UINT8, ISO_INT16, ISO_UINT16, ISO_FLOAT32};
static const int part_counts[] = {1, 2, 3, 5, 8};

/* Random grids of every type, transform, pattern and kind of view. */
static void random_grids(void **state) {
    (void)state;
    test_random random = {11};
    iso_pool *pool = NULL;
    assert_int_equal(iso_pool_create(3, &pool, NULL), ISO_OK);
    for (int round = 0; round < 5 * TEST_TRANSFORMS * TEST_VIEWS; round++) {
        int dims[3];
        test_random_dims(&random, 3, 70, dims);
        iso_grid grid = test_rgrid(dims, types[round % 4]);
        test_set_transform(&grid, round % TEST_TRANSFORMS);
        grid.rgrid->level_set = round % 3 == 0;
        test_fill(&grid, (test_pattern)(round % 3), &random);
        const iso_view view =
            test_view_make(&grid, (test_view)(round / 3 % TEST_VIEWS), SIZE, test_random_direction(&random));
        const subject s = {&grid,
                           round % 3 == TEST_SMOOTH ? 100.3 : 100,
                           &view,
                           round % 2 ? pool : NULL,
                           {colors, 1, {10, 20, 30}, round % 5 == 0, {0, 0, 0}}};
        check_same(&s, test_random_int(&random, 1, MOST_CHUNKS), part_counts[round % 5], &random);
        iso_grid_destroy(&grid);
    }
    iso_pool_destroy(pool);
}

/* Large cells: outlined ones, cells next to the eye. */
static void large_cells(void **state) {
    (void)state;
    test_random random = {12};
    for (int round = 0; round < 6 * TEST_VIEWS; round++) {
        iso_grid grid = test_rgrid((const int[3]){33, 20, 18}, types[round % 4]);
        test_fill(&grid, TEST_SMOOTH, &random);
        const iso_view view =
            test_view_make(&grid, (test_view)(round % TEST_VIEWS), 900, test_random_direction(&random));
        const subject s = {&grid, 100.3, &view, NULL, {colors, 1, {0, 0, 0}, 0, {0, 0, 0}}};
        check_same(&s, 8, 2, &random);
        iso_grid_destroy(&grid);
    }
}

/* Voxels that are not finite, also in halos. */
static void voxels_that_are_not_finite(void **state) {
    (void)state;
    test_random random = {13};
    for (int round = 0; round < 2 * TEST_VIEWS; round++) {
        iso_grid grid = test_rgrid((const int[3]){50, 34, 49}, ISO_FLOAT32);
        test_fill(&grid, TEST_NOISE, &random);
        float *values = grid.rgrid->data;
        static const float bad[] = {NAN, INFINITY, -INFINITY};
        for (int i = 0; i < 3000; i++) values[test_random_int(&random, 0, 50 * 34 * 49 - 1)] = bad[i % 3];
        const iso_view view =
            test_view_make(&grid, (test_view)(round % TEST_VIEWS), SIZE, test_random_direction(&random));
        const subject s = {&grid, 140, &view, NULL, {colors, 1, {0, 0, 0}, 0, {0, 0, 0}}};
        check_same(&s, 30, 3, &random);
        iso_grid_destroy(&grid);
    }
}

/* A chunk whose bricks the whole does not have is none; boxes are clipped. */
static void boxes_are_clipped(void **state) {
    (void)state;
    const int dims[3] = {40, 16, 17};
    const iso_transform transform = iso_transform_identity();
    iso_grid_chunk chunk;
    int first[3], end[3];
    const iso_brick_box beyond = {{3, 0, 0}, {4, 1, 1}}, around = {{-2, -1, 1}, {2, 9, 9}};
    assert_false(iso_grid_chunk_make(dims, &transform, &beyond, &chunk));
    assert_true(iso_grid_chunk_make(dims, &transform, &around, &chunk));
    iso_grid_chunk_voxels(&chunk, first, end);
    assert_int_equal(first[0], 0);
    assert_int_equal(end[0], 34);
    assert_int_equal(first[1], 0);
    assert_int_equal(end[1], 16);
    assert_int_equal(first[2], 15);
    assert_int_equal(end[2], 17);
    assert_int_equal(chunk.size[2], 17);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(random_grids),
        cmocka_unit_test(large_cells),
        cmocka_unit_test(voxels_that_are_not_finite),
        cmocka_unit_test(boxes_are_clipped),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
