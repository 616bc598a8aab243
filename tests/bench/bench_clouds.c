/* What files of points cost: reading ten millions of them against copying the file; estimating normals and
 * radii; and twenty millions to a picture, isorender against a program that does it with VTK. The points lie
 * on a lumpy sphere of 100 mm, in random order. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "bench_files.h"
#include "clouds/cloud.h"
#include "io/glyphs/glyphs_read.h"

enum { LAS_HEADER = 227, LAS_RECORD = 26 };

/* Numbers in -1 .. 1, the same on every machine. */
static float next_number(uint32_t *seed) {
    *seed = *seed * 1664525u + 1013904223u;
    return (float)(*seed >> 8) / (float)(1 << 23) - 1;
}

/* A point of the sphere and its direction from the middle. */
static void make_point(uint32_t *seed, float position[3], float direction[3]) {
    float square;
    do {
        square = 0;
        for (int k = 0; k < 3; k++) {
            direction[k] = next_number(seed);
            square += direction[k] * direction[k];
        }
    } while (square > 1 || square < 0.01f);
    const float scale = 1 / sqrtf(square);
    for (int k = 0; k < 3; k++) direction[k] *= scale;
    const float lump = direction[0] * direction[1] * direction[2];
    for (int k = 0; k < 3; k++) position[k] = direction[k] * (100 + 40 * lump);
}

static void put_ply(FILE *file, int count) {
    uint32_t seed = 1;
    fprintf(file,
            "ply\nformat binary_little_endian 1.0\nelement vertex %d\nproperty float x\nproperty float y\n"
            "property float z\nproperty float nx\nproperty float ny\nproperty float nz\nproperty uchar red\n"
            "property uchar green\nproperty uchar blue\nend_header\n",
            count);
    for (int i = 0; i < count; i++) {
        float numbers[6];
        unsigned char color[3];
        make_point(&seed, numbers, numbers + 3);
        for (int k = 0; k < 3; k++) color[k] = (unsigned char)(127 + 127 * numbers[3 + k]);
        fwrite(numbers, sizeof numbers, 1, file);
        fwrite(color, sizeof color, 1, file);
    }
}

/* LAS 1.2, point format 2: coordinates in steps of .001 at map coordinates, and colours. */
static void put_las(FILE *file, int count) {
    static const double numbers[6] = {0.001, 0.001, 0.001, 600000, 5400000, 100};
    const uint16_t lengths[2] = {LAS_HEADER, LAS_RECORD};
    const uint32_t begin = LAS_HEADER, points = (uint32_t)count;
    unsigned char header[LAS_HEADER] = "LASF", record[LAS_RECORD] = {0};
    uint32_t seed = 1;
    header[24] = 1, header[25] = 2, header[104] = 2;
    memcpy(header + 94, &lengths[0], 2);
    memcpy(header + 96, &begin, 4);
    memcpy(header + 105, &lengths[1], 2);
    memcpy(header + 107, &points, 4);
    memcpy(header + 131, numbers, sizeof numbers);
    fwrite(header, sizeof header, 1, file);
    for (int i = 0; i < count; i++) {
        float position[3], direction[3];
        int32_t place[3];
        uint16_t color[3];
        make_point(&seed, position, direction);
        for (int k = 0; k < 3; k++) place[k] = (int32_t)(1000 * position[k]);
        for (int k = 0; k < 3; k++) color[k] = (uint16_t)(32767 + 32767 * direction[k]);
        memcpy(record, place, sizeof place);
        memcpy(record + 20, color, sizeof color);
        fwrite(record, sizeof record, 1, file);
    }
}

static iso_status read_points(const char *path, size_t *primitives, iso_error *error) {
    iso_glyphs glyphs;
    ISO_TRY(iso_glyphs_read(path, NULL, &glyphs, error));
    *primitives = glyphs.count;
    iso_glyphs_free(&glyphs);
    return ISO_OK;
}

static const bench_file_plan formats[2] = {{.ending = "ply", .put = put_ply, .read = read_points},
                                           {.ending = "las", .put = put_las, .read = read_points}};

/* ---- estimates */

static iso_status open_estimates(bench_row *row, iso_error *error) {
    const bench_file_plan *plan = row->plan;
    iso_glyphs *glyphs = calloc(1, sizeof *glyphs);
    uint32_t seed = 1;
    row->context = glyphs;
    if (!glyphs || !plan) return iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    glyphs->count = (size_t)plan->count;
    glyphs->positions = iso_alloc(glyphs->count * sizeof *glyphs->positions);
    if (!glyphs->positions) return iso_fail(error, ISO_ERR_NOMEM, "out of memory");
    for (size_t i = 0; i < glyphs->count; i++) {
        float direction[3];
        make_point(&seed, glyphs->positions[i], direction);
    }
    return ISO_OK;
}

