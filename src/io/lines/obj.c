/* obj: the polylines of Wavefront's format: elements "l", which name vertices by numbers from 1, or,
 * negative, backwards from the last one. Everything but v and l is ignored. */
#include <stdlib.h>
#include <string.h>

#include "io/lines/lines_format.h"
#include "io/polydata/polydata.h"
#include "io/rows.h"

typedef struct obj {
    iso_rows rows;
    iso_polydata data;
    int colors; /* column; -1: none */
} obj;

/* Reads "v x y z", "v x y z w", or "v x y z red green blue" with colours 0 .. 1. */
static iso_status take_vertex(obj *o, char *text, iso_error *error) {
    double numbers[7];
    int count = 0;
    while (count < 7 && iso_row_number(&text, "", &numbers[count])) count++;
    if (count < 3) return iso_rows_fail(&o->rows, "not a vertex", error);
    if (count >= 6 && o->colors < 0 && o->data.point_count == 0)
        ISO_TRY(iso_polydata_add_column(&o->data, "colors", 3, false, ISO_ROLE_COLOR, &o->colors, error));
    ISO_TRY(iso_polydata_reserve(&o->data, o->data.point_count + 1, error));
    if (o->colors >= 0) {
        float *to = iso_polydata_column(&o->data, o->colors)->values.data;
        for (size_t k = 0; k < 3; k++)
            to[3 * o->data.point_count + k] = count >= 6 ? (float)(255 * numbers[3 + k]) : 255;
    }
    iso_polydata_add_point(&o->data, numbers);
    return ISO_OK;
}

/* Reads "l 1 2 3" or, with texture coordinates, "l 1/1 2/2". */
static iso_status take_line(obj *o, char *text, iso_error *error) {
    for (char *word = iso_row_word(&text); word; word = iso_row_word(&text)) {
        char *end;
        const long long number = strtoll(word, &end, 10),
                        point = number < 0 ? (long long)o->data.point_count + number : number - 1;
        if (end == word || (*end && *end != '/') || point < 0 || point >= UINT32_MAX)
            return iso_rows_fail(&o->rows, "a line names a point that cannot be", error);
        ISO_TRY(iso_polydata_add_index(&o->data, (uint32_t)point, error));
    }
    return iso_polydata_end_line(&o->data, error);
}

static bool begins(const char *row, char element) {
    return row[0] == element && (row[1] == ' ' || row[1] == '\t');
}

static iso_status read_obj(obj *o, iso_lines *lines, iso_error *error) {
    ISO_TRY(iso_rows_load(o->data.reading, &o->rows, error));
    for (char *row = iso_rows_next(&o->rows); row; row = iso_rows_next(&o->rows)) {
        row += strspn(row, " \t");
        if (begins(row, 'v')) ISO_TRY(take_vertex(o, row + 2, error));
        if (begins(row, 'l')) ISO_TRY(take_line(o, row + 2, error));
    }
    return iso_polydata_to_lines(&o->data, lines, error);
}

iso_status iso_lines_read_obj(iso_reading *reading, iso_lines *lines, iso_error *error) {
    obj o = {.data = {.reading = reading}, .colors = -1};
    iso_status status = read_obj(&o, lines, error);
    iso_rows_free(&o.rows);
    iso_polydata_free(&o.data);
    return status;
}
