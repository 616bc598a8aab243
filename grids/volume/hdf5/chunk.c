/* chunk: reads chunks of an array, undoes their filters, and converts their values to voxels. Without
 * libhdf5: the places of the chunks are known. (Values that libhdf5 decodes come from decoder.c.) */
#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "grids/volume/codecs.h"
#include "grids/volume/hdf5/hdf5.h"

/* ---- which chunks ---- */

void iso_hdf5_chunk_grid(const iso_hdf5_array *array, const int dims[3], int counts[3], int voxels[3]) {
    for (int i = 0; i < 3; i++) {
        const uint64_t size = array->chunk[array->xyz[i]], dim = (uint64_t)dims[i];
        voxels[i] = size < dim ? (int)size : (int)dim;
        counts[i] = (int)((dim - 1) / size + 1);
    }
}

uint64_t iso_hdf5_chunk_count(const iso_hdf5_array *array, const int dims[3]) {
    int counts[3], voxels[3];
    iso_hdf5_chunk_grid(array, dims, counts, voxels);
    return iso_format_size(counts, 1);
}

void iso_hdf5_chunk_start(const iso_hdf5_array *array, const int index[3], uint64_t start[ISO_HDF5_AXES]) {
    for (int axis = 0; axis < array->rank; axis++)
        start[axis] = array->at[axis] / array->chunk[axis] * array->chunk[axis];
    for (int i = 0; i < 3; i++) start[array->xyz[i]] = (uint64_t)index[i] * array->chunk[array->xyz[i]];
}

uint64_t iso_hdf5_chunk_bytes(const iso_hdf5_array *array) {
    uint64_t bytes = iso_scalar_size(array->scalar);
    for (int axis = 0; axis < array->rank; axis++)
        if (__builtin_mul_overflow(bytes, array->chunk[axis], &bytes)) return UINT64_MAX;
    return bytes;
}

/* Filters may make a chunk a little larger. */
static uint64_t largest_chunk(uint64_t bytes) {
    return bytes + bytes / 64 + 1024;
}

uint64_t iso_hdf5_chunk_room(const iso_hdf5_array *array) {
    const uint64_t bytes = iso_hdf5_chunk_bytes(array);
    return bytes > UINT64_MAX / 4 ? UINT64_MAX : 2 * largest_chunk(bytes);
}

/* ---- messages ---- */

void iso_hdf5_name_chunk(const iso_hdf5_array *array, const int index[3], char text[ISO_HDF5_CHUNK_NAME]) {
    uint64_t start[ISO_HDF5_AXES];
    int length = snprintf(text, ISO_HDF5_CHUNK_NAME, "%.160s, the chunk at ", array->path);
    iso_hdf5_chunk_start(array, index, start);
    for (int axis = 0; axis < array->rank && length < ISO_HDF5_CHUNK_NAME; axis++)
        length += snprintf(text + length, ISO_HDF5_CHUNK_NAME - (size_t)length, "%s%" PRIu64, axis ? "," : "",
                           start[axis]);
}

static iso_status fail_chunk(const iso_hdf5_source *source, const int index[3], const char *reason,
                             iso_error *error) {
    char name[ISO_HDF5_CHUNK_NAME];
    iso_hdf5_name_chunk(&source->array, index, name);
    return iso_fail(error, ISO_ERR_IO, "%s: %s: %s", source->path, name, reason);
}

/* ---- filters ---- */

/* A buffer of bytes that are unpacked into another one. */
typedef struct piece {
    unsigned char *data;
    size_t bytes;
} piece;

static bool undo_codec(iso_codec codec, const piece *from, piece *to, size_t room, size_t element) {
    iso_coded coded = {from->data, from->bytes, to->data, room, element, 0};
    if (iso_codec_undo(codec, &coded)) return false;
    to->bytes = coded.got;
    return true;
}

