/* lines_files: writes lines as .tck, .trk and legacy .vtk files, for tests of their readers. The writers
 * share nothing with the readers. Lines are in LPS, as in memory. */
#ifndef ISO_TESTS_LINES_FILES_H
#define ISO_TESTS_LINES_FILES_H

#include <stdbool.h>

#include "io/lines/lines_read.h"

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

typedef struct vtk_layout {
    int version; /* 1 to 5; 5 has offsets of 64 bits */
    bool binary, doubles;
    bool arrays; /* see write_vtk */
} vtk_layout;

/* Points are in reverse order, and lines name them. With arrays: points have SCALARS s0 (short), FIELD
 * arrays s1 (double) and "radius" (float, equal to s0), VECTORS "v" (float: s0, s1, s2) and COLOR_SCALARS
 * "c" (s0 modulo 256, 7, 255), and lines the FIELD array p0. A vertex cell and a polygon come before and
 * after the lines, and have numbers in p0 too. */
void write_vtk(const char *path, const iso_lines *lines, const vtk_layout *layout);

/* Scalar s of vertex i, and property p of line i. */
float trk_scalar(int s, size_t i);
float trk_property(int p, size_t i);

/* Reads lines; fails the test on errors. */
iso_lines read_lines(const char *path, const iso_read_opts *opts);

/* Expects an error whose text names the file and contains `reason`. */
void refuse_lines(const char *path, const iso_read_opts *opts, iso_status wanted, const char *reason);

/* What reading a file of ../shared/lines must give: an error whose text has `reason`, or so many lines,
 * vertices and segments (-1: not compared), and as many things left out, mended and noted. */
typedef struct lines_outcome {
    const char *name; /* in ../shared/lines */
    iso_status status;
    const char *reason;
    int lines, vertices, segments;
    int dropped, mended, notes;
} lines_outcome;

/* Skips the test where there are no such files. */
void check_lines_outcomes(const lines_outcome *outcomes, size_t count);

/* Cuts a file off at every byte but the last `tail` ones, in a file `cut`: reading it must fail, so that no
 * part of it is taken for the whole. */
void check_every_cut(const char *path, const char *cut, size_t tail);

/* The box in the file's own coordinates. */
iso_box own_box(const iso_lines *lines, iso_space space);

#endif
