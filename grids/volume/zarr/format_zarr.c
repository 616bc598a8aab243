/* format_zarr: reads OME-Zarr 0.4 and 0.5 and arrays of Zarr v2 and v3 and of N5 from a local
 * folder: every number type of 8 to 64 bits, both orders of memory, all codecs of codecs.h, shards.
 * Chunks are the tiles of the volume. Axes that are not of space are components. */
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "grids/volume/module.h"
#include "grids/volume/tiled.h"
#include "grids/volume/zarr/zarr.h"

/* Files of chunks that are listed for the index of a volume (NAME.isoindex), at most. */
enum { MOST_LISTED = 4096 };

/* An array, and how its axes are those of a volume. */
typedef struct zarr_volume {
    iso_zarr_image image; /* levels is 0: there is only the array */
    iso_zarr_array array;
    int level;
    char *folder;                           /* of the array */
    int space[3];                           /* the axes of x, y and z; -1: there is none, and one voxel */
    int others[ISO_ZARR_AXES], other_count; /* the others, slowest first: components */
    uint64_t components;
} zarr_volume;

static void free_volume(zarr_volume *v) {
    iso_zarr_image_free(&v->image);
    free(v->folder);
    *v = (zarr_volume){.level = 0};
}

/* ---- axes */

static const char *axis_name(const zarr_volume *v, int axis) {
    return v->image.levels ? v->image.axis_names[axis] : v->array.names[axis];
}

static int find_axis(const zarr_volume *v, const char *name) {
    for (int axis = 0; axis < v->array.axes; axis++)
        if (strcasecmp(axis_name(v, axis), name) == 0) return axis;
    return -1;
}

/* Axes named x, y and z are those of space; else the last three are z, y, x. */
static void find_space(zarr_volume *v) {
    static const char *const names[3] = {"x", "y", "z"};
    const int axes = v->array.axes;
    for (int i = 0; i < 3; i++) v->space[i] = find_axis(v, names[i]);
    if (v->space[0] < 0 || v->space[1] < 0)
        for (int i = 0; i < 3; i++) v->space[i] = axes > i ? axes - 1 - i : -1;
    v->other_count = 0;
    for (int axis = 0; axis < axes; axis++)
        if (axis != v->space[0] && axis != v->space[1] && axis != v->space[2])
            v->others[v->other_count++] = axis;
}

/* ---- opening */

/* Chooses the level of an image, whose array is read then. */
static iso_status choose_level(const char *path, const iso_volume_opts *opts, zarr_volume *v,
                               iso_error *error) {
    const int levels = v->image.levels ? v->image.levels : 1;
    bool found;
    if (opts->level < 0 || opts->level >= levels)
        return iso_fail(error, ISO_ERR_USAGE, "%s: no level %d, there %s %d (from 0)", path, opts->level,
                        levels == 1 ? "is" : "are", levels);
    v->level = opts->level;
    v->folder = strdup(v->image.levels ? v->image.paths[v->level] : path);
    if (!v->folder) return iso_fail_memory(error, path);
    ISO_TRY(iso_zarr_read_array(v->folder, opts, &v->array, &found, error));
    if (!found)
        return iso_fail(error, ISO_ERR_IO,
                        "%s: has no array (.zarray, zarr.json, or dimensions in attributes.json)", v->folder);
    if (!v->image.levels || v->image.axes == v->array.axes) return ISO_OK;
    return iso_fail(error, ISO_ERR_FORMAT, "%s: has %d axes, but its image states %d", v->folder,
                    v->array.axes, v->image.axes);
}

static iso_status count_components(const char *path, zarr_volume *v, iso_error *error) {
    v->components = 1;
    for (int i = 0; i < v->other_count; i++)
        if (__builtin_mul_overflow(v->components, v->array.shape[v->others[i]], &v->components) ||
            v->components > INT_MAX)
            return iso_fail(error, ISO_ERR_FORMAT, "%s: has too many channels and times", path);
    return ISO_OK;
}

