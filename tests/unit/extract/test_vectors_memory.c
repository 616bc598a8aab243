/* Glyphs and streamlines of vector volumes that run out of memory say so and leak nothing: calls for memory
 * are refused from a chosen one on (the linker's --wrap). */
#include <stdio.h>
#include <string.h>

#include "check_support.h"
#include "extract/points/points.h"
#include "extract/vectors/gradient_glyphs.h"
#include "extract/vectors/streamlines.h"
#include "extract/vectors/vector_glyphs.h"
#include "file_support.h"
#include "grids/volume/vectors_read.h"
#include "refused_memory.h"

#define FILE_VECTORS ISO_TEST_TMP "/test_vectors_memory.mha"

/* A volume of 4 x 4 x 4 voxels whose bytes grow: vectors or tensors. */
static void write_file(int channels) {
    char text[512 + 4 * 4 * 4 * 9];
    int length = snprintf(text, 512,
                          "ObjectType = Image\nNDims = 3\nDimSize = 4 4 4\nElementNumberOfChannels = %d\n"
                          "ElementType = MET_UCHAR\nElementDataFile = LOCAL\n",
                          channels);
    for (int i = 0; i < 64 * channels; i++)
        text[length++] = (char)(i % channels == 0 || i % channels > 2 ? 90 : 5);
    spill(FILE_VECTORS, text, (size_t)length);
}

static iso_vectors read_file(int channels) {
    iso_vectors v;
    iso_vectors_info info;
    iso_error error = {0};
    write_file(channels);
    test_ok(iso_vectors_read(FILE_VECTORS, NULL, &v, &info, &error), &error);
    return v;
}

static iso_status read_vectors(const void *data, iso_error *error) {
    (void)data;
    iso_vectors v = {0};
    iso_vectors_info info;
    const iso_status status = iso_vectors_read(FILE_VECTORS, NULL, &v, &info, error);
    if (status == ISO_OK) iso_vectors_free(&v);
    return status;
}

static void test_reading(void **state) {
    (void)state;
    for (int channels = 3; channels <= 9; channels += 3) {
        write_file(channels);
        assert_true(test_refuse_each(read_vectors, NULL, NULL) >= 2 + channels);
    }
}

static iso_status make_glyphs(const void *data, iso_error *error) {
    iso_glyphs glyphs;
    iso_vector_glyphs_totals totals;
    const iso_status status =
        iso_vector_glyphs(data, &(iso_vector_glyphs_opts){.every = 0}, &glyphs, &totals, error);
    if (status == ISO_OK) iso_glyphs_free(&glyphs);
    return status;
}

static iso_status make_lines(const void *data, iso_error *error) {
    iso_lines lines;
    iso_streamlines_totals totals;
    const iso_status status =
        iso_streamlines(data, &(iso_streamlines_opts){.count = 9}, &lines, &totals, error);
    if (status == ISO_OK) iso_lines_free(&lines);
    return status;
}

static void test_fields(void **state) {
    (void)state;
    iso_vectors vectors = read_file(3), tensors = read_file(6);
    assert_true(test_refuse_each(make_glyphs, &vectors, NULL) >= 6);
    assert_true(test_refuse_each(make_glyphs, &tensors, NULL) >= 8);
    assert_true(test_refuse_each(make_lines, &vectors, NULL) >= 6);
    iso_vectors_free(&vectors);
    iso_vectors_free(&tensors);
}

static iso_status make_gradients(const void *data, iso_error *error) {
    iso_glyphs glyphs;
    iso_gradient_glyphs_totals totals;
    const iso_status status =
        iso_gradient_glyphs(data, 2, &(iso_gradient_glyphs_opts){.every = 0}, &glyphs, &totals, error);
    if (status == ISO_OK) iso_glyphs_free(&glyphs);
    return status;
}

static void test_gradients(void **state) {
    (void)state;
    iso_error error = {0};
    float values[8 * 8 * 8];
    for (int i = 0; i < 512; i++) values[i] = (float)(i % 8);
    iso_grid grid = {0};
    iso_point_set *points;
    test_ok(iso_rgrid_create(&(iso_rgrid_desc){.dims = {8, 8, 8}, .type = ISO_FLOAT32, .data = values},
                             &grid.rgrid, &error),
            &error);
    test_ok(iso_point_set_create(&grid, &(iso_points_opts){.isovalue = 3.5}, &points, &error), &error);
    test_ok(iso_point_set_update(points, &error), &error);
    const iso_gradient_source source = {&grid, iso_point_set_view(points)};
    const iso_gradient_source sources[2] = {source, source};
    assert_true(test_refuse_each(make_gradients, sources, NULL) >= 10);
    iso_point_set_destroy(points);
    iso_grid_destroy(&grid);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_reading), cmocka_unit_test(test_fields),
                                       cmocka_unit_test(test_gradients)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
