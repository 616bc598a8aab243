/* base: geometry, packed points, the thread pool, sinks. */
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/inotify.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>

#include "base/cgroup.h"
#include "base/cpu.h"
#include "base/file.h"
#include "base/file_blocks.h"
#include "base/file_set.h"
#include "base/geometry.h"
#include "base/memory.h"
#include "base/numbers.h"
#include "base/parallel.h"
#include "base/primitives.h"
#include "base/text.h"
#include "check_support.h"

static void sincos_matches_libm(void **state) {
    (void)state;
    for (double angle = -1000; angle < 1000; angle += 0.01371) {
        double sine, cosine;
        iso_sincos(angle, &sine, &cosine);
        near(sine, sin(angle), 1e-14);
        near(cosine, cos(angle), 1e-14);
    }
    near(iso_tan(ISO_PI / 12), tan(ISO_PI / 12), 1e-14);
}

static void affine_inverts_itself(void **state) {
    (void)state;
    uint32_t seed = 1;
    for (int round = 0; round < 100; round++) {
        iso_transform transform = iso_transform_identity();
        for (int i = 0; i < 9; i++) transform.direction[i] = uniform(&seed) - 0.5;
        for (int i = 0; i < 3; i++) {
            transform.spacing[i] = 0.1 + uniform(&seed);
            transform.origin[i] = 100 * uniform(&seed);
        }
        if (fabs(iso_transform_affine(&transform).determinant) < 1e-3) continue;
        assert_false(iso_transform_is_singular(&transform));
        iso_affine affine = iso_transform_affine(&transform);
        iso_vec3 p = {7 * uniform(&seed), 9 * uniform(&seed), 5 * uniform(&seed)};
        iso_vec3 q = iso_affine_point_to_index(&affine, iso_affine_point(&affine, p));
        near(iso_vec3_length(iso_vec3_sub(p, q)), 0, 1e-9);
        /* a covector applied to a vector does not change under the transform */
        iso_vec3 n = {1, 2, 3}, v = {3, 0, -1}; /* perpendicular in index space */
        near(iso_vec3_dot(iso_affine_normal(&affine, n), iso_affine_vector(&affine, v)), 0, 1e-9);
    }
    iso_transform flat = iso_transform_identity();
    flat.direction[8] = 0;
    assert_true(iso_transform_is_singular(&flat));
}

static void packed_points_keep_their_precision(void **state) {
    (void)state;
    uint32_t seed = 7;
    double worst_position = 0, worst_normal = 0;
    for (int round = 0; round < 300000; round++) {
        iso_surfel surfel;
        float length = 0;
        for (int axis = 0; axis < 3; axis++) {
            surfel.position[axis] = (float)(-2 + 19.99 * uniform(&seed));
            surfel.normal[axis] = (float)(2 * uniform(&seed) - 1);
            length += surfel.normal[axis] * surfel.normal[axis];
        }
        if (length < 1e-3f) continue;
        for (int axis = 0; axis < 3; axis++) surfel.normal[axis] /= sqrtf(length);
        iso_surfel back = iso_point_unpack(iso_point_pack(&surfel));
        double chord = 0;
        for (int axis = 0; axis < 3; axis++) {
            worst_position = fmax(worst_position, fabs(back.position[axis] - surfel.position[axis]));
            chord += pow(back.normal[axis] - surfel.normal[axis], 2);
        }
        worst_normal = fmax(worst_normal, 2 * asin(sqrt(chord) / 2) * 180 / ISO_PI);
    }
    near(worst_position, 0.0006, 0.0001); /* half a step, reached and not exceeded */
    near(worst_normal, 0.115, 0.015);
}

static void cleaned(const char *text, const char *wanted) {
    char clean[256];
    assert_int_equal(iso_text_clean(text, clean, sizeof clean), strlen(wanted));
    assert_string_equal(clean, wanted);
    assert_int_equal(iso_text_begins(clean, text), strlen(wanted));
}

