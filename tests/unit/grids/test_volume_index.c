/* volume_index and block_ranges: ranges of bricks become those of blocks, are kept in a file, and a file
 * that is damaged or of another volume is not used. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "check_support.h"
#include "grids/volume_index.h"

static const iso_volume_identity identity = {
    .files = 77, .dims = {150, 70, 61}, .type = ISO_INT16, .scale = 1};
static char path[256];

static void make_index(iso_volume_index *index) {
    assert_int_equal(iso_volume_index_create(&identity, index, NULL), ISO_OK);
}

/* The range of a brick: made from its number; some have none. */
static iso_brick_range range_of(int x, int y, int z) {
    const int number = x + 31 * y + 57 * z;
    if (number % 11 == 0) return (iso_brick_range){INFINITY, -INFINITY, false};
    return (iso_brick_range){(float)(number % 97), (float)(number % 97 + number % 13), number % 17 != 0};
}

static void add_box(iso_volume_index *index, const iso_brick_box *box) {
    iso_brick_range ranges[10 * 5 * 4], *next = ranges;
    for (int z = box->first[2]; z < box->end[2]; z++)
        for (int y = box->first[1]; y < box->end[1]; y++)
            for (int x = box->first[0]; x < box->end[0]; x++) *next++ = range_of(x, y, z);
    iso_block_ranges_add(&index->ranges, box, ranges);
}

/* Enters all bricks by boxes of 3 x 2 x 3 bricks, which blocks do not consist of. */
static void add_all(iso_volume_index *index) {
    for (int z = 0; z < 4; z += 3)
        for (int y = 0; y < 5; y += 2)
            for (int x = 0; x < 10; x += 3) {
                iso_brick_box box = {{x, y, z}, {x + 3, y + 2, z + 3}};
                const int bricks[3] = {10, 5, 4};
                for (int axis = 0; axis < 3; axis++)
                    if (box.end[axis] > bricks[axis]) box.end[axis] = bricks[axis];
                add_box(index, &box);
            }
}

/* The first brick of the block that has a brick, which lies `before` bricks before a multiple of 4, or 0. */
static int block_start(int brick, int before) {
    const int first = (brick + before) / 4 * 4 - before;
    return first > 0 ? first : 0;
}

static void check_ranges(const iso_block_ranges *ranges) {
    const int *before = ranges->before;
    assert_int_equal(ranges->unknown, 0);
    for (int x = 0; x < 10; x++)
        for (int y = 0; y < 5; y++) {
            /* the blocks that overlap bricks x .. x + 1, all y from `y` on, all z */
            const iso_brick_box box = {{x, y, 0}, {x < 9 ? x + 2 : 10, 5, 4}};
            iso_brick_range found, wanted = {INFINITY, -INFINITY, true};
            const int first = block_start(x, before[0]),
                      last = (box.end[0] - 1 + before[0]) / 4 * 4 - before[0] + 3;
            for (int k = 0; k < 4; k++)
                for (int j = block_start(y, before[1]); j < 5; j++)
                    for (int i = first; i <= last && i < 10; i++) {
                        const iso_brick_range one = range_of(i, j, k);
                        wanted.lo = fminf(wanted.lo, one.lo);
                        wanted.hi = fmaxf(wanted.hi, one.hi);
                        wanted.finite = wanted.finite && one.finite;
                    }
            assert_true(iso_block_ranges_of(ranges, &box, &found));
            assert_true(found.lo == wanted.lo && found.hi == wanted.hi && found.finite == wanted.finite);
        }
}

static void blocks_have_the_ranges_of_their_bricks(void **state) {
    (void)state;
    iso_volume_index index;
    iso_brick_range range;
    const iso_brick_box some = {{0, 0, 0}, {4, 4, 4}}, rest = {{0, 0, 0}, {5, 4, 4}};
    make_index(&index);
    assert_false(iso_block_ranges_of(&index.ranges, &some, &range));
    add_box(&index, &some);
    assert_true(iso_block_ranges_of(&index.ranges, &some, &range));
    assert_false(iso_block_ranges_of(&index.ranges, &rest, &range));
    iso_volume_index_free(&index);
    make_index(&index);
    add_all(&index);
    check_ranges(&index.ranges);
    iso_volume_index_free(&index);
}

