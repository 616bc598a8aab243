/* lines: the readers of .tck and .trk, on files that are written here and on those of other programs. */
#include <locale.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "check_support.h"
#include "file_support.h"
#include "index_support.h"
#include "io/lines/lines_read.h"
#include "lines_files.h"

#define FILE_TCK ISO_TEST_TMP "/test_lines.tck"
#define FILE_TRK ISO_TEST_TMP "/test_lines.trk"

/* ---- .tck */

static void test_tck_round_trip(void **state) {
    (void)state;
    for (int layout = 0; layout < 4; layout++) {
        iso_lines wanted = random_lines(20000, 7);
        write_tck(FILE_TCK, &wanted, layout & 1 ? 8 : 4, layout & 2);
        iso_read_report report;
        iso_lines got = read_lines(FILE_TCK, &(iso_read_opts){.report = &report});
        check_same_lines(&got, &wanted, 0);
        assert_string_equal(report.format, "tck");
        assert_int_equal(report.items, wanted.line_count);
        assert_int_equal(report.dropped, 0);
        assert_int_equal(report.space, ISO_SPACE_RAS);
        assert_true(report.space_stated);
        iso_lines_free(&got);
        iso_lines_free(&wanted);
    }
}

static void test_space_of_the_caller(void **state) {
    (void)state;
    iso_lines wanted = random_lines(10, 7);
    write_tck(FILE_TCK, &wanted, 4, false);
    iso_read_report report;
    iso_lines got = read_lines(FILE_TCK, &(iso_read_opts){.space = ISO_SPACE_LPS, .report = &report});
    assert_false(report.space_stated);
    assert_int_equal(report.space, ISO_SPACE_LPS);
    for (size_t i = 0; i < got.vertex_count; i++)
        for (int axis = 0; axis < 2; axis++) got.vertices[i][axis] = -got.vertices[i][axis];
    check_same_lines(&got, &wanted, 0);
    iso_lines_free(&got);
    iso_lines_free(&wanted);
}

/* Coordinates far from 0 keep the digits that the file has. */
static void test_far_away(void **state) {
    (void)state;
    iso_lines wanted = random_lines(100, 5), far = random_lines(100, 5);
    for (size_t i = 0; i < far.vertex_count; i++) far.vertices[i][0] += 0x1p21f;
    write_tck(FILE_TCK, &far, 8, false);
    wanted.origin.x = 0x1p21;
    iso_lines got = read_lines(FILE_TCK, NULL);
    assert_true(fabs(got.origin.x - 0x1p21) < 200);
    check_same_lines(&got, &wanted, 0.25); /* what `far` itself has lost */
    iso_lines_free(&got);
    iso_lines_free(&far);
    iso_lines_free(&wanted);
}

/* Every n-th line, of both formats, with the columns of those lines. */
static void check_every(const char *path, int every, const iso_lines *all, double tolerance) {
    iso_read_report report;
    iso_lines some = read_lines(path, &(iso_read_opts){.every = every, .report = &report});
    assert_int_equal(report.items, all->line_count);
    assert_int_equal(some.line_count, (all->line_count + (size_t)every - 1) / (size_t)every);
    for (size_t i = 0; i < some.line_count; i++) {
        const size_t from = all->starts[i * (size_t)every], at = some.starts[i],
                     vertices = some.starts[i + 1] - at;
        assert_int_equal(vertices, all->starts[i * (size_t)every + 1] - from);
        for (size_t v = 0; v < vertices; v++) {
            for (int axis = 0; axis < 3; axis++)
                near((double)some.vertices[at + v][axis], (double)all->vertices[from + v][axis], tolerance);
            for (int a = 0; a < some.attribute_count; a++)
                if (!some.attributes[a].per_line)
                    assert_true(some.attributes[a].values[at + v] == trk_scalar(a, from + v));
        }
    }
    iso_lines_free(&some);
}

