/* Numbers of the vertices of a mesh: which reader, and those of FreeSurfer's files (lh.curv, lh.aparc.annot),
 * big-endian. */
#include <math.h>
#include <string.h>

#include "base/decimal_point.h"
#include "grids/volume/scalar_load.h"
#include "io/mesh/mesh_format.h"

iso_status iso_vertex_values_reserve(iso_vertex_values *values, size_t count, bool colors, iso_error *error) {
    values->values = iso_alloc((count + 1) * sizeof *values->values);
    values->colors = colors ? iso_alloc_zero(count + 1, sizeof *values->colors) : NULL;
    values->count = count;
    if (values->values && (values->colors || !colors)) return ISO_OK;
    return iso_fail(error, ISO_ERR_NOMEM, "out of memory for the numbers of %zu vertices", count);
}

void iso_vertex_values_free(iso_vertex_values *values) {
    iso_free(values->values);
    iso_free(values->colors);
    *values = (iso_vertex_values){.values = NULL};
}

/* ---- FreeSurfer */

static iso_status truncated(const iso_mesh_reading *r, iso_error *error) {
    return iso_fail(error, ISO_ERR_IO, "%s: truncated", r->path);
}

static iso_status take_curv(const iso_mesh_reading *r, const unsigned char *at, size_t bytes,
                            iso_vertex_values *values, iso_error *error) {
    if (bytes < 15) return truncated(r, error);
    if (memcmp(at, "\xff\xff\xff", 3) != 0)
        return iso_fail(
            error, ISO_ERR_FORMAT,
            "%s: not FreeSurfer's numbers of vertices: its first bytes are others (those of before "
            "2001: mris_convert -c)",
            r->path);
    const double count = iso_scalar_load(at + 3, ISO_SCALAR_INT32, true),
                 each = iso_scalar_load(at + 11, ISO_SCALAR_INT32, true);
    if (!(count > 0) || each != 1)
        return iso_fail(error, ISO_ERR_FORMAT, "%s: not FreeSurfer's numbers: %g of each of %g vertices",
                        r->path, each, count);
    if ((bytes - 15) / 4 < (size_t)count) return truncated(r, error);
    ISO_TRY(iso_vertex_values_reserve(values, (size_t)count, false, error));
    for (size_t i = 0; i < values->count; i++)
        values->values[i] = (float)iso_scalar_load(at + 15 + 4 * i, ISO_SCALAR_FLOAT, true);
    return ISO_OK;
}

/* Pairs of a vertex and its label, which is its colour in one number; 0: it has none. Vertices that the file
 * leaves out have none either. The table of names behind the pairs is not needed. */
static iso_status take_annot(const iso_mesh_reading *r, const unsigned char *at, size_t bytes,
                             iso_vertex_values *values, iso_error *error) {
    if (bytes < 4) return truncated(r, error);
    const double count = iso_scalar_load(at, ISO_SCALAR_INT32, true);
    if (!(count > 0))
        return iso_fail(error, ISO_ERR_FORMAT, "%s: not an annotation of FreeSurfer: %g vertices", r->path,
                        count);
    if ((bytes - 4) / 8 < (size_t)count) return truncated(r, error);
    ISO_TRY(iso_vertex_values_reserve(values, (size_t)count, true, error));
    for (size_t i = 0; i < values->count; i++) values->values[i] = NAN;
    for (size_t i = 0; i < values->count; i++) {
        const double vertex = iso_scalar_load(at + 4 + 8 * i, ISO_SCALAR_INT32, true),
                     label = iso_scalar_load(at + 8 + 8 * i, ISO_SCALAR_INT32, true);
        if (!(vertex >= 0 && vertex < count && label < 1 << 24))
            return iso_fail(error, ISO_ERR_FORMAT,
                            "%s: not an annotation of FreeSurfer: label %g of vertex %g", r->path, label,
                            vertex);
        if (!(label > 0)) continue; /* (-1: none, as some writers have it) */
        values->values[(size_t)vertex] = (float)label;
        for (int k = 0; k < 3; k++) values->colors[(size_t)vertex][k] = (uint8_t)((int)label >> 8 * k);
    }
    return ISO_OK;
}

typedef iso_status take_values(const iso_mesh_reading *r, const unsigned char *at, size_t bytes,
                               iso_vertex_values *values, iso_error *error);

/* Reads a file, which has no arrays with names. */
static iso_status read_with(take_values *take, iso_mesh_reading *r, const char *array,
                            iso_vertex_values *values, iso_error *error) {
    iso_buffer buffer = {0};
    size_t bytes = 0;
    if (array)
        return iso_fail(error, ISO_ERR_USAGE, "%s: there is no array %.60s: the file has one", r->path,
                        array);
    r->text = iso_reading_begin(r->path, NULL, &r->report);
    iso_status status = iso_reading_load(&r->text, &buffer, &bytes, error);
    if (status == ISO_OK) status = take(r, buffer.data, bytes, values, error);
    iso_reading_free(&r->text, &buffer);
    return status;
}

iso_status iso_vertex_values_read_curv(iso_mesh_reading *r, const char *array, iso_vertex_values *values,
                                       iso_error *error) {
    return read_with(take_curv, r, array, values, error);
}

iso_status iso_vertex_values_read_annot(iso_mesh_reading *r, const char *array, iso_vertex_values *values,
                                        iso_error *error) {
    return read_with(take_annot, r, array, values, error);
}

/* ---- any */

static iso_status read_any(iso_mesh_reading *r, const char *array, iso_vertex_values *values,
                           iso_error *error) {
    char known[128];
    switch (iso_file_type_find(r->path, ISO_HOLDS_VALUES)) {
#define VALUES(reader) return iso_vertex_values_read_##reader(r, array, values, error);
#include "base/file_types.inc"
    default:
        break;
    }
    iso_file_type_extensions(ISO_HOLDS_VALUES, 0, "and", known, sizeof known);
    return iso_fail(error, ISO_ERR_UNSUPPORTED, "%s: numbers of vertices are read from %s", r->path, known);
}

iso_status iso_vertex_values_read(const char *path, const char *array, iso_vertex_values *values,
                                  iso_error *error) {
    iso_mesh_reading r = {.path = path};
    *values = (iso_vertex_values){.values = NULL};
    void *numbers = iso_decimal_point_begin();
    const iso_status status = read_any(&r, array, values, error);
    iso_decimal_point_end(numbers);
    if (status != ISO_OK) iso_vertex_values_free(values);
    return status;
}
