/* format_hdf5: reads an array of an HDF5 file as a volume: a path in the file, the only array with three
 * axes, or what VTKHDF, Imaris, BigDataViewer and NeXus say. Integers of up to 64 bits and floats of 16, 32
 * and 64 in both byte orders, in one piece or in chunks, through the filters that chunk.c or libhdf5 undo.
 * The last axis is x; a fourth axis has components. */
#include <limits.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/file.h"
#include "base/memory.h"
#include "grids/volume/hdf5/hdf5.h"
#include "grids/volume/module.h"
#include "grids/volume/rectilinear.h"
#include "grids/volume/tiled.h"

/* ---- files ---- */

/* The HDF5 file, and the .xml of BigDataViewer that belongs to it or NULL. */
typedef struct hdf5_paths {
    char *file, *xml;
} hdf5_paths;

static void free_paths(hdf5_paths *paths) {
    free(paths->file);
    free(paths->xml);
    *paths = (hdf5_paths){NULL, NULL};
}

/* "data.xml" beside "data.h5", if it says that its images are in this file; NULL: there is none. */
static char *find_xml(const char *file) {
    const char *slash = strrchr(file, '/'), *dot = strrchr(slash ? slash : file, '.');
    char *xml = NULL, *images = NULL;
    if (asprintf(&xml, "%.*s.xml", (int)(dot ? (size_t)(dot - file) : strlen(file)), file) < 0) return NULL;
    const bool belongs = access(xml, F_OK) == 0 && iso_bdv_is_xml(xml) &&
                         iso_bdv_file(xml, &images, NULL) == ISO_OK && iso_file_same(images, file);
    free(images);
    if (belongs) return xml;
    free(xml);
    return NULL;
}

/* free_paths when done, also after an error. */
static iso_status find_paths(const char *path, const iso_volume_opts *opts, hdf5_paths *paths,
                             iso_error *error) {
    *paths = (hdf5_paths){NULL, NULL};
    if (iso_bdv_is_xml(path)) {
        paths->xml = strdup(path);
        ISO_TRY(iso_bdv_file(path, &paths->file, error));
        ISO_TRY(iso_format_file_bytes(paths->file, &(uint64_t){0}, error)); /* it is a regular file */
    } else {
        paths->file = strdup(path);
        paths->xml = find_xml(path);
    }
    if (!paths->file) return iso_fail_memory(error, path);
    iso_file_set_read(opts->files, paths->file);
    if (paths->xml) iso_file_set_read(opts->files, paths->xml);
    return ISO_OK;
}

/* ---- what the child process finds out ---- */

/* Shared with the child, which is not trusted: a damaged file can make libhdf5 write anywhere. */
typedef struct description {
    int finished;
    iso_status status;
    iso_error error;
    iso_volume_info info;
    iso_hdf5_array array;
    iso_hdf5_slices slices;
    iso_hdf5_positions positions;
    iso_channels channels;
    uint64_t place_count;
} description;

typedef struct describing {
    const char *path, *xml;
    const iso_volume_opts *opts;
    description *shared;
} describing;

static void describe(void *context) {
    const describing *job = context;
    description *shared = job->shared;
    iso_volume_opts opts = *job->opts;
    opts.channels = &shared->channels;
    shared->status = iso_hdf5_describe(job->path, job->xml, &opts, &shared->info, &shared->array,
                                       &shared->slices, &shared->positions, &shared->error);
}

/* The memory that libhdf5 may take: most files need a few megabytes; 32 suffice to start. */
static uint64_t child_memory(const iso_volume_opts *opts) {
    const uint64_t limit = iso_format_memory_limit(opts), least = 32u << 20, most = 1u << 30;
    return limit < least ? least : limit > most ? most : limit;
}

static void end_texts(description *d) {
    iso_volume_info *info = &d->info;
    d->error.text[sizeof d->error.text - 1] = 0;
    d->array.path[sizeof d->array.path - 1] = d->array.special[sizeof d->array.special - 1] = 0;
    info->name[sizeof info->name - 1] = info->file_type[sizeof info->file_type - 1] = 0;
    info->format[sizeof info->format - 1] = 0;
    for (int i = 0; i < ISO_CHANNELS; i++) d->channels.items[i].name[ISO_CHANNEL_NAME - 1] = 0;
    for (int i = 0; i < ISO_VOLUME_ITEMS; i++) info->items[i][ISO_VOLUME_TEXT - 1] = 0;
    for (int i = 0; i < ISO_VOLUME_NOTES; i++) info->notes[i][ISO_VOLUME_TEXT - 1] = 0;
}

