/* point_rows: points as rows of numbers in text, and the decision what columns without names are. */
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "check_support.h"
#include "glyphs_support.h"

#define FILE_XYZ ISO_TEST_TMP "/test_point_rows.xyz"
#define FILE_PTS ISO_TEST_TMP "/test_point_rows.pts"
#define FILE_PWN ISO_TEST_TMP "/test_point_rows.pwn"
#define FILE_ASC ISO_TEST_TMP "/test_point_rows.asc"
#define FILE_TXT ISO_TEST_TMP "/test_point_rows.txt"

static void check_note(const char *text) {
    assert_int_equal(report.note_count, 1);
    if (!strstr(report.notes[0], text)) fail_msg("\"%s\", wanted \"%s\"", report.notes[0], text);
}

static void test_rows(void **state) {
    (void)state;
    iso_glyphs glyphs =
        read_text(FILE_ASC, "# a comment\r\n// X Y Z\n1 2 3\n4,5,6\n\n7;8 ; 9\n1e13 0 0\n-1\t-2\t-3");
    assert_int_equal(glyphs.count, 4);
    assert_int_equal(report.dropped, 1);
    assert_int_equal(report.note_count, 0);
    assert_string_equal(report.format, "asc");
    assert_null(glyphs.directions);
    check_vector(glyphs.positions[3], -1, -2, -3);
    iso_glyphs_free(&glyphs);
    glyphs = read_text(FILE_TXT, "4320978.61 0 0\n4320978.62 0 0\n");
    check_place(&glyphs, 1, 4320978.62, 0, 0, 1e-6);
    iso_glyphs_free(&glyphs);
    refuse_text(FILE_TXT, "", ISO_ERR_FORMAT, "empty");
    refuse_text(FILE_TXT, "1 2\n", ISO_ERR_FORMAT, "row 1");
    refuse_text(FILE_TXT, "1 2 3 4 5 6 7 8 9 10 11\n", ISO_ERR_FORMAT, "row 1");
    refuse_text(FILE_TXT, "1 2 3\n1 2 3 4\n", ISO_ERR_FORMAT, "row 2");
    refuse_text(FILE_TXT, "1 2 3\n1 2 c\n", ISO_ERR_FORMAT, "row 2");
}

static void test_names(void **state) {
    (void)state;
    iso_glyphs glyphs = read_text(FILE_TXT, "\"X\";Y,Z Intensity r g b\tNx Ny Nz\n1 2 3 0.5 255 0 1 0 0 1\n");
    assert_int_equal(glyphs.count, 1);
    assert_int_equal(report.note_count, 0);
    assert_true(find_attribute(&glyphs, "Intensity")->values[0] == 0.5f);
    check_vector(glyphs.directions[0], 0, 0, 1);
    assert_int_equal(glyphs.colors[0][0], 255);
    iso_glyphs_free(&glyphs);
    glyphs = read_text(FILE_XYZ, "x y z r g b\n1 2 3 0.5 1 0\n"); /* fractions */
    assert_int_equal(glyphs.colors[0][0], 128);
    iso_glyphs_free(&glyphs);
    glyphs = read_text(FILE_TXT, "x y z\n");
    assert_int_equal(glyphs.count, 0);
    iso_glyphs_free(&glyphs);
    refuse_text(FILE_TXT, "x y\n1 2\n", ISO_ERR_FORMAT, "no z");
    refuse_text(FILE_TXT, "x y z\n1 2\n", ISO_ERR_FORMAT, "row 2");
}

