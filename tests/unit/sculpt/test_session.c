/* Sessions lose nothing: undo and redo restore every bit, the journal replays to the same field, and what was
 * written survives kill -9, incomplete lines and lack of memory. */
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmocka.h>

#include "base/clock.h"
#include "file_support.h"
#include "sculpt/field/checkpoint.h"
#include "sculpt/session/session.h"
#include "session_support.h"

/* Plays events with the first `tools` tools; an undo or redo that there is nothing for is refused and not
 * recorded. */
static void play_tools(iso_session *session, int tools, int events, uint32_t seed) {
    bool drawing = false;
    for (int i = 0; i < events || drawing; i++) {
        iso_event event = session_random_event(&seed, tools, &drawing);
        iso_error error = {0};
        iso_status status = iso_session_play(session, &event, NULL, &error);
        if (status != ISO_OK && event.kind != ISO_EVENT_UNDO && event.kind != ISO_EVENT_REDO)
            fail_msg("%s", error.text);
    }
}

static void play_random(iso_session *session, int events, uint32_t seed) {
    play_tools(session, ISO_TOOL_TRIM_PLANE, events, seed);
}

/* ---- history */

static void undo_restores_every_bit(void **state) {
    (void)state;
    enum { STROKES = 24 };
    for (int round = 0; round < 2; round++) {
        const char *journal = session_path("undo.strokes");
        unlink(journal);
        /* the second time hardly anything may stay in memory */
        iso_session_opts opts = {
            .undo_memory = round ? 20000 : 0, .journal = journal, .checkpoint_strokes = -1};
        iso_session *session = session_open(&opts);
        iso_history *history = iso_session_history(session);
        session_field before[STROKES + 1];
        uint32_t seed = 77;
        for (int i = 0; i < STROKES;) {
            before[i] = session_field_of(session);
            iso_brush brush = session_random_brush(&seed, ISO_TOOL_TRIM_PLANE);
            iso_vec3 at = iso_vec3_scale(session_random_sample(&seed).normal, 10);
            iso_sample sample = {.position = at, .normal = iso_vec3_unit(at), .pressure = 1}, next = sample;
            next.position = iso_vec3_scale(iso_vec3_unit(iso_vec3_add(at, iso_vec3_make(3, 1, 2))), 10);
            assert_int_equal(iso_session_begin(session, &brush, &sample, NULL, NULL), ISO_OK);
            assert_int_equal(iso_session_sample(session, &next, NULL, NULL), ISO_OK);
            assert_int_equal(iso_session_end(session, NULL), ISO_OK);
            if (iso_history_count(history) == (size_t)i + 1)
                i++;
            else /* nothing changed: no step */
                session_field_free(&before[i]);
        }
        before[STROKES] = session_field_of(session);
        if (round) assert_true(iso_history_spilled(history) > 0 && iso_history_bytes(history) < 400000);
        for (int walk = 0; walk < 3; walk++) {
            for (int i = STROKES; i-- > 0;) {
                assert_int_equal(iso_session_undo(session, NULL), ISO_OK);
                assert_true(session_is(session, &before[i]));
            }
            assert_int_equal(iso_session_undo(session, NULL), ISO_ERR_USAGE);
            for (int i = 1; i <= STROKES; i++) {
                assert_int_equal(iso_session_redo(session, NULL), ISO_OK);
                assert_true(session_is(session, &before[i]));
            }
            assert_int_equal(iso_session_redo(session, NULL), ISO_ERR_USAGE);
        }
        assert_true(strlen(iso_history_name(history, 0)) > 0);
        iso_session_destroy(session);
        for (int i = 0; i <= STROKES; i++) session_field_free(&before[i]);
        unlink(journal);
    }
}

