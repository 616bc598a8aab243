/* format_hdf5: reads an array of an HDF5 file as a volume: a path in the file, the only array with three
 * axes, or what VTKHDF, Imaris, BigDataViewer and NeXus say. Integers of 8 to 64 bits and floats in both byte
 * orders, in one piece or in chunks that are compressed by deflate or LZF, shuffled or not. The last axis is
 * x; a fourth axis has components. */
#define _GNU_SOURCE
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/memory.h"
#include "grids/volume/hdf5/hdf5.h"
#include "grids/volume/module.h"

/* ---- what the child process finds out ---- */

/* Shared with the child, which is not trusted: a damaged file can make libhdf5 write anywhere. */
typedef struct description {
    int finished;
    iso_status status;
    iso_error error;
    iso_volume_info info;
    iso_hdf5_array array;
} description;

typedef struct describing {
    const char *path;
    const iso_volume_opts *opts;
    description *shared;
} describing;

static void describe(void *context) {
    const describing *job = context;
    description *shared = job->shared;
    shared->status = iso_hdf5_describe(job->path, job->opts, &shared->info, &shared->array, &shared->error);
}

/* The memory that libhdf5 may take: most files need a few megabytes; 32 suffice to start. */
static uint64_t child_memory(const iso_volume_opts *opts) {
    const uint64_t limit = iso_format_memory_limit(opts), least = 32u << 20, most = 1u << 30;
    return limit < least ? least : limit > most ? most : limit;
}

static void end_texts(description *d) {
    iso_volume_info *info = &d->info;
    d->error.text[sizeof d->error.text - 1] = 0;
    d->array.path[sizeof d->array.path - 1] = 0;
    info->name[sizeof info->name - 1] = info->file_type[sizeof info->file_type - 1] = 0;
    info->format[sizeof info->format - 1] = 0;
    for (int i = 0; i < ISO_VOLUME_ITEMS; i++) info->items[i][ISO_VOLUME_TEXT - 1] = 0;
    for (int i = 0; i < ISO_VOLUME_NOTES; i++) info->notes[i][ISO_VOLUME_TEXT - 1] = 0;
}

static bool has_sense(const iso_hdf5_array *array) {
    bool good = array->rank >= 3 && array->rank <= ISO_HDF5_AXES && array->scalar <= ISO_SCALAR_DOUBLE &&
                array->filter_count >= 0 && array->filter_count <= ISO_HDF5_FILTERS &&
                array->element_bytes == iso_scalar_size(array->scalar);
    for (int axis = 0; good && axis < array->rank; axis++)
        good =
            array->chunk[axis] >= 1 && array->chunk[axis] <= INT_MAX && array->at[axis] < array->sizes[axis];
    for (int i = 0; good && i < 3; i++) good = array->xyz[i] >= 0 && array->xyz[i] < array->rank;
    return good && iso_hdf5_chunk_bytes(array) <= INT_MAX;
}

static bool is_plausible(const description *d) {
    const iso_volume_info *info = &d->info;
    bool good = has_sense(&d->array) && info->type == iso_scalar_stored_type(d->array.scalar) &&
                info->item_count >= 0 && info->item_count <= ISO_VOLUME_ITEMS && info->note_count >= 0 &&
                info->note_count <= ISO_VOLUME_NOTES;
    for (int i = 0; good && i < 3; i++)
        good = info->dims[i] >= 1 && (uint64_t)info->dims[i] <= d->array.sizes[d->array.xyz[i]];
    return good;
}

/* Describes the file in a child process. Few files take more than milliseconds. */
static iso_status run_description(const char *path, const iso_volume_opts *opts, description *shared,
                                  iso_error *error) {
    enum { SECONDS = 3 };
    describing job = {path, opts, shared};
    ISO_TRY(iso_hdf5_guard(path, child_memory(opts), SECONDS, describe, &job, &shared->finished, error));
    end_texts(shared);
    if (shared->status != ISO_OK) return iso_fail(error, shared->status, "%s", shared->error.text);
    return is_plausible(shared) ? ISO_OK : iso_fail(error, ISO_ERR_IO, "%s: damaged", path);
}

