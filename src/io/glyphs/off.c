/* off: Geomview's OFF as text: vertices, with their normals (NOFF) and colours (COFF) if the first word says
 * so, and faces, which serve normals or are the surface. Texture coordinates (STOFF) are left out. */
#include <string.h>

#include "io/glyphs/point_rows.h"
#include "io/polydata/faces.h"

enum { MOST = 16 }; /* numbers of a vertex: at most 3 + 3 + 4 + 2 are used */

typedef struct off {
    iso_text_rows rows;
    iso_polydata *data;
    iso_faces *faces;
    bool has_normals, has_colors, has_texture;
    uint64_t vertices, face_count;
    iso_slot slots[MOST];
    int used; /* numbers of a vertex that have slots */
} off;

/* ---- the header */

/* Parses the first word, "OFF" with letters before it that say what vertices have. */
static iso_status parse_keyword(off *o, const char *word, iso_error *error) {
    const char *const path = o->rows.reading->path;
    if (word && (o->has_texture = strncmp(word, "ST", 2) == 0)) word += 2;
    if (word && (o->has_colors = *word == 'C')) word++;
    if (word && (o->has_normals = *word == 'N')) word++;
    if (word && (*word == '4' || *word == 'n') && strstr(word, "OFF"))
        return iso_fail(error, ISO_ERR_UNSUPPORTED, "%s: points of more than three dimensions", path);
    if (word && strcmp(word, "OFF") == 0) return ISO_OK;
    return iso_fail(error, ISO_ERR_FORMAT, "%s: not an OFF file", path);
}

static bool parse_count(char **row, uint64_t *count) {
    double number;
    if (!iso_row_number(row, "", &number) || !(number >= 0 && number < 1e15)) return false;
    *count = (uint64_t)number;
    return (double)*count == number;
}

/* Reads the first word, and the numbers of vertices and faces, behind it or in a row of their own. */
static iso_status read_header(off *o, iso_error *error) {
    char *row = iso_point_rows_next(&o->rows);
    if (!row) return iso_fail(error, ISO_ERR_FORMAT, "%s: the file is empty", o->rows.reading->path);
    ISO_TRY(parse_keyword(o, iso_row_word(&row), error));
    row += strspn(row, " \t");
    if (strncmp(row, "BINARY", 6) == 0)
        return iso_fail(error, ISO_ERR_UNSUPPORTED, "%s: binary OFF is not read", o->rows.reading->path);
    if (*row == 0 || *row == '#') row = iso_point_rows_next(&o->rows);
    if (!row) return iso_fail(error, ISO_ERR_IO, "%s: truncated in its header", o->rows.reading->path);
    if (!parse_count(&row, &o->vertices) || !parse_count(&row, &o->face_count))
        return iso_text_rows_fail(&o->rows, "not the numbers of vertices and faces", error);
    /* a vertex takes at least six bytes, "0 0 0" and the end of its row, which the last row may lack */
    if (o->vertices <= (uint64_t)(o->rows.end - o->rows.at + 1) / 6) return ISO_OK;
    return iso_fail(error, ISO_ERR_IO, "%s: truncated: it promises %llu vertices", o->rows.reading->path,
                    (unsigned long long)o->vertices);
}

/* ---- vertices */

/* Returns the next row without a comment at its end. */
static iso_status next_row(off *o, const char *what, char **row, iso_error *error) {
    *row = iso_point_rows_next(&o->rows);
    if (!*row)
        return iso_fail(error, ISO_ERR_IO, "%s: truncated: %s are missing", o->rows.reading->path, what);
    (*row)[strcspn(*row, "#")] = 0;
    return ISO_OK;
}

/* Adds a column of three numbers to the slots. */
static iso_status add_three(off *o, const char *name, iso_role role, iso_error *error) {
    int column;
    ISO_TRY(iso_polydata_add_column(o->data, name, 3, false, role, &column, error));
    for (int k = 0; k < 3; k++) o->slots[o->used++] = (iso_slot){column, k};
    return ISO_OK;
}

static iso_status read_vertices(off *o, iso_error *error) {
    double numbers[MOST];
    for (; o->used < 3; o->used++) o->slots[o->used] = (iso_slot){ISO_SLOT_POINT, o->used};
    if (o->has_normals) ISO_TRY(add_three(o, "normals", ISO_ROLE_NORMAL, error));
    if (o->has_colors) ISO_TRY(add_three(o, "colors", ISO_ROLE_COLOR, error));
    const int wanted = o->used + (o->has_texture ? 2 : 0);
    ISO_TRY(iso_polydata_reserve(o->data, (size_t)o->vertices, error));
    for (uint64_t i = 0; i < o->vertices; i++) {
        char *row;
        int count = 0;
        ISO_TRY(next_row(o, "vertices", &row, error));
        while (count < MOST && iso_row_number(&row, "", &numbers[count])) count++;
        if (count < wanted) return iso_text_rows_fail(&o->rows, "not enough numbers for a vertex", error);
        iso_polydata_add_row(o->data, o->slots, numbers, o->used);
    }
    iso_polydata_scale_colors(o->data, true);
    return ISO_OK;
}

/* ---- faces */

static iso_status read_face(off *o, char *row, iso_error *error) {
    iso_face face = {0};
    uint64_t corners, corner;
    if (!parse_count(&row, &corners)) return iso_text_rows_fail(&o->rows, "not a face", error);
    for (uint64_t i = 0; i < corners; i++) {
        if (!parse_count(&row, &corner) || corner >= UINT32_MAX)
            return iso_text_rows_fail(&o->rows, "not as many corners as the face has", error);
        ISO_TRY(iso_faces_add_corner(o->data->reading, o->faces, &face, (uint32_t)corner, error));
    }
    return iso_faces_end_face(o->data->reading, o->faces, &face, error);
}

static iso_status read_faces(off *o, iso_error *error) {
    const bool normals = iso_faces_are_wanted(o->data);
    if (!normals && !o->data->surface) return ISO_OK;
    for (uint64_t i = 0; i < o->face_count; i++) {
        char *row;
        ISO_TRY(next_row(o, "faces", &row, error));
        ISO_TRY(read_face(o, row, error));
    }
    return normals ? iso_faces_make_normals(o->faces, o->data, error) : ISO_OK;
}

static iso_status read_off(off *o, iso_error *error) {
    ISO_TRY(iso_text_rows_load(o->data->reading, &o->rows, error));
    ISO_TRY(read_header(o, error));
    ISO_TRY(read_vertices(o, error));
    return read_faces(o, error);
}

iso_status iso_polydata_read_off(iso_polydata *data, iso_error *error) {
    iso_faces own = {0};
    off o = {.data = data, .faces = data->surface ? data->surface : &own};
    const iso_status status = read_off(&o, error);
    iso_text_rows_free(&o.rows);
    iso_faces_free(data->reading, &own);
    return status;
}
