/* Meshes in Wavefront OBJ. */
#include "io/mesh/mesh_format.h"

#include <stdlib.h>
#include <string.h>

/* Reads the corners of a face: "7", "7/1", "7//3" or "-1". Vertices are numbered from 1, or backwards from
 * the last one, -1. */
static iso_status read_obj_face(iso_mesh_reading *r, char *text, iso_error *error) {
    iso_mesh_polygon face = {0};
    for (char *word = iso_row_word(&text); word; word = iso_row_word(&text)) {
        char *end;
        const long long n = strtoll(word, &end, 10);
        const long long corner = n < 0 ? (long long)r->vertex_count + n : n - 1;
        if (end == word || (*end && *end != '/') || corner < 0 || corner >= UINT32_MAX)
            return iso_fail(error, ISO_ERR_FORMAT, "%s: line %zu: '%s' is no corner of a face", r->path,
                            r->rows.number, word);
        ISO_TRY(iso_mesh_add_corner(r, &face, (uint32_t)corner, error));
    }
    return iso_mesh_end_polygon(r, &face, error);
}

/* A vertex may have a colour behind it, which is no part of the format: most programs write it so. */
static iso_status read_obj_vertex(iso_mesh_reading *r, char *text, iso_error *error) {
    double p[3], rgb[3];
    for (int axis = 0; axis < 3; axis++)
        if (!iso_row_number(&text, "", &p[axis]))
            return iso_fail(error, ISO_ERR_FORMAT, "%s: line %zu: not a vertex", r->path, r->rows.number);
    ISO_TRY(iso_mesh_add_vertex(r, p, error));
    for (int k = 0; k < 3; k++)
        if (!iso_row_number(&text, "", &rgb[k])) return ISO_OK;
    r->real_colors = true;
    return iso_mesh_add_color(r, rgb, error);
}

iso_status iso_mesh_read_obj(iso_mesh_reading *r, iso_error *error) {
    ISO_TRY(iso_mesh_load_rows(r, error));
    for (char *row; (row = iso_text_rows_next_continued(&r->rows));) {
        row += strspn(row, " \t");
        if (row[0] && row[1] != ' ' && row[1] != '\t') continue;
        if (row[0] == 'f') ISO_TRY(read_obj_face(r, row + 2, error));
        if (row[0] == 'v') ISO_TRY(read_obj_vertex(r, row + 2, error));
    }
    return ISO_OK;
}