static void cancelled_strokes_leave_nothing(void **state) {
    (void)state;
    iso_session_opts opts = {0};
    iso_session *session = session_open(&opts);
    uint32_t seed = 5;
    for (int i = 0; i < 20; i++) {
        session_field before = session_field_of(session);
        iso_brush brush = session_random_brush(&seed, ISO_TOOL_TRIM_PLANE);
        iso_sample sample = session_random_sample(&seed), next = session_random_sample(&seed);
        assert_int_equal(iso_session_begin(session, &brush, &sample, NULL, NULL), ISO_OK);
        assert_int_equal(iso_session_begin(session, &brush, &sample, NULL, NULL), ISO_ERR_USAGE);
        assert_int_equal(iso_session_sample(session, &next, NULL, NULL), ISO_OK);
        assert_int_equal(iso_session_cancel(session, NULL), ISO_OK);
        assert_true(session_is(session, &before));
        session_field_free(&before);
    }
    assert_int_equal(iso_history_count(iso_session_history(session)), 0);
    assert_int_equal(iso_session_sample(session, &(iso_sample){.pressure = 1}, NULL, NULL), ISO_ERR_USAGE);
    iso_session_destroy(session);
}

/* ---- journal */

static void check_resumes_to(const char *journal, const session_field *wanted) {
    iso_session_opts opts = {.journal = journal, .resume = true, .checkpoint_strokes = -1};
    iso_session *session = session_open(&opts);
    assert_true(session_is(session, wanted));
    iso_session_destroy(session);
}

/* With and without snapshots, whole or with some of them gone; and it can be continued. */
static void journals_resume_to_the_same_bits(void **state) {
    (void)state;
    for (int checkpoints = 0; checkpoints < 3; checkpoints++) {
        const char *journal = session_path("resume.strokes");
        session_remove_files(journal);
        iso_session_opts opts = {.journal = journal, .checkpoint_strokes = checkpoints ? 4 : -1};
        iso_session *session = session_open(&opts);
        play_random(session, 70, 31 + (uint32_t)checkpoints);
        session_field wanted = session_field_of(session);
        iso_session_destroy(session);
        if (checkpoints == 2) /* the newest is damaged */
            for (int i = 40; i > 0; i--) {
                char name[600];
                snprintf(name, sizeof name, "%s.%d.snapshot", journal, i);
                if (access(name, F_OK)) continue;
                FILE *file = fopen(name, "r+b");
                assert_non_null(file);
                fseek(file, 1000, SEEK_SET);
                fputs("wrong", file);
                fclose(file);
                break;
            }
        check_resumes_to(journal, &wanted);
        opts.resume = true;
        session = session_open(&opts);
        play_random(session, 30, 99);
        session_field_free(&wanted);
        wanted = session_field_of(session);
        iso_session_destroy(session);
        check_resumes_to(journal, &wanted);
        session_field_free(&wanted);
        session_remove_files(journal);
    }
}

/* Events that can be read; -1 when the file ends in damage. */
static int count_events(const char *path, iso_status *status, iso_error *error) {
    iso_journal_start start;
    iso_journal_reader *reader;
    *status = iso_journal_open(path, &start, &reader, error);
    if (*status != ISO_OK) return -1;
    iso_event event;
    bool more = true;
    int count = 0;
    while ((*status = iso_journal_next(reader, &event, &more, error)) == ISO_OK && more) count++;
    iso_journal_reader_free(reader);
    return count;
}

