/* npy: arrays of NumPy, versions 1 to 3 of the format: N rows of 3 to 10 numbers, in C or Fortran order.
 * What the numbers behind x y z are is decided from their values (point_columns.h), unless the options
 * name them. */
#define _GNU_SOURCE
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "io/glyphs/glyphs_format.h"
#include "io/glyphs/point_columns.h"
#include "io/polydata/records.h"

enum { HEADER_MOST = 60000 };

typedef struct npy {
    iso_polydata data;
    iso_stream in;
    char header[HEADER_MOST + 1]; /* a Python dictionary as text */
    iso_scalar scalar;
    bool big_endian, fortran;
    uint64_t rows, columns;
    iso_slot slots[ISO_POLYDATA_COLUMNS];
    iso_record_field fields[ISO_POLYDATA_COLUMNS];
} npy;

static const char *path_of(const npy *n) {
    return n->data.reading->path;
}

/* ---- the header */

static iso_status fail_header(const npy *n, const char *what, iso_error *error) {
    return iso_fail(error, ISO_ERR_FORMAT, "%s: its NPY header has no %s that can be read", path_of(n), what);
}

/* Returns the text behind a key of the dictionary; NULL if there is none. */
static char *find_value(npy *n, const char *key) {
    char *at = strstr(n->header, key);
    if (!at) return NULL;
    at += strlen(key);
    at += strspn(at, " ");
    if (*at != ':') return NULL;
    at++;
    return at + strspn(at, " ");
}

/* Parses a type such as '<f4'. */
static iso_status parse_type(npy *n, iso_error *error) {
    static const struct {
        char name[3];
        iso_scalar scalar;
    } types[] = {{"f4", ISO_SCALAR_FLOAT}, {"f8", ISO_SCALAR_DOUBLE}, {"i1", ISO_SCALAR_INT8},
                 {"u1", ISO_SCALAR_UINT8}, {"i2", ISO_SCALAR_INT16},  {"u2", ISO_SCALAR_UINT16},
                 {"i4", ISO_SCALAR_INT32}, {"u4", ISO_SCALAR_UINT32}, {"i8", ISO_SCALAR_INT64},
                 {"u8", ISO_SCALAR_UINT64}};
    const char *value = find_value(n, "'descr'");
    if (!value) return fail_header(n, "descr", error);
    if (*value == '\'' && value[1] && strchr("<>|=", value[1]))
        for (size_t i = 0; i < sizeof types / sizeof *types; i++)
            if (strncmp(value + 2, types[i].name, 2) == 0 && value[4] == '\'') {
                n->scalar = types[i].scalar;
                n->big_endian = value[1] == '>';
                return ISO_OK;
            }
    return iso_fail(error, ISO_ERR_UNSUPPORTED, "%s: numbers of type %.*s are not read from .npy", path_of(n),
                    (int)strcspn(value, ",}\n"), value);
}

/* Parses a tuple of two numbers such as (1000, 3). */
static bool parse_shape(npy *n) {
    char *at = find_value(n, "'shape'"), *end;
    uint64_t *const to[2] = {&n->rows, &n->columns};
    if (!at || *at++ != '(') return false;
    for (int k = 0; k < 2; k++) {
        at += strspn(at, " ");
        if (*at < '0' || *at > '9') return false;
        errno = 0;
        *to[k] = strtoull(at, &end, 10);
        if (errno) return false;
        at = end + strspn(end, "L "); /* (written by Python 2) */
        if (k == 0 && *at++ != ',') return false;
    }
    if (*at == ',') at++;
    return at[strspn(at, " ")] == ')';
}

static iso_status parse_header(npy *n, iso_error *error) {
    const char *order = find_value(n, "'fortran_order'");
    ISO_TRY(parse_type(n, error));
    if (!order) return fail_header(n, "fortran_order", error);
    n->fortran = strncmp(order, "True", 4) == 0;
    if (!parse_shape(n)) return fail_header(n, "shape of two numbers", error);
    const uint64_t most = n->data.reading->opts.columns ? ISO_POLYDATA_COLUMNS : ISO_POINT_COLUMNS_MOST;
    if (n->columns >= ISO_POINT_COLUMNS_LEAST && n->columns <= most) return ISO_OK;
    return iso_fail(error, ISO_ERR_FORMAT, "%s: %llu numbers in a row are not a point, which is 3 to 10",
                    path_of(n), (unsigned long long)n->columns);
}