static iso_status open_volume(const char *path, const iso_volume_opts *opts, zarr_volume *v,
                              iso_error *error) {
    bool found;
    *v = (zarr_volume){.level = 0};
    ISO_TRY(iso_zarr_read_image(path, opts, &v->image, &found, error));
    ISO_TRY(choose_level(path, opts, v, error));
    find_space(v);
    return count_components(path, v, error);
}

static uint64_t size_along(const zarr_volume *v, const uint64_t sizes[ISO_ZARR_AXES], int i) {
    return v->space[i] < 0 ? 1 : sizes[v->space[i]];
}

/* ---- header */

/* Sets spacing and origin, in mm. Axes without a unit are taken as micrometres, as microscopes write them. */
static void set_transform(const zarr_volume *v, const iso_volume_opts *opts, iso_volume_info *info) {
    const iso_zarr_image *image = &v->image;
    bool stated = image->has_scale, has_unit = true;
    for (int i = 0; i < 3; i++) {
        const int axis = v->space[i];
        if (axis >= 0 && v->array.spacing[axis] > 0) {
            info->transform.spacing[i] = v->array.spacing[axis];
            stated = true;
        }
        if (axis < 0 || !image->levels || !image->has_scale) continue;
        const double unit = image->units[axis] > 0 ? image->units[axis] : 1e-3;
        has_unit &= image->units[axis] > 0;
        info->transform.spacing[i] = image->scale[v->level][axis] * unit;
        info->transform.origin[i] = image->translation[v->level][axis] * unit;
    }
    const bool given = opts->spacing[0] > 0 && opts->spacing[1] > 0 && opts->spacing[2] > 0;
    info->unitless = !stated && !given;
    if (!stated && !given) iso_volume_note(info, "the distance of voxels is not stated: 1 mm (--spacing)");
    if (stated && !has_unit && !given)
        iso_volume_note(info, "the unit of its distances is not stated: taken as micrometres (--spacing)");
}

static void describe_codecs(const zarr_volume *v, char *text, size_t room) {
    const iso_zarr_codecs *codecs = &v->array.codecs;
    size_t used = 0;
    for (int i = 0; i < codecs->count && used < room; i++)
        used += (size_t)snprintf(text + used, room - used, "%s%s", i ? " + " : "", codecs->codec[i].name);
    if (!codecs->count) snprintf(text, room, "not compressed");
}

/* "x 512 in chunks of 64, ..", of all axes. */
static void describe_axes(const zarr_volume *v, char *text, size_t room) {
    const iso_zarr_array *array = &v->array;
    size_t used = 0;
    for (int axis = 0; axis < array->axes && used < room; axis++) {
        const char *name = axis_name(v, axis);
        char number[24];
        snprintf(number, sizeof number, "axis %d", axis);
        used += (size_t)snprintf(text + used, room - used, "%s%.20s %llu by %llu", axis ? ", " : "",
                                 *name ? name : number, (unsigned long long)array->shape[axis],
                                 (unsigned long long)array->chunk[axis]);
    }
}

static void add_item(iso_volume_info *info, const char *format, ...) {
    va_list arguments;
    if (info->item_count == ISO_VOLUME_ITEMS) return;
    va_start(arguments, format);
    vsnprintf(info->items[info->item_count++], ISO_VOLUME_TEXT, format, arguments);
    va_end(arguments);
}

static void list_levels(const zarr_volume *v, iso_volume_info *info) {
    const iso_zarr_image *image = &v->image;
    for (int level = 0; level < image->levels; level++) {
        double mm[3];
        for (int i = 0; i < 3; i++) {
            const int axis = v->space[i];
            mm[i] = axis < 0
                        ? 1
                        : image->scale[level][axis] * (image->units[axis] > 0 ? image->units[axis] : 1e-3);
        }
        add_item(info, "level %d%s: %.100s, voxels of %g x %g x %g mm", level,
                 level == v->level ? " (this one)" : "", strrchr(image->paths[level], '/') + 1, mm[0], mm[1],
                 mm[2]);
    }
}

