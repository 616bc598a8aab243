/* json: writes one JSON document to a stream, indented, with the commas in the right places.
 *
 * `key` is the member's name inside an object and NULL inside an array (and for the outermost value). Strings
 * are UTF-8; bytes that are not become U+FFFD. Numbers are the shortest that read back the same; NaN and
 * infinities become null. Write errors are not returned: check the stream with ferror. One thread at a time.
 *
 * Not written with jansson, which stroke files are read and written with (sculpt/session/event.c): its
 * numbers have a fixed count of digits, so that 0.1 becomes 0.10000000000000001 where all must read back the
 * same; its arrays take a line for each number; and it builds the whole document in memory first. */
#ifndef ISO_APPS_COMMON_JSON_H
#define ISO_APPS_COMMON_JSON_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Zero-initialise but for the stream, which is borrowed. */
typedef struct iso_json {
    FILE *stream;
    int depth;
    bool filled;  /* the innermost object or array has a member already */
    bool inlined; /* inside an array of numbers: kept on one line */
} iso_json;

void iso_json_begin_object(iso_json *json, const char *key);
void iso_json_end_object(iso_json *json);
void iso_json_begin_array(iso_json *json, const char *key);
void iso_json_end_array(iso_json *json);

void iso_json_string(iso_json *json, const char *key, const char *value); /* NULL: null */
void iso_json_real(iso_json *json, const char *key, double value);
void iso_json_integer(iso_json *json, const char *key, uint64_t value);
void iso_json_bool(iso_json *json, const char *key, bool value);
void iso_json_null(iso_json *json, const char *key);

/* An array of `count` numbers on one line. */
void iso_json_reals(iso_json *json, const char *key, const double *values, int count);
void iso_json_ints(iso_json *json, const char *key, const int *values, int count);

#ifdef __cplusplus
}
#endif
#endif