static void text_becomes_one_printable_line(void **state) {
    (void)state;
    cleaned("", "");
    cleaned("a b/c.nrrd", "a b/c.nrrd");
    cleaned("two\nlines\r\tand\x1b[31m \x7f", "two\\nlines\\r\\tand\\x1b[31m \\x7f");
    cleaned("K\xc3\xb6rper \xe2\x82\xac \xf0\x9f\xa6\xb4", "K\xc3\xb6rper \xe2\x82\xac \xf0\x9f\xa6\xb4");
    cleaned("\xff\xc3(\xe2\x82", "\\xff\\xc3(\\xe2\\x82");          /* no sequences, one without its end */
    cleaned("\xc0\xaf \xed\xa0\x80", "\\xc0\\xaf \\xed\\xa0\\x80"); /* overlong, a surrogate */
    cleaned("\xc2\x9b"
            "31m",
            "\\xc2\\x9b31m"); /* the C1 control that begins sequences */
    cleaned("\xe2\x80\xae"
            "gpj\xe2\x80\xa8",
            "\\xe2\\x80\\xaegpj\\xe2\\x80\\xa8");      /* order, line separator */
    cleaned("back\\slash \\x1b", "back\\slash \\x1b"); /* clean text stays as it is */
    assert_int_equal(iso_text_begins("b: reason", "a"), 0);
    assert_int_equal(iso_text_begins("a\\x1b: reason", "a\x1b"), 5);
}

static void names_end_in_extensions(void **state) {
    (void)state;
    assert_true(iso_text_ends_with("a.ply", ".ply"));
    assert_true(iso_text_ends_with(".ply", ".ply"));
    assert_false(iso_text_ends_with("a.PLY", ".ply"));
    assert_false(iso_text_ends_with("ply", ".ply"));
    assert_true(iso_text_has_extension("a.NII.gz", ".nii.GZ"));
    assert_false(iso_text_has_extension(".gz", ".gz"));
    assert_int_equal(iso_text_mark("\xef\xbb\xbfx", 4), 3);
    assert_int_equal(iso_text_mark("\xef\xbb", 2), 0);
    assert_null(iso_text_wide("\xef\xbb\xbfx", 4));
    assert_string_equal(iso_text_wide("\xfe\xff\0x", 4), "UTF-16");
    assert_string_equal(iso_text_wide("\xff\xfex\0", 4), "UTF-16");
    assert_string_equal(iso_text_wide("\xff\xfe\0\0", 4), "UTF-32");
    assert_null(iso_text_wide("\xff", 1));
    assert_false(iso_text_has_extension("a.gz.x", ".gz"));
    for (int i = -3; i < 9; i++) assert_int_equal(iso_clamp_index(i, 5), i < 0 ? 0 : i > 4 ? 4 : i);
}

static void text_that_is_too_long_keeps_both_ends(void **state) {
    (void)state;
    char text[301] = "", clean[64];
    for (int i = 0; i < 100; i++) memcpy(text + 3 * i, "\xe2\x82\xac", 4);
    for (size_t room = 1; room <= sizeof clean; room++) {
        iso_text_clean(text, clean, room);
        assert_true(strlen(clean) < room);
        for (const char *c = clean; *c; c += iso_text_utf8(c)) assert_true(iso_text_utf8(c) > 0);
    }
    assert_non_null(strstr(clean, "\xe2\x82\xac...\xe2\x82\xac"));
    for (int i = 0; i < 300; i++) text[i] = '\x1b';
    for (size_t room = 17; room <= sizeof clean; room++) {
        iso_text_clean(text, clean, room);
        assert_true(strstr(clean, "...") && (strlen(clean) - 3) % 4 == 0); /* whole escapes */
    }
    char cut[8] = "abcd\xe2\x82", whole[8] = "ab\x1b"
                                             "c";
    iso_text_clean_in_place(cut, 7); /* its end was cut off by the room */
    assert_string_equal(cut, "abcd");
    iso_text_clean_in_place(whole, sizeof whole);
    assert_string_equal(whole, "ab\\x1bc");
}