/* Columns that are named by the caller, in every format of rows. */
static void test_given(void **state) {
    (void)state;
    iso_glyphs glyphs = read_text(FILE_XYZ, "1 2 3 9 .5 0 0 1\n");
    iso_glyphs_free(&glyphs);
    glyphs = read_with(FILE_XYZ, (iso_read_opts){.columns = "y,x,z, -,heat,nx,ny,nz"});
    check_vector(glyphs.positions[0], 2, 1, 3);
    check_vector(glyphs.directions[0], 0, 0, 1);
    assert_int_equal(glyphs.attribute_count, 1);
    assert_true(find_attribute(&glyphs, "heat")->values[0] == 0.5f);
    assert_int_equal(report.note_count, 0);
    iso_glyphs_free(&glyphs);
    /* names of the file give way */
    glyphs = read_text(FILE_TXT, "x y z\n1 2 3\n");
    iso_glyphs_free(&glyphs);
    glyphs = read_with(FILE_TXT, (iso_read_opts){.columns = "z,y,x"});
    check_vector(glyphs.positions[0], 3, 2, 1);
    iso_glyphs_free(&glyphs);
    refuse_text(FILE_ASC, "1 2 3 4 5 6 7 8 9 10 255 0 0\n", ISO_ERR_FORMAT,
                "row 1"); /* too many to find out */
    glyphs = read_with(FILE_ASC, (iso_read_opts){.columns = "-,-,-,-,-,-,-,x,y,z,r,g,b"});
    check_vector(glyphs.positions[0], 8, 9, 10);
    assert_int_equal(glyphs.colors[0][0], 255);
    iso_glyphs_free(&glyphs);
    static const struct {
        const char *columns;
        iso_status status;
    } bad[] = {{"x,y", ISO_ERR_USAGE},    {"x,y,,z", ISO_ERR_USAGE},
               {"x,y,z,", ISO_ERR_USAGE}, {"", ISO_ERR_USAGE},
               {"x,y,z", ISO_ERR_FORMAT}, {"x,y,z,-,-,-,-,-,-,-,-,-,-,-", ISO_ERR_FORMAT}};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        iso_error error = {0};
        const iso_read_opts opts = {.columns = bad[i].columns};
        assert_int_equal(iso_glyphs_read(FILE_ASC, &opts, &glyphs, &error), bad[i].status);
    }
}

/* What columns without names are: colours of the first point, or its normal's x, and the attributes. */
static void test_decisions(void **state) {
    (void)state;
    static const struct {
        const char *path, *rows, *note;
        int red;        /* -1: no colours */
        float normal_x; /* NaN: no normals */
        int attributes;
    } tables[] = {
        {FILE_XYZ, "1 2 3 7\n", "x y z, intensity", -1, (float)NAN, 1},
        {FILE_XYZ, "1 2 3 7 8\n", "x y z, column 4, column 5", -1, (float)NAN, 2},
        {FILE_XYZ, "1 2 3 .6 0 .8\n1 2 3 0 0 1\n1 2 3 9 9 9\n", "x y z, normals", -1, .6f, 0},
        {FILE_XYZ, "1 2 3 1 0 0\n1 2 3 200 0 0\n1 2 3 9 9 9\n", "x y z, colors", 1, (float)NAN, 0},
        {FILE_XYZ, "1 2 3 .5 0 0\n1 2 3 .25 0 0\n", "x y z, normals", -1, .5f, 0},
        {FILE_XYZ, "1 2 3 5 0 0\n1 2 3 -9 0 0\n", "x y z, normals", -1, 5, 0},
        {FILE_XYZ, "1 2 3 .6 0 .8 5\n", "x y z, normals, column 7", -1, .6f, 1},
        {FILE_XYZ, "1 2 3 5 .6 0 .8\n", "x y z, intensity, normals", -1, .6f, 1},
        {FILE_XYZ, "1 2 3 50 60 70 80\n", "x y z, colors, column 7", 50, (float)NAN, 1},
        {FILE_PTS, "1 2 3 50 60 70 80\n", "x y z, intensity, colors", 60, (float)NAN, 1},
        {FILE_XYZ, "1 2 3 -50 60 70 80\n", "x y z, intensity, colors", 60, (float)NAN, 1},
        {FILE_XYZ, "1 2 3 9 50 60 70 -8\n", "x y z, colors, column 7, column 8", 9, (float)NAN, 2},
        {FILE_XYZ, "1 2 3 -9 50 60 70 -8\n", "x y z, column 4, colors, column 8", 50, (float)NAN, 2},
        {FILE_XYZ, "1 2 3 -9 50 60 -70 -8\n", "column 4, column 5, column 6, column 7, column 8", -1,
         (float)NAN, 5},
        {FILE_XYZ, "1 2 3 50 60 70 0 0 1\n", "x y z, colors, normals", 50, 0, 0},
        {FILE_XYZ, "1 2 3 0 0 1 50 60 70\n", "x y z, normals, colors", 50, 0, 0},
        {FILE_XYZ, "1 2 3 0 0 1 0 1 0\n", "x y z, normals, colors", 0, 0, 0},
        {FILE_XYZ, "1 2 3 7 8 9 50 60 70\n", "x y z, colors, normals", 7, 50, 0},
        {FILE_XYZ, "1 2 3 50 60 70 0 0 1 4\n", "x y z, colors, normals, column 10", 50, 0, 1},
        {FILE_XYZ, "1 2 3 -4 50 60 70 0 0 1\n", "x y z, intensity, colors, normals", 50, 0, 1},
    };
    for (size_t i = 0; i < sizeof tables / sizeof *tables; i++) {
        iso_glyphs glyphs = read_text(tables[i].path, tables[i].rows);
        check_note(tables[i].note);
        if ((glyphs.colors ? glyphs.colors[0][0] : -1) != tables[i].red) fail_msg("%s", tables[i].rows);
        if ((glyphs.directions != NULL) == (bool)isnan(tables[i].normal_x)) fail_msg("%s", tables[i].rows);
        if (glyphs.directions) assert_true(glyphs.directions[0][0] == tables[i].normal_x);
        assert_int_equal(glyphs.attribute_count, tables[i].attributes);
        iso_glyphs_free(&glyphs);
    }
}

