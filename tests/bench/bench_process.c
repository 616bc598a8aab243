/* The rows whose work is done in a process of its own: how much memory a first extraction takes, and how long
 * it is from a file to points, and to a picture. Ours is bench_alone or isorender, which the peers' libraries
 * are not linked to. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

#include "base/file.h"
#include "base/primitives.h"
#include "bench_harness.h"
#include "bench_peers.h"
#include "bench_scenes.h"

static int ct_size(const bench_settings *settings) {
    return settings->small ? 48 : 512;
}

/* Runs a program beside this one and reads the first line that it prints. */
static iso_status run_process(const char *name, const char *arguments, char *line, int size,
                              iso_error *error) {
    char self[1024], command[2200];
    ssize_t length = readlink("/proc/self/exe", self, sizeof self - 1);
    if (length < 0 || memchr(self, '\'', (size_t)length))
        return iso_fail(error, ISO_ERR_UNSUPPORTED, "cannot start another process");
    self[length] = 0;
    *strrchr(self, '/') = 0;
    snprintf(command, sizeof command, "exec '%s/%s' %s", self, name, arguments);
    FILE *child = popen(command, "r");
    if (!child) return iso_fail(error, ISO_ERR_UNSUPPORTED, "cannot start another process");
    bool said = fgets(line, size, child) != NULL;
    if (pclose(child) != 0 || !said)
        return iso_fail(error, ISO_ERR_UNSUPPORTED, "the process that was to be measured failed");
    return ISO_OK;
}

/* ---- memory of a first extraction ---- */

typedef struct child_report {
    double peak, before;
} child_report;

static iso_status open_memory(bench_row *row, iso_error *error) {
    row->context = calloc(1, sizeof(child_report));
    return row->context ? ISO_OK : iso_fail(error, ISO_ERR_NOMEM, "out of memory");
}

static iso_status run_memory(bench_row *row, bench_sample *sample, iso_error *error) {
    child_report *report = row->context;
    char arguments[32], line[256];
    snprintf(arguments, sizeof arguments, "memory %d", ct_size(row->bench->settings));
    ISO_TRY(run_process("bench_alone", arguments, line, sizeof line, error));
    if (sscanf(line, "%lf %lf %lf %zu %lf", &sample->wall, &sample->cpu, &report->peak, &sample->primitives,
               &report->before) != 5)
        return iso_fail(error, ISO_ERR_UNSUPPORTED, "the process that measures memory said '%s'", line);
    return ISO_OK;
}

static void finish_memory(bench_row *row) {
    const child_report *report = row->context;
    double volume = (double)row->size * row->size * row->size;
    double primitives = (double)row->primitives * sizeof(iso_point);
    bench_count(row, "peak_bytes", report->peak, 0, 0);
    bench_count(row, "volume_bytes", volume, 0, 0);
    bench_count(row, "primitive_bytes", primitives, 0, 0);
    bench_count(row, "process_bytes", report->before - volume, 0, 0); /* program and libraries */
    bench_count(row, "extraction_bytes", report->peak - report->before - primitives, 0, 0);
    bench_count(row, "overhead_bytes", report->peak - volume - primitives, 0, 64.0 * 1024 * 1024);
}

static void close_context(bench_row *row) {
    free(row->context);
}

static const bench_kind memory_kind = {.open = open_memory,
                                       .run = run_memory,
                                       .finish = finish_memory,
                                       .close = close_context,
                                       .batch = 1,
                                       .rounds = 1};

/* ---- from a file to points ---- */

/* VTK's side: only the reading is timed, not the start of the process. It has a process of its own because a
 * second reading is much faster than the first, and whoever reads a file reads it once. */
int bench_vtk_child(const bench_settings *settings) {
    iso_error error = {0};
    bench_sample sample = {0};
    bench_clock clock = bench_clock_start();
    iso_status status = bench_vti_read(settings->vtk_child, &sample.primitives, &error);
    bench_clock_stop(&clock, &sample);
    if (status == ISO_OK) printf("%.17g %.17g %zu\n", sample.wall, sample.cpu, sample.primitives);
    if (status != ISO_OK) fprintf(stderr, "bench: %s\n", error.text);
    return iso_status_exit(status);
}

