/* Snapshots for another thread while the field changes; checkpoints, and resuming that can be cancelled. */
#include <pthread.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "session_support.h"

typedef struct taking {
    iso_snapshot *snapshot;
    iso_hgrid *grid;
    iso_status status;
} taking;

/* Slowly: the writer must have time to change what was not taken yet. */
static int dawdle(void *context, double fraction) {
    (void)context;
    (void)fraction;
    usleep(2000);
    return 0;
}

static void *take(void *context) {
    taking *t = context;
    const iso_progress slow = {.tell = dawdle};
    t->status = iso_snapshot_copy(t->snapshot, &slow, &t->grid, NULL);
    return NULL;
}

static void play(iso_session *session, uint32_t *seed, int events, bool *drawing) {
    for (int i = 0; i < events; i++) {
        iso_event event = session_random_event(seed, ISO_TOOL_TRIM_PLANE, drawing);
        iso_status status = iso_session_play(session, &event, NULL, NULL);
        assert_true(status == ISO_OK || event.kind == ISO_EVENT_UNDO || event.kind == ISO_EVENT_REDO);
    }
}

static void end_stroke(iso_session *session, bool *drawing) {
    if (*drawing) assert_int_equal(iso_session_end(session, NULL), ISO_OK);
    *drawing = false;
}

/* Strokes, undo, redo and cancelled strokes go on while two threads take what was there before. */
static void snapshots_keep_the_old_field(void **state) {
    (void)state;
    iso_session_opts opts = {0};
    iso_session *session = session_open(&opts);
    uint32_t seed = 3;
    bool drawing = false;
    for (int round = 0; round < 60; round++) {
        pthread_t thread[2];
        taking t[2] = {{0}};
        iso_hgrid *wanted[2];
        for (int i = 0; i < 2; i++) {
            play(session, &seed, 4, &drawing);
            end_stroke(session, &drawing);
            wanted[i] = sculpt_copy(iso_session_grid(session));
            assert_int_equal(iso_session_snapshot(session, &t[i].snapshot, NULL), ISO_OK);
            /* what is written before anything is taken must have been kept */
            if (round % 2) play(session, &seed, 3, &drawing);
            end_stroke(session, &drawing);
            assert_int_equal(pthread_create(&thread[i], NULL, take, &t[i]), 0);
        }
        play(session, &seed, 12, &drawing);
        for (int i = 0; i < 2; i++) {
            pthread_join(thread[i], NULL);
            assert_int_equal(t[i].status, ISO_OK);
            assert_true(sculpt_same(t[i].grid, wanted[i]));
            iso_session_release_snapshot(session, t[i].snapshot);
            iso_hgrid_destroy(t[i].grid);
            iso_hgrid_destroy(wanted[i]);
        }
        end_stroke(session, &drawing);
    }
    iso_session_destroy(session);
}

static int refuse(void *context, double fraction) {
    int *left = context;
    (void)fraction;
    return --*left < 0;
}

static void snapshots_are_refused_and_cancelled(void **state) {
    (void)state;
    iso_session_opts opts = {0};
    iso_session *session = session_open(&opts);
    uint32_t seed = 4;
    iso_snapshot *snapshots[ISO_SESSION_SNAPSHOTS], *more;
    iso_hgrid *none;
    iso_error error = {0};
    for (int i = 0; i < ISO_SESSION_SNAPSHOTS; i++)
        assert_int_equal(iso_session_snapshot(session, &snapshots[i], NULL), ISO_OK);
    assert_int_equal(iso_session_snapshot(session, &more, &error), ISO_ERR_USAGE);
    int calls = 0;
    const iso_progress never = {.tell = refuse, .context = &calls};
    assert_int_equal(iso_snapshot_copy(snapshots[0], &never, &none, &error), ISO_ERR_IO);
    assert_non_null(strstr(error.text, "cancelled"));
    for (int i = 0; i < ISO_SESSION_SNAPSHOTS; i++) iso_session_release_snapshot(session, snapshots[i]);
    iso_brush brush = session_random_brush(&seed, 1);
    iso_sample sample = session_random_sample(&seed);
    assert_int_equal(iso_session_begin(session, &brush, &sample, NULL, NULL), ISO_OK);
    assert_int_equal(iso_session_snapshot(session, &more, &error), ISO_ERR_USAGE);
    iso_session_destroy(session);
}

static uint64_t file_size(const char *path) {
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    fseek(file, 0, SEEK_END);
    long size = ftell(file);
    fclose(file);
    return (uint64_t)size;
}

/* Cancelled at any event: the journal is as it was and can be continued later. */
static void resuming_can_be_cancelled(void **state) {
    (void)state;
    const char *journal = session_path("cancelled.strokes");
    session_remove_files(journal);
    iso_session_opts opts = {.journal = journal, .checkpoint_strokes = 3};
    iso_session *session = session_open(&opts);
    uint32_t seed = 5;
    bool drawing = false;
    play(session, &seed, 40, &drawing);
    end_stroke(session, &drawing);
    session_field wanted = session_field_of(session);
    iso_session_destroy(session);
    const uint64_t size = file_size(journal);
    opts.resume = true;
    int done = 0;
    for (int calls = 0; !done && calls < 200; calls += 7) {
        int left = calls;
        const iso_progress some = {.tell = refuse, .context = &left};
        iso_error error = {0};
        iso_hgrid *grid;
        opts.progress = &some;
        assert_int_equal(iso_session_solid(&SESSION_START, &grid, NULL), ISO_OK);
        iso_status status = iso_session_create(grid, &SESSION_START, &opts, &session, &error);
        if (status != ISO_OK) {
            assert_int_equal(status, ISO_ERR_IO);
            assert_non_null(strstr(error.text, "cancelled"));
            assert_int_equal(file_size(journal), size);
            continue;
        }
        done = calls + 1;
        assert_true(session_is(session, &wanted));
        iso_session_destroy(session);
    }
    assert_true(done > 7);
    session_field_free(&wanted);
    session_remove_files(journal);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(snapshots_keep_the_old_field),
                                       cmocka_unit_test(snapshots_are_refused_and_cancelled),
                                       cmocka_unit_test(resuming_can_be_cancelled)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