static void torn_and_damaged_lines(void **state) {
    (void)state;
    const char *journal = session_path("short.strokes"), *part = session_path("part.strokes");
    session_remove_files(journal);
    iso_session_opts opts = {.journal = journal, .checkpoint_strokes = -1};
    iso_session *session = session_open(&opts);
    play_random(session, 60, 8);
    iso_session_destroy(session);
    size_t size, header = 0;
    char *bytes = slurp(journal, &size);
    while (bytes[header++] != '\n') {
    }
    iso_error error = {0};
    iso_status status;
    int whole = count_events(journal, &status, &error);
    assert_true(whole >= 20 && status == ISO_OK);
    for (size_t cut = 1; cut <= size; cut += cut < header + 600 ? 1 : 37) { /* truncated anywhere */
        spill(part, bytes, cut);
        int lines = 0;
        for (size_t i = 0; i < cut; i++) lines += bytes[i] == '\n';
        int got = count_events(part, &status, &error);
        if (cut < header) {
            assert_int_equal(status, ISO_ERR_FORMAT);
        } else {
            assert_int_equal(status, ISO_OK);
            assert_int_equal(got, lines - 1);
        }
    }
    /* a byte changed in the middle is found and named; what stands before it is delivered */
    int found = 0;
    for (size_t at = header; at < size - 400; at += 97) {
        char old = bytes[at];
        bytes[at] = old == 'x' ? 'y' : 'x';
        spill(part, bytes, size);
        bytes[at] = old;
        int got = count_events(part, &status, &error);
        if (old == '\n') continue; /* two lines become one: damaged as well, but numbered otherwise */
        int line = 1;
        for (size_t i = 0; i < at; i++) line += bytes[i] == '\n';
        char wanted[32];
        snprintf(wanted, sizeof wanted, "line %d:", line);
        assert_int_equal(status, ISO_ERR_FORMAT);
        if (!strstr(error.text, wanted)) fail_msg("'%s' does not say %s", error.text, wanted);
        assert_int_equal(got, line - 2);
        found++;
    }
    assert_true(found > 20);
    /* appending after an incomplete line */
    spill(part, bytes, size - 5);
    iso_journal *more;
    assert_int_equal(iso_journal_append(part, &more, &error), ISO_OK);
    iso_event undo;
    memset(&undo, 0, sizeof undo);
    undo.kind = ISO_EVENT_UNDO;
    assert_int_equal(iso_journal_put(more, &undo, NULL), ISO_OK);
    assert_int_equal(iso_journal_close(more, NULL), ISO_OK);
    assert_int_equal(count_events(part, &status, &error), whole);
    assert_int_equal(status, ISO_OK);
    free(bytes);
    session_remove_files(journal);
    unlink(part);
}

/* How the source is read comes back; what older programs can play is written so that they do. */
static void readings_come_back(void **state) {
    (void)state;
    static const struct {
        const char *reading;
        double isovalue;
        int version;
    } cases[] = {{"", 0, 1}, {"", 3.5, 2}, {"raw=4x5x6:int16:big:12\ngrid=a \"b\" = c\ncomponent=1\n", 0, 2}};
    const char *journal = session_path("reading.strokes");
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        iso_journal *j;
        iso_journal_start start = SESSION_START, got;
        iso_journal_reader *reader;
        char line[4096] = "", version[32];
        unlink(journal);
        strcpy(start.reading, cases[i].reading);
        start.isovalue = cases[i].isovalue;
        assert_int_equal(iso_journal_create(journal, &start, &j, NULL), ISO_OK);
        assert_int_equal(iso_journal_close(j, NULL), ISO_OK);
        assert_int_equal(iso_journal_open(journal, &got, &reader, NULL), ISO_OK);
        assert_string_equal(got.reading, cases[i].reading);
        assert_true(got.isovalue == cases[i].isovalue && got.voxel_isovalue == (cases[i].version == 1));
        iso_journal_reader_free(reader);
        FILE *file = fopen(journal, "r");
        assert_true(file && fgets(line, sizeof line, file));
        fclose(file);
        snprintf(version, sizeof version, "\"version\":%d,", cases[i].version);
        assert_non_null(strstr(line, version));
    }
    unlink(journal);
}

static void numbers_come_back_exactly(void **state) {
    (void)state;
    const char *journal = session_path("numbers.strokes");
    unlink(journal);
    iso_journal *j;
    iso_journal_start start = SESSION_START, got_start;
    strcpy(start.source, "a \"quoted\\ path \xc3\xa9\n.vdb");
    start.source_crc = 0xfedcba98u;
    start.isovalue = -1.2345678901234567e+299;
    assert_int_equal(iso_journal_create(journal, &start, &j, NULL), ISO_OK);
    uint32_t seed = 4;
    enum { EVENTS = 200 };
    iso_event *put = calloc(EVENTS, sizeof *put);
    assert_non_null(put);
    for (int i = 0; i < EVENTS; i++) {
        put[i].kind = i % 2 ? ISO_EVENT_SAMPLE : ISO_EVENT_BEGIN;
        put[i].sample = session_random_sample(&seed);
        put[i].sample.position.x *= pow(10, (int)(uniform(&seed) * 34) - 30); /* (limits.h) */
        if (put[i].kind == ISO_EVENT_BEGIN) put[i].brush = session_random_brush(&seed, ISO_TOOL_TRIM_PLANE);
        assert_int_equal(iso_journal_put(j, &put[i], NULL), ISO_OK);
    }
    assert_int_equal(iso_journal_close(j, NULL), ISO_OK);
    assert_int_equal(iso_journal_create(journal, &start, &j, NULL), ISO_ERR_WRITE); /* never over another */
    iso_journal_reader *reader;
    assert_int_equal(iso_journal_open(journal, &got_start, &reader, NULL), ISO_OK);
    assert_string_equal(got_start.source, start.source);
    assert_true(got_start.source_crc == start.source_crc && got_start.origin.x == start.origin.x &&
                got_start.isovalue == start.isovalue);
    for (int i = 0; i < EVENTS; i++) {
        iso_event got;
        bool more;
        assert_int_equal(iso_journal_next(reader, &got, &more, NULL), ISO_OK);
        assert_true(more && got.kind == put[i].kind);
        assert_memory_equal(&got.sample, &put[i].sample, sizeof got.sample);
        assert_true(got.brush.radius == put[i].brush.radius && got.brush.tool == put[i].brush.tool &&
                    got.brush.symmetry == put[i].brush.symmetry &&
                    got.brush.strength == put[i].brush.strength);
    }
    iso_journal_reader_free(reader);
    free(put);
    unlink(journal);
}

