/* fuzz: any bytes as a PLY file of points. What the reader accepts must be usable and come back the same when
 * it is written and read again; what it refuses must be refused in one line that names the file. */
#define _GNU_SOURCE
#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "io/points_io.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* A file without a name on disk; returns its descriptor and a path for it. */
static int open_memory(char path[64]) {
    int descriptor = memfd_create("fuzz_ply", 0);
    if (descriptor < 0) abort();
    snprintf(path, 64, "/proc/self/fd/%d", descriptor);
    return descriptor;
}

static void check_points(const iso_points *points) {
    if (points->span.count == 0) abort();
    for (uint32_t i = 0; i < points->span.count; i++) {
        const iso_surfel *surfel = &points->surfels[i];
        const float *p = surfel->position, *n = surfel->normal;
        float length = sqrtf(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
        if (!isfinite(p[0]) || !isfinite(p[1]) || !isfinite(p[2])) abort();
        if (!(fabsf(length - 1) < 1e-5f) || !(points->radii[i] > 0) || !isfinite(points->radii[i])) abort();
    }
}

static void write_and_read_back(const iso_points *points) {
    char path[] = "/tmp/fuzz_ply_XXXXXX";
    int descriptor = mkstemp(path);
    if (descriptor < 0) abort();
    close(descriptor);
    const iso_point_view view = iso_points_view(points);
    iso_points again;
    if (iso_points_write_ply(path, &view, NULL, NULL) != ISO_OK) abort();
    if (iso_points_read_ply(path, 0, &again, NULL) != ISO_OK) abort();
    unlink(path);
    size_t count = points->span.count;
    if (again.span.count != count) abort();
    for (size_t i = 0; i < count; i++) /* by value: a position of -0 may come back as 0 */
        for (int axis = 0; axis < 3; axis++) {
            if (points->surfels[i].position[axis] != again.surfels[i].position[axis]) abort();
            if (points->surfels[i].normal[axis] != again.surfels[i].normal[axis]) abort();
        }
    if (memcmp(points->radii, again.radii, count * sizeof *points->radii) != 0) abort();
    iso_points_free(&again);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    char path[64];
    int descriptor = open_memory(path);
    if (size > 0 && write(descriptor, data, size) != (ssize_t)size) abort();
    iso_points points;
    iso_error error = {0};
    iso_status status = iso_points_read_ply(path, 1 << 26, &points, &error);
    if (status == ISO_OK) {
        check_points(&points);
        write_and_read_back(&points);
        iso_points_free(&points);
    } else if (!strstr(error.text, path) || strchr(error.text, '\n'))
        abort(); /* every error is one line that names the file */
    close(descriptor);
    return 0;
}
