/* bench_alone: our side of what is measured in a process of its own. The bench starts it; itself it has the
 * peers' libraries in its memory and in the time of its start.
 *
 *     bench_alone memory SIZE    makes the ct scene, extracts points once, and prints milliseconds, those of
 *                                the processors, peak bytes, points, and bytes before the extraction
 *     bench_alone points FILE    reads a volume, extracts points once, and prints how many */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "bench_scenes.h"
#include "extract/points/points.h"
#include "grids/volume/volume.h"

static double milliseconds(clockid_t clock) {
    struct timespec now;
    clock_gettime(clock, &now);
    return 1e3 * (double)now.tv_sec + 1e-6 * (double)now.tv_nsec;
}

/* Bytes in a line of /proc/self/status; 0 when it is not there. */
static double status_bytes(const char *key) {
    FILE *stream = fopen("/proc/self/status", "r");
    if (!stream) return 0;
    char line[256];
    double kilobytes = 0;
    while (fgets(line, sizeof line, stream))
        if (strncmp(line, key, strlen(key)) == 0) sscanf(line + strlen(key), ": %lf", &kilobytes);
    fclose(stream);
    return kilobytes * 1024;
}

/* Making the scene may have taken more memory than what is measured: the peak starts anew. */
static void forget_peak(void) {
    FILE *stream = fopen("/proc/self/clear_refs", "w");
    if (!stream) return;
    fputs("5", stream);
    fclose(stream);
}

static iso_status extract(const iso_grid *grid, iso_point_set **set, iso_error *error) {
    iso_points_opts opts = {.isovalue = 127.5};
    ISO_TRY(iso_point_set_create(grid, &opts, set, error));
    return iso_point_set_update(*set, error);
}

static iso_status measure_memory(const char *size, iso_error *error) {
    bench_scenes *scenes = NULL;
    const iso_grid *grid = NULL;
    iso_point_set *set = NULL;
    iso_status status = bench_scenes_create(&scenes, error);
    if (status == ISO_OK) status = bench_scene_ct(scenes, atoi(size), ISO_UINT8, &grid, error);
    double before = status_bytes("VmRSS");
    forget_peak();
    double cpu = milliseconds(CLOCK_PROCESS_CPUTIME_ID), wall = milliseconds(CLOCK_MONOTONIC);
    if (status == ISO_OK) status = extract(grid, &set, error);
    wall = milliseconds(CLOCK_MONOTONIC) - wall;
    cpu = milliseconds(CLOCK_PROCESS_CPUTIME_ID) - cpu;
    if (status == ISO_OK)
        printf("%.17g %.17g %.17g %zu %.17g\n", wall, cpu, status_bytes("VmHWM"),
               iso_point_set_stats(set).points, before);
    iso_point_set_destroy(set);
    bench_scenes_destroy(scenes);
    return status;
}

static iso_status count_points(const char *path, iso_error *error) {
    iso_volume volume = {0};
    iso_volume_opts how = {0};
    iso_point_set *set = NULL;
    iso_status status = iso_volume_read(path, &how, &volume, error);
    if (status == ISO_OK) status = extract(&volume.grid, &set, error);
    if (status == ISO_OK) printf("%zu\n", iso_point_set_stats(set).points);
    iso_point_set_destroy(set);
    iso_volume_free(&volume);
    return status;
}

int main(int argc, char **argv) {
    iso_error error = {0};
    iso_status status = ISO_ERR_USAGE;
    if (argc == 3 && strcmp(argv[1], "memory") == 0) status = measure_memory(argv[2], &error);
    if (argc == 3 && strcmp(argv[1], "points") == 0) status = count_points(argv[2], &error);
    if (status != ISO_OK) fprintf(stderr, "bench_alone: %s\n", *error.text ? error.text : "wrong usage");
    return iso_status_exit(status);
}
