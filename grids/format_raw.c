/* format_raw: voxels in a file without a header, laid out as iso_raw_layout says. */
#define _GNU_SOURCE
#include <ctype.h>
#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "grids/format.h"

/* ---- the layout as text ---- */

static bool parse_dims(const char *text, const char *end, int dims[3]) {
    for (int i = 0; i < 3; i++) {
        if (!isdigit((unsigned char)*text)) return false;
        char *after;
        errno = 0;
        long value = strtol(text, &after, 10);
        if (errno || value < 1 || value > INT_MAX) return false;
        dims[i] = (int)value;
        bool last = i == 2;
        if (last ? after != end : (*after != 'x' && *after != 'X')) return false;
        text = after + 1;
    }
    return true;
}

static bool word_is(const char *word, size_t length, const char *wanted) {
    return strlen(wanted) == length && strncasecmp(word, wanted, length) == 0;
}

static bool parse_type(const char *word, size_t length, iso_type *type) {
    for (iso_type t = ISO_UINT8; t <= ISO_FLOAT32; t++) {
        if (!word_is(word, length, iso_type_name(t))) continue;
        *type = t;
        return true;
    }
    *type = ISO_FLOAT32;
    return word_is(word, length, "float");
}

static bool parse_offset(const char *text, uint64_t *offset) {
    if (!*text) return true;
    if (!isdigit((unsigned char)*text)) return false;
    char *after;
    errno = 0;
    unsigned long long value = strtoull(text, &after, 10);
    *offset = value;
    return errno == 0 && !*after;
}

iso_status iso_raw_layout_parse(const char *text, iso_raw_layout *layout, iso_error *error) {
    iso_raw_layout result = {.components = 1};
    const char *dims_end = strchrnul(text, ':');
    if (!parse_dims(text, dims_end, result.dims))
        return iso_fail(error, ISO_ERR_USAGE, "raw layout '%s': must begin with three sizes, as in 64x64x93",
                        text);
    if (!*dims_end)
        return iso_fail(error, ISO_ERR_USAGE, "raw layout '%s': the type is missing, as in 64x64x93:uint8",
                        text);
    const char *type = dims_end + 1, *type_end = strchrnul(type, ':');
    if (!parse_type(type, (size_t)(type_end - type), &result.type))
        return iso_fail(error, ISO_ERR_USAGE,
                        "raw layout '%s': the type must be uint8, int16, uint16 or float", text);
    const char *endian = *type_end ? type_end + 1 : type_end, *endian_end = strchrnul(endian, ':');
    size_t length = (size_t)(endian_end - endian);
    result.big_endian = word_is(endian, length, "big");
    if (length && !result.big_endian && !word_is(endian, length, "little"))
        return iso_fail(error, ISO_ERR_USAGE, "raw layout '%s': the byte order must be little or big", text);
    if (!parse_offset(*endian_end ? endian_end + 1 : endian_end, &result.offset))
        return iso_fail(error, ISO_ERR_USAGE, "raw layout '%s': the offset must be a number of bytes", text);
    *layout = result;
    return ISO_OK;
}

/* ---- the file ---- */

static iso_scalar scalar_of(iso_type type) {
    switch (type) {
    case ISO_UINT8:
        return ISO_SCALAR_UINT8;
    case ISO_INT16:
        return ISO_SCALAR_INT16;
    case ISO_UINT16:
        return ISO_SCALAR_UINT16;
    default:
        return ISO_SCALAR_FLOAT;
    }
}

/* Bytes that the file must have; UINT64_MAX when that is more than 64 bits can say. */
static uint64_t wanted_bytes(const iso_volume_info *info, uint64_t offset) {
    uint64_t bytes = iso_format_size(info->dims, iso_type_size(info->type) * (uint64_t)info->components);
    return __builtin_add_overflow(bytes, offset, &bytes) ? UINT64_MAX : bytes;
}

typedef struct raw_file {
    const char *path;
    FILE *stream;
} raw_file;

static iso_status fill(void *context, void *target, size_t bytes, iso_error *error) {
    raw_file *file = context;
    if (fread(target, 1, bytes, file->stream) == bytes) return ISO_OK;
    return iso_fail(error, ISO_ERR_IO, "%s: cannot read: %s", file->path,
                    ferror(file->stream) ? strerror(errno) : "the file ends too early");
}

static iso_format_stream stream_of(const iso_volume_opts *opts, const iso_volume_info *info, raw_file *file) {
    bool swap = opts->raw->big_endian != (__BYTE_ORDER__ == __ORDER_BIG_ENDIAN__);
    return (iso_format_stream){fill, file, scalar_of(info->type), info->components, info->component, swap};
}

static iso_status raw_info(const char *path, const iso_volume_opts *opts, iso_volume_info *info,
                           iso_error *error) {
    const iso_raw_layout *raw = opts->raw;
    uint64_t dims[3];
    for (int i = 0; i < 3; i++) dims[i] = raw->dims[i] < 0 ? 0 : (uint64_t)raw->dims[i];
    ISO_TRY(iso_format_dims(path, dims, info, error));
    info->type = raw->type;
    snprintf(info->file_type, sizeof info->file_type, "%s", iso_type_name(raw->type));
    ISO_TRY(iso_format_component(path, opts, raw->components ? raw->components : 1, info, error));
    uint64_t bytes = 0, wanted = wanted_bytes(info, raw->offset);
    ISO_TRY(iso_format_file_bytes(path, &bytes, error));
    if (bytes > wanted)
        iso_volume_note(info, "%llu bytes after the last voxel are not used",
                        (unsigned long long)(bytes - wanted));
    iso_format_stream stream = stream_of(opts, info, NULL);
    iso_format_stream_room(&stream, info);
    return ISO_OK;
}

static iso_status raw_read(const char *path, const iso_volume_opts *opts, iso_volume_info *info,
                           iso_grid *grid, iso_error *error) {
    uint64_t bytes = 0, wanted = wanted_bytes(info, opts->raw->offset);
    raw_file file = {path, NULL};
    ISO_TRY(iso_format_open(path, &file.stream, &bytes, error));
    iso_status status = ISO_OK;
    if (bytes < wanted)
        status = iso_format_truncated(path, bytes, wanted, error);
    else if (fseeko(file.stream, (off_t)opts->raw->offset, SEEK_SET) != 0)
        status = iso_fail(error, ISO_ERR_IO, "%s: cannot read: %s", path, strerror(errno));
    iso_format_stream stream = stream_of(opts, info, &file);
    if (status == ISO_OK) status = iso_format_read_stream(path, opts, info, &stream, grid, error);
    fclose(file.stream);
    return status;
}

const iso_format iso_format_raw = {"raw", "isopoint", NULL, raw_info, raw_read};
