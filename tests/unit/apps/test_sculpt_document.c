/* isosculpt's files: heavy work that is cancelled leaves nothing, and what was there stays. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>

#include "apps/isosculpt/load_job.h"
#include "apps/isosculpt/reference_job.h"
#include "apps/isosculpt/save.h"
#include "grids/level_set.h"
#include "sculpt_support.h"
#include "session_support.h"

/* Refuses when it was asked so often. */
typedef struct patience {
    int left;
} patience;

static int refuse(void *context, double fraction) {
    patience *p = context;
    (void)fraction;
    return p->left-- <= 0;
}

static bool is_there(const char *path) {
    return access(path, F_OK) == 0;
}

/* Whether there is OpenVDB. */
static bool write_ball(const char *path) {
    iso_hgrid *ball;
    iso_error error = {0};
    assert_int_equal(iso_session_solid(&SESSION_START, &ball, NULL), ISO_OK);
    iso_status status = iso_level_set_write_vdb(path, ball, "surface", NULL, &error);
    iso_hgrid_destroy(ball);
    if (status == ISO_ERR_UNSUPPORTED) print_message("%s: left out\n", error.text);
    return status == ISO_OK;
}

static void write_mesh(const char *path) {
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    fputs("v 0 0 0\nv 20 0 0\nv 0 20 0\nv 0 0 20\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n", file);
    fclose(file);
}

enum { SIDE = 40 };
static void write_volume(const char *path) {
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    fprintf(file, "NRRD0004\ntype: uint8\ndimension: 3\nsizes: %d %d %d\nencoding: raw\n\n", SIDE, SIDE,
            SIDE);
    for (int i = 0; i < SIDE * SIDE * SIDE; i++) {
        const int x = i % SIDE - 20, y = i / SIDE % SIDE - 20, z = i / SIDE / SIDE - 20;
        fputc(250 - (x * x + y * y + z * z) / 5, file);
    }
    fclose(file);
}

static void cancelled_writing_leaves_no_file(void **state) {
    (void)state;
    const char *path = session_path("written.vdb");
    iso_hgrid *ball;
    if (!write_ball(path)) return;
    unlink(path);
    assert_int_equal(iso_session_solid(&SESSION_START, &ball, NULL), ISO_OK);
    iso_status status = ISO_ERR_IO;
    int refusals = 0;
    for (int calls = 0; status != ISO_OK; calls++, refusals++) {
        patience p = {calls};
        iso_error error = {0};
        const iso_progress progress = {.tell = refuse, .context = &p};
        status = iso_level_set_write_vdb(path, ball, "surface", &progress, &error);
        assert_int_equal(is_there(path), status == ISO_OK);
        if (status == ISO_OK) break;
        assert_int_equal(status, ISO_ERR_IO);
        assert_non_null(strstr(error.text, "cancelled"));
    }
    assert_true(refusals > 4);
    iso_hgrid_destroy(ball);
    unlink(path);
}

/* Saves that are cancelled, some at once and some later, leave the old file. */
static void cancelled_saves_keep_the_file_before(void **state) {
    (void)state;
    const char *path = session_path("probe.vdb");
    if (!write_ball(path)) return;
    unlink(path);
    iso_pool *pool;
    assert_int_equal(iso_pool_create(2, &pool, NULL), ISO_OK);
    isosculpt_document document = {.pool = pool};
    char folder[ISOSCULPT_PATH / 2], target[ISOSCULPT_PATH + 8], fresh[ISOSCULPT_PATH];
    const isosculpt_save_opts how = {0};
    snprintf(folder, sizeof folder, "%s", ISO_TEST_TMP);
    assert_int_equal(isosculpt_document_new(&document, folder, NULL, NULL), ISO_OK);
    snprintf(document.target, sizeof document.target, "%s/saved.vdb", folder);
    snprintf(target, sizeof target, "%s", document.target);
    snprintf(fresh, sizeof fresh, "%s/saved.vdb.isonew1", folder);
    int cancelled = 0;
    for (int round = 0; round < 4; round++) {
        FILE *old = fopen(target, "wb");
        assert_non_null(old);
        fputs("what was there", old);
        fclose(old);
        iso_status status = ISO_OK;
        iso_error error = {0};
        document.change_count++;
        assert_int_equal(isosculpt_document_save(&document, &how, &error), ISO_OK);
        assert_int_equal(isosculpt_document_save(&document, &how, &error), ISO_ERR_USAGE);
        usleep((useconds_t)(round * 20000));
        isosculpt_task_cancel(isosculpt_document_save_task(&document));
        assert_int_equal(isosculpt_document_poll_save(&document, true, &status, &error), ISOSCULPT_SAVE_DONE);
        char text[32] = "";
        old = fopen(target, "rb");
        assert_non_null(old);
        assert_non_null(fgets(text, sizeof text, old));
        fclose(old);
        assert_int_equal(strcmp(text, "what was there") == 0, status != ISO_OK);
        assert_false(is_there(fresh));
        assert_int_equal(document.saved_change_count == document.change_count,
                         status == ISO_OK); /* closing still asks */
        cancelled += status != ISO_OK;
    }
    assert_true(cancelled > 0);
    unlink(target);
    strcat(target, ".bak");
    unlink(target);
    isosculpt_document_close(&document);
    iso_pool_destroy(pool);
}

