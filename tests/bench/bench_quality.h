/* bench_quality: ./run bench quality, how near the methods come to the truth. */
#ifndef ISO_TESTS_BENCH_QUALITY_H
#define ISO_TESTS_BENCH_QUALITY_H

#include "compare/metrics.h"
#include "scene/method.h"

enum { QUALITY_NAME = 64 };

/* One picture of a method, and how far it is from the truth. */
typedef struct quality_row {
    char volume[QUALITY_NAME];
    int zoom;
    const iso_renderer *method;
    double pixels_per_voxel, seconds;
    iso_metrics metrics;
} quality_row;

/* Whether a volume is one of the seven over which the studies of the project take means. */
bool quality_is_in_study(const char *volume);

/* bench_quality_asked.c: prints what the project asks for and these rows do not reach, and how many of what
 * is asked they do reach. */
void quality_print_asked(const quality_row *rows, int count);

/* The whole program, from the command line behind the name `quality`; the exit status. */
int bench_quality(int argc, char **argv);

#endif