static void test_every(void **state) {
    (void)state;
    const trk_layout layout = {.version = 2,
                               .dims = {9, 9, 9},
                               .matrix = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1},
                               .order = "RAS",
                               .scalars = 2};
    iso_lines all = random_lines(5001, 3);
    write_tck(FILE_TCK, &all, 4, false);
    write_trk(FILE_TRK, &all, &layout);
    for (int every = 2; every < 8000; every = 3 * every + 1) {
        check_every(FILE_TCK, every, &all, 0);
        check_every(FILE_TRK, every, &all, 1e-4);
    }
    iso_lines_free(&all);
}

/* A vertex that is no number ends a line without a segment across the gap. */
static void test_bad_vertices(void **state) {
    (void)state;
    iso_lines lines = random_lines(1, 3);
    assert_true(lines.vertex_count >= 5);
    const float bad[] = {NAN, INFINITY, 3e12f};
    for (int k = 0; k < 3; k++)
        for (int value = 4; value <= 8; value += 4) {
            lines.vertices[2][1] = bad[k];
            write_tck(FILE_TCK, &lines, value, false);
            iso_read_report report;
            iso_lines got = read_lines(FILE_TCK, &(iso_read_opts){.report = &report});
            assert_int_equal(got.line_count, 2);
            assert_int_equal(got.starts[1], 2);
            assert_int_equal(got.vertex_count, lines.vertex_count - 1);
            assert_int_equal(report.dropped, 1);
            assert_int_equal(report.items, 1);
            assert_memory_equal(got.vertices[2], lines.vertices[3], 12);
            iso_lines_free(&got);
        }
    iso_lines_free(&lines);
}

static void test_cut_off(void **state) {
    (void)state;
    const trk_layout layout = {.version = 2,
                               .dims = {9, 9, 9},
                               .matrix = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1},
                               .order = "RAS",
                               .properties = 1};
    iso_lines lines = random_lines(4, 3);
    write_tck(FILE_TCK, &lines, 4, false);
    check_every_cut(FILE_TCK, ISO_TEST_TMP "/test_lines_cut.tck", 0);
    write_trk(FILE_TRK, &lines, &layout);
    check_every_cut(FILE_TRK, ISO_TEST_TMP "/test_lines_cut.trk", 0);
    iso_lines_free(&lines);
}

static void test_limit(void **state) {
    (void)state;
    iso_lines lines = random_lines(20000, 3);
    write_tck(FILE_TCK, &lines, 4, false);
    refuse_lines(FILE_TCK, &(iso_read_opts){.max_memory = 400000}, ISO_ERR_LIMIT, "--max-memory");
    refuse_lines(FILE_TCK, &(iso_read_opts){.max_memory = 400000, .every = 2}, ISO_ERR_LIMIT, "--max-memory");
    iso_lines few = read_lines(FILE_TCK, &(iso_read_opts){.max_memory = 400000, .every = 100});
    assert_int_equal(few.line_count, 200);
    iso_lines_free(&few);
    iso_lines_free(&lines);
}

static void test_no_lines(void **state) {
    (void)state;
    iso_lines none = random_lines(0, 1);
    write_tck(FILE_TCK, &none, 4, false);
    iso_lines got = read_lines(FILE_TCK, NULL);
    assert_int_equal(got.line_count, 0);
    assert_int_equal(got.starts[0], 0);
    iso_lines_free(&got);
    iso_lines_free(&none);
    refuse_lines(ISO_TEST_TMP "/no such file.tck", NULL, ISO_ERR_IO, "cannot read");
    refuse_lines(ISO_TEST_TMP, NULL, ISO_ERR_IO, "not a regular file");
    spill(ISO_TEST_TMP "/test_lines.txt", "hello", 5);
    refuse_lines(ISO_TEST_TMP "/test_lines.txt", NULL, ISO_ERR_FORMAT, "not a file of lines");
}

/* The content tells the format, whatever the name. */
static void test_content_first(void **state) {
    (void)state;
    iso_lines wanted = random_lines(30, 1);
    write_tck(FILE_TRK, &wanted, 4, false);
    iso_lines got = read_lines(FILE_TRK, NULL);
    check_same_lines(&got, &wanted, 0);
    iso_lines_free(&got);
    iso_lines_free(&wanted);
}

/* ---- .trk */

