/* format_stream: functions for readers that read voxels in file order: filling a grid in chunks of bytes,
 * parsing numbers in text, loading texts, and paths of files that a header names. */
#include <ctype.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/memory.h"
#include "grids/volume/format.h"
#include "grids/volume/mapping.h"

/* Large enough that calls cost little, small enough to stay in cache between reading and conversion. */
enum { CHUNK_BYTES = 1 << 20 };

uint64_t iso_format_size(const int dims[3], uint64_t each) {
    uint64_t bytes = each;
    for (int i = 0; i < 3; i++)
        if (__builtin_mul_overflow(bytes, (uint64_t)dims[i], &bytes)) return UINT64_MAX;
    return bytes;
}

static size_t voxel_bytes(const iso_format_stream *stream) {
    return iso_scalar_size(stream->scalar) * (size_t)stream->components;
}

static size_t chunk_voxels(const iso_format_stream *stream) {
    size_t voxels = CHUNK_BYTES / voxel_bytes(stream);
    return voxels ? voxels : 1;
}

/* Whether values need no conversion, so that they are read directly into the grid. */
static bool is_direct(const iso_format_stream *stream, iso_type type) {
    return stream->components == 1 && iso_scalar_is_stored(stream->scalar) &&
           iso_scalar_stored_type(stream->scalar) == type;
}

void iso_format_stream_room(const iso_format_stream *stream, iso_volume_info *info) {
    info->read_bytes = iso_format_size(info->dims, iso_type_size(info->type));
    if (is_direct(stream, info->type)) return;
    uint64_t scratch = (uint64_t)chunk_voxels(stream) * voxel_bytes(stream);
    if (__builtin_add_overflow(info->read_bytes, scratch, &info->read_bytes)) info->read_bytes = UINT64_MAX;
}

static iso_status fill_grid(const char *path, const iso_volume_opts *opts, const iso_format_stream *stream,
                            iso_rgrid *grid, iso_error *error) {
    size_t count = (size_t)grid->dims[0] * (size_t)grid->dims[1] * (size_t)grid->dims[2];
    size_t chunk = chunk_voxels(stream), each = iso_type_size(grid->type);
    bool direct = is_direct(stream, grid->type);
    void *scratch = direct ? NULL : iso_alloc(chunk * voxel_bytes(stream));
    if (!direct && !scratch) return iso_fail_memory(error, path);
    iso_status status = ISO_OK;
    for (size_t at = 0; at < count && status == ISO_OK; at += chunk) {
        size_t voxels = count - at < chunk ? count - at : chunk;
        char *target = (char *)grid->data + at * each, *place = direct ? target : scratch;
        status = stream->fill(stream->context, place, voxels * voxel_bytes(stream), error);
        if (status != ISO_OK) break;
        iso_scalar_source source = {place, stream->scalar, stream->components, stream->component,
                                    stream->swap};
        iso_scalar_convert(&source, voxels, grid->type, target);
        status = iso_format_progress(path, opts, (double)(at + voxels) / (double)count, error);
    }
    iso_free(scratch);
    return status;
}

/* ---- mapped voxels */

/* iso_format_fill from a file: the rest of a stream that has been taken as read. */
static iso_status read_plain(void *file, void *target, size_t bytes, iso_error *error) {
    if (fread(target, 1, bytes, file) == bytes) return ISO_OK;
    return iso_fail(error, ISO_ERR_IO, "truncated, or it cannot be read");
}

static iso_status create_mapped(const char *path, const iso_volume_info *info, iso_mapping *mapping,
                                iso_grid *grid, iso_error *error) {
    const iso_format_data lent = {iso_mapping_data(mapping), iso_mapping_destroy, mapping};
    return iso_format_create(path, info, &lent, grid, error);
}

/* Maps the voxels where they lie, if the grid can use them as they are. *grid stays empty otherwise, and the
 * stream is then to be read on from `rest`. */
