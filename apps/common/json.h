/* json: writes a JSON document to a stream, with indentation and commas.
 *
 * `key` is the member's name inside an object and NULL inside an array (and for the outermost value). Strings
 * are UTF-8; bytes that are not become U+FFFD. Numbers have the fewest digits that are read back as the same
 * number; NaN and infinities become null. Write errors are not returned: check the stream with ferror. Not
 * thread-safe.
 *
 * The library jansson, which reads and writes stroke files (sculpt/session/event.c), is not used here for
 * three reasons: it writes numbers with a fixed count of digits, 0.1 as 0.10000000000000001; it puts each
 * number of an array on its own line; and it builds the whole document in memory. */
#ifndef ISO_APPS_COMMON_JSON_H
#define ISO_APPS_COMMON_JSON_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Zero-initialise everything except the stream, which is borrowed. */
typedef struct iso_json {
    FILE *stream;
    int depth;
    bool filled;  /* the innermost object or array already has a member */
    bool inlined; /* inside an array of numbers: kept on one line */
} iso_json;

void iso_json_begin_object(iso_json *json, const char *key);
void iso_json_end_object(iso_json *json);
void iso_json_begin_array(iso_json *json, const char *key);
void iso_json_end_array(iso_json *json);

void iso_json_string(iso_json *json, const char *key, const char *value); /* writes null if value is NULL */
void iso_json_real(iso_json *json, const char *key, double value);
void iso_json_integer(iso_json *json, const char *key, uint64_t value);
void iso_json_bool(iso_json *json, const char *key, bool value);
void iso_json_null(iso_json *json, const char *key);

/* Writes an array of `count` numbers on one line. */
void iso_json_reals(iso_json *json, const char *key, const double *values, int count);
void iso_json_ints(iso_json *json, const char *key, const int *values, int count);

#ifdef __cplusplus
}
#endif
#endif