/* Blocks that are smaller at the beginning, so that others begin elsewhere. */
static void blocks_begin_where_they_are_to(void **state) {
    (void)state;
    for (int shift = 0; shift < 64; shift++) {
        const int before[3] = {shift % 4, shift / 4 % 4, shift / 16};
        iso_volume_index index;
        make_index(&index);
        iso_block_ranges_free(&index.ranges);
        assert_int_equal(iso_block_ranges_create(identity.dims, before, &index.ranges, NULL), ISO_OK);
        add_all(&index);
        check_ranges(&index.ranges);
        iso_volume_index_free(&index);
    }
}

static void write_index(void) {
    iso_volume_index index;
    make_index(&index);
    add_all(&index);
    index.has_histogram = 1;
    index.histogram.bins[7] = index.histogram.counted = 99;
    for (int i = 0; i < ISO_INDEXED_SURFACES + 2; i++) {
        const iso_indexed_surface surface = {.isovalue = i, .kind = 5, .primitives = (uint64_t)i * 1000};
        iso_volume_index_add(&index, &surface);
    }
    assert_int_equal(iso_volume_index_write(path, &index, NULL), ISO_OK);
    assert_false(index.changed);
    iso_volume_index_free(&index);
}

static void indices_are_read_back(void **state) {
    (void)state;
    iso_volume_index index;
    write_index();
    make_index(&index);
    assert_true(iso_volume_index_read(path, &index));
    check_ranges(&index.ranges);
    assert_int_equal(index.has_histogram, 1);
    assert_int_equal(index.histogram.bins[7], 99);
    assert_null(iso_volume_index_find(&index, 2, 4));
    assert_null(iso_volume_index_find(&index, 1, 5)); /* the oldest ones gave way */
    assert_int_equal(iso_volume_index_find(&index, 2, 5)->primitives, 2000);
    assert_int_equal(iso_volume_index_find(&index, ISO_INDEXED_SURFACES + 1, 5)->primitives, 33000);
    iso_volume_index_free(&index);
}

/* Blocks of which only some bricks were read are not known when the file is read. */
static void unfinished_blocks_begin_anew(void **state) {
    (void)state;
    iso_volume_index index;
    const iso_brick_box some = {{0, 0, 0}, {6, 4, 4}};
    make_index(&index);
    add_box(&index, &some);
    assert_int_equal(iso_volume_index_write(path, &index, NULL), ISO_OK);
    iso_volume_index_free(&index);
    make_index(&index);
    assert_true(iso_volume_index_read(path, &index));
    assert_int_equal(index.ranges.unknown, index.ranges.count - 1);
    add_all(&index);
    check_ranges(&index.ranges);
    iso_volume_index_free(&index);
}

static void expect_nothing(const iso_volume_identity *wanted) {
    iso_volume_index index;
    assert_int_equal(iso_volume_index_create(wanted, &index, NULL), ISO_OK);
    assert_false(iso_volume_index_read(path, &index));
    assert_int_equal(index.ranges.unknown, index.ranges.count);
    assert_int_equal(index.has_histogram + index.surface_count, 0);
    iso_volume_index_free(&index);
}

static void other_files_are_not_used(void **state) {
    (void)state;
    static unsigned char bytes[1 << 16];
    iso_volume_identity other = identity;
    write_index();
    other.files++;
    expect_nothing(&other);
    other = identity;
    other.dims[0] = 1500; /* more blocks than the file has */
    expect_nothing(&other);
    other = identity;
    other.first[2] = 1;
    expect_nothing(&other);
    FILE *file = fopen(path, "rb");
    const size_t size = fread(bytes, 1, sizeof bytes, file);
    fclose(file);
    for (size_t at = 0; at <= size; at += at < 300 ? 1 : 41)
        for (int kind = 0; kind < 2; kind++) { /* truncated; a bit turned over */
            if (at == size) bytes[size] = 0;   /* a byte more */
            file = fopen(path, "wb");
            bytes[at] ^= at < size && kind ? 4 : 0;
            fwrite(bytes, 1, at == size ? size + 1 : kind ? size : at, file);
            bytes[at] ^= at < size && kind ? 4 : 0;
            fclose(file);
            expect_nothing(&identity);
        }
    remove(path);
    expect_nothing(&identity);
}