static void errors_are_one_clean_line(void **state) {
    (void)state;
    char path[2000];
    iso_error error = {0};
    iso_fail(&error, ISO_ERR_IO, "%s: cannot read: %s", "a\nb\x1b]0;x\x07\xff", "why");
    assert_string_equal(error.text, "a\\nb\\x1b]0;x\\x07\\xff: cannot read: why");
    iso_fail(&error, ISO_ERR_IO, "in.nrrd: %s", error.text); /* its own text is an argument */
    assert_string_equal(error.text, "in.nrrd: a\\nb\\x1b]0;x\\x07\\xff: cannot read: why");
    memset(path, 'p', sizeof path);
    path[sizeof path - 1] = 0;
    iso_fail(&error, ISO_ERR_IO, "%s: cannot read: why", path);
    assert_int_equal(strlen(error.text), sizeof error.text - 1);
    assert_string_equal(error.text + strlen(error.text) - 18, ": cannot read: why");
}

static void set_text(const char *path) {
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    fputs(path, file);
    fclose(file);
}

/* The status and text when `read` is read and `a` and `b` are written. */
static iso_status clash(const char *read, const char *a, const char *b, iso_error *error) {
    iso_file_set files = {0};
    if (read) iso_file_set_read(&files, read);
    iso_file_set_write(&files, a);
    iso_file_set_write(&files, b);
    iso_status status = iso_file_set_check(&files, error);
    iso_file_set_free(&files);
    return status;
}

static void files_are_known_under_every_name(void **state) {
    (void)state;
    iso_error error = {0};
    char folder[] = "base_files_XXXXXX", before[4096];
    assert_non_null(getcwd(before, sizeof before));
    assert_non_null(mkdtemp(folder));
    assert_int_equal(chdir(folder), 0);
    set_text("in");
    assert_int_equal(link("in", "hard"), 0);
    assert_int_equal(symlink("in", "soft"), 0);
    assert_int_equal(symlink("soft", "softer"), 0);
    assert_int_equal(symlink("new", "dangling"), 0);
    assert_int_equal(symlink("circle", "circle"), 0);
    assert_int_equal(clash("in", "new", "other", &error), ISO_OK);
    const char *const names[] = {"in", "./in", "hard", "soft", "softer"};
    for (int i = 0; i < 5; i++) {
        assert_int_equal(clash("in", "new", names[i], &error), ISO_ERR_USAGE);
        assert_non_null(strstr(error.text, names[i]));
        assert_non_null(strstr(error.text, "input in"));
        assert_int_equal(clash(names[i], "in", NULL, NULL), ISO_ERR_USAGE);
    }
    assert_int_equal(clash(NULL, "new", "../base_none/new", NULL), ISO_OK); /* a folder that is not there */
    assert_int_equal(clash(NULL, "new", "./new", &error), ISO_ERR_USAGE);
    assert_non_null(strstr(error.text, "./new: is the same file as another output, new"));
    assert_int_equal(clash(NULL, "dangling", "new", NULL), ISO_ERR_USAGE);
    assert_int_equal(clash("in", "/dev/null", "/dev/null", NULL), ISO_OK);

    assert_int_equal(clash("in", "circle", "new", NULL), ISO_OK);
    iso_file_set_read(NULL, "in");
    char *target = iso_file_follow("softer");
    assert_string_equal(target, "in");
    free(target);
    assert_null(iso_file_follow("circle"));
    iso_sink sink;
    assert_int_equal(iso_sink_open("circle", &sink, &error), ISO_ERR_WRITE);
    const char *const made[] = {"in", "hard", "soft", "softer", "dangling", "circle"};
    for (int i = 0; i < 6; i++) unlink(made[i]);
    assert_int_equal(chdir(before), 0);
    assert_int_equal(rmdir(folder), 0);
}

typedef struct tally {
    unsigned char done[10000];
    int workers;
} tally;

static void mark(void *context, size_t index, int worker) {
    tally *t = context;
    t->done[index]++;
    if (worker < 0 || worker >= t->workers) t->done[index] = 100;
}

