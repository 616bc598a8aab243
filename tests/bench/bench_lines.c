/* What reading lines costs: files of a million segments against copying them; and a file of tracts to a
 * picture, isorender against a program that does it with VTK. */
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "bench_harness.h"
#include "io/lines/lines_read.h"

enum { VERTICES = 101, COPY_BLOCK = 1 << 17 }; /* vertices of a line */

/* A format: its header, and what comes before and after the vertices of a line. */
typedef struct lines_plan {
    bool trk;
    int lines;
} lines_plan;

typedef struct lines_file {
    char path[512], copy[520], picture[520];
} lines_file;

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

static void put_lines(FILE *file, const lines_plan *plan) {
    const int32_t count = VERTICES;
    for (int line = 0; line < plan->lines; line++) {
        if (plan->trk) put(file, &count, sizeof count);
        for (int i = 0; i < VERTICES; i++) {
            const float vertex[3] = {(float)i, (float)(line % 100), (float)line / 100};
            put(file, vertex, sizeof vertex);
        }
        if (!plan->trk) put_triple(file, (float)NAN);
    }
    if (!plan->trk) put_triple(file, (float)INFINITY);
}

static iso_status open_lines(bench_row *row, iso_error *error) {
    const lines_plan *plan = row->plan;
    const char *folder = getenv("TMPDIR");
    lines_file *written = calloc(1, sizeof *written);
    row->context = written;
    if (!written || !plan) return iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    const int begin = snprintf(written->path, sizeof written->path, "%.300s/", folder ? folder : "/tmp");
    snprintf(written->path + begin, sizeof written->path - (size_t)begin, "isopoint-bench-%ld-%s.%s",
             (long)getpid(), row->name, plan->trk ? "trk" : "tck");
    for (char *at = written->path + begin; *at; at++)
        if (*at == '/') *at = '-';
    snprintf(written->copy, sizeof written->copy, "%s.copy", written->path);
    snprintf(written->picture, sizeof written->picture, "%s.png", written->path);
    FILE *file = fopen(written->path, "wb");
    if (!file) return iso_fail(error, ISO_ERR_WRITE, "%s: cannot write", written->path);
    if (plan->trk)
        put_trk_header(file, plan->lines);
    else
        fprintf(file, "mrtrix tracks\ndatatype: Float32LE\nfile: . 100\nEND\n%50s", "");
    if (!plan->trk) fseek(file, 100, SEEK_SET);
    put_lines(file, plan);
    return fclose(file) == 0 ? ISO_OK : iso_fail(error, ISO_ERR_WRITE, "%s: cannot write", written->path);
}

static void close_lines(bench_row *row) {
    const lines_file *written = row->context;
    if (!written) return;
    unlink(written->path);
    unlink(written->copy);
    unlink(written->picture);
    free(row->context);
}

static iso_status run_read(bench_row *row, bench_sample *sample, iso_error *error) {
    const lines_file *written = row->context;
    iso_lines lines;
    const bench_clock clock = bench_clock_start();
    ISO_TRY(iso_lines_read(written->path, NULL, &lines, error));
    bench_clock_stop(&clock, sample);
    sample->primitives = iso_lines_segment_count(&lines);
    iso_lines_free(&lines);
    return ISO_OK;
}

static bool copy_bytes(int from, int to) {
    static char block[COPY_BLOCK];
    for (;;) {
        const ssize_t got = read(from, block, sizeof block);
        if (got <= 0) return got == 0;
        if (write(to, block, (size_t)got) != got) return false;
    }
}

static iso_status run_copy(bench_row *row, bench_sample *sample, iso_error *error) {
    const lines_file *written = row->context;
    const bench_clock clock = bench_clock_start();
    const int from = open(written->path, O_RDONLY),
              to = open(written->copy, O_WRONLY | O_CREAT | O_TRUNC, 0644);
    const bool copied = from >= 0 && to >= 0 && copy_bytes(from, to);
    if (from >= 0) close(from);
    if (to >= 0) close(to);
    bench_clock_stop(&clock, sample);
    sample->primitives = 0;
    return copied ? ISO_OK : iso_fail(error, ISO_ERR_WRITE, "%s: cannot copy", written->path);
}

