/* Strokes stay editable: after any edit of a past stroke the field and the masks are, bit for bit, those of a
 * fresh session in which the edited list of strokes is drawn; edits are undone and redone as steps, and are
 * in the journal. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "file_support.h"
#include "session_support.h"

/* A ball in which most strokes lie apart: edits then leave many of them as they are. */
static const iso_journal_start LARGE = {.source = "ball",
                                        .voxel_size = 0.5,
                                        .dims = {176, 176, 176},
                                        .origin = {-43.75, -43.75, -43.75},
                                        .radius = 30};

static iso_session *open_ball(const iso_journal_start *start, size_t version_memory) {
    iso_hgrid *grid;
    iso_session *session;
    const iso_session_opts opts = {.checkpoint_strokes = -1, .version_memory = version_memory};
    assert_int_equal(iso_session_solid(start, &grid, NULL), ISO_OK);
    assert_int_equal(iso_session_create(grid, start, &opts, &session, NULL), ISO_OK);
    return session;
}

/* Draws the list in a fresh session. */
static iso_session *draw_fresh(iso_session *edited) {
    iso_stroke_list list = {.count = 0};
    const bool large = iso_session_grid(edited)->dims[0] == LARGE.dims[0];
    iso_session *session = open_ball(large ? &LARGE : &SESSION_START, 0);
    assert_int_equal(iso_session_strokes(edited, &list, NULL), ISO_OK);
    for (size_t i = 0; i < list.count; i++) {
        const iso_stroke *stroke = iso_stroke_at(&list, i);
        iso_error error = {0};
        if (stroke->muted) continue;
        if (iso_session_begin(session, &stroke->brush, &stroke->samples[0], NULL, &error) != ISO_OK)
            fail_msg("%s", error.text);
        for (size_t k = 1; k < stroke->count; k++)
            assert_int_equal(iso_session_sample(session, &stroke->samples[k], NULL, NULL), ISO_OK);
        assert_int_equal(iso_session_end(session, NULL), ISO_OK);
    }
    iso_stroke_list_free(&list);
    return session;
}

static void assert_is_fresh(iso_session *session) {
    iso_session *fresh = draw_fresh(session);
    session_field field = session_field_of(fresh);
    assert_true(session_is(session, &field));
    session_field_free(&field);
    iso_session_destroy(fresh);
}

/* A short stroke on or near the ball, so that masks and creases meet strokes that follow. On the large ball
 * whole-mask tools are left out, as they reach every stroke that a mask does. */
static void draw(iso_session *session, uint32_t *seed, unsigned before) {
    iso_event event = {.kind = ISO_EVENT_BEGIN, .before = before};
    const bool large = iso_session_grid(session)->dims[0] == LARGE.dims[0];
    event.brush = session_random_brush(seed, large ? ISO_TOOL_CLEAR_MASK : ISO_TOOL_TRIM_PLANE);
    event.brush.radius = 0.5 + 2 * uniform(seed);
    event.sample = session_random_sample(seed);
    event.sample.position = iso_vec3_scale(event.sample.normal, (large ? 29 : 9) + 2 * uniform(seed));
    assert_int_equal(iso_session_play(session, &event, NULL, NULL), ISO_OK);
    event.kind = ISO_EVENT_SAMPLE;
    for (int i = 0; i < 3; i++) {
        iso_vec3 step; /* (one after the other: compilers evaluate arguments in different orders) */
        step.x = uniform(seed) - 0.5;
        step.y = uniform(seed) - 0.5;
        step.z = uniform(seed) - 0.5;
        event.sample.position = iso_vec3_add(event.sample.position, iso_vec3_scale(step, 3));
        assert_int_equal(iso_session_play(session, &event, NULL, NULL), ISO_OK);
    }
    event.kind = ISO_EVENT_END;
    assert_int_equal(iso_session_play(session, &event, NULL, NULL), ISO_OK);
}

static const iso_stroke *random_stroke(const iso_stroke_list *list, uint32_t *seed) {
    return iso_stroke_at(list, (size_t)(uniform(seed) * (double)list->count) % list->count);
}

