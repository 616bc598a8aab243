/* What the bench says: tables for people, Google Benchmark's JSON for programs. */
#define _GNU_SOURCE
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "apps/json.h"
#include "base/file.h"
#include "bench_harness.h"

/* ---- tables ---- */

void bench_print_rows(const bench_state *bench, const char *title, int first) {
    bool any = false;
    for (int i = first; i < bench->row_count; i++) {
        const bench_row *row = bench->rows[i];
        if (!row->rounds && !row->problem[0]) continue;
        if (!any)
            printf("\n%s\n  %-56s %10s %10s %10s %11s\n", title, "", "median ms", "least", "most",
                   "primitives");
        any = true;
        if (row->rounds)
            printf("  %-56s %10.3f %10.3f %10.3f %11zu\n", row->name, bench_row_median(row), row->least_wall,
                   row->most_wall, row->primitives);
        if (row->problem[0]) printf("  %-56s %s\n", row->name, row->problem);
    }
    fflush(stdout);
}

static void print_counter(const bench_row *row, const bench_counter *counter) {
    printf("  %-56s %-34s %14.6g", row->name, counter->name, counter->value);
    bool met = (counter->least <= 0 || counter->value >= counter->least) &&
               (counter->most <= 0 || counter->value <= counter->most);
    if (counter->least > 0) printf("   at least %.4g: %s", counter->least, met ? "met" : "not met");
    if (counter->most > 0) printf("   at most %.8g: %s", counter->most, met ? "met" : "not met");
    printf("\n");
}

void bench_print_counters(const bench_state *bench) {
    printf("\nratios (of medians of this run; pairwise: median of the rounds' ratios) and counts\n");
    for (int i = 0; i < bench->row_count; i++)
        for (int k = 0; k < bench->rows[i]->counter_count; k++)
            print_counter(bench->rows[i], &bench->rows[i]->counters[k]);
}

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

/* ---- JSON ---- */

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

iso_status bench_write_json(const bench_state *bench, iso_error *error) {
    iso_sink sink = {0};
    ISO_TRY(iso_sink_open(bench->settings->json, &sink, error));
    iso_json json = {.stream = sink.stream};
    iso_json_begin_object(&json, NULL);
    write_context(&json, bench);
    iso_json_begin_array(&json, "benchmarks");
    for (int i = 0; i < bench->row_count; i++)
        if (bench->rows[i]->rounds) write_row(&json, bench->rows[i], i);
    iso_json_end_array(&json);
    iso_json_end_object(&json);
    return iso_sink_commit(&sink, error);
}
