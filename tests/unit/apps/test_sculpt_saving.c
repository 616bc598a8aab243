/* Files that isosculpt writes beside others: what a save replaces is kept, never over a file of the user; a
 * program that is killed at any moment leaves no file that nobody wants; nothing is written through links; a
 * journal is open in one program only, whatever its names. */
#include <dirent.h>
#include <math.h>
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmocka.h>

#include "apps/isosculpt/save.h"

static char folder[256];

static const char *in_folder(const char *name) {
    static char path[4][512];
    static int turn;
    turn = (turn + 1) % 4;
    snprintf(path[turn], sizeof path[turn], "%s/%s", folder, name);
    return path[turn];
}

static void write_text(const char *path, const char *text) {
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    fputs(text, file);
    fclose(file);
}

static bool has_text(const char *path, const char *text) {
    char found[64] = "";
    FILE *file = fopen(path, "rb");
    if (!file) return false;
    found[fread(found, 1, sizeof found - 1, file)] = 0;
    fclose(file);
    return strcmp(found, text) == 0;
}

/* The number of files whose names contain a text; with `remove` they are removed. */
static int count_files(const char *text, bool remove) {
    DIR *directory = opendir(folder);
    int count = 0;
    assert_non_null(directory);
    for (struct dirent *entry; (entry = readdir(directory));) {
        if (entry->d_name[0] == '.' || !strstr(entry->d_name, text)) continue;
        count++;
        if (remove) unlink(in_folder(entry->d_name));
    }
    closedir(directory);
    return count;
}

static int make_folder(void **state) {
    (void)state;
    snprintf(folder, sizeof folder, "%s/sculpt_saving_%d", ISO_TEST_TMP, (int)getpid());
    return mkdir(folder, 0700);
}

static int remove_folder(void **state) {
    (void)state;
    count_files("", true);
    return rmdir(folder);
}

/* A small solid, which is saved in a few milliseconds. */
static iso_status new_document(isosculpt_document *document, const char *mesh) {
    const iso_source source = {.path = mesh, .isovalue = NAN, .voxel = 1, .close_holes = INFINITY};
    write_text(mesh, "v 0 0 0\nv 9 0 0\nv 0 9 0\nv 0 0 9\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n");
    return isosculpt_document_new(document, folder, &source, NULL);
}

static iso_status save(isosculpt_document *document, const char *path) {
    iso_status status = ISO_ERR_IO;
    const isosculpt_save_opts how = {.path = path};
    const iso_status started = isosculpt_document_save(document, &how, NULL);
    if (started != ISO_OK) return started;
    isosculpt_document_poll_save(document, true, &status, NULL);
    return status;
}

/* Sessions keep what they replace as .bak, .bak-2 ..: each replaces its own last one only. */
static void files_of_the_user_stay(void **state) {
    (void)state;
    char target[512];
    snprintf(target, sizeof target, "%s", in_folder("solid.stl"));
    write_text(target, "first");
    write_text(in_folder("solid.stl.bak"), "of the user");
    for (int session = 0; session < 2; session++) {
        isosculpt_document document = {0};
        assert_int_equal(new_document(&document, in_folder("mesh.obj")), ISO_OK);
        for (int i = 0; i < 3; i++) assert_int_equal(save(&document, target), ISO_OK);
        isosculpt_document_close(&document);
        assert_true(has_text(in_folder("solid.stl.bak"), "of the user"));
        assert_int_equal(count_files("solid.stl", false), 3 + session);
    }
    assert_int_equal(count_files("isonew", false), 0);
    count_files("", true);
}

/* A file's bytes; *size: how many. */
static char *read_bytes(const char *path, size_t *size) {
    static char bytes[2][1 << 14];
    static int turn;
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    turn = 1 - turn;
    *size = fread(bytes[turn], 1, sizeof bytes[turn], file);
    fclose(file);
    return bytes[turn];
}

static bool same_bytes(const char *a, const char *b) {
    size_t sizes[2];
    const char *first = read_bytes(a, &sizes[0]), *second = read_bytes(b, &sizes[1]);
    return sizes[0] == sizes[1] && memcmp(first, second, sizes[0]) == 0;
}

/* A segmentation of 20 x 20 x 20 voxels: a box of label 3 in one of label 9. */
static void write_segmentation(const char *path) {
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    fputs("NDims = 3\nDimSize = 20 20 20\nElementType = MET_UCHAR\nElementDataFile = LOCAL\n", file);
    for (int i = 0; i < 8000; i++) {
        const int x = i % 20, y = i / 20 % 20, z = i / 400;
        const bool in = x > 2 && x < 17 && y > 2 && y < 17 && z > 2 && z < 17;
        putc(in ? x < 10 ? 3 : 9 : 0, file);
    }
    fclose(file);
}

