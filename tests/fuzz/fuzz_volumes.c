/* fuzz_volumes: any bytes as a volume file. The first byte chooses the name, and so the reader that a file
 * without a magic number gets; the rest is the file. Whatever happens must end in a volume or in one line.
 *
 * With clang and -fsanitize=fuzzer this is a libFuzzer target, with fuzz_replay.c a program that replays
 * files. */
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "grids/volume/mapping.h"
#include "tests/fuzz/read_volume.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t count);

static const char *const suffixes[] = {"vti",  "vtk", "nrrd", "mha",  "nii", "nii.gz", "vdb",  "dcm",
                                       "tif",  "raw", "mrc",  "mgz",  "mif", "mih",    "cube", "dx",
                                       "vasp", "npz", "vtr",  "pvti", "pvd", "vtm",    "xdmf", "am"};
enum { RAW = 9, SUFFIXES = sizeof suffixes / sizeof *suffixes };

static const char *write_file(int which, const uint8_t *bytes, size_t count) {
    static char path[256];
    const char *folder = getenv("TMPDIR");
    snprintf(path, sizeof path, "%s/fuzz_volumes.%ld.%s", folder ? folder : "/tmp", (long)getpid(),
             suffixes[which]);
    FILE *file = fopen(path, "wb");
    fuzz_check(file && fwrite(bytes, 1, count, file) == count, "no room for the file");
    fclose(file);
    return path;
}

static float last_voxel(const iso_volume *volume) {
    const int *dims = iso_grid_dims(&volume->grid);
    return iso_grid_at(&volume->grid, dims[0] - 1, dims[1] - 1, dims[2] - 1);
}

/* Voxels that can be read and can stay in the file are the same when they are mapped. */
static void read_mapped(const char *path, iso_volume_opts opts) {
    iso_volume read, mapped;
    bool mappable = false;
    opts.mappable = &mappable;
    if (iso_volume_read(path, &opts, &read, NULL) != ISO_OK) return;
    const float last = last_voxel(&read);
    iso_volume_free(&read);
    if (!mappable) return;
    opts.mapped = true;
    fuzz_check(iso_volume_read(path, &opts, &mapped, NULL) == ISO_OK, "a volume that cannot be mapped");
    if (mapped.grid.rgrid->release == iso_mapping_destroy) {
        const float same = last_voxel(&mapped);
        fuzz_check(memcmp(&same, &last, sizeof last) == 0, "a voxel that changes when it is mapped");
    }
    iso_volume_free(&mapped);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t count) {
    if (count < 1) return 0;
    int which = bytes[0] % SUFFIXES;
    const char *path = write_file(which, bytes + 1, count - 1);
    iso_raw_layout raw = {.dims = {7, 3, 2}, .type = ISO_INT16, .big_endian = count & 1};
    iso_volume_opts opts = {.max_memory = 64 << 20, .raw = which == RAW ? &raw : NULL};
    fuzz_read_volume(path, &opts);
    read_mapped(path, opts);
    remove(path);
    return 0;
}
