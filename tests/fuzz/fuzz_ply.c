/* fuzz: any bytes as a PLY file of points. A cloud of what the reader accepts must be usable, and come back
 * the same when it is written and read again; what the reader refuses must be refused in one line that names
 * the file. */
#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "clouds/cloud.h"
#include "io/glyphs/glyphs_read.h"
#include "io/points_write.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* A file without a name on disk; returns its descriptor and a path for it. */
static int open_memory(char path[64]) {
    int descriptor = memfd_create("fuzz_ply", 0);
    if (descriptor < 0) abort();
    snprintf(path, 64, "/proc/self/fd/%d", descriptor);
    return descriptor;
}

static void check_cloud(const iso_cloud *cloud) {
    if (cloud->count == 0) abort();
    for (size_t i = 0; i < cloud->count; i++) {
        const float *p = cloud->surfels[i].position, *n = cloud->surfels[i].normal;
        const float length = sqrtf(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
        for (int axis = 0; axis < 3; axis++)
            if (!(p[axis] >= 0 && p[axis] <= ISO_BRICK)) abort();
        if (!(fabsf(length - 1) < 1e-5f) || !(cloud->radii[i] > 0) || !isfinite(cloud->radii[i])) abort();
    }
}

/* Writes the cloud, and reads it: it has a normal and a radius for each point now. */
static void write_and_read_back(const iso_cloud *cloud) {
    char path[] = "/tmp/fuzz_ply_XXXXXX.ply";
    int descriptor = mkstemps(path, 4);
    if (descriptor < 0) abort();
    close(descriptor);
    const iso_point_view view = iso_cloud_view(cloud);
    iso_glyphs again;
    if (iso_points_write_ply(path, &view, NULL, NULL) != ISO_OK) abort();
    if (iso_glyphs_read(path, NULL, &again, NULL) != ISO_OK) abort();
    unlink(path);
    if (again.count != cloud->count || !again.directions || !again.radii) abort();
    if (!again.colors != !cloud->colors) abort();
    for (size_t i = 0; i < again.count; i++) {
        if (memcmp(again.directions[i], cloud->surfels[i].normal, sizeof again.directions[i]) != 0) {
            for (int axis = 0; axis < 3; axis++) /* a component of -0 may come back as 0 */
                if (again.directions[i][axis] != cloud->surfels[i].normal[axis]) abort();
        }
        if (again.radii[i] != cloud->radii[i]) abort();
        if (again.colors && memcmp(again.colors[i], cloud->colors[i], 3) != 0) abort();
    }
    iso_glyphs_free(&again);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    char path[64];
    int descriptor = open_memory(path);
    if (size > 0 && write(descriptor, data, size) != (ssize_t)size) abort();
    const iso_read_opts opts = {.max_memory = 1 << 26};
    iso_glyphs glyphs = {.count = 0};
    iso_cloud cloud = {0};
    iso_error error = {0};
    iso_status status = iso_glyphs_read(path, &opts, &glyphs, &error);
    if (status == ISO_OK) {
        if (glyphs.count) {
            if (iso_cloud_make(&glyphs, &(iso_cloud_opts){0}, &cloud, &error) != ISO_OK) abort();
            check_cloud(&cloud);
            write_and_read_back(&cloud);
        }
        iso_cloud_free(&cloud);
        iso_glyphs_free(&glyphs);
    } else if (!strstr(error.text, path) || strchr(error.text, '\n'))
        abort(); /* every error is one line that names the file */
    close(descriptor);
    return 0;
}
