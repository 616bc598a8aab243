/* vtk_polydata: polygonal data in VTK's legacy format (The VTK User's Guide, "VTK File Formats"; version 5 as
 * vtkPolyDataReader reads it), text or binary: the points, the lines and the arrays over both, or the
 * points, polygons and strips of a surface. Vertices are skipped.
 *
 * Up to version 4 a line is the number of its points and the points; in version 5 lines are two arrays, the
 * offsets at which they begin and end, and the points of all of them. Binary numbers are big-endian. The
 * format states no space, but 3D Slicer writes "SPACE=RAS" or "SPACE=LPS" into the title. */
#include <ctype.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "grids/volume/scalar_load.h"
#include "io/common/rows.h"
#include "io/polydata/faces.h"

enum { WORD = 128 };

/* The kinds of cells, in the order in which arrays over cells have them. */
enum { VERTICES, LINES, POLYGONS, STRIPS, KINDS };

typedef struct vtk_file {
    iso_polydata *data;
    iso_text_rows rows;
    bool binary, split_cells; /* split_cells: version 5 */
    uint64_t cells[KINDS];    /* cells of each kind */
    bool has_points;
    enum { NO_DATA, POINT_DATA, CELL_DATA } section;
    uint64_t tuples; /* number of tuples in the current section */
} vtk_file;

static iso_status bad(const vtk_file *f, const char *what, iso_error *error) {
    return iso_fail(error, ISO_ERR_FORMAT, "%s: not a readable VTK file: %s", f->data->reading->path, what);
}

static iso_status ends(const vtk_file *f, iso_error *error) {
    return iso_fail(error, ISO_ERR_IO, "%s: truncated", f->data->reading->path);
}

/* ---- words and numbers */

/* Reads the next word, cut to WORD - 1 characters; false at the end of the file. */
static bool next_word(vtk_file *f, char word[WORD]) {
    char *at = f->rows.at, *end = f->rows.end;
    size_t length = 0;
    while (at < end && isspace((unsigned char)*at)) at++;
    for (; at < end && !isspace((unsigned char)*at); at++)
        if (length < WORD - 1) word[length++] = *at;
    word[length] = 0;
    f->rows.at = at;
    return length > 0;
}

static bool word_is(const char *word, const char *wanted) {
    return strcasecmp(word, wanted) == 0;
}

/* Moves behind the end of the row, where binary numbers begin. */
static void end_row(vtk_file *f) {
    char *end = memchr(f->rows.at, '\n', (size_t)(f->rows.end - f->rows.at));
    f->rows.at = end ? end + 1 : f->rows.end;
}

static iso_status read_size(vtk_file *f, uint64_t *size, iso_error *error) {
    char word[WORD];
    if (!next_word(f, word)) return ends(f, error);
    if (word[strspn(word, "0123456789")] || strlen(word) > 18)
        return bad(f, "a count is not possible", error);
    *size = strtoull(word, NULL, 10);
    return ISO_OK;
}

static iso_status read_type(vtk_file *f, iso_scalar *scalar, iso_error *error) {
    char word[WORD];
    if (!next_word(f, word)) return ends(f, error);
    if (iso_scalar_of_vtk(word, scalar)) return ISO_OK;
    return iso_fail(error, ISO_ERR_FORMAT, "%s: not a readable VTK file: values of type %.80s",
                    f->data->reading->path, word);
}

/* Checks, before memory is allocated, that the file is long enough for `count` numbers. In text a number
 * takes two characters, except the last one. */
static iso_status check_numbers(const vtk_file *f, iso_scalar scalar, uint64_t count, iso_error *error) {
    const uint64_t left = (uint64_t)(f->rows.end - f->rows.at),
                   most = f->binary ? left / iso_scalar_size(scalar) : (left + 1) / 2;
    return count <= most ? ISO_OK : ends(f, error);
}

/* Prepares to read an array of `count` numbers; checks that they are there. */
static iso_status begin_numbers(vtk_file *f, iso_scalar scalar, uint64_t count, iso_error *error) {
    if (f->binary) end_row(f);
    return check_numbers(f, scalar, count, error);
}

