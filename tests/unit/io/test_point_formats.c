/* point_formats: the readers of formats that scans come in: .pcd, .las and .npy. */
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "check_support.h"
#include "file_support.h"
#include "glyphs_support.h"

#define FILE_PCD ISO_TEST_TMP "/test_point_formats.pcd"
#define FILE_LAS ISO_TEST_TMP "/test_point_formats.las"
#define FILE_NPY ISO_TEST_TMP "/test_point_formats.npy"

/* ---- files that are made here */

typedef struct made_file {
    unsigned char bytes[4096];
    size_t count;
} made_file;

static void add_bytes(made_file *file, const void *bytes, size_t count) {
    assert_true(file->count + count <= sizeof file->bytes);
    memcpy(file->bytes + file->count, bytes, count);
    file->count += count;
}

static void add_text(made_file *file, const char *text) {
    add_bytes(file, text, strlen(text));
}

static void add_floats(made_file *file, int count, const float *values) {
    add_bytes(file, values, (size_t)count * sizeof *values);
}

static iso_glyphs read_made(const char *path, const made_file *file) {
    spill(path, file->bytes, file->count);
    return read_with(path, (iso_read_opts){0});
}

static void refuse_made(const char *path, const made_file *file, iso_status status, const char *reason) {
    spill(path, file->bytes, file->count);
    refuse(path, (iso_read_opts){0}, status, reason);
}

static void check_color(const iso_glyphs *glyphs, size_t glyph, int red, int green, int blue) {
    assert_non_null(glyphs->colors);
    assert_int_equal(glyphs->colors[glyph][0], red);
    assert_int_equal(glyphs->colors[glyph][1], green);
    assert_int_equal(glyphs->colors[glyph][2], blue);
}

/* ---- .pcd */

static void test_pcd_ascii(void **state) {
    (void)state;
    iso_glyphs glyphs = read_text(
        FILE_PCD,
        "# .PCD v.7 - Point Cloud Data file format\r\nVERSION .7\r\nFIELDS x y z rgb _ normal_x normal_y "
        "normal_z curvature f\r\nSIZE 4 4 4 4 1 4 4 4 4 4\r\nTYPE F F F F U F F F F F\r\n"
        "COUNT 1 1 1 1 2 1 1 1 1 2\r\nWIDTH 3\r\nHEIGHT 1\r\nVIEWPOINT 0 0 0 1 0 0 0\r\nPOINTS 3\r\n"
        "DATA ascii\r\n1 2 3 2.33721352e-38 9 9 0 0 1 0.25 5 6\r\nnan nan nan 0 9 9 nan nan nan 0 0 0\r\n"
        "\r\n4320978.61,5\t6;1.4e-45 9 9 1 0 0 0.5 7 8");
    assert_int_equal(glyphs.count, 2);
    assert_int_equal(report.dropped, 1);
    assert_int_equal(report.note_count, 0);
    assert_string_equal(report.format, "pcd");
    check_place(&glyphs, 0, 1, 2, 3, 0);
    check_place(&glyphs, 1, 4320978.61, 5, 6, 0.5);
    check_color(&glyphs, 0, 254, 128, 1);
    check_color(&glyphs, 1, 0, 0, 1); /* the smallest denormal */
    check_vector(glyphs.directions[1], 1, 0, 0);
    assert_true(find_attribute(&glyphs, "curvature")->values[1] == 0.5f);
    const iso_attribute *pair = find_attribute(&glyphs, "f");
    assert_true(pair->components == 2 && pair->values[2] == 7 && pair->values[3] == 8);
    iso_glyphs_free(&glyphs);
}

static const char binary_head[] =
    "VERSION 0.7\nFIELDS X Y Z rgba _ intensity\nSIZE 4 4 4 4 2 2\nTYPE F F F U U I\n"
    "COUNT 1 1 1 1 3 1\nWIDTH 2\nHEIGHT 1\nVIEWPOINT 0 0 0 0 1 0 0\nPOINTS 2\nDATA ";

/* A point of binary_head. */
static void add_pcd_point(made_file *file, float x, uint32_t rgba, int16_t intensity) {
    add_floats(file, 3, (float[]){x, x + 1, x + 2});
    add_bytes(file, &rgba, 4);
    add_bytes(file, "??????", 6);
    add_bytes(file, &intensity, 2);
}