static bool has_sense(const iso_hdf5_array *array) {
    bool good = array->rank >= 3 && array->rank <= ISO_HDF5_AXES && array->scalar <= ISO_SCALAR_HALF &&
                array->filter_count >= 0 && array->filter_count <= ISO_HDF5_FILTERS &&
                array->element_bytes == iso_scalar_size(array->scalar);
    for (int axis = 0; good && axis < array->rank; axis++)
        good =
            array->chunk[axis] >= 1 && array->chunk[axis] <= INT_MAX && array->at[axis] < array->sizes[axis];
    uint64_t bytes = array->element_bytes; /* of values in one piece */
    for (int axis = 0; good && !array->chunked && axis < array->rank; axis++)
        good = !__builtin_mul_overflow(bytes, array->sizes[axis], &bytes);
    for (int i = 0; good && i < 3; i++) good = array->xyz[i] >= 0 && array->xyz[i] < array->rank;
    return good && iso_hdf5_chunk_bytes(array) <= INT_MAX;
}

static bool is_plausible(const description *d) {
    const iso_volume_info *info = &d->info;
    const iso_type type = d->slices.count ? ISO_FLOAT32 : iso_scalar_stored_type(d->array.scalar);
    bool good = has_sense(&d->array) && info->type == type &&
                (d->slices.count == 0 || d->slices.count == info->dims[2]) &&
                d->slices.count <= ISO_HDF5_SLICES && info->item_count >= 0 &&
                info->item_count <= ISO_VOLUME_ITEMS && info->note_count >= 0 &&
                info->note_count <= ISO_VOLUME_NOTES && d->channels.count >= 0;
    for (int i = 0; good && i < 3; i++)
        good = info->dims[i] >= 1 && (uint64_t)info->dims[i] <= d->array.sizes[d->array.xyz[i]] &&
               (d->positions.count[i] == 0 ||
                (d->positions.count[i] == info->dims[i] && d->positions.count[i] <= ISO_HDF5_POSITIONS));
    return good;
}

/* Processor time for a description: most files take milliseconds. In files of many gigabytes the chunks that
 * are there have to be counted, a million in a tenth of a second. */
static int seconds_for(const char *path) {
    struct stat status;
    const off_t more = stat(path, &status) == 0 ? status.st_size >> 30 : 0;
    return 3 + (more < 60 ? (int)more : 60);
}

/* Describes the file in a child process. */
static iso_status run_description(const hdf5_paths *paths, const iso_volume_opts *opts, description *shared,
                                  iso_error *error) {
    const char *path = paths->file;
    describing job = {path, paths->xml, opts, shared};
    ISO_TRY(iso_hdf5_guard(path, child_memory(opts), seconds_for(path), describe, &job, &shared->finished,
                           error));
    end_texts(shared);
    if (shared->status != ISO_OK) return iso_fail(error, shared->status, "%s", shared->error.text);
    return is_plausible(shared) ? ISO_OK : iso_fail(error, ISO_ERR_IO, "%s: damaged", path);
}

/* ---- header ---- */

/* The bytes of the table of places; 0: values in one piece, or no chunk is in the file. UINT64_MAX: more than
 * any memory. */
static uint64_t places_bytes(const iso_hdf5_array *array) {
    uint64_t bytes;
    if (!array->chunked) return 0;
    return __builtin_mul_overflow(array->stored, sizeof(iso_hdf5_place), &bytes) ? UINT64_MAX : bytes;
}

