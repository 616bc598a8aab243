/* vtp_polydata: polygonal data in VTK's XML format ("VTK XML Formats", docs.vtk.org): the points, the lines
 * and the arrays over both, of all pieces, or the points, polygons and strips of a surface. Vertices are
 * skipped.
 *
 * Arrays are text or bytes. Bytes are raw or in base64, inside the element or appended after all elements,
 * and may be divided into blocks that are compressed by zlib. They begin with numbers that state their
 * length; in compressed arrays these numbers are encoded in base64 separately.
 *
 * VTK's own reader is not used, because it allocates as much memory as the counts of pieces state, and uses
 * indices without checking them. */
#include <ctype.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <zlib.h>

#include "base/file.h"
#include "base/memory.h"
#include "io/common/rows.h"
#include "io/common/scalar_load.h"
#include "io/common/xml.h"
#include "io/polydata/faces.h"

enum { ARRAYS = 512, NAME = ISO_COLUMN_NAME };

typedef enum section { OTHER, POINT_DATA, CELL_DATA, POINTS, LINES, POLYGONS, STRIPS } section;

/* Where and how the values of an array are stored. */
typedef struct array {
    section in;
    char name[NAME];
    iso_scalar scalar;
    uint64_t components;
    iso_role role;
    enum { ASCII, BASE64, RAW } encoding;
    const char *begin; /* where the values begin */
} array;

typedef struct vtp {
    iso_polydata *data;
    iso_buffer text;
    iso_xml markup;       /* the rest of it */
    const char *appended; /* where offsets into the appended data count from; NULL: there is no such data */
    const char *end_of_data; /* the end of the file */
    bool appended_raw, big_endian, compressed;
    size_t header; /* bytes of each number in the header of an array: 4 or 8 */
    section in;
    char roles[3][NAME];                         /* the names of the active normals, vectors and tensors */
    uint64_t points, lines, cells_before, cells; /* counts of the current piece; cells_before: cells that
                                                    precede its lines */
    uint64_t polygons, strips;
    array arrays[ARRAYS];
    int array_count;
    iso_buffer values, sizes; /* the decoded bytes of an array; the numbers of its header */
    uint64_t bytes;           /* number of bytes in `values` */
    bool has_piece;
} vtp;

static iso_status bad(const vtp *v, const char *what, iso_error *error) {
    return iso_fail(error, ISO_ERR_FORMAT, "%s: not a readable .vtp file: %s", v->data->reading->path, what);
}

static iso_status ends(const vtp *v, iso_error *error) {
    return iso_fail(error, ISO_ERR_IO, "%s: truncated", v->data->reading->path);
}

/* ---- markup */

/* Reads a count; returns `missing` if the attribute is missing. */
static iso_status read_count(const vtp *v, const iso_xml_tag *t, const char *name, uint64_t missing,
                             uint64_t *count, iso_error *error) {
    char value[ISO_XML_TEXT];
    *count = missing;
    if (!iso_xml_attribute(t, name, value)) return ISO_OK;
    char *digits = value + strspn(value, " ");
    if (digits[strspn(digits, "0123456789 ")] || !*digits || strlen(digits) > 15)
        return bad(v, "a count is not possible", error);
    *count = strtoull(digits, NULL, 10);
    return ISO_OK;
}

/* ---- bytes of arrays */

/* The part of an array's data that has not been read yet. */
typedef struct source {
    const char *at, *end;
    bool base64;
} source;

/* Returns the number of characters that encode `bytes` bytes. */
static uint64_t characters(const source *s, uint64_t bytes) {
    return s->base64 ? (bytes + 2) / 3 * 4 : bytes;
}

static bool has_bytes(const source *s, uint64_t bytes) {
    return bytes <= (uint64_t)(s->end - s->at) && characters(s, bytes) <= (uint64_t)(s->end - s->at);
}

/* Copies the next bytes, which must exist, and advances behind their characters. In base64 more bytes can
 * follow only if this number is a multiple of three. Returns false if the text is not base64. */
static bool take_bytes(source *s, uint64_t bytes, unsigned char *to) {
    if (!s->base64) {
        memcpy(to, s->at, bytes);
        s->at += bytes;
        return true;
    }
    return iso_base64_take(&s->at, bytes, to);
}