/* ---- header ---- */

/* The bytes of the table of places; 0: values in one piece. UINT64_MAX: more than any memory. */
static uint64_t places_bytes(const iso_hdf5_array *array, const int dims[3]) {
    uint64_t bytes = iso_hdf5_chunk_count(array, dims);
    if (!array->chunked) return 0;
    return __builtin_mul_overflow(bytes, sizeof(iso_hdf5_place), &bytes) ? UINT64_MAX : bytes;
}

/* Beside the grid: the table of places, a chunk, and room to unpack it. */
static void measure(const iso_hdf5_array *array, iso_volume_info *info) {
    int counts[3], voxels[3];
    const uint64_t size = iso_type_size(info->type);
    iso_hdf5_chunk_grid(array, info->dims, counts, voxels);
    const uint64_t parts[] = {places_bytes(array, info->dims), iso_hdf5_chunk_room(array),
                              iso_format_size(voxels, size)};
    info->bytes = info->read_bytes = iso_format_size(info->dims, size);
    for (int i = 0; i < 3; i++)
        if (__builtin_add_overflow(info->read_bytes, parts[i], &info->read_bytes))
            info->read_bytes = UINT64_MAX;
}

static iso_status describe_file(const char *path, const iso_volume_opts *opts, iso_volume_info *info,
                                iso_hdf5_array *array, iso_error *error) {
    description *shared = iso_hdf5_share(sizeof *shared);
    if (!shared) return iso_fail_memory(error, path);
    shared->info = *info;
    iso_status status = run_description(path, opts, shared, error);
    if (status == ISO_OK) {
        *info = shared->info;
        *array = shared->array;
        measure(array, info);
    }
    iso_hdf5_unshare(shared, sizeof *shared);
    return status;
}

static iso_status hdf5_info(const char *path, const iso_volume_opts *opts, iso_volume_info *info,
                            iso_error *error) {
    iso_hdf5_array array;
    return describe_file(path, opts, info, &array, error);
}

/* ---- places ---- */

typedef struct finding {
    const iso_hdf5_source *source;
    iso_hdf5_place *places;
    description *shared;
} finding;

static void find_places(void *context) {
    const finding *job = context;
    job->shared->status = iso_hdf5_find_places(job->source->path, &job->source->array, job->source->dims,
                                               job->places, &job->shared->error);
}

/* Finds all chunks in a child process, which takes microseconds for each. */
static iso_status find_all_places(const iso_volume_opts *opts, const iso_hdf5_source *source,
                                  iso_hdf5_place *places, iso_error *error) {
    const uint64_t count = iso_hdf5_chunk_count(&source->array, source->dims), seconds = 3 + count / 10000;
    description *shared = iso_hdf5_share(sizeof *shared);
    if (!shared) return iso_fail_memory(error, source->path);
    finding job = {source, places, shared};
    iso_status status =
        iso_hdf5_guard(source->path, child_memory(opts), seconds > INT_MAX ? INT_MAX : (int)seconds,
                       find_places, &job, &shared->finished, error);
    end_texts(shared);
    if (status == ISO_OK && shared->status != ISO_OK)
        status = iso_fail(error, shared->status, "%s", shared->error.text);
    iso_hdf5_unshare(shared, sizeof *shared);
    return status;
}

/* ---- values ---- */

static void close_source(iso_hdf5_source *source) {
    iso_hdf5_unshare((void *)source->places, (size_t)places_bytes(&source->array, source->dims));
    if (source->descriptor >= 0) close(source->descriptor);
}

