/* obj_polydata: Wavefront's format: vertices "v", of lines with elements "l", which name vertices by numbers
 * from 1, or, negative, backwards from the last one. Of points with normals "vn", if there are as many as
 * vertices, and faces "f", if normals are wanted from them. Everything else is ignored. */
#include <stdlib.h>
#include <string.h>

#include "io/common/rows.h"
#include "io/polydata/faces.h"

typedef struct obj {
    iso_text_rows rows;
    iso_polydata *data;
    iso_faces faces;
    iso_buffer normals; /* three floats each */
    size_t normal_count;
    int colors; /* column; -1: none */
} obj;

/* Reads "v x y z", "v x y z w", or "v x y z red green blue" with colours 0 .. 1. */
static iso_status take_vertex(obj *o, char *text, iso_error *error) {
    double numbers[7];
    int count = 0;
    while (count < 7 && iso_row_number(&text, "", &numbers[count])) count++;
    if (count < 3) return iso_text_rows_fail(&o->rows, "not a vertex", error);
    if (count >= 6 && o->colors < 0 && o->data->point_count == 0)
        ISO_TRY(iso_polydata_add_column(o->data, "colors", 3, false, ISO_ROLE_COLOR, &o->colors, error));
    ISO_TRY(iso_polydata_reserve(o->data, o->data->point_count + 1, error));
    if (o->colors >= 0) {
        float *to = iso_polydata_column(o->data, o->colors)->values.data;
        for (size_t k = 0; k < 3; k++)
            to[3 * o->data->point_count + k] = count >= 6 ? (float)(255 * numbers[3 + k]) : 255;
    }
    iso_polydata_add_point(o->data, numbers);
    return ISO_OK;
}

static iso_status take_normal(obj *o, char *text, iso_error *error) {
    const size_t count = o->normal_count;
    double number;
    ISO_TRY(iso_reading_reserve(o->data->reading, &o->normals, count + 1, 3 * sizeof(float), count, error));
    float *to = (float *)o->normals.data + 3 * o->normal_count++;
    for (int k = 0; k < 3; k++) {
        if (!iso_row_number(&text, "", &number)) return iso_text_rows_fail(&o->rows, "not a normal", error);
        to[k] = (float)number;
    }
    return ISO_OK;
}

/* Parses the number of a vertex: "7", "7/1", "7//3" or "-1". */
static bool parse_corner(const obj *o, const char *word, uint32_t *corner) {
    char *end;
    const long long number = strtoll(word, &end, 10),
                    point = number < 0 ? (long long)o->data->point_count + number : number - 1;
    *corner = (uint32_t)point;
    return end != word && (!*end || *end == '/') && point >= 0 && point < UINT32_MAX;
}

static iso_status take_line(obj *o, char *text, iso_error *error) {
    uint32_t corner;
    for (char *word = iso_row_word(&text); word; word = iso_row_word(&text)) {
        if (!parse_corner(o, word, &corner))
            return iso_text_rows_fail(&o->rows, "a line names a point that cannot be", error);
        ISO_TRY(iso_polydata_add_index(o->data, corner, error));
    }
    return iso_polydata_end_line(o->data, error);
}

static iso_status take_face(obj *o, char *text, iso_error *error) {
    iso_face face = {0};
    uint32_t corner;
    for (char *word = iso_row_word(&text); word; word = iso_row_word(&text)) {
        if (!parse_corner(o, word, &corner))
            return iso_text_rows_fail(&o->rows, "a face names a point that cannot be", error);
        ISO_TRY(iso_faces_add_corner(o->data->reading, &o->faces, &face, corner, error));
    }
    return iso_faces_end_face(o->data->reading, &o->faces, &face, error);
}

/* Makes the column of normals, if there is one for each vertex. */
static iso_status use_normals(obj *o, iso_error *error) {
    int column;
    if (o->normal_count == 0 || o->normal_count != o->data->point_count) return ISO_OK;
    ISO_TRY(iso_polydata_add_column(o->data, "normals", 3, false, ISO_ROLE_NORMAL, &column, error));
    iso_polydata_column(o->data, column)->values = o->normals;
    o->normals = (iso_buffer){0};
    return ISO_OK;
}

static bool begins(const char *row, char element) {
    return row[0] == element && (row[1] == ' ' || row[1] == '\t');
}

static iso_status read_obj(obj *o, iso_error *error) {
    const bool points = o->data->points_only, faces = iso_faces_are_wanted(o->data);
    ISO_TRY(iso_text_rows_load(o->data->reading, &o->rows, error));
    for (char *row = iso_text_rows_next_continued(&o->rows); row;
         row = iso_text_rows_next_continued(&o->rows)) {
        row += strspn(row, " \t");
        if (begins(row, 'v')) ISO_TRY(take_vertex(o, row + 2, error));
        if (begins(row, 'l') && !points) ISO_TRY(take_line(o, row + 2, error));
        if (points && row[0] == 'v' && begins(row + 1, 'n')) ISO_TRY(take_normal(o, row + 3, error));
        if (begins(row, 'f') && faces) ISO_TRY(take_face(o, row + 2, error));
    }
    ISO_TRY(use_normals(o, error));
    return iso_faces_make_normals(&o->faces, o->data, error);
}

iso_status iso_polydata_read_obj(iso_polydata *data, iso_error *error) {
    obj o = {.data = data, .colors = -1};
    iso_status status = read_obj(&o, error);
    iso_text_rows_free(&o.rows);
    iso_reading_free(data->reading, &o.normals);
    iso_faces_free(data->reading, &o.faces);
    return status;
}