/* A ball that reaches out of its grid is saved as an open mesh, which the document says, or closed. */
static void saves_say_whether_meshes_are_open(void **state) {
    (void)state;
    isosculpt_document document = {0};
    iso_status status = ISO_ERR_IO;
    char path[ISOSCULPT_PATH];
    assert_int_equal(isosculpt_document_new(&document, NULL, NULL, NULL), ISO_OK);
    const double border = -document.start.origin.x;
    const iso_brush brush = {.tool = ISO_TOOL_ADD, .radius = 5, .strength = 1};
    const iso_sample sample = {.position = {border, 0, 0}, .normal = {1, 0, 0}, .pressure = 1};
    assert_int_equal(iso_session_begin(document.session, &brush, &sample, NULL, NULL), ISO_OK);
    assert_int_equal(iso_session_end(document.session, NULL), ISO_OK);
    snprintf(path, sizeof path, "%s", session_path("open.stl"));
    for (int closed = 0; closed < 2; closed++) {
        const isosculpt_save_opts how = {.path = path, .closed = closed};
        assert_int_equal(isosculpt_document_save(&document, &how, NULL), ISO_OK);
        assert_int_equal(isosculpt_document_poll_save(&document, true, &status, NULL), ISOSCULPT_SAVE_DONE);
        assert_int_equal(status, ISO_OK);
        assert_int_equal(document.saved_open_edges == 0, closed);
        assert_int_equal(unlink(path), 0);
    }
    isosculpt_document_close(&document);
    char backup[ISOSCULPT_PATH + 4];
    snprintf(backup, sizeof backup, "%s.bak", path);
    unlink(backup);
}

/* A source, cancelled all along its way. */
static void check_cancelling(const char *path, double isovalue) {
    int refusals = 0;
    for (int calls = 0;; calls += 1 + calls / 4, refusals++) {
        patience p = {calls};
        iso_error error = {0};
        iso_journal_start start;
        iso_hgrid *grid;
        const iso_progress progress = {.tell = refuse, .context = &p};
        const iso_source source = {.path = path, .isovalue = isovalue, .progress = &progress};
        iso_status status = iso_source_open(&source, &start, &grid, &error);
        if (status == ISO_OK) {
            iso_hgrid_destroy(grid);
            break;
        }
        if (status != ISO_ERR_IO || !strstr(error.text, "cancelled"))
            fail_msg("%s, %d calls: %s", path, calls, error.text);
    }
    assert_true(refusals > 8);
}

static void sources_can_be_cancelled(void **state) {
    (void)state;
    const char *vdb = session_path("source.vdb"), *mesh = session_path("source.obj"),
               *volume = session_path("source.nrrd");
    const bool have = write_ball(vdb);
    write_mesh(mesh);
    write_volume(volume);
    if (have) check_cancelling(mesh, NAN);
    check_cancelling(volume, 200);
    unlink(vdb);
    unlink(mesh);
    unlink(volume);
}

