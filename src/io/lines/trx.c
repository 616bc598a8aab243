/* trx: tractograms of the TRX format (github.com/tee-ar-ex/trx-spec): a ZIP archive of arrays, which their
 * names describe: positions.3.float16 (RAS mm), offsets.uint64 (of the first vertex of each line, and
 * perhaps of the end), dpv/NAME.type with numbers for each vertex, dps/NAME.3.type with numbers for each
 * line. Groups are left out. Numbers are little-endian. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/zip.h"
#include "grids/volume/scalar_load.h"
#include "io/lines/lines_format.h"
#include "io/polydata/polydata.h"

enum { ARRAYS = 512 };

typedef struct trx_array {
    char name[ISO_COLUMN_NAME];
    enum { OTHER, POSITIONS, OFFSETS, OF_VERTICES, OF_LINES } what;
    iso_scalar scalar;
    uint64_t components, rows;
    iso_zip_entry entry;
} trx_array;

typedef struct trx {
    iso_reading *reading;
    iso_polydata data;
    iso_buffer text, unpacked, numbers;
    trx_array arrays[ARRAYS];
    int array_count, groups;
} trx;

static iso_status bad(const trx *t, const char *what, iso_error *error) {
    return iso_fail(error, ISO_ERR_FORMAT, "%s: not a readable .trx file: %s", t->reading->path, what);
}

/* Takes ".3.float32" or ".uint8" off the end of a name. False: it is no name of an array. */
static bool take_type(char *name, trx_array *a) {
    static const struct {
        const char *name;
        iso_scalar scalar;
    } types[] = {{"float16", ISO_SCALAR_HALF},  {"float32", ISO_SCALAR_FLOAT}, {"float64", ISO_SCALAR_DOUBLE},
                 {"uint8", ISO_SCALAR_UINT8},   {"int8", ISO_SCALAR_INT8},     {"uint16", ISO_SCALAR_UINT16},
                 {"int16", ISO_SCALAR_INT16},   {"uint32", ISO_SCALAR_UINT32}, {"int32", ISO_SCALAR_INT32},
                 {"uint64", ISO_SCALAR_UINT64}, {"int64", ISO_SCALAR_INT64}};
    char *dot = strrchr(name, '.');
    if (!dot) return false;
    bool known = false;
    for (size_t i = 0; i < sizeof types / sizeof *types && !known; i++) {
        known = strcmp(dot + 1, types[i].name) == 0;
        a->scalar = types[i].scalar;
    }
    *dot = 0;
    a->components = 1;
    char *count = strrchr(name, '.');
    if (!count || !count[1] || count[1 + strspn(count + 1, "0123456789")] || strlen(count) > 5) return known;
    a->components = strtoul(count + 1, NULL, 10);
    *count = 0;
    return known;
}

static iso_status add_entry(trx *t, const iso_zip_entry *entry, iso_error *error) {
    char name[256];
    trx_array a = {.entry = *entry};
    snprintf(name, sizeof name, "%.*s", (int)(entry->name_length < 255 ? entry->name_length : 255),
             entry->name);
    t->groups += strncmp(name, "groups/", 7) == 0;
    if (!take_type(name, &a)) return ISO_OK; /* header.json, folders */
    const bool vertices = strncmp(name, "dpv/", 4) == 0, lines = strncmp(name, "dps/", 4) == 0;
    a.what = strcmp(name, "positions") == 0 ? POSITIONS
             : strcmp(name, "offsets") == 0 ? OFFSETS
             : vertices                     ? OF_VERTICES
             : lines                        ? OF_LINES
                                            : OTHER;
    if (a.what == OTHER || t->array_count == ARRAYS) return ISO_OK;
    const uint64_t each = a.components * iso_scalar_size(a.scalar);
    if (!each || entry->size % each) return bad(t, "the size of an array is no multiple of its rows", error);
    a.rows = entry->size / each;
    snprintf(a.name, sizeof a.name, "%.*s", (int)sizeof a.name - 1, name + (vertices || lines ? 4 : 0));
    t->arrays[t->array_count++] = a;
    return ISO_OK;
}

static const trx_array *find(const trx *t, int what) {
    for (int i = 0; i < t->array_count; i++)
        if ((int)t->arrays[i].what == what) return &t->arrays[i];
    return NULL;
}

/* Writes the numbers of an array as floats. */
static iso_status load(trx *t, const trx_array *a, float *to, iso_error *error) {
    const unsigned char *bytes;
    ISO_TRY(iso_reading_unzip(t->reading, &a->entry, &t->unpacked, &bytes, error));
    const iso_scalar_source source = {
        .data = bytes, .scalar = a->scalar, .components = 1, .swap = __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__};
    iso_scalar_convert(&source, (size_t)(a->rows * a->components), ISO_FLOAT32, to);
    return ISO_OK;
}

