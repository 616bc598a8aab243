/* format_raw: reads files without a header, whose layout (iso_raw_layout) is given by the caller or by the
 * file's name. */
#include <ctype.h>
#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "grids/volume/format.h"

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

/* The types of numbers, and what files' names call them; the first name is the one that is shown. */
static const struct {
    iso_type type;
    bool converted; /* the file has other numbers than `type` */
    iso_scalar scalar;
    const char *names[5];
} types[] = {{ISO_UINT8, false, ISO_SCALAR_UINT8, {"uint8", "uchar", "u8"}},
             {ISO_INT16, false, ISO_SCALAR_INT16, {"int16", "short", "i16"}},
             {ISO_UINT16, false, ISO_SCALAR_UINT16, {"uint16", "ushort", "u16"}},
             {ISO_FLOAT32, false, ISO_SCALAR_FLOAT, {"float32", "float", "f32"}},
             {ISO_INT16, true, ISO_SCALAR_INT8, {"int8", "schar", "i8"}},
             {ISO_FLOAT32, true, ISO_SCALAR_INT32, {"int32", "i32"}},
             {ISO_FLOAT32, true, ISO_SCALAR_UINT32, {"uint32", "u32"}},
             {ISO_FLOAT32, true, ISO_SCALAR_DOUBLE, {"float64", "double", "f64"}}};
enum { TYPES = sizeof types / sizeof *types };

/* The row of a layout's type. */
static int row_of(const iso_raw_layout *layout) {
    for (int i = 0; i < TYPES; i++)
        if (types[i].converted ? strcmp(types[i].names[0], layout->number) == 0
                               : !*layout->number && types[i].type == layout->type)
            return i;
    return 0;
}

const char *iso_raw_layout_type_name(const iso_raw_layout *layout) {
    return types[row_of(layout)].names[0];
}

size_t iso_raw_layout_number_bytes(const iso_raw_layout *layout) {
    return iso_scalar_size(types[row_of(layout)].scalar);
}

static bool find_type(const char *word, size_t length, iso_raw_layout *layout) {
    for (int i = 0; i < TYPES; i++)
        for (const char *const *name = types[i].names; *name; name++)
            if (word_is(word, length, *name)) {
                layout->type = types[i].type;
                snprintf(layout->number, sizeof layout->number, "%s",
                         types[i].converted ? types[i].names[0] : "");
                return true;
            }
    return false;
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
    if (!find_type(type, (size_t)(type_end - type), &result))
        return iso_fail(
            error, ISO_ERR_USAGE,
            "raw layout '%s': the type must be uint8, int8, uint16, int16, uint32, int32, float32 or float64",
            text);
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

/* ---- the layout in a file's name ---- */

/* A word of a file's name; words are separated by _ - . and spaces. */
typedef struct name_word {
    const char *text;
    size_t length;
} name_word;

enum { NAME_WORDS = 64 };

static int split_name(const char *path, name_word words[NAME_WORDS]) {
    const char *at = strrchr(path, '/') ? strrchr(path, '/') + 1 : path;
    int count = 0;
    while (*at && count < NAME_WORDS) {
        size_t length = strcspn(at, "_-. ");
        if (length) words[count++] = (name_word){at, length};
        at += length + (at[length] != 0);
    }
    return count;
}

static bool is_any(const name_word *word, const char *const *names) {
    for (; *names; names++)
        if (word_is(word->text, word->length, *names)) return true;
    return false;
}

bool iso_raw_layout_of_name(const char *path, iso_raw_layout *layout) {
    static const char *const big[] = {"be", "big", NULL};
    name_word words[NAME_WORDS];
    int count = split_name(path, words), sizes = -1;
    iso_raw_layout result = {.components = 1};
    for (int i = 0; i < count; i++) {
        int dims[3];
        if (!parse_dims(words[i].text, words[i].text + words[i].length, dims)) continue;
        if (sizes >= 0) return false; /* two sizes: ambiguous */
        sizes = i;
        memcpy(result.dims, dims, sizeof dims);
    }
    if (sizes < 0) return false;
    int last = sizes + 1; /* the type is the word after the sizes, or before them */
    if (last == count || !find_type(words[last].text, words[last].length, &result)) {
        last = sizes;
        if (sizes == 0 || !find_type(words[last - 1].text, words[last - 1].length, &result)) return false;
    }
    result.big_endian = last + 1 < count && is_any(&words[last + 1], big);
    *layout = result;
    return true;
}

uint64_t iso_raw_layout_bytes(const iso_raw_layout *layout) {
    uint64_t each =
        iso_raw_layout_number_bytes(layout) * (uint64_t)(layout->components ? layout->components : 1);
    uint64_t bytes = iso_format_size(layout->dims, each);
    return __builtin_add_overflow(bytes, layout->offset, &bytes) ? UINT64_MAX : bytes;
}

/* ---- the file ---- */

static iso_format_place place_of(const iso_raw_layout *raw) {
    return (iso_format_place){.known = true,
                              .swap = raw->big_endian != (__BYTE_ORDER__ == __ORDER_BIG_ENDIAN__),
                              .scalar = types[row_of(raw)].scalar,
                              .position = raw->offset};
}

static iso_status raw_info(const char *path, const iso_volume_opts *opts, iso_volume_info *info,
                           iso_error *error) {
    const iso_raw_layout *raw = opts->raw;
    uint64_t dims[3];
    for (int i = 0; i < 3; i++) dims[i] = raw->dims[i] < 0 ? 0 : (uint64_t)raw->dims[i];
    ISO_TRY(iso_format_dims(path, dims, info, error));
    info->type = types[row_of(raw)].type;
    snprintf(info->file_type, sizeof info->file_type, "%s", iso_raw_layout_type_name(raw));
    ISO_TRY(iso_format_component(path, opts, raw->components ? raw->components : 1, info, error));
    uint64_t bytes = 0, wanted = iso_raw_layout_bytes(raw);
    ISO_TRY(iso_format_file_bytes(path, &bytes, error));
    if (bytes > wanted)
        iso_volume_note(info, "%llu bytes after the last voxel are not used",
                        (unsigned long long)(bytes - wanted));
    *opts->place = place_of(raw);
    iso_format_place_room(opts->place, info);
    return ISO_OK;
}

const iso_format iso_format_raw = {"raw", "isopoint", NULL, raw_info, NULL, NULL};