/* Beside the grid: the table of places, a chunk, and room to unpack it, here and in libhdf5. */
static void measure(const iso_hdf5_array *array, iso_volume_info *info) {
    int counts[3], voxels[3];
    const uint64_t size = iso_type_size(info->type);
    iso_hdf5_chunk_grid(array, info->dims, counts, voxels);
    const uint64_t parts[] = {places_bytes(array), iso_hdf5_chunk_room(array),
                              array->by_library ? iso_hdf5_decoder_bytes(array) : 0,
                              iso_format_size(voxels, size)};
    info->bytes = info->read_bytes = iso_format_size(info->dims, size);
    for (size_t i = 0; i < sizeof parts / sizeof *parts; i++)
        if (__builtin_add_overflow(info->read_bytes, parts[i], &info->read_bytes))
            info->read_bytes = UINT64_MAX;
}

static iso_status take_positions(const char *path, const iso_hdf5_positions *positions, iso_rectilinear *axes,
                                 iso_error *error) {
    for (int i = 0; i < 3; i++) {
        const size_t bytes = (size_t)positions->count[i] * sizeof(double);
        if (bytes == 0) continue;
        axes->axis[i] = iso_alloc(bytes);
        if (!axes->axis[i]) return iso_fail_memory(error, path);
        memcpy(axes->axis[i], positions->at[i], bytes);
        axes->count[i] = positions->count[i];
    }
    return ISO_OK;
}

/* *slices (may be NULL): a copy of the scales of slices (free); NULL: there are none. `axes` (may be
 * NULL): those that are not evenly spaced. */
static iso_status describe_file(const hdf5_paths *paths, const iso_volume_opts *opts, iso_volume_info *info,
                                iso_hdf5_array *array, iso_rectilinear *axes, iso_hdf5_slices **slices,
                                iso_error *error) {
    const char *path = paths->file;
    description *shared = iso_hdf5_share(sizeof *shared);
    if (!shared) return iso_fail_memory(error, path);
    shared->info = *info;
    iso_status status = run_description(paths, opts, shared, error);
    if (status == ISO_OK) {
        *info = shared->info;
        *array = shared->array;
        if (opts->channels) *opts->channels = shared->channels;
        measure(array, info);
    }
    if (status == ISO_OK && axes) status = take_positions(path, &shared->positions, axes, error);
    if (status == ISO_OK && slices && shared->slices.count) {
        *slices = malloc(sizeof **slices);
        if (*slices)
            **slices = shared->slices;
        else
            status = iso_fail_memory(error, path);
    }
    iso_hdf5_unshare(shared, sizeof *shared);
    return status;
}

static iso_status hdf5_info(const char *path, const iso_volume_opts *opts, iso_volume_info *info,
                            iso_error *error) {
    iso_hdf5_array array;
    hdf5_paths paths;
    iso_status status = find_paths(path, opts, &paths, error);
    if (status == ISO_OK) status = describe_file(&paths, opts, info, &array, opts->axes, NULL, error);
    free_paths(&paths);
    return status;
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
                                               job->places, &job->shared->place_count, &job->shared->error);
}

/* Whether the numbers ascend and are those of chunks. The child, which is not trusted, has sorted them. */
static bool are_places(const iso_hdf5_source *source, const iso_hdf5_place *places, uint64_t count) {
    const uint64_t all = iso_hdf5_chunk_count(&source->array, source->dims);
    bool good = count <= source->array.stored && (count == 0 || places[count - 1].number < all);
    for (uint64_t i = 1; good && i < count; i++) good = places[i - 1].number < places[i].number;
    return good;
}

/* Finds the chunks that are in the file in a child process, which takes microseconds for each. */
static iso_status find_all_places(const iso_volume_opts *opts, iso_hdf5_source *source,
                                  iso_hdf5_place *places, iso_error *error) {
    const uint64_t seconds = 3 + source->array.stored / 10000;
    description *shared = iso_hdf5_share(sizeof *shared);
    if (!shared) return iso_fail_memory(error, source->path);
    finding job = {source, places, shared};
    iso_status status =
        iso_hdf5_guard(source->path, child_memory(opts), seconds > INT_MAX ? INT_MAX : (int)seconds,
                       find_places, &job, &shared->finished, error);
    end_texts(shared);
    if (status == ISO_OK && shared->status != ISO_OK)
        status = iso_fail(error, shared->status, "%s", shared->error.text);
    if (status == ISO_OK && !are_places(source, places, shared->place_count))
        status = iso_fail(error, ISO_ERR_IO, "%s: damaged: the index of the chunks of %s", source->path,
                          source->array.path);
    source->place_count = status == ISO_OK ? shared->place_count : 0;
    iso_hdf5_unshare(shared, sizeof *shared);
    return status;
}

