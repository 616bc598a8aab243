/* read_volume: what the fuzzers of volume files have in common: any file must end in a volume or in one
 * line. */
#ifndef ISO_TESTS_FUZZ_READ_VOLUME_H
#define ISO_TESTS_FUZZ_READ_VOLUME_H

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "grids/volume/volume.h"

/* Aborts, which the fuzzer reports, unless `truth`. */
static inline void fuzz_check(int truth, const char *what) {
    if (truth) return;
    fprintf(stderr, "fuzz: %s\n", what);
    abort();
}

/* Reads the file or folder, and checks the volume or the error. */
static inline void fuzz_read_volume(const char *path, const iso_volume_opts *opts) {
    iso_volume volume;
    iso_error error = {0};
    const iso_status status = iso_volume_read(path, opts, &volume, &error);
    if (status == ISO_OK) {
        const int *dims = iso_grid_dims(&volume.grid);
        fuzz_check(dims[0] >= 1 && dims[1] >= 1 && dims[2] >= 1, "a volume without voxels");
        fuzz_check(!iso_transform_is_singular(iso_grid_transform(&volume.grid)), "a flat volume");
        volatile float last = iso_grid_at(&volume.grid, dims[0] - 1, dims[1] - 1, dims[2] - 1);
        (void)last;
        iso_volume_free(&volume);
    } else {
        fuzz_check(error.status == status && *error.text && !strchr(error.text, '\n'),
                   "a failure without one line");
        fuzz_check(status != ISO_ERR_UNSUPPORTED || !strstr(error.text, "reader cannot be loaded"),
                   "a module that fuzzing would never reach");
    }
}

#endif