/* Reads a number of an array's header, as an integer because lengths must not be rounded. */
static uint64_t load_count(const vtp *v, const unsigned char *bytes) {
    uint64_t count = 0;
    for (size_t i = 0; i < v->header; i++) count = count << 8 | bytes[v->big_endian ? i : v->header - 1 - i];
    return count;
}

/* Reads an array that is not compressed: its length and its bytes, which are encoded together. */
static iso_status take_plain(vtp *v, source s, iso_error *error) {
    unsigned char head[8];
    source again = s;
    if (!has_bytes(&s, v->header)) return ends(v, error);
    if (!take_bytes(&s, v->header, head)) return bad(v, "an array is not in base64", error);
    v->bytes = load_count(v, head);
    if (v->bytes > (uint64_t)(s.end - s.at) || !has_bytes(&again, v->header + v->bytes))
        return ends(v, error);
    ISO_TRY(iso_reading_reserve(v->data->reading, &v->values, (size_t)(v->header + v->bytes), 1, 0, error));
    unsigned char *to = v->values.data;
    if (!take_bytes(&again, v->header + v->bytes, to)) return bad(v, "an array is not in base64", error);
    memmove(to, to + v->header, (size_t)v->bytes);
    return ISO_OK;
}

/* Reads the header of a compressed array into v->sizes: the number of blocks, the size of a block, the size
 * of a smaller last block, and the compressed size of each. */
static iso_status take_sizes(vtp *v, source *s, uint64_t head[3], iso_error *error) {
    unsigned char bytes[24];
    if (!has_bytes(s, 3 * v->header)) return ends(v, error);
    if (!take_bytes(s, 3 * v->header, bytes)) return bad(v, "an array is not in base64", error);
    for (size_t i = 0; i < 3; i++) head[i] = load_count(v, bytes + i * v->header);
    if (head[0] > (uint64_t)(s->end - s->at) / v->header || !has_bytes(s, head[0] * v->header))
        return ends(v, error);
    ISO_TRY(iso_reading_reserve(v->data->reading, &v->sizes, (size_t)head[0] + 1, v->header, 0, error));
    return take_bytes(s, head[0] * v->header, v->sizes.data) ? ISO_OK
                                                             : bad(v, "an array is not in base64", error);
}

/* Checks the sizes: all compressed bytes exist, and no block is larger than 1032 times its compressed size,
 * the most that zlib can reach. Sets v->bytes and *packed. */
static iso_status check_sizes(vtp *v, const source *s, const uint64_t head[3], uint64_t *packed,
                              iso_error *error) {
    const uint64_t blocks = head[0], last = head[2] ? head[2] : head[1];
    *packed = v->bytes = 0;
    if (blocks == 0) return ISO_OK;
    for (uint64_t i = 0; i < blocks; i++) {
        const uint64_t size = load_count(v, (const unsigned char *)v->sizes.data + i * v->header);
        if (!has_bytes(s, size) || !has_bytes(s, *packed += size)) return ends(v, error);
    }
    if (__builtin_mul_overflow(blocks - 1, head[1], &v->bytes) ||
        __builtin_add_overflow(v->bytes, last, &v->bytes) || v->bytes / 1032 > *packed || last > head[1])
        return bad(v, "the sizes of compressed blocks are not possible", error);
    return ISO_OK;
}

static iso_status unpack(vtp *v, const uint64_t head[3], const unsigned char *packed, iso_error *error) {
    unsigned char *to = v->values.data;
    for (uint64_t i = 0; i < head[0]; i++) {
        const uint64_t size = load_count(v, (const unsigned char *)v->sizes.data + i * v->header),
                       wanted = i + 1 < head[0] || head[2] == 0 ? head[1] : head[2];
        uLongf got = (uLongf)wanted;
        if (uncompress(to, &got, packed, (uLong)size) != Z_OK || got != wanted)
            return iso_fail(error, ISO_ERR_IO, "%s: corrupt: a compressed block", v->data->reading->path);
        packed += size;
        to += wanted;
    }
    return ISO_OK;
}

