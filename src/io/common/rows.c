/* rows: text files in memory. */
#include "io/common/rows.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/text.h"

iso_status iso_text_rows_load(iso_reading *reading, iso_text_rows *rows, iso_error *error) {
    size_t bytes;
    rows->reading = reading;
    ISO_TRY(iso_reading_load(reading, &rows->text, &bytes, error));
    rows->at = rows->text.data;
    rows->end = rows->at + bytes;
    ISO_TRY(iso_file_check_text(reading->path, rows->at, bytes, error));
    rows->at += iso_text_mark(rows->at, bytes);
    return ISO_OK;
}

void iso_text_rows_free(iso_text_rows *rows) {
    if (rows->text.data) iso_reading_free(rows->reading, &rows->text);
}

/* Moves behind the end of the row and returns where its text ends. */
static char *end_row(iso_text_rows *rows) {
    char *row = rows->at, *end = memchr(row, '\n', (size_t)(rows->end - row));
    rows->at = end ? end + 1 : rows->end;
    if (!end) end = rows->end;
    rows->number++;
    return end > row && end[-1] == '\r' ? end - 1 : end;
}

char *iso_text_rows_next(iso_text_rows *rows) {
    if (rows->at == rows->end) return NULL;
    char *row = rows->at;
    *end_row(rows) = 0;
    return row;
}

char *iso_text_rows_next_continued(iso_text_rows *rows) {
    if (rows->at == rows->end) return NULL;
    char *row = rows->at, *end = end_row(rows);
    const bool comment = row[strspn(row, " \t")] == '#';
    while (!comment && end > row && end[-1] == '\\' && rows->at < rows->end) {
        memset(end - 1, ' ', (size_t)(rows->at - end + 1)); /* the backslash and the end of the row */
        end = end_row(rows);
    }
    *end = 0;
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

char *iso_row_cell(char **text, char separator) {
    char *cell = *text, *end, *after;
    while (is_blank(*cell) && *cell != separator) cell++;
    if (*cell == '"') {
        cell++;
        end = cell + strcspn(cell, "\"");
        after = *end ? end + 1 : end;
        while (*after && *after != separator) after++;
    } else {
        end = after = strchr(cell, separator) ? strchr(cell, separator) : cell + strlen(cell);
        while (end > cell && is_blank(end[-1])) end--;
    }
    *text = *after ? after + 1 : NULL;
    *end = 0;
    return cell;
}

char iso_row_separator(const char *row) {
    static const char candidates[] = ",;\t";
    const int first = iso_row_has_decimal_commas(row);
    int counts[3] = {0}, best = first;
    bool quoted = false;
    for (const char *at = row; *at; at++) {
        const char *found = strchr(candidates, *at);
        quoted ^= *at == '"';
        if (found && !quoted) counts[found - candidates]++;
    }
    for (int k = first; k < 3; k++)
        if (counts[k] > counts[best]) best = k;
    return counts[best] ? candidates[best] : 0;
}

static bool is_decimal_comma(const char *row, const char *at) {
    return *at == ',' && at > row && isdigit((unsigned char)at[-1]) && isdigit((unsigned char)at[1]);
}

bool iso_row_has_decimal_commas(const char *row) {
    int words = 0, commas = 0;
    for (const char *at = row + strspn(row, "; \t"); *at; at += strspn(at, "; \t")) {
        const size_t length = strcspn(at, "; \t");
        int own = 0;
        for (const char *end = at + length; at < end; at++) {
            if (*at == '.' || (*at == ',' && !is_decimal_comma(row, at))) return false;
            own += *at == ',';
        }
        if (own > 1) return false;
        commas += own;
        words++;
    }
    return words >= 2 && commas > 0;
}

void iso_row_turn_commas(char *row) {
    for (char *at = row; *at; at++)
        if (is_decimal_comma(row, at)) *at = '.';
}

iso_status iso_text_rows_fail(const iso_text_rows *rows, const char *problem, iso_error *error) {
    return iso_fail(error, ISO_ERR_FORMAT, "%s: row %zu: %s", rows->reading->path, rows->number, problem);
}
