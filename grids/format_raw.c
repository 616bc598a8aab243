/* format_raw: voxels in a file without a header, laid out as iso_raw_layout says. */
#define _GNU_SOURCE
#include <ctype.h>
#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "base/memory.h"
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
    uint64_t bytes = iso_type_size(info->type) * (uint64_t)info->components;
    for (int i = 0; i < 3; i++)
        if (__builtin_mul_overflow(bytes, (uint64_t)info->dims[i], &bytes)) return UINT64_MAX;
    return __builtin_add_overflow(bytes, offset, &bytes) ? UINT64_MAX : bytes;
}

static iso_status raw_info(const char *path, const iso_volume_opts *opts, iso_volume_info *info,
                           iso_error *error) {
    const iso_raw_layout *raw = opts->raw;
    for (int i = 0; i < 3; i++) info->dims[i] = raw->dims[i];
    info->type = raw->type;
    snprintf(info->file_type, sizeof info->file_type, "%s", iso_type_name(raw->type));
    ISO_TRY(iso_format_component(path, opts, raw->components ? raw->components : 1, info, error));
    uint64_t bytes = 0;
    ISO_TRY(iso_format_file_bytes(path, &bytes, error));
    for (int i = 0; i < 3; i++)
        if (info->dims[i] < 1) return ISO_OK; /* volume.c words that */
    uint64_t wanted = wanted_bytes(info, raw->offset);
    if (bytes > wanted)
        iso_volume_note(info, "%llu bytes after the last voxel are not used",
                        (unsigned long long)(bytes - wanted));
    return ISO_OK;
}

/* Slices of several components go through `slice`; of one component straight to their place. */
static iso_status read_slice(FILE *file, const iso_volume_info *info, bool swap, void *slice, void *target) {
    size_t count = (size_t)info->dims[0] * (size_t)info->dims[1];
    size_t size = iso_type_size(info->type) * (size_t)info->components;
    void *place = slice ? slice : target;
    if (fread(place, size, count, file) != count) return ISO_ERR_IO;
    iso_scalar_source source = {place, scalar_of(info->type), info->components, info->component, swap};
    iso_scalar_convert(&source, count, info->type, target);
    return ISO_OK;
}

static iso_status read_slices(const char *path, FILE *file, const iso_volume_opts *opts,
                              const iso_volume_info *info, iso_rgrid *grid, iso_error *error) {
    bool swap = opts->raw->big_endian != (__BYTE_ORDER__ == __ORDER_BIG_ENDIAN__);
    size_t slice_bytes = (size_t)grid->stride_z * iso_type_size(info->type);
    void *slice = NULL;
    if (info->components > 1 && !(slice = iso_alloc(slice_bytes * (size_t)info->components)))
        return iso_fail(error, ISO_ERR_NOMEM, "%s: out of memory", path);
    iso_status status = ISO_OK;
    for (int z = 0; z < info->dims[2] && status == ISO_OK; z++) {
        status = read_slice(file, info, swap, slice, (char *)grid->data + (size_t)z * slice_bytes);
        if (status != ISO_OK)
            iso_fail(error, status, "%s: cannot read: %s", path,
                     ferror(file) ? strerror(errno) : "file ends");
        else
            status = iso_format_progress(path, opts, (z + 1.0) / info->dims[2], error);
    }
    iso_free(slice);
    return status;
}

static iso_status raw_read(const char *path, const iso_volume_opts *opts, iso_volume_info *info,
                           iso_grid *grid, iso_error *error) {
    uint64_t bytes = 0, wanted = wanted_bytes(info, opts->raw->offset);
    ISO_TRY(iso_format_file_bytes(path, &bytes, error));
    if (bytes < wanted) return iso_format_truncated(path, bytes, wanted, error);
    FILE *file = fopen(path, "rb");
    if (!file || fseeko(file, (off_t)opts->raw->offset, SEEK_SET) != 0) {
        int code = errno;
        if (file) fclose(file);
        return iso_fail(error, ISO_ERR_IO, "%s: cannot read: %s", path, strerror(code));
    }
    iso_grid result = {0};
    iso_status status = iso_format_create(path, info, NULL, &result, error);
    if (status == ISO_OK) status = read_slices(path, file, opts, info, result.rgrid, error);
    fclose(file);
    if (status != ISO_OK) {
        iso_grid_destroy(&result);
        return status;
    }
    *grid = result;
    return ISO_OK;
}

const iso_format iso_format_raw = {"raw", "isopoint", raw_info, raw_read};
