/* Readers of lines and glyphs that run out of memory say so and leak nothing: calls for memory are refused
 * from a chosen one on (the linker's --wrap), over the files of the fuzzers, whose first byte is not the
 * file's. */
#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "check_support.h"
#include "file_support.h"
#include "io/glyphs/glyphs_read.h"
#include "io/lines/lines_read.h"
#include "refused_memory.h"

static iso_status read_lines(const void *path, iso_error *error) {
    iso_lines lines;
    const iso_status status = iso_lines_read(path, NULL, &lines, error);
    if (status == ISO_OK) iso_lines_free(&lines);
    return status;
}

static iso_status read_glyphs(const void *path, iso_error *error) {
    iso_glyphs glyphs;
    const iso_read_opts opts = {.normals_from_faces = true};
    const iso_status status = iso_glyphs_read(path, &opts, &glyphs, error);
    if (status == ISO_OK) iso_glyphs_free(&glyphs);
    return status;
}

static void read_folder(const char *folder, iso_status (*read)(const void *path, iso_error *error)) {
    char path[512];
    long calls = 0;
    iso_status status; /* some files of the corpus are damaged */
    snprintf(path, sizeof path, "%s/tests/fuzz/corpus/%s", ISO_SOURCE_DIR, folder);
    DIR *directory = opendir(path);
    assert_non_null(directory);
    for (struct dirent *entry = readdir(directory); entry; entry = readdir(directory)) {
        size_t size;
        if (entry->d_name[0] == '.') continue;
        snprintf(path, sizeof path, "%s/tests/fuzz/corpus/%s/%s", ISO_SOURCE_DIR, folder, entry->d_name);
        char *bytes = slurp(path, &size);
        snprintf(path, sizeof path, "%s/test_read_memory_%.200s", ISO_TEST_TMP, entry->d_name);
        spill(path, bytes + 1, size - 1);
        free(bytes);
        calls += test_refuse_each(read, path, &status);
        remove(path);
    }
    closedir(directory);
    assert_true(calls > 100);
}

static void test_lines(void **state) {
    (void)state;
    read_folder("lines", read_lines);
}

static void test_glyphs(void **state) {
    (void)state;
    read_folder("glyphs", read_glyphs);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_lines), cmocka_unit_test(test_glyphs)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
