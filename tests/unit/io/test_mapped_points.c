/* mapped_points: clouds of files that are mapped have the bytes of clouds of files that are read; which files
 * must be read; files that are damaged. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "check_support.h"
#include "clouds/cloud.h"
#include "file_support.h"
#include "io/glyphs/glyphs_read.h"
#include "io/glyphs/mapped_points.h"

#define FILE_PLY ISO_TEST_TMP "/test_mapped_points.ply"

enum { COUNT = 3000, BYTES = 1 << 18 };

/* The bytes of a file. */
typedef struct content {
    char bytes[BYTES];
    size_t count, start; /* start: of the points */
} content;

static content file; /* too large for the stack */

/* Makes a file with some properties, named by a letter each: x y z, n o p the normal, r g b colours (R G B
 * the same as floats), s a scalar, a alpha, d radius, v w u a vector. */
static void make_file(const char *properties, const char *format, const char *before, const char *after) {
    static const struct {
        char letter;
        const char *text;
    } names[] = {{'x', "float x"},    {'y', "float y"},     {'z', "float z"},      {'n', "float nx"},
                 {'o', "float ny"},   {'p', "float nz"},    {'r', "uchar red"},    {'g', "uchar green"},
                 {'b', "uchar blue"}, {'R', "float red"},   {'G', "float green"},  {'B', "float blue"},
                 {'s', "short heat"}, {'a', "uchar alpha"}, {'d', "float radius"}, {'v', "float vx"},
                 {'w', "float vy"},   {'u', "float vz"},    {'X', "double x"}};
    uint32_t seed = 7;
    char *at = file.bytes;
    at += sprintf(at, "ply\nformat %s 1.0\n%selement vertex %d\n", format,
                  *before ? "element odd 2\nproperty uchar odd\n" : "", COUNT);
    for (const char *p = properties; *p; p++)
        for (size_t k = 0; k < sizeof names / sizeof *names; k++)
            if (names[k].letter == *p) at += sprintf(at, "property %s\n", names[k].text);
    at += sprintf(at, "%send_header\n%s",
                  *after ? "element face 1\nproperty list uchar int vertex_indices\n" : "", before);
    file.start = (size_t)(at - file.bytes);
    for (int i = 0; i < COUNT; i++) {
        float numbers[6];
        double square = 0;
        for (int k = 0; k < 3; k++) {
            numbers[k] = (float)(100 * uniform(&seed) - 30);
            numbers[3 + k] = (float)(uniform(&seed) - 0.5);
            square += (double)numbers[3 + k] * (double)numbers[3 + k];
        }
        for (int k = 3; k < 6 && i % 4; k++) numbers[k] /= (float)sqrt(square); /* some are not of length 1 */
        for (const char *p = properties; *p; p++) {
            const char *known = strchr("xyznop", *p);
            const int16_t heat = (int16_t)i;
            const double wide = (double)numbers[0];
            const float other = (float)(i % 256) / 256;
            const void *from = known ? (const void *)&numbers[known - "xyznop"] : &other;
            size_t size = sizeof(float);
            if (strchr("rgba", *p)) from = &heat, size = 1;
            if (*p == 's') from = &heat, size = 2;
            if (*p == 'X') from = &wide, size = 8;
            memcpy(at, from, size);
            at += size;
        }
    }
    at += *after ? 13 : 0;
    if (*after) memcpy(at - 13, "\3\0\0\0\0\1\0\0\0\2\0\0\0", 13);
    file.count = (size_t)(at - file.bytes);
    assert_true(file.count <= BYTES);
    spill(FILE_PLY, file.bytes, file.count);
}

/* The cloud of the file as it is read. */
static iso_cloud read_cloud(iso_read_report *report) {
    iso_error error;
    iso_glyphs glyphs;
    iso_cloud cloud;
    test_ok(iso_glyphs_read(FILE_PLY, &(iso_read_opts){.report = report}, &glyphs, &error), &error);
    test_ok(iso_cloud_make(&glyphs, &(iso_cloud_opts){.radius = 0.3}, &cloud, &error), &error);
    iso_glyphs_free(&glyphs);
    return cloud;
}

static void check_same(const iso_cloud *a, const iso_cloud *b) {
    assert_int_equal(a->count, b->count);
    assert_int_equal(a->span_count, b->span_count);
    assert_memory_equal(a->surfels, b->surfels, a->count * sizeof *a->surfels);
    assert_int_equal(a->colors != NULL, b->colors != NULL);
    if (a->colors) assert_memory_equal(a->colors, b->colors, a->count * sizeof *a->colors);
    assert_true(!a->opacities && !b->opacities && !a->radii && !b->radii && a->radius == b->radius);
    assert_memory_equal(&a->transform, &b->transform, sizeof a->transform);
}