static void check_binary_pcd(iso_glyphs glyphs) {
    assert_int_equal(glyphs.count, 2);
    check_place(&glyphs, 0, 0.1f, 1.1f, 2.1f, 1e-6);
    check_place(&glyphs, 1, 7, 8, 9, 0);
    check_color(&glyphs, 0, 1, 2, 3);
    check_color(&glyphs, 1, 255, 128, 0);
    assert_true(find_attribute(&glyphs, "intensity")->values[1] == -5);
    assert_int_equal(glyphs.attribute_count, 1);
    assert_int_equal(report.note_count, 1);
    assert_non_null(strstr(report.notes[0], "VIEWPOINT"));
    iso_glyphs_free(&glyphs);
}

static void test_pcd_binary(void **state) {
    (void)state;
    made_file file = {.count = 0};
    add_text(&file, binary_head);
    add_text(&file, "binary\n");
    add_pcd_point(&file, 0.1f, 0xff010203, 4);
    add_pcd_point(&file, 7, 0x00ff8000, -5);
    check_binary_pcd(read_made(FILE_PCD, &file));
    read_truncated(FILE_PCD, file.bytes, file.count, (iso_read_opts){0});
    file.count--;
    refuse_made(FILE_PCD, &file, ISO_ERR_IO, "truncated");
}

/* Field by field, the first literally; the padding as references. */
static void test_pcd_compressed(void **state) {
    (void)state;
    made_file data = {.count = 0}, file = {.count = 0};
    for (int axis = 0; axis < 3; axis++) {
        add_text(&data, "\x07");
        add_floats(&data, 2, (float[]){0.1f + (float)axis, 7 + (float)axis});
    }
    add_text(&data, "\x07");
    add_bytes(&data, (uint32_t[]){0xff010203, 0x00ff8000}, 8);
    add_bytes(&data, "\x00?\xe0\x02\x00", 5); /* a literal and a run of 7 + 2 + 2 */
    add_bytes(&data, "\x03\x04\x00\xfb\xff", 5);
    const uint32_t sizes[2] = {(uint32_t)data.count, 2 * 24};
    add_text(&file, binary_head);
    add_text(&file, "binary_compressed\n");
    const size_t head = file.count;
    add_bytes(&file, sizes, sizeof sizes);
    add_bytes(&file, data.bytes, data.count);
    check_binary_pcd(read_made(FILE_PCD, &file));
    read_truncated(FILE_PCD, file.bytes, file.count, (iso_read_opts){0});
    /* every byte damaged: mostly read all the same, never read or written out of bounds */
    for (size_t at = head; at < file.count; at++) {
        made_file damaged = file;
        damaged.bytes[at] ^= 0xff;
        iso_glyphs glyphs;
        spill(FILE_PCD, damaged.bytes, damaged.count);
        if (iso_glyphs_read(FILE_PCD, NULL, &glyphs, NULL) == ISO_OK) iso_glyphs_free(&glyphs);
    }
    file.bytes[head + 5] = 1; /* 256 bytes more */
    refuse_made(FILE_PCD, &file, ISO_ERR_FORMAT, "damaged");
}

static void test_pcd_types(void **state) {
    (void)state;
    made_file file = {.count = 0};
    add_text(&file,
             "COLUMNS x y z Red Green Blue i\nSIZE 8 8 8 2 2 2 8\nTYPE F F F U U U I\nWIDTH 1\nHEIGHT 2\n"
             "DATA binary\n");
    for (int i = 0; i < 2; i++) {
        add_bytes(&file, (double[]){493994.875 + i, 4877429.625, 1}, 24);
        add_bytes(&file, (uint16_t[]){65535, 257, 0}, 6);
        add_bytes(&file, (int64_t[]){-70000}, 8);
    }
    iso_glyphs glyphs = read_made(FILE_PCD, &file);
    assert_int_equal(glyphs.count, 2);
    check_place(&glyphs, 1, 493995.875, 4877429.625, 1, 0);
    check_color(&glyphs, 0, 255, 1, 0);
    assert_true(find_attribute(&glyphs, "i")->values[0] == -70000);
    iso_glyphs_free(&glyphs);
}

