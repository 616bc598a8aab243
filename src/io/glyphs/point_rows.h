/* point_rows: points as rows of numbers in text. Internal to src/io/glyphs. */
#ifndef ISO_IO_GLYPHS_POINT_ROWS_H
#define ISO_IO_GLYPHS_POINT_ROWS_H

#include "io/common/rows.h"
#include "io/polydata/polydata.h"

/* Returns the next row that is neither empty nor a comment (# or //); NULL at the end. */
char *iso_point_rows_next(iso_text_rows *rows);

/* Whether a row is one whole number, which counts what follows; stores it. */
bool iso_point_rows_is_count(char *row, double *count);

/* Reads points from `row`, the first one that iso_point_rows_next has returned, to the end: a row of names
 * that include x y z, and rows of as many numbers; or rows of 3 to 10 numbers, which iso_point_columns_decide
 * names. ISO_ERR_FORMAT; ISO_ERR_LIMIT, ISO_ERR_NOMEM. */
iso_status iso_point_rows_read(iso_polydata *data, iso_text_rows *rows, char *row, iso_error *error);

#endif