static iso_status take_compressed(vtp *v, source s, iso_error *error) {
    uint64_t head[3], packed;
    ISO_TRY(take_sizes(v, &s, head, error));
    ISO_TRY(check_sizes(v, &s, head, &packed, error));
    iso_reading *reading = v->data->reading;
    iso_buffer bytes = {0};
    ISO_TRY(iso_reading_reserve(reading, &v->values, (size_t)v->bytes + 1, 1, 0, error));
    if (!s.base64) return unpack(v, head, (const unsigned char *)s.at, error);
    ISO_TRY(iso_reading_reserve(reading, &bytes, (size_t)packed + 1, 1, 0, error));
    iso_status status = take_bytes(&s, packed, bytes.data) ? unpack(v, head, bytes.data, error)
                                                           : bad(v, "an array is not in base64", error);
    iso_reading_free(reading, &bytes);
    return status;
}

/* ---- numbers of arrays */

/* Reads all numbers of a text array as doubles. */
static iso_status take_text(vtp *v, const array *a, uint64_t count, iso_error *error) {
    const char *at = a->begin;
    /* a number takes two characters */
    if (count > (uint64_t)(v->end_of_data - at)) return ends(v, error);
    ISO_TRY(iso_reading_reserve(v->data->reading, &v->values, (size_t)count + 1, sizeof(double), 0, error));
    for (uint64_t i = 0; i < count; i++) {
        char *end;
        ((double *)v->values.data)[i] = strtod(at, &end);
        if (end == at || (*end && *end != '<' && !isspace((unsigned char)*end)))
            return bad(v, "an array has fewer numbers than it should, or others", error);
        at = end;
    }
    return ISO_OK;
}

/* Decodes an array, which must have `count` numbers, for get_number. */
static iso_status decode(vtp *v, const array *a, uint64_t count, iso_error *error) {
    if (a->encoding == ASCII) return take_text(v, a, count, error);
    const source s = {a->begin, v->end_of_data, a->encoding == BASE64};
    ISO_TRY(v->compressed ? take_compressed(v, s, error) : take_plain(v, s, error));
    uint64_t wanted;
    if (__builtin_mul_overflow(count, iso_scalar_size(a->scalar), &wanted) || v->bytes != wanted)
        return iso_fail(error, ISO_ERR_FORMAT, "%s: damaged: array '%.60s' has %llu bytes, not %llu",
                        v->data->reading->path, a->name, (unsigned long long)v->bytes,
                        (unsigned long long)wanted);
    return ISO_OK;
}

static double get_number(const vtp *v, const array *a, uint64_t i) {
    if (a->encoding == ASCII) return ((const double *)v->values.data)[i];
    const unsigned char *bytes = v->values.data;
    return iso_scalar_load(bytes + i * iso_scalar_size(a->scalar), a->scalar, v->big_endian);
}

static const array *find_array(const vtp *v, section in, const char *name) {
    for (int i = 0; i < v->array_count; i++)
        if (v->arrays[i].in == in && (!name || strcmp(v->arrays[i].name, name) == 0)) return &v->arrays[i];
    return NULL;
}

/* ---- pieces */

static iso_status take_points(vtp *v, iso_error *error) {
    const array *a = find_array(v, POINTS, NULL);
    if (v->points == 0) return ISO_OK;
    if (!a || a->components != 3) return bad(v, "a piece has no points", error);
    if (v->points > UINT32_MAX)
        return iso_fail(error, ISO_ERR_LIMIT, "%s: too many points", v->data->reading->path);
    if (!v->has_piece) v->data->keep_floats = a->scalar == ISO_SCALAR_FLOAT;
    ISO_TRY(decode(v, a, 3 * v->points, error));
    ISO_TRY(iso_polydata_reserve(v->data, v->data->point_count + (size_t)v->points, error));
    for (uint64_t i = 0; i < v->points; i++) {
        double p[3];
        for (uint64_t axis = 0; axis < 3; axis++) p[axis] = get_number(v, a, 3 * i + axis);
        iso_polydata_add_point(v->data, p);
    }
    return ISO_OK;
}

