/* bench_files: rows about files that the bench writes: reading one, copying it with nothing but read and
 * write, and what programs make of it. */
#ifndef ISO_TESTS_BENCH_FILES_H
#define ISO_TESTS_BENCH_FILES_H

#include <stdio.h>

#include "bench_harness.h"

/* What a row writes and reads. Copied into bench_row.plan. */
typedef struct bench_file_plan {
    const char *ending;                 /* of the file's name, without the dot */
    int count;                          /* passed to put */
    void (*put)(FILE *file, int count); /* write errors are found when the file is closed */
    /* Reads the file; sets *primitives to the number of items in it. */
    iso_status (*read)(const char *path, size_t *primitives, iso_error *error);
} bench_file_plan;

/* row->context of all rows here. */
typedef struct bench_file {
    char path[512], copy[520], picture[520];
} bench_file;

/* Writes the file of the row's plan into TMPDIR; removes it with what was made of it. */
iso_status bench_file_open(bench_row *row, iso_error *error);
void bench_file_close(bench_row *row);

extern const bench_kind bench_file_read_kind, bench_file_copy_kind;

/* A row of one thread with a copy of the plan; the name is that of bench_add. */
bench_row *bench_file_add(bench_state *bench, const bench_kind *kind, const bench_file_plan *plan,
                          const char *name);
/* The side of the pictures that programs make: text for their arguments. */
const char *bench_file_picture_side(const bench_row *row);
/* Runs vtk_frame, with the display that the bench starts, as `mode FILE PICTURE RADIUS SIDE`. */
iso_status bench_file_run_vtk(bench_row *row, const char *mode, const char *radius, bench_sample *sample,
                              iso_error *error);

#endif