/* Fletcher's checksum as HDF5 computes it: of big-endian words of 16 bits. */
static uint32_t fletcher32(const unsigned char *data, size_t bytes) {
    uint64_t first = 0, second = 0;
    for (size_t i = 0; i < bytes; i += 2) {
        first += (uint64_t)data[i] << 8 | (i + 1 < bytes ? data[i + 1] : 0);
        first = (first & 0xffff) + (first >> 16);
        second += first;
        second = (second & 0xffff) + (second >> 16);
    }
    first = (first & 0xffff) + (first >> 16);
    second = (second & 0xffff) + (second >> 16);
    return (uint32_t)(second << 16 | first);
}

/* The checksum follows the values, little-endian. */
static bool undo_fletcher32(const piece *from, piece *to) {
    if (from->bytes < 4) return false;
    const size_t bytes = from->bytes - 4;
    const unsigned char *sum = from->data + bytes;
    const uint32_t stored =
        (uint32_t)sum[0] | (uint32_t)sum[1] << 8 | (uint32_t)sum[2] << 16 | (uint32_t)sum[3] << 24;
    if (stored != fletcher32(from->data, bytes)) return false;
    memcpy(to->data, from->data, bytes);
    to->bytes = bytes;
    return true;
}

/* LZF: runs of up to 32 bytes as they are, and copies of up to 264 bytes from up to 8 KiB before. */
static bool undo_lzf(const piece *from, piece *to, size_t room) {
    const unsigned char *in = from->data, *end = in + from->bytes;
    size_t out = 0;
    while (in < end) {
        const unsigned control = *in++;
        if (control < 32) {
            const size_t run = control + 1;
            if (run > (size_t)(end - in) || run > room - out) return false;
            memcpy(to->data + out, in, run);
            in += run;
            out += run;
            continue;
        }
        size_t length = control >> 5;
        if (length == 7) {
            if (in == end) return false;
            length += *in++;
        }
        if (in == end) return false;
        const size_t distance = ((size_t)(control & 31) << 8 | *in++) + 1;
        length += 2;
        if (distance > out || length > room - out) return false;
        for (size_t i = 0; i < length; i++, out++) to->data[out] = to->data[out - distance];
    }
    to->bytes = out;
    return true;
}

static bool codec_of_filter(int filter, iso_codec *codec) {
    static const struct {
        int filter;
        iso_codec codec;
    } codecs[] = {{ISO_HDF5_DEFLATE, ISO_CODEC_ZLIB},   {ISO_HDF5_SHUFFLE, ISO_CODEC_SHUFFLE},
                  {ISO_HDF5_BZIP2, ISO_CODEC_BZIP2},    {ISO_HDF5_BLOSC, ISO_CODEC_BLOSC},
                  {ISO_HDF5_LZ4, ISO_CODEC_LZ4_BLOCKS}, {ISO_HDF5_ZSTD, ISO_CODEC_ZSTD}};
    for (size_t i = 0; i < sizeof codecs / sizeof *codecs; i++)
        if (codecs[i].filter == filter) {
            *codec = codecs[i].codec;
            return iso_codec_is_built_in(*codec);
        }
    return false;
}

bool iso_hdf5_knows_filter(int filter) {
    iso_codec codec;
    return filter == ISO_HDF5_FLETCHER32 || filter == ISO_HDF5_LZF || codec_of_filter(filter, &codec);
}

static bool undo_filter(const iso_hdf5_array *array, int filter, const piece *from, piece *to, size_t room) {
    iso_codec codec;
    if (filter == ISO_HDF5_FLETCHER32) return undo_fletcher32(from, to);
    if (filter == ISO_HDF5_LZF) return undo_lzf(from, to, room);
    return codec_of_filter(filter, &codec) && undo_codec(codec, from, to, room, (size_t)array->element_bytes);
}

/* Undoes the filters of a chunk, the last one first; `now` has the chunk as it is stored, and then its
 * values. */
static bool undo_filters(const iso_hdf5_array *array, uint32_t skipped, piece *now, piece *other,
                         size_t room) {
    for (int i = array->filter_count - 1; i >= 0; i--) {
        if (skipped >> i & 1) continue;
        if (!undo_filter(array, array->filters[i], now, other, room)) return false;
        const piece swap = *now;
        *now = *other;
        *other = swap;
    }
    return true;
}