/* Reads the lines of a piece, which refer to points of the piece; `first` is the number of its first
 * point. */
static iso_status take_lines(vtp *v, uint64_t first, iso_error *error) {
    const array *offsets = find_array(v, LINES, "offsets"), *points = find_array(v, LINES, "connectivity");
    const uint64_t indices = v->data->index_count;
    uint64_t last = 0;
    if (v->lines == 0) return ISO_OK;
    if (!offsets || !points) return bad(v, "lines without offsets and connectivity", error);
    ISO_TRY(decode(v, offsets, v->lines, error));
    for (uint64_t i = 0; i < v->lines; i++) {
        const double offset = get_number(v, offsets, i);
        if (!(offset >= (double)last && offset < 1e15))
            return bad(v, "the offsets of its lines do not rise", error);
        last = (uint64_t)offset;
        v->data->index_count = (size_t)(indices + last); /* ends the line there */
        ISO_TRY(iso_polydata_end_line(v->data, error));
    }
    v->data->index_count = (size_t)indices;
    ISO_TRY(decode(v, points, last, error));
    for (uint64_t i = 0; i < last; i++) {
        const double point = get_number(v, points, i);
        if (!(point >= 0 && point < (double)v->points))
            return bad(v, "a line names a point that is not there", error);
        ISO_TRY(iso_polydata_add_index(v->data, (uint32_t)(first + (uint64_t)point), error));
    }
    return ISO_OK;
}

/* Reads the corners of the faces that end at `offsets`. */
static iso_status take_corners(vtp *v, section in, const double *offsets, uint64_t count, uint64_t first,
                               iso_error *error) {
    const array *points = find_array(v, in, "connectivity");
    const uint64_t last = count ? (uint64_t)offsets[count - 1] : 0;
    if (!points) return bad(v, "faces without offsets and connectivity", error);
    ISO_TRY(decode(v, points, last, error));
    for (uint64_t face = 0, i = 0; face < count; face++) {
        iso_face f = {.strip = in == STRIPS};
        for (; i < (uint64_t)offsets[face]; i++) {
            const double point = get_number(v, points, i);
            if (!(point >= 0 && point < (double)v->points))
                return bad(v, "a face names a point that is not there", error);
            ISO_TRY(iso_faces_add_corner(v->data->reading, v->data->surface, &f,
                                         (uint32_t)(first + (uint64_t)point), error));
        }
        ISO_TRY(iso_faces_end_face(v->data->reading, v->data->surface, &f, error));
    }
    return ISO_OK;
}

/* Reads the polygons or strips of a piece; `first` is the number of its first point. */
static iso_status take_faces(vtp *v, section in, uint64_t count, uint64_t first, iso_error *error) {
    const array *offsets = find_array(v, in, "offsets");
    iso_buffer buffer = {0};
    if (count == 0) return ISO_OK;
    if (!offsets) return bad(v, "faces without offsets and connectivity", error);
    ISO_TRY(decode(v, offsets, count, error));
    ISO_TRY(iso_reading_reserve(v->data->reading, &buffer, (size_t)count, sizeof(double), 0, error));
    double *ends = buffer.data, last = 0;
    iso_status status = ISO_OK;
    for (uint64_t i = 0; i < count && status == ISO_OK; i++, last = ends[i - 1]) {
        ends[i] = get_number(v, offsets, i);
        if (!(ends[i] >= last && ends[i] < 1e15))
            status = bad(v, "the offsets of its faces do not rise", error);
    }
    if (status == ISO_OK) status = take_corners(v, in, ends, count, first, error);
    iso_reading_free(v->data->reading, &buffer);
    return status;
}

/* Finds the column of an array, or makes it. *column -1: the array was missing in an earlier piece and is
 * ignored. */
static iso_status find_column(vtp *v, const array *a, int *column, iso_error *error) {
    const bool per_line = a->in == CELL_DATA;
    *column = -1;
    for (int i = 0; i < v->data->column_count; i++) {
        const iso_column *c = iso_polydata_column(v->data, i);
        if (c->per_line == per_line && (uint64_t)c->components == a->components &&
            strcmp(c->name, a->name) == 0)
            *column = i;
    }
    if (*column >= 0 || v->has_piece) return ISO_OK;
    return iso_polydata_add_column(v->data, a->name, (int)a->components, per_line, a->role, column, error);
}