static void test_pcd_errors(void **state) {
    (void)state;
    static const struct {
        const char *text;
        iso_status status;
        const char *reason;
    } bad[] = {
        {"1 2 3\n4 5 6\n", ISO_ERR_FORMAT, "\"1\" line"},
        {"", ISO_ERR_FORMAT, "no line DATA"},
        {"FIELDS x y z\nWIDTH 1\n", ISO_ERR_FORMAT, "no line DATA"},
        {"WIDTH 1\nDATA ascii\n", ISO_ERR_FORMAT, "no fields"},
        {"FIELDS x y\nPOINTS 1\nDATA ascii\n1 2\n", ISO_ERR_FORMAT, "no z"},
        {"FIELDS x y z\nSIZE 4 4\nPOINTS 1\nDATA ascii\n1 2 3\n", ISO_ERR_FORMAT, "\"SIZE\""},
        {"FIELDS x y z\nSIZE 4 4 3\nPOINTS 1\nDATA ascii\n1 2 3\n", ISO_ERR_FORMAT, "field z"},
        {"FIELDS x y z\nCOUNT 1 1 600\nPOINTS 1\nDATA ascii\n1 2 3\n", ISO_ERR_FORMAT, "\"COUNT\""},
        {"FIELDS x y z a b\nCOUNT 1 1 1 400 400\nPOINTS 1\nDATA ascii\n1 2 3\n", ISO_ERR_FORMAT,
         "512 numbers"},
        {"FIELDS x y z\nPOINTS -1\nDATA ascii\n1 2 3\n", ISO_ERR_FORMAT, "\"POINTS\""},
        {"FIELDS x y z\nPOINTS 1\nDATA zip\n1 2 3\n", ISO_ERR_FORMAT, "\"DATA\""},
        {"FIELDS x y z\nPOINTS 1\nDATA ascii\n1 2\n3 4 5 6\n", ISO_ERR_FORMAT, "row 4"},
        {"FIELDS x y z\nPOINTS 2\nDATA ascii\n1 2 3\n \n \n \n \n", ISO_ERR_IO, "truncated"},
        {"FIELDS x y z\nPOINTS 99999999999\nDATA ascii\n1 2 3\n", ISO_ERR_IO, "truncated"},
        {"FIELDS x y z\nPOINTS 99999999999\nDATA binary\n1 2 3\n", ISO_ERR_IO, "truncated"},
        {"FIELDS x y z\nPOINTS 18446744073709551615\nDATA binary_compressed\nabcdefgh", ISO_ERR_IO,
         "truncated"},
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        refuse_text(FILE_PCD, bad[i].text, bad[i].status, bad[i].reason);
    iso_glyphs none = read_text(FILE_PCD, "FIELDS x y z\nPOINTS 0\nDATA binary_compressed\n");
    assert_int_equal(none.count, 0);
    iso_glyphs_free(&none);
}

/* ---- .las */

static void put(made_file *file, size_t at, const void *bytes, size_t count) {
    memcpy(file->bytes + at, bytes, count);
}

/* A header with a block of variable length and two bytes before the points. */
static made_file make_las(int minor, int format, uint16_t record, uint32_t points) {
    made_file file = {.count = minor >= 4 ? 375 : 227};
    const uint16_t length = (uint16_t)file.count;
    const uint32_t begin = (uint32_t)(file.count + 54 + 3 + 2), one = 1;
    memcpy(file.bytes, "LASF", 4);
    file.bytes[24] = 1;
    file.bytes[25] = (unsigned char)minor;
    put(&file, 94, &length, 2);
    put(&file, 96, &begin, 4);
    put(&file, 100, &one, 4);
    file.bytes[104] = (unsigned char)format;
    put(&file, 105, &record, 2);
    put(&file, minor >= 4 ? 247 : 107, &points, 4);
    for (size_t axis = 0; axis < 3; axis++) {
        const double scale = 0.01, shift = axis == 0 ? 500000 : 0;
        put(&file, 131 + 8 * axis, &scale, 8);
        put(&file, 155 + 8 * axis, &shift, 8);
    }
    unsigned char block[54 + 3 + 2] = {0};
    strcpy((char *)block + 2, "LASF_Projection");
    block[20] = 3;
    add_bytes(&file, block, sizeof block);
    return file;
}

/* Adds a point of `record` bytes whose colour, and time, are at these offsets; 0: it has none. */
static void add_las_point(made_file *file, const int32_t xyz[3], size_t record, size_t time, size_t color,
                          uint16_t red) {
    unsigned char bytes[80] = {0};
    const uint16_t intensity = 700, rgb[3] = {red, 0, 1};
    const double gps = 1234567.5 + xyz[0];
    memcpy(bytes, xyz, 12);
    memcpy(bytes + 12, &intensity, 2);
    bytes[14] = 0xfb;
    bytes[15] = 0xe2;
    bytes[16] = 66;
    if (time) memcpy(bytes + time, &gps, 8);
    if (color) memcpy(bytes + color, rgb, 6);
    add_bytes(file, bytes, record);
}

static void test_las_formats(void **state) {
    (void)state;
    static const struct {
        int minor, format;
        size_t record, time, color;
        float return_number, classification;
    } kinds[] = {
        {0, 0, 20, 0, 0, 3, 2},    {2, 1, 28, 20, 0, 3, 2},     {2, 2, 26, 0, 20, 3, 2},
        {3, 3, 40, 20, 28, 3, 2},  {3, 4, 57, 20, 0, 3, 2},     {3, 5, 63, 20, 28, 3, 2},
        {4, 6, 30, 22, 0, 11, 66}, {4, 7, 36, 22, 30, 11, 66},  {4, 8, 38, 22, 30, 11, 66},
        {4, 9, 59, 22, 0, 11, 66}, {4, 10, 67, 22, 30, 11, 66}, {1, 1, 28, 20, 0, 3, 2},
    };
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++) {
        made_file file = make_las(kinds[i].minor, kinds[i].format, (uint16_t)kinds[i].record, 2);
        add_las_point(&file, (int32_t[]){1, -2, 3}, kinds[i].record, kinds[i].time, kinds[i].color, 257);
        add_las_point(&file, (int32_t[]){12345678, 0, 0}, kinds[i].record, kinds[i].time, kinds[i].color,
                      65535);
        iso_glyphs glyphs = read_made(FILE_LAS, &file);
        assert_string_equal(report.format, "las");
        assert_int_equal(glyphs.count, 2);
        check_place(&glyphs, 0, 500000.01, -0.02, 0.03, 1e-6);
        check_place(&glyphs, 1, 623456.78, 0, 0, 0.01);
        assert_true(find_attribute(&glyphs, "intensity")->values[1] == 700);
        assert_true(find_attribute(&glyphs, "return_number")->values[1] == kinds[i].return_number);
        assert_true(find_attribute(&glyphs, "classification")->values[0] == kinds[i].classification);
        if (kinds[i].time) assert_true(find_attribute(&glyphs, "gps_time")->values[1] == 12345677.0f + 0.5f);
        assert_int_equal(glyphs.attribute_count, kinds[i].time ? 4 : 3);
        assert_int_equal(report.note_count, kinds[i].time ? 1 : 0);
        if (kinds[i].color) check_color(&glyphs, 0, 1, 0, 0);
        if (kinds[i].color) check_color(&glyphs, 1, 255, 0, 0);
        iso_glyphs_free(&glyphs);
        read_truncated(FILE_LAS, file.bytes, file.count, (iso_read_opts){0});
    }
}

