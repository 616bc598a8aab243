/* fuzz: any bytes as an OpenEXR picture of depth, normals and coverage. What the reader accepts must keep
 * what its header promises and come back the same when it is written and read again; what it refuses must be
 * refused in one line that names the file. */
#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "base/memory.h"
#include "image/exr.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* A file without a name on disk; returns its descriptor and a path for it. */
static int open_memory(char path[64]) {
    int descriptor = memfd_create("fuzz_exr", 0);
    if (descriptor < 0) abort();
    snprintf(path, 64, "/proc/self/fd/%d", descriptor);
    return descriptor;
}

static void check_values(const iso_aov *aov) {
    size_t count = (size_t)aov->width * (size_t)aov->height;
    for (size_t i = 0; i < count; i++) {
        float coverage = aov->coverage[i], x = aov->normal[0][i], y = aov->normal[1][i],
              z = aov->normal[2][i];
        if (!(coverage >= 0 && coverage <= 1) || !isfinite(x) || !isfinite(y) || !isfinite(z)) abort();
        if (coverage > 0 ? !isfinite(aov->depth[i]) : aov->depth[i] != INFINITY) abort();
    }
    if (!(aov->voxel >= 0) || !isfinite(aov->voxel)) abort();
}

static void write_and_read_back(const iso_aov *aov) {
    char path[] = "/tmp/fuzz_exr_XXXXXX";
    int descriptor = mkstemp(path);
    if (descriptor < 0) abort();
    close(descriptor);
    iso_aov again;
    if (iso_exr_write(path, aov, NULL, NULL, NULL) != ISO_OK) abort();
    if (iso_exr_read(path, NULL, &again, NULL) != ISO_OK) abort();
    unlink(path);
    if (again.width != aov->width || again.height != aov->height || again.voxel != aov->voxel) abort();
    size_t bytes = (size_t)aov->width * (size_t)aov->height * sizeof(float);
    if (memcmp(aov->depth, again.depth, bytes) != 0 || memcmp(aov->coverage, again.coverage, bytes) != 0)
        abort();
    for (int axis = 0; axis < 3; axis++)
        if (memcmp(aov->normal[axis], again.normal[axis], bytes) != 0) abort();
    iso_aov_free(&again);
}

/* Reading it as colours ends well or with an error, too. */
static void read_colors(const char *path) {
    iso_float_image image;
    iso_error error = {0};
    if (iso_exr_read_color(path, NULL, &image, &error) == ISO_OK)
        iso_free(image.rgb);
    else if (!strstr(error.text, path) || strchr(error.text, '\n'))
        abort();
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    char path[64];
    int descriptor = open_memory(path);
    if (size > 0 && write(descriptor, data, size) != (ssize_t)size) abort();
    iso_aov aov;
    iso_error error = {0};
    iso_status status = iso_exr_read(path, NULL, &aov, &error);
    if (status == ISO_OK) {
        check_values(&aov);
        if ((size_t)aov.width * (size_t)aov.height < (1 << 20)) write_and_read_back(&aov);
        iso_aov_free(&aov);
    } else if (!strstr(error.text, path) || strchr(error.text, '\n'))
        abort(); /* every error is one line that names the file */
    read_colors(path);
    close(descriptor);
    return 0;
}
