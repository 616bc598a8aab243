/* The change log compared with a model that stores every voxel of every edit. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "check_support.h"
#include "grids/change_log.h"

enum { CX = 4, CY = 3, CZ = 2, CELLS = CX * CY * CZ, VOXELS = 4096, CONSUMERS = 5 };

/* The number of the last edit that touched each voxel, by cell. */
typedef struct model {
    uint64_t last[CELLS][VOXELS];
    uint64_t cell[CELLS];
} model;

static void model_touch(model *m, uint64_t edit, const int lo[3], const int hi[3]) {
    for (int z = lo[2] < 0 ? 0 : lo[2]; z <= hi[2] && z < CZ * 16; z++)
        for (int y = lo[1] < 0 ? 0 : lo[1]; y <= hi[1] && y < CY * 16; y++)
            for (int x = lo[0] < 0 ? 0 : lo[0]; x <= hi[0] && x < CX * 16; x++) {
                int cell = (z / 16 * CY + y / 16) * CX + x / 16;
                m->last[cell][(z % 16 * 16 + y % 16) * 16 + x % 16] = edit;
                m->cell[cell] = edit;
            }
}

static int in_box(const iso_change *c, int voxel) {
    const int at[3] = {voxel % 16, voxel / 16 % 16, voxel / 256};
    for (int axis = 0; axis < 3; axis++)
        if (at[axis] < c->lo[axis] || at[axis] > c->hi[axis]) return 0;
    return 1;
}

/* What a consumer that has read up to `seen` is told: every voxel changed since, in order, and no cell that
 * was not touched since. */
static void check_consumer(const iso_change_log *log, const model *m, uint64_t seen) {
    static uint8_t told[CELLS][VOXELS];
    memset(told, 0, sizeof told);
    const iso_change *changes;
    size_t count = iso_change_log_since(log, seen, &changes);
    uint64_t before = seen;
    for (size_t i = 0; i < count; i++) {
        const iso_change *c = &changes[i];
        assert_true(c->edit > seen && c->edit >= before && c->edit <= iso_change_log_now(log));
        assert_true(c->cell < CELLS);
        assert_true(m->cell[c->cell] > seen);
        before = c->edit;
        for (int axis = 0; axis < 3; axis++) assert_true(c->lo[axis] <= c->hi[axis] && c->hi[axis] < 16);
        for (int v = 0; v < VOXELS; v++) told[c->cell][v] |= in_box(c, v);
    }
    for (int cell = 0; cell < CELLS; cell++)
        for (int v = 0; v < VOXELS; v++)
            if (m->last[cell][v] > seen && !told[cell][v])
                fail_msg("voxel %d of cell %d changed in edit %llu and a reader at %llu was not told", v,
                         cell, (unsigned long long)m->last[cell][v], (unsigned long long)seen);
}

static void random_box(uint64_t *random, int lo[3], int hi[3]) {
    const int size[3] = {CX * 16, CY * 16, CZ * 16};
    int large = random_below(random, 50) == 0;
    for (int axis = 0; axis < 3; axis++) {
        lo[axis] = (int)random_below(random, (uint32_t)size[axis] + 4) - 2;
        hi[axis] = lo[axis] + (int)random_below(random, large ? 40 : 4);
    }
}

static void tells_every_consumer_enough(void **state) {
    (void)state;
    const int cells[3] = {CX, CY, CZ};
    iso_change_log *log;
    static model m;
    assert_int_equal(iso_change_log_create(cells, &log, NULL), ISO_OK);
    uint64_t random = 7, seen[CONSUMERS] = {0};
    size_t entries = 0, merges = 0;
    for (int round = 0; round < 16000; round++) {
        int lo[3], hi[3];
        if (round == 0 || random_below(&random, 3)) {
            uint64_t now = iso_change_log_now(log);
            assert_int_equal(iso_change_log_begin(log), now + 1);
        }
        random_box(&random, lo, hi);
        assert_int_equal(iso_change_log_add(log, lo, hi, NULL), ISO_OK);
        model_touch(&m, iso_change_log_now(log), lo, hi);
        const iso_change *changes;
        size_t count = iso_change_log_since(log, 0, &changes);
        merges += count < entries;
        entries = count;
        assert_true(count <= 4096);
        /* Consumers of very different patience; the last one reads nothing until the end. */
        for (int c = 0; c < CONSUMERS - 1; c++)
            if (random_below(&random, 20u << (2 * c)) == 0) {
                check_consumer(log, &m, seen[c]);
                seen[c] = iso_change_log_now(log);
                assert_int_equal(iso_change_log_since(log, seen[c], &changes), 0);
            }
    }
    check_consumer(log, &m, seen[CONSUMERS - 1]);
    assert_true(merges >= 3);
    for (uint32_t cell = 0; cell < CELLS; cell++)
        assert_int_equal(iso_change_log_last_edit(log, cell), m.cell[cell]);
    iso_change_log_destroy(log);
}

