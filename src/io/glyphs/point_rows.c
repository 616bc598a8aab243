/* point_rows: points as rows of numbers: .pts, .asc, .txt, and .xyz that are not molecules. The numbers are
 * separated by blanks, commas or semicolons; they have decimal commas if those of the first row do. A first
 * row of one number is the number of points. In .pwn files (CGAL's "point with normal") as many rows of
 * normals may follow the points. */
#include "io/glyphs/point_rows.h"

#include <ctype.h>
#include <string.h>

#include "base/file_types.h"
#include "io/glyphs/point_columns.h"

static const char separators[] = ",;";
enum { LEAST_ROW = 6 }; /* bytes of a row: "0 0 0" and its end, which the last row may lack */

char *iso_point_rows_next(iso_text_rows *rows) {
    char *row;
    do {
        row = iso_text_rows_next(rows);
        if (row) row += strspn(row, " \t");
    } while (row && (*row == 0 || *row == '#' || strncmp(row, "//", 2) == 0));
    return row;
}

bool iso_point_rows_is_count(char *row, double *count) {
    return iso_row_number(&row, "", count) && *row == 0 && *count >= 0 && *count < 1e15 &&
           (double)(uint64_t)*count == *count;
}

/* The state of the reader. */
typedef struct point_rows {
    iso_polydata *data;
    iso_text_rows *rows;
    int columns; /* numbers of a row */
    bool named;
    bool decimal_commas;
    iso_slot slots[ISO_POLYDATA_COLUMNS];
    double numbers[ISO_POLYDATA_COLUMNS + 1];
} point_rows;

/* Parses the numbers of a row; returns how many there are, -1 if something else is among them. */
static int parse_row(point_rows *p, char *row, int most) {
    int count = 0;
    if (p->decimal_commas) iso_row_turn_commas(row);
    while (count < most && iso_row_number(&row, separators, &p->numbers[count])) count++;
    return *row ? -1 : count;
}

/* ---- the first row */

/* Finds the next name of a row behind blanks and separators: a word, or what is between quotes. NULL: there
 * is none. *end: the character behind it. */
static char *find_name(char *row, char **end) {
    static const char between[] = ",; \t";
    row += strspn(row, between);
    const bool quoted = *row == '"';
    row += quoted;
    *end = row + strcspn(row, quoted ? "\"" : between);
    return *row ? row : NULL;
}

static int count_names(char *row) {
    int count = 0;
    for (char *end; find_name(row, &end); count++) row = *end ? end + 1 : end;
    return count;
}

/* Returns the next name, terminated in place. `separator`: the only character that separates names; 0: blanks
 * and all separators do. */
static const char *next_name(char **row, char separator) {
    char *end, *name;
    if (separator) return *row && **row ? iso_row_cell(row, separator) : NULL;
    name = find_name(*row, &end);
    *row = *end ? end + 1 : end;
    *end = 0;
    return name;
}

/* Takes the names of `count` numbers from a row. They are words, or else between separators, with blanks in
 * them. */
static iso_status take_names(point_rows *p, char *row, int count, iso_error *error) {
    const char *names[ISO_POLYDATA_COLUMNS], *name;
    const char separator = count_names(row) == count ? 0 : iso_row_separator(row);
    while ((name = next_name(&row, separator))) {
        if (p->columns == ISO_POLYDATA_COLUMNS) return iso_text_rows_fail(p->rows, "too many names", error);
        names[p->columns++] = *name ? name : NULL;
    }
    return iso_polydata_name_columns(p->data, names, p->columns, p->slots, error);
}

/* Finds out whether the numbers of the first row of points have decimal commas. `names`: the row of names. */
static void find_commas(point_rows *p, const char *names, const char *row) {
    const char separator = names ? iso_row_separator(names) : 0;
    const bool between = separator == ';' || separator == '\t';
    p->decimal_commas =
        row && (iso_row_has_decimal_commas(row) || (between && strchr(row, separator) && !strchr(row, ',')));
}

/* Whether a row has names instead of numbers. (nan and inf are numbers.) */
static bool has_names(point_rows *p, char *row) {
    return (isalpha((unsigned char)*row) || *row == '"') && !iso_row_number(&row, separators, &p->numbers[0]);
}

/* Finds what the columns are from the options or the first row. If it has names, *row becomes the one behind
 * it. */
static iso_status begin_rows(point_rows *p, char **row, iso_error *error) {
    const bool named = has_names(p, *row), given = p->data->reading->opts.columns != NULL;
    p->named = named || given;
    char *const names = named ? *row : NULL;
    if (named) *row = iso_point_rows_next(p->rows);
    find_commas(p, names, *row);
    if (given) ISO_TRY(iso_point_columns_given(p->data, p->slots, &p->columns, error));
    if (named && !given)
        ISO_TRY(take_names(p, names, *row ? parse_row(p, *row, ISO_POLYDATA_COLUMNS) : 0, error));
    if (p->named) return ISO_OK;
    p->columns = parse_row(p, *row, ISO_POINT_COLUMNS_MOST + 1);
    if (p->columns < ISO_POINT_COLUMNS_LEAST || p->columns > ISO_POINT_COLUMNS_MOST)
        return iso_text_rows_fail(p->rows, "not a point, which is 3 to 10 numbers", error);
    return iso_point_columns_add(p->data, p->columns, p->slots, error);
}

