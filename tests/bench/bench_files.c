/* bench_files: files that the bench writes, reads and copies. */
#include "bench_files.h"

#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { COPY_BLOCK = 1 << 17 };

iso_status bench_file_open(bench_row *row, iso_error *error) {
    const bench_file_plan *plan = row->plan;
    const char *folder = getenv("TMPDIR");
    bench_file *written = calloc(1, sizeof *written);
    row->context = written;
    if (!written || !plan) return iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    const int begin = snprintf(written->path, sizeof written->path, "%.300s/", folder ? folder : "/tmp");
    snprintf(written->path + begin, sizeof written->path - (size_t)begin, "isopoint-bench-%ld-%s.%s",
             (long)getpid(), row->name, plan->ending);
    for (char *at = written->path + begin; *at; at++)
        if (*at == '/') *at = '-';
    snprintf(written->copy, sizeof written->copy, "%s.copy", written->path);
    snprintf(written->picture, sizeof written->picture, "%s.png", written->path);
    FILE *file = fopen(written->path, "wb");
    if (!file) return iso_fail(error, ISO_ERR_WRITE, "%s: cannot write", written->path);
    plan->put(file, plan->count);
    return fclose(file) == 0 ? ISO_OK : iso_fail(error, ISO_ERR_WRITE, "%s: cannot write", written->path);
}

void bench_file_close(bench_row *row) {
    const bench_file *written = row->context;
    if (!written) return;
    unlink(written->path);
    unlink(written->copy);
    unlink(written->picture);
    free(row->context);
}

static iso_status run_read(bench_row *row, bench_sample *sample, iso_error *error) {
    const bench_file *written = row->context;
    const bench_file_plan *plan = row->plan;
    const bench_clock clock = bench_clock_start();
    ISO_TRY(plan->read(written->path, &sample->primitives, error));
    bench_clock_stop(&clock, sample);
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
    const bench_file *written = row->context;
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

const bench_kind bench_file_read_kind = {.open = bench_file_open, .run = run_read, .close = bench_file_close},
                 bench_file_copy_kind = {.open = bench_file_open, .run = run_copy, .close = bench_file_close};

bench_row *bench_file_add(bench_state *bench, const bench_kind *kind, const bench_file_plan *plan,
                          const char *name) {
    bench_row *row = bench_add(bench, kind, "%s", name);
    bench_file_plan *copy = calloc(1, sizeof *copy);
    if (copy) *copy = *plan;
    row->plan = copy;
    row->threads = 1;
    return row;
}

const char *bench_file_picture_side(const bench_row *row) {
    return row->bench->settings->small ? "64" : "1024";
}

iso_status bench_file_run_vtk(bench_row *row, const char *mode, const char *radius, bench_sample *sample,
                              iso_error *error) {
    const bench_file *file = row->context;
    char program[1100];
    const char *display;
    ISO_TRY(bench_sibling("vtk_frame", program, sizeof program, error));
    ISO_TRY(bench_display_open(&row->bench->display, &display, error));
    const char *const argv[] = {
        program, mode, file->path, file->picture, radius, bench_file_picture_side(row), NULL};
    return bench_time_program(argv, row->threads, display, sample, error);
}