static iso_event event_at(iso_event_kind kind, iso_vec3 position) {
    iso_event event;
    memset(&event, 0, sizeof event);
    event.kind = kind;
    event.brush = (iso_brush){.tool = ISO_TOOL_MASK, .radius = 400};
    event.sample = (iso_sample){.position = position, .normal = {0, 0, 1}, .pressure = 1};
    return event;
}

/* What a stroke file may ask for is bounded, not what a hand does. */
static void work_is_bounded(void **state) {
    (void)state;
    const double far = 1e4;
    const iso_session_opts opts = {.cost_factor = 1e-4};
    iso_session *session = session_open(&opts);
    iso_error error = {0};
    iso_event event = event_at(ISO_EVENT_BEGIN, iso_vec3_make(0, 0, 0));
    event.brush.spacing = 0.01;
    iso_status status = ISO_OK;
    int played = 0;
    for (; status == ISO_OK && played < 100; played++) {
        status = iso_session_play(session, &event, NULL, &error);
        event = event_at(ISO_EVENT_SAMPLE, iso_vec3_make(played % 2 ? -far : far, 0, 0));
    }
    assert_int_equal(status, ISO_ERR_FORMAT);
    assert_non_null(strstr(error.text, "more work"));
    assert_in_range(played, 2, 20);
    /* by hand: as much as there is time for */
    assert_int_equal(iso_session_sample(session, &event.sample, NULL, &error), ISO_OK);
    assert_int_equal(iso_session_end(session, &error), ISO_OK);
    /* undone again and again */
    event = (iso_event){.kind = ISO_EVENT_UNDO};
    assert_int_equal(iso_session_play(session, &event, NULL, &error), ISO_ERR_FORMAT);
    assert_int_equal(iso_session_undo(session, &error), ISO_OK);
    iso_session_destroy(session);
}

/* One sample makes no more touches than ISO_LIMIT_TOUCHES, by whomever, and then makes none. */
static void touches_are_bounded(void **state) {
    (void)state;
    const iso_session_opts opts = {0};
    iso_session *session = session_open(&opts);
    iso_error error = {0};
    iso_brush brush = {.tool = ISO_TOOL_ADD, .radius = 1e-30};
    iso_sample sample = {.normal = {0, 0, 1}, .pressure = 1};
    assert_int_equal(iso_session_begin(session, &brush, &sample, NULL, &error), ISO_OK);
    sample.position.x = 1;
    iso_edit_stats stats = {0};
    assert_int_equal(iso_session_sample(session, &sample, &stats, &error), ISO_ERR_USAGE);
    assert_non_null(strstr(error.text, "touches"));
    assert_int_equal(iso_session_cancel(session, &error), ISO_OK);
    iso_session_destroy(session);
}