/* Reads the next number. check_numbers has ensured that there are enough bytes for binary ones. */
static iso_status read_number(vtk_file *f, iso_scalar scalar, double *number, iso_error *error) {
    if (f->binary) {
        *number = iso_scalar_load(f->rows.at, scalar, true);
        f->rows.at += iso_scalar_size(scalar);
        return ISO_OK;
    }
    char *end;
    *number = strtod(f->rows.at, &end);
    if (end > f->rows.at && (*end == 0 || isspace((unsigned char)*end))) {
        f->rows.at = end;
        return ISO_OK;
    }
    char word[WORD];
    if (!next_word(f, word) || f->rows.at == f->rows.end) return ends(f, error);
    return iso_fail(error, ISO_ERR_FORMAT, "%s: not a readable VTK file: '%.40s' is not a number",
                    f->data->reading->path, word);
}

static iso_status skip_numbers(vtk_file *f, iso_scalar scalar, uint64_t count, iso_error *error) {
    char word[WORD];
    ISO_TRY(check_numbers(f, scalar, count, error));
    if (f->binary) f->rows.at += count * iso_scalar_size(scalar);
    for (uint64_t i = 0; i < count && !f->binary; i++)
        if (!next_word(f, word)) return ends(f, error);
    return ISO_OK;
}

/* ---- points and lines */

static iso_status take_points(vtk_file *f, iso_error *error) {
    uint64_t count;
    iso_scalar scalar;
    if (f->has_points) return bad(f, "its points come twice", error);
    ISO_TRY(read_size(f, &count, error));
    ISO_TRY(read_type(f, &scalar, error));
    if (count > UINT64_MAX / 3) return ends(f, error);
    ISO_TRY(begin_numbers(f, scalar, 3 * count, error));
    f->has_points = true;
    f->data->keep_floats = scalar == ISO_SCALAR_FLOAT;
    ISO_TRY(iso_polydata_reserve(f->data, (size_t)count, error));
    for (uint64_t i = 0; i < count; i++) {
        double p[3];
        for (int axis = 0; axis < 3; axis++) ISO_TRY(read_number(f, scalar, &p[axis], error));
        iso_polydata_add_point(f->data, p);
    }
    return ISO_OK;
}

/* Reads the number of a point. Whether the point exists is checked later, when all points are known. */
static iso_status read_index(vtk_file *f, iso_scalar scalar, iso_error *error) {
    double index;
    ISO_TRY(read_number(f, scalar, &index, error));
    if (!(index >= 0 && index < UINT32_MAX)) return bad(f, "a line names a point that cannot be", error);
    return iso_polydata_add_index(f->data, (uint32_t)index, error);
}

/* Reads the cells of files up to version 4: `size` numbers. The first number of each cell is the count of
 * those that follow it. */
static iso_status take_packed_lines(vtk_file *f, uint64_t count, uint64_t size, iso_error *error) {
    ISO_TRY(begin_numbers(f, ISO_SCALAR_INT32, size, error));
    for (uint64_t i = 0; i < count; i++) {
        double points;
        if (size == 0) return bad(f, "its lines are longer than it says", error);
        ISO_TRY(read_number(f, ISO_SCALAR_INT32, &points, error));
        size--;
        if (!(points >= 0 && points <= (double)size)) return bad(f, "a line is longer than all lines", error);
        for (uint64_t k = 0; k < (uint64_t)points; k++) ISO_TRY(read_index(f, ISO_SCALAR_INT32, error));
        size -= (uint64_t)points;
        ISO_TRY(iso_polydata_end_line(f->data, error));
    }
    return size == 0 ? ISO_OK : bad(f, "its lines are shorter than it says", error);
}

