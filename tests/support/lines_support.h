/* lines_support: lines that tests put together vertex by vertex. */
#ifndef ISO_TESTS_LINES_SUPPORT_H
#define ISO_TESTS_LINES_SUPPORT_H

#include "base/lines.h"

enum { TEST_LINES_VERTICES = 4000, TEST_LINES_MOST = 600 };

/* Lines in arrays of fixed size. `lines` has radii and starts; tests may add the colours or leave out the
 * radii. */
typedef struct test_lines {
    iso_lines lines;
    float vertices[TEST_LINES_VERTICES][3], radii[TEST_LINES_VERTICES];
    uint8_t colors[TEST_LINES_VERTICES][3];
    size_t starts[TEST_LINES_MOST + 1];
} test_lines;

/* Empties the set and gives it an origin. */
void test_lines_start(test_lines *set, double x, double y, double z);

/* Adds a vertex to the last line. */
void test_lines_add(test_lines *set, double x, double y, double z, double radius);

void test_lines_end(test_lines *set);

/* Adds a random walk of `count` steps from a point of the box +-half, with radii between low and high. */
void test_lines_add_walk(test_lines *set, int count, double half, double step, double low, double high,
                         uint32_t *seed);

#endif