static void every_index_runs_once(void **state) {
    (void)state;
    const int counts[] = {1, 2, 7};
    for (int i = 0; i < 3; i++) {
        iso_pool *pool = NULL;
        assert_int_equal(iso_pool_create(counts[i], &pool, NULL), ISO_OK);
        assert_int_equal(iso_pool_threads(pool), counts[i]);
        for (int round = 0; round < 200; round++) {
            tally t = {.workers = counts[i]};
            size_t count = (size_t)(round * 50);
            iso_parallel_for(pool, count, mark, &t);
            for (size_t k = 0; k < sizeof t.done; k++) assert_int_equal(t.done[k], k < count);
        }
        iso_pool_destroy(pool);
    }
    iso_pool *pool = NULL;
    iso_error error = {0};
    assert_int_equal(iso_pool_create(-1, &pool, &error), ISO_ERR_USAGE);
    assert_non_null(strstr(error.text, "-1"));
    assert_null(pool);
}

/* What goes through slots: each holds the index that is in it, and what has been done with it. Plain data:
 * the thread sanitizer sees whether anybody looks at a slot out of turn. */
enum { ORDERED_ITEMS = 3000, ORDERED_SLOTS = 64 };
typedef struct ordered_tally {
    size_t slot[ORDERED_SLOTS], placed, moved;
    size_t place_of[ORDERED_ITEMS]; /* by index: 1 + how many were placed before it */
    size_t *array;                  /* moves now and then, with nobody writing to it */
    unsigned char finished[ORDERED_ITEMS];
} ordered_tally;

static void ordered_work(void *context, size_t index, size_t slot, int worker) {
    ordered_tally *t = context;
    (void)worker;
    volatile unsigned spin = (unsigned)(index * 2654435761u) >> 20; /* some take longer */
    while (spin) spin--;
    t->slot[slot] = index;
}

static bool ordered_place(void *context, size_t slot, bool alone) {
    ordered_tally *t = context;
    if (t->placed % 7 == 3) {
        if (!alone) return false;
        size_t *moved = malloc(ORDERED_ITEMS * sizeof *moved);
        assert_non_null(moved);
        memcpy(moved, t->array, ORDERED_ITEMS * sizeof *moved);
        free(t->array);
        t->array = moved;
        t->moved++;
    }
    t->place_of[t->slot[slot]] = ++t->placed;
    return true;
}

static void ordered_finish(void *context, size_t slot) {
    ordered_tally *t = context;
    const size_t index = t->slot[slot];
    t->array[index] = index + 1;
    t->finished[index]++;
}

static void results_are_placed_in_order(void **state) {
    (void)state;
    const int threads[] = {1, 2, 7};
    static ordered_tally t;
    for (int i = 0; i < 3; i++) {
        iso_pool *pool = NULL;
        assert_int_equal(iso_pool_create(threads[i], &pool, NULL), ISO_OK);
        for (int round = 0; round < 20; round++) {
            const size_t count = round < 3 ? (size_t)round : ORDERED_ITEMS - (size_t)round;
            iso_ordered steps = {ordered_work, ordered_place, ordered_finish, iso_ordered_slots(pool)};
            assert_true(steps.slots >= (size_t)threads[i] && steps.slots <= ORDERED_SLOTS);
            if (round % 4 == 3) steps.slots = (size_t)threads[i] / 2 + 1; /* fewer are right too */
            memset(&t, 0, sizeof t);
            t.array = calloc(ORDERED_ITEMS, sizeof *t.array);
            assert_non_null(t.array);
            iso_parallel_ordered(pool, count, &steps, &t);
            for (size_t k = 0; k < count; k++) {
                assert_int_equal(t.place_of[k], k + 1);
                assert_int_equal(t.finished[k], 1);
                assert_int_equal(t.array[k], k + 1);
            }
            assert_int_equal(t.placed, count);
            assert_true(count < 4 || t.moved >= count / 7);
            free(t.array);
        }
        iso_pool_destroy(pool);
    }
}

/* Cancels after so many calls. */
static bool cancel_later(void *context, double fraction) {
    (void)fraction;
    return --*(int *)context < 0;
}

