/* fuzz_volio: any bytes as a volume file. The first byte chooses the name, and so the reader that a file
 * without a magic number gets; the rest is the file. Whatever happens must end in a volume or in one line.
 *
 * With clang and -fsanitize=fuzzer this is a libFuzzer target, with fuzz_replay.c a program that replays
 * files. */
#define _DEFAULT_SOURCE
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "grids/volume/volume.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t count);

static const char *const suffixes[] = {"vti",    "vtk", "nrrd", "mha", "nii",
                                       "nii.gz", "vdb", "dcm",  "tif", "raw"};
enum { SUFFIXES = sizeof suffixes / sizeof *suffixes };

static void check(int truth, const char *what) {
    if (truth) return;
    fprintf(stderr, "fuzz_volio: %s\n", what);
    abort();
}

static const char *write_file(int which, const uint8_t *bytes, size_t count) {
    static char path[256];
    const char *folder = getenv("TMPDIR");
    snprintf(path, sizeof path, "%s/fuzz_volio.%ld.%s", folder ? folder : "/tmp", (long)getpid(),
             suffixes[which]);
    FILE *file = fopen(path, "wb");
    check(file && fwrite(bytes, 1, count, file) == count, "no room for the file");
    fclose(file);
    return path;
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t count) {
    if (count < 1) return 0;
    int which = bytes[0] % SUFFIXES;
    const char *path = write_file(which, bytes + 1, count - 1);
    iso_raw_layout raw = {.dims = {7, 3, 2}, .type = ISO_INT16, .big_endian = count & 1};
    iso_volume_opts opts = {.max_memory = 64 << 20, .raw = which == SUFFIXES - 1 ? &raw : NULL};
    iso_volume volume;
    iso_error error = {0};
    iso_status status = iso_volume_read(path, &opts, &volume, &error);
    if (status == ISO_OK) {
        const int *dims = iso_grid_dims(&volume.grid);
        check(dims[0] >= 1 && dims[1] >= 1 && dims[2] >= 1, "a volume without voxels");
        check(!iso_transform_is_singular(iso_grid_transform(&volume.grid)), "a flat volume");
        volatile float last = iso_grid_at(&volume.grid, dims[0] - 1, dims[1] - 1, dims[2] - 1);
        (void)last;
        iso_volume_free(&volume);
    } else {
        check(error.status == status && *error.text && !strchr(error.text, '\n'),
              "a failure without one line");
        check(status != ISO_ERR_UNSUPPORTED || !strstr(error.text, "reader cannot be loaded"),
              "a module that fuzzing would never reach");
    }
    remove(path);
    return 0;
}