static void check_mapped(iso_pool *pool) {
    iso_error error;
    iso_mapped_points points;
    iso_read_report report, wanted;
    iso_cloud mapped, read = read_cloud(&wanted);
    assert_true(iso_mapped_points_open(FILE_PLY, &(iso_read_opts){.report = &report}, pool, &points));
    test_ok(iso_cloud_make_of_source(&points.source, &points.survey, 0.3, pool, &mapped, &error), &error);
    iso_mapped_points_close(&points);
    check_same(&mapped, &read);
    assert_string_equal(report.format, wanted.format);
    assert_true(report.items == wanted.items && report.space == wanted.space);
    iso_cloud_free(&mapped);
    iso_cloud_free(&read);
}

static bool opens(iso_read_opts opts) {
    iso_mapped_points points;
    const bool open = iso_mapped_points_open(FILE_PLY, &opts, NULL, &points);
    if (open) iso_mapped_points_close(&points);
    return open;
}

static void test_layouts(void **state) {
    (void)state;
    static const char *const layouts[] = {"xyznop",        "xyznoprgb",  "rgbxyznop",
                                          "snopsrgbsxyzs", "nopxyzssss", "xyznopn"};
    iso_pool *pool;
    iso_error error;
    test_ok(iso_pool_create(3, &pool, &error), &error);
    for (size_t i = 0; i < sizeof layouts / sizeof *layouts; i++)
        for (int around = 0; around < 4; around++) {
            make_file(layouts[i], "binary_little_endian", around & 1 ? "ab" : "", around & 2 ? "f" : "");
            check_mapped(around & 1 ? pool : NULL);
        }
    iso_pool_destroy(pool);
}

/* Files whose points must be converted, and options that choose some of them. */
static void test_others(void **state) {
    (void)state;
    static const char *const layouts[] = {"xyz",     "xyzrgb",    "yxznop",    "xyzonp",
                                          "xynopz",  "xyznopRGB", "xyznopgrb", "xyznopa",
                                          "xyznopd", "xyznopvwu", "Xyznop",    "xysznop"};
    for (size_t i = 0; i < sizeof layouts / sizeof *layouts; i++) {
        make_file(layouts[i], "binary_little_endian", "", "");
        assert_false(opens((iso_read_opts){0}));
    }
    make_file("xyznop", "binary_little_endian", "", "");
    assert_true(opens((iso_read_opts){0}));
    assert_true(opens((iso_read_opts){.every = 1, .space = ISO_SPACE_LPS}));
    assert_false(opens((iso_read_opts){.every = 2}));
    assert_false(opens((iso_read_opts){.space = ISO_SPACE_RAS}));
    assert_false(opens((iso_read_opts){.max_memory = COUNT * 30}));
    make_file("xyznop", "binary_big_endian", "", "");
    assert_false(opens((iso_read_opts){0}));
    assert_false(iso_mapped_points_open(ISO_TEST_TMP "/no such file", NULL, NULL, &(iso_mapped_points){0}));
}

/* A number that is not usable anywhere, and a file that ends anywhere. */
static void test_damaged(void **state) {
    (void)state;
    static const float bad[] = {NAN, INFINITY, -INFINITY, 2e12f};
    make_file("xyznop", "binary_little_endian", "", "");
    for (size_t at = 0; at < 6 * COUNT; at += at < 20 ? 1 : 997)
        for (int k = 0; k < 4; k++) {
            char *number = file.bytes + file.start + at * sizeof(float), kept[sizeof(float)];
            if (at % 6 >= 3 && k == 3) continue; /* a long normal */
            memcpy(kept, number, sizeof kept);
            memcpy(number, &bad[k], sizeof kept);
            spill(FILE_PLY, file.bytes, file.count);
            assert_false(opens((iso_read_opts){0}));
            memcpy(number, kept, sizeof kept);
        }
    memset(file.bytes + file.start + 12, 0, 12); /* a normal of 0 */
    spill(FILE_PLY, file.bytes, file.count);
    assert_false(opens((iso_read_opts){0}));
    for (size_t count = 0; count < file.count; count += count < file.start + 50 ? 1 : 4001) {
        spill(FILE_PLY, file.bytes, count);
        assert_false(opens((iso_read_opts){0}));
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_layouts),
        cmocka_unit_test(test_others),
        cmocka_unit_test(test_damaged),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