static iso_status map_in_place(const char *path, const iso_volume_info *info, const iso_format_stream *stream,
                               iso_format_stream *rest, iso_grid *grid, iso_error *error) {
    const size_t size = iso_scalar_size(stream->scalar);
    const uint64_t bytes = iso_format_size(info->dims, voxel_bytes(stream));
    FILE *file = stream->plain ? stream->plain(stream->context, bytes) : NULL;
    *rest = *stream;
    if (!file) return ISO_OK;
    rest->fill = read_plain;
    rest->context = file;
    const off_t start = ftello(file);
    const bool usable = is_direct(stream, info->type) && (!stream->swap || size == 1);
    if (!usable || start < 0 || start % (off_t)size) return ISO_OK;
    iso_mapping *mapping = NULL;
    ISO_TRY(iso_mapping_of_file(path, file, bytes, &mapping, error));
    if (fseeko(file, (off_t)bytes, SEEK_CUR) != 0) {
        iso_mapping_destroy(mapping);
        return iso_fail(error, ISO_ERR_IO, "%s: cannot be read", path);
    }
    return create_mapped(path, info, mapping, grid, error);
}

static iso_status map_stream(const char *path, const iso_volume_opts *opts, const iso_volume_info *info,
                             const iso_format_stream *stream, iso_grid *grid, iso_error *error) {
    iso_format_stream rest;
    iso_mapping *mapping = NULL;
    ISO_TRY(map_in_place(path, info, stream, &rest, grid, error));
    if (grid->rgrid) return ISO_OK;
    ISO_TRY(iso_mapping_of_new_file(path, iso_format_size(info->dims, iso_type_size(info->type)), &mapping,
                                    error));
    ISO_TRY(create_mapped(path, info, mapping, grid, error));
    return fill_grid(path, opts, &rest, grid->rgrid, error);
}

static iso_status read_into_memory(const char *path, const iso_volume_opts *opts, const iso_volume_info *info,
                                   const iso_format_stream *stream, iso_grid *grid, iso_error *error) {
    ISO_TRY(iso_format_create(path, info, NULL, grid, error));
    return fill_grid(path, opts, stream, grid->rgrid, error);
}

iso_status iso_format_read_stream(const char *path, const iso_volume_opts *opts, const iso_volume_info *info,
                                  const iso_format_stream *stream, iso_grid *grid, iso_error *error) {
    iso_grid result = {0};
    iso_status status = opts->mapped ? map_stream(path, opts, info, stream, &result, error)
                                     : read_into_memory(path, opts, info, stream, &result, error);
    if (status != ISO_OK) {
        iso_grid_destroy(&result);
        return status;
    }
    *grid = result;
    return ISO_OK;
}

/* ---- voxels that lie in a file as they are ---- */

typedef struct open_file {
    const char *path;
    FILE *stream;
    iso_inflater *inflater; /* NULL: the file is not compressed */
    bool text, bits;
    iso_scalar scalar;
    unsigned char held; /* of bits: the byte that is being taken apart, and how many of it are left */
    unsigned left;
} open_file;

static iso_status read_stored(const open_file *file, void *target, size_t bytes, iso_error *error) {
    if (file->inflater) return iso_inflater_fill(file->inflater, target, bytes, error);
    if (fread(target, 1, bytes, file->stream) == bytes) return ISO_OK;
    return iso_fail(error, ISO_ERR_IO, "%s: cannot read: %s", file->path,
                    ferror(file->stream) ? strerror(errno) : "the file ends too early");
}

/* Takes bits apart. The bytes that hold them lie at the end of the target first, where each is taken before a
 * voxel takes its place. */
static iso_status read_bits(open_file *file, unsigned char *target, size_t count, iso_error *error) {
    const size_t packed = count > file->left ? (count - file->left + 7) / 8 : 0;
    const unsigned char *next = target + count - packed;
    ISO_TRY(read_stored(file, target + count - packed, packed, error));
    for (size_t i = 0; i < count; i++) {
        if (!file->left) file->held = *next++, file->left = 8;
        target[i] = file->held >> --file->left & 1;
    }
    return ISO_OK;
}

static iso_status read_bytes(void *context, void *target, size_t bytes, iso_error *error) {
    open_file *file = context;
    if (file->bits) return read_bits(file, target, bytes, error);
    if (file->text) {
        const size_t count = bytes / iso_scalar_size(file->scalar);
        if (iso_format_read_numbers(file->stream, "<", file->scalar, count, target)) return ISO_OK;
        return iso_fail(error, ISO_ERR_IO, "%s: truncated: a number is missing, or is none", file->path);
    }
    return read_stored(file, target, bytes, error);
}

static FILE *plain_file(void *context, uint64_t bytes) {
    const open_file *file = context;
    (void)bytes;
    return file->inflater || file->text || file->bits ? NULL : file->stream;
}

