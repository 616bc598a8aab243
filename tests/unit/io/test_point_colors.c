/* point_colors: colours of points in PLY, out and in, and places that floats would round. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "check_support.h"
#include "io/glyphs/glyphs_read.h"
#include "io/points_write.h"
#include "points_support.h"

#define FILE_PLY ISO_TEST_TMP "/test_point_colors.ply"

static void read_text(const char *text, test_points *points) {
    FILE *file = fopen(FILE_PLY, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(text, 1, strlen(text), file), strlen(text));
    fclose(file);
    iso_error error = {0};
    test_ok(test_points_read(FILE_PLY, 0, points, &error), &error);
}

static void colors_come_back(void **state) {
    (void)state;
    enum { COUNT = 50 };
    iso_surfel surfels[COUNT];
    uint8_t colors[COUNT][3];
    for (int i = 0; i < COUNT; i++) {
        surfels[i] = (iso_surfel){{(float)i, (float)(i * i), 0.25f}, {0, 0.6f, 0.8f}};
        for (int k = 0; k < 3; k++) colors[i][k] = (uint8_t)(i * (k + 3));
    }
    const iso_point_span span = {.count = COUNT};
    const iso_point_view view = {.surfels = surfels,
                                 .colors = (const uint8_t(*)[3])colors,
                                 .spans = &span,
                                 .span_count = 1,
                                 .transform = iso_transform_identity(),
                                 .radius = 2};
    iso_error error = {0};
    test_points points;
    test_ok(iso_points_write_ply(FILE_PLY, &view, NULL, &error), &error);
    test_ok(test_points_read(FILE_PLY, 0, &points, &error), &error);
    assert_int_equal(points.span.count, COUNT);
    assert_memory_equal(points.surfels, surfels, sizeof surfels);
    assert_memory_equal(points.colors, colors, sizeof colors);
    assert_ptr_equal(test_points_view(&points).colors, points.colors);
    test_points_free(&points);
    assert_null(points.colors);
    /* the limit counts them */
    size_t needed = COUNT * (sizeof(iso_surfel) + sizeof(float) + 3 * sizeof(float));
    assert_int_equal(test_points_read(FILE_PLY, needed - 1, &points, &error), ISO_ERR_LIMIT);
}

#define VERTICES                                                                                             \
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"        \
    "property float nx\nproperty float ny\nproperty float nz\nproperty float radius\n"
#define POINT "1 2 3 0 0 1 0.5 "
#define NO_POINT "nan 2 3 0 0 1 0.5 "

/* Any types, any order, dropped points between; fractions are of 255; two of three are none. */
static void colors_of_other_programs(void **state) {
    (void)state;
    test_points points;
    read_text(VERTICES "property int blue\nproperty uchar red\nproperty double green\nend_header\n" POINT
                       "7 255 0.5\n" NO_POINT "9 9 9\n" POINT "-4 300 2\n",
              &points);
    const uint8_t wanted[2][3] = {{255, 128, 7}, {255, 255, 0}};
    assert_int_equal(points.span.count, 2);
    assert_memory_equal(points.colors, wanted, sizeof wanted);
    test_points_free(&points);
    read_text(VERTICES "property uchar red\nproperty uchar blue\nend_header\n" POINT "1 2\n" POINT
                       "3 4\n" POINT "5 6\n",
              &points);
    assert_null(points.colors);
    assert_null(test_points_view(&points).colors);
    test_points_free(&points);
}

/* Far from 0 in relation to their box, coordinates are written as doubles, and come back to a float's
 * precision of the box; near 0 they are floats. */
static void places_far_from_0_are_doubles(void **state) {
    (void)state;
    enum { COUNT = 200, SIZE = 40 };
    iso_surfel surfels[COUNT];
    uint32_t seed = 5;
    for (int i = 0; i < COUNT; i++) {
        surfels[i] = (iso_surfel){{0, 0, 0}, {0, 0.6f, 0.8f}};
        for (int k = 0; k < 3; k++) surfels[i].position[k] = (float)(SIZE * uniform(&seed));
    }
    const iso_point_span span = {.count = COUNT};
    iso_point_view view = {.surfels = surfels,
                           .spans = &span,
                           .span_count = 1,
                           .transform = iso_transform_identity(),
                           .radius = 1};
    iso_error error = {0};
    for (int far = 0; far < 2; far++) {
        iso_glyphs glyphs;
        char head[400] = "";
        view.transform.origin[1] = far ? 5403850.25 : 2 * SIZE;
        test_ok(iso_points_write_ply(FILE_PLY, &view, NULL, &error), &error);
        FILE *file = fopen(FILE_PLY, "rb");
        assert_non_null(file);
        assert_true(fread(head, 1, sizeof head - 1, file) > 300);
        fclose(file);
        assert_int_equal(strstr(head, "property double y\n") != NULL, far);
        assert_non_null(strstr(head, "property float nx\n"));
        test_ok(iso_glyphs_read(FILE_PLY, NULL, &glyphs, &error), &error);
        assert_int_equal(glyphs.count, COUNT);
        for (size_t i = 0; i < COUNT; i++)
            assert_true(fabs(iso_glyph_position(&glyphs, i).y - view.transform.origin[1] -
                             (double)surfels[i].position[1]) < 1e-6 * SIZE * (far ? 1 : 4));
        iso_glyphs_free(&glyphs);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(colors_come_back),
        cmocka_unit_test(colors_of_other_programs),
        cmocka_unit_test(places_far_from_0_are_doubles),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