/* Reads an array over points or cells; `first`: the number of the piece's first item. */
static iso_status take_column(vtp *v, const array *a, uint64_t first, iso_error *error) {
    const bool cells = a->in == CELL_DATA;
    const uint64_t items = cells ? v->lines : v->points, all = cells ? v->cells : v->points,
                   skipped = cells ? v->cells_before : 0;
    int number;
    if (items == 0 || a->components < 1 || a->components > 64) return ISO_OK;
    ISO_TRY(find_column(v, a, &number, error));
    if (number < 0) return ISO_OK;
    iso_column *column = iso_polydata_column(v->data, number);
    const size_t each = (size_t)column->components;
    ISO_TRY(decode(v, a, all * a->components, error));
    ISO_TRY(iso_reading_reserve(v->data->reading, &column->values, (size_t)(first + items),
                                each * sizeof(float), (size_t)first, error));
    float *to = (float *)column->values.data + first * each;
    for (uint64_t i = 0; i < items * each; i++) to[i] = (float)get_number(v, a, skipped * each + i);
    return ISO_OK;
}

/* Sets the columns to NaN for those items of this piece for which it has no array. */
static iso_status clear_columns(vtp *v, bool per_line, uint64_t first, uint64_t items, iso_error *error) {
    for (int i = 0; i < v->data->column_count; i++) {
        iso_column *column = iso_polydata_column(v->data, i);
        const size_t each = (size_t)column->components;
        if (column->per_line != per_line || !column->values.data) continue;
        ISO_TRY(iso_reading_reserve(v->data->reading, &column->values, (size_t)(first + items),
                                    each * sizeof(float), (size_t)first, error));
        float *to = (float *)column->values.data + first * each;
        for (uint64_t k = 0; k < items * each; k++) to[k] = (float)NAN;
    }
    return ISO_OK;
}

static iso_status take_piece(vtp *v, iso_error *error) {
    const uint64_t point = v->data->point_count, line = v->data->line_count;
    ISO_TRY(take_points(v, error));
    if (!v->data->points_only) ISO_TRY(take_lines(v, point, error));
    if (v->data->surface) {
        ISO_TRY(take_faces(v, POLYGONS, v->polygons, point, error));
        ISO_TRY(take_faces(v, STRIPS, v->strips, point, error));
    }
    ISO_TRY(clear_columns(v, false, point, v->points, error));
    if (!v->data->points_only) ISO_TRY(clear_columns(v, true, line, v->lines, error));
    for (int i = 0; i < v->array_count && !v->data->surface; i++) {
        const array *a = &v->arrays[i];
        if (a->in == POINT_DATA) ISO_TRY(take_column(v, a, point, error));
        if (a->in == CELL_DATA && !v->data->points_only) ISO_TRY(take_column(v, a, line, error));
    }
    v->has_piece = v->has_piece || v->points > 0;
    v->array_count = 0;
    return ISO_OK;
}

/* ---- elements */

static iso_status begin_piece(vtp *v, const iso_xml_tag *t, iso_error *error) {
    ISO_TRY(read_count(v, t, "NumberOfPoints", 0, &v->points, error));
    ISO_TRY(read_count(v, t, "NumberOfVerts", 0, &v->cells_before, error));
    ISO_TRY(read_count(v, t, "NumberOfLines", 0, &v->lines, error));
    ISO_TRY(read_count(v, t, "NumberOfStrips", 0, &v->strips, error));
    ISO_TRY(read_count(v, t, "NumberOfPolys", 0, &v->polygons, error));
    v->cells = v->cells_before + v->lines + v->strips + v->polygons;
    v->array_count = 0;
    return ISO_OK;
}

static bool scalar_of(const char *type, iso_scalar *scalar) {
    static const char *const names[] = {"UInt8", "Int8",   "UInt16", "Int16",   "UInt32",
                                        "Int32", "UInt64", "Int64",  "Float32", "Float64"};
    for (int i = 0; i < 10; i++)
        if (strcmp(type, names[i]) == 0) {
            *scalar = (iso_scalar)i;
            return true;
        }
    return false;
}