static iso_status read_header(npy *n, iso_error *error) {
    unsigned char head[12] = {0};
    uint32_t length = 0;
    ISO_TRY(iso_stream_read(&n->in, head, 8, error));
    if (memcmp(head, "\x93NUMPY", 6) != 0)
        return iso_fail(error, ISO_ERR_FORMAT, "%s: not an NPY file", path_of(n));
    if (head[6] < 1 || head[6] > 3)
        return iso_fail(error, ISO_ERR_UNSUPPORTED, "%s: version %d of NPY is not known", path_of(n),
                        head[6]);
    const size_t size = head[6] == 1 ? 2 : 4;
    ISO_TRY(iso_stream_read(&n->in, head + 8, size, error));
    memcpy(&length, head + 8, size); /* little-endian, like the machines that this runs on */
    if (length > HEADER_MOST)
        return iso_fail(error, ISO_ERR_FORMAT, "%s: damaged: an NPY header of %lu bytes", path_of(n),
                        (unsigned long)length);
    ISO_TRY(iso_stream_read(&n->in, n->header, length, error));
    return parse_header(n, error);
}

/* ---- numbers */

/* Adds columns for the numbers of a row, with the names that the options give. */
static iso_status add_columns(npy *n, iso_error *error) {
    int given;
    if (!n->data.reading->opts.columns)
        return iso_point_columns_add(&n->data, (int)n->columns, n->slots, error);
    ISO_TRY(iso_point_columns_given(&n->data, n->slots, &given, error));
    if ((uint64_t)given == n->columns) return ISO_OK;
    return iso_fail(error, ISO_ERR_FORMAT, "%s: its rows have %llu numbers, for which there are %d names",
                    path_of(n), (unsigned long long)n->columns, given);
}

static iso_status add_fields(npy *n, iso_error *error) {
    const size_t size = iso_scalar_size(n->scalar), columns = (size_t)n->columns;
    n->data.keep_floats = n->scalar == ISO_SCALAR_FLOAT;
    ISO_TRY(add_columns(n, error));
    for (size_t i = 0; i < columns; i++) {
        const size_t before = n->fortran ? i * (size_t)n->rows : i;
        n->fields[i] =
            iso_record_field_make(n->slots[i], n->scalar, before * size, n->fortran ? size : columns * size);
        n->fields[i].big_endian = n->big_endian;
    }
    return ISO_OK;
}

/* In Fortran order a point's numbers are far from each other: the file is read as a whole. */
static iso_status read_fortran(npy *n, iso_buffer *bytes, size_t record, iso_error *error) {
    const size_t rows = (size_t)n->rows;
    ISO_TRY(iso_polydata_reserve(&n->data, rows, error));
    ISO_TRY(iso_reading_reserve(n->data.reading, bytes, rows + 1, record, 0, error));
    ISO_TRY(iso_stream_read(&n->in, bytes->data, rows * record, error));
    iso_polydata_add_records(&n->data, n->fields, (int)n->columns, bytes->data, rows);
    return ISO_OK;
}

static iso_status read_numbers(npy *n, iso_error *error) {
    const size_t record = iso_scalar_size(n->scalar) * (size_t)n->columns;
    ISO_TRY(iso_polydata_check_records(&n->in, record, n->rows, error));
    ISO_TRY(add_fields(n, error));
    if (!n->fortran)
        return iso_polydata_stream_records(&n->data, n->fields, (int)n->columns, &n->in, record, n->rows,
                                           error);
    iso_buffer bytes = {0};
    iso_status status = read_fortran(n, &bytes, record, error);
    iso_reading_free(n->data.reading, &bytes);
    return status;
}

static iso_status read_npy(npy *n, iso_glyphs *glyphs, iso_error *error) {
    ISO_TRY(iso_stream_open(path_of(n), &n->in, error));
    ISO_TRY(read_header(n, error));
    ISO_TRY(read_numbers(n, error));
    if (n->data.reading->opts.columns)
        iso_polydata_scale_colors(&n->data, true);
    else
        ISO_TRY(iso_point_columns_decide(&n->data, false, error));
    return iso_polydata_to_glyphs(&n->data, glyphs, error);
}

iso_status iso_glyphs_read_npy(iso_reading *reading, iso_glyphs *glyphs, iso_error *error) {
    npy *n = iso_alloc_zero(1, sizeof *n);
    if (!n) return iso_fail_memory(error, reading->path);
    n->data.reading = reading;
    iso_status status = read_npy(n, glyphs, error);
    iso_stream_close(&n->in);
    iso_polydata_free(&n->data);
    iso_free(n);
    return status;
}