/* Bends the path of a stroke, or reseats it and those after it. */
static void edit_path(iso_session *session, const iso_stroke *stroke, bool reseat, uint32_t *seed) {
    enum { MOST = 64 };
    iso_sample samples[MOST];
    iso_event event = {.kind = ISO_EVENT_PATH, .first = stroke->number, .last = stroke->number};
    iso_error error = {0};
    if (reseat) {
        event.kind = ISO_EVENT_RESEAT;
        event.last += 6;
    } else {
        assert_true(stroke->count <= MOST);
        event.path = samples;
        event.path_count = stroke->count;
        for (size_t i = 0; i < stroke->count; i++) {
            samples[i] = stroke->samples[i];
            samples[i].position.x += uniform(seed) - 0.5;
            samples[i].position.z += uniform(seed) - 0.5;
        }
    }
    if (iso_session_edit(session, &event, &error) != ISO_OK) fail_msg("%s", error.text);
}

/* One of the kinds of edits: a brush, delete, mute or unmute, move, insert, another path, reseat. */
enum { EDIT_KINDS = 7 };
static void edit(iso_session *session, int kind, uint32_t *seed) {
    iso_stroke_list list = {.count = 0};
    assert_int_equal(iso_session_strokes(session, &list, NULL), ISO_OK);
    assert_true(list.count > 2);
    const iso_stroke *stroke = random_stroke(&list, seed), *other = random_stroke(&list, seed);
    iso_event event = {.first = stroke->number, .last = stroke->number, .brush = stroke->brush};
    const unsigned before = other->number == stroke->number ? 0 : other->number;
    if (kind > 4) {
        edit_path(session, stroke, kind == 6, seed);
        iso_stroke_list_free(&list);
        return;
    }
    if (kind == 4) {
        iso_stroke_list_free(&list);
        draw(session, seed, before);
        return;
    }
    event.kind = kind == 0   ? ISO_EVENT_EDIT
                 : kind == 1 ? ISO_EVENT_DELETE
                 : kind == 3 ? ISO_EVENT_MOVE
                             : (stroke->muted ? ISO_EVENT_UNMUTE : ISO_EVENT_MUTE);
    if (kind == 3) event.before = before;
    event.brush.radius *= 0.7 + 0.6 * uniform(seed);
    if (uniform(seed) < 0.3) event.brush.symmetry ^= 1;
    if (uniform(seed) < 0.2) event.brush.tool = (iso_tool)(uniform(seed) * ISO_TOOL_TRIM_PLANE);
    iso_stroke_list_free(&list);
    iso_error error = {0};
    if (iso_session_edit(session, &event, &error) != ISO_OK) fail_msg("%s", error.text);
}

static void edits_equal_a_fresh_replay(void **state) {
    (void)state;
    enum { SESSIONS = 8, STROKES = 36, EDITS = 21 };
    iso_versions_stats all[2] = {{0}};
    for (uint32_t round = 0; round < SESSIONS; round++) {
        uint32_t seed = 4100 + round;
        const int large = round % 4 == 3;
        iso_session *session = open_ball(large ? &LARGE : &SESSION_START, round % 2 ? 100000 : 0);
        for (int i = 0; i < (large ? 3 : 1) * STROKES; i++) draw(session, &seed, 0);
        for (int i = 0; i < EDITS; i++) {
            edit(session, i % EDIT_KINDS, &seed);
            assert_is_fresh(session);
            if (i % 7 == 6) {
                session_field now = session_field_of(session);
                assert_int_equal(iso_session_undo(session, NULL), ISO_OK);
                assert_is_fresh(session);
                assert_int_equal(iso_session_redo(session, NULL), ISO_OK);
                assert_true(session_is(session, &now));
                session_field_free(&now);
            }
            if (i % 11 == 10) { /* strokes may be drawn between edits */
                draw(session, &seed, 0);
                assert_is_fresh(session);
            }
        }
        const iso_versions_stats stats = iso_session_edit_stats(session);
        if (round % 2)
            assert_true(stats.in_files > stats.bytes / 2 && stats.bytes - stats.in_files <= 100000);
        all[large].strokes += stats.strokes;
        all[large].drawn += stats.drawn;
        iso_session_destroy(session);
    }
    print_message("%d edits: drew %zu of %zu strokes, on the large ball %zu of %zu\n", SESSIONS * EDITS,
                  all[0].drawn, all[0].strokes, all[1].drawn, all[1].strokes);
    assert_true(2 * all[0].drawn < all[0].strokes); /* what an edit cannot reach is not drawn again */
    assert_true(3 * all[1].drawn < all[1].strokes);
}

