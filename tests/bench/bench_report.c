/* What the bench says: tables for people, Google Benchmark's JSON for programs. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "apps/common/json.h"
#include "bench_harness.h"

/* ---- the machine ---- */

/* The first line of a file without its newline, or of /proc/cpuinfo's `key`; false when there is none. */
static bool read_line(const char *path, const char *key, char *text, int size) {
    FILE *stream = fopen(path, "r");
    if (!stream) return false;
    bool found = false;
    while (!found && fgets(text, size, stream)) found = !key || strncmp(text, key, strlen(key)) == 0;
    fclose(stream);
    if (!found) return false;
    text[strcspn(text, "\n")] = 0;
    const char *colon = key ? strchr(text, ':') : NULL;
    if (colon) memmove(text, colon + 1 + (colon[1] == ' '), strlen(colon + 1 + (colon[1] == ' ')) + 1);
    return true;
}

/* ---- tables ---- */

/* Counters that have a column, by any of their names, and those that are in the JSON only. */
static const char *const peer_names[] = {"ratio_vs_vtkFlyingEdges3D", "ratio_vs_volumeToMesh",
                                         "ratio_vs_vtk_frame", "ratio_vs_vtk_process", NULL};
static const char *const pair_names[] = {
    "ratio_vs_vtkFlyingEdges3D_pairwise", "ratio_vs_volumeToMesh_pairwise", "ratio_vs_full_pairwise",
    "ratio_vs_vtk_frame_pairwise",        "ratio_vs_vtk_process_pairwise",  NULL};
static const char *const own_names[] = {"ratio_vs_marching_cubes", "ratio_vs_full", "ratio_vs_raycast",
                                        "ratio_vs_pullpush", NULL};
static const char *const scaling_names[] = {"scaling", NULL};
static const char *const first_names[] = {"first_ms", NULL};
static const char *const *const columns[] = {peer_names, pair_names, own_names, scaling_names, first_names};
enum { COLUMNS = sizeof columns / sizeof *columns };

static bool is_named(const bench_counter *counter, const char *const *names) {
    while (*names && strcmp(counter->name, *names) != 0) names++;
    return *names != NULL;
}

static bool has_column(const bench_counter *counter) {
    for (int c = 0; c < COLUMNS; c++)
        if (is_named(counter, columns[c])) return true;
    return false;
}

static void print_column(const bench_row *row, const char *const *names) {
    for (int i = 0; i < row->counter_count; i++)
        if (is_named(&row->counters[i], names)) {
            printf(" %8.*f", row->counters[i].value < 100 ? 2 : 0, row->counters[i].value);
            return;
        }
    printf(" %8s", "");
}

static void print_row(const bench_row *row) {
    printf("  %-52s %9.3f %9.3f %9.3f %10zu", row->name, bench_row_median(row), row->least_wall,
           row->most_wall, row->primitives);
    for (int c = 0; c < COLUMNS; c++) print_column(row, columns[c]);
    printf("\n");
    for (int i = 0; i < row->counter_count; i++)
        if (!has_column(&row->counters[i]))
            printf("      %-48s %14.6g\n", row->counters[i].name, row->counters[i].value);
}

void bench_print_machine(const bench_state *bench) {
    char model[256];
    double load = 0;
    long processors = sysconf(_SC_NPROCESSORS_ONLN);
    if (!read_line("/proc/cpuinfo", "model name", model, sizeof model)) strcpy(model, "unknown processor");
    printf("%s, %ld processors, %s", model, processors, iso_cpu_level_name(bench->best));
    if (getloadavg(&load, 1) == 1) printf(", load %.2f", load);
    printf("\n");
    if (load > 0.25 * (double)processors)
        printf(
            "others are at work on this machine: scaling is not to be trusted, and times less than ratios\n");
    fflush(stdout);
}

void bench_print_rows(const bench_state *bench, const char *title, int first) {
    bool any = false;
    for (int i = first; i < bench->row_count; i++) {
        const bench_row *row = bench->rows[i];
        if (!row->rounds && !row->problem[0]) continue;
        if (!any)
            printf("\n%-54s %9s %9s %9s %10s %8s %8s %8s %8s %8s\n", title, "median ms", "least", "most",
                   "primitives", "vs peer", "pairwise", "vs own", "scaling", "first ms");
        any = true;
        if (row->rounds) print_row(row);
        if (row->problem[0]) printf("  %-52s %s\n", row->name, row->problem);
    }
    fflush(stdout);
}

static void print_asked(const bench_row *row, const bench_counter *counter) {
    bool least = counter->least > 0;
    double limit = least ? counter->least : counter->most;
    bool met = least ? counter->value >= limit : counter->value <= limit;
    printf("  %-52s %-30s %12.6g  %s %10.8g  %s\n", row->name, counter->name, counter->value,
           least ? "at least" : "at most ", limit, met ? "met" : "not met");
}

void bench_print_asked(const bench_state *bench) {
    if (bench->vtk_renderer[0])
        printf("\nVTK's frames were drawn by %s, bound to as many processors as it has threads\n",
               bench->vtk_renderer);
    printf("\nwhat is asked for (ratios of medians of this run)\n");
    for (int i = 0; i < bench->row_count; i++)
        for (int k = 0; k < bench->rows[i]->counter_count; k++) {
            const bench_counter *counter = &bench->rows[i]->counters[k];
            if (counter->least > 0 || counter->most > 0) print_asked(bench->rows[i], counter);
        }
}