/* Reads "OFFSETS type" or "CONNECTIVITY type", and checks that `count` numbers follow. */
static iso_status begin_array(vtk_file *f, const char *name, uint64_t count, iso_scalar *scalar,
                              iso_error *error) {
    char word[WORD];
    if (!next_word(f, word)) return ends(f, error);
    if (!word_is(word, name)) return bad(f, "cells without OFFSETS and CONNECTIVITY", error);
    ISO_TRY(read_type(f, scalar, error));
    return begin_numbers(f, *scalar, count, error);
}

/* Reads the offsets, which must begin with 0 and end with `size`, into the starts of lines. */
static iso_status read_offsets(vtk_file *f, iso_scalar scalar, uint64_t count, uint64_t size,
                               iso_error *error) {
    double before = 0, offset = 0;
    for (uint64_t i = 0; i < count; i++, before = offset) {
        ISO_TRY(read_number(f, scalar, &offset, error));
        if (!(offset >= before && offset <= (double)size) || (i == 0 && offset > 0))
            return bad(f, "the offsets of its lines do not rise from 0 to their size", error);
        f->data->index_count = (size_t)offset; /* ends the line there */
        if (i > 0) ISO_TRY(iso_polydata_end_line(f->data, error));
    }
    f->data->index_count = 0;
    return count == 0 || offset == (double)size ? ISO_OK
                                                : bad(f, "the offsets of its lines end early", error);
}

static iso_status take_split_lines(vtk_file *f, uint64_t count, uint64_t size, iso_error *error) {
    iso_scalar scalar;
    ISO_TRY(begin_array(f, "OFFSETS", count, &scalar, error));
    ISO_TRY(read_offsets(f, scalar, count, size, error));
    ISO_TRY(begin_array(f, "CONNECTIVITY", size, &scalar, error));
    for (uint64_t i = 0; i < size; i++) ISO_TRY(read_index(f, scalar, error));
    return ISO_OK;
}

static iso_status skip_cells(vtk_file *f, uint64_t count, uint64_t size, iso_error *error) {
    iso_scalar scalar = ISO_SCALAR_INT32;
    if (f->split_cells) {
        ISO_TRY(begin_array(f, "OFFSETS", count, &scalar, error));
        ISO_TRY(skip_numbers(f, scalar, count, error));
        ISO_TRY(begin_array(f, "CONNECTIVITY", size, &scalar, error));
    } else if (f->binary)
        end_row(f);
    return skip_numbers(f, scalar, size, error);
}

/* Adds the next face, of `corners` corners. */
static iso_status take_face(vtk_file *f, iso_scalar scalar, bool strip, uint64_t corners, iso_error *error) {
    iso_face face = {.strip = strip};
    for (uint64_t i = 0; i < corners; i++) {
        double index;
        ISO_TRY(read_number(f, scalar, &index, error));
        if (!(index >= 0 && index < UINT32_MAX)) return bad(f, "a face names a point that cannot be", error);
        ISO_TRY(iso_faces_add_corner(f->data->reading, f->data->surface, &face, (uint32_t)index, error));
    }
    return iso_faces_end_face(f->data->reading, f->data->surface, &face, error);
}

static iso_status take_packed_faces(vtk_file *f, bool strips, uint64_t count, uint64_t size,
                                    iso_error *error) {
    ISO_TRY(begin_numbers(f, ISO_SCALAR_INT32, size, error));
    for (uint64_t i = 0; i < count; i++) {
        double corners;
        if (size == 0) return bad(f, "its faces are longer than it says", error);
        ISO_TRY(read_number(f, ISO_SCALAR_INT32, &corners, error));
        size--;
        if (!(corners >= 0 && corners <= (double)size))
            return bad(f, "a face is longer than all faces", error);
        ISO_TRY(take_face(f, ISO_SCALAR_INT32, strips, (uint64_t)corners, error));
        size -= (uint64_t)corners;
    }
    return size == 0 ? ISO_OK : bad(f, "its faces are shorter than it says", error);
}

