/* csv: points in a table: a row of names, which include x y z, unless the options name the columns, and a row
 * for each point. The separator is a comma, semicolon or tab, whichever is most frequent in the first row;
 * between semicolons or tabs, numbers may have decimal commas. Values may be in double quotes. A column whose
 * first value is not a number contains words, which are numbered in order of appearance. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "io/common/rows.h"
#include "io/glyphs/point_columns.h"
#include "io/polydata/polydata.h"

enum { WORDS = 64, COLUMNS = ISO_POLYDATA_COLUMNS };

/* The words of a column, which point into the text. */
typedef struct dictionary {
    const char *words[WORDS];
    int count;
    bool used;
} dictionary;

typedef struct csv {
    iso_text_rows rows;
    iso_polydata *data;
    char separator;
    int columns;
    char *cells[COLUMNS]; /* the cells of a row */
    iso_slot slots[COLUMNS];
    double numbers[COLUMNS];
    dictionary dictionaries[COLUMNS];
} csv;

/* Splits a row into cells; returns how many it has, at most COLUMNS. */
static int split_row(csv *c, char *row) {
    int count = 0;
    while (row && count < COLUMNS) c->cells[count++] = iso_row_cell(&row, c->separator);
    return count;
}

/* Returns the number of a word in its column; NaN when there are too many words. */
static double number_of_word(dictionary *words, const char *word) {
    for (int i = 0; i < words->count; i++)
        if (strcmp(words->words[i], word) == 0) return i;
    if (words->count == WORDS) return (double)NAN;
    words->words[words->count] = word;
    return words->count++;
}

/* Returns the number in a cell; NaN if the cell is empty or not a number. */
static double parse_cell(csv *c, int column) {
    char *cell = c->cells[column];
    double number;
    if (c->dictionaries[column].used) return number_of_word(&c->dictionaries[column], cell);
    if (c->separator != ',' && cell[strspn(cell, "0123456789+-,eE")] == 0) iso_row_turn_commas(cell);
    return iso_row_number(&cell, "", &number) && *cell == 0 ? number : (double)NAN;
}

/* Whether a cell begins as a number and goes on as something else, as "3.1+e2". A missing number is an empty
 * cell, or a word. */
static bool has_rubbish(const char *cell) {
    char *end;
    strtod(cell, &end);
    return end != cell && end[strspn(end, " \t")] != 0;
}

/* Finds the columns of words: in the first row of data their cell is not a number, but not empty. */
static void find_words(csv *c) {
    for (int i = 0; i < c->columns; i++) {
        const bool position = c->slots[i].column == ISO_SLOT_POINT;
        c->dictionaries[i].used =
            !position && *c->cells[i] && isnan(parse_cell(c, i)) && strcasecmp(c->cells[i], "nan") != 0;
    }
}

static iso_status take_row(csv *c, char *row, iso_error *error) {
    if (split_row(c, row) != c->columns)
        return iso_text_rows_fail(&c->rows, "not as many values as there are names", error);
    if (c->data->point_count == 0) find_words(c);
    ISO_TRY(iso_polydata_reserve(c->data, c->data->point_count + 1, error));
    for (int i = 0; i < c->columns; i++) {
        c->numbers[i] = parse_cell(c, i);
        if (c->slots[i].column == ISO_SLOT_POINT && has_rubbish(c->cells[i]))
            return iso_text_rows_fail(&c->rows, "a coordinate has something behind its number", error);
    }
    iso_polydata_add_row(c->data, c->slots, c->numbers, c->columns);
    return ISO_OK;
}

static void note_words(csv *c) {
    for (int i = 0; i < c->columns; i++) {
        const dictionary *words = &c->dictionaries[i];
        if (!words->used) continue;
        iso_reading_note(c->data->reading, "column %d has words: '%.40s' is 0%s%.40s%s%s", i + 1,
                         words->words[0], words->count > 1 ? ", '" : "",
                         words->count > 1 ? words->words[1] : "", words->count > 1 ? "' is 1" : "",
                         words->count > 2 ? ", .." : "");
    }
}

/* Takes the names of the columns from the options or, else, from the first row, and stores in *row the first
 * row of values, which is the first row itself if it has no names. */
static iso_status take_names(csv *c, char **row, iso_error *error) {
    double number;
    c->separator = iso_row_separator(*row);
    if (!c->separator) c->separator = ',';
    if (!c->data->reading->opts.columns) {
        c->columns = split_row(c, *row);
        *row = iso_text_rows_next(&c->rows);
        return iso_polydata_name_columns(c->data, (const char *const *)c->cells, c->columns, c->slots, error);
    }
    ISO_TRY(iso_point_columns_given(c->data, c->slots, &c->columns, error));
    char *cell = *row, separators[2] = {c->separator, 0};
    if (!iso_row_number(&cell, separators, &number)) *row = iso_text_rows_next(&c->rows);
    return ISO_OK;
}

static bool is_empty(const char *row) {
    return row[strspn(row, " \t")] == 0;
}

static iso_status read_csv(csv *c, iso_error *error) {
    ISO_TRY(iso_text_rows_load(c->data->reading, &c->rows, error));
    char *row = iso_text_rows_next(&c->rows);
    if (!row) return iso_fail(error, ISO_ERR_FORMAT, "%s: the file is empty", c->rows.reading->path);
    ISO_TRY(take_names(c, &row, error));
    for (; row; row = iso_text_rows_next(&c->rows))
        if (!is_empty(row)) ISO_TRY(take_row(c, row, error));
    note_words(c);
    iso_polydata_scale_colors(c->data, true);
    return ISO_OK;
}

iso_status iso_polydata_read_csv(iso_polydata *data, iso_error *error) {
    csv *c = iso_alloc_zero(1, sizeof *c);
    if (!c) return iso_fail_memory(error, data->reading->path);
    c->data = data;
    const iso_status status = read_csv(c, error);
    iso_text_rows_free(&c->rows);
    iso_free(c);
    return status;
}