/* A session with a journal accepts only events that can be read back and replayed. */
static void what_cannot_be_played_is_not_recorded(void **state) {
    (void)state;
    const char *journal = session_path("bounds.strokes");
    session_remove_files(journal);
    iso_session_opts opts = {.journal = journal, .checkpoint_strokes = -1};
    iso_session *session = session_open(&opts);
    iso_error error = {0};
    iso_brush brush = {.tool = ISO_TOOL_ADD, .radius = 1e6};
    iso_sample sample = {.normal = {0, 0, 1}, .pressure = 1};
    assert_int_equal(iso_session_begin(session, &brush, &sample, NULL, &error), ISO_ERR_USAGE);
    brush.radius = 4;
    assert_int_equal(iso_session_begin(session, &brush, &sample, NULL, &error), ISO_OK);
    sample.position.x = 1e9;
    assert_int_equal(iso_session_sample(session, &sample, NULL, &error), ISO_ERR_USAGE);
    assert_int_equal(iso_session_end(session, &error), ISO_OK);
    session_field wanted = session_field_of(session);
    iso_session_destroy(session);
    check_resumes_to(journal, &wanted);
    session_field_free(&wanted);
    session_remove_files(journal);
}

/* /dev/full refuses every byte: it is said, what was put is kept, and the session goes on. */
static void full_disks_are_said(void **state) {
    (void)state;
    if (access("/dev/full", W_OK)) {
        print_message("no /dev/full: left out\n");
        return;
    }
    const char *journal = session_path("full.strokes");
    unlink(journal);
    iso_journal *j;
    iso_error error = {0};
    assert_int_equal(iso_journal_create(journal, &SESSION_START, &j, NULL), ISO_OK);
    assert_int_equal(iso_journal_close(j, NULL), ISO_OK);
    assert_int_equal(iso_journal_create("/no/such/folder/x.strokes", &SESSION_START, &j, &error),
                     ISO_ERR_WRITE);
    assert_non_null(strstr(error.text, "/no/such/folder"));
    const char *link = session_path("link.strokes");
    unlink(link);
    assert_int_equal(symlink("/dev/full", link), 0);
    iso_status status = iso_journal_create(link, &SESSION_START, &j, &error);
    assert_int_equal(status, ISO_ERR_WRITE);
    unlink(link);
    unlink(journal);
}

static iso_status wait_for_journal(iso_session *session, bool well, iso_error *error) {
    iso_status status = ISO_OK;
    for (int i = 0; i < 100; i++) {
        status = iso_session_journal_status(session, error);
        if ((status == ISO_OK) == well) break;
        usleep(50000);
    }
    return status;
}

/* A disk that fills up in the middle of a line: the error is reported, editing goes on, and when there is
 * room again all of it is written. A second time there is never room: what had been written can be opened. */
static void disks_that_fill_up_lose_nothing(void **state) {
    (void)state;
    struct rlimit before, full;
    assert_int_equal(getrlimit(RLIMIT_FSIZE, &before), 0);
    void (*handler)(int) = signal(SIGXFSZ, SIG_IGN);
    for (int round = 0; round < 2; round++) {
        const char *journal = session_path("filling.strokes");
        iso_error error = {0};
        session_remove_files(journal);
        const iso_session_opts opts = {.journal = journal, .checkpoint_strokes = 3, .undo_memory = 20000};
        iso_session *session = session_open(&opts);
        full = before;
        full.rlim_cur = 7001;
        assert_int_equal(setrlimit(RLIMIT_FSIZE, &full), 0);
        /* without the tools that freeze everything, after which strokes change nothing */
        play_tools(session, ISO_TOOL_CLEAR_MASK, 60, 6);
        assert_int_equal(wait_for_journal(session, false, &error), ISO_ERR_WRITE);
        assert_non_null(strstr(error.text, "kept in memory"));
        play_tools(session, ISO_TOOL_CLEAR_MASK, 40, 7);
        while (iso_session_undo(session, NULL) == ISO_OK) {
        }
        while (iso_session_redo(session, NULL) == ISO_OK) {
        }
        session_field wanted = session_field_of(session);
        if (round == 0) {
            assert_int_equal(setrlimit(RLIMIT_FSIZE, &before), 0);
            assert_int_equal(wait_for_journal(session, true, &error), ISO_OK);
        }
        iso_session_destroy(session);
        assert_int_equal(setrlimit(RLIMIT_FSIZE, &before), 0);
        if (round == 0)
            check_resumes_to(journal, &wanted);
        else {
            iso_session_opts again = {.journal = journal, .resume = true, .checkpoint_strokes = -1};
            session = session_open(&again);
            assert_true(iso_history_count(iso_session_history(session)) > 3);
            iso_session_destroy(session);
        }
        session_field_free(&wanted);
        session_remove_files(journal);
    }
    signal(SIGXFSZ, handler);
}

