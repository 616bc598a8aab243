/* rows: the lines of a text file that has been read into memory, and the numbers in them. A line of text is
 * called a row, because lines are what files hold. Internal to src/io. */
#ifndef ISO_IO_ROWS_H
#define ISO_IO_ROWS_H

#include "io/reading.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Zero-initialise; iso_rows_free when done. */
typedef struct iso_rows {
    iso_reading *reading;
    iso_buffer text;
    char *at, *end;
    size_t number; /* of the row that was read last, from 1 */
} iso_rows;

iso_status iso_rows_load(iso_reading *reading, iso_rows *rows, iso_error *error);
void iso_rows_free(iso_rows *rows);

/* The next row, without its end (LF or CRLF), ended by a zero byte in place; NULL at the end. */
char *iso_rows_next(iso_rows *rows);

/* Parses the number at *text, after blanks, and moves *text behind it and behind one of `separators`, if
 * there is one. False, without moving: there is anything else. Between iso_encode_numbers_begin and
 * iso_encode_numbers_end. */
bool iso_row_number(char **text, const char *separators, double *number);

/* The next word of a row, ended by a zero byte in place; NULL at its end. */
char *iso_row_word(char **text);

/* ISO_ERR_FORMAT "path: row N: problem". */
iso_status iso_rows_fail(const iso_rows *rows, const char *problem, iso_error *error);

#ifdef __cplusplus
}
#endif
#endif
