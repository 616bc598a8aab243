/* vtp_polydata: polygonal data in VTK's XML format ("VTK XML Formats", docs.vtk.org): the points, the lines
 * and the arrays over both, of all pieces, or the points, polygons and strips of a surface. Vertices are
 * skipped.
 *
 * VTK's own reader is not used, because it allocates as much memory as the counts of pieces state, and uses
 * indices without checking them. */
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/memory.h"
#include "grids/volume/vtk_xml.h"
#include "io/polydata/faces.h"

enum { ARRAYS = 512, NAME = ISO_COLUMN_NAME };

typedef enum section { OTHER, POINT_DATA, CELL_DATA, POINTS, LINES, POLYGONS, STRIPS } section;

typedef struct array {
    section in;
    iso_role role;
    iso_vtk_array stored;
} array;

typedef struct vtp {
    iso_polydata *data;
    iso_buffer text;
    iso_vtk_xml xml;
    section in;
    char roles[3][NAME];                         /* the names of the active normals, vectors and tensors */
    uint64_t points, lines, cells_before, cells; /* counts of the current piece; cells_before: cells that
                                                    precede its lines */
    uint64_t polygons, strips;
    array arrays[ARRAYS];
    int array_count;
    bool has_piece;
} vtp;

static iso_status bad(const vtp *v, const char *what, iso_error *error) {
    return iso_vtk_xml_bad(&v->xml, what, error);
}

static iso_status reserve(void *reading, iso_buffer *buffer, size_t count, size_t each, iso_error *error) {
    return iso_reading_reserve(reading, buffer, count, each, 0, error);
}

/* Decodes an array, which must have `count` numbers, for get_number. */
static iso_status decode(vtp *v, const array *a, uint64_t count, iso_error *error) {
    return iso_vtk_xml_decode(&v->xml, &a->stored, count, error);
}

static double get_number(const vtp *v, const array *a, uint64_t i) {
    return iso_vtk_xml_number(&v->xml, &a->stored, i);
}

static const array *find_array(const vtp *v, section in, const char *name) {
    for (int i = 0; i < v->array_count; i++)
        if (v->arrays[i].in == in && (!name || strcmp(v->arrays[i].stored.name, name) == 0))
            return &v->arrays[i];
    return NULL;
}

/* ---- pieces */

static iso_status take_points(vtp *v, iso_error *error) {
    const array *a = find_array(v, POINTS, NULL);
    if (v->points == 0) return ISO_OK;
    if (!a || a->stored.components != 3) return bad(v, "a piece has no points", error);
    if (v->points > UINT32_MAX)
        return iso_fail(error, ISO_ERR_LIMIT, "%s: too many points", v->data->reading->path);
    if (!v->has_piece) v->data->keep_floats = a->stored.scalar == ISO_SCALAR_FLOAT;
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
        if (c->per_line == per_line && (uint64_t)c->components == a->stored.components &&
            strcmp(c->name, a->stored.name) == 0)
            *column = i;
    }
    if (*column >= 0 || v->has_piece) return ISO_OK;
    return iso_polydata_add_column(v->data, a->stored.name, (int)a->stored.components, per_line, a->role,
                                   column, error);
}

/* Reads an array over points or cells; `first`: the number of the piece's first item. */
static iso_status take_column(vtp *v, const array *a, uint64_t first, iso_error *error) {
    const bool cells = a->in == CELL_DATA;
    const uint64_t items = cells ? v->lines : v->points, all = cells ? v->cells : v->points,
                   skipped = cells ? v->cells_before : 0;
    int number;
    if (items == 0 || a->stored.components < 1 || a->stored.components > 64) return ISO_OK;
    ISO_TRY(find_column(v, a, &number, error));
    if (number < 0) return ISO_OK;
    iso_column *column = iso_polydata_column(v->data, number);
    const size_t each = (size_t)column->components;
    ISO_TRY(decode(v, a, all * a->stored.components, error));
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
    ISO_TRY(iso_vtk_xml_count(&v->xml, t, "NumberOfPoints", 0, &v->points, error));
    ISO_TRY(iso_vtk_xml_count(&v->xml, t, "NumberOfVerts", 0, &v->cells_before, error));
    ISO_TRY(iso_vtk_xml_count(&v->xml, t, "NumberOfLines", 0, &v->lines, error));
    ISO_TRY(iso_vtk_xml_count(&v->xml, t, "NumberOfStrips", 0, &v->strips, error));
    ISO_TRY(iso_vtk_xml_count(&v->xml, t, "NumberOfPolys", 0, &v->polygons, error));
    v->cells = v->cells_before + v->lines + v->strips + v->polygons;
    v->array_count = 0;
    return ISO_OK;
}

static iso_role role_of(const vtp *v, const array *a) {
    static const iso_role roles[] = {ISO_ROLE_NORMAL, ISO_ROLE_VECTOR, ISO_ROLE_TENSOR};
    static const uint64_t components[] = {3, 3, 9};
    if (a->stored.scalar == ISO_SCALAR_UINT8 && (a->stored.components == 3 || a->stored.components == 4))
        return ISO_ROLE_COLOR;
    for (int i = 0; i < 3; i++)
        if (a->stored.components == components[i] && *a->stored.name &&
            strcmp(a->stored.name, v->roles[i]) == 0)
            return roles[i];
    return ISO_ROLE_NONE;
}

static iso_status take_array(vtp *v, const iso_xml_tag *t, iso_error *error) {
    array a = {.in = v->in};
    bool known; /* else they are bits or texts */
    if (v->in == OTHER) return ISO_OK;
    if (v->array_count == ARRAYS) return bad(v, "more than 512 arrays", error);
    ISO_TRY(iso_vtk_xml_array(&v->xml, t, &a.stored, &known, error));
    if (!known) return ISO_OK;
    a.role = role_of(v, &a);
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

static iso_status read_file(vtp *v, iso_error *error) {
    size_t bytes;
    iso_xml_tag t;
    bool ended = false;
    ISO_TRY(iso_reading_load(v->data->reading, &v->text, &bytes, error));
    ISO_TRY(iso_vtk_xml_open(&v->xml, v->text.data, bytes, "PolyData", error));
    while (!ended && iso_xml_next(&v->xml.markup, &t)) {
        ISO_TRY(take_tag(v, &t, error));
        ended = iso_xml_is(&t, "/PolyData");
    }
    return ended ? ISO_OK : iso_vtk_xml_ends(&v->xml, error);
}

iso_status iso_polydata_read_vtp(iso_polydata *data, iso_error *error) {
    vtp *v = iso_alloc_zero(1, sizeof *v);
    if (!v) return iso_fail_memory(error, data->reading->path);
    v->data = data;
    v->xml = (iso_vtk_xml){.path = data->reading->path, .reserve = reserve, .context = data->reading};
    iso_status status = read_file(v, error);
    iso_buffer *const buffers[] = {&v->text, &v->xml.values, &v->xml.sizes, &v->xml.packed};
    for (size_t i = 0; i < sizeof buffers / sizeof *buffers; i++) iso_reading_free(data->reading, buffers[i]);
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