/* A random matrix whose columns lie near the world axes, in any order and direction. */
static void random_matrix(uint32_t *seed, double m[12]) {
    int axes[3] = {0, 1, 2};
    for (int i = 2; i > 0; i--) {
        const int k = (int)(random_bits(seed) % (uint32_t)(i + 1)), kept = axes[i];
        axes[i] = axes[k];
        axes[k] = kept;
    }
    for (int column = 0; column < 3; column++) {
        const double size = 0.5 + 2 * uniform(seed), sign = random_bits(seed) % 2 ? 1 : -1;
        for (int row = 0; row < 3; row++)
            m[4 * row + column] = row == axes[column] ? sign * size : size * (0.4 * uniform(seed) - 0.2);
    }
    for (int row = 0; row < 3; row++) m[4 * row + 3] = 200 * uniform(seed) - 100;
}

static void random_order(uint32_t *seed, char order[4]) {
    static const char letters[3][3] = {"RL", "AP", "SI"};
    const int first = (int)(random_bits(seed) % 3), step = 1 + (int)(random_bits(seed) % 2);
    for (int i = 0; i < 3; i++) order[i] = letters[(first + i * step) % 3][random_bits(seed) % 2];
    order[3] = 0;
}

/* dims belong to the axes of `order`: a turned axis counts from their end. */
static void test_trk_round_trip(void **state) {
    (void)state;
    uint32_t seed = 11;
    for (int i = 0; i < 300; i++) {
        char order[4];
        trk_layout layout = {.version = 2, .dims = {20, 31, 7}, .order = order, .big = i & 1};
        layout.scalars = (int)(random_bits(&seed) % 4);
        layout.properties = (int)(random_bits(&seed) % 3);
        random_matrix(&seed, layout.matrix);
        random_order(&seed, order);
        iso_lines wanted = random_lines(40, (uint32_t)i);
        write_trk(FILE_TRK, &wanted, &layout);
        iso_read_report report;
        iso_lines got = read_lines(FILE_TRK, &(iso_read_opts){.report = &report});
        check_same_lines(&got, &wanted, 1e-3);
        assert_int_equal(report.note_count, 0);
        assert_int_equal(got.attribute_count, layout.scalars + layout.properties);
        for (int a = 0; a < got.attribute_count; a++) {
            const iso_attribute *attribute = &got.attributes[a];
            const int p = a - layout.scalars;
            assert_int_equal(attribute->per_line, p >= 0);
            assert_int_equal(attribute->name[0], p < 0 ? 's' : 'p');
            assert_int_equal(attribute->components, 1);
            for (size_t k = 0; k < (p < 0 ? got.vertex_count : got.line_count); k++)
                assert_true(attribute->values[k] == (p < 0 ? trk_scalar(a, k) : trk_property(p, k)));
        }
        iso_lines_free(&got);
        iso_lines_free(&wanted);
    }
}

/* Without a matrix shape, size and axes are right, and the report says that the place is not. */
static void test_trk_version_1(void **state) {
    (void)state;
    const trk_layout layout = {
        .version = 1, .dims = {9, 9, 9}, .matrix = {-1.5, 0, 0, 0, 0, -2, 0, 0, 0, 0, 3, 0}, .order = "LPS"};
    iso_lines wanted = random_lines(40, 1);
    write_trk(FILE_TRK, &wanted, &layout);
    iso_read_report report;
    iso_lines got = read_lines(FILE_TRK, &(iso_read_opts){.report = &report});
    check_same_lines(&got, &wanted, 1e-3);
    assert_int_equal(report.note_count, 1);
    assert_non_null(strstr(report.notes[0], "vox_to_ras"));
    iso_lines_free(&got);
    iso_lines_free(&wanted);
}