static void openings(void **state) {
    (void)state;
    const char *volume = session_path("opened.nrrd");
    write_volume(volume);
    const isosculpt_load_request request = {.path = volume, .isovalue = 200, .threads = 2},
                                 none = {.path = "/no/such.vdb", .isovalue = NAN, .threads = 1};
    isosculpt_load_job *load_job;
    isosculpt_loaded loaded;
    iso_error error = {0};
    assert_int_equal(isosculpt_load_job_start(&request, &load_job, NULL), ISO_OK);
    assert_int_equal(isosculpt_load_job_finish(load_job, &loaded, NULL), ISO_OK);
    assert_true(isosculpt_viewport_point_count(&loaded.viewport) > 1000);
    assert_null(loaded.document.session); /* the volume is viewed first */
    assert_non_null(loaded.volume);
    const size_t points = isosculpt_viewport_point_count(&loaded.viewport);
    isosculpt_viewport_set_isovalue(&loaded.viewport, 220); /* a smaller ball */
    loaded.viewport.sliding = true;
    assert_int_equal(isosculpt_viewport_draw(&loaded.viewport, 64, 40, true, NULL), ISO_OK);
    assert_int_equal(loaded.viewport.quality, ISOSCULPT_QUALITY_MOVING);
    assert_int_equal(isosculpt_viewport_draw(&loaded.viewport, 64, 40, false, NULL), ISO_OK);
    while (loaded.viewport.quality != ISOSCULPT_QUALITY_FINE)
        assert_int_equal(isosculpt_viewport_refine(&loaded.viewport, NULL), ISO_OK);
    assert_true(isosculpt_viewport_point_count(&loaded.viewport) < points);
    const isosculpt_load_request conversion = {
        .path = loaded.volume->path, .volume = loaded.volume, .isovalue = 220, .threads = 2};
    isosculpt_loaded field;
    assert_int_equal(isosculpt_load_job_start(&conversion, &load_job, NULL), ISO_OK);
    assert_int_equal(isosculpt_load_job_finish(load_job, &field, NULL), ISO_OK);
    iso_journal_start start;
    iso_hgrid *wanted;
    const iso_source source = {.path = volume, .isovalue = 220};
    assert_int_equal(iso_source_open(&source, &start, &wanted, NULL), ISO_OK);
    assert_true(sculpt_same(iso_session_grid(field.document.session), wanted));
    assert_int_equal(field.document.start.source_crc, start.source_crc);
    assert_string_equal(field.document.start.source, start.source);
    iso_hgrid_destroy(wanted);
    isosculpt_loaded_free(&field);
    isosculpt_loaded_free(&loaded);
    assert_int_equal(isosculpt_load_job_start(&request, &load_job, NULL), ISO_OK);
    isosculpt_task_cancel(isosculpt_load_job_task(load_job));
    assert_int_equal(isosculpt_load_job_finish(load_job, &loaded, &error), ISO_ERR_IO);
    assert_non_null(strstr(error.text, "cancelled"));
    assert_int_equal(isosculpt_load_job_start(&request, &load_job, NULL), ISO_OK);
    while (!isosculpt_task_done(isosculpt_load_job_task(load_job))) usleep(1000);
    isosculpt_task_cancel(isosculpt_load_job_task(load_job)); /* too late, and heard all the same */
    assert_int_equal(isosculpt_load_job_finish(load_job, &loaded, &error), ISO_ERR_IO);
    assert_int_equal(isosculpt_load_job_start(&none, &load_job, NULL), ISO_OK);
    assert_int_equal(isosculpt_load_job_finish(load_job, &loaded, &error), ISO_ERR_IO);
    assert_non_null(strstr(error.text, "/no/such.vdb"));
    unlink(volume);
}

/* Leaves a journal, with one stroke or with none, as a program leaves it that is killed. */
static void leave_journal(const char *path, bool stroke) {
    char lock_file[ISOSCULPT_PATH];
    iso_journal *journal;
    iso_event event;
    memset(&event, 0, sizeof event);
    event.kind = ISO_EVENT_BEGIN;
    event.brush = (iso_brush){.tool = ISO_TOOL_ADD, .radius = 2, .strength = 1};
    event.sample = (iso_sample){.position = {0, 0, 10}, .normal = {0, 0, 1}, .pressure = 1};
    unlink(path);
    assert_int_equal(iso_journal_create(path, &SESSION_START, &journal, NULL), ISO_OK);
    if (stroke) assert_int_equal(iso_journal_put(journal, &event, NULL), ISO_OK);
    event.kind = ISO_EVENT_END;
    if (stroke) assert_int_equal(iso_journal_put(journal, &event, NULL), ISO_OK);
    assert_int_equal(iso_journal_close(journal, NULL), ISO_OK);
    snprintf(lock_file, sizeof lock_file, "%s.open", path);
    FILE *left = fopen(lock_file, "wb");
    assert_non_null(left);
    fclose(left);
}

/* A session in which nothing was done, though newer, does not hide the one that is worth recovering; what was
 * recovered counts as not saved. */
