/* rows: text files in memory. */
#include "io/rows.h"

#include <stdlib.h>
#include <string.h>

#include "base/text.h"

iso_status iso_rows_load(iso_reading *reading, iso_rows *rows, iso_error *error) {
    size_t bytes;
    rows->reading = reading;
    ISO_TRY(iso_reading_load(reading, &rows->text, &bytes, error));
    rows->at = rows->text.data;
    rows->end = rows->at + bytes;
    const char *wide = iso_text_wide(rows->at, bytes);
    if (wide)
        return iso_fail(error, ISO_ERR_FORMAT, "%s: text in %s, which is not read; save it as UTF-8",
                        reading->path, wide);
    rows->at += iso_text_mark(rows->at, bytes);
    return ISO_OK;
}

void iso_rows_free(iso_rows *rows) {
    if (rows->text.data) iso_reading_free(rows->reading, &rows->text);
}

char *iso_rows_next(iso_rows *rows) {
    if (rows->at == rows->end) return NULL;
    char *row = rows->at, *end = memchr(row, '\n', (size_t)(rows->end - row));
    rows->at = end ? end + 1 : rows->end;
    if (!end) end = rows->end;
    *end = 0;
    if (end > row && end[-1] == '\r') end[-1] = 0;
    rows->number++;
    return row;
}

static bool is_blank(char c) {
    return c == ' ' || c == '\t';
}

bool iso_row_number(char **text, const char *separators, double *number) {
    char *end, *start = *text;
    while (is_blank(*start)) start++;
    *number = strtod(start, &end);
    const bool ended = *end == 0 || is_blank(*end) || strchr(separators, *end);
    if (end == start || !ended) return false;
    while (is_blank(*end)) end++;
    *text = *end && strchr(separators, *end) ? end + 1 : end;
    return true;
}

char *iso_row_word(char **text) {
    char *word = *text + strspn(*text, " \t");
    if (!*word) return NULL;
    char *end = word + strcspn(word, " \t");
    *text = *end ? end + 1 : end;
    *end = 0;
    return word;
}

iso_status iso_rows_fail(const iso_rows *rows, const char *problem, iso_error *error) {
    return iso_fail(error, ISO_ERR_FORMAT, "%s: row %zu: %s", rows->reading->path, rows->number, problem);
}
