/* points_support: points read from a file as arrays in the file's order, for tests of files of points. */
#ifndef ISO_TESTS_POINTS_SUPPORT_H
#define ISO_TESTS_POINTS_SUPPORT_H

#include "base/primitives.h"
#include "base/status.h"

/* World millimetres; zero-initialise, test_points_free. */
typedef struct test_points {
    iso_surfel *surfels; /* normals 0: the file has none */
    float *radii;        /* NULL: the file has none; likewise colours */
    uint8_t (*colors)[3];
    iso_point_span span;
} test_points;

/* Reads points with iso_glyphs_read, whose errors it returns; ISO_ERR_EMPTY: there are none. limit: bytes of
 * memory; 0: no limit. */
iso_status test_points_read(const char *path, uint64_t limit, test_points *points, iso_error *error);
void test_points_free(test_points *points);
/* A view of the points, which it borrows. */
iso_point_view test_points_view(const test_points *points);

#endif