/* Channels vary fastest among the components if they are the last of the other axes, as OME-Zarr has them. */
static void name_channels(const zarr_volume *v, iso_channels *channels) {
    const iso_channels *stated = &v->image.channels;
    const int axis = v->other_count ? v->others[v->other_count - 1] : -1;
    const bool is_channel = axis >= 0 && (strcmp(v->image.axis_types[axis], "channel") == 0 ||
                                          strcasecmp(v->image.axis_names[axis], "c") == 0);
    const uint64_t count = is_channel ? v->array.shape[axis] : 1;
    if (!channels || !stated->count || (uint64_t)stated->count > count) return;
    *channels = *stated;
    channels->count = (int)count;
}

static void describe(const zarr_volume *v, const iso_volume_opts *opts, iso_volume_info *info) {
    const iso_zarr_array *array = &v->array;
    char text[ISO_VOLUME_TEXT];
    info->type = iso_scalar_stored_type(array->scalar);
    snprintf(info->file_type, sizeof info->file_type, "%s", iso_scalar_name(array->scalar));
    snprintf(info->name, sizeof info->name, "%s", v->image.name);
    describe_axes(v, text, sizeof text);
    add_item(info, "axes in chunks: %.230s", text);
    describe_codecs(v, text, sizeof text);
    if (v->image.levels)
        add_item(info, "OME-Zarr %.20s, Zarr v%d, %.100s%s", v->image.version, array->version, text,
                 array->sharded ? ", in shards" : "");
    else if (array->n5)
        add_item(info, "an array of N5, %.100s", text);
    else
        add_item(info, "an array of Zarr v%d, %.100s%s", array->version, text,
                 array->sharded ? ", in shards" : "");
    list_levels(v, info);
    if (v->level > 0)
        iso_volume_note(info, "level %d of %d is read, not the finest, which is 0 (--level)", v->level,
                        v->image.levels);
    set_transform(v, opts, info);
}

/* Decoding: the chunk with its other components, and what its codecs need. */
static uint64_t scratch_bytes(const iso_zarr_array *array) {
    const uint64_t bytes = iso_zarr_chunk_elements(array) * iso_scalar_size(array->scalar);
    return bytes + iso_zarr_decode_room(bytes) + iso_zarr_most_encoded(array);
}

/* What one thread needs to read chunks. */
static uint64_t least_bytes(const iso_zarr_array *array) {
    return scratch_bytes(array) + iso_zarr_index_bytes(array);
}

static iso_status describe_volume(const char *path, const iso_volume_opts *opts, zarr_volume *v,
                                  iso_volume_info *info, iso_error *error) {
    uint64_t dims[3];
    for (int i = 0; i < 3; i++) dims[i] = size_along(v, v->array.shape, i);
    ISO_TRY(iso_format_dims(path, dims, info, error));
    ISO_TRY(iso_format_component(path, opts, (int)v->components, info, error));
    describe(v, opts, info);
    name_channels(v, opts->channels);
    info->bytes = info->read_bytes = iso_format_size(info->dims, iso_type_size(info->type));
    const uint64_t more = least_bytes(&v->array) + iso_zarr_chunk_elements(&v->array) * sizeof(float);
    if (__builtin_add_overflow(info->read_bytes, more, &info->read_bytes)) info->read_bytes = UINT64_MAX;
    return ISO_OK;
}

static iso_status list_files(zarr_volume *v, const iso_volume_opts *opts, iso_error *error) {
    iso_zarr_chunks *chunks;
    if (!opts->files) return ISO_OK;
    ISO_TRY(iso_zarr_chunks_create(v->folder, &v->array, opts->remote, 0, &chunks, error));
    iso_zarr_list_files(chunks, MOST_LISTED, opts->files);
    iso_zarr_chunks_destroy(chunks);
    return ISO_OK;
}

static iso_status zarr_info(const char *path, const iso_volume_opts *opts, iso_volume_info *info,
                            iso_error *error) {
    zarr_volume v;
    iso_status status = open_volume(path, opts, &v, error);
    if (status == ISO_OK) status = list_files(&v, opts, error);
    if (status == ISO_OK) status = describe_volume(path, opts, &v, info, error);
    free_volume(&v);
    return status;
}

/* ---- tiles */