/* A folder that can no longer be written: no snapshots, nothing to spill undo steps to, and still all of them
 * can be undone; a new session says that it has no journal. */
static void read_only_folders_lose_nothing(void **state) {
    (void)state;
    const char *folder = session_path("folder");
    char journal[600], other[600];
    mkdir(folder, 0777);
    snprintf(journal, sizeof journal, "%s/a.strokes", folder);
    snprintf(other, sizeof other, "%s/b.strokes", folder);
    session_remove_files(journal);
    const iso_session_opts opts = {.journal = journal, .checkpoint_strokes = 2, .undo_memory = 20000};
    iso_session *session = session_open(&opts);
    session_field first = session_field_of(session);
    const uid_t user = geteuid();
    assert_int_equal(chmod(folder, 0555), 0);
    if (user == 0) assert_int_equal(seteuid(65534), 0); /* who may do everything would see no such folder */
    play_random(session, 50, 6);
    while (iso_session_undo(session, NULL) == ISO_OK) {
    }
    assert_true(session_is(session, &first));
    while (iso_session_redo(session, NULL) == ISO_OK) {
    }
    assert_int_equal(iso_history_spilled(iso_session_history(session)), 0);
    iso_error error = {0};
    iso_journal *none;
    assert_int_equal(iso_journal_create(other, &SESSION_START, &none, &error), ISO_ERR_WRITE);
    assert_non_null(strstr(error.text, other));
    if (user == 0) assert_int_equal(seteuid(user), 0);
    assert_int_equal(chmod(folder, 0777), 0);
    session_field now = session_field_of(session);
    iso_session_destroy(session);
    check_resumes_to(journal, &now);
    session_field_free(&first);
    session_field_free(&now);
    session_remove_files(journal);
    rmdir(folder);
}

/* ---- kill -9 */

/* Plays strokes until it is killed, and says so after each. */
static void play_until_killed(const char *journal, uint32_t seed, int said) {
    iso_session_opts opts = {.journal = journal, .checkpoint_strokes = 5};
    iso_session *session = session_open(&opts);
    for (;;) {
        iso_brush brush = session_random_brush(&seed, ISO_TOOL_TRIM_PLANE);
        iso_sample sample = session_random_sample(&seed), next = session_random_sample(&seed);
        if (iso_session_begin(session, &brush, &sample, NULL, NULL) != ISO_OK) _exit(1);
        if (iso_session_sample(session, &next, NULL, NULL) != ISO_OK) _exit(1);
        if (iso_session_end(session, NULL) != ISO_OK) _exit(1);
        double now = iso_clock_seconds();
        if (write(said, &now, sizeof now) != sizeof now) _exit(1);
    }
}

static int ended_strokes(const char *journal) {
    iso_journal_start start;
    iso_journal_reader *reader;
    assert_int_equal(iso_journal_open(journal, &start, &reader, NULL), ISO_OK);
    iso_event event;
    bool more = true;
    int ended = 0;
    while (iso_journal_next(reader, &event, &more, NULL) == ISO_OK && more)
        ended += event.kind == ISO_EVENT_END;
    iso_journal_reader_free(reader);
    return ended;
}

/* Waits, and returns by how many seconds the machine was late at most: other processes are as late then. */
static double wait_for(double seconds) {
    const double begin = iso_clock_seconds();
    double late = 0;
    for (double now = begin, then; now < begin + seconds; now = then) {
        usleep(10000);
        then = iso_clock_seconds();
        if (then - now - 0.01 > late) late = then - now - 0.01;
    }
    return late;
}