static void test_las_errors(void **state) {
    (void)state;
    made_file file = make_las(2, 2, 26, 1);
    add_las_point(&file, (int32_t[]){0, 0, 0}, 26, 0, 20, 200); /* colours of 8 bits */
    iso_glyphs glyphs = read_made(FILE_LAS, &file);
    check_color(&glyphs, 0, 200, 0, 1);
    iso_glyphs_free(&glyphs);
    made_file bad = file;
    bad.bytes[104] |= 0x80;
    refuse_made(FILE_LAS, &bad, ISO_ERR_FORMAT, "nothing says how its points are compressed (LAZ)");
    const uint16_t laszip = 22204;
    strcpy((char *)bad.bytes + 227 + 2, "laszip encoded");
    put(&bad, 227 + 18, &laszip, sizeof laszip);
    refuse_made(FILE_LAS, &bad, ISO_ERR_IO, "damaged: its block of LASzip");
    bad = file;
    bad.bytes[104] = 11;
    refuse_made(FILE_LAS, &bad, ISO_ERR_UNSUPPORTED, "point format 11");
    bad = file;
    bad.bytes[105] = 25;
    refuse_made(FILE_LAS, &bad, ISO_ERR_FORMAT, "25 bytes");
    bad = file;
    bad.bytes[108] = 1; /* 257 points */
    refuse_made(FILE_LAS, &bad, ISO_ERR_IO, "257 points");
    bad = file;
    bad.bytes[96] = 100, bad.bytes[97] = 0; /* the points begin in the header */
    refuse_made(FILE_LAS, &bad, ISO_ERR_FORMAT, "damaged");
    refuse_text(FILE_LAS, "LASF", ISO_ERR_IO, "truncated");
}

/* ---- .npy */

static made_file make_npy(int version, const char *dictionary) {
    made_file file = {.count = 0};
    const uint32_t length = (uint32_t)strlen(dictionary);
    add_bytes(&file, "\x93NUMPY", 6);
    add_bytes(&file, (char[]){(char)version, 0}, 2);
    add_bytes(&file, &length, version == 1 ? 2 : 4);
    add_text(&file, dictionary);
    return file;
}