/* The open array. */
typedef struct zarr_tiles {
    zarr_volume volume;
    iso_zarr_chunks *chunks;
    iso_zarr_files files; /* that exist */
    uint64_t tiles[3];    /* of the volume */
    iso_type type;
    float fill;                     /* stored value of voxels in absent chunks */
    uint64_t fixed[ISO_ZARR_AXES];  /* the component: its place on the other axes */
    uint64_t stride[ISO_ZARR_AXES]; /* elements of a decoded chunk from one to the next, by axis */
    size_t voxels;                  /* of a tile */
    size_t bytes;                   /* of a decoded chunk */
    int tile[3];
    bool swap;
} zarr_tiles;

static void index_of_chunk(const zarr_tiles *t, const int index[3], uint64_t chunk[ISO_ZARR_AXES]) {
    const zarr_volume *v = &t->volume;
    memset(chunk, 0, ISO_ZARR_AXES * sizeof *chunk);
    for (int i = 0; i < v->other_count; i++)
        chunk[v->others[i]] = t->fixed[v->others[i]] / v->array.chunk[v->others[i]];
    for (int i = 0; i < 3; i++)
        if (v->space[i] >= 0) chunk[v->space[i]] = (uint64_t)index[i];
}

/* Chunks that a file has along x, y or z. */
static uint64_t across(const zarr_volume *v, int i) {
    return size_along(v, v->array.shard, i) / size_along(v, v->array.chunk, i);
}

/* The first tile along x, from `at` on, that a shard has; the end of the shard: there is none. */
static uint64_t next_in_shard(const zarr_tiles *t, const uint64_t at[3], uint64_t side) {
    const int index[3] = {(int)at[0], (int)at[1], (int)at[2]};
    const uint64_t left = side - at[0] % side,
                   count = left < t->tiles[0] - at[0] ? left : t->tiles[0] - at[0];
    uint64_t chunk[ISO_ZARR_AXES];
    index_of_chunk(t, index, chunk);
    return at[0] + iso_zarr_next_in_shard(t->chunks, chunk, t->volume.space[0], count);
}

/* Goes from the files that exist to the tiles that they have. */
static uint64_t next_stored(void *context, uint64_t from, uint64_t end) {
    const zarr_tiles *t = context;
    const zarr_volume *v = &t->volume;
    const uint64_t *tiles = t->tiles, *files = t->files.counts,
                   side[3] = {across(v, 0), across(v, 1), across(v, 2)};
    while (from < end) {
        const uint64_t at[3] = {from % tiles[0], from / tiles[0] % tiles[1], from / tiles[0] / tiles[1]};
        const uint64_t layer = at[2] / side[2] * files[1] * files[0],
                       row = layer + at[1] / side[1] * files[0], file = row + at[0] / side[0],
                       found = iso_zarr_files_next(&t->files, file);
        const bool begins_layer = at[0] == 0 && at[1] == 0;
        uint64_t next[3] = {0, at[1], at[2]}; /* where the file that was found, or another one, may be met */
        if (found == file) {
            next[0] = v->array.sharded ? next_in_shard(t, at, side[0]) : at[0];
            if (next[0] / side[0] == at[0] / side[0] && next[0] < tiles[0]) return from + next[0] - at[0];
        } else if (found < row + files[0])
            next[0] = (found - row) * side[0];
        else if (found < layer + files[0] * files[1])
            next[1] = (found - layer) / files[0] * side[1];
        else if (!begins_layer)
            next[1] = tiles[1]; /* the next tiles along z may be in files of this layer again */
        else if (found == UINT64_MAX)
            return end;
        else
            next[2] = found / files[0] / files[1] * side[2];
        from = (next[2] * tiles[1] + next[1]) * tiles[0] + next[0];
    }
    return end;
}

static uint64_t stride_along(const zarr_tiles *t, int i) {
    return t->volume.space[i] < 0 ? 1 : t->stride[t->volume.space[i]];
}

