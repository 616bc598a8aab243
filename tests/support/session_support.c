/* session_support: files and random events for the tests of sessions. */
#include "session_support.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

const iso_journal_start SESSION_START = {.source = "ball",
                                         .voxel_size = 0.5,
                                         .dims = {64, 64, 64},
                                         .origin = {-15.75, -15.75, -15.75},
                                         .radius = 10};

const char *session_path(const char *name) {
    static char path[4][512];
    static int turn;
    turn = (turn + 1) % 4;
    snprintf(path[turn], sizeof path[turn], "%s/session_%d_%s", ISO_TEST_TMP, (int)getpid(), name);
    return path[turn];
}

void session_remove_files(const char *journal) {
    char name[600];
    unlink(journal);
    for (int i = 1; i < 10000; i++) {
        snprintf(name, sizeof name, "%s.%d.snapshot", journal, i);
        if (unlink(name) && i >= 60) return;
    }
}

iso_session *session_open(const iso_session_opts *opts) {
    iso_hgrid *grid;
    iso_session *session;
    iso_error error = {0};
    if (iso_session_solid(&SESSION_START, &grid, &error) != ISO_OK) fail_msg("%s", error.text);
    if (iso_session_create(grid, &SESSION_START, opts, &session, &error) != ISO_OK)
        fail_msg("%s", error.text);
    return session;
}

iso_sample session_random_sample(uint32_t *seed) {
    iso_sample s = {.pressure = uniform(seed), .seconds = uniform(seed) * 100};
    double *p[6] = {&s.position.x, &s.position.y, &s.position.z, &s.normal.x, &s.normal.y, &s.normal.z};
    for (int i = 0; i < 6; i++) *p[i] = (uniform(seed) - 0.5) * (i < 3 ? 32 : 1);
    s.normal = iso_vec3_unit(s.normal);
    return s;
}

iso_brush session_random_brush(uint32_t *seed, int tools) {
    /* (No stamp has voxels; blurring comes below, so that the sequence is what it was without both.) */
    enum { OTHERS = ISO_TOOL_PAINT - ISO_TOOL_BLUR_MASK };
    if (tools > ISO_TOOL_BLUR_MASK) tools -= OTHERS;
    iso_brush b = {.tool = (iso_tool)(uniform(seed) * tools),
                   .shape = (iso_solid)(uniform(seed) * ISO_SOLID_STAMP),
                   .radius = 0.5 + 4 * uniform(seed),
                   .strength = uniform(seed),
                   .symmetry = uniform(seed) < 0.2 ? 5 : 0,
                   .pressure_strength = uniform(seed) < 0.5};
    const unsigned random = (unsigned)(1e6 * b.strength); /* (of its last digits) */
    if (b.tool >= ISO_TOOL_BLUR_MASK) b.tool = (iso_tool)(b.tool + OTHERS);
    if (b.tool == ISO_TOOL_INVERT_MASK && random % 4 < 2) b.tool = ISO_TOOL_BLUR_MASK;
    b.has_color = tools > ISO_TOOL_BLUR_MASK && random % 2;
    if (b.has_color) b.color = (iso_rgb){(uint8_t)random, (uint8_t)(random / 3), (uint8_t)(random / 7)};
    return b;
}

iso_event session_random_event(uint32_t *seed, int tools, bool *drawing) {
    iso_event event;
    memset(&event, 0, sizeof event);
    double chance = uniform(seed);
    event.sample = session_random_sample(seed);
    if (*drawing) {
        event.kind = chance < 0.5 ? ISO_EVENT_SAMPLE : chance < 0.95 ? ISO_EVENT_END : ISO_EVENT_CANCEL;
        *drawing = event.kind == ISO_EVENT_SAMPLE;
        return event;
    }
    event.kind = chance < 0.6 ? ISO_EVENT_BEGIN : chance < 0.85 ? ISO_EVENT_UNDO : ISO_EVENT_REDO;
    event.brush = session_random_brush(seed, tools);
    *drawing = event.kind == ISO_EVENT_BEGIN;
    return event;
}

session_field session_field_of(iso_session *session) {
    session_field field = {.grid = sculpt_copy(iso_session_grid(session))};
    assert_int_equal(iso_field_items_copy(iso_session_items(session), &field.items, NULL), ISO_OK);
    return field;
}

void session_field_free(session_field *field) {
    iso_hgrid_destroy(field->grid);
    iso_field_items_free(&field->items);
}

static bool same_kind(const iso_cell_items *a, const iso_cell_items *b) {
    for (size_t i = 0; i < a->cells; i++) {
        const void *x = a->cell[i], *y = b->cell[i];
        if (!x != !y || (x && memcmp(x, y, a->bytes))) return false;
    }
    return a->used == b->used;
}

bool session_same_items(const iso_field_items *a, const iso_field_items *b) {
    bool same = true;
    for (int i = 0; i < ISO_ITEM_KINDS; i++) same &= same_kind(&a->of[i], &b->of[i]);
    return same;
}

bool session_is(iso_session *session, const session_field *field) {
    return sculpt_same(iso_session_grid(session), field->grid) &&
           session_same_items(iso_session_items(session), &field->items);
}

void session_stroke(iso_session *session, const iso_brush *brush, const iso_vec3 *at, int count) {
    iso_sample sample = {.pressure = 1};
    for (int i = 0; i < count; i++) {
        sample.position = at[i];
        sample.normal = iso_vec3_unit(at[i]);
        assert_int_equal(i ? iso_session_sample(session, &sample, NULL, NULL)
                           : iso_session_begin(session, brush, &sample, NULL, NULL),
                         ISO_OK);
    }
    assert_int_equal(iso_session_end(session, NULL), ISO_OK);
}

iso_session *session_drawn(const char *journal, void (*draw)(iso_session *session), session_field *drawn) {
    iso_pool *pool;
    session_remove_files(journal);
    assert_int_equal(iso_pool_create(4, &pool, NULL), ISO_OK);
    iso_session *session = session_open(&(iso_session_opts){.journal = journal, .checkpoint_strokes = -1}),
                *other = session_open(&(iso_session_opts){.pool = pool, .checkpoint_strokes = -1});
    draw(session);
    draw(other);
    *drawn = session_field_of(session);
    assert_true(session_is(other, drawn));
    iso_session_destroy(other);
    iso_pool_destroy(pool);
    return session;
}