/* The colours behind the intensity of .pts files are colours when all of them are 0, too: not used then. */
static void test_zero_colors(void **state) {
    (void)state;
    iso_glyphs glyphs = read_text(FILE_PTS, "1 2 3 50 0 0 0\n1 2 3 60 0 0 0\n");
    assert_int_equal(report.note_count, 2);
    assert_non_null(strstr(report.notes[0], "x y z, intensity, colors"));
    assert_non_null(strstr(report.notes[1], "0 throughout"));
    assert_null(glyphs.colors);
    iso_glyphs_free(&glyphs);
}

static void test_counted(void **state) {
    (void)state;
    iso_glyphs glyphs = read_text(FILE_PTS, "2\n1 2 3\n4 5 6\n");
    assert_int_equal(glyphs.count, 2);
    assert_int_equal(report.note_count, 0);
    iso_glyphs_free(&glyphs);
    glyphs = read_text(FILE_PTS, "2\n1 2 3\n4 5 6\n7 8 9\n");
    assert_int_equal(glyphs.count, 2);
    check_note("further rows");
    iso_glyphs_free(&glyphs);
    for (int k = 0; k < 2; k++) {
        glyphs = read_text(FILE_PTS, k ? "0\n1 2 3\n" : "0\n");
        assert_int_equal(glyphs.count, 0);
        assert_int_equal(report.note_count, k);
        iso_glyphs_free(&glyphs);
    }
    refuse_text(FILE_PTS, "3\n1 2 3\n4 5 6\n", ISO_ERR_IO, "truncated");
    refuse_text(FILE_PTS, "3\n", ISO_ERR_IO, "truncated");
    refuse_text(FILE_PTS, "99999999999\n1 2 3\n", ISO_ERR_IO, "truncated");
}

/* Points, then as many normals; or both in a row. */
static void test_pwn(void **state) {
    (void)state;
    static const char *const texts[] = {"2\n1 2 3\n4 5 6\n0 0 1\n1 0 0\n", "2\n1 2 3 0 0 1\n4 5 6 1 0 0\n",
                                        "1 2 3 0 0 1\n4 5 6 1 0 0\n"};
    for (int k = 0; k < 3; k++) {
        iso_glyphs glyphs = read_text(FILE_PWN, texts[k]);
        assert_int_equal(glyphs.count, 2);
        assert_int_equal(report.note_count, k > 0);
        check_vector(glyphs.positions[1], 4, 5, 6);
        check_vector(glyphs.directions[1], 1, 0, 0);
        iso_glyphs_free(&glyphs);
    }
    refuse_text(FILE_PWN, "2\n1 2 3\n4 5 6\n0 0 1\n", ISO_ERR_IO, "normals are missing");
    refuse_text(FILE_PWN, "2\n1 2 3\n4 5 6\n0 0 1\n0 0\n", ISO_ERR_FORMAT, "row 5");
    read_truncated(FILE_PWN, texts[0], strlen(texts[0]), (iso_read_opts){0});
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_rows),      cmocka_unit_test(test_names),       cmocka_unit_test(test_given),
        cmocka_unit_test(test_decisions), cmocka_unit_test(test_zero_colors), cmocka_unit_test(test_counted),
        cmocka_unit_test(test_pwn),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
