/* npy: arrays of NumPy, versions 1 to 3 of the format: N rows of 3 to 10 numbers, in C or Fortran order.
 * What the numbers behind x y z are is decided from their values (point_columns.h), unless the options
 * name them. */
#include "grids/volume/npy_header.h"
#include "io/glyphs/point_columns.h"
#include "io/polydata/records.h"

typedef struct npy {
    iso_polydata *data;
    iso_stream in;
    char text[ISO_NPY_TEXT + 1]; /* the header's dictionary */
    iso_npy_header header;
    uint64_t rows, columns;
    iso_slot slots[ISO_POLYDATA_COLUMNS];
    iso_record_field fields[ISO_POLYDATA_COLUMNS];
} npy;

static const char *path_of(const npy *n) {
    return n->data->reading->path;
}

/* ---- the header */

static iso_status check_shape(const npy *n, iso_error *error) {
    if (n->header.scalar == ISO_SCALAR_HALF)
        return iso_fail(error, ISO_ERR_UNSUPPORTED,
                        "%s: points of numbers of type '<f2' (float16) are not read", path_of(n));
    if (n->header.axes != 2)
        return iso_fail(error, ISO_ERR_FORMAT,
                        "%s: its NPY header has no shape of two numbers: points are N rows", path_of(n));
    const uint64_t most = n->data->reading->opts.columns ? ISO_POLYDATA_COLUMNS : ISO_POINT_COLUMNS_MOST;
    if (n->columns >= ISO_POINT_COLUMNS_LEAST && n->columns <= most) return ISO_OK;
    return iso_fail(error, ISO_ERR_FORMAT, "%s: %llu numbers in a row are not a point, which is 3 to 10",
                    path_of(n), (unsigned long long)n->columns);
}

static iso_status read_header(npy *n, iso_error *error) {
    unsigned char head[ISO_NPY_HEAD] = {0};
    const size_t magic = 8; /* with the version, which says how long the length behind it is */
    ISO_TRY(iso_stream_read(&n->in, head, magic, error));
    ISO_TRY(iso_npy_begin(path_of(n), head, &n->header, error));
    ISO_TRY(iso_stream_read(&n->in, head + magic, n->header.text_at - magic, error));
    ISO_TRY(iso_npy_begin(path_of(n), head, &n->header, error)); /* with the length */
    ISO_TRY(iso_stream_read(&n->in, n->text, n->header.text_bytes, error));
    ISO_TRY(iso_npy_parse(path_of(n), n->text, &n->header, error));
    n->rows = n->header.shape[0];
    n->columns = n->header.shape[1];
    return check_shape(n, error);
}

/* ---- numbers */

/* Adds columns for the numbers of a row, with the names that the options give. */
static iso_status add_columns(npy *n, iso_error *error) {
    int given;
    if (!n->data->reading->opts.columns)
        return iso_point_columns_add(n->data, (int)n->columns, n->slots, error);
    ISO_TRY(iso_point_columns_given(n->data, n->slots, &given, error));
    if ((uint64_t)given == n->columns) return ISO_OK;
    return iso_fail(error, ISO_ERR_FORMAT, "%s: its rows have %llu numbers, for which there are %d names",
                    path_of(n), (unsigned long long)n->columns, given);
}

static iso_status add_fields(npy *n, iso_error *error) {
    const size_t size = iso_scalar_size(n->header.scalar), columns = (size_t)n->columns;
    n->data->keep_floats = n->header.scalar == ISO_SCALAR_FLOAT;
    ISO_TRY(add_columns(n, error));
    for (size_t i = 0; i < columns; i++) {
        const size_t before = n->header.fortran ? i * (size_t)n->rows : i;
        n->fields[i] = iso_record_field_make(n->slots[i], n->header.scalar, before * size,
                                             n->header.fortran ? size : columns * size);
        n->fields[i].big_endian = n->header.big_endian;
    }
    return ISO_OK;
}

/* In Fortran order a point's numbers are far from each other: the file is read as a whole. */
static iso_status read_fortran(npy *n, iso_buffer *bytes, size_t record, iso_error *error) {
    const size_t rows = (size_t)n->rows;
    ISO_TRY(iso_polydata_reserve(n->data, rows, error));
    ISO_TRY(iso_reading_reserve(n->data->reading, bytes, rows + 1, record, 0, error));
    ISO_TRY(iso_stream_read(&n->in, bytes->data, rows * record, error));
    iso_polydata_add_records(n->data, n->fields, (int)n->columns, bytes->data, rows);
    return ISO_OK;
}

static iso_status read_numbers(npy *n, iso_error *error) {
    const size_t record = iso_scalar_size(n->header.scalar) * (size_t)n->columns;
    ISO_TRY(iso_polydata_check_records(&n->in, record, n->rows, error));
    ISO_TRY(add_fields(n, error));
    if (!n->header.fortran)
        return iso_polydata_stream_records(n->data, n->fields, (int)n->columns, &n->in, record, n->rows,
                                           error);
    iso_buffer bytes = {0};
    iso_status status = read_fortran(n, &bytes, record, error);
    iso_reading_free(n->data->reading, &bytes);
    return status;
}

static iso_status read_npy(npy *n, iso_error *error) {
    ISO_TRY(iso_stream_open(path_of(n), &n->in, error));
    ISO_TRY(read_header(n, error));
    ISO_TRY(read_numbers(n, error));
    if (!n->data->reading->opts.columns) return iso_point_columns_decide(n->data, false, error);
    iso_polydata_scale_colors(n->data, true);
    return ISO_OK;
}

iso_status iso_polydata_read_npy(iso_polydata *data, iso_error *error) {
    npy *n = iso_alloc_zero(1, sizeof *n);
    if (!n) return iso_fail_memory(error, data->reading->path);
    n->data = data;
    const iso_status status = read_npy(n, error);
    iso_stream_close(&n->in);
    iso_free(n);
    return status;
}