/* Copies the component's voxels of a decoded chunk. */
static void extract(const zarr_tiles *t, const char *values, void *target) {
    const iso_zarr_array *array = &t->volume.array;
    const size_t size = iso_scalar_size(array->scalar), each = iso_type_size(t->type);
    const uint64_t step[3] = {stride_along(t, 0), stride_along(t, 1), stride_along(t, 2)};
    uint64_t first = 0;
    for (int i = 0; i < t->volume.other_count; i++) {
        const int axis = t->volume.others[i];
        first += t->fixed[axis] % array->chunk[axis] * t->stride[axis];
    }
    const int *tile = t->tile;
    const bool whole =
        step[0] == 1 && step[1] == (uint64_t)tile[0] && step[2] == (uint64_t)tile[0] * (uint64_t)tile[1];
    const int rows = whole ? 1 : tile[1], slices = whole ? 1 : tile[2];
    const size_t count = whole ? t->voxels : (size_t)tile[0];
    for (int z = 0; z < slices; z++)
        for (int y = 0; y < rows; y++) {
            const uint64_t at = first + (uint64_t)z * step[2] + (uint64_t)y * step[1];
            const iso_scalar_source source = {values + at * size, array->scalar, (int)step[0], 0, t->swap};
            const size_t row = (size_t)z * (size_t)tile[1] + (size_t)y;
            iso_scalar_convert(&source, count, t->type, (char *)target + row * (size_t)tile[0] * each);
        }
}

static iso_status read_tile(void *context, const int index[3], void *target, iso_error *error) {
    const zarr_tiles *t = context;
    uint64_t chunk[ISO_ZARR_AXES];
    bool absent;
    char *values = iso_alloc(t->bytes);
    if (!values) return iso_fail_memory(error, t->volume.folder);
    index_of_chunk(t, index, chunk);
    iso_status status = iso_zarr_read_chunk(t->chunks, chunk, values, &absent, error);
    if (status == ISO_OK && !absent)
        extract(t, values, target);
    else if (status == ISO_OK && t->files.may_all_exist)
        iso_scalar_fill(t->type, t->fill, target, t->voxels);
    else if (status == ISO_OK)
        status = iso_fail(error, ISO_ERR_IO, "%s: changed while it was read", t->volume.folder);
    iso_free(values);
    return status;
}

static void destroy_tiles(void *context) {
    zarr_tiles *t = context;
    iso_zarr_chunks_destroy(t->chunks);
    iso_zarr_files_free(&t->files);
    free_volume(&t->volume);
    free(t);
}

/* The fill value as voxels have it. It must be one of the array's type. */
static iso_status set_fill(zarr_tiles *t, iso_error *error) {
    static const double ranges[][2] = {[ISO_SCALAR_UINT8] = {0, UINT8_MAX},
                                       [ISO_SCALAR_INT8] = {INT8_MIN, INT8_MAX},
                                       [ISO_SCALAR_UINT16] = {0, UINT16_MAX},
                                       [ISO_SCALAR_INT16] = {INT16_MIN, INT16_MAX},
                                       [ISO_SCALAR_UINT32] = {0, UINT32_MAX},
                                       [ISO_SCALAR_INT32] = {INT32_MIN, INT32_MAX},
                                       [ISO_SCALAR_UINT64] = {0, 18446744073709551616.0},
                                       [ISO_SCALAR_INT64] = {-0x1p63, 0x1p63},
                                       [ISO_SCALAR_FLOAT] = {-HUGE_VAL, HUGE_VAL},
                                       [ISO_SCALAR_DOUBLE] = {-HUGE_VAL, HUGE_VAL},
                                       [ISO_SCALAR_HALF] = {-HUGE_VAL, HUGE_VAL}};
    const iso_zarr_array *array = &t->volume.array;
    const bool is_real = array->scalar >= ISO_SCALAR_FLOAT;
    const double fill = array->fill, *range = ranges[array->scalar];
    if (!(fill >= range[0] && fill <= range[1] && (is_real || fill == floor(fill))) &&
        !(isnan(fill) && is_real))
        return iso_fail(error, ISO_ERR_FORMAT, "%s: the fill_value %g is not one of its type",
                        t->volume.folder, fill);
    t->fill = (float)fill;
    return ISO_OK;
}

static void set_strides(zarr_tiles *t) {
    const iso_zarr_array *array = &t->volume.array;
    uint64_t stride = 1;
    for (int i = array->axes - 1; i >= 0; i--) {
        t->stride[array->order[i]] = stride;
        stride *= array->chunk[array->order[i]];
    }
}