/* ---- reading ---- */

static uint64_t number_of(const iso_hdf5_source *source, const int index[3]) {
    return ((uint64_t)index[2] * (uint64_t)source->counts[1] + (uint64_t)index[1]) *
               (uint64_t)source->counts[0] +
           (uint64_t)index[0];
}

/* The first place from this number on; NULL: there is none. */
static const iso_hdf5_place *find_place(const iso_hdf5_source *source, uint64_t number) {
    uint64_t begin = 0, end = source->place_count;
    while (begin < end) {
        const uint64_t middle = begin + (end - begin) / 2;
        if (source->places[middle].number < number)
            begin = middle + 1;
        else
            end = middle;
    }
    return begin < source->place_count ? &source->places[begin] : NULL;
}

uint64_t iso_hdf5_next_stored(const iso_hdf5_source *source, uint64_t from) {
    if (!source->array.chunked) return source->array.allocated ? from : UINT64_MAX;
    const iso_hdf5_place *place = find_place(source, from);
    return place ? place->number : UINT64_MAX;
}

static iso_status read_bytes(const iso_hdf5_source *source, const int index[3], uint64_t address,
                             uint64_t bytes, unsigned char *target, iso_error *error) {
    if (address > source->file_bytes || bytes > source->file_bytes - address)
        return fail_chunk(source, index, "truncated: it lies beyond the end of the file", error);
    for (uint64_t done = 0; done < bytes;) {
        const ssize_t got =
            pread(source->descriptor, target + done, (size_t)(bytes - done), (off_t)(address + done));
        if (got < 0 && errno == EINTR) continue;
        if (got < 0) return fail_chunk(source, index, strerror(errno), error);
        if (got == 0) return fail_chunk(source, index, "truncated", error);
        done += (uint64_t)got;
    }
    return ISO_OK;
}

/* A box of an array whose values are in one piece. Inner axes that it covers whole make up one run of bytes
 * together with the axis before them. */
typedef struct box {
    uint64_t start[ISO_HDF5_AXES], count[ISO_HDF5_AXES];
    uint64_t file_step[ISO_HDF5_AXES], chunk_step[ISO_HDF5_AXES]; /* bytes */
    int first_in_run;                                             /* axis */
    uint64_t run_bytes;
} box;

static box find_box(const iso_hdf5_array *array, const int index[3]) {
    box b = {.first_in_run = array->rank - 1};
    uint64_t file_step = iso_scalar_size(array->scalar), chunk_step = file_step;
    iso_hdf5_chunk_start(array, index, b.start);
    for (int axis = array->rank - 1; axis >= 0; axis--) {
        const uint64_t left = array->sizes[axis] - b.start[axis];
        b.count[axis] = left < array->chunk[axis] ? left : array->chunk[axis];
        b.file_step[axis] = file_step;
        b.chunk_step[axis] = chunk_step;
        file_step *= array->sizes[axis];
        chunk_step *= array->chunk[axis];
    }
    while (b.first_in_run > 0 && b.count[b.first_in_run] == array->sizes[b.first_in_run] &&
           array->chunk[b.first_in_run] == array->sizes[b.first_in_run])
        b.first_in_run--;
    b.run_bytes = b.count[b.first_in_run] * b.file_step[b.first_in_run];
    return b;
}

/* Reads the values of a box, which are laid out as in a chunk. */
static iso_status read_box(const iso_hdf5_source *source, const int index[3], unsigned char *target,
                           iso_error *error) {
    const iso_hdf5_array *array = &source->array;
    const box b = find_box(array, index);
    uint64_t at[ISO_HDF5_AXES] = {0}; /* in the box, on the axes before the run */
    for (int axis = 0; axis >= 0;) {
        uint64_t from = array->address, to = 0;
        for (int i = 0; i < array->rank; i++) {
            from += (b.start[i] + at[i]) * b.file_step[i];
            to += at[i] * b.chunk_step[i];
        }
        ISO_TRY(read_bytes(source, index, from, b.run_bytes, target + to, error));
        for (axis = b.first_in_run - 1; axis >= 0 && ++at[axis] == b.count[axis]; axis--) at[axis] = 0;
    }
    return ISO_OK;
}