/* ---- tiles ---- */

/* An open array. The memory in which chunks are unpacked is used again: `rooms` are those that no thread
 * uses, each of which begins with the address of the next one. */
typedef struct hdf5_tiles {
    iso_hdf5_source source;
    hdf5_paths paths;
    pthread_mutex_t lock;
    void *rooms;
} hdf5_tiles;

static void destroy_tiles(void *context) {
    hdf5_tiles *tiles = context;
    iso_hdf5_source *source = &tiles->source;
    iso_hdf5_decoder_destroy(source->decoder);
    iso_hdf5_unshare((void *)(uintptr_t)source->places, (size_t)places_bytes(&source->array));
    if (source->descriptor >= 0) close(source->descriptor);
    for (void *room = tiles->rooms, *next; room; room = next) {
        memcpy(&next, room, sizeof next);
        iso_free(room);
    }
    pthread_mutex_destroy(&tiles->lock);
    free(source->slices);
    free_paths(&tiles->paths);
    free(tiles);
}

static iso_status open_places(const iso_volume_opts *opts, iso_hdf5_source *source, iso_error *error) {
    const uint64_t bytes = places_bytes(&source->array);
    if (bytes == 0) return ISO_OK;
    ISO_TRY(iso_format_check_memory(source->path, opts, bytes, "the places of its chunks", error));
    iso_hdf5_place *places = iso_hdf5_share((size_t)bytes);
    source->places = places;
    return places ? find_all_places(opts, source, places, error) : iso_fail_memory(error, source->path);
}

static iso_status open_decoder(const iso_volume_opts *opts, iso_hdf5_source *source, iso_error *error) {
    if (!source->array.by_library) return ISO_OK;
    ISO_TRY(iso_format_check_memory(source->path, opts, iso_hdf5_decoder_bytes(&source->array),
                                    "a chunk that libhdf5 decodes", error));
    source->decode = iso_hdf5_decode_chunk;
    return iso_hdf5_decoder_create(source, &source->decoder, error);
}

/* What is not in the file has one value, which slices with scales of their own would make different ones. */
static iso_status check_slices(const iso_hdf5_source *source, iso_error *error) {
    const uint64_t all = iso_hdf5_chunk_count(&source->array, source->dims);
    const bool complete = source->array.chunked ? source->place_count == all : source->array.allocated;
    if (!source->slices || complete) return ISO_OK;
    return iso_fail(error, ISO_ERR_UNSUPPORTED,
                    "%s: its slices have scales of their own, and some are not in the file", source->path);
}

/* Opens the file that `info` describes. */
static iso_status open_source(const iso_volume_opts *opts, const iso_volume_info *info, hdf5_tiles *tiles,
                              iso_error *error) {
    iso_volume_info now = {.components = 1, .scale = 1, .transform = iso_transform_identity()};
    iso_hdf5_source *source = &tiles->source;
    ISO_TRY(describe_file(&tiles->paths, opts, &now, &source->array, NULL, &source->slices, error));
    if (memcmp(now.dims, info->dims, sizeof now.dims) != 0 || now.type != info->type ||
        now.components != info->components || now.read_bytes > info->read_bytes)
        return iso_fail(error, ISO_ERR_IO, "%s: changed while it was read", tiles->paths.file);
    memcpy(source->dims, info->dims, sizeof source->dims);
    iso_hdf5_chunk_grid(&source->array, source->dims, source->counts, source->voxels);
    ISO_TRY(iso_file_descriptor(tiles->paths.file, &source->descriptor, &source->file_bytes, error));
    ISO_TRY(open_places(opts, source, error));
    ISO_TRY(check_slices(source, error));
    return open_decoder(opts, source, error);
}

static void *take_room(hdf5_tiles *tiles) {
    pthread_mutex_lock(&tiles->lock);
    void *room = tiles->rooms;
    if (room) memcpy(&tiles->rooms, room, sizeof tiles->rooms);
    pthread_mutex_unlock(&tiles->lock);
    return room ? room : iso_alloc((size_t)iso_hdf5_chunk_room(&tiles->source.array));
}