/* ---- points */

/* Reads rows from `row` on, until there are `most` points. */
static iso_status read_rows(point_rows *p, char *row, uint64_t most, iso_error *error) {
    for (; row; row = iso_point_rows_next(p->rows)) {
        if (parse_row(p, row, p->columns + 1) != p->columns)
            return iso_text_rows_fail(p->rows,
                                      p->named ? "not as many numbers as there are names"
                                               : "not as many numbers as in the first row",
                                      error);
        ISO_TRY(iso_polydata_reserve(p->data, p->data->point_count + 1, error));
        iso_polydata_add_row(p->data, p->slots, p->numbers, p->columns);
        if (p->data->point_count == most) break;
    }
    return ISO_OK;
}

static iso_status finish(point_rows *p, iso_error *error) {
    const bool pts = iso_file_type_of_name(p->rows->reading->path, ISO_HOLDS_ROWS) == ISO_FILE_pts;
    if (!p->named) return iso_point_columns_decide(p->data, pts, error);
    iso_polydata_scale_colors(p->data, true);
    return ISO_OK;
}

static iso_status read_uncounted(point_rows *p, char *row, iso_error *error) {
    ISO_TRY(begin_rows(p, &row, error));
    ISO_TRY(read_rows(p, row, UINT64_MAX, error));
    return finish(p, error);
}

iso_status iso_point_rows_read(iso_polydata *data, iso_text_rows *rows, char *row, iso_error *error) {
    point_rows *p = iso_alloc_zero(1, sizeof *p);
    if (!p) return iso_fail_memory(error, rows->reading->path);
    p->data = data;
    p->rows = rows;
    iso_status status = read_uncounted(p, row, error);
    iso_free(p);
    return status;
}

/* ---- points with their number before them */

/* Reads a row with a normal for each point, from `row` on. */
static iso_status read_normals(point_rows *p, char *row, iso_error *error) {
    int column;
    const size_t count = p->data->point_count;
    ISO_TRY(iso_polydata_add_column(p->data, "normals", 3, false, ISO_ROLE_NORMAL, &column, error));
    ISO_TRY(iso_polydata_reserve(p->data, count, error));
    float *to = iso_polydata_column(p->data, column)->values.data;
    for (size_t i = 0; i < count; i++, row = iso_point_rows_next(p->rows)) {
        if (!row)
            return iso_fail(error, ISO_ERR_IO, "%s: truncated: normals are missing", p->rows->reading->path);
        if (parse_row(p, row, 4) != 3) return iso_text_rows_fail(p->rows, "not a normal", error);
        for (int k = 0; k < 3; k++) *to++ = (float)p->numbers[k];
    }
    return ISO_OK;
}

/* Reads `count` points from `row` on, and finds the row behind them. */
static iso_status read_points(point_rows *p, uint64_t count, char **row, iso_error *error) {
    ISO_TRY(begin_rows(p, row, error));
    ISO_TRY(read_rows(p, *row, count, error));
    if (p->data->point_count < count)
        return iso_fail(error, ISO_ERR_IO, "%s: truncated: %zu of %llu points", p->rows->reading->path,
                        p->data->point_count, (unsigned long long)count);
    *row = iso_point_rows_next(p->rows);
    return finish(p, error);
}

static iso_status read_counted(point_rows *p, double count, iso_error *error) {
    const char *path = p->rows->reading->path;
    char *row = iso_point_rows_next(p->rows);
    if (count > (double)(p->rows->text.bytes) / LEAST_ROW + 1 || (!row && count > 0))
        return iso_fail(error, ISO_ERR_IO, "%s: truncated: it promises %.0f points", path, count);
    if (count > 0) ISO_TRY(read_points(p, (uint64_t)count, &row, error));
    if (row && p->columns == 3 && iso_file_type_of_name(path, ISO_HOLDS_ROWS) == ISO_FILE_pwn) {
        ISO_TRY(read_normals(p, row, error));
        row = iso_point_rows_next(p->rows);
    }
    if (row)
        iso_reading_note(p->rows->reading,
                         "further rows follow: only the %.0f points that it promises are read", count);
    return ISO_OK;
}

static iso_status read_file(point_rows *p, iso_error *error) {
    double count;
    ISO_TRY(iso_text_rows_load(p->data->reading, p->rows, error));
    char *row = iso_point_rows_next(p->rows);
    if (!row) return iso_fail(error, ISO_ERR_FORMAT, "%s: the file is empty", p->rows->reading->path);
    return iso_point_rows_is_count(row, &count) ? read_counted(p, count, error)
                                                : read_uncounted(p, row, error);
}

iso_status iso_polydata_read_rows(iso_polydata *data, iso_error *error) {
    iso_text_rows rows = {0};
    point_rows *p = iso_alloc_zero(1, sizeof *p);
    if (!p) return iso_fail_memory(error, data->reading->path);
    p->data = data;
    p->rows = &rows;
    const iso_status status = read_file(p, error);
    iso_text_rows_free(&rows);
    iso_free(p);
    return status;
}