/* ---- from a file of tracts to a picture: tubes of .1 mm */

static const char *picture_side(const bench_row *row) {
    return row->bench->settings->small ? "64" : "1024";
}

static iso_status run_vtk_tracts(bench_row *row, bench_sample *sample, iso_error *error) {
    const lines_file *file = row->context;
    char program[1100];
    const char *display;
    ISO_TRY(bench_sibling("vtk_frame", program, sizeof program, error));
    ISO_TRY(bench_display_open(&row->bench->display, &display, error));
    const char *const argv[] = {program, "tracts", file->path, file->picture, "0.1", picture_side(row), NULL};
    return bench_time_program(argv, row->threads, display, sample, error);
}

static iso_status run_isorender_tracts(bench_row *row, bench_sample *sample, iso_error *error) {
    const lines_file *file = row->context;
    char program[1100], resolution[16];
    ISO_TRY(bench_sibling("isorender", program, sizeof program, error));
    snprintf(resolution, sizeof resolution, "%sx%s", picture_side(row), picture_side(row));
    const char *const argv[] = {program,        file->path, file->picture, "--tube-radius", "0.1",
                                "--resolution", resolution, "--camera",    "iso",           "--quiet",
                                "--threads",    "1",        NULL};
    return bench_time_program(argv, row->threads, NULL, sample, error);
}

static const bench_kind read_kind = {.open = open_lines, .run = run_read, .close = close_lines},
                        copy_kind = {.open = open_lines, .run = run_copy, .close = close_lines},
                        vtk_tracts_kind = {.open = open_lines,
                                           .run = run_vtk_tracts,
                                           .close = close_lines,
                                           .batch = 1},
                        isorender_tracts_kind = {.open = open_lines,
                                                 .run = run_isorender_tracts,
                                                 .close = close_lines,
                                                 .batch = 1};

static bench_row *add_row(bench_state *bench, const bench_kind *kind, const char *what, bool trk, int lines) {
    const bool reads = kind == &read_kind || kind == &copy_kind;
    bench_row *row = bench_add(bench, kind, "%s/%s/%dk/%s", reads ? "read" : "process", trk ? "trk" : "tck",
                               lines * (VERTICES - 1) / 1000, what);
    lines_plan *plan = calloc(1, sizeof *plan);
    if (plan) *plan = (lines_plan){trk, lines};
    row->plan = plan;
    row->threads = 1;
    return row;
}

iso_status bench_lines_group(bench_state *bench, iso_error *error) {
    const bool small = bench->settings->small;
    for (int trk = 0; trk < 2; trk++) {
        bench_row *copy = add_row(bench, &copy_kind, "copy", trk, small ? 100 : 10000);
        bench_row *read = add_row(bench, &read_kind, "lines", trk, small ? 100 : 10000);
        bench_compare(read, copy, "ratio_vs_copy", "ratio_vs_copy_pairwise", small ? 0 : 0.25);
    }
    return bench_run_group(bench, "files of lines: reading them, and copying them", error);
}

iso_status bench_tracts_group(bench_state *bench, iso_error *error) {
    const bool small = bench->settings->small;
    bench_row *vtk = add_row(bench, &vtk_tracts_kind, "vtk_tubes", false, small ? 100 : 10000);
    bench_row *ours = add_row(bench, &isorender_tracts_kind, "isorender", false, small ? 100 : 10000);
    bench_against *against =
        bench_compare(ours, vtk, "ratio_vs_vtk_process", "ratio_vs_vtk_process_pairwise", small ? 0 : 10);
    if (against) against->cpu = "cpu_ratio_vs_vtk_process";
    return bench_run_group(bench, "a .tck file to a .png, whole processes", error);
}
