/* places: asks libhdf5 where the chunks of an array lie in the file. Runs in the child process.
 *
 * libhdf5 1.10 can list chunks only in quadratic time, but finds a single one quickly: it is asked to read
 * each chunk, and the driver notes the place instead of reading (library.c). */
#define _GNU_SOURCE
#include "grids/volume/hdf5/library.h"

/* Whether a chunk that could not be read is not in the file. The function that reads a chunk fails itself
 * then; when the index of chunks is damaged, one that it calls does. Other versions of libhdf5 are asked. */
static bool is_absent(hid_t dataset, const hsize_t *offset) {
    haddr_t address = 0;
    hsize_t bytes;
    unsigned skipped;
    if (iso_hdf5_failed_in("H5D__chunk_direct_read")) return true;
    return H5Dget_chunk_info_by_coord(dataset, offset, &skipped, &address, &bytes) >= 0 &&
           address == HADDR_UNDEF;
}

static iso_status find_place(iso_hdf5_file *file, hid_t dataset, const iso_hdf5_array *array,
                             const int index[3], iso_hdf5_place *place, iso_error *error) {
    uint64_t start[ISO_HDF5_AXES];
    hsize_t offset[ISO_HDF5_AXES];
    unsigned char nothing;
    iso_hdf5_chunk_start(array, index, start);
    for (int axis = 0; axis < array->rank; axis++) offset[axis] = start[axis];
    file->place = (iso_hdf5_place){0};
    file->locating = true;
    const herr_t result = H5Dread_chunk(dataset, H5P_DEFAULT, offset, &file->place.skipped, &nothing);
    file->locating = false;
    *place = result >= 0 ? file->place : (iso_hdf5_place){0};
    return result >= 0 || is_absent(dataset, offset) ? ISO_OK : iso_hdf5_fail(file, array->path, error);
}

iso_status iso_hdf5_find_places(const char *path, const iso_hdf5_array *array, const int dims[3],
                                iso_hdf5_place *places, iso_error *error) {
    iso_hdf5_file file;
    int counts[3], voxels[3], index[3];
    ISO_TRY(iso_hdf5_open(path, &file, error));
    const hid_t dataset = iso_hdf5_dataset(file.id, array->path);
    if (dataset < 0) return iso_hdf5_fail(&file, array->path, error);
    iso_hdf5_chunk_grid(array, dims, counts, voxels);
    for (index[2] = 0; index[2] < counts[2]; index[2]++)
        for (index[1] = 0; index[1] < counts[1]; index[1]++)
            for (index[0] = 0; index[0] < counts[0]; index[0]++)
                ISO_TRY(find_place(&file, dataset, array, index, places++, error));
    return ISO_OK;
}