/* What was begun before the cancelling is finished, in order and without holes; the next loop is whole. */
static void cancelled_loops_end(void **state) {
    (void)state;
    static ordered_tally t;
    const int threads[] = {1, 2, 7};
    for (int i = 0; i < 3; i++) {
        iso_pool *pool = NULL;
        assert_int_equal(iso_pool_create(threads[i], &pool, NULL), ISO_OK);
        for (int round = 0; round < 60; round++) {
            int calls = round * 5;
            const iso_ordered steps = {ordered_work, ordered_place, ordered_finish,
                                       (size_t)threads[i] / 2 + 1};
            memset(&t, 0, sizeof t);
            t.array = calloc(ORDERED_ITEMS, sizeof *t.array);
            assert_non_null(t.array);
            iso_pool_watch(pool, cancel_later, &calls);
            iso_parallel_ordered(pool, ORDERED_ITEMS, &steps, &t);
            assert_true(iso_pool_is_cancelled(pool) || t.placed == ORDERED_ITEMS);
            assert_true(t.placed < ORDERED_ITEMS || threads[i] > 1);
            for (size_t k = 0; k < ORDERED_ITEMS; k++) {
                assert_int_equal(t.place_of[k], k < t.placed ? k + 1 : 0);
                assert_int_equal(t.finished[k], k < t.placed);
            }
            free(t.array);
            tally whole = {.workers = threads[i]}, part = {.workers = threads[i]};
            iso_parallel_until(pool, sizeof part.done, mark, &part);
            assert_true(part.done[sizeof part.done - 1] == 0 || !iso_pool_is_cancelled(pool));
            iso_pool_watch(pool, NULL, NULL);
            assert_false(iso_pool_is_cancelled(pool));
            iso_parallel_until(pool, sizeof whole.done, mark, &whole);
            for (size_t k = 0; k < sizeof whole.done; k++) assert_int_equal(whole.done[k], 1);
        }
        iso_pool_destroy(pool);
    }
}

static bool no_nameless_files; /* as on file systems that have none */

int __real_access(const char *path, int mode);
int __wrap_access(const char *path, int mode);
int __wrap_access(const char *path, int mode) {
    return no_nameless_files ? -1 : __real_access(path, mode);
}

/* What a folder holds beside "." and "..". */
static int count_files(const char *folder) {
    DIR *listing = opendir(folder);
    int count = -2;
    assert_non_null(listing);
    while (readdir(listing)) count++;
    closedir(listing);
    return count;
}

static void check_contents(const char *path, const char *wanted) {
    char text[16] = "";
    FILE *file = fopen(path, "r");
    assert_non_null(file);
    assert_non_null(fgets(text, sizeof text, file));
    fclose(file);
    assert_string_equal(text, wanted);
}

static void write_text(const char *path, const char *text) {
    iso_sink sink;
    iso_error error = {0};
    assert_int_equal(iso_sink_open(path, &sink, &error), ISO_OK);
    fputs(text, sink.stream);
    assert_int_equal(iso_sink_commit(&sink, &error), ISO_OK);
    iso_sink_abort(&sink); /* harmless after commit */
}

/* Files appear whole, replace what was there and leave nothing else; `before_commit` files are seen while one
 * is being written. */
static void check_sink(const char *folder, int before_commit) {
    char path[512];
    snprintf(path, sizeof path, "%s/sink.txt", folder);
    iso_sink sink;
    iso_error error = {0};
    assert_int_equal(iso_sink_open(path, &sink, &error), ISO_OK);
    fputs("half", sink.stream);
    assert_int_equal(count_files(folder), before_commit);
    iso_sink_abort(&sink);
    assert_int_equal(count_files(folder), 0);

    write_text(path, "whole");
    check_contents(path, "whole");
    chmod(path, 0640);
    write_text(path, "second");
    check_contents(path, "second");
    struct stat info;
    assert_int_equal(stat(path, &info), 0);
    assert_int_equal(info.st_mode & 0777, 0640);
    assert_int_equal(count_files(folder), 1);
    remove(path);
}

/* A temporary name that a killed program has left is used again, or removed; one that a running program has
 * locked, and what is no file, stay. */