/* Indices whose checksum is right, and which cannot be true. */
typedef void lie_fn(iso_volume_index *index);
static void nan_bounds(iso_volume_index *index) {
    index->surfaces[0].index[2] = NAN;
}
static void infinite_bounds(iso_volume_index *index) {
    index->surfaces[3].world[5] = INFINITY;
}
static void exchanged_bounds(iso_volume_index *index) {
    index->surfaces[0].world[0] = 1;
}
static void bounds_beside_the_volume(iso_volume_index *index) {
    index->surfaces[0].index[3] = 150;
}
static void other_world(iso_volume_index *index) {
    index->surfaces[0].world[4] = 3;
}
static void nan_isovalue(iso_volume_index *index) {
    index->surfaces[1].isovalue = NAN;
}
static void isovalue_of_no_block(iso_volume_index *index) {
    index->surfaces[1].isovalue = 1e6;
}
static void too_many_primitives(iso_volume_index *index) {
    index->surfaces[0].primitives = 1u << 30;
}
static void nan_range(iso_volume_index *index) {
    index->ranges.lo[1] = NAN;
}
static void infinite_range(iso_volume_index *index) {
    index->ranges.hi[1] = INFINITY;
}
static void exchanged_range(iso_volume_index *index) {
    index->ranges.lo[0] = index->ranges.hi[0] + 1;
}
static void odd_state(iso_volume_index *index) {
    index->ranges.states[0] |= 5;
}
static void nan_histogram(iso_volume_index *index) {
    index->histogram.width = NAN;
}
static void exchanged_histogram(iso_volume_index *index) {
    index->histogram.low = 1;
}
static void too_many_counted(iso_volume_index *index) {
    index->histogram.counted = 98;
}
static void counted_beyond_the_volume(iso_volume_index *index) {
    index->histogram.bins[7] = index->histogram.counted = UINT64_C(1) << 50;
}

static void indices_that_lie_are_not_used(void **state) {
    (void)state;
    lie_fn *const lies[] = {
        nan_bounds,    infinite_bounds,     exchanged_bounds,     bounds_beside_the_volume,
        other_world,   nan_isovalue,        isovalue_of_no_block, too_many_primitives,
        nan_range,     infinite_range,      exchanged_range,      odd_state,
        nan_histogram, exchanged_histogram, too_many_counted,     counted_beyond_the_volume};
    for (size_t i = 0; i < sizeof lies / sizeof *lies; i++) {
        iso_volume_index index;
        write_index();
        make_index(&index);
        assert_true(iso_volume_index_read(path, &index));
        lies[i](&index);
        assert_int_equal(iso_volume_index_write(path, &index, NULL), ISO_OK);
        iso_volume_index_free(&index);
        expect_nothing(&identity);
    }
    remove(path);
}

/* Only an index is written over, and nothing through a link. */
static void other_files_stay(void **state) {
    (void)state;
    char target[sizeof path + 8], text[16] = "";
    iso_volume_index index;
    iso_error error = {0};
    snprintf(target, sizeof target, "%s.file", path);
    make_index(&index);
    add_all(&index);
    for (int links = 0; links < 3; links++) { /* a file; a symbolic link to it; a link to nothing */
        FILE *file = fopen(links ? target : path, "wb");
        fputs("precious", file);
        fclose(file);
        if (links) assert_int_equal(symlink(target, path), 0);
        if (links == 2) remove(target);
        assert_int_equal(iso_volume_index_write(path, &index, &error), ISO_ERR_WRITE);
        assert_non_null(strstr(error.text, links ? "symbolic link" : "another file"));
        file = fopen(links ? target : path, "rb");
        assert_int_equal(file == NULL, links == 2);
        if (file) {
            assert_non_null(fgets(text, sizeof text, file));
            assert_string_equal(text, "precious");
            fclose(file);
        }
        remove(path);
    }
    remove(target);
    iso_volume_index_free(&index);
}

static int set_up(void **state) {
    (void)state;
    snprintf(path, sizeof path, "%s/volume_index_%d.isoindex", ISO_TEST_TMP, (int)getpid());
    return 0;
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(blocks_have_the_ranges_of_their_bricks),
        cmocka_unit_test(blocks_begin_where_they_are_to),
        cmocka_unit_test(indices_are_read_back),
        cmocka_unit_test(unfinished_blocks_begin_anew),
        cmocka_unit_test(other_files_are_not_used),
        cmocka_unit_test(indices_that_lie_are_not_used),
        cmocka_unit_test(other_files_stay),
    };
    return cmocka_run_group_tests(tests, set_up, NULL);
}