/* While nothing was merged, the boxes are as small as they can be for boxes. */
static void tells_no_more_than_the_box(void **state) {
    (void)state;
    const int cells[3] = {CX, CY, CZ};
    iso_change_log *log;
    assert_int_equal(iso_change_log_create(cells, &log, NULL), ISO_OK);
    uint64_t random = 99;
    for (int round = 0; round < 300; round++) {
        int lo[3], hi[3];
        random_box(&random, lo, hi);
        uint64_t seen = iso_change_log_now(log);
        iso_change_log_begin(log);
        assert_int_equal(iso_change_log_add(log, lo, hi, NULL), ISO_OK);
        const iso_change *changes;
        size_t count = iso_change_log_since(log, seen, &changes), told = 0, wanted = 1;
        for (size_t i = 0; i < count; i++) {
            size_t volume = 1;
            for (int axis = 0; axis < 3; axis++)
                volume *= (size_t)(changes[i].hi[axis] - changes[i].lo[axis] + 1);
            told += volume;
        }
        const int size[3] = {CX * 16, CY * 16, CZ * 16};
        for (int axis = 0; axis < 3; axis++) {
            int first = lo[axis] < 0 ? 0 : lo[axis], last = hi[axis] < size[axis] ? hi[axis] : size[axis] - 1;
            wanted *= last < first ? 0 : (size_t)(last - first + 1);
        }
        assert_int_equal(told, wanted);
    }
    iso_change_log_destroy(log);
}

/* Repeated touches of one cell under one edit share an entry, those of different edits never do. */
static void repeated_touches_share_an_entry(void **state) {
    (void)state;
    const int cells[3] = {1, 1, 1};
    iso_change_log *log;
    const iso_change *changes;
    assert_int_equal(iso_change_log_create(cells, &log, NULL), ISO_OK);
    iso_change_log_begin(log);
    for (int x = 0; x < 16; x++) {
        const int at[3] = {x, 3, 4};
        assert_int_equal(iso_change_log_add(log, at, at, NULL), ISO_OK);
    }
    assert_int_equal(iso_change_log_since(log, 0, &changes), 1);
    assert_int_equal(changes->lo[0], 0);
    assert_int_equal(changes->hi[0], 15);
    assert_int_equal(changes->hi[1], 3);
    iso_change_log_begin(log);
    const int at[3] = {5, 3, 4};
    assert_int_equal(iso_change_log_add(log, at, at, NULL), ISO_OK);
    assert_int_equal(iso_change_log_since(log, 0, &changes), 2);
    assert_int_equal(iso_change_log_since(log, 1, &changes), 1);
    assert_int_equal(changes->edit, 2);
    iso_change_log_destroy(log);
}

/* A grid of many cells that is touched as a whole again and again: the log stays within its budget, and the
 * last edit is told exactly. */
static void stays_within_its_budget(void **state) {
    (void)state;
    enum { SIDE = 24, TOTAL = SIDE * SIDE * SIDE };
    const int cells[3] = {SIDE, SIDE, SIDE}, lo[3] = {0, 0, 0};
    const int hi[3] = {SIDE * 16 - 1, SIDE * 16 - 1, SIDE * 16 - 1};
    iso_change_log *log;
    const iso_change *changes;
    assert_int_equal(iso_change_log_create(cells, &log, NULL), ISO_OK);
    for (int edit = 1; edit <= 20; edit++) {
        iso_change_log_begin(log);
        assert_int_equal(iso_change_log_add(log, lo, hi, NULL), ISO_OK);
        assert_true(iso_change_log_since(log, 0, &changes) <= 4 * (size_t)TOTAL);
        assert_int_equal(iso_change_log_since(log, (uint64_t)edit - 1, &changes), TOTAL);
    }
    assert_true(iso_change_log_bytes(log) < (size_t)TOTAL * 400);
    iso_change_log_destroy(log);
}

static void first_touch_starts_edit_one(void **state) {
    (void)state;
    const int cells[3] = {2, 1, 1}, lo[3] = {-5, -5, -5}, hi[3] = {100, 100, 100}, out[3] = {32, 0, 0};
    iso_change_log *log;
    const iso_change *changes;
    assert_int_equal(iso_change_log_create(cells, &log, NULL), ISO_OK);
    assert_int_equal(iso_change_log_now(log), 0);
    assert_int_equal(iso_change_log_since(log, 0, &changes), 0);
    assert_int_equal(iso_change_log_add(log, out, hi, NULL), ISO_OK);
    assert_int_equal(iso_change_log_since(log, 0, &changes), 0);
    assert_int_equal(iso_change_log_add(log, lo, hi, NULL), ISO_OK);
    assert_int_equal(iso_change_log_now(log), 1);
    assert_int_equal(iso_change_log_since(log, 0, &changes), 2);
    assert_int_equal(iso_change_log_last_edit(log, 1), 1);
    iso_change_log_destroy(log);
    iso_change_log_destroy(NULL);
}

static void refuses_impossible_sizes(void **state) {
    (void)state;
    const int none[3] = {1, 0, 1}, many[3] = {65536, 65536, 1};
    iso_change_log *log = NULL;
    iso_error error = {0};
    assert_int_equal(iso_change_log_create(none, &log, &error), ISO_ERR_USAGE);
    assert_int_equal(iso_change_log_create(many, &log, &error), ISO_ERR_LIMIT);
    assert_null(log);
    assert_non_null(strstr(error.text, "65536 x 65536 x 1"));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(tells_every_consumer_enough),     cmocka_unit_test(tells_no_more_than_the_box),
        cmocka_unit_test(repeated_touches_share_an_entry), cmocka_unit_test(stays_within_its_budget),
        cmocka_unit_test(first_touch_starts_edit_one),     cmocka_unit_test(refuses_impossible_sizes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