static iso_status take_positions(trx *t, iso_error *error) {
    const trx_array *a = find(t, POSITIONS);
    if (!a || a->components != 3) return bad(t, "it has no array of positions", error);
    ISO_TRY(iso_polydata_reserve(&t->data, (size_t)a->rows, error));
    ISO_TRY(iso_reading_reserve(t->reading, &t->numbers, (size_t)a->rows + 1, 3 * sizeof(float), 0, error));
    const float *p = t->numbers.data;
    t->data.stated = ISO_SPACE_RAS;
    t->data.keep_floats = true;
    ISO_TRY(load(t, a, t->numbers.data, error));
    for (uint64_t i = 0; i < a->rows; i++, p += 3)
        iso_polydata_add_point(&t->data, (const double[3]){(double)p[0], (double)p[1], (double)p[2]});
    return ISO_OK;
}

/* Ends each line where the next one begins, and the last one with the vertices. */
static iso_status take_offsets(trx *t, iso_error *error) {
    const trx_array *a = find(t, OFFSETS);
    const unsigned char *bytes;
    uint64_t vertex = 0;
    if (!a || a->components != 1 || iso_scalar_size(a->scalar) < 4 || a->scalar == ISO_SCALAR_FLOAT)
        return bad(t, "it has no array of offsets", error);
    ISO_TRY(iso_reading_unzip(t->reading, &a->entry, &t->unpacked, &bytes, error));
    for (uint64_t i = 1; i <= a->rows; i++) {
        const size_t each = iso_scalar_size(a->scalar);
        double end = (double)t->data.point_count;
        if (i < a->rows) end = iso_scalar_load(bytes + i * each, a->scalar, false);
        if (!(end >= (double)vertex && end <= (double)t->data.point_count))
            return bad(t, "its offsets do not rise to the number of its vertices", error);
        if (i == a->rows && vertex == t->data.point_count) break; /* (the end was stated, too) */
        for (; vertex < (uint64_t)end; vertex++)
            ISO_TRY(iso_polydata_add_index(&t->data, (uint32_t)vertex, error));
        ISO_TRY(iso_polydata_end_line(&t->data, error));
    }
    return ISO_OK;
}

static iso_status take_columns(trx *t, iso_error *error) {
    for (int i = 0; i < t->array_count; i++) {
        const trx_array *a = &t->arrays[i];
        const bool lines = a->what == OF_LINES;
        const size_t items = lines ? t->data.line_count : t->data.point_count;
        int number;
        if ((!lines && a->what != OF_VERTICES) || a->components > 64) continue;
        if (a->rows != items)
            return bad(t, "an array has not as many rows as there are vertices or lines", error);
        ISO_TRY(iso_polydata_add_column(&t->data, a->name, (int)a->components, lines, ISO_ROLE_NONE, &number,
                                        error));
        iso_column *column = iso_polydata_column(&t->data, number);
        ISO_TRY(iso_reading_reserve(t->reading, &column->values, items + 1,
                                    (size_t)a->components * sizeof(float), 0, error));
        ISO_TRY(load(t, a, column->values.data, error));
    }
    return ISO_OK;
}

static iso_status read_trx(trx *t, iso_lines *lines, iso_error *error) {
    iso_zip zip;
    iso_zip_entry entry;
    size_t bytes;
    bool more;
    ISO_TRY(iso_reading_load(t->reading, &t->text, &bytes, error));
    ISO_TRY(iso_zip_open(t->reading->path, t->text.data, bytes, &zip, error));
    for (;;) {
        ISO_TRY(iso_zip_next(t->reading->path, &zip, &entry, &more, error));
        if (!more) break;
        ISO_TRY(add_entry(t, &entry, error));
    }
    ISO_TRY(take_positions(t, error));
    ISO_TRY(take_offsets(t, error));
    ISO_TRY(take_columns(t, error));
    if (t->groups) iso_reading_note(t->reading, "groups of lines are left out");
    return iso_polydata_to_lines(&t->data, lines, error);
}

iso_status iso_lines_read_trx(iso_reading *reading, iso_lines *lines, iso_error *error) {
    trx *t = iso_alloc_zero(1, sizeof *t);
    if (!t) return iso_fail_memory(error, reading->path);
    t->reading = t->data.reading = reading;
    const iso_status status = read_trx(t, lines, error);
    iso_reading_free(reading, &t->text);
    iso_reading_free(reading, &t->unpacked);
    iso_reading_free(reading, &t->numbers);
    iso_polydata_free(&t->data);
    iso_free(t);
    return status;
}
