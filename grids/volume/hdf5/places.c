/* places: asks libhdf5 where the chunks of an array lie in the file. Runs in the child process.
 *
 * An array may have any number of chunks that are not in the file, so that only those that are can be asked
 * for. libhdf5 1.10 lists them in linear time only in the text that H5Ddebug prints; its place in the file is
 * that of a single chunk, which it finds quickly: it is asked to read the chunk, and the driver notes the
 * place instead of reading (library.c). */
#include <stdio.h>
#include <stdlib.h>

#include "grids/volume/hdf5/library.h"

/* ---- which chunks are in the file ---- */

/* A list of chunks that is being made from the text of H5Ddebug. */
typedef struct chunk_list {
    const iso_hdf5_array *array;
    int counts[3];
    iso_hdf5_place *places; /* whose numbers are set */
    uint64_t count, lines;  /* chunks that hold voxels; all chunks */
    char line[512];
    size_t length;
} chunk_list;

/* The numbers along x, y and z of the chunk whose first element is `first`. False: it holds none of the
 * voxels that are read, but those of another component. */
static bool index_of(const chunk_list *list, const uint64_t first[ISO_HDF5_AXES], int index[3]) {
    const iso_hdf5_array *array = list->array;
    for (int axis = 0; axis < array->rank; axis++) {
        const uint64_t at = first[axis] / array->chunk[axis];
        int i = 0;
        while (i < 3 && array->xyz[i] != axis) i++;
        if (i == 3 ? at != array->at[axis] / array->chunk[axis] : at >= (uint64_t)list->counts[i])
            return false;
        if (i < 3) index[i] = (int)at;
    }
    return true;
}

/* "0x00000000 512 4016 [0, 64, 128, 0]": filters that were not applied, bytes, address, the first element and
 * a byte of it. */
static void take_line(chunk_list *list) {
    uint64_t first[ISO_HDF5_AXES];
    int index[3] = {0, 0, 0};
    const char *text = list->line;
    while (*text && *text != '[') text++;
    for (int axis = 0; axis < list->array->rank; axis++) {
        if (*text != (axis ? ',' : '[')) return;
        char *end = NULL;
        first[axis] = strtoull(text + 1, &end, 10);
        text = end;
    }
    if (list->lines++ >= list->array->stored || !index_of(list, first, index)) return;
    list->places[list->count++].number =
        ((uint64_t)index[2] * (uint64_t)list->counts[1] + (uint64_t)index[1]) * (uint64_t)list->counts[0] +
        (uint64_t)index[0];
}

static ssize_t take_text(void *cookie, const char *text, size_t size) {
    chunk_list *list = cookie;
    for (size_t i = 0; i < size; i++) {
        if (text[i] != '\n') {
            if (list->length < sizeof list->line - 1) list->line[list->length++] = text[i];
            continue;
        }
        list->line[list->length] = 0;
        take_line(list);
        list->length = 0;
    }
    return (ssize_t)size;
}

static int compare_numbers(const void *a, const void *b) {
    const uint64_t first = ((const iso_hdf5_place *)a)->number, second = ((const iso_hdf5_place *)b)->number;
    return (first > second) - (first < second);
}

/* Lists the chunks in the order of their numbers. False: libhdf5 cannot list them all. */
static bool list_chunks(hid_t dataset, chunk_list *list) {
    FILE *const before = stdout;
    stdout = fopencookie(list, "w", (cookie_io_functions_t){.write = take_text});
    const bool printed = stdout && H5Ddebug(dataset) >= 0 && fclose(stdout) == 0;
    stdout = before;
    qsort(list->places, (size_t)list->count, sizeof *list->places, compare_numbers);
    return printed && list->lines == list->array->stored;
}

/* ---- where they are ---- */

static bool locate(iso_hdf5_file *file, hid_t dataset, const iso_hdf5_array *array, const int counts[3],
                   iso_hdf5_place *place) {
    const uint64_t number = place->number, columns = (uint64_t)counts[0], rows = (uint64_t)counts[1];
    const int index[3] = {(int)(number % columns), (int)(number / columns % rows),
                          (int)(number / columns / rows)};
    uint64_t start[ISO_HDF5_AXES];
    hsize_t offset[ISO_HDF5_AXES];
    unsigned char nothing;
    uint32_t skipped = 0;
    iso_hdf5_chunk_start(array, index, start);
    for (int axis = 0; axis < array->rank; axis++) offset[axis] = start[axis];
    file->place = (iso_hdf5_place){0};
    file->locating = true;
    const herr_t result = H5Dread_chunk(dataset, H5P_DEFAULT, offset, &skipped, &nothing);
    file->locating = false;
    *place = (iso_hdf5_place){number, file->place.address, file->place.bytes, skipped};
    return result >= 0 && place->bytes > 0;
}

iso_status iso_hdf5_find_places(const char *path, const iso_hdf5_array *array, const int dims[3],
                                iso_hdf5_place *places, uint64_t *count, iso_error *error) {
    iso_hdf5_file file;
    chunk_list list = {.array = array, .places = places};
    int voxels[3];
    *count = 0;
    ISO_TRY(iso_hdf5_open(path, &file, error));
    const hid_t dataset = iso_hdf5_dataset(file.id, array->path);
    iso_hdf5_chunk_grid(array, dims, list.counts, voxels);
    if (dataset < 0 || !list_chunks(dataset, &list)) return iso_hdf5_fail(&file, array->path, error);
    for (uint64_t i = 0; i < list.count; i++)
        if (!locate(&file, dataset, array, list.counts, &places[i]))
            return iso_hdf5_fail(&file, array->path, error);
    *count = list.count;
    return ISO_OK;
}