/* Strokes that lie apart are not drawn again when one of them is edited. */
static void only_what_is_reached_is_drawn(void **state) {
    (void)state;
    iso_session *session = open_ball(&LARGE, 0);
    const iso_vec3 at[6] = {{30, 0, 0}, {-30, 0, 0}, {0, 30, 0}, {0, -30, 0}, {0, 0, 30}, {0, 0, -30}};
    const iso_brush brush = {.tool = ISO_TOOL_ADD, .radius = 2};
    for (int i = 0; i < 6; i++) {
        const iso_sample sample = {.position = at[i], .normal = iso_vec3_unit(at[i]), .pressure = 1};
        assert_int_equal(iso_session_begin(session, &brush, &sample, NULL, NULL), ISO_OK);
        assert_int_equal(iso_session_end(session, NULL), ISO_OK);
    }
    iso_event event = {.kind = ISO_EVENT_MUTE, .first = 6, .last = 6};
    assert_int_equal(iso_session_edit(session, &event, NULL), ISO_OK);
    assert_int_equal(iso_session_edit_stats(session).drawn, 6); /* the first edit: every stroke once */
    event = (iso_event){.kind = ISO_EVENT_EDIT, .first = 2, .last = 2, .brush = brush};
    event.brush.radius = 3;
    assert_int_equal(iso_session_edit(session, &event, NULL), ISO_OK);
    assert_int_equal(iso_session_edit_stats(session).drawn, 7);
    event = (iso_event){.kind = ISO_EVENT_MOVE, .first = 1, .last = 1};
    assert_int_equal(iso_session_edit(session, &event, NULL), ISO_OK);
    assert_int_equal(iso_session_edit_stats(session).drawn, 8);
    iso_session_destroy(session);
}

static void refusals_change_nothing(void **state) {
    (void)state;
    uint32_t seed = 3;
    iso_session *session = session_open(&(iso_session_opts){.checkpoint_strokes = -1});
    for (int i = 0; i < 4; i++) draw(session, &seed, 0);
    session_field before = session_field_of(session);
    const size_t steps = iso_history_count(iso_session_history(session));
    const iso_event wrong[] = {{.kind = ISO_EVENT_MUTE, .first = 9, .last = 9},
                               {.kind = ISO_EVENT_DELETE, .first = 7, .last = 12},
                               {.kind = ISO_EVENT_MOVE, .first = 1, .last = 2, .before = 2},
                               {.kind = ISO_EVENT_MOVE, .first = 1, .last = 2, .before = 5},
                               {.kind = ISO_EVENT_EDIT, .first = 1, .last = 1, .brush = {.radius = -1}},
                               {.kind = ISO_EVENT_MUTE, .text = "arms"},
                               {.kind = ISO_EVENT_RESEAT, .first = 7, .last = 9},
                               {.kind = ISO_EVENT_PATH, .first = 1, .last = 1},
                               {.kind = ISO_EVENT_PATH,
                                .first = 1,
                                .last = 1,
                                .path = (const iso_sample[]){{.pressure = 1}},
                                .path_count = 1}};
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        iso_error error = {0};
        assert_int_equal(iso_session_edit(session, &wrong[i], &error), ISO_ERR_USAGE);
        assert_true(error.text[0] && !strchr(error.text, '\n'));
        assert_true(session_is(session, &before));
    }
    assert_int_equal(iso_history_count(iso_session_history(session)), steps);
    /* an edit of what lies in no cell is a step, too */
    iso_event event = {.kind = ISO_EVENT_GROUP, .first = 1, .last = 3, .text = "legs"};
    assert_int_equal(iso_session_edit(session, &event, NULL), ISO_OK);
    assert_int_equal(iso_history_count(iso_session_history(session)), steps + 1);
    assert_true(session_is(session, &before));
    iso_stroke_list list = {.count = 0};
    assert_int_equal(iso_session_strokes(session, &list, NULL), ISO_OK);
    assert_string_equal(iso_stroke_find(&list, 2)->group, "legs");
    assert_string_equal(iso_stroke_find(&list, 4)->group, "");
    assert_int_equal(iso_session_undo(session, NULL), ISO_OK);
    assert_int_equal(iso_session_strokes(session, &list, NULL), ISO_OK);
    assert_string_equal(iso_stroke_find(&list, 2)->group, "");
    iso_stroke_list_free(&list);
    session_field_free(&before);
    iso_session_destroy(session);
}

