/* What reading lines costs: files of a million segments against copying them; and a file of tracts to a
 * picture, isorender against a program that does it with VTK. */
#include <math.h>
#include <string.h>

#include "bench_files.h"
#include "io/lines/lines_read.h"

enum { VERTICES = 101 }; /* of a line */

static void put(FILE *file, const void *bytes, size_t size) {
    fwrite(bytes, 1, size, file); /* errors are found when the file is closed */
}

/* A header of 1000 bytes: voxels of 1 mm in RAS (src/io/lines/trk.c has the places). */
static void put_trk_header(FILE *file, int lines) {
    static const float size[3] = {1, 1, 1}, matrix[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    const int32_t numbers[3] = {lines, 2, 1000};
    unsigned char header[1000] = "TRACK";
    memcpy(header + 12, size, sizeof size);
    memcpy(header + 440, matrix, sizeof matrix);
    memcpy(header + 948, "RAS", 3);
    memcpy(header + 988, numbers, sizeof numbers);
    put(file, header, sizeof header);
}

static void put_triple(FILE *file, float value) {
    const float triple[3] = {value, value, value};
    put(file, triple, sizeof triple);
}

static void put_line(FILE *file, int line) {
    for (int i = 0; i < VERTICES; i++) {
        const float vertex[3] = {(float)i, (float)(line % 100), (float)line / 100};
        put(file, vertex, sizeof vertex);
    }
}

static void put_trk(FILE *file, int lines) {
    const int32_t count = VERTICES;
    put_trk_header(file, lines);
    for (int line = 0; line < lines; line++) {
        put(file, &count, sizeof count);
        put_line(file, line);
    }
}

static void put_tck(FILE *file, int lines) {
    fprintf(file, "mrtrix tracks\ndatatype: Float32LE\nfile: . 100\nEND\n%50s", "");
    fseek(file, 100, SEEK_SET);
    for (int line = 0; line < lines; line++) {
        put_line(file, line);
        put_triple(file, (float)NAN);
    }
    put_triple(file, (float)INFINITY);
}

static iso_status read_lines(const char *path, size_t *primitives, iso_error *error) {
    iso_lines lines;
    ISO_TRY(iso_lines_read(path, NULL, &lines, error));
    *primitives = iso_lines_segment_count(&lines);
    iso_lines_free(&lines);
    return ISO_OK;
}

static const bench_file_plan formats[2] = {{.ending = "tck", .put = put_tck, .read = read_lines},
                                           {.ending = "trk", .put = put_trk, .read = read_lines}};

/* ---- from a file of tracts to a picture: tubes of .1 mm */

static iso_status run_vtk_tracts(bench_row *row, bench_sample *sample, iso_error *error) {
    return bench_file_run_vtk(row, "tracts", "0.1", sample, error);
}

static iso_status run_isorender_tracts(bench_row *row, bench_sample *sample, iso_error *error) {
    const bench_file *file = row->context;
    char program[1100], resolution[16];
    ISO_TRY(bench_sibling("isorender", program, sizeof program, error));
    snprintf(resolution, sizeof resolution, "%sx%s", bench_file_picture_side(row),
             bench_file_picture_side(row));
    const char *const argv[] = {
        program,     file->path, file->picture, "--tube-radius", "0.1",       "--resolution",
        resolution,  "--camera", "iso",         "--quiet",       "--threads", "1",
        "--samples", "1",        NULL};
    return bench_time_program(argv, row->threads, NULL, sample, error);
}

static const bench_kind vtk_tracts_kind = {.open = bench_file_open,
                                           .run = run_vtk_tracts,
                                           .close = bench_file_close,
                                           .batch = 1},
                        isorender_tracts_kind = {.open = bench_file_open,
                                                 .run = run_isorender_tracts,
                                                 .close = bench_file_close,
                                                 .batch = 1};

static bench_row *add_row(bench_state *bench, const bench_kind *kind, const char *what, bool trk) {
    const bool reads = kind == &bench_file_read_kind || kind == &bench_file_copy_kind;
    bench_file_plan plan = formats[trk];
    char name[64];
    plan.count = bench->settings->small ? 100 : 10000;
    snprintf(name, sizeof name, "%s/%s/%dk/%s", reads ? "read" : "process", plan.ending,
             plan.count * (VERTICES - 1) / 1000, what);
    return bench_file_add(bench, kind, &plan, name);
}

iso_status bench_lines_group(bench_state *bench, iso_error *error) {
    const bool small = bench->settings->small;
    for (int trk = 0; trk < 2; trk++) {
        bench_row *copy = add_row(bench, &bench_file_copy_kind, "copy", trk);
        bench_row *read = add_row(bench, &bench_file_read_kind, "lines", trk);
        bench_compare(read, copy, "ratio_vs_copy", "ratio_vs_copy_pairwise", small ? 0 : 0.25);
    }
    return bench_run_group(bench, "files of lines: reading them, and copying them", error);
}

iso_status bench_tracts_group(bench_state *bench, iso_error *error) {
    const bool small = bench->settings->small;
    bench_row *vtk = add_row(bench, &vtk_tracts_kind, "vtk_tubes", false);
    bench_row *ours = add_row(bench, &isorender_tracts_kind, "isorender", false);
    bench_against *against =
        bench_compare(ours, vtk, "ratio_vs_vtk_process", "ratio_vs_vtk_process_pairwise", small ? 0 : 10);
    if (against) against->cpu = "cpu_ratio_vs_vtk_process";
    return bench_run_group(bench, "a .tck file to a .png, whole processes", error);
}
