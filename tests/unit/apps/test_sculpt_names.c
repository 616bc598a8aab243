/* Names of files in isosculpt: where a sculpture is saved, what the browser shows, the command that draws it;
 * and the numbers along an axis. */
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

#include "apps/isosculpt/render_command.h"
#include "apps/isosculpt/save.h"
#include "apps/isosculpt/window/axis.h"
#include "apps/isosculpt/window/file_browser.h"
#include "base/file_types.h"
#include "grids/volume/volume.h"

static char folder[] = ISO_TEST_TMP "/names-XXXXXX";

static const char *in_folder(const char *name) {
    static char paths[4][256];
    static int next;
    char *path = paths[next++ % 4];
    snprintf(path, sizeof paths[0], "%s/%s", folder, name);
    return path;
}

static void make_file(const char *name) {
    FILE *file = fopen(in_folder(name), "w");
    assert_non_null(file);
    fputs("something", file);
    fclose(file);
}

static int open_folder(void **state) {
    (void)state;
    static const char *const files[] = {"teapot.stl", "Head.nii.gz",      "a.vdb",
                                        "notes.txt",  ".show_hidden.stl", "B.obj"};
    if (!mkdtemp(folder)) return -1;
    for (size_t i = 0; i < sizeof files / sizeof *files; i++) make_file(files[i]);
    return mkdir(in_folder("shelf"), 0700);
}

static int remove_folder(void **state) {
    (void)state;
    char command[128];
    snprintf(command, sizeof command, "rm -r '%s'", folder);
    return system(command);
}

static void assert_target(const char *source, const char *name) {
    char target[ISOSCULPT_PATH];
    isosculpt_target_default(source, target);
    assert_string_equal(target, in_folder(name));
}

static void saving_goes_beside_the_source(void **state) {
    (void)state;
    char path[ISOSCULPT_PATH];
    assert_target(in_folder("teapot.stl"), "teapot.vdb");
    assert_target(in_folder("Head.nii.gz"), "Head.vdb");
    assert_target(in_folder("a.vdb"), "a-2.vdb"); /* never the source itself */
    assert_target(in_folder("shelf"), "shelf.vdb");
    assert_int_equal(chdir(folder), 0);
    assert_target(NULL, "sculpture.vdb");
    make_file("sculpture.vdb");
    assert_target(NULL, "sculpture-2.vdb");
    isosculpt_target_beside("bear.strokes", path);
    assert_string_equal(path, "bear.vdb"); /* it is not there: the name as it is */
    assert_true(isosculpt_path_with_ending("/x/bear.vdb", "-1.png", path));
    assert_string_equal(path, "/x/bear-1.png");
    isosculpt_path_unused(in_folder("teapot.vdb"), ".stl", path);
    assert_string_equal(path, in_folder("teapot-2.stl"));
}

static void some_files_are_not_written(void **state) {
    (void)state;
    isosculpt_document document = {.target_is_own = true};
    iso_error error = {0};
    bool replaces;
    snprintf(document.start.source, sizeof document.start.source, "%s", in_folder("teapot.stl"));
    snprintf(document.target, sizeof document.target, "%s", in_folder("a.vdb"));
    assert_int_equal(isosculpt_document_check_target(&document, in_folder("new.stl"), &replaces, &error),
                     ISO_OK);
    assert_false(replaces);
    assert_int_equal(isosculpt_document_check_target(&document, in_folder("a.vdb"), &replaces, &error),
                     ISO_OK);
    assert_false(replaces); /* its own */
    assert_int_equal(isosculpt_document_check_target(&document, in_folder("B.obj"), &replaces, &error),
                     ISO_OK);
    assert_true(replaces);
    static const char *const refused[] = {"teapot.stl", "notes.txt", "new", "shelf.vdb/", "link.stl"};
    assert_int_equal(mkdir(in_folder("shelf.vdb"), 0700), 0);
    assert_int_equal(symlink("teapot.stl", in_folder("link.stl")), 0);
    for (size_t i = 0; i < sizeof refused / sizeof *refused; i++) {
        error = (iso_error){0};
        assert_int_not_equal(
            isosculpt_document_check_target(&document, in_folder(refused[i]), &replaces, &error), ISO_OK);
        assert_non_null(strstr(error.text, refused[i]));
    }
    rmdir(in_folder("shelf.vdb"));
    unlink(in_folder("link.stl"));
}