static iso_status run_estimates(bench_row *row, bench_sample *sample, iso_error *error) {
    const iso_glyphs *glyphs = row->context;
    const iso_cloud_opts opts = {.pool = NULL};
    iso_cloud cloud;
    const bench_clock clock = bench_clock_start();
    ISO_TRY(iso_cloud_make(glyphs, &opts, &cloud, error));
    bench_clock_stop(&clock, sample);
    sample->primitives = cloud.count;
    iso_cloud_free(&cloud);
    return ISO_OK;
}

static void finish_estimates(bench_row *row) {
    if (!row->primitives) return;
    bench_count(row, "cpu_us_a_point", 1e3 * bench_median(row->cpu, row->rounds) / (double)row->primitives, 0,
                0);
}

static void close_estimates(bench_row *row) {
    if (row->context) iso_glyphs_free(row->context);
    free(row->context);
}

/* ---- to a picture: the radius is given to both, so that isorender estimates nothing */

static iso_status run_vtk_cloud(bench_row *row, bench_sample *sample, iso_error *error) {
    return bench_file_run_vtk(row, "cloud", "0.06", sample, error);
}

static iso_status run_isorender_cloud(bench_row *row, bench_sample *sample, iso_error *error) {
    const bench_file *file = row->context;
    const char *side = bench_file_picture_side(row);
    char program[1100], resolution[16];
    ISO_TRY(bench_sibling("isorender", program, sizeof program, error));
    snprintf(resolution, sizeof resolution, "%sx%s", side, side);
    const char *const argv[] = {program, file->path,     file->picture, "--radius", "0.06",      "--camera",
                                "iso",   "--resolution", resolution,    "--quiet",  "--threads", "1",
                                NULL};
    return bench_time_program(argv, row->threads, NULL, sample, error);
}

static const bench_kind estimates_kind = {.open = open_estimates,
                                          .run = run_estimates,
                                          .finish = finish_estimates,
                                          .close = close_estimates,
                                          .batch = 1},
                        vtk_cloud_kind = {.open = bench_file_open,
                                          .run = run_vtk_cloud,
                                          .close = bench_file_close,
                                          .batch = 1,
                                          .rounds = 3},
                        isorender_cloud_kind = {.open = bench_file_open,
                                                .run = run_isorender_cloud,
                                                .close = bench_file_close,
                                                .batch = 1,
                                                .rounds = 3};

static bench_row *add_row(bench_state *bench, const bench_kind *kind, int format, int count,
                          const char *what) {
    bench_file_plan plan = formats[format];
    char name[64];
    plan.count = count;
    snprintf(name, sizeof name, "%s/%dk", what, count / 1000);
    return bench_file_add(bench, kind, &plan, name);
}

iso_status bench_clouds_group(bench_state *bench, iso_error *error) {
    static const char *const names[2][2] = {{"read/ply/copy", "read/ply/points"},
                                            {"read/las/copy", "read/las/points"}};
    const bool small = bench->settings->small;
    for (int format = 0; format < 2; format++) {
        const int count = small ? 1000 : 10000000;
        bench_row *copy = add_row(bench, &bench_file_copy_kind, format, count, names[format][0]),
                  *read = add_row(bench, &bench_file_read_kind, format, count, names[format][1]);
        bench_against *against =
            bench_compare(read, copy, "ratio_vs_copy", "ratio_vs_copy_pairwise", small ? 0 : 0.5);
        if (against) against->cpu = "cpu_ratio_vs_copy";
    }
    ISO_TRY(bench_run_group(bench, "files of points: reading them, and copying them", error));
    add_row(bench, &estimates_kind, 0, small ? 1000 : 1000000, "estimate/normals_and_radii");
    return bench_run_group(bench, "normals and radii of points, estimated, one thread", error);
}

iso_status bench_cloud_picture_group(bench_state *bench, iso_error *error) {
    const bool small = bench->settings->small;
    const int count = small ? 1000 : 20000000;
    bench_row *vtk = add_row(bench, &vtk_cloud_kind, 0, count, "process/ply/vtkPointGaussianMapper"),
              *ours = add_row(bench, &isorender_cloud_kind, 0, count, "process/ply/isorender");
    bench_against *against =
        bench_compare(ours, vtk, "ratio_vs_vtk_process", "ratio_vs_vtk_process_pairwise", small ? 0 : 10);
    if (against) against->cpu = "cpu_ratio_vs_vtk_process";
    return bench_run_group(bench, "a .ply file of points to a .png, whole processes", error);
}