/* A label goes back into a copy of its file, also after its session was opened again from the journal; what
 * the session began with is not replaced, and neither is a file of another type written. */
static void labels_go_back(void **state) {
    (void)state;
    char source[512], copy[512], journal[ISOSCULPT_PATH];
    snprintf(source, sizeof source, "%s", in_folder("seg.mha"));
    snprintf(copy, sizeof copy, "%s", in_folder("copy.mha"));
    write_segmentation(source);
    isosculpt_document document = {0};
    const iso_input input = {.label = "3"};
    const iso_source opened = {.path = source, .isovalue = NAN, .input = &input};
    assert_int_equal(isosculpt_document_new(&document, folder, &opened, NULL), ISO_OK);
    assert_int_equal(save(&document, copy), ISO_OK);
    assert_true(same_bytes(source, copy));
    assert_int_equal(save(&document, source), ISO_ERR_USAGE);
    assert_int_equal(save(&document, in_folder("copy.nrrd")), ISO_ERR_USAGE);
    const iso_brush brush = {.tool = ISO_TOOL_ADD, .radius = 3, .strength = 1};
    const iso_sample sample = {.position = {10, 10, 10}, .normal = {1, 0, 0}, .pressure = 1};
    assert_int_equal(iso_session_begin(document.session, &brush, &sample, NULL, NULL), ISO_OK);
    assert_int_equal(iso_session_end(document.session, NULL), ISO_OK);
    assert_int_equal(save(&document, copy), ISO_OK);
    size_t size, changed = 0;
    const char *before = read_bytes(source, &size), *after = read_bytes(copy, &size);
    for (size_t i = 0; i < size; i++) {
        if (before[i] == after[i]) continue;
        assert_true(before[i] == 9 && after[i] == 3);
        changed++;
    }
    assert_in_range(changed, 20, 80); /* (of a ball of 113 voxels, of which half lies in the other box) */
    memcpy(journal, document.journal, sizeof journal);
    document.change_count = 1; /* the journal stays */
    isosculpt_document_close(&document);
    document = (isosculpt_document){0};
    assert_int_equal(isosculpt_document_open(&document, journal, NULL, NULL), ISO_OK);
    assert_int_equal(save(&document, in_folder("again.mha")), ISO_OK);
    isosculpt_document_close(&document);
    assert_true(same_bytes(copy, in_folder("again.mha")));
    count_files("", true);
}

/* Nothing is kept when a save fails. */
static void failed_saves_keep_nothing(void **state) {
    (void)state;
    char target[512];
    snprintf(target, sizeof target, "%s", in_folder("solid.stl"));
    isosculpt_document document = {0};
    assert_int_equal(new_document(&document, in_folder("mesh.obj")), ISO_OK);
    write_text(target, "first");
    const iso_brush brush = {.tool = ISO_TOOL_CARVE, .radius = 30, .strength = 1};
    const iso_sample sample = {.position = {3, 3, 3}, .normal = {0, 0, 1}, .pressure = 1};
    assert_int_equal(iso_session_begin(document.session, &brush, &sample, NULL, NULL), ISO_OK);
    assert_int_equal(iso_session_end(document.session, NULL), ISO_OK);
    assert_int_equal(save(&document, target), ISO_ERR_EMPTY);
    assert_true(has_text(target, "first"));
    assert_int_equal(count_files("solid.stl", false), 1);
    isosculpt_document_close(&document);
    count_files("", true);
}

/* Saves again and again, until it is killed. */
static void save_for_ever(const char *target) {
    isosculpt_document document = {0};
    if (new_document(&document, in_folder("mesh.obj")) != ISO_OK) _exit(1);
    const iso_brush brush = {.tool = ISO_TOOL_ADD, .radius = 1, .strength = 1};
    const iso_sample sample = {.position = {3, 3, 0}, .normal = {0, 0, -1}, .pressure = 1};
    if (iso_session_begin(document.session, &brush, &sample, NULL, NULL) != ISO_OK) _exit(1);
    if (iso_session_end(document.session, NULL) != ISO_OK) _exit(1);
    while (save(&document, target) == ISO_OK) continue;
    _exit(1);
}

static bool is_whole_stl(const char *path) {
    struct stat info;
    uint32_t triangles = 0;
    FILE *file = fopen(path, "rb");
    if (!file) return false;
    const bool has_count =
        fseek(file, 80, SEEK_SET) == 0 && fread(&triangles, sizeof triangles, 1, file) == 1;
    fclose(file);
    return has_count && stat(path, &info) == 0 && info.st_size == 84 + 50 * (off_t)triangles;
}

