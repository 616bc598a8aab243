/* fuzz_hdf5: any bytes as a chunk of an HDF5 file, through any filters. This is what this process reads of
 * such files by itself; libhdf5 runs in a child process, whose crashes are expected (hdf5/guard.c,
 * hdf5/decoder.c), and is tried by fuzz_volumes.
 *
 * Of the first eight bytes, three are the sizes of the chunk, and the others the type of its values, their
 * order and the number of filters, the filters (three bits each), and which ones were skipped; the rest is
 * the chunk. */
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "grids/volume/hdf5/hdf5.h"
#include "tests/fuzz/read_volume.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t count);

static const int filters[8] = {ISO_HDF5_DEFLATE, ISO_HDF5_SHUFFLE, ISO_HDF5_FLETCHER32, ISO_HDF5_BZIP2,
                               ISO_HDF5_LZF,     ISO_HDF5_BLOSC,   ISO_HDF5_LZ4,        ISO_HDF5_ZSTD};

static iso_hdf5_array array_of(const uint8_t head[8]) {
    iso_hdf5_array array = {.path = "/a",
                            .rank = 3,
                            .xyz = {2, 1, 0},
                            .scalar = (iso_scalar)(head[3] % (ISO_SCALAR_HALF + 1)),
                            .big_endian = head[4] & 1,
                            .chunked = true,
                            .allocated = true,
                            .filter_count = head[4] >> 1 & 3};
    for (int axis = 0; axis < 3; axis++) array.sizes[axis] = array.chunk[axis] = 1 + head[axis] % 16;
    for (int i = 0; i < array.filter_count; i++)
        array.filters[i] = filters[(head[5] | (unsigned)head[6] << 8) >> 3 * i & 7];
    array.element_bytes = iso_scalar_size(array.scalar);
    return array;
}

/* The file has the chunk's bytes only. Blocks of memory have the sizes that are asked for, so that a step
 * beyond their ends is found. */
static void read_chunk(const iso_hdf5_array *array, uint32_t skipped, int file, size_t count) {
    static const int first[3] = {0, 0, 0};
    const iso_hdf5_place place = {.address = 0, .bytes = (uint32_t)count, .skipped = skipped};
    iso_hdf5_source source = {.path = "fuzz",
                              .descriptor = file,
                              .file_bytes = count,
                              .array = *array,
                              .places = &place,
                              .place_count = 1};
    iso_error error = {0};
    for (int axis = 0; axis < 3; axis++) source.dims[axis] = (int)array->sizes[array->xyz[axis]];
    iso_hdf5_chunk_grid(array, source.dims, source.counts, source.voxels);
    const uint64_t bytes =
        iso_format_size(source.voxels, iso_type_size(iso_scalar_stored_type(array->scalar)));
    void *room = malloc((size_t)iso_hdf5_chunk_room(array)), *target = malloc((size_t)bytes);
    fuzz_check(room && target, "no memory");
    const iso_status status = iso_hdf5_read_chunk(&source, first, room, target, &error);
    fuzz_check(status == ISO_OK || (status == ISO_ERR_IO && *error.text && !strchr(error.text, '\n')),
               "a failure without one line");
    free(room);
    free(target);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t count) {
    enum { HEAD = 8 };
    if (count < HEAD) return 0;
    const iso_hdf5_array array = array_of(bytes);
    const int file = memfd_create("fuzz_hdf5", 0);
    fuzz_check(file >= 0 && write(file, bytes + HEAD, count - HEAD) == (ssize_t)(count - HEAD), "no file");
    read_chunk(&array, bytes[7], file, count - HEAD);
    close(file);
    return 0;
}
