/* Meshes and data of their vertices in GIFTI, the surface format of neuroimaging ("GIFTI Surface Data
 * Format", version 1.0, 2011): XML with arrays in text or in base64, as they are or compressed by zlib. Of a
 * mesh the first array of points and the first one of triangles are read, of data the first one, or the one
 * that is asked for; labels have the colours of the file's table. Coordinates are RAS, as GIFTI's coordinate
 * systems are, and turned to LPS; matrices in the file are not applied, as other readers do. */
#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

#include "base/xml.h"
#include "grids/volume/scalar_load.h"
#include "io/mesh/mesh_format.h"

typedef struct gii_array {
    iso_scalar scalar;
    uint64_t rows;
    unsigned columns;
    bool text, zlib, big_endian, by_columns;
    const char *begin, *end; /* its characters */
} gii_array;

static iso_status bad(const iso_mesh_reading *r, const char *what, iso_error *error) {
    return iso_fail(error, ISO_ERR_FORMAT, "%s: not a readable GIFTI file: %s", r->path, what);
}

/* Describes an array of 1 or 3 columns by its tag; its characters are not known yet. */
static iso_status describe(const iso_mesh_reading *r, const iso_xml_tag *tag, unsigned columns, gii_array *a,
                           iso_error *error) {
    static const struct {
        const char *name;
        iso_scalar scalar;
    } types[] = {{"NIFTI_TYPE_FLOAT32", ISO_SCALAR_FLOAT}, {"NIFTI_TYPE_FLOAT64", ISO_SCALAR_DOUBLE},
                 {"NIFTI_TYPE_INT32", ISO_SCALAR_INT32},   {"NIFTI_TYPE_UINT32", ISO_SCALAR_UINT32},
                 {"NIFTI_TYPE_INT64", ISO_SCALAR_INT64},   {"NIFTI_TYPE_UINT8", ISO_SCALAR_UINT8}};
    char text[ISO_XML_TEXT], encoding[ISO_XML_TEXT] = "";
    bool known = false;
    for (size_t i = 0; i < sizeof types / sizeof *types && !known; i++) {
        known = iso_xml_attribute_is(tag, "DataType", types[i].name);
        a->scalar = types[i].scalar;
    }
    if (!known) return bad(r, "an array of a type that is not read", error);
    a->rows = iso_xml_attribute(tag, "Dim0", text) ? strtoull(text, NULL, 10) : 0;
    a->columns = columns;
    const unsigned long long given = iso_xml_attribute(tag, "Dim1", text) ? strtoull(text, NULL, 10) : 1;
    if (given != columns || !a->rows || a->rows > UINT32_MAX)
        return bad(r,
                   columns == 3 ? "its points or triangles are not rows of three numbers"
                                : "its data are not one number of each vertex",
                   error);
    iso_xml_attribute(tag, "Encoding", encoding);
    a->text = strcmp(encoding, "ASCII") == 0;
    a->zlib = strcmp(encoding, "GZipBase64Binary") == 0;
    if (!a->text && !a->zlib && strcmp(encoding, "Base64Binary") != 0)
        return iso_fail(error, ISO_ERR_UNSUPPORTED,
                        "%s: values in the encoding %.40s are not read (wb_command -gifti-convert)", r->path,
                        *encoding ? encoding : "\"\"");
    a->big_endian = iso_xml_attribute_is(tag, "Endian", "BigEndian");
    a->by_columns = iso_xml_attribute_is(tag, "ArrayIndexingOrder", "ColumnMajorOrder");
    return ISO_OK;
}

static iso_status decode_text(iso_mesh_reading *r, const gii_array *a, double *numbers, iso_error *error) {
    const char *at = a->begin;
    for (uint64_t i = 0; i < a->columns * a->rows; i++) {
        char *end;
        numbers[i] = strtod(at, &end); /* (ends before </Data> at the latest) */
        if (end == at || end > a->end)
            return iso_fail(error, ISO_ERR_IO, "%s: truncated: an array has fewer numbers than it states",
                            r->path);
        at = end;
    }
    return ISO_OK;
}

/* Unpacks the characters of an array into `bytes` bytes at `to`; `packed` has room for all of them. */
static iso_status decode_bytes(iso_mesh_reading *r, const gii_array *a, uint64_t bytes, unsigned char *packed,
                               unsigned char *to, iso_error *error) {
    const char *at = a->begin;
    const uint64_t given = (uint64_t)(a->end - a->begin) / 4 * 3, size = a->zlib ? given : bytes;
    if (size > given)
        return iso_fail(error, ISO_ERR_IO, "%s: truncated: an array has fewer bytes than it states", r->path);
    if (!iso_base64_take(&at, size, a->zlib ? packed : to)) return bad(r, "an array is not in base64", error);
    uLongf got = (uLongf)bytes;
    if (a->zlib && (uncompress(to, &got, packed, (uLong)size) != Z_OK || got != bytes))
        return iso_fail(error, ISO_ERR_IO, "%s: corrupt: a compressed array", r->path);
    return ISO_OK;
}