static iso_format_stream stream_of(const iso_format_place *place, const iso_volume_info *info) {
    return (iso_format_stream){.scalar = place->scalar,
                               .components = place->components ? place->components
                                             : place->separate ? 1
                                                               : info->components,
                               .component = place->components ? place->component
                                            : place->separate ? 0
                                                              : info->component,
                               .swap = place->swap,
                               .fill = read_bytes,
                               .plain = plain_file};
}

void iso_format_place_room(const iso_format_place *place, iso_volume_info *info) {
    const iso_format_stream stream = stream_of(place, info);
    iso_format_stream_room(&stream, info);
}

void iso_format_set_place(const iso_format_place *place, const iso_volume_opts *opts, iso_volume_info *info) {
    info->type = iso_scalar_stored_type(place->scalar);
    snprintf(info->file_type, sizeof info->file_type, "%s",
             place->text   ? "text"
             : place->bits ? "bit"
                           : iso_scalar_name(place->scalar));
    *opts->place = *place;
    iso_format_place_room(place, info);
}

iso_status iso_format_text_voxels(const char *path, FILE *file, const iso_volume_opts *opts,
                                  iso_volume_info *info, iso_error *error) {
    const off_t position = ftello(file);
    if (position < 0) return iso_fail(error, ISO_ERR_IO, "%s: cannot read: %s", path, strerror(errno));
    iso_format_set_place(
        &(iso_format_place){
            .known = true, .text = true, .scalar = ISO_SCALAR_FLOAT, .position = (uint64_t)position},
        opts, info);
    return ISO_OK;
}

/* Goes to the first byte of the voxels; `end` is behind their last one. */
static iso_status go_to_voxels(open_file *file, uint64_t bytes, uint64_t start, uint64_t end,
                               const iso_format_place *place, iso_error *error) {
    char skipped[1 << 14];
    if (place->gzip) {
        if (fseeko(file->stream, (off_t)place->plain, SEEK_SET) != 0)
            return iso_fail(error, ISO_ERR_IO, "%s: cannot read: %s", file->path, strerror(errno));
        ISO_TRY(iso_inflater_create(file->path, file->stream, end, &file->inflater, error));
        for (uint64_t part; start; start -= part) {
            part = start < sizeof skipped ? start : sizeof skipped;
            ISO_TRY(iso_inflater_fill(file->inflater, skipped, part, error));
        }
        return ISO_OK;
    }
    if (!file->text && bytes < end) return iso_format_truncated(file->path, bytes, end, error);
    if (fseeko(file->stream, (off_t)start, SEEK_SET) == 0) return ISO_OK;
    return iso_fail(error, ISO_ERR_IO, "%s: cannot read: %s", file->path, strerror(errno));
}

iso_status iso_format_read_place(const char *path, const iso_volume_opts *opts, const iso_volume_info *info,
                                 const iso_format_place *place, iso_grid *grid, iso_error *error) {
    iso_format_stream stream = stream_of(place, info);
    open_file file = {.path = *place->file ? place->file : path,
                      .text = place->text,
                      .bits = place->bits,
                      .scalar = place->scalar};
    const uint64_t volume = iso_format_size(info->dims, voxel_bytes(&stream));
    uint64_t bytes, start = 0, end;
    if (place->separate && __builtin_mul_overflow(volume, (uint64_t)info->component, &start))
        start = UINT64_MAX;
    uint64_t size = volume, first = 0; /* in the file: bytes, and of bits those before the first one */
    if (place->bits && start != UINT64_MAX) {
        first = start % 8;
        size = (first + volume) / 8 + ((first + volume) % 8 > 0);
        start /= 8;
    }
    if (__builtin_add_overflow(start, place->position, &start) || __builtin_add_overflow(start, size, &end))
        end = UINT64_MAX;
    ISO_TRY(iso_file_open(file.path, &file.stream, &bytes, error));
    stream.context = &file;
    iso_status status = go_to_voxels(&file, bytes, start, end, place, error);
    if (status == ISO_OK && first) status = read_stored(&file, &file.held, 1, error);
    file.left = first ? 8 - (unsigned)first : 0;
    if (status == ISO_OK) status = iso_format_read_stream(path, opts, info, &stream, grid, error);
    if (status == ISO_OK && file.inflater) {
        status = iso_inflater_finish(file.inflater, NULL, error);
        if (status != ISO_OK) iso_grid_destroy(grid);
    }
    iso_inflater_destroy(file.inflater);
    fclose(file.stream);
    return status;
}