/* Reads the corners of the faces whose offsets are `offsets`, which rise from 0 to `size`. */
static iso_status take_split_corners(vtk_file *f, bool strips, const double *offsets, uint64_t count,
                                     uint64_t size, iso_error *error) {
    iso_scalar scalar;
    ISO_TRY(begin_array(f, "CONNECTIVITY", size, &scalar, error));
    if (count && (offsets[0] != 0 || offsets[count - 1] != (double)size))
        return bad(f, "the offsets of its faces do not rise from 0 to their size", error);
    for (uint64_t i = 1; i < count; i++) {
        if (!(offsets[i] >= offsets[i - 1])) return bad(f, "the offsets of its faces do not rise", error);
        ISO_TRY(take_face(f, scalar, strips, (uint64_t)(offsets[i] - offsets[i - 1]), error));
    }
    return ISO_OK;
}

static iso_status take_split_faces(vtk_file *f, bool strips, uint64_t count, uint64_t size,
                                   iso_error *error) {
    iso_buffer buffer = {0};
    iso_scalar scalar;
    ISO_TRY(begin_array(f, "OFFSETS", count, &scalar, error));
    ISO_TRY(iso_reading_reserve(f->data->reading, &buffer, (size_t)count + 1, sizeof(double), 0, error));
    double *offsets = buffer.data;
    iso_status status = ISO_OK;
    for (uint64_t i = 0; i < count && status == ISO_OK; i++)
        status = read_number(f, scalar, &offsets[i], error);
    if (status == ISO_OK) status = take_split_corners(f, strips, offsets, count, size, error);
    iso_reading_free(f->data->reading, &buffer);
    return status;
}

static iso_status take_cells(vtk_file *f, int kind, iso_error *error) {
    uint64_t count, size;
    if (f->cells[kind]) return bad(f, "cells of one kind come twice", error);
    ISO_TRY(read_size(f, &count, error));
    ISO_TRY(read_size(f, &size, error));
    f->cells[kind] = f->split_cells && count ? count - 1 : count;
    if (kind >= POLYGONS && f->data->surface)
        return f->split_cells ? take_split_faces(f, kind == STRIPS, count, size, error)
                              : take_packed_faces(f, kind == STRIPS, count, size, error);
    if (kind != LINES || f->data->points_only) return skip_cells(f, count, size, error);
    if (f->data->line_count) return bad(f, "its lines come twice", error);
    return f->split_cells ? take_split_lines(f, count, size, error)
                          : take_packed_lines(f, count, size, error);
}

/* ---- arrays */

typedef struct array {
    char name[WORD];
    iso_scalar scalar;
    uint64_t components, tuples;
    iso_role role;
    double factor; /* from the numbers in the file to those in the column */
} array;

/* Replaces %20 and similar codes, which VTK writes for characters that are not allowed in words. */
static void decode_name(char *name) {
    char *to = name;
    for (const char *from = name; *from; from++) {
        const char digits[3] = {from[0] == '%' ? from[1] : 0, from[0] == '%' && from[1] ? from[2] : 0, 0};
        const bool coded = isxdigit((unsigned char)digits[0]) && isxdigit((unsigned char)digits[1]);
        *to++ = coded ? (char)strtol(digits, NULL, 16) : *from;
        if (coded) from += 2;
    }
    *to = 0;
}

/* Finds where the first tuple of an array belongs and how many tuples are used; of arrays over cells only
 * those of lines are used. Returns whether any are. */
static bool is_wanted(const vtk_file *f, const array *a, uint64_t *skipped, uint64_t *wanted) {
    uint64_t cells = 0;
    for (int kind = 0; kind < KINDS; kind++) cells += f->cells[kind];
    *skipped = f->section == CELL_DATA ? f->cells[VERTICES] : 0;
    *wanted = f->section == CELL_DATA ? f->cells[LINES] : f->data->point_count;
    const bool fits = a->tuples == (f->section == CELL_DATA ? cells : *wanted);
    return f->section != NO_DATA && fits && *wanted > 0 && a->components <= 64 &&
           !(f->section == CELL_DATA && f->data->points_only);
}