/* Decodes an array into rows of numbers. Its size is believed as far as its characters allow. */
static iso_status decode(iso_mesh_reading *r, const gii_array *a, iso_buffer *numbers, iso_error *error) {
    const uint64_t count = a->columns * a->rows, each = iso_scalar_size(a->scalar), bytes = count * each,
                   given = (uint64_t)(a->end - a->begin);
    if (count / 1032 > given)
        return iso_fail(error, ISO_ERR_IO, "%s: truncated: an array has fewer bytes than it states", r->path);
    ISO_TRY(iso_reading_reserve(&r->text, numbers, (size_t)count, sizeof(double), 0, error));
    double *to = numbers->data;
    if (a->text) return decode_text(r, a, to, error);
    iso_buffer packed = {0}, plain = {0};
    iso_status status = iso_reading_reserve(&r->text, &packed, (size_t)given + 4, 1, 0, error);
    if (status == ISO_OK) status = iso_reading_reserve(&r->text, &plain, (size_t)bytes + 4, 1, 0, error);
    if (status == ISO_OK) status = decode_bytes(r, a, bytes, packed.data, plain.data, error);
    for (uint64_t i = 0; i < count && status == ISO_OK; i++) {
        const uint64_t from = a->by_columns ? i % a->columns * a->rows + i / a->columns : i;
        to[i] = iso_scalar_load((unsigned char *)plain.data + from * each, a->scalar, a->big_endian);
    }
    iso_reading_free(&r->text, &packed);
    iso_reading_free(&r->text, &plain);
    return status;
}

/* Takes blanks out of base64, which some writers break into lines; returns its new end. */
static const char *without_blanks(const char *begin, const char *end) {
    char *to = (char *)(uintptr_t)begin; /* (in the text that was loaded) */
    for (const char *at = begin; at < end; at++)
        if (!isspace((unsigned char)*at)) *to++ = *at;
    return to;
}

static iso_status add_rows(iso_mesh_reading *r, const double *numbers, uint64_t rows, bool points,
                           iso_error *error) {
    for (uint64_t i = 0; i < rows; i++, numbers += 3) {
        const double p[3] = {-numbers[0], -numbers[1], numbers[2]};
        uint32_t corners[3];
        for (int k = 0; k < 3 && !points; k++) {
            if (!(numbers[k] >= 0 && numbers[k] < UINT32_MAX))
                return iso_fail(error, ISO_ERR_FORMAT, "%s: triangle %llu names vertex %g", r->path,
                                (unsigned long long)i + 1, numbers[k]);
            corners[k] = (uint32_t)numbers[k];
        }
        ISO_TRY(points ? iso_mesh_add_vertex(r, p, error)
                       : iso_mesh_add_triangle(r, corners[0], corners[1], corners[2], error));
    }
    return ISO_OK;
}

/* Decodes the array that begins with `tag`, of 1 or 3 columns, into `numbers`, the caller's. */
static iso_status decode_array(iso_mesh_reading *r, iso_xml *xml, const iso_xml_tag *tag, unsigned columns,
                               uint64_t *rows, iso_buffer *numbers, iso_error *error) {
    gii_array a = {0};
    iso_xml_tag next;
    ISO_TRY(describe(r, tag, columns, &a, error));
    do
        if (!iso_xml_next(xml, &next)) return iso_fail(error, ISO_ERR_IO, "%s: truncated", r->path);
    while (!iso_xml_is(&next, "Data"));
    for (a.begin = next.end + 1; a.begin < xml->end && isspace((unsigned char)*a.begin);) a.begin++;
    if (!iso_xml_next(xml, &next)) return iso_fail(error, ISO_ERR_IO, "%s: truncated", r->path);
    a.end = next.text - 1;
    if (!a.text) a.end = without_blanks(a.begin, a.end);
    *rows = a.rows;
    return decode(r, &a, numbers, error);
}

static bool is_mesh_array(const iso_xml_tag *tag, bool *points) {
    *points = iso_xml_attribute_is(tag, "Intent", "NIFTI_INTENT_POINTSET");
    return *points || iso_xml_attribute_is(tag, "Intent", "NIFTI_INTENT_TRIANGLE");
}