/* The target is whole or not there; the journal is offered; the next start leaves nothing else. */
static void killed_saves_leave_nothing(void **state) {
    (void)state;
    enum { ROUNDS = 100 };
    int unfinished = 0, saved = 0;
    for (int round = 0; round < ROUNDS; round++) {
        char target[512], journal[ISOSCULPT_PATH];
        int status;
        snprintf(target, sizeof target, "%s", in_folder("solid.stl"));
        const pid_t child = fork();
        assert_true(child >= 0);
        if (!child) save_for_ever(target);
        while (round % 10 && access(target, F_OK)) usleep(200);
        usleep((useconds_t)(round * 7919 % 20000));
        kill(child, SIGKILL);
        assert_int_equal(waitpid(child, &status, 0), child);
        assert_true(WIFSIGNALED(status));
        unfinished += count_files("isonew", false);
        if (access(target, F_OK) == 0) {
            saved++;
            assert_true(is_whole_stl(target));
        }
        isosculpt_document document = {0};
        if (isosculpt_document_find_unclosed(folder, journal)) {
            iso_error error = {0};
            if (isosculpt_document_open(&document, journal, NULL, &error) != ISO_OK)
                fail_msg("the journal of kill %d: %s", round, error.text);
            assert_int_equal(save(&document, target), ISO_OK);
            isosculpt_document_close(&document);
        }
        count_files(".strokes", true);
        count_files("mesh.obj", true);
        count_files("solid.stl.bak", true);
        unlink(target);
        assert_int_equal(count_files("", true), 0);
    }
    print_message("%d of %d kills left a file that the next start removed; %d came after a save\n",
                  unfinished, ROUNDS, saved);
    assert_true(saved > ROUNDS / 2);
}

/* What is put where a lock file will be is not written to. */
static void lock_files_are_no_links(void **state) {
    (void)state;
    char journal[ISOSCULPT_PATH], lock_file[ISOSCULPT_PATH + 8], precious[512];
    iso_error error = {0};
    isosculpt_document document = {0};
    snprintf(precious, sizeof precious, "%s", in_folder("precious"));
    write_text(precious, "precious");
    assert_int_equal(new_document(&document, in_folder("mesh.obj")), ISO_OK);
    snprintf(journal, sizeof journal, "%s", document.journal);
    snprintf(lock_file, sizeof lock_file, "%s.open", journal);
    document.change_count = 1; /* the journal stays */
    isosculpt_document_close(&document);
    for (int kind = 0; kind < 3; kind++) {
        if (kind == 0) assert_int_equal(symlink(precious, lock_file), 0);
        if (kind == 1) assert_int_equal(link(precious, lock_file), 0);
        if (kind == 2) assert_int_equal(mkfifo(lock_file, 0600), 0);
        assert_int_equal(isosculpt_document_open(&document, journal, NULL, &error), ISO_ERR_WRITE);
        assert_true(has_text(precious, "precious"));
        unlink(lock_file);
    }
    assert_int_equal(isosculpt_document_open(&document, journal, NULL, &error), ISO_OK);
    isosculpt_document_close(&document);
    count_files("", true);
}

static void journals_are_open_once(void **state) {
    (void)state;
    char second[512], found[ISOSCULPT_PATH];
    iso_error error = {0};
    iso_journal *journal;
    isosculpt_document document = {0}, other = {0};
    snprintf(second, sizeof second, "%s", in_folder("second.strokes"));
    assert_int_equal(new_document(&document, in_folder("mesh.obj")), ISO_OK);
    assert_int_equal(link(document.journal, second), 0);
    assert_int_equal(isosculpt_document_open(&other, second, NULL, &error), ISO_ERR_WRITE);
    assert_non_null(strstr(error.text, "another program has it open"));
    assert_int_equal(iso_journal_append(second, &journal, &error), ISO_ERR_WRITE);
    assert_non_null(strstr(error.text, "another program has it open"));
    write_text(in_folder("second.strokes.open"), "");
    assert_false(isosculpt_document_find_unclosed(folder, found));
    document.change_count = 1; /* the journal stays */
    isosculpt_document_close(&document);
    assert_int_equal(isosculpt_document_open(&other, second, NULL, &error), ISO_OK);
    isosculpt_document_close(&other);
    count_files("", true);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(files_of_the_user_stay),    cmocka_unit_test(labels_go_back),
        cmocka_unit_test(failed_saves_keep_nothing), cmocka_unit_test(killed_saves_leave_nothing),
        cmocka_unit_test(lock_files_are_no_links),   cmocka_unit_test(journals_are_open_once),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