/* ---- JSON: the machine ---- */

static int count_bits(const char *mask) {
    int count = 0;
    for (const char *c = mask; *c; c++) {
        const char digit[2] = {*c, 0};
        if (*c != ',') count += __builtin_popcountl(strtoul(digit, NULL, 16));
    }
    return count;
}

static bool cache_text(int index, const char *name, char *text, int size) {
    char path[128];
    snprintf(path, sizeof path, "/sys/devices/system/cpu/cpu0/cache/index%d/%s", index, name);
    return read_line(path, NULL, text, size);
}

static void write_caches(iso_json *json) {
    iso_json_begin_array(json, "caches");
    char type[64], level[64], size[64], shared[256];
    for (int i = 0; cache_text(i, "type", type, sizeof type) && cache_text(i, "level", level, sizeof level) &&
                    cache_text(i, "size", size, sizeof size);
         i++) {
        bool known = cache_text(i, "shared_cpu_map", shared, sizeof shared);
        iso_json_begin_object(json, NULL);
        iso_json_string(json, "type", type);
        iso_json_integer(json, "level", strtoul(level, NULL, 10));
        iso_json_integer(json, "size", strtoul(size, NULL, 10) * (strchr(size, 'M') ? 1 << 20 : 1 << 10));
        iso_json_integer(json, "num_sharing", known ? (uint64_t)count_bits(shared) : 1);
        iso_json_end_object(json);
    }
    iso_json_end_array(json);
}

static void write_context(iso_json *json, const bench_state *bench) {
    char text[256];
    time_t now = time(NULL);
    struct tm local;
    strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%S%z", localtime_r(&now, &local));
    iso_json_begin_object(json, "context");
    iso_json_string(json, "date", text);
    iso_json_string(json, "host_name", "");
    iso_json_string(json, "executable", "bench");
    iso_json_integer(json, "num_cpus", (uint64_t)sysconf(_SC_NPROCESSORS_ONLN));
    bool known = read_line("/proc/cpuinfo", "cpu MHz", text, sizeof text);
    iso_json_integer(json, "mhz_per_cpu", known ? (uint64_t)(strtod(text, NULL) + 0.5) : 0);
    known = read_line("/proc/cpuinfo", "model name", text, sizeof text);
    iso_json_string(json, "cpu_model", known ? text : "unknown");
    iso_json_string(json, "cpu_level", iso_cpu_level_name(bench->best));
    if (bench->vtk_renderer[0]) iso_json_string(json, "vtk_renderer", bench->vtk_renderer);
    known = read_line("/sys/devices/system/cpu/cpu0/cpufreq/scaling_governor", NULL, text, sizeof text);
    iso_json_bool(json, "cpu_scaling_enabled", known && strcmp(text, "performance") != 0);
    write_caches(json);
    double load[3] = {0};
    int loads = getloadavg(load, 3);
    iso_json_reals(json, "load_avg", load, loads < 0 ? 0 : loads);
#ifdef NDEBUG
    iso_json_string(json, "library_build_type", "release");
#else
    iso_json_string(json, "library_build_type", "debug");
#endif
    iso_json_end_object(json);
}

/* ---- JSON: the rows ---- */

static void write_row(iso_json *json, const bench_row *row, int index) {
    iso_json_begin_object(json, NULL);
    iso_json_string(json, "name", row->name);
    iso_json_integer(json, "family_index", (uint64_t)index);
    iso_json_integer(json, "per_family_instance_index", 0);
    iso_json_string(json, "run_name", row->name);
    iso_json_string(json, "run_type", "iteration");
    iso_json_integer(json, "repetitions", (uint64_t)row->rounds);
    iso_json_integer(json, "repetition_index", 0);
    iso_json_integer(json, "threads", (uint64_t)row->threads);
    iso_json_integer(json, "iterations", (uint64_t)row->runs);
    iso_json_real(json, "real_time", bench_row_median(row));
    iso_json_real(json, "cpu_time", bench_median(row->cpu, row->rounds));
    iso_json_string(json, "time_unit", "ms");
    iso_json_real(json, "min", row->least_wall);
    iso_json_real(json, "median", bench_row_median(row));
    iso_json_real(json, "max", row->most_wall);
    iso_json_integer(json, "primitives", row->primitives);
    for (int i = 0; i < row->counter_count; i++)
        iso_json_real(json, row->counters[i].name, row->counters[i].value);
    iso_json_end_object(json);
}

iso_status bench_write_json(bench_state *bench, iso_error *error) {
    iso_json json = {0};
    iso_json_begin_object(&json, NULL);
    write_context(&json, bench);
    iso_json_begin_array(&json, "benchmarks");
    for (int i = 0; i < bench->row_count; i++)
        if (bench->rows[i]->rounds) write_row(&json, bench->rows[i], i);
    iso_json_end_array(&json);
    iso_json_end_object(&json);
    return iso_json_commit(&json, &bench->json, error);
}