static void temporary_names_are_used_again(void **state) {
    (void)state;
    char folder[] = ISO_TEST_TMP "/names.XXXXXX", path[512], name[3][520];
    assert_non_null(mkdtemp(folder));
    snprintf(path, sizeof path, "%s/sink.txt", folder);
    for (int i = 0; i < 3; i++) snprintf(name[i], sizeof name[i], "%s.isonew%d", path, i + 1);
    for (int without = 0; without < 2; without++) {
        no_nameless_files = without;
        const int locked = open(name[0], O_CREAT | O_WRONLY, 0600);
        assert_true(locked >= 0);
        assert_int_equal(flock(locked, LOCK_EX | LOCK_NB), 0);
        assert_int_equal(symlink("elsewhere", name[1]), 0);
        write_text(name[2], "left");
        write_text(path, "first");
        assert_int_equal(access(name[2], F_OK), -1);
        write_text(path, "second");
        check_contents(path, "second");
        assert_int_equal(count_files(folder), 3);
        close(locked);
        remove(name[1]);
        iso_file_remove_unfinished(path);
        assert_int_equal(count_files(folder), 1);
        remove(path);
    }
    no_nameless_files = false;
    rmdir(folder);
}

/* A writer that waits for the reader of a FIFO still waits after the FIFO was refused. */
static void fifos_are_refused_unopened(void **state) {
    (void)state;
    static const char path[] = ISO_TEST_TMP "/refused.fifo";
    char event[sizeof(struct inotify_event) + NAME_MAX + 1];
    FILE *stream;
    iso_error error = {0};
    unlink(path);
    assert_int_equal(mkfifo(path, 0600), 0);
    const int watch = inotify_init1(IN_NONBLOCK);
    assert_true(inotify_add_watch(watch, path, IN_OPEN) >= 0);
    assert_int_equal(iso_file_open(path, &stream, NULL, &error), ISO_ERR_IO);
    assert_int_equal(iso_file_head(path, event, sizeof event), 0);
    assert_int_equal(read(watch, event, sizeof event), -1);
    assert_int_equal(errno, EAGAIN);
    close(watch);
    unlink(path);
}

/* What nobody has asked for is not written through links, nor over what is no such file. */
static void own_files_replace_their_own(void **state) {
    (void)state;
    char folder[] = ISO_TEST_TMP "/own.XXXXXX", path[512], other[512];
    iso_sink sink;
    iso_error error = {0};
    assert_non_null(mkdtemp(folder));
    snprintf(path, sizeof path, "%s/own", folder);
    snprintf(other, sizeof other, "%s/other", folder);
    for (int round = 0; round < 2; round++) { /* a new file; the same again */
        assert_int_equal(iso_sink_open_own(path, "MARK", 4, &sink, &error), ISO_OK);
        fprintf(sink.stream, "MARK %d", round);
        assert_int_equal(iso_sink_commit(&sink, &error), ISO_OK);
        check_contents(path, round ? "MARK 1" : "MARK 0");
    }
    write_text(other, "MARK of another");
    remove(path);
    for (int kind = 0; kind < 4; kind++) {
        if (kind == 0) assert_int_equal(symlink(other, path), 0);
        if (kind == 1) assert_int_equal(mkfifo(path, 0600), 0);
        if (kind == 2) assert_int_equal(mkdir(path, 0700), 0);
        if (kind == 3) write_text(path, "MAR");
        assert_int_equal(iso_sink_open_own(path, "MARK", 4, &sink, &error), ISO_ERR_WRITE);
        check_contents(other, "MARK of another");
        remove(path);
    }
    remove(other);
    assert_int_equal(count_files(folder), 0);
    rmdir(folder);
}

static void sinks_write_all_or_nothing(void **state) {
    (void)state;
    char folder[] = ISO_TEST_TMP "/sink.XXXXXX";
    assert_non_null(mkdtemp(folder));
    no_nameless_files = true;
    check_sink(folder, 1);
    no_nameless_files = false;
    int nameless = open(folder, O_TMPFILE | O_WRONLY, 0600);
    check_sink(folder, nameless < 0);
    if (nameless >= 0) close(nameless);
    rmdir(folder);

    iso_sink sink;
    iso_error error = {0};
    assert_int_equal(iso_sink_open("/nonexistent/folder/x", &sink, &error), ISO_ERR_WRITE);
    assert_non_null(strstr(error.text, "/nonexistent/folder/x"));
    assert_int_equal(iso_sink_open("/", &sink, &error), ISO_ERR_WRITE);

    FILE *full = fopen("/dev/full", "w");
    if (full) {
        sink = (iso_sink){.stream = full};
        fputs("lost", full);
        assert_int_equal(iso_sink_commit(&sink, &error), ISO_ERR_WRITE);
        assert_non_null(strstr(error.text, "No space left"));
        fclose(full);
    }
}

