/* key_file: files of key images are read back, are merged in any order, and are refused when they are
 * damaged, missing, doubled or foreign. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "check_support.h"
#include "image/image.h"
#include "io/key_file.h"
#include "render/pullpush/pyramid.h"
#include "scene/method.h"

enum { WIDTH = 37, HEIGHT = 23, PIXELS = WIDTH * HEIGHT, PARTS = 5 };

static char folder[256];

static const char *path_of(int part) {
    static char paths[4][320];
    static int next;
    char *path = paths[next++ % 4];
    snprintf(path, sizeof paths[0], "%s/%d.isokeys", folder, part);
    return path;
}

static void make_part(int part, iso_key_file *file) {
    uint64_t random = (uint64_t)part;
    *file = (iso_key_file){.part = part, .parts = PARTS};
    file->surface.type = ISO_INT16;
    file->surface.transform = iso_transform_identity();
    file->surface.isovalue = 0.1;
    file->surface.primitives = (uint64_t)1 << 40;
    for (int axis = 0; axis < 3; axis++) file->surface.dims[axis] = 100 + axis;
    file->style.width = WIDTH;
    file->style.height = HEIGHT;
    file->style.samples = 1;
    file->style.view_angle = 30;
    file->style.color[2] = 255;
    file->texts[ISO_KEY_TITLE] = strdup("a title");
    file->texts[ISO_KEY_COMMENT] = strdup("");
    assert_int_equal(iso_key_image_allocate(WIDTH, HEIGHT, &file->keys, NULL), ISO_OK);
    for (int i = 0; i < PIXELS; i++)
        if (random_below(&random, 4) == 0)
            file->keys.keys[i] = (uint64_t)random_long(&random) << 32 | random_long(&random);
}

static void write_parts(void) {
    for (int part = 1; part <= PARTS; part++) {
        iso_key_file file;
        make_part(part, &file);
        assert_int_equal(iso_key_file_write(path_of(part), &file, NULL), ISO_OK);
        iso_key_file_free(&file);
    }
}

static int set_up(void **state) {
    (void)state;
    snprintf(folder, sizeof folder, "%s", ISO_TEST_TMP "/keys.XXXXXX");
    return mkdtemp(folder) ? 0 : -1;
}

static int tear_down(void **state) {
    (void)state;
    for (int part = 0; part <= PARTS; part++) remove(path_of(part));
    return rmdir(folder);
}

static void files_are_read_back(void **state) {
    (void)state;
    iso_key_file made, read;
    make_part(3, &made);
    assert_int_equal(iso_key_file_write(path_of(3), &made, NULL), ISO_OK);
    assert_int_equal(iso_key_file_read(path_of(3), 0, &read, NULL), ISO_OK);
    assert_int_equal(read.part, 3);
    assert_int_equal(read.parts, PARTS);
    assert_memory_equal(&made.surface, &read.surface, sizeof made.surface);
    assert_memory_equal(&made.style, &read.style, sizeof made.style);
    assert_string_equal(read.texts[ISO_KEY_TITLE], "a title");
    assert_string_equal(read.texts[ISO_KEY_COMMENT], "");
    assert_null(read.texts[ISO_KEY_SOFTWARE]);
    assert_memory_equal(made.keys.keys, read.keys.keys, PIXELS * sizeof *made.keys.keys);
    iso_key_file_free(&read);
    iso_key_file_free(&made);
    assert_int_equal(iso_key_file_read(path_of(3), PIXELS * 8 - 1, &read, NULL), ISO_ERR_LIMIT);
    assert_int_equal(iso_key_file_read(path_of(3), PIXELS * 8, &read, NULL), ISO_OK);
    iso_key_file_free(&read);
}

static void parts_are_merged_in_any_order(void **state) {
    (void)state;
    static const int orders[][PARTS] = {{1, 2, 3, 4, 5}, {5, 3, 1, 2, 4}, {2, 5, 4, 1, 3}};
    write_parts();
    for (int i = 0; i < 3; i++) {
        char *paths[PARTS];
        iso_key_file merged;
        for (int k = 0; k < PARTS; k++) paths[k] = strdup(path_of(orders[i][k]));
        assert_int_equal(iso_key_files_merge((const char *const *)paths, PARTS, 0, NULL, &merged, NULL),
                         ISO_OK);
        uint64_t least[PIXELS];
        memset(least, 0xff, sizeof least);
        for (int part = 1; part <= PARTS; part++) {
            iso_key_file file;
            make_part(part, &file);
            for (int k = 0; k < PIXELS; k++)
                if (file.keys.keys[k] < least[k]) least[k] = file.keys.keys[k];
            iso_key_file_free(&file);
        }
        assert_memory_equal(least, merged.keys.keys, sizeof least);
        iso_key_file_free(&merged);
        for (int k = 0; k < PARTS; k++) free(paths[k]);
    }
}

/* Merges parts 1 .. 5, of which part `place` is replaced by the file 0; expects a failure whose message names
 * the file `named` and has the word. */