/* ---- text ---- */

static bool is_between(int c, const char *separators) {
    return isspace(c) || (*separators && c && strchr(separators, c));
}

/* Reads the next word, of at most 63 characters; false at the end of the file, or when the word is longer. */
static bool next_word(FILE *file, const char *separators, char word[64]) {
    int c = getc(file), length = 0;
    while (c != EOF && is_between(c, separators)) c = getc(file);
    while (c != EOF && !is_between(c, separators)) {
        if (length == 63) return false;
        word[length++] = (char)c;
        c = getc(file);
    }
    word[length] = 0;
    return length > 0;
}

static double clamp(double value, double lo, double hi) {
    if (!(value > lo)) return lo;
    return value < hi ? value : hi;
}

/* Parses a word and stores the number. Integers are parsed as double, because they may be written as 3.0 (and
 * 64-bit integers become floats in the grid anyway). */
static bool store_number(const char *word, iso_scalar scalar, void *place) {
    char *end;
    double value = strtod(word, &end);
    if (end == word || *end) return false;
#define STORE(type, result)                                                                                  \
    do {                                                                                                     \
        type number = (type)(result);                                                                        \
        memcpy(place, &number, sizeof number);                                                               \
        return true;                                                                                         \
    } while (0)
    switch (scalar) {
    case ISO_SCALAR_UINT8:
        STORE(uint8_t, clamp(value, 0, UINT8_MAX));
    case ISO_SCALAR_INT8:
        STORE(int8_t, clamp(value, INT8_MIN, INT8_MAX));
    case ISO_SCALAR_UINT16:
        STORE(uint16_t, clamp(value, 0, UINT16_MAX));
    case ISO_SCALAR_INT16:
        STORE(int16_t, clamp(value, INT16_MIN, INT16_MAX));
    case ISO_SCALAR_UINT32:
        STORE(uint32_t, clamp(value, 0, UINT32_MAX));
    case ISO_SCALAR_INT32:
        STORE(int32_t, clamp(value, INT32_MIN, INT32_MAX));
    case ISO_SCALAR_UINT64: /* the largest double below 2^64 */
        STORE(uint64_t, clamp(value, 0, 18446744073709549568.0));
    case ISO_SCALAR_INT64:
        STORE(int64_t, clamp(value, -9223372036854775808.0, 9223372036854774784.0));
    case ISO_SCALAR_FLOAT: /* parsed as float: from double it would be rounded twice */
        STORE(float, strtof(word, NULL));
    default:
        STORE(double, value);
    }
#undef STORE
}

bool iso_format_read_numbers(FILE *file, const char *separators, iso_scalar scalar, size_t count,
                             void *target) {
    size_t size = iso_scalar_size(scalar);
    char word[64];
    for (size_t i = 0; i < count; i++)
        if (!next_word(file, separators, word) || !store_number(word, scalar, (char *)target + i * size))
            return false;
    return true;
}

iso_status iso_format_load_text(const char *path, uint64_t most, char **text, size_t *bytes,
                                iso_error *error) {
    FILE *file;
    uint64_t size;
    ISO_TRY(iso_file_open(path, &file, &size, error));
    iso_status status = ISO_OK;
    char *loaded = NULL;
    if (size > most)
        status = iso_fail(error, ISO_ERR_FORMAT, "%s: damaged: a text of %llu bytes, of %llu at most", path,
                          (unsigned long long)size, (unsigned long long)most);
    else if (!(loaded = iso_alloc_zero(1, (size_t)size + 1)))
        status = iso_fail_memory(error, path);
    else if (fread(loaded, 1, (size_t)size, file) != size)
        status = iso_fail(error, ISO_ERR_IO, "%s: cannot read: %s", path,
                          ferror(file) ? strerror(errno) : "changed while it was read");
    fclose(file);
    if (status != ISO_OK) {
        iso_free(loaded);
        return status;
    }
    *text = loaded;
    *bytes = (size_t)size;
    return ISO_OK;
}

char *iso_format_beside(const char *header, const char *name) {
    const char *slash = strrchr(header, '/');
    if (name[0] == '/' || !slash) return strdup(name);
    char *path = NULL;
    if (asprintf(&path, "%.*s/%s", (int)(slash - header), header, name) < 0) return NULL;
    return path;
}
