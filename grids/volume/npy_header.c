#include "grids/volume/npy_header.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"

static const char MAGIC[] = "\x93NUMPY";

bool iso_npy_is(const void *bytes, size_t count) {
    return count >= strlen(MAGIC) && memcmp(bytes, MAGIC, strlen(MAGIC)) == 0;
}

iso_status iso_npy_begin(const char *path, const unsigned char head[ISO_NPY_HEAD], iso_npy_header *header,
                         iso_error *error) {
    *header = (iso_npy_header){0};
    if (!iso_npy_is(head, ISO_NPY_HEAD)) return iso_fail(error, ISO_ERR_FORMAT, "%s: not an NPY file", path);
    const int version = head[6];
    if (version < 1 || version > 3)
        return iso_fail(error, ISO_ERR_UNSUPPORTED, "%s: version %d of NPY is not known", path, version);
    const size_t size = version == 1 ? 2 : 4; /* of the length, little-endian */
    header->text_at = 8 + size;
    for (size_t i = 0; i < size; i++) header->text_bytes |= (size_t)head[8 + i] << (8 * i);
    if (header->text_bytes <= ISO_NPY_TEXT) return ISO_OK;
    return iso_fail(error, ISO_ERR_FORMAT, "%s: damaged: an NPY header of %zu bytes", path,
                    header->text_bytes);
}

static iso_status fail_header(const char *path, const char *what, iso_error *error) {
    return iso_fail(error, ISO_ERR_FORMAT, "%s: its NPY header has no %s that can be read", path, what);
}

/* Returns the text behind a key of the dictionary; NULL if there is none. */
static const char *find_value(const char *text, const char *key) {
    const char *at = strstr(text, key);
    if (!at) return NULL;
    at += strlen(key);
    at += strspn(at, " ");
    if (*at != ':') return NULL;
    at++;
    return at + strspn(at, " ");
}

/* Parses a type such as '<f4'. */
static iso_status parse_type(const char *path, const char *text, iso_npy_header *header, iso_error *error) {
    static const struct {
        char name[3];
        iso_scalar scalar;
    } types[] = {{"f2", ISO_SCALAR_HALF},   {"f4", ISO_SCALAR_FLOAT},  {"f8", ISO_SCALAR_DOUBLE},
                 {"i1", ISO_SCALAR_INT8},   {"u1", ISO_SCALAR_UINT8},  {"b1", ISO_SCALAR_UINT8},
                 {"i2", ISO_SCALAR_INT16},  {"u2", ISO_SCALAR_UINT16}, {"i4", ISO_SCALAR_INT32},
                 {"u4", ISO_SCALAR_UINT32}, {"i8", ISO_SCALAR_INT64},  {"u8", ISO_SCALAR_UINT64}};
    const char *value = find_value(text, "'descr'");
    if (!value) return fail_header(path, "descr", error);
    if (*value == '\'' && value[1] && strchr("<>|=", value[1]))
        for (size_t i = 0; i < sizeof types / sizeof *types; i++)
            if (strncmp(value + 2, types[i].name, 2) == 0 && value[4] == '\'') {
                header->scalar = types[i].scalar;
                header->big_endian = value[1] == '>';
                return ISO_OK;
            }
    return iso_fail(error, ISO_ERR_UNSUPPORTED, "%s: numbers of type %.*s are not read from .npy", path,
                    (int)strcspn(value, ",}\n"), value);
}

/* Parses a tuple of numbers such as (1000, 3), (5,) or (). */
static bool parse_shape(const char *text, iso_npy_header *header) {
    const char *at = find_value(text, "'shape'");
    if (!at || *at++ != '(') return false;
    for (header->axes = 0;; header->axes++) {
        at += strspn(at, " ");
        if (*at == ')') return true;
        if (*at < '0' || *at > '9' || header->axes == ISO_NPY_AXES) return false;
        char *end;
        errno = 0;
        header->shape[header->axes] = strtoull(at, &end, 10);
        if (errno) return false;
        at = end + strspn(end, "L "); /* (written by Python 2) */
        if (*at == ',')
            at++;
        else if (*at != ')')
            return false;
    }
}

iso_status iso_npy_parse(const char *path, const char *text, iso_npy_header *header, iso_error *error) {
    const char *order = find_value(text, "'fortran_order'");
    ISO_TRY(parse_type(path, text, header, error));
    if (!order) return fail_header(path, "fortran_order", error);
    header->fortran = strncmp(order, "True", 4) == 0;
    return parse_shape(text, header) ? ISO_OK : fail_header(path, "shape", error);
}

int iso_npy_axes(const char *path) {
    unsigned char head[ISO_NPY_HEAD];
    iso_npy_header header;
    FILE *file;
    int axes = 0;
    if (iso_file_open(path, &file, NULL, NULL) != ISO_OK) return 0;
    char *text = NULL;
    if (fread(head, 1, sizeof head, file) == sizeof head &&
        iso_npy_begin(path, head, &header, NULL) == ISO_OK && (text = calloc(1, header.text_bytes + 1)) &&
        fseek(file, (long)header.text_at, SEEK_SET) == 0 &&
        fread(text, 1, header.text_bytes, file) == header.text_bytes &&
        iso_npy_parse(path, text, &header, NULL) == ISO_OK)
        axes = header.axes;
    free(text);
    fclose(file);
    return axes;
}