static void give_room(hdf5_tiles *tiles, void *room) {
    pthread_mutex_lock(&tiles->lock);
    memcpy(room, &tiles->rooms, sizeof tiles->rooms);
    tiles->rooms = room;
    pthread_mutex_unlock(&tiles->lock);
}

static iso_status read_tile(void *context, const int index[3], void *target, iso_error *error) {
    hdf5_tiles *tiles = context;
    void *room = take_room(tiles);
    if (!room) return iso_fail_memory(error, tiles->paths.file);
    const iso_status status = iso_hdf5_read_chunk(&tiles->source, index, room, target, error);
    give_room(tiles, room);
    return status;
}

static uint64_t next_stored(void *context, uint64_t from, uint64_t end) {
    const hdf5_tiles *tiles = context;
    (void)end;
    return iso_hdf5_next_stored(&tiles->source, from);
}

static iso_status hdf5_open_tiled(const char *path, const iso_volume_opts *opts, const iso_volume_info *info,
                                  iso_tiled *tiled, iso_error *error) {
    hdf5_tiles *tiles = calloc(1, sizeof *tiles);
    if (!tiles) return iso_fail_memory(error, path);
    pthread_mutex_init(&tiles->lock, NULL);
    tiles->source = (iso_hdf5_source){.descriptor = -1};
    iso_status status = find_paths(path, opts, &tiles->paths, error);
    tiles->source.path = tiles->paths.file;
    if (status == ISO_OK) status = open_source(opts, info, tiles, error);
    if (status != ISO_OK) {
        destroy_tiles(tiles);
        return status;
    }
    *tiled = (iso_tiled){.type = info->type,
                         .scratch = iso_hdf5_chunk_room(&tiles->source.array),
                         .read = read_tile,
                         .next_stored = next_stored,
                         .fill = iso_hdf5_fill_value(&tiles->source.array),
                         .destroy = destroy_tiles,
                         .context = tiles};
    memcpy(tiled->dims, tiles->source.dims, sizeof tiled->dims);
    memcpy(tiled->tile, tiles->source.voxels, sizeof tiled->tile);
    return ISO_OK;
}

/* ---- coordinates that another format's file names ---- */

/* Shared with the child. */
typedef struct found_numbers {
    int finished;
    iso_status status;
    iso_error error;
    double numbers[];
} found_numbers;

typedef struct finding_numbers {
    const char *path, *array;
    uint64_t count;
    found_numbers *shared;
} finding_numbers;

static void find_numbers(void *context) {
    const finding_numbers *job = context;
    job->shared->status =
        iso_hdf5_read_numbers(job->path, job->array, job->count, job->shared->numbers, &job->shared->error);
}

static iso_status read_numbers(const char *path, const char *array, const iso_volume_opts *opts,
                               uint64_t count, double *numbers, iso_error *error) {
    const size_t bytes = sizeof(found_numbers) + (size_t)count * sizeof *numbers;
    found_numbers *shared = iso_hdf5_share(bytes);
    if (!shared) return iso_fail_memory(error, path);
    finding_numbers job = {path, array, count, shared};
    iso_status status = iso_hdf5_guard(path, child_memory(opts), seconds_for(path), find_numbers, &job,
                                       &shared->finished, error);
    shared->error.text[sizeof shared->error.text - 1] = 0;
    if (status == ISO_OK && shared->status != ISO_OK)
        status = iso_fail(error, shared->status, "%s", shared->error.text);
    if (status == ISO_OK) memcpy(numbers, shared->numbers, (size_t)count * sizeof *numbers);
    iso_hdf5_unshare(shared, bytes);
    return status;
}

static const iso_format format_hdf5 = {
    .name = "hdf5", .library = "libhdf5", .info = hdf5_info, .open_tiled = hdf5_open_tiled};

ISO_MODULE_EXTERN const iso_module iso_module_table;
const iso_module iso_module_table = {
    .abi = ISO_MODULE_ABI, .version = ISO_VERSION, .format = &format_hdf5, .read_numbers = read_numbers};