static iso_status fill_column(vtk_file *f, const array *a, uint64_t wanted, iso_error *error) {
    int number;
    ISO_TRY(iso_polydata_add_column(f->data, a->name, (int)a->components, f->section == CELL_DATA, a->role,
                                    &number, error));
    iso_column *column = iso_polydata_column(f->data, number);
    ISO_TRY(iso_reading_reserve(f->data->reading, &column->values, (size_t)wanted,
                                (size_t)a->components * sizeof(float), 0, error));
    float *values = column->values.data;
    for (uint64_t i = 0; i < wanted * a->components; i++) {
        double value;
        ISO_TRY(read_number(f, a->scalar, &value, error));
        values[i] = (float)(value * a->factor);
    }
    return ISO_OK;
}

/* Takes an array whose header was just read. */
static iso_status take_array(vtk_file *f, array *a, iso_error *error) {
    uint64_t count, skipped, wanted;
    if (a->components < 1 || __builtin_mul_overflow(a->components, a->tuples, &count))
        return bad(f, "an array has an impossible size", error);
    ISO_TRY(begin_numbers(f, a->scalar, count, error));
    if (f->data->surface) return skip_numbers(f, a->scalar, count, error);
    decode_name(a->name);
    if (!is_wanted(f, a, &skipped, &wanted)) {
        if (f->section != NO_DATA && wanted > 0 && !(f->section == CELL_DATA && f->data->points_only))
            iso_reading_note(f->data->reading, "array '%.60s' of %llu items is left out", a->name,
                             (unsigned long long)a->tuples);
        return skip_numbers(f, a->scalar, count, error);
    }
    if (a->factor == 0) a->factor = 1;
    if (a->scalar == ISO_SCALAR_UINT8 && (a->components == 3 || a->components == 4)) a->role = ISO_ROLE_COLOR;
    ISO_TRY(skip_numbers(f, a->scalar, skipped * a->components, error));
    ISO_TRY(fill_column(f, a, wanted, error));
    return skip_numbers(f, a->scalar, count - (skipped + wanted) * a->components, error);
}

/* Reads "SCALARS name type [components] LOOKUP_TABLE name". */
static iso_status take_scalars(vtk_file *f, iso_error *error) {
    array a = {.tuples = f->tuples, .components = 1};
    char word[WORD];
    if (!next_word(f, a.name)) return ends(f, error);
    ISO_TRY(read_type(f, &a.scalar, error));
    if (!next_word(f, word)) return ends(f, error);
    if (!word_is(word, "LOOKUP_TABLE")) {
        a.components = strtoull(word, NULL, 10);
        if (!next_word(f, word)) return ends(f, error);
    }
    if (!word_is(word, "LOOKUP_TABLE")) return bad(f, "scalars without LOOKUP_TABLE", error);
    if (!next_word(f, word)) return ends(f, error);
    return take_array(f, &a, error);
}

/* Reads "COLOR_SCALARS name components"; the values are bytes or, in text files, numbers 0 .. 1. */
static iso_status take_colors(vtk_file *f, iso_error *error) {
    array a = {.tuples = f->tuples, .scalar = f->binary ? ISO_SCALAR_UINT8 : ISO_SCALAR_FLOAT};
    if (!next_word(f, a.name)) return ends(f, error);
    ISO_TRY(read_size(f, &a.components, error));
    if (a.components >= 3) a.role = ISO_ROLE_COLOR;
    a.factor = f->binary ? 1 : 255;
    return take_array(f, &a, error);
}

/* Reads "VECTORS name type" and similar rows, with a fixed number of components; 0 for TEXTURE_COORDINATES,
 * whose row gives the number. */
static iso_status take_tuples(vtk_file *f, uint64_t components, iso_role role, iso_error *error) {
    array a = {.tuples = f->tuples, .components = components, .role = role};
    if (!next_word(f, a.name)) return ends(f, error);
    if (components == 0) ISO_TRY(read_size(f, &a.components, error));
    ISO_TRY(read_type(f, &a.scalar, error));
    return take_array(f, &a, error);
}

/* Skips strings: in text files a row each. In binary files the two upper bits of the first byte give the size
 * of the length that precedes the string: 1, 2, 4 or 8 bytes for 3, 2, 1 and 0. */
