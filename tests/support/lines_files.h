/* lines_files: writes lines as .tck and .trk files, for tests of their readers. The writers share nothing
 * with the readers. Lines are in LPS, as in memory. */
#ifndef ISO_TESTS_LINES_FILES_H
#define ISO_TESTS_LINES_FILES_H

#include <stdbool.h>

#include "base/lines.h"

/* Lines of 1 to 9 random vertices in [-100, 100) mm, rounded to 1/1024 mm. iso_lines_free. */
iso_lines random_lines(int count, uint32_t seed);

/* Fails the test unless both sets have the same lines, with vertices that differ by at most `tolerance` mm.
 */
void check_same_lines(const iso_lines *got, const iso_lines *wanted, double tolerance);

/* `value`: bytes of a number, 4 or 8. */
void write_tck(const char *path, const iso_lines *lines, int value, bool big);

typedef struct trk_layout {
    int version;
    bool big;
    int dims[3];
    double matrix[12];       /* from voxel centres to RAS, rows of a 3 x 4 matrix */
    const char *order;       /* "LPS", .. */
    int scalars, properties; /* named s0, s1, .. and p0, p1, ..; see trk_scalar */
} trk_layout;

void write_trk(const char *path, const iso_lines *lines, const trk_layout *layout);

/* Scalar s of vertex i, and property p of line i. */
float trk_scalar(int s, size_t i);
float trk_property(int p, size_t i);

#endif