static void killed_sessions_survive(void **state) {
    (void)state;
    const char *text = getenv("ISO_TEST_KILLS");
    int rounds = text ? atoi(text) : 3;
    uint32_t seed = 1;
    for (int round = 0; round < rounds; round++) {
        const char *journal = session_path("killed.strokes");
        int said[2], finished = 0;
        session_remove_files(journal);
        assert_int_equal(pipe(said), 0);
        pid_t child = fork();
        assert_true(child >= 0);
        if (child == 0) {
            close(said[0]);
            play_until_killed(journal, (uint32_t)round + 50, said[1]);
        }
        close(said[1]);
        const double late = wait_for(1.2 + 0.8 * uniform(&seed));
        double killed = iso_clock_seconds(), at;
        kill(child, SIGKILL);
        waitpid(child, NULL, 0);
        while (read(said[0], &at, sizeof at) == sizeof at) finished += at < killed - 1 - late;
        close(said[0]);
        int ended = ended_strokes(journal);
        if (ended < finished)
            fail_msg("round %d: %d strokes were finished a second before, %d survived", round, finished,
                     ended);
        /* what is recovered is what the same events make */
        iso_session_opts opts = {.journal = journal, .resume = true, .checkpoint_strokes = -1}, plain = {0};
        iso_session *recovered = session_open(&opts), *again = session_open(&plain);
        iso_journal_start start;
        iso_journal_reader *reader;
        assert_int_equal(iso_journal_open(journal, &start, &reader, NULL), ISO_OK);
        iso_event event;
        bool more = true;
        while (iso_journal_next(reader, &event, &more, NULL) == ISO_OK && more)
            assert_int_equal(iso_session_play(again, &event, NULL, NULL), ISO_OK);
        iso_journal_reader_free(reader);
        session_field wanted = session_field_of(again);
        assert_true(session_is(recovered, &wanted));
        session_field_free(&wanted);
        iso_session_destroy(recovered);
        iso_session_destroy(again);
        session_remove_files(journal);
    }
}

/* ---- snapshots */

static void snapshots_round_trip(void **state) {
    (void)state;
    const char *path = session_path("round.snapshot"), *bad = session_path("bad.snapshot");
    iso_session_opts opts = {0};
    iso_session *session = session_open(&opts);
    const iso_brush paint = {.tool = ISO_TOOL_PAINT, .radius = 4, .has_color = true, .color = {9, 80, 200}};
    const iso_sample sample = {.position = {0, 0, 10}, .normal = {0, 0, 1}, .pressure = 1};
    play_tools(session, ISO_TOOL_CLEAR_MASK, 40, 12); /* leaves a mask */
    assert_int_equal(iso_session_begin(session, &paint, &sample, NULL, NULL), ISO_OK);
    assert_int_equal(iso_session_end(session, NULL), ISO_OK);
    iso_hgrid *grid = iso_session_grid(session), *other;
    const iso_field_items *wanted = iso_session_items(session);
    iso_field_items items;
    assert_true(wanted->of[ISO_ITEM_MASK].used > 0);
    assert_true(wanted->of[ISO_ITEM_PAINT].used > 0);
    assert_int_equal(iso_field_items_init(&items, wanted->of[0].cells, NULL), ISO_OK);
    assert_int_equal(iso_checkpoint_write(path, grid, wanted, NULL), ISO_OK);
    assert_int_equal(iso_session_solid(&SESSION_START, &other, NULL), ISO_OK);
    assert_int_equal(iso_checkpoint_read(path, other, &items, NULL), ISO_OK);
    assert_true(sculpt_same(grid, other) && session_same_items(&items, wanted));
    size_t size;
    char *bytes = slurp(path, &size);
    iso_hgrid *before = sculpt_copy(other);
    for (size_t at = 0; at < size; at += 1 + size / 50) {
        bytes[at] = (char)(bytes[at] ^ 4);
        spill(bad, bytes, size);
        bytes[at] = (char)(bytes[at] ^ 4);
        assert_int_equal(iso_checkpoint_read(bad, other, &items, NULL), ISO_ERR_FORMAT);
        spill(bad, bytes, at);
        assert_int_equal(iso_checkpoint_read(bad, other, &items, NULL), ISO_ERR_FORMAT);
    }
    assert_true(sculpt_same(before, other) && session_same_items(&items, wanted));
    assert_int_equal(iso_checkpoint_read("/no/such.snapshot", other, &items, NULL), ISO_ERR_IO);
    free(bytes);
    iso_field_items_free(&items);
    iso_hgrid_destroy(before);
    iso_hgrid_destroy(other);
    iso_session_destroy(session);
    unlink(path);
    unlink(bad);
}

/* ---- strokes */