static void buffers_keep_their_contents(void **state) {
    (void)state;
    iso_buffer buffer = {0};
    assert_int_equal(iso_buffer_reserve(&buffer, 10, 0, NULL), ISO_OK);
    memcpy(buffer.data, "012345678", 10);
    assert_int_equal(iso_buffer_reserve(&buffer, 5 << 20, 10, NULL), ISO_OK);
    assert_string_equal((char *)buffer.data, "012345678");
    assert_int_equal((uintptr_t)buffer.data % ISO_ALIGNMENT, 0);
    assert_int_equal(iso_buffer_reserve(&buffer, SIZE_MAX / 2, 10, NULL), ISO_ERR_NOMEM);
    assert_string_equal((char *)buffer.data, "012345678");
    iso_buffer_free(&buffer);
    size_t product;
    assert_false(iso_size_multiply(SIZE_MAX / 2, 3, &product));
    assert_true(iso_memory_available() > 0);
    assert_true(iso_memory_peak() > 0);
}

/* A large buffer that grows never takes twice its memory. */
static void buffers_move_piece_by_piece(void **state) {
    (void)state;
    enum { MEGABYTE = 1 << 20, FIRST = 96 };
    iso_buffer buffer = {0};
    assert_int_equal(iso_buffer_reserve(&buffer, FIRST * MEGABYTE, 0, NULL), ISO_OK);
    uint32_t *words = buffer.data;
    for (uint32_t i = 0; i < FIRST * MEGABYTE / 4; i++) words[i] = i * 2654435761u;
    FILE *peak = fopen("/proc/self/clear_refs", "w");
    if (peak) fputs("5", peak); /* the peak becomes what is taken now */
    const bool is_measured = peak && fclose(peak) == 0;
    const uint64_t before = iso_number_in_file("/proc/self/status", "VmHWM:");
    assert_int_equal(iso_buffer_reserve(&buffer, 2 * FIRST * MEGABYTE, FIRST * MEGABYTE - 5, NULL), ISO_OK);
    const uint64_t most = iso_number_in_file("/proc/self/status", "VmHWM:");
    words = buffer.data;
    for (uint32_t i = 0; i < FIRST * MEGABYTE / 4 - 2; i++) assert_int_equal(words[i], i * 2654435761u);
#ifdef ADDRESS_SANITIZER /* which notes an eighth of what is allocated */
    const uint64_t beside = 2 * FIRST * 1024 / 8;
#else
    const uint64_t beside = 0;
#endif
    if (is_measured) assert_in_range(most, before, before + 24 * 1024 + beside);
    iso_buffer_free(&buffer);
}

/* All blocks together stay below the limit; what is freed can be had again. */
static void memory_is_limited(void **state) {
    (void)state;
    enum { MEGABYTE = 1 << 20 };
    iso_memory_set_limit(20 * MEGABYTE);
    void *first = iso_alloc(12 * MEGABYTE);
    assert_non_null(first);
    assert_false(iso_memory_was_refused());
    assert_null(iso_alloc(12 * MEGABYTE));
    assert_null(iso_alloc_zero(12, MEGABYTE));
    assert_true(iso_memory_was_refused());
    iso_free(first);
    for (int i = 0; i < 100; i++) {
        void *block = i % 2 ? iso_alloc(12 * MEGABYTE) : iso_alloc_zero(12, MEGABYTE);
        assert_non_null(block);
        iso_free(block);
    }
    void *some[6]; /* no more is counted than was asked for */
    iso_memory_set_limit(200 * MEGABYTE);
    for (int i = 0; i < 6; i++) {
        some[i] = iso_alloc(33 * MEGABYTE);
        assert_non_null(some[i]);
        assert_int_equal((uintptr_t)some[i] % ISO_ALIGNMENT, 0);
    }
    for (int i = 0; i < 6; i++) iso_free(some[i]);
    iso_memory_set_limit(UINT64_MAX);
    first = iso_alloc(50 * MEGABYTE);
    assert_non_null(first);
    iso_free(first);
}