static void test_trk_names(void **state) {
    (void)state;
    const trk_layout layout = {.version = 2,
                               .dims = {9, 9, 9},
                               .matrix = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1},
                               .order = "RAS",
                               .scalars = 7};
    iso_lines wanted = random_lines(5, 1);
    write_trk(FILE_TRK, &wanted, &layout);
    size_t size;
    char *bytes = slurp(FILE_TRK, &size);
    char(*names)[20] = (char(*)[20])(void *)(bytes + 38);
    memset(names, 0, 200);
    memcpy(names[0], "col\0002", 5); /* two columns */
    memcpy(names[1], "same    ", 8); /* two columns of one name, padded */
    memcpy(names[2], "same", 4);
    memcpy(names[3], "e\033[1m", 5);
    spill(FILE_TRK, bytes, size);
    free(bytes);
    iso_lines got = read_lines(FILE_TRK, NULL);
    assert_int_equal(got.attribute_count, 4);
    static const struct {
        const char *name;
        int components, first;
    } expected[] = {{"col", 2, 0}, {"same", 2, 2}, {"e\\x1b[1m", 1, 4}, {"scalars", 2, 5}};
    for (int a = 0; a < 4; a++) {
        const iso_attribute *attribute = &got.attributes[a];
        assert_string_equal(attribute->name, expected[a].name);
        assert_int_equal(attribute->components, expected[a].components);
        for (size_t i = 0; i < got.vertex_count; i++)
            for (int c = 0; c < attribute->components; c++)
                assert_true(attribute->values[i * (size_t)attribute->components + (size_t)c] ==
                            trk_scalar(expected[a].first + c, i));
    }
    iso_lines_free(&got);
    iso_lines_free(&wanted);
}

/* ---- files of other programs */

static void check_row(const index_row *row) {
    iso_read_report report;
    iso_lines lines = read_lines(row->path, &(iso_read_opts){.report = &report});
    const iso_box box = own_box(&lines, report.space);
    if ((long)lines.line_count != number_before(row->counts, " streamlines") ||
        (long)lines.vertex_count != number_before(row->counts, " points"))
        fail_msg("%s: %zu lines, %zu vertices, wanted %s", row->name, lines.line_count, lines.vertex_count,
                 row->counts);
    /* a file without a matrix has no position that could be wrong */
    if (row->has_box && report.note_count == 0) check_box(row->name, &box, &row->box);
    iso_lines_free(&lines);
}

static void test_index(void **state) {
    (void)state;
    static const char *const formats[] = {"tck", "trk", NULL};
    assert_true(check_index("lines", formats, check_row) >= 18);
}

/* The same lines in three files. */
static void test_standard(void **state) {
    (void)state;
    free(load_index("lines")); /* skips when there are none */
    iso_lines trk = read_lines(index_path("lines", "trk/standard.trk"), NULL),
              lps = read_lines(index_path("lines", "trk/standard.LPS.trk"), NULL),
              tck = read_lines(index_path("lines", "tck/standard.tck"), NULL);
    check_same_lines(&trk, &tck, 1e-6);
    check_same_lines(&lps, &tck, 1e-6);
    iso_lines_free(&trk);
    iso_lines_free(&lps);
    iso_lines_free(&tck);
}