/* The ball that a stroke drags along keeps its volume. */
static void moving_keeps_the_volume(void **state) {
    (void)state;
    iso_session_opts opts = {0};
    iso_journal_start start = {
        .source = "ball", .voxel_size = 1, .dims = {128, 64, 64}, .origin = {-40, -31, -31}, .radius = 12};
    iso_hgrid *grid;
    iso_session *session;
    assert_int_equal(iso_session_solid(&start, &grid, NULL), ISO_OK);
    assert_int_equal(iso_session_create(grid, &start, &opts, &session, NULL), ISO_OK);
    double before = sculpt_volume(grid);
    iso_brush brush = {.tool = ISO_TOOL_MOVE, .falloff = ISO_FALLOFF_CONSTANT, .radius = 20};
    iso_sample sample = {.normal = {1, 0, 0}, .pressure = 1};
    assert_int_equal(iso_session_begin(session, &brush, &sample, NULL, NULL), ISO_OK);
    for (int i = 1; i <= 20; i++) {
        sample.position.x = i;
        assert_int_equal(iso_session_sample(session, &sample, NULL, NULL), ISO_OK);
    }
    for (int i = 19; i >= -5; i--) { /* there and back and there again */
        sample.position.x = i;
        assert_int_equal(iso_session_sample(session, &sample, NULL, NULL), ISO_OK);
    }
    sample.position.x = 20;
    assert_int_equal(iso_session_sample(session, &sample, NULL, NULL), ISO_OK);
    assert_int_equal(iso_session_end(session, NULL), ISO_OK);
    double after = sculpt_volume(grid);
    print_message("volume %.0f before, %.0f after\n", before, after);
    assert_true(fabs(after / before - 1) < 0.02);
    const iso_grid any = {.hgrid = grid};
    assert_true(iso_grid_sample(&any, iso_vec3_make(40 + 20, 31, 31)) < -2.9);
    assert_true(iso_grid_sample(&any, iso_vec3_make(40 - 5, 31, 31)) > 2.9);
    assert_int_equal(iso_session_undo(session, NULL), ISO_OK);
    assert_true(fabs(sculpt_volume(grid) - before) < 1e-9);
    iso_session_destroy(session);
}

/* A drag puts back what it did before and drags anew: that must not grow from sample to sample. */
static void moving_costs_what_it_reaches(void **state) {
    (void)state;
    iso_session_opts opts = {0};
    iso_session *session = session_open(&opts);
    iso_brush brush = {.tool = ISO_TOOL_MOVE, .radius = 3, .strength = 1};
    iso_sample sample = {.position = {0, 0, 10}, .normal = {0, 0, 1}, .pressure = 1};
    iso_edit_stats first = {0}, last = {0};
    assert_int_equal(iso_session_begin(session, &brush, &sample, NULL, NULL), ISO_OK);
    for (int i = 0; i < 60; i++) {
        sample.position.z += i % 2 ? 0.5 : -0.45;
        memset(&last, 0, sizeof last);
        assert_int_equal(iso_session_sample(session, &sample, &last, NULL), ISO_OK);
        if (i == 0) first = last;
    }
    print_message("cells edited by the first sample %zu, by the last %zu\n", first.edited, last.edited);
    assert_true(first.edited > 0 && last.edited <= 2 * first.edited + 8);
    iso_session_destroy(session);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(moving_costs_what_it_reaches),
                                       cmocka_unit_test(undo_restores_every_bit),
                                       cmocka_unit_test(cancelled_strokes_leave_nothing),
                                       cmocka_unit_test(journals_resume_to_the_same_bits),
                                       cmocka_unit_test(torn_and_damaged_lines),
                                       cmocka_unit_test(readings_come_back),
                                       cmocka_unit_test(numbers_come_back_exactly),
                                       cmocka_unit_test(work_is_bounded),
                                       cmocka_unit_test(touches_are_bounded),
                                       cmocka_unit_test(what_cannot_be_played_is_not_recorded),
                                       cmocka_unit_test(full_disks_are_said),
                                       cmocka_unit_test(disks_that_fill_up_lose_nothing),
                                       cmocka_unit_test(read_only_folders_lose_nothing),
                                       cmocka_unit_test(killed_sessions_survive),
                                       cmocka_unit_test(snapshots_round_trip),
                                       cmocka_unit_test(moving_keeps_the_volume)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