static iso_role role_of(const vtp *v, const array *a) {
    static const iso_role roles[] = {ISO_ROLE_NORMAL, ISO_ROLE_VECTOR, ISO_ROLE_TENSOR};
    static const uint64_t components[] = {3, 3, 9};
    if (a->scalar == ISO_SCALAR_UINT8 && (a->components == 3 || a->components == 4)) return ISO_ROLE_COLOR;
    for (int i = 0; i < 3; i++)
        if (a->components == components[i] && *a->name && strcmp(a->name, v->roles[i]) == 0) return roles[i];
    return ISO_ROLE_NONE;
}

/* Finds where the values of an array begin: after its tag, or at an offset in the appended data. */
static iso_status locate(vtp *v, const iso_xml_tag *t, array *a, iso_error *error) {
    char format[ISO_XML_TEXT] = "ascii";
    uint64_t offset;
    iso_xml_attribute(t, "format", format);
    a->begin = t->end + 1;
    a->encoding = strcmp(format, "ascii") == 0 ? ASCII : BASE64;
    if (strcmp(format, "appended") == 0) {
        ISO_TRY(read_count(v, t, "offset", UINT64_MAX, &offset, error));
        if (!v->appended) return bad(v, "there is no appended data", error);
        if (offset > (uint64_t)(v->end_of_data - v->appended)) return ends(v, error);
        a->begin = v->appended + offset;
        a->encoding = v->appended_raw ? RAW : BASE64;
    } else if (a->encoding == BASE64 && strcmp(format, "binary") != 0)
        return bad(v, "an array of an unknown format", error);
    while (a->encoding == BASE64 && a->begin < v->end_of_data && isspace((unsigned char)*a->begin))
        a->begin++;
    return ISO_OK;
}

static iso_status take_array(vtp *v, const iso_xml_tag *t, iso_error *error) {
    char text[ISO_XML_TEXT] = "";
    array a = {.in = v->in};
    if (v->in == OTHER) return ISO_OK;
    if (v->array_count == ARRAYS) return bad(v, "more than 512 arrays", error);
    if (!iso_xml_attribute(t, "type", text) || !scalar_of(text, &a.scalar))
        return ISO_OK; /* bits and strings */
    if (iso_xml_attribute(t, "Name", text)) memcpy(a.name, text, sizeof a.name - 1);
    ISO_TRY(read_count(v, t, "NumberOfComponents", 1, &a.components, error));
    a.role = role_of(v, &a);
    ISO_TRY(locate(v, t, &a, error));
    v->arrays[v->array_count++] = a;
    return ISO_OK;
}

static void begin_point_data(vtp *v, const iso_xml_tag *t) {
    static const char *const names[] = {"Normals", "Vectors", "Tensors"};
    char text[ISO_XML_TEXT];
    v->in = POINT_DATA;
    for (int i = 0; i < 3; i++) {
        v->roles[i][0] = 0;
        if (iso_xml_attribute(t, names[i], text)) memcpy(v->roles[i], text, NAME - 1);
    }
}

static iso_status take_tag(vtp *v, const iso_xml_tag *t, iso_error *error) {
    if (iso_xml_is(t, "Piece")) return begin_piece(v, t, error);
    if (iso_xml_is(t, "/Piece")) return take_piece(v, error);
    if (iso_xml_is(t, "DataArray")) return take_array(v, t, error);
    if (iso_xml_is(t, "PointData")) begin_point_data(v, t);
    if (iso_xml_is(t, "CellData")) v->in = CELL_DATA;
    if (iso_xml_is(t, "Points")) v->in = POINTS;
    if (iso_xml_is(t, "Lines")) v->in = LINES;
    if (iso_xml_is(t, "Polys")) v->in = POLYGONS;
    if (iso_xml_is(t, "Strips")) v->in = STRIPS;
    static const char *const others[] = {"/PointData", "/CellData", "/Points", "/Lines", "/Polys", "/Strips"};
    for (int i = 0; i < 6; i++)
        if (iso_xml_is(t, others[i])) v->in = OTHER;
    return ISO_OK;
}

