/* Meshes in GIFTI, the surface format of neuroimaging ("GIFTI Surface Data Format", version 1.0, 2011):
 * XML with arrays in text or in base64, as they are or compressed by zlib. The first array of points and
 * the first one of triangles are read. Coordinates are RAS, as GIFTI's coordinate systems are, and turned
 * to LPS; matrices in the file are not applied, as other readers do. */
#include <ctype.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

#include "io/common/scalar_load.h"
#include "io/common/xml.h"
#include "io/mesh/mesh_format.h"

typedef struct gii_array {
    iso_scalar scalar;
    uint64_t rows;
    bool text, zlib, big_endian, by_columns;
    const char *begin, *end; /* its characters */
} gii_array;

static iso_status bad(const iso_mesh_reading *r, const char *what, iso_error *error) {
    return iso_fail(error, ISO_ERR_FORMAT, "%s: not a readable GIFTI surface: %s", r->path, what);
}

/* Describes an array of three columns by its tag; its characters are not known yet. */
static iso_status describe(const iso_mesh_reading *r, const iso_xml_tag *tag, gii_array *a,
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
    if (!iso_xml_attribute_is(tag, "Dim1", "3") || !a->rows || a->rows > UINT32_MAX)
        return bad(r, "its points or triangles are not rows of three numbers", error);
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
    for (uint64_t i = 0; i < 3 * a->rows; i++) {
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

/* Decodes an array into rows of three numbers. Its size is believed as far as its characters allow. */
static iso_status decode(iso_mesh_reading *r, const gii_array *a, iso_buffer *numbers, iso_error *error) {
    const uint64_t count = 3 * a->rows, each = iso_scalar_size(a->scalar), bytes = count * each,
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
        const uint64_t from = a->by_columns ? i % 3 * a->rows + i / 3 : i;
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

/* Reads the array that begins with `tag` if it is the first one of points, or of triangles. */
static iso_status take_array(iso_mesh_reading *r, iso_xml *xml, const iso_xml_tag *tag, iso_error *error) {
    const bool points = iso_xml_attribute_is(tag, "Intent", "NIFTI_INTENT_POINTSET");
    gii_array a = {0};
    iso_xml_tag next;
    iso_buffer numbers = {0};
    if (!points && !iso_xml_attribute_is(tag, "Intent", "NIFTI_INTENT_TRIANGLE")) return ISO_OK;
    if (points ? r->vertex_count : r->triangle_count) return ISO_OK;
    ISO_TRY(describe(r, tag, &a, error));
    do
        if (!iso_xml_next(xml, &next)) return iso_fail(error, ISO_ERR_IO, "%s: truncated", r->path);
    while (!iso_xml_is(&next, "Data"));
    for (a.begin = next.end + 1; a.begin < xml->end && isspace((unsigned char)*a.begin);) a.begin++;
    if (!iso_xml_next(xml, &next)) return iso_fail(error, ISO_ERR_IO, "%s: truncated", r->path);
    a.end = next.text - 1;
    if (!a.text) a.end = without_blanks(a.begin, a.end);
    iso_status status = decode(r, &a, &numbers, error);
    if (status == ISO_OK) status = add_rows(r, numbers.data, a.rows, points, error);
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