static void recovered_work_is_unsaved(void **state) {
    (void)state;
    const char *folder = session_path("killed"), *worked = session_path("killed/worked.strokes"),
               *empty = session_path("killed/empty.strokes"),
               *empty_lock_file = session_path("killed/empty.strokes.open");
    char found[ISOSCULPT_PATH];
    mkdir(folder, 0700);
    leave_journal(empty, false);
    assert_false(isosculpt_document_find_unclosed(folder, found));
    leave_journal(worked, true);
    leave_journal(empty, false); /* the newest */
    assert_true(isosculpt_document_find_unclosed(folder, found));
    assert_string_equal(found, worked);
    isosculpt_document document = {0};
    assert_int_equal(isosculpt_document_open(&document, worked, NULL, NULL), ISO_OK);
    assert_int_not_equal(document.change_count, document.saved_change_count);
    isosculpt_document_close(&document);
    assert_int_equal(isosculpt_document_open(&document, worked, NULL, NULL), ISO_OK);
    assert_int_equal(document.change_count, document.saved_change_count); /* it was closed */
    isosculpt_document_close(&document);
    unlink(worked);
    unlink(empty);
    unlink(empty_lock_file);
    rmdir(folder);
}

static void copy_file(const char *from, const char *to) {
    char bytes[4096];
    FILE *in = fopen(from, "rb"), *out = fopen(to, "wb");
    assert_non_null(in);
    assert_non_null(out);
    for (size_t got; (got = fread(bytes, 1, sizeof bytes, in)) > 0;)
        assert_int_equal(fwrite(bytes, 1, got, out), got);
    fclose(in);
    fclose(out);
}

/* What is recovered is saved where it was saved before, after a question, and not beside what it began with.
 */
static void recovered_work_is_saved_where_it_was(void **state) {
    (void)state;
    char folder[ISOSCULPT_PATH], strokes[ISOSCULPT_PATH + 16], killed[ISOSCULPT_PATH + 16],
        lock_file[ISOSCULPT_PATH + 32], killed_lock_file[ISOSCULPT_PATH + 32];
    snprintf(folder, sizeof folder, "%s", session_path("saving"));
    mkdir(folder, 0700);
    const char *const names[] = {"a long name that was saved to first.stl", "final.stl", "exported.obj"};
    isosculpt_document document = {0};
    assert_int_equal(isosculpt_document_new(&document, folder, NULL, NULL), ISO_OK);
    const iso_brush brush = {.tool = ISO_TOOL_ADD, .radius = 5, .strength = 1};
    const iso_sample sample = {.position = {0, 0, 40}, .normal = {0, 0, 1}, .pressure = 1};
    assert_int_equal(iso_session_begin(document.session, &brush, &sample, NULL, NULL), ISO_OK);
    assert_int_equal(iso_session_end(document.session, NULL), ISO_OK);
    char paths[3][ISOSCULPT_PATH + 64];
    for (int i = 0; i < 3; i++) {
        iso_status status = ISO_ERR_IO;
        snprintf(paths[i], sizeof paths[i], "%s/%s", folder, names[i]);
        const isosculpt_save_opts how = {.path = paths[i], .is_export = i == 2};
        assert_int_equal(isosculpt_document_save(&document, &how, NULL), ISO_OK);
        assert_int_equal(isosculpt_document_poll_save(&document, true, &status, NULL), ISOSCULPT_SAVE_DONE);
        assert_int_equal(status, ISO_OK);
    }
    snprintf(strokes, sizeof strokes, "%s", document.journal);
    snprintf(lock_file, sizeof lock_file, "%s.open", strokes);
    snprintf(killed, sizeof killed, "%s/killed.strokes", folder);
    snprintf(killed_lock_file, sizeof killed_lock_file, "%s.open", killed);
    copy_file(lock_file, killed_lock_file); /* as they are when the program is killed now */
    copy_file(strokes, killed);
    isosculpt_document_close(&document);
    assert_int_equal(isosculpt_document_open(&document, killed, NULL, NULL), ISO_OK);
    assert_string_equal(document.target, paths[1]);
    bool replaces = false;
    assert_int_equal(isosculpt_document_check_target(&document, document.target, &replaces, NULL), ISO_OK);
    assert_true(replaces);
    isosculpt_document_close(&document);
    unlink(strokes);
    unlink(killed);
    for (int i = 0; i < 3; i++) unlink(paths[i]);
    rmdir(folder);
}