static void scale_row(const iso_hdf5_slices *slices, int z, float *row, size_t count) {
    if (z >= slices->count) return; /* outside of the volume */
    for (size_t i = 0; i < count; i++)
        row[i] = (float)((double)row[i] * slices->scale[z] + slices->offset[z]);
}

/* Converts the values of the chunk whose first voxel is in slice `slice` row by row. */
static void convert(const iso_hdf5_source *source, const unsigned char *data, int slice, void *target) {
    const iso_hdf5_array *array = &source->array;
    const size_t size = iso_scalar_size(array->scalar);
    const iso_type type = source->slices ? ISO_FLOAT32 : iso_scalar_stored_type(array->scalar);
    size_t steps[ISO_HDF5_AXES], step = 1, first = 0;
    for (int axis = array->rank - 1; axis >= 0; step *= array->chunk[axis--]) {
        steps[axis] = step;
        first += array->at[axis] % array->chunk[axis] * step;
    }
    const size_t row = (size_t)source->voxels[0], row_bytes = row * iso_type_size(type);
    for (int z = 0; z < source->voxels[2]; z++)
        for (int y = 0; y < source->voxels[1]; y++) {
            const size_t at = first + (size_t)y * steps[array->xyz[1]] + (size_t)z * steps[array->xyz[2]];
            const iso_scalar_source values = {.data = data + at * size,
                                              .scalar = array->scalar,
                                              .components = (int)steps[array->xyz[0]],
                                              .swap = array->big_endian};
            char *voxels = (char *)target + ((size_t)z * (size_t)source->voxels[1] + (size_t)y) * row_bytes;
            iso_scalar_convert(&values, row, type, voxels);
            if (source->slices) scale_row(source->slices, slice + z, (float *)(void *)voxels, row);
        }
}

float iso_hdf5_fill_value(const iso_hdf5_array *array) {
    const iso_scalar_source value = {.data = array->fill, .scalar = array->scalar, .components = 1};
    float fill;
    iso_scalar_convert(&value, 1, ISO_FLOAT32, &fill);
    return fill;
}

/* Reads a chunk as it is stored and undoes its filters; the values are in now->data. */
static iso_status unpack(const iso_hdf5_source *source, const int index[3], piece *now, piece *other,
                         size_t room, iso_error *error) {
    const uint64_t number = number_of(source, index);
    const iso_hdf5_place *found = find_place(source, number);
    if (!found || found->number != number) return fail_chunk(source, index, "is not in the file", error);
    const iso_hdf5_place place = *found;
    now->bytes = place.bytes;
    if (place.bytes > room) return fail_chunk(source, index, "damaged: it is too long", error);
    ISO_TRY(read_bytes(source, index, place.address, place.bytes, now->data, error));
    if (!undo_filters(&source->array, place.skipped, now, other, room))
        return fail_chunk(source, index, "damaged", error);
    return now->bytes == iso_hdf5_chunk_bytes(&source->array)
               ? ISO_OK
               : fail_chunk(source, index, "damaged: it unpacks to a wrong number of bytes", error);
}

iso_status iso_hdf5_read_chunk(const iso_hdf5_source *source, const int index[3], void *room, void *target,
                               iso_error *error) {
    const size_t most = (size_t)largest_chunk(iso_hdf5_chunk_bytes(&source->array));
    piece now = {.data = room}, other = {.data = (unsigned char *)room + most};
    if (source->decode)
        ISO_TRY(source->decode(source->decoder, index, now.data, error));
    else
        ISO_TRY(source->array.chunked ? unpack(source, index, &now, &other, most, error)
                                      : read_box(source, index, now.data, error));
    convert(source, now.data, index[2] * (int)source->array.chunk[source->array.xyz[2]], target);
    return ISO_OK;
}