/* ---- the file */

/* Finds the appended data, where the markup ends. */
static void find_appended(vtp *v) {
    const char *open = memmem(v->markup.at, (size_t)(v->markup.end - v->markup.at), "<AppendedData", 13);
    const char *close = open ? memchr(open, '>', (size_t)(v->markup.end - open)) : NULL;
    const char *mark = close ? memchr(close, '_', (size_t)(v->markup.end - close)) : NULL;
    if (!mark) return;
    const iso_xml_tag t = {open + 1, close};
    v->appended = mark + 1;
    v->appended_raw = iso_xml_attribute_is(&t, "encoding", "raw");
    v->markup.end = open;
}

static iso_status read_header(vtp *v, iso_error *error) {
    char text[ISO_XML_TEXT] = "";
    iso_xml_tag t;
    do
        if (!iso_xml_next(&v->markup, &t)) return bad(v, "it has no element VTKFile", error);
    while (!iso_xml_is(&t, "VTKFile"));
    if (!iso_xml_attribute(&t, "type", text) || strcmp(text, "PolyData") != 0)
        return iso_fail(error, ISO_ERR_FORMAT, "%s: holds a %.80s, not polygonal data",
                        v->data->reading->path, *text ? text : "VTKFile without a type");
    v->big_endian = iso_xml_attribute_is(&t, "byte_order", "BigEndian");
    v->header = iso_xml_attribute_is(&t, "header_type", "UInt64") ? 8 : 4;
    v->compressed = iso_xml_attribute(&t, "compressor", text) && *text;
    if (v->compressed && strcmp(text, "vtkZLibDataCompressor") != 0)
        return iso_fail(error, ISO_ERR_UNSUPPORTED, "%s: compressed by %.80s: only zlib is supported",
                        v->data->reading->path, text);
    return ISO_OK;
}

static iso_status read_file(vtp *v, iso_error *error) {
    size_t bytes;
    iso_xml_tag t;
    bool ended = false;
    ISO_TRY(iso_reading_load(v->data->reading, &v->text, &bytes, error));
    v->markup.at = v->text.data;
    v->markup.end = v->end_of_data = v->markup.at + bytes;
    ISO_TRY(read_header(v, error));
    find_appended(v);
    while (!ended && iso_xml_next(&v->markup, &t)) {
        ISO_TRY(take_tag(v, &t, error));
        ended = iso_xml_is(&t, "/PolyData");
    }
    return ended ? ISO_OK : ends(v, error);
}

iso_status iso_polydata_read_vtp(iso_polydata *data, iso_error *error) {
    vtp *v = iso_alloc_zero(1, sizeof *v);
    if (!v) return iso_fail_memory(error, data->reading->path);
    v->data = data;
    iso_status status = read_file(v, error);
    iso_reading_free(data->reading, &v->text);
    iso_reading_free(data->reading, &v->values);
    iso_reading_free(data->reading, &v->sizes);
    iso_free(v);
    return status;
}

/* ---- what is in a file ---- */

/* Whether an attribute such as NumberOfLines="12" of a tag is there and above 0. */
static bool has_some(const char *piece, const char *attribute) {
    const char *end = strchr(piece, '>'), *at = strstr(piece, attribute);
    return at && (!end || at < end) && strtod(at + strlen(attribute), NULL) > 0;
}

iso_vtp_cells iso_vtp_find_cells(const char *path) {
    enum { HEAD = 1 << 16 };
    char head[HEAD];
    bool points = false, faces = false, lines = false;
    head[iso_file_head(path, head, HEAD - 1)] = 0;
    for (const char *piece = strstr(head, "<Piece"); piece; piece = strstr(piece + 1, "<Piece")) {
        points |= has_some(piece, "NumberOfPoints=\"");
        lines |= has_some(piece, "NumberOfLines=\"");
        faces |= has_some(piece, "NumberOfPolys=\"") || has_some(piece, "NumberOfStrips=\"");
    }
    return lines ? ISO_VTP_LINES : faces ? ISO_VTP_FACES : points ? ISO_VTP_POINTS : ISO_VTP_UNKNOWN;
}