/* What becomes of files that are damaged or odd. */
static const lines_outcome odd[] = {
    {"bad/tck/orig.tck", ISO_OK, NULL, 20, 146, -1, 0, 0, 0},
    {"bad/tck/badcount.tck", ISO_OK, NULL, 20, 146, -1, 0, 0, 0},
    {"bad/tck/dataaftereofdelim.tck", ISO_OK, NULL, 20, 146, -1, 0, 0, 0},
    {"bad/tck/float64.tck", ISO_OK, NULL, 20, 146, -1, 0, 0, 0},
    {"bad/tck/huge_coordinates.tck", ISO_OK, NULL, 20, 146, -1, 5, 0, 0},
    {"bad/tck/matlab_nan.tck", ISO_OK, NULL, 1, 108, -1, 0, 0, 0},
    {"bad/tck/no_header_end.tck", ISO_ERR_FORMAT, "END", 0, 0, 0, 0, 0, 0},
    {"bad/tck/no_header_end_eof.tck", ISO_ERR_FORMAT, "END", 0, 0, 0, 0, 0, 0},
    {"bad/tck/no_magic_number.tck", ISO_ERR_FORMAT, "not a .tck file", 0, 0, 0, 0, 0, 0},
    {"bad/tck/noeofdelim.tck", ISO_ERR_IO, "truncated", 0, 0, 0, 0, 0, 0},
    {"bad/tck/nolastdelim.tck", ISO_OK, NULL, 20, 146, -1, 0, 0, 0},
    {"bad/tck/novertices.tck", ISO_OK, NULL, 20, 146, -1, 0, 0, 0},
    {"bad/tck/offset_in_header.tck", ISO_ERR_FORMAT, "within the header", 0, 0, 0, 0, 0, 0},
    {"bad/tck/offset_past_end.tck", ISO_ERR_IO, "truncated", 0, 0, 0, 0, 0, 0},
    {"bad/tck/onevertex.tck", ISO_OK, NULL, 21, 147, -1, 0, 0, 0},
    {"bad/tck/partialfinite.tck", ISO_OK, NULL, 22, 150, -1, 1, 0, 0},
    {"bad/tck/truncated_mid_vertex.tck", ISO_ERR_IO, "truncated", 0, 0, 0, 0, 0, 0},
    {"bad/tck/unknown_datatype.tck", ISO_ERR_FORMAT, "Int16LE", 0, 0, 0, 0, 0, 0},
    {"bad/trk/hdr_size_garbage.trk", ISO_ERR_FORMAT, "its size", 0, 0, 0, 0, 0, 0},
    {"bad/trk/huge_points.trk", ISO_ERR_IO, "truncated", 0, 0, 0, 0, 0, 0},
    {"bad/trk/n_count_negative.trk", ISO_ERR_FORMAT, "lines", 0, 0, 0, 0, 0, 0},
    {"bad/trk/n_count_too_few.trk", ISO_OK, NULL, 120, 360, -1, 0, 0, 1},
    {"bad/trk/n_count_too_many.trk", ISO_ERR_IO, "truncated", 0, 0, 0, 0, 0, 0},
    {"bad/trk/n_count_zero.trk", ISO_OK, NULL, 120, 360, -1, 0, 0, 0},
    {"bad/trk/nan_vertex.trk", ISO_OK, NULL, 120, 359, -1, 1, 0, 0},
    {"bad/trk/negative_points.trk", ISO_ERR_FORMAT, "points", 0, 0, 0, 0, 0, 0},
    {"bad/trk/not_track.trk", ISO_ERR_FORMAT, "not a .trk file", 0, 0, 0, 0, 0, 0},
    {"bad/trk/scalars_300.trk", ISO_ERR_FORMAT, "scalars", 0, 0, 0, 0, 0, 0},
    {"bad/trk/scalars_negative.trk", ISO_ERR_FORMAT, "scalars", 0, 0, 0, 0, 0, 0},
    {"bad/trk/singular_matrix.trk", ISO_ERR_FORMAT, "singular", 0, 0, 0, 0, 0, 0},
    {"bad/trk/truncated_header.trk", ISO_ERR_IO, "truncated", 0, 0, 0, 0, 0, 0},
    {"bad/trk/truncated_record.trk", ISO_ERR_IO, "truncated", 0, 0, 0, 0, 0, 0},
    {"bad/trk/version_1.trk", ISO_OK, NULL, 120, 360, -1, 0, 0, 1},
    {"bad/trk/vox_to_ras_unset.trk", ISO_OK, NULL, 120, 360, -1, 0, 0, 1},
    {"bad/trk/voxel_order_empty.trk", ISO_OK, NULL, 120, 360, -1, 0, 0, 0},
    {"bad/trk/zero_voxel_size.trk", ISO_ERR_FORMAT, "voxel size", 0, 0, 0, 0, 0, 0},
};

static void test_odd_files(void **state) {
    (void)state;
    check_lines_outcomes(odd, sizeof odd / sizeof *odd);
}

int main(void) {
    setlocale(LC_ALL, "");
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_tck_round_trip), cmocka_unit_test(test_space_of_the_caller),
        cmocka_unit_test(test_far_away),       cmocka_unit_test(test_every),
        cmocka_unit_test(test_bad_vertices),   cmocka_unit_test(test_cut_off),
        cmocka_unit_test(test_limit),          cmocka_unit_test(test_no_lines),
        cmocka_unit_test(test_content_first),  cmocka_unit_test(test_trk_round_trip),
        cmocka_unit_test(test_trk_version_1),  cmocka_unit_test(test_trk_names),
        cmocka_unit_test(test_index),          cmocka_unit_test(test_standard),
        cmocka_unit_test(test_odd_files),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