/* The last test: blocks go on to lie in files. */
static void large_blocks_lie_in_files(void **state) {
    (void)state;
    enum { MEGABYTE = 1 << 20 };
    iso_memory_set_limit(20 * MEGABYTE);
    iso_memory_use_files();
    unsigned char *first = iso_alloc(12 * MEGABYTE), *second = iso_alloc(12 * MEGABYTE),
                  *third = iso_alloc_zero(12, MEGABYTE);
    assert_non_null(first);
    if (!second && iso_file_blocks_problem() && strstr(iso_file_blocks_problem(), "tmpfs")) {
        iso_free(first);
        iso_memory_set_limit(UINT64_MAX);
        skip();
    }
    assert_non_null(second);
    assert_non_null(third);
    assert_int_equal(iso_memory_in_files(), 24 * MEGABYTE);
    memset(second, 7, 12 * MEGABYTE);
    for (int i = 0; i < 12 * MEGABYTE; i++) assert_true(third[i] == 0 && second[i] == 7);
    iso_buffer buffer = {0};
    assert_int_equal(iso_buffer_reserve(&buffer, 2 * MEGABYTE, 0, NULL), ISO_OK);
    memset(buffer.data, 5, 2 * MEGABYTE);
    assert_int_equal(iso_buffer_reserve(&buffer, 9 * MEGABYTE, 2 * MEGABYTE, NULL), ISO_OK);
    assert_int_equal(((unsigned char *)buffer.data)[2 * MEGABYTE - 1], 5);
    iso_buffer_free(&buffer);
    iso_free(second);
    iso_free(third);
    iso_free(first);

    assert_null(iso_file_blocks_problem());
    const char *folder = getenv("TMPDIR");
    setenv("TMPDIR", "/nonexistent/folder", 1);
    assert_null(iso_alloc(21 * MEGABYTE));
    assert_string_equal(iso_file_blocks_problem(), "No such file or directory");
    if (folder)
        setenv("TMPDIR", folder, 1);
    else
        unsetenv("TMPDIR");
    iso_memory_set_limit(UINT64_MAX);
    first = iso_alloc(50 * MEGABYTE);
    iso_free(first);
    assert_in_range(iso_memory_in_files(), 33 * MEGABYTE, 35 * MEGABYTE);
}

static void cpu_level_can_be_limited(void **state) {
    (void)state;
    iso_cpu_level best = iso_cpu_best();
    assert_true(best <= iso_cpu_supported());
    for (int level = 0; level < ISO_CPU_LEVELS; level++) {
        iso_cpu_level wanted = level < (int)best ? (iso_cpu_level)level : best;
        assert_int_equal(iso_cpu_limit((iso_cpu_level)level), wanted);
        assert_int_equal(iso_cpu_best(), wanted);
    }
    assert_int_equal(iso_cpu_limit(ISO_CPU_AVX512), best);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sincos_matches_libm),
        cmocka_unit_test(affine_inverts_itself),
        cmocka_unit_test(packed_points_keep_their_precision),
        cmocka_unit_test(text_becomes_one_printable_line),
        cmocka_unit_test(names_end_in_extensions),
        cmocka_unit_test(text_that_is_too_long_keeps_both_ends),
        cmocka_unit_test(errors_are_one_clean_line),
        cmocka_unit_test(files_are_known_under_every_name),
        cmocka_unit_test(every_index_runs_once),
        cmocka_unit_test(results_are_placed_in_order),
        cmocka_unit_test(cancelled_loops_end),
        cmocka_unit_test(sinks_write_all_or_nothing),
        cmocka_unit_test(temporary_names_are_used_again),
        cmocka_unit_test(fifos_are_refused_unopened),
        cmocka_unit_test(own_files_replace_their_own),
        cmocka_unit_test(buffers_keep_their_contents),
        cmocka_unit_test(buffers_move_piece_by_piece),
        cmocka_unit_test(memory_is_limited),
        cmocka_unit_test(cpu_level_can_be_limited),
        cmocka_unit_test(large_blocks_lie_in_files),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