static void check_refused(int place, int named, const char *word) {
    char *paths[PARTS];
    iso_key_file merged;
    iso_error error = {0};
    for (int k = 0; k < PARTS; k++) paths[k] = strdup(path_of(k + 1 == place ? 0 : k + 1));
    const iso_status status =
        iso_key_files_merge((const char *const *)paths, PARTS, 0, NULL, &merged, &error);
    assert_int_equal(iso_status_exit(status), 3);
    if (named >= 0) assert_non_null(strstr(error.text, path_of(named)));
    assert_non_null(strstr(error.text, word));
    for (int k = 0; k < PARTS; k++) free(paths[k]);
}

static void foreign_parts_are_refused(void **state) {
    (void)state;
    write_parts();
    for (int kind = 0; kind < 7; kind++) {
        static const char *const words[] = {"another surface", "another surface", "another picture",
                                            "other options",   "is in ",          "another division",
                                            "other options"};
        iso_key_file file;
        make_part(kind == 4 ? 2 : 4, &file);
        if (kind == 0) file.surface.isovalue = 0.2;
        if (kind == 1) file.surface.primitives++;
        if (kind == 2) file.style.position.x = 1;
        if (kind == 3) file.texts[ISO_KEY_TITLE][0] = 'A';
        if (kind == 5) file.parts++;
        if (kind == 6) file.texts[ISO_KEY_SOFTWARE] = strdup("another program");
        assert_int_equal(iso_key_file_write(path_of(0), &file, NULL), ISO_OK);
        check_refused(4, 0, words[kind]);
        iso_key_file_free(&file);
    }
    /* four of five files */
    char *paths[PARTS];
    iso_key_file merged;
    iso_error error = {0};
    for (int k = 0; k < PARTS; k++) paths[k] = strdup(path_of(k + 1));
    assert_int_equal(iso_key_files_merge((const char *const *)paths, PARTS - 1, 0, NULL, &merged, &error),
                     ISO_ERR_FORMAT);
    assert_non_null(strstr(error.text, "part 5 of 5 is missing"));
    for (int k = 0; k < PARTS; k++) free(paths[k]);
    remove(path_of(0));
    check_refused(2, 0, "cannot");
}

/* Every truncation, and every bit that is turned over, is noticed. */
static void damage_is_noticed(void **state) {
    (void)state;
    static unsigned char bytes[1 << 16];
    write_parts();
    FILE *file = fopen(path_of(1), "rb");
    const size_t size = fread(bytes, 1, sizeof bytes, file);
    fclose(file);
    iso_key_file read;
    for (size_t at = 0; at < size; at += at < 500 ? 1 : 97) {
        for (int kind = 0; kind < 3; kind++) {
            file = fopen(path_of(1), "wb");
            bytes[at] ^= kind ? 1 << (at + (size_t)kind) % 8 : 0;
            fwrite(bytes, 1, kind ? size : at, file);
            bytes[at] ^= kind ? 1 << (at + (size_t)kind) % 8 : 0;
            fclose(file);
            const iso_status status = iso_key_file_read(path_of(1), 1 << 24, &read, NULL);
            assert_true(status == ISO_ERR_IO || status == ISO_ERR_FORMAT || status == ISO_ERR_UNSUPPORTED ||
                        status == ISO_ERR_LIMIT);
        }
    }
    file = fopen(path_of(1), "wb");
    fwrite(bytes, 1, size, file);
    fputc(0, file);
    fclose(file);
    assert_int_equal(iso_key_file_read(path_of(1), 0, &read, NULL), ISO_ERR_IO);
}