/* Components count the slowest other axis last: channel c of time t is c + channels * t. */
static void set_component(zarr_tiles *t, int component) {
    uint64_t rest = (uint64_t)component;
    for (int i = t->volume.other_count - 1; i >= 0; i--) {
        const int axis = t->volume.others[i];
        t->fixed[axis] = rest % t->volume.array.shape[axis];
        rest /= t->volume.array.shape[axis];
    }
}

static iso_status list_stored(zarr_tiles *t, iso_error *error) {
    const zarr_volume *v = &t->volume;
    for (int i = 0; i < 3; i++) {
        t->files.space[i] = v->space[i];
        t->files.counts[i] = (size_along(v, v->array.shape, i) - 1) / size_along(v, v->array.shard, i) + 1;
        t->tiles[i] = (size_along(v, v->array.shape, i) - 1) / size_along(v, v->array.chunk, i) + 1;
    }
    for (int axis = 0; axis < v->array.axes; axis++)
        t->files.fixed[axis] = t->fixed[axis] / v->array.shard[axis];
    return iso_zarr_files_list(v->folder, &v->array, &t->files, error);
}

static iso_status open_tiles(const char *path, const iso_volume_opts *opts, const iso_volume_info *info,
                             zarr_tiles *t, iso_error *error) {
    zarr_volume *v = &t->volume;
    ISO_TRY(open_volume(path, opts, v, error));
    const uint64_t limit = iso_format_memory_limit(opts);
    if (v->components != (uint64_t)info->components)
        return iso_fail(error, ISO_ERR_IO, "%s: changed while it was read", path);
    for (int i = 0; i < 3; i++) {
        const uint64_t side = size_along(v, v->array.chunk, i);
        if (side > INT_MAX) return iso_fail(error, ISO_ERR_LIMIT, "%s: has too large chunks", path);
        t->tile[i] = (int)side;
    }
    ISO_TRY(iso_format_check_memory(path, opts, least_bytes(&v->array),
                                    v->array.sharded ? "a chunk and the index of its shard" : "a chunk",
                                    error));
    t->type = iso_scalar_stored_type(v->array.scalar);
    t->swap = v->array.big_endian;
    t->voxels = (size_t)t->tile[0] * (size_t)t->tile[1] * (size_t)t->tile[2];
    t->bytes = (size_t)iso_zarr_chunk_elements(&v->array) * iso_scalar_size(v->array.scalar);
    set_strides(t);
    for (int i = 0; i < 3; i++)
        if (stride_along(t, i) > INT_MAX)
            return iso_fail(error, ISO_ERR_LIMIT, "%s: has too large chunks", path);
    set_component(t, info->component);
    ISO_TRY(set_fill(t, error));
    ISO_TRY(list_stored(t, error));
    return iso_zarr_chunks_create(v->folder, &v->array, opts->remote, limit / 16, &t->chunks, error);
}

static iso_status zarr_open_tiled(const char *path, const iso_volume_opts *opts, const iso_volume_info *info,
                                  iso_tiled *tiled, iso_error *error) {
    zarr_tiles *t = calloc(1, sizeof *t);
    if (!t) return iso_fail_memory(error, path);
    const iso_status status = open_tiles(path, opts, info, t, error);
    if (status != ISO_OK) {
        destroy_tiles(t);
        return status;
    }
    *tiled = (iso_tiled){.type = t->type,
                         .scratch = scratch_bytes(&t->volume.array),
                         .read = read_tile,
                         .next_stored = next_stored,
                         .fill = t->fill,
                         .waits = opts->remote != NULL,
                         .destroy = destroy_tiles,
                         .context = t};
    for (int i = 0; i < 3; i++) {
        const uint64_t side = size_along(&t->volume, t->volume.array.shape, i);
        tiled->dims[i] = side <= INT_MAX ? (int)side : 0; /* else it changed meanwhile */
    }
    memcpy(tiled->tile, t->tile, sizeof tiled->tile);
    return ISO_OK;
}

static const iso_format format = {
    .name = "zarr", .library = "Zarr's", .info = zarr_info, .open_tiled = zarr_open_tiled};

ISO_MODULE(&format, NULL, NULL, NULL, NULL);