/* What is done to a group is done to the strokes that are in it then. */
static void groups_are_edited(void **state) {
    (void)state;
    uint32_t seed = 12;
    iso_session *session = session_open(&(iso_session_opts){.checkpoint_strokes = -1});
    iso_stroke_list list = {.count = 0};
    for (int i = 0; i < 6; i++) draw(session, &seed, 0);
    const iso_event edits[] = {{.kind = ISO_EVENT_GROUP, .first = 1, .last = 2, .text = "legs"},
                               {.kind = ISO_EVENT_GROUP, .first = 5, .last = 5, .text = "legs"},
                               {.kind = ISO_EVENT_MUTE, .text = "legs"},
                               {.kind = ISO_EVENT_GROUP, .first = 2, .last = 2},
                               {.kind = ISO_EVENT_UNMUTE, .text = "legs"},
                               {.kind = ISO_EVENT_MOVE, .text = "legs"},
                               {.kind = ISO_EVENT_MOVE, .text = "legs", .before = 5},
                               {.kind = ISO_EVENT_DELETE, .text = "legs"}};
    const struct {
        unsigned number[6]; /* in order; 0: the end */
        unsigned muted;     /* bits, by number */
    } wanted[] = {{{1, 2, 3, 4, 5, 6}, 0},    {{1, 2, 3, 4, 5, 6}, 0},    {{1, 2, 3, 4, 5, 6}, 0x26},
                  {{1, 2, 3, 4, 5, 6}, 0x26}, {{1, 2, 3, 4, 5, 6}, 0x04}, {{2, 3, 4, 6, 1, 5}, 0x04},
                  {{2, 3, 4, 6, 1, 5}, 0x04}, {{2, 3, 4, 6, 0, 0}, 0x04}};
    for (size_t i = 0; i < sizeof edits / sizeof *edits; i++) {
        const bool itself = edits[i].before > 0;
        assert_int_equal(iso_session_edit(session, &edits[i], NULL), itself ? ISO_ERR_USAGE : ISO_OK);
        assert_int_equal(iso_session_strokes(session, &list, NULL), ISO_OK);
        for (size_t k = 0; k < list.count; k++) {
            const iso_stroke *stroke = iso_stroke_at(&list, k);
            assert_int_equal(stroke->number, wanted[i].number[k]);
            assert_int_equal(stroke->muted, wanted[i].muted >> stroke->number & 1);
        }
        assert_true(list.count == 6 || !wanted[i].number[list.count]);
        assert_is_fresh(session);
    }
    assert_string_equal(iso_history_name(iso_session_history(session), 12), "delete legs");
    iso_stroke_list_free(&list);
    iso_session_destroy(session);
}

static void draw_dab(iso_session *session, const iso_brush *brush, iso_vec3 at) {
    iso_sample sample = {.position = at, .normal = {0, 0, 1}, .pressure = 1};
    assert_int_equal(iso_session_begin(session, brush, &sample, NULL, NULL), ISO_OK);
    sample.position.x += 1;
    assert_int_equal(iso_session_sample(session, &sample, NULL, NULL), ISO_OK);
    assert_int_equal(iso_session_end(session, NULL), ISO_OK);
}

static iso_vec3 place_of(const iso_session *session, unsigned number, size_t sample) {
    iso_stroke_list list = {.count = 0};
    assert_int_equal(iso_session_strokes(session, &list, NULL), ISO_OK);
    const iso_vec3 place = iso_stroke_find(&list, number)->samples[sample].position;
    iso_stroke_list_free(&list);
    return place;
}