/* Opens the file that `info` describes. Close with close_source, also after an error. */
static iso_status open_source(const char *path, const iso_volume_opts *opts, const iso_volume_info *info,
                              iso_hdf5_source *source, iso_error *error) {
    iso_volume_info now = {.components = 1, .scale = 1, .transform = iso_transform_identity()};
    struct stat status;
    *source = (iso_hdf5_source){.path = path, .descriptor = -1};
    ISO_TRY(describe_file(path, opts, &now, &source->array, error));
    if (memcmp(now.dims, info->dims, sizeof now.dims) != 0 || now.type != info->type ||
        now.components != info->components || now.read_bytes > info->read_bytes)
        return iso_fail(error, ISO_ERR_IO, "%s: changed while it was read", path);
    memcpy(source->dims, info->dims, sizeof source->dims);
    iso_hdf5_chunk_grid(&source->array, source->dims, source->counts, source->voxels);
    source->descriptor = open(path, O_RDONLY | O_CLOEXEC);
    if (source->descriptor < 0 || fstat(source->descriptor, &status) != 0)
        return iso_fail(error, ISO_ERR_IO, "%s: cannot read: %s", path, strerror(errno));
    source->file_bytes = (uint64_t)status.st_size;
    const uint64_t bytes = places_bytes(&source->array, source->dims);
    if (bytes == 0) return ISO_OK;
    iso_hdf5_place *places = iso_hdf5_share((size_t)bytes);
    source->places = places;
    return places ? find_all_places(opts, source, places, error) : iso_fail_memory(error, path);
}

/* Copies the voxels of a chunk that are in the volume. */
static void copy_chunk(const iso_hdf5_source *source, const int index[3], const char *chunk,
                       iso_rgrid *grid) {
    const size_t size = iso_type_size(grid->type);
    int first[3], count[3];
    for (int i = 0; i < 3; i++) {
        first[i] = index[i] * source->voxels[i];
        count[i] =
            source->dims[i] - first[i] < source->voxels[i] ? source->dims[i] - first[i] : source->voxels[i];
    }
    for (int z = 0; z < count[2]; z++)
        for (int y = 0; y < count[1]; y++) {
            const size_t from =
                ((size_t)z * (size_t)source->voxels[1] + (size_t)y) * (size_t)source->voxels[0];
            const size_t to = ((size_t)(first[2] + z) * (size_t)source->dims[1] + (size_t)(first[1] + y)) *
                                  (size_t)source->dims[0] +
                              (size_t)first[0];
            memcpy((char *)grid->data + to * size, chunk + from * size, (size_t)count[0] * size);
        }
}

static iso_status read_chunks(const iso_hdf5_source *source, const iso_volume_opts *opts, void *room,
                              void *chunk, iso_rgrid *grid, iso_error *error) {
    const int *counts = source->counts;
    int index[3];
    for (index[2] = 0; index[2] < counts[2]; index[2]++) {
        for (index[1] = 0; index[1] < counts[1]; index[1]++)
            for (index[0] = 0; index[0] < counts[0]; index[0]++) {
                ISO_TRY(iso_hdf5_read_chunk(source, index, room, chunk, error));
                copy_chunk(source, index, chunk, grid);
            }
        ISO_TRY(iso_format_progress(source->path, opts, (index[2] + 1.0) / counts[2], error));
    }
    return ISO_OK;
}

static iso_status hdf5_read(const char *path, const iso_volume_opts *opts, iso_volume_info *info,
                            iso_grid *grid, iso_error *error) {
    iso_hdf5_source source;
    void *room = NULL, *chunk = NULL;
    iso_status status = open_source(path, opts, info, &source, error);
    if (status == ISO_OK) {
        room = iso_alloc((size_t)iso_hdf5_chunk_room(&source.array));
        chunk = iso_alloc((size_t)iso_format_size(source.voxels, iso_type_size(info->type)));
        if (!room || !chunk) status = iso_fail_memory(error, path);
    }
    if (status == ISO_OK) status = iso_format_create(path, info, NULL, grid, error);
    if (status == ISO_OK) status = read_chunks(&source, opts, room, chunk, grid->rgrid, error);
    iso_free(room);
    iso_free(chunk);
    close_source(&source);
    return status;
}

static const iso_format format_hdf5 = {
    .name = "hdf5", .library = "libhdf5", .info = hdf5_info, .read = hdf5_read};
ISO_MODULE(&format_hdf5, NULL, NULL);