static void test_npy_orders(void **state) {
    (void)state;
    made_file file = make_npy(1, "{'descr': '<f4', 'fortran_order': False, 'shape': (2, 6), }  \n");
    add_floats(&file, 12, (float[]){1, 2, 3, 0, 0, 1, 4, 5, 6, 1, 0, 0});
    iso_glyphs glyphs = read_made(FILE_NPY, &file);
    assert_int_equal(glyphs.count, 2);
    assert_string_equal(report.format, "npy");
    assert_non_null(strstr(report.notes[0], "x y z, normals"));
    check_place(&glyphs, 1, 4, 5, 6, 0);
    check_vector(glyphs.directions[1], 1, 0, 0);
    iso_glyphs_free(&glyphs);
    read_truncated(FILE_NPY, file.bytes, file.count, (iso_read_opts){0});
    file = make_npy(2, "{'descr': '<f8', 'fortran_order': True, 'shape': (2, 4)}");
    add_bytes(&file, (double[]){500000.25, 500001.5, 2, 5, 3, 6, 7, 8}, 64);
    glyphs = read_made(FILE_NPY, &file);
    check_place(&glyphs, 0, 500000.25, 2, 3, 0);
    check_place(&glyphs, 1, 500001.5, 5, 6, 0);
    assert_true(find_attribute(&glyphs, "intensity")->values[1] == 8);
    iso_glyphs_free(&glyphs);
    read_truncated(FILE_NPY, file.bytes, file.count, (iso_read_opts){0});
    file = make_npy(3, "{'shape': (1L, 3L), 'fortran_order': False, 'descr': '>i2'}");
    add_bytes(&file, "\x01\x00\xff\xff\x00\x02", 6);
    glyphs = read_made(FILE_NPY, &file);
    check_place(&glyphs, 0, 256, -1, 2, 0);
    iso_glyphs_free(&glyphs);
}

static void test_npy_errors(void **state) {
    (void)state;
    static const struct {
        int version;
        const char *dictionary;
        iso_status status;
        const char *reason;
    } bad[] = {
        {4, "{}", ISO_ERR_UNSUPPORTED, "version 4"},
        {1, "{}", ISO_ERR_FORMAT, "descr"},
        {1, "{'descr': '<f4'}", ISO_ERR_FORMAT, "fortran_order"},
        {1, "{'descr': '<f4', 'fortran_order': False, 'shape': (2,)}", ISO_ERR_FORMAT, "shape"},
        {1, "{'descr': '<f4', 'fortran_order': False, 'shape': (2, 3, 4)}", ISO_ERR_FORMAT, "shape"},
        {1, "{'descr': '<f4', 'fortran_order': False, 'shape': (-2, 3)}", ISO_ERR_FORMAT, "shape"},
        {1, "{'descr': '<f4', 'fortran_order': False, 'shape': (2, 2)}", ISO_ERR_FORMAT, "2 numbers"},
        {1, "{'descr': '<f4', 'fortran_order': False, 'shape': (2, 11)}", ISO_ERR_FORMAT, "11 numbers"},
        {1, "{'descr': '<f4', 'fortran_order': False, 'shape': (2, 3)}", ISO_ERR_IO, "2 points"},
        {1, "{'descr': '<f4', 'fortran_order': True, 'shape': (99999999999999999, 3)}", ISO_ERR_IO,
         "truncated"},
        {1, "{'descr': '<f2', 'fortran_order': False, 'shape': (2, 3)}", ISO_ERR_UNSUPPORTED, "'<f2'"},
        {1, "{'descr': [('x', '<f4')], 'fortran_order': False, 'shape': (2, 3)}", ISO_ERR_UNSUPPORTED,
         "[('x'"},
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        made_file file = make_npy(bad[i].version, bad[i].dictionary);
        refuse_made(FILE_NPY, &file, bad[i].status, bad[i].reason);
    }
    refuse_text(FILE_NPY, "\x93NUMPY", ISO_ERR_IO, "truncated");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_pcd_ascii),      cmocka_unit_test(test_pcd_binary),
        cmocka_unit_test(test_pcd_compressed), cmocka_unit_test(test_pcd_types),
        cmocka_unit_test(test_pcd_errors),     cmocka_unit_test(test_las_formats),
        cmocka_unit_test(test_las_errors),     cmocka_unit_test(test_npy_orders),
        cmocka_unit_test(test_npy_errors),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
