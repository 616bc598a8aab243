/* rows: the lines of a text file that has been read into memory, and the numbers in them. A line of text is
 * called a row here, because a line is a polyline in this folder. Internal to src/io. */
#ifndef ISO_IO_COMMON_ROWS_H
#define ISO_IO_COMMON_ROWS_H

#include "io/common/reading.h"

/* Zero-initialise; iso_text_rows_free when done. */
typedef struct iso_text_rows {
    iso_reading *reading;
    iso_buffer text;
    char *at, *end;
    size_t number; /* number of the row that was read last, from 1 */
} iso_text_rows;

/* Reads the file; a byte order mark of UTF-8 is skipped. ISO_ERR_FORMAT: the mark is that of UTF-16 or
 * UTF-32. */
iso_status iso_text_rows_load(iso_reading *reading, iso_text_rows *rows, iso_error *error);
void iso_text_rows_free(iso_text_rows *rows);

/* Returns the next row without its line end (LF or CRLF), terminated by a zero byte in place; NULL at the
 * end. */
char *iso_text_rows_next(iso_text_rows *rows);

/* The same for formats in which a backslash at the end of a row continues it in the next one: such rows are
 * returned as one, and rows->number is the last of them. Comments, which begin with #, are not continued. */
char *iso_text_rows_next_continued(iso_text_rows *rows);

/* Parses the number at *text, after blanks, and moves *text behind it and behind one following character of
 * `separators`. Returns false without moving if there is no such number. To be called between
 * iso_decimal_point_begin and iso_decimal_point_end. */
bool iso_row_number(char **text, const char *separators, double *number);

/* Returns the next word of a row, terminated by a zero byte in place; NULL at the end of the row. */
char *iso_row_word(char **text);

/* Returns the next cell of a row of a table, without quotes and without blanks around it, terminated by a
 * zero byte in place; *text becomes NULL behind the last one. Between quotes, separators belong to it. */
char *iso_row_cell(char **text, char separator);

/* The character that separates the cells of a row: of comma, semicolon and tab the most frequent outside of
 * quotes, the first of equals; 0: none is there. Of decimal commas it is not the comma. */
char iso_row_separator(const char *row);

/* Whether a row has numbers with decimal commas: commas between digits, at most one in a word, and none of
 * the points that other numbers have. The words are between semicolons or blanks, and two or more. */
bool iso_row_has_decimal_commas(const char *row);
/* Makes points of the commas between digits. */
void iso_row_turn_commas(char *row);

/* Fails with ISO_ERR_FORMAT and the message "path: row N: problem". */
iso_status iso_text_rows_fail(const iso_text_rows *rows, const char *problem, iso_error *error);

#endif