/* The volume as VTK's own writer puts it when asked for raw, uncompressed appended data. */
static iso_status write_vti(const iso_rgrid *grid, const char *path, iso_error *error) {
    iso_sink sink = {0};
    ISO_TRY(iso_sink_open(path, &sink, error));
    int last = grid->dims[0] - 1;
    uint64_t bytes = (uint64_t)grid->dims[0] * (uint64_t)grid->dims[1] * (uint64_t)grid->dims[2];
    fprintf(sink.stream,
            "<VTKFile type=\"ImageData\" version=\"1.0\" byte_order=\"LittleEndian\" "
            "header_type=\"UInt64\"><ImageData WholeExtent=\"0 %d 0 %d 0 %d\" Origin=\"0 0 0\" "
            "Spacing=\"1 1 1\"><Piece Extent=\"0 %d 0 %d 0 %d\"><PointData Scalars=\"v\"><DataArray "
            "type=\"UInt8\" Name=\"v\" format=\"appended\" offset=\"0\"/></PointData></Piece></ImageData>"
            "<AppendedData encoding=\"raw\">_",
            last, last, last, last, last, last);
    fwrite(&bytes, sizeof bytes, 1, sink.stream);
    fwrite(grid->data, 1, bytes, sink.stream);
    fputs("</AppendedData></VTKFile>", sink.stream);
    return iso_sink_commit(&sink, error);
}

typedef struct vti_file {
    char path[512], picture[520];
} vti_file;

/* Rows share the file: whoever opens first writes it, and each removes it when all are done. */
static iso_status open_file(bench_row *row, iso_error *error) {
    const iso_grid *grid = NULL;
    ISO_TRY(bench_row_grid(row, &grid, error));
    vti_file *file = calloc(1, sizeof *file);
    if (!file) return iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    row->context = file;
    const char *folder = getenv("TMPDIR");
    snprintf(file->path, sizeof file->path, "%.400s/isopoint-bench-%ld.vti", folder ? folder : "/tmp",
             (long)getpid());
    snprintf(file->picture, sizeof file->picture, "%.500s.png", file->path);
    if (access(file->path, R_OK) == 0) return ISO_OK;
    return write_vti(grid->rgrid, file->path, error);
}

static void close_file(bench_row *row) {
    const vti_file *file = row->context;
    if (file) remove(file->path);
    if (file) remove(file->picture);
    free(row->context);
}

static iso_status run_vti_to_points(bench_row *row, bench_sample *sample, iso_error *error) {
    const vti_file *file = row->context;
    char arguments[600], line[64];
    snprintf(arguments, sizeof arguments, "points '%s'", file->path);
    bench_clock clock = bench_clock_start();
    ISO_TRY(run_process("bench_alone", arguments, line, sizeof line, error));
    bench_clock_stop(&clock, sample);
    sample->primitives = strtoul(line, NULL, 10);
    return ISO_OK;
}

static iso_status run_vtk_read(bench_row *row, bench_sample *sample, iso_error *error) {
    const vti_file *file = row->context;
    char arguments[600], line[256];
    snprintf(arguments, sizeof arguments, "'--vtk-child=%s'", file->path);
    ISO_TRY(run_process("bench", arguments, line, sizeof line, error));
    if (sscanf(line, "%lf %lf %zu", &sample->wall, &sample->cpu, &sample->primitives) != 3)
        return iso_fail(error, ISO_ERR_UNSUPPORTED, "the process that reads with VTK said '%s'", line);
    return ISO_OK;
}

static void finish_vti_to_points(bench_row *row) {
    if (!row->against_count || !row->against[0].other->rounds) return;
    double read = bench_row_median(row->against[0].other);
    double most = row->bench->settings->small ? 0 : 2.5;
    bench_count(row, "time_vs_vtkXMLImageDataReader", bench_row_median(row) / read, 0, most);
}

static const bench_kind vti_to_points_kind = {.open = open_file,
                                              .run = run_vti_to_points,
                                              .finish = finish_vti_to_points,
                                              .close = close_file,
                                              .batch = 3};
static const bench_kind vtk_read_kind = {
    .open = open_file, .run = run_vtk_read, .close = close_file, .batch = 3};

/* ---- from a file to a picture ---- */