/* Reads the array that begins with `tag` if it is the first one of points, or of triangles. */
static iso_status take_array(iso_mesh_reading *r, iso_xml *xml, const iso_xml_tag *tag, iso_error *error) {
    bool points;
    uint64_t rows = 0;
    iso_buffer numbers = {0};
    if (!is_mesh_array(tag, &points) || (points ? r->vertex_count : r->triangle_count)) return ISO_OK;
    iso_status status = decode_array(r, xml, tag, 3, &rows, &numbers, error);
    if (status == ISO_OK) status = add_rows(r, numbers.data, rows, points, error);
    iso_reading_free(&r->text, &numbers);
    return status;
}

static iso_status read_arrays(iso_mesh_reading *r, const iso_buffer *text, size_t bytes, iso_error *error) {
    iso_xml xml = {text->data, (const char *)text->data + bytes};
    iso_xml_tag tag;
    bool is_gifti = false;
    while (iso_xml_next(&xml, &tag)) {
        is_gifti |= iso_xml_is(&tag, "GIFTI");
        if (iso_xml_is(&tag, "/GIFTI")) {
            if (r->vertex_count && r->triangle_count) return ISO_OK;
            return iso_fail(error, ISO_ERR_FORMAT,
                            "%s: holds no surface: data of GIFTI, such as .func.gii, have none of their own",
                            r->path);
        }
        if (is_gifti && iso_xml_is(&tag, "DataArray")) ISO_TRY(take_array(r, &xml, &tag, error));
    }
    return is_gifti ? iso_fail(error, ISO_ERR_IO, "%s: truncated", r->path)
                    : bad(r, "it has no element GIFTI", error);
}

iso_status iso_mesh_read_gii(iso_mesh_reading *r, iso_error *error) {
    iso_buffer text = {0};
    size_t bytes;
    r->text = iso_reading_begin(r->path, NULL, &r->report);
    iso_status status = iso_reading_load(&r->text, &text, &bytes, error);
    if (status == ISO_OK) status = read_arrays(r, &text, bytes, error);
    iso_reading_free(&r->text, &text);
    return status;
}

/* ---- data of vertices */

/* Of a data array: its place among them, and its name. */
typedef struct gii_data {
    iso_xml_tag tag;
    iso_xml xml; /* behind the tag */
    unsigned number;
    char name[ISO_XML_TEXT];
} gii_data;

/* Copies the text up to the next tag, less CDATA's marks. */
static void copy_text(const char *begin, const char *end, char text[ISO_XML_TEXT]) {
    static const char open[] = "![CDATA[";
    size_t count = (size_t)(end - begin);
    if (count >= sizeof open - 1 + 2 && memcmp(begin, open, sizeof open - 1) == 0) {
        begin += sizeof open - 1;
        count -= sizeof open - 1 + 2; /* and ]] */
    }
    if (count >= ISO_XML_TEXT) count = ISO_XML_TEXT - 1;
    memcpy(text, begin, count);
    text[count] = 0;
}

/* Finds the name in an array's metadata: <Name>Name</Name> <Value>its name</Value>, each perhaps as CDATA,
 * which ends where xml.h finds the end of a tag. */
static void find_name(gii_data *data) {
    iso_xml xml = data->xml;
    iso_xml_tag tag;
    bool is_name = false;
    while (iso_xml_next(&xml, &tag) && !iso_xml_is(&tag, "Data") && !iso_xml_is(&tag, "/DataArray")) {
        const bool name = iso_xml_is(&tag, "Name"), value = iso_xml_is(&tag, "Value");
        if (!name && !value) continue;
        const char *begin = tag.end + 1;
        if (!iso_xml_next(&xml, &tag)) return;
        char text[ISO_XML_TEXT];
        if (tag.text == begin + 1 && *tag.text == '!')
            copy_text(tag.text, tag.end, text);
        else
            copy_text(begin, tag.text - 1, text);
        if (name) is_name = strcmp(text, "Name") == 0;
        if (value && is_name) {
            memcpy(data->name, text, sizeof text);
            return;
        }
    }
}

/* Finds the data array that is asked for. */
static iso_status find_data(const iso_mesh_reading *r, const iso_buffer *text, size_t bytes,
                            const char *array, gii_data *data, iso_error *error) {
    iso_xml xml = {text->data, (const char *)text->data + bytes};
    iso_xml_tag tag;
    bool points, is_gifti = false;
    unsigned count = 0;
    char *end;
    const unsigned long wanted = array ? strtoul(array, &end, 10) : 0;
    const bool by_number = !array || (isdigit((unsigned char)*array) && !*end);
    while (iso_xml_next(&xml, &tag)) {
        is_gifti |= iso_xml_is(&tag, "GIFTI");
        if (!is_gifti || !iso_xml_is(&tag, "DataArray") || is_mesh_array(&tag, &points)) continue;
        *data = (gii_data){.tag = tag, .xml = xml, .number = count++};
        find_name(data);
        if (by_number ? data->number == wanted : strcmp(data->name, array) == 0) return ISO_OK;
    }
    if (!is_gifti) return bad(r, "it has no element GIFTI", error);
    if (!count)
        return iso_fail(error, ISO_ERR_FORMAT, "%s: holds no data of vertices, but a surface alone", r->path);
    return iso_fail(error, ISO_ERR_USAGE, "%s: there is no array %.60s: it has %u (0 ..)", r->path, array,
                    count);
}