static void the_browser_shows_what_can_be_chosen(void **state) {
    (void)state;
    isosculpt_browser browser = {0};
    char path[ISOSCULPT_PATH];
    isosculpt_browser_open(&browser, ISOSCULPT_BROWSE_STAMP, in_folder("x.vdb"));
    assert_string_equal(browser.folder, folder);
    static const char *const wanted[] = {"shelf", "B.obj", "teapot.stl"}; /* folders first, any case */
    assert_int_equal(browser.count, 3);
    for (size_t i = 0; i < browser.count; i++) assert_string_equal(browser.entries[i].name, wanted[i]);
    browser.show_hidden = true;
    isosculpt_browser_reread(&browser);
    assert_int_equal(browser.count, 4);
    browser.show_hidden = false;
    isosculpt_browser_reread(&browser);
    isosculpt_browser_step(&browser, 1);
    assert_false(isosculpt_browser_choose(&browser, path)); /* enters */
    assert_string_equal(browser.folder, in_folder("shelf"));
    isosculpt_browser_up(&browser);
    isosculpt_browser_step(&browser, 2);
    assert_true(isosculpt_browser_choose(&browser, path));
    assert_string_equal(path, in_folder("B.obj"));
    snprintf(browser.name, sizeof browser.name, "nothing.stl");
    assert_false(isosculpt_browser_choose(&browser, path));
    assert_true(browser.error_text[0]);
    isosculpt_browser_close(&browser);
    isosculpt_browser_open(&browser, ISOSCULPT_BROWSE_SAVE, in_folder("x.ply"));
    assert_string_equal(browser.name, "x.ply");
    isosculpt_browser_set_type(&browser, 1);
    assert_string_equal(browser.name, "x.stl");
    snprintf(browser.name, sizeof browser.name, "plain");
    assert_true(isosculpt_browser_choose(&browser, path));
    assert_string_equal(path, in_folder("plain.stl"));
    /* An extension that is typed counts, and the type follows it; a name without one keeps the type. */
    const isosculpt_file_type *types = isosculpt_browser_types(ISOSCULPT_BROWSE_SAVE);
    static const struct {
        const char *name;
        iso_file_type type;
    } typed[] = {{"y.VDB", ISO_FILE_vdb},
                 {"y", ISO_FILE_vdb},
                 {"y.obj", ISO_FILE_obj},
                 {"y.step", ISO_FILE_obj},
                 {"y.stl", ISO_FILE_stl}};
    for (size_t i = 0; i < sizeof typed / sizeof *typed; i++) {
        snprintf(browser.name, sizeof browser.name, "%s", typed[i].name);
        isosculpt_browser_follow_name(&browser);
        assert_string_equal(browser.name, typed[i].name);
        assert_int_equal(types[browser.type].type, typed[i].type);
    }
    isosculpt_browser_close(&browser);
}

/* Every volume and every level set that can be read is shown when a file is opened. */
static void volumes_can_be_chosen(void **state) {
    (void)state;
    const unsigned everything = isosculpt_browser_types(ISOSCULPT_BROWSE_OPEN)[0].holds;
    char extensions[1024];
    iso_file_type_extensions(ISO_HOLDS_VOLUME, 0, NULL, extensions, sizeof extensions);
    size_t count = 0;
    for (char *save, *word = strtok_r(extensions, " ", &save); word; word = strtok_r(NULL, " ", &save)) {
        char name[32];
        snprintf(name, sizeof name, "head%s", word);
        if (iso_file_type_of_name(name, everything) == ISO_FILE_UNKNOWN) fail_msg("%s is not shown", word);
        count++;
    }
    assert_true(count > 20);
}

static void commands_are_quoted(void **state) {
    (void)state;
    isosculpt_viewport view = {.camera = {.position = {0.1, -2, 3}, .view_up = {0, 0, 1}, .view_angle = 30}};
    view.mode.material.color = (iso_rgb){0xCE, 0x8E, 0x70};
    isosculpt_render_command command = {.path = "/a b/it's.vdb",
                                        .reading = "grid=x y\ncrop=1,2,3,4,5,6\n",
                                        .viewport = &view,
                                        .width = 64,
                                        .height = 48};
    char text[2048];
    assert_true(isosculpt_render_command_text(&command, text, sizeof text));
    assert_non_null(strstr(
        text, "isorender '/a b/it'\\''s.vdb' -o 'it'\\''s-view.png' --grid='x y' --crop=1,2,3,4,5,6 "));
    assert_non_null(strstr(text, " --color=CE8E70 "));
    assert_non_null(strstr(text, " --camera-position=0.1,-2,3 "));
    assert_non_null(strstr(text, " --resolution=64x48 "));
    assert_false(isosculpt_render_command_text(&command, text, 40));
}

static void ticks_are_round(void **state) {
    (void)state;
    double ticks[ISOSCULPT_AXIS_TICKS];
    assert_int_equal(isosculpt_axis_ticks(62, 2000, 6, ticks), 4);
    for (int i = 0; i < 4; i++) assert_true(fabs(ticks[i] - 500 * (i + 1)) < 1e-9);
    assert_int_equal(isosculpt_axis_ticks(-1, 1, 5, ticks), 5); /* -1 -0.5 0 0.5 1 */
    assert_int_equal(isosculpt_axis_ticks(5, 5, 6, ticks), 0);
    assert_int_equal(isosculpt_axis_ticks(NAN, 1, 6, ticks), 0);
    assert_int_equal(isosculpt_axis_ticks(-1e308, 1e308, 6, ticks), 0); /* no such range */
    assert_true(isosculpt_axis_ticks(1e-300, 2e-300, 6, ticks) > 2);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(saving_goes_beside_the_source),
                                       cmocka_unit_test(some_files_are_not_written),
                                       cmocka_unit_test(the_browser_shows_what_can_be_chosen),
                                       cmocka_unit_test(volumes_can_be_chosen),
                                       cmocka_unit_test(commands_are_quoted),
                                       cmocka_unit_test(ticks_are_round)};
    return cmocka_run_group_tests(tests, open_folder, remove_folder);
}