static double children_cpu(void) {
    struct rusage usage;
    getrusage(RUSAGE_CHILDREN, &usage);
    return 1e3 * (double)(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) +
           1e-3 * (double)(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
}

iso_status bench_time_program(const char *const *argv, int threads, const char *display, bench_sample *sample,
                              iso_error *error) {
    bench_child *child = NULL;
    double cpu = children_cpu();
    bench_clock clock = bench_clock_start();
    ISO_TRY(bench_child_start(argv, threads, display, &child, error));
    if (!bench_child_end(child)) return iso_fail(error, ISO_ERR_UNSUPPORTED, "%.120s failed", argv[0]);
    bench_clock_stop(&clock, sample);
    sample->cpu = children_cpu() - cpu;
    return ISO_OK;
}

static const char *picture_side(const bench_row *row) {
    return row->bench->settings->small ? "64" : "1024";
}

static iso_status run_vtk_picture(bench_row *row, bench_sample *sample, iso_error *error) {
    const vti_file *file = row->context;
    char program[1100], threads[16];
    const char *display;
    ISO_TRY(bench_sibling("vtk_frame", program, sizeof program, error));
    ISO_TRY(bench_display_open(&row->bench->display, &display, error));
    snprintf(threads, sizeof threads, "%d", row->threads);
    const char *const argv[] = {program, "picture",         file->path, file->picture,
                                "127.5", picture_side(row), threads,    NULL};
    return bench_time_program(argv, row->threads, display, sample, error);
}

/* The plan is the name of a method. */
static iso_status run_isorender(bench_row *row, bench_sample *sample, iso_error *error) {
    const vti_file *file = row->context;
    char program[1100], threads[16], resolution[16];
    ISO_TRY(bench_sibling("isorender", program, sizeof program, error));
    snprintf(threads, sizeof threads, "%d", row->threads);
    snprintf(resolution, sizeof resolution, "%sx%s", picture_side(row), picture_side(row));
    const char *const argv[] = {program,     file->path,     file->picture, "--isovalue", "127.5", "--method",
                                row->plan,   "--resolution", resolution,    "--camera",   "iso",   "--quiet",
                                "--threads", threads,        "--samples",   "1",          NULL};
    return bench_time_program(argv, row->threads, NULL, sample, error);
}

static const bench_kind vtk_picture_kind = {
    .open = open_file, .run = run_vtk_picture, .close = close_file, .batch = 1};
static const bench_kind isorender_kind = {
    .open = open_file, .run = run_isorender, .close = close_file, .batch = 1};

/* ---- groups ---- */

static iso_status run_memory_group(bench_state *bench, iso_error *error) {
    bench_row *row = bench_add(bench, &memory_kind, "extract/memory/uint8/%d", ct_size(bench->settings));
    row->size = ct_size(bench->settings);
    return bench_run_group(bench, "memory of a first extraction, in a process of its own", error);
}

static iso_status run_file_group(bench_state *bench, iso_error *error) {
    int size = ct_size(bench->settings);
    bench_row *read = bench_add(bench, &vtk_read_kind, "extract/vtkXMLImageDataReader/uint8/%d", size);
    bench_row *ours = bench_add(bench, &vti_to_points_kind, "extract/vti_to_points/uint8/%d", size);
    read->size = ours->size = size;
    bench_compare(ours, read, "ratio_vs_vtkXMLImageDataReader", NULL, 0);
    return bench_run_group(bench, "a .vti file to points, whole process; VTK only reads it", error);
}

iso_status bench_process_groups(bench_state *bench, iso_error *error) {
    ISO_TRY(run_memory_group(bench, error));
    return run_file_group(bench, error);
}

/* Methods of isorender, and how much faster than VTK's program they shall be. */
static const struct picture_method {
    const char *name;
    double least;
} picture_methods[] = {{"points", 0}, {"mesh", 0}, {"exact", 3}};

iso_status bench_picture_group(bench_state *bench, iso_error *error) {
    enum { METHODS = sizeof picture_methods / sizeof *picture_methods };
    const bench_settings *settings = bench->settings;
    int size = ct_size(settings);
    for (int t = 0; t < settings->thread_count; t++) {
        int threads = settings->threads[t];
        bench_row *vtk =
            bench_add(bench, &vtk_picture_kind, "process/vtk_picture/ct%d.vti/threads:%d", size, threads);
        vtk->size = size;
        vtk->threads = threads;
        for (int m = 0; m < METHODS; m++) {
            const struct picture_method *method = &picture_methods[m];
            bench_row *row = bench_add(bench, &isorender_kind, "process/isorender_%s/ct%d.vti/threads:%d",
                                       method->name, size, threads);
            row->size = size;
            row->threads = threads;
            row->plan = strdup(method->name);
            bool asked = threads == 2 && !settings->small;
            bench_compare(row, vtk, "ratio_vs_vtk_process", "ratio_vs_vtk_process_pairwise",
                          asked ? method->least : 0);
        }
    }
    return bench_run_group(bench, "a .vti file to a .png, whole processes", error);
}