static iso_status skip_strings(vtk_file *f, uint64_t count, iso_error *error) {
    end_row(f);
    for (uint64_t i = 0; i < count; i++) {
        const uint64_t left = (uint64_t)(f->rows.end - f->rows.at);
        if (left == 0) return ends(f, error);
        if (!f->binary) {
            end_row(f);
            continue;
        }
        const unsigned char *at = (const unsigned char *)f->rows.at;
        const uint64_t bytes = (uint64_t)1 << (3 - (at[0] >> 6));
        if (bytes > left) return ends(f, error);
        uint64_t length = at[0] & 0x3f;
        for (uint64_t k = 1; k < bytes; k++) length = length << 8 | at[k];
        if (length > left - bytes) return ends(f, error);
        f->rows.at += bytes + length;
    }
    return ISO_OK;
}

/* Skips single bits: eight to a byte in binary files. */
static iso_status skip_bits(vtk_file *f, uint64_t count, iso_error *error) {
    if (f->binary) end_row(f);
    return skip_numbers(f, ISO_SCALAR_UINT8, f->binary ? count / 8 + (count % 8 > 0) : count, error);
}

/* Takes the next array of a field: "name components tuples type". */
static iso_status take_field_array(vtk_file *f, iso_error *error) {
    array a = {.role = ISO_ROLE_NONE};
    char type[WORD];
    uint64_t count;
    if (!next_word(f, a.name)) return ends(f, error);
    ISO_TRY(read_size(f, &a.components, error));
    ISO_TRY(read_size(f, &a.tuples, error));
    if (!next_word(f, type)) return ends(f, error);
    if (__builtin_mul_overflow(a.components, a.tuples, &count)) return ends(f, error);
    if (word_is(type, "string")) return skip_strings(f, count, error);
    if (word_is(type, "bit")) return skip_bits(f, count, error);
    if (!iso_scalar_of_vtk(type, &a.scalar)) return bad(f, "an array of an unknown type", error);
    if (count > 0) return take_array(f, &a, error);
    if (f->binary) end_row(f);
    return ISO_OK;
}

/* Skips METADATA: rows up to an empty one. */
static void skip_metadata(vtk_file *f) {
    end_row(f);
    while (f->rows.at < f->rows.end) {
        const char *row = f->rows.at;
        end_row(f);
        if (row[strspn(row, " \t\r")] == '\n') break;
    }
}

/* Reads "FIELD name count", and the arrays, each of which METADATA may follow. */
static iso_status take_field(vtk_file *f, iso_error *error) {
    char word[WORD];
    uint64_t count = 0;
    if (!next_word(f, word)) return ends(f, error);
    ISO_TRY(read_size(f, &count, error));
    for (uint64_t i = 0; i < count; i++) {
        char *before = f->rows.at;
        if (next_word(f, word) && word_is(word, "METADATA"))
            skip_metadata(f);
        else
            f->rows.at = before;
        ISO_TRY(take_field_array(f, error));
    }
    return ISO_OK;
}

/* Skips "LOOKUP_TABLE name size" and its colours, which are bytes or, in text files, floats. */
static iso_status skip_table(vtk_file *f, iso_error *error) {
    char word[WORD];
    uint64_t size = 0, count;
    if (!next_word(f, word)) return ends(f, error);
    ISO_TRY(read_size(f, &size, error));
    if (__builtin_mul_overflow(size, 4, &count)) return ends(f, error);
    if (f->binary) end_row(f);
    return skip_numbers(f, ISO_SCALAR_UINT8, count, error);
}

/* ---- the file */

static iso_status take_section(vtk_file *f, bool cells, iso_error *error) {
    f->section = cells ? CELL_DATA : POINT_DATA;
    return read_size(f, &f->tuples, error);
}

