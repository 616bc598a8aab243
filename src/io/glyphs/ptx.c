/* ptx: scans of laser scanners in Leica's PTX, as text. Of each scan the numbers of columns and rows, the
 * place and axes of the scanner, a matrix (rows times points give the world), and a row for each point, in
 * the scanner's coordinates: x y z intensity, and perhaps red green blue. Points without a return are 0 0
 * 0. */
#include <string.h>

#include "io/glyphs/point_rows.h"

enum { MOST = 7 };

typedef struct ptx {
    iso_text_rows rows;
    iso_polydata *data;
    iso_slot slots[MOST];
    int columns; /* of all scans; 0: no point has been read yet */
    uint64_t missing;
} ptx;

/* Parses up to `room` numbers of a row; 0 if there are more, or anything else, or no row. */
static int numbers_of(char *row, int room, double *numbers) {
    int count = 0;
    if (!row) return 0;
    while (count < room && iso_row_number(&row, "", &numbers[count])) count++;
    return row[strspn(row, " \t")] ? 0 : count;
}

static iso_status begin_columns(ptx *p, int count, iso_error *error) {
    static const char *const names[MOST] = {"x", "y", "z", "intensity", "red", "green", "blue"};
    p->columns = count;
    return iso_polydata_name_columns(p->data, names, count, p->slots, error);
}

static iso_status read_points(ptx *p, size_t count, const double m[16], iso_error *error) {
    for (size_t i = 0; i < count; i++) {
        double n[MOST];
        char *row = iso_point_rows_next(&p->rows);
        if (!row)
            return iso_fail(error, ISO_ERR_IO, "%s: truncated: points are missing", p->data->reading->path);
        const int found = numbers_of(row, MOST, n);
        if (found != 4 && found != 7)
            return iso_text_rows_fail(&p->rows, "not a point: x y z, intensity and perhaps a colour", error);
        if (!p->columns) {
            ISO_TRY(begin_columns(p, found, error));
            ISO_TRY(iso_polydata_reserve(p->data, count, error));
        }
        if (found != p->columns)
            return iso_text_rows_fail(&p->rows, "some points have colours, others none", error);
        if (n[0] == 0 && n[1] == 0 && n[2] == 0) {
            p->missing++;
            continue;
        }
        const double x = n[0], y = n[1], z = n[2];
        for (int axis = 0; axis < 3; axis++)
            n[axis] = x * m[axis] + y * m[4 + axis] + z * m[8 + axis] + m[12 + axis];
        iso_polydata_add_row(p->data, p->slots, n, found);
    }
    return ISO_OK;
}

/* Reads the scan that begins with `row`. */
static iso_status read_scan(ptx *p, char *row, iso_error *error) {
    double sizes[2], matrix[16], ignored[4];
    char *second = iso_point_rows_next(&p->rows);
    if (!iso_point_rows_is_count(row, &sizes[0]) || !second || !iso_point_rows_is_count(second, &sizes[1]))
        return iso_text_rows_fail(&p->rows, "a scan begins with its numbers of columns and rows", error);
    for (int i = 0; i < 8; i++)
        if (numbers_of(iso_point_rows_next(&p->rows), 4, i < 4 ? ignored : matrix + 4 * (i - 4)) !=
            (i < 4 ? 3 : 4))
            return iso_text_rows_fail(&p->rows, "not four rows of the scanner and four of a matrix", error);
    /* a point takes at least eight bytes, "0 0 0 0" and the end of the row, which the last row may lack */
    if (!(sizes[0] * sizes[1] <= (double)(p->rows.end - p->rows.at + 1) / 8))
        return iso_fail(error, ISO_ERR_IO, "%s: truncated: it promises %.0f points", p->data->reading->path,
                        sizes[0] * sizes[1]);
    const size_t count = (size_t)(sizes[0] * sizes[1]);
    if (p->columns) ISO_TRY(iso_polydata_reserve(p->data, p->data->point_count + count, error));
    return read_points(p, count, matrix, error);
}

static iso_status read_ptx(ptx *p, iso_error *error) {
    ISO_TRY(iso_text_rows_load(p->data->reading, &p->rows, error));
    char *row = iso_point_rows_next(&p->rows);
    if (!row) return iso_fail(error, ISO_ERR_FORMAT, "%s: the file is empty", p->data->reading->path);
    for (; row; row = iso_point_rows_next(&p->rows)) ISO_TRY(read_scan(p, row, error));
    if (!p->columns) ISO_TRY(begin_columns(p, 4, error));
    if (p->missing)
        iso_reading_note(p->data->reading, "%llu points without a return are left out",
                         (unsigned long long)p->missing);
    iso_polydata_scale_colors(p->data, false);
    return ISO_OK;
}

iso_status iso_polydata_read_ptx(iso_polydata *data, iso_error *error) {
    ptx p = {.data = data};
    const iso_status status = read_ptx(&p, error);
    iso_text_rows_free(&p.rows);
    return status;
}
