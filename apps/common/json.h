/* json: builds a JSON document, member by member, and writes it, indented or as one line. jansson, which
 * also reads and writes stroke files (sculpt/session/event.c), holds and encodes it.
 *
 * `key` is the member's name inside an object and NULL inside an array (and for the outermost value).
 * Members keep their order. Strings that are not UTF-8 are quoted as iso_text_clean does it. Numbers have
 * 17 digits, so that they are read back as the same number; NaN and infinities become null. Errors are
 * reported by iso_json_write. Not thread-safe. */
#ifndef ISO_APPS_COMMON_JSON_H
#define ISO_APPS_COMMON_JSON_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#include "base/file.h"
#include "base/status.h"

enum { ISO_JSON_DEPTH = 16 };

/* A document under construction. Zero-initialise; ends with iso_json_write or iso_json_discard. */
typedef struct iso_json {
    struct json_t *document, *open[ISO_JSON_DEPTH]; /* open: the objects and arrays that are not ended yet */
    int depth;
    bool one_line; /* written without line breaks; the caller's */
    bool failed;   /* there was no memory for a member */
} iso_json;

void iso_json_begin_object(iso_json *json, const char *key);
void iso_json_end_object(iso_json *json);
void iso_json_begin_array(iso_json *json, const char *key);
void iso_json_end_array(iso_json *json);

void iso_json_string(iso_json *json, const char *key, const char *value); /* adds null if value is NULL */
void iso_json_real(iso_json *json, const char *key, double value);
void iso_json_integer(iso_json *json, const char *key, uint64_t value);
void iso_json_bool(iso_json *json, const char *key, bool value);

/* Add an array of `count` numbers. */
void iso_json_reals(iso_json *json, const char *key, const double *values, int count);
void iso_json_ints(iso_json *json, const char *key, const int *values, int count);

/* Writes the document, with a line break at its end, and frees it. ISO_ERR_NOMEM: it is incomplete. Errors
 * of the stream are not returned: check it with ferror. */
iso_status iso_json_write(iso_json *json, FILE *stream, iso_error *error);

/* Writes the document as iso_json_write does and commits the file, or aborts it. Errors: those of both. */
iso_status iso_json_commit(iso_json *json, iso_sink *sink, iso_error *error);

/* Frees a document that is not to be written. */
void iso_json_discard(iso_json *json);

#endif