static iso_status take_keyword(vtk_file *f, const char *word, iso_error *error) {
    if (word_is(word, "POINTS")) return take_points(f, error);
    if (word_is(word, "VERTICES")) return take_cells(f, VERTICES, error);
    if (word_is(word, "LINES")) return take_cells(f, LINES, error);
    if (word_is(word, "POLYGONS")) return take_cells(f, POLYGONS, error);
    if (word_is(word, "TRIANGLE_STRIPS")) return take_cells(f, STRIPS, error);
    if (word_is(word, "POINT_DATA")) return take_section(f, false, error);
    if (word_is(word, "CELL_DATA")) return take_section(f, true, error);
    if (word_is(word, "FIELD")) return take_field(f, error);
    if (word_is(word, "METADATA")) {
        skip_metadata(f);
        return ISO_OK;
    }
    if (f->section == NO_DATA) return bad(f, "an unknown word in its header", error);
    if (word_is(word, "SCALARS")) return take_scalars(f, error);
    if (word_is(word, "COLOR_SCALARS")) return take_colors(f, error);
    if (word_is(word, "LOOKUP_TABLE")) return skip_table(f, error);
    if (word_is(word, "VECTORS")) return take_tuples(f, 3, ISO_ROLE_VECTOR, error);
    if (word_is(word, "NORMALS")) return take_tuples(f, 3, ISO_ROLE_NORMAL, error);
    if (word_is(word, "TEXTURE_COORDINATES")) return take_tuples(f, 0, ISO_ROLE_NONE, error);
    if (word_is(word, "TENSORS")) return take_tuples(f, 9, ISO_ROLE_TENSOR, error);
    if (word_is(word, "TENSORS6")) return take_tuples(f, 6, ISO_ROLE_NONE, error);
    if (word_is(word, "GLOBAL_IDS") || word_is(word, "PEDIGREE_IDS"))
        return take_tuples(f, 1, ISO_ROLE_NONE, error);
    return bad(f, "an unknown kind of array", error);
}

static iso_space space_of_title(const char *title) {
    if (strstr(title, "SPACE=RAS")) return ISO_SPACE_RAS;
    return strstr(title, "SPACE=LPS") ? ISO_SPACE_LPS : ISO_SPACE_FILE;
}

static iso_status read_header(vtk_file *f, iso_error *error) {
    static const char magic[] = "# vtk DataFile Version ";
    char word[WORD];
    const char *first = iso_text_rows_next(&f->rows), *title = iso_text_rows_next(&f->rows);
    if (!first || strncmp(first, magic, sizeof magic - 1) != 0)
        return bad(f, "it does not begin with '# vtk DataFile Version'", error);
    const long version = strtol(first + sizeof magic - 1, NULL, 10);
    if (version < 1 || version > 5) return bad(f, "a version that is not 1 to 5", error);
    f->split_cells = version >= 5;
    f->data->stated = title ? space_of_title(title) : ISO_SPACE_FILE;
    if (!next_word(f, word)) return ends(f, error);
    f->binary = word_is(word, "BINARY");
    if (!f->binary && !word_is(word, "ASCII")) return bad(f, "neither ASCII nor BINARY", error);
    if (!next_word(f, word)) return ends(f, error);
    if (!word_is(word, "DATASET")) return bad(f, "no DATASET", error);
    if (!next_word(f, word)) return ends(f, error);
    if (word_is(word, "POLYDATA")) return ISO_OK;
    return iso_fail(error, ISO_ERR_FORMAT, "%s: holds a %.80s, not polygonal data", f->data->reading->path,
                    word);
}

static iso_status read_file(vtk_file *f, iso_error *error) {
    char word[WORD];
    ISO_TRY(iso_text_rows_load(f->data->reading, &f->rows, error));
    ISO_TRY(read_header(f, error));
    while (next_word(f, word)) ISO_TRY(take_keyword(f, word, error));
    return f->has_points ? ISO_OK : ends(f, error);
}

iso_status iso_polydata_read_vtk(iso_polydata *data, iso_error *error) {
    vtk_file f = {.data = data};
    iso_status status = read_file(&f, error);
    iso_text_rows_free(&f.rows);
    return status;
}