/* A session that was not closed is offered again when its recovery is cancelled, however late. */
static void cancelled_recoveries_are_offered_again(void **state) {
    (void)state;
    const char *folder = session_path("recovered"), *strokes = session_path("recovered/left.strokes");
    char found[ISOSCULPT_PATH];
    mkdir(folder, 0700);
    leave_journal(strokes, true);
    const isosculpt_load_request request = {.path = strokes, .isovalue = NAN, .threads = 1};
    for (int round = 0; round < 2; round++) {
        isosculpt_load_job *load_job;
        isosculpt_loaded loaded;
        assert_true(isosculpt_document_find_unclosed(folder, found));
        assert_int_equal(isosculpt_load_job_start(&request, &load_job, NULL), ISO_OK);
        while (round && !isosculpt_task_done(isosculpt_load_job_task(load_job))) usleep(1000);
        isosculpt_task_cancel(isosculpt_load_job_task(load_job));
        assert_int_equal(isosculpt_load_job_finish(load_job, &loaded, NULL), ISO_ERR_IO);
    }
    assert_true(isosculpt_document_find_unclosed(folder, found));
    assert_string_equal(found, strokes);
    isosculpt_document document = {0};
    assert_int_equal(isosculpt_document_open(&document, strokes, NULL, NULL), ISO_OK);
    isosculpt_document_close(&document);
    assert_false(isosculpt_document_find_unclosed(folder, found));
    unlink(strokes);
    rmdir(folder);
}

/* The field that a session began with can be made again after strokes, whatever it began with. */
static void first_fields_can_be_made_again(void **state) {
    (void)state;
    const char *volume = session_path("first.nrrd"), *mesh = session_path("first.obj");
    iso_pool *pool;
    assert_int_equal(iso_pool_create(2, &pool, NULL), ISO_OK);
    write_volume(volume);
    write_mesh(mesh);
    const iso_source sources[] = {{.path = volume, .isovalue = 170, .pool = pool},
                                  {.path = mesh, .isovalue = NAN, .voxel = 0.5, .pool = pool}};
    const isosculpt_settings settings = {.common.threads = 1};
    const isosculpt_reference_files files = {.settings = &settings};
    for (int i = 0; i < 3; i++) {
        isosculpt_document document = {.pool = pool};
        isosculpt_reference_job *job;
        isosculpt_reference *reference;
        iso_hgrid *again;
        const iso_brush brush = {.tool = ISO_TOOL_CARVE, .radius = 8, .strength = 1};
        const double inside = i == 1 ? 20 : 3;
        const iso_sample sample = {.position = {inside, inside, inside}, .normal = {0, 0, 1}, .pressure = 1};
        assert_int_equal(isosculpt_document_new(&document, NULL, i ? &sources[i - 1] : NULL, NULL), ISO_OK);
        iso_hgrid *first = sculpt_copy(iso_session_grid(document.session));
        assert_int_equal(iso_session_begin(document.session, &brush, &sample, NULL, NULL), ISO_OK);
        assert_int_equal(iso_session_end(document.session, NULL), ISO_OK);
        assert_int_equal(
            isosculpt_document_first_field(&document.start, document.journal, pool, NULL, &again, NULL),
            ISO_OK);
        assert_true(sculpt_same(first, again));
        assert_false(sculpt_same(iso_session_grid(document.session), again));
        iso_hgrid_destroy(first);
        iso_hgrid_destroy(again);
        assert_int_equal(isosculpt_reference_job_start(&document, &files, NULL, &job, NULL), ISO_OK);
        assert_int_equal(isosculpt_reference_job_finish(job, &reference, NULL, NULL), ISO_OK);
        isosculpt_reference_destroy(reference);
        assert_int_equal(isosculpt_reference_job_start(&document, &files, NULL, &job, NULL), ISO_OK);
        isosculpt_reference_job_cancel(job);
        if (i == 2) { /* the file is another one now */
            iso_error error = {0};
            write_volume(mesh);
            assert_int_equal(isosculpt_reference_job_start(&document, &files, NULL, &job, NULL), ISO_OK);
            assert_int_equal(isosculpt_reference_job_finish(job, &reference, NULL, &error), ISO_ERR_FORMAT);
            assert_non_null(strstr(error.text, "checksum"));
        }
        isosculpt_document_close(&document);
    }
    unlink(volume);
    unlink(mesh);
    iso_pool_destroy(pool);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(cancelled_writing_leaves_no_file),
                                       cmocka_unit_test(cancelled_saves_keep_the_file_before),
                                       cmocka_unit_test(saves_say_whether_meshes_are_open),
                                       cmocka_unit_test(sources_can_be_cancelled),
                                       cmocka_unit_test(openings),
                                       cmocka_unit_test(recovered_work_is_unsaved),
                                       cmocka_unit_test(recovered_work_is_saved_where_it_was),
                                       cmocka_unit_test(cancelled_recoveries_are_offered_again),
                                       cmocka_unit_test(first_fields_can_be_made_again)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