/* A knob shrinks under strokes that lie on it and on one another: reseated they lie on it again, as high. */
static void reseated_strokes_follow_the_surface(void **state) {
    (void)state;
    const char *journal = session_path("reseat.strokes");
    session_remove_files(journal);
    iso_session_opts opts = {.journal = journal, .checkpoint_strokes = -1};
    iso_session *session = session_open(&opts);
    const double ball = SESSION_START.radius;
    iso_brush knob = {.tool = ISO_TOOL_ADD, .radius = 3};
    const iso_brush bead = {.tool = ISO_TOOL_ADD, .radius = 1}, drag = {.tool = ISO_TOOL_MOVE, .radius = 1};
    const iso_sample sample = {.position = {0, 0, ball}, .normal = {0, 0, 1}, .pressure = 1};
    assert_int_equal(iso_session_begin(session, &knob, &sample, NULL, NULL), ISO_OK);
    assert_int_equal(iso_session_end(session, NULL), ISO_OK);
    draw_dab(session, &bead, iso_vec3_make(0, 0, ball + 3.2)); /* 2: a little above the knob */
    draw_dab(session, &bead, iso_vec3_make(0, 0, ball + 4.2)); /* 3: on that bead */
    draw_dab(session, &drag, iso_vec3_make(0, -ball, 0));      /* 4: somewhere else */
    draw_dab(session, &drag, iso_vec3_make(0, 0, ball + 5.2)); /* 5: what it grips lies on the bead */
    knob.radius = 2;
    iso_event event = {.kind = ISO_EVENT_EDIT, .first = 1, .last = 1, .brush = knob};
    assert_int_equal(iso_session_edit(session, &event, NULL), ISO_OK);
    session_field floating = session_field_of(session);
    event = (iso_event){.kind = ISO_EVENT_RESEAT, .first = 2, .last = 5};
    assert_int_equal(iso_session_edit(session, &event, NULL), ISO_OK);
    assert_is_fresh(session);
    assert_true(fabs(place_of(session, 2, 0).z - (ball + 2.2)) < 0.02);
    assert_true(fabs(place_of(session, 3, 0).z - (ball + 3.2)) < 0.05);
    assert_true(place_of(session, 4, 0).z == 0 && place_of(session, 4, 0).y == -ball);
    assert_true(fabs(place_of(session, 5, 0).z - (ball + 4.2)) < 0.08);
    assert_true(place_of(session, 5, 1).z == place_of(session, 5, 0).z); /* a drag moves as a whole */
    session_field seated = session_field_of(session);
    /* once more: nothing has moved since */
    assert_int_equal(iso_session_edit(session, &event, NULL), ISO_OK);
    assert_true(session_is(session, &seated));
    /* undone and redone as a step, and in the journal with the places that were found */
    assert_int_equal(iso_session_undo(session, NULL), ISO_OK);
    assert_int_equal(iso_session_undo(session, NULL), ISO_OK);
    assert_true(session_is(session, &floating));
    assert_int_equal(iso_session_redo(session, NULL), ISO_OK);
    assert_true(session_is(session, &seated));
    iso_session_destroy(session);
    opts.resume = true;
    session = session_open(&opts);
    assert_true(session_is(session, &seated));
    iso_session_destroy(session);
    session_field_free(&floating);
    session_field_free(&seated);
    session_remove_files(journal);
}

/* iso_progress.tell: cancels when it has been asked often enough. */
static int cancel_later(void *context, double fraction) {
    int *left = context;
    (void)fraction;
    return (*left)-- <= 0;
}

/* An edit in parts: strokes and undo wait for its end; what is cancelled or not kept changes nothing. */
static void edits_are_made_in_parts(void **state) {
    (void)state;
    uint32_t seed = 17;
    const iso_event event = {.kind = ISO_EVENT_MUTE, .first = 2, .last = 2};
    const iso_sample sample = {.position = {10, 0, 0}, .normal = {1, 0, 0}, .pressure = 1};
    const iso_brush brush = {.tool = ISO_TOOL_ADD, .radius = 2};
    for (int aside = 0; aside < 2; aside++) {
        iso_session *session =
            session_open(&(iso_session_opts){.checkpoint_strokes = -1, .edits_aside = aside});
        for (int i = 0; i < 6; i++) draw(session, &seed, 0);
        const size_t steps = iso_history_count(iso_session_history(session));
        session_field before = session_field_of(session);
        for (int calls = 0; calls < 12; calls++) { /* (the last ones with versions that are complete) */
            int left = 7 * calls;
            const iso_progress progress = {.tell = cancel_later, .context = &left};
            iso_error error = {0};
            assert_int_equal(iso_session_begin_edit(session, calls % 3 ? &event : NULL, NULL), ISO_OK);
            assert_int_equal(iso_session_begin_edit(session, &event, NULL), ISO_ERR_USAGE);
            assert_int_equal(iso_session_begin(session, &brush, &sample, NULL, &error), ISO_ERR_USAGE);
            assert_string_equal(error.text, "strokes are being edited");
            assert_int_equal(iso_session_undo(session, NULL), ISO_ERR_USAGE);
            const iso_status status = iso_session_draw_edit(session, &progress, &error);
            assert_true(status == ISO_OK || status == ISO_ERR_IO);
            if (calls == 0) assert_int_equal(status, ISO_ERR_IO);
            assert_int_equal(iso_session_end_edit(session, false, NULL), ISO_OK);
            assert_true(session_is(session, &before));
        }
        assert_int_equal(iso_history_count(iso_session_history(session)), steps);
        assert_int_equal(iso_session_edit(session, &event, NULL), ISO_OK);
        assert_is_fresh(session);
        assert_int_equal(iso_history_count(iso_session_history(session)), steps + 1);
        assert_string_equal(iso_history_name(iso_session_history(session), steps), "mute 2");
        session_field_free(&before);
        iso_session_destroy(session);
    }
}