/* A component of a colour, 0 .. 1, of a tag <Label Key= Red= ..>. */
static uint8_t component_of(const iso_xml_tag *tag, const char *name) {
    char text[ISO_XML_TEXT];
    const double share = iso_xml_attribute(tag, name, text) ? strtod(text, NULL) : 0;
    return (uint8_t)(share > 0 ? share < 1 ? share * 255 + 0.5 : 255 : 0);
}

typedef struct gii_label {
    double key;
    uint8_t color[3];
} gii_label;

static int compare_labels(const void *a, const void *b) {
    const double x = ((const gii_label *)a)->key, y = ((const gii_label *)b)->key;
    return (x > y) - (x < y);
}

/* Takes the labels of the file's table, but those without opacity, sorted by their keys. */
static iso_status take_labels(iso_mesh_reading *r, iso_xml xml, iso_buffer *labels, size_t *count,
                              iso_error *error) {
    iso_xml_tag tag;
    char text[ISO_XML_TEXT];
    while (iso_xml_next(&xml, &tag)) {
        if (!iso_xml_is(&tag, "Label")) continue;
        if (iso_xml_attribute(&tag, "Alpha", text) && !(strtod(text, NULL) > 0)) continue;
        if (!iso_xml_attribute(&tag, "Key", text) && !iso_xml_attribute(&tag, "Index", text)) continue;
        const double key = strtod(text, NULL);
        if (!isfinite(key)) continue;
        ISO_TRY(iso_reading_reserve(&r->text, labels, *count + 1, sizeof(gii_label), *count, error));
        ((gii_label *)labels->data)[(*count)++] = (gii_label){
            key, {component_of(&tag, "Red"), component_of(&tag, "Green"), component_of(&tag, "Blue")}};
    }
    if (*count) qsort(labels->data, *count, sizeof(gii_label), compare_labels);
    return ISO_OK;
}

/* Gives the vertices the colours of their labels; those of others have no number. */
static iso_status color_labels(iso_mesh_reading *r, const iso_buffer *text, size_t bytes,
                               iso_vertex_values *values, iso_error *error) {
    iso_buffer labels = {0};
    size_t count = 0;
    const iso_xml xml = {text->data, (const char *)text->data + bytes};
    const iso_status status = take_labels(r, xml, &labels, &count, error);
    for (size_t i = 0; i < values->count && status == ISO_OK; i++) {
        const gii_label key = {(double)values->values[i], {0, 0, 0}};
        const gii_label *label =
            count && isfinite(key.key) ? bsearch(&key, labels.data, count, sizeof key, compare_labels) : NULL;
        if (label)
            memcpy(values->colors[i], label->color, 3);
        else
            values->values[i] = NAN;
    }
    iso_reading_free(&r->text, &labels);
    return status;
}

static iso_status read_data(iso_mesh_reading *r, const iso_buffer *text, size_t bytes, const char *array,
                            iso_buffer *numbers, iso_vertex_values *values, iso_error *error) {
    gii_data data;
    uint64_t rows = 0;
    ISO_TRY(find_data(r, text, bytes, array, &data, error));
    const bool labels = iso_xml_attribute_is(&data.tag, "Intent", "NIFTI_INTENT_LABEL");
    ISO_TRY(decode_array(r, &data.xml, &data.tag, 1, &rows, numbers, error));
    ISO_TRY(iso_vertex_values_reserve(values, (size_t)rows, labels, error));
    for (size_t i = 0; i < values->count; i++) values->values[i] = (float)((double *)numbers->data)[i];
    return labels ? color_labels(r, text, bytes, values, error) : ISO_OK;
}

iso_status iso_vertex_values_read_gii(iso_mesh_reading *r, const char *array, iso_vertex_values *values,
                                      iso_error *error) {
    iso_buffer text = {0}, numbers = {0};
    size_t bytes;
    r->text = iso_reading_begin(r->path, NULL, &r->report);
    iso_status status = iso_reading_load(&r->text, &text, &bytes, error);
    if (status == ISO_OK) status = read_data(r, &text, bytes, array, &numbers, values, error);
    iso_reading_free(&r->text, &numbers);
    iso_reading_free(&r->text, &text);
    return status;
}