/* Writes the changed file with a right checksum, and expects that its numbers are refused. */
static void refuse_numbers(iso_key_file *file, const char *what) {
    iso_key_file read;
    iso_error error = {0};
    assert_int_equal(iso_key_file_write(path_of(1), file, NULL), ISO_OK);
    const iso_status status = iso_key_file_read(path_of(1), 1 << 24, &read, &error);
    if (status != ISO_ERR_IO || !strstr(error.text, "numbers do not agree"))
        fail_msg("%s: status %d, %s", what, status, error.text);
    iso_key_file_free(file);
}

/* Numbers that no picture has, in files whose checksums match. */
static void impossible_numbers_are_refused(void **state) {
    (void)state;
    iso_key_file f;
#define REFUSE(change)                                                                                       \
    do {                                                                                                     \
        make_part(1, &f);                                                                                    \
        f.change;                                                                                            \
        refuse_numbers(&f, #change);                                                                         \
    } while (0)
    REFUSE(part = 0);
    REFUSE(part = PARTS + 1);
    REFUSE(parts = ISO_KEY_PARTS + 1);
    REFUSE(surface.dims[2] = 0);
    REFUSE(surface.type = ISO_FLOAT32 + 1);
    REFUSE(surface.type = -1);
    REFUSE(style.width = 0);
    REFUSE(style.height = -1);
    REFUSE(style.samples = 2);
    REFUSE(style.width = ISO_IMAGE_MAX + 1);
    REFUSE(style.method = ISO_METHOD_MESH);
    REFUSE(style.method = -1);
    REFUSE(style.orthographic = 2);
    REFUSE(style.anatomical = -1);
    REFUSE(style.caps = 2);
    REFUSE(style.position.z = NAN);
    REFUSE(style.view_up.x = INFINITY);
    REFUSE(style.view_angle = NAN);
    REFUSE(style.pixels_per_metre = INFINITY);
#undef REFUSE
    make_part(1, &f); /* a run that is longer than the picture */
    iso_key_image_free(&f.keys);
    assert_int_equal(iso_key_image_allocate(WIDTH, HEIGHT + 1, &f.keys, NULL), ISO_OK);
    memset(f.keys.keys, 1, (PIXELS + WIDTH) * sizeof *f.keys.keys);
    refuse_numbers(&f, "more keys than pixels");
}

/* A picture of pull-push has keys for each pixel of a level of its pyramid. */
static void pyramids_have_keys_of_their_own(void **state) {
    (void)state;
    const iso_view view = {.width = WIDTH, .height = HEIGHT};
    const iso_pyramid_layout layout = iso_pyramid_layout_of(&view, 1, 4);
    const iso_pyramid_level level = iso_pyramid_level_of(&layout, 1);
    const iso_pullpush_base right = {
        .base = 1, .top = 4, .width = level.width, .height = level.height, .cull = 1};
    for (int kind = 0; kind < 8; kind++) {
        iso_key_file file, read;
        make_part(2, &file);
        iso_key_image_free(&file.keys);
        assert_int_equal(iso_key_image_allocate(level.width, level.height, &file.keys, NULL), ISO_OK);
        file.keys.keys[level.width * level.height - 1] = 7;
        file.style.method = ISO_METHOD_PULLPUSH;
        file.style.base = right;
        if (kind == 1) file.style.base.width++;
        if (kind == 2) file.style.base.height--;
        if (kind == 3) file.style.base.base = 4;
        if (kind == 4) file.style.base.top = ISO_PYRAMID_TOP + 1;
        if (kind == 5) file.style.base.cull = 2;
        if (kind == 6) file.style.base.base = -1;
        if (kind == 7) file.style.caps = 1;
        if (kind) {
            refuse_numbers(&file, "a level of a pyramid");
            continue;
        }
        assert_int_equal(iso_key_file_write(path_of(2), &file, NULL), ISO_OK);
        assert_int_equal(iso_key_file_read(path_of(2), 0, &read, NULL), ISO_OK);
        assert_int_equal(read.keys.width, level.width);
        assert_memory_equal(read.keys.keys, file.keys.keys,
                            (size_t)level.width * (size_t)level.height * sizeof *read.keys.keys);
        iso_key_file_free(&read);
        iso_key_file_free(&file);
    }
}

/* The depth of the surface in the brick with place 0, or none, and that of the cap, or none: which is shown.
 */
static void merged_caps_are_joined(void **state) {
    (void)state;
    enum { SURFACE = 0x010203, CAP = 0x0a0b0c };
    const double none = NAN;
    const struct {
        double surface, cap;
        bool shows_cap;
    } pixels[] = {{3, 2, true},
                  {2, 3, false},
                  {2, 2, false},
                  {none, 5, true},
                  {4, none, false},
                  {0.5f, 0.5, false},
                  {2, 2 - 1e-12, true},
                  {2, 2 + 1e-12, false},
                  {-7, -8, true},
                  {-8, -7, false},
                  {-1, 1, false},
                  {1, -1, true},
                  {1e-30, -INFINITY, true},
                  {none, -INFINITY, true}};
    iso_key_file file, merged;
    make_part(1, &file);
    iso_key_image_free(&file.keys);
    assert_int_equal(iso_key_image_allocate(WIDTH, ISO_KEY_PLANES * HEIGHT, &file.keys, NULL), ISO_OK);
    for (size_t i = 0; i < sizeof pixels / sizeof *pixels; i++) {
        const float depth = (float)pixels[i].surface;
        uint32_t bits;
        memcpy(&bits, &depth, sizeof bits);
        if (!isnan(pixels[i].surface))
            file.keys.keys[i] = SURFACE | 0xff000000u, file.keys.keys[PIXELS + i] = bits;
        if (!isnan(pixels[i].cap)) file.keys.keys[2 * PIXELS + i] = iso_key_of_cap(pixels[i].cap, 3, CAP);
    }
    file.parts = 1;
    file.style.caps = 1;
    assert_int_equal(iso_key_file_write(path_of(1), &file, NULL), ISO_OK);
    const char *path = path_of(1);
    assert_int_equal(iso_key_files_merge(&path, 1, 0, NULL, &merged, NULL), ISO_OK);
    assert_int_equal(merged.keys.height, HEIGHT);
    assert_int_equal(merged.style.caps, 0);
    for (size_t i = 0; i < sizeof pixels / sizeof *pixels; i++)
        if ((uint32_t)merged.keys.keys[i] != ((pixels[i].shows_cap ? CAP : SURFACE) | 0xff000000u))
            fail_msg("surface at %g, cap at %g", pixels[i].surface, pixels[i].cap);
    assert_true(merged.keys.keys[PIXELS - 1] == ISO_KEY_EMPTY);
    assert_true(iso_key_of_cap(2, 9, 0) < iso_key_of_cap(2.1, 0, 0));
    assert_true(iso_key_of_cap(2, 1, 9) < iso_key_of_cap(2, 2, 0));
    iso_key_file_free(&merged);
    iso_key_file_free(&file);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(files_are_read_back),
        cmocka_unit_test(parts_are_merged_in_any_order),
        cmocka_unit_test(foreign_parts_are_refused),
        cmocka_unit_test(damage_is_noticed),
        cmocka_unit_test(impossible_numbers_are_refused),
        cmocka_unit_test(pyramids_have_keys_of_their_own),
        cmocka_unit_test(merged_caps_are_joined),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