/* The stroke that moved the surface at a place last is found. */
static void strokes_are_found(void **state) {
    (void)state;
    iso_session *session = open_ball(&LARGE, 0);
    const iso_vec3 at[3] = {{30, 0, 0}, {30, 3, 0}, {0, 0, 30}};
    for (int i = 0; i < 3; i++) {
        const iso_brush brush = {.tool = i == 1 ? ISO_TOOL_CARVE : ISO_TOOL_ADD, .radius = 2};
        const iso_sample sample = {.position = at[i], .normal = iso_vec3_unit(at[i]), .pressure = 1};
        assert_int_equal(iso_session_begin(session, &brush, &sample, NULL, NULL), ISO_OK);
        assert_int_equal(iso_session_end(session, NULL), ISO_OK);
    }
    const struct {
        iso_vec3 place;
        unsigned number;
    } cases[] = {{{31.9, -0.4, 0}, 1}, {{28.1, 3, 0}, 2},  {{0, 0, 32}, 3},
                 {{-30, 0, 0}, 0},     {{0, 1e9, 0}, 0},   {{0, -43.8, 0}, 0},
                 {{30, 1, 0}, 2},      {{29.9, -3, 0}, 0}, {{NAN, 0, 0}, 0}};
    assert_int_equal(iso_session_stroke_at(session, cases[0].place), 0); /* there are no versions */
    assert_int_equal(iso_session_begin_edit(session, NULL, NULL), ISO_OK);
    assert_int_equal(iso_session_draw_edit(session, NULL, NULL), ISO_OK);
    assert_int_equal(iso_session_end_edit(session, true, NULL), ISO_OK);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        assert_int_equal(iso_session_stroke_at(session, cases[i].place), cases[i].number);
    iso_session_destroy(session);
}

/* What was edited is in the journal, also when checkpoints were made before and after. */
static void journals_hold_edits(void **state) {
    (void)state;
    for (int checkpoints = 0; checkpoints < 2; checkpoints++) {
        const char *journal = session_path("edits.strokes");
        session_remove_files(journal);
        iso_session_opts opts = {.journal = journal, .checkpoint_strokes = checkpoints ? 4 : -1};
        iso_session *session = session_open(&opts);
        uint32_t seed = 60 + (uint32_t)checkpoints;
        for (int i = 0; i < 12; i++) draw(session, &seed, 0);
        for (int i = 0; i < 14; i++) edit(session, i % EDIT_KINDS, &seed);
        iso_event event = {.kind = ISO_EVENT_GROUP, .first = 1, .last = 12, .text = "a \"group\""};
        assert_int_equal(iso_session_edit(session, &event, NULL), ISO_OK);
        assert_int_equal(iso_session_undo(session, NULL), ISO_OK);
        assert_int_equal(iso_session_redo(session, NULL), ISO_OK);
        session_field wanted = session_field_of(session);
        iso_session_destroy(session);
        opts.resume = true;
        opts.checkpoint_strokes = -1;
        for (int again = 0; again < 2; again++) {
            session = session_open(&opts);
            assert_true(session_is(session, &wanted));
            if (again) break;
            edit(session, 0, &seed); /* it can be continued */
            assert_is_fresh(session);
            session_field_free(&wanted);
            wanted = session_field_of(session);
            iso_session_destroy(session);
        }
        iso_session_destroy(session);
        session_field_free(&wanted);
        session_remove_files(journal);
    }
}

int main(int argc, char **argv) {
    if (argc > 1) cmocka_set_test_filter(argv[1]);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(edits_equal_a_fresh_replay), cmocka_unit_test(only_what_is_reached_is_drawn),
        cmocka_unit_test(refusals_change_nothing),    cmocka_unit_test(edits_are_made_in_parts),
        cmocka_unit_test(strokes_are_found),          cmocka_unit_test(journals_hold_edits),
        cmocka_unit_test(groups_are_edited),          cmocka_unit_test(reseated_strokes_follow_the_surface),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
