/* Builds JSON documents with jansson. */
#include "apps/common/json.h"

#include <assert.h>
#include <jansson.h>
#include <math.h>
#include <stdlib.h>

#include "base/text.h"

/* ---- members */

/* Adds a value to the innermost object or array that is open, which owns it from then on. NULL: there was no
 * memory for the value; nothing more is added. */
static void add(iso_json *json, const char *key, json_t *value) {
    if (json->failed) {
        json_decref(value);
        return;
    }
    json_t *parent = json->depth > 0 ? json->open[json->depth - 1] : NULL;
    if (!parent)
        json->document = value;
    else if (json_is_object(parent))
        json->failed = json_object_set_new(parent, key, value) != 0;
    else
        json->failed = json_array_append_new(parent, value) != 0;
    json->failed |= !value;
}

static void begin(iso_json *json, const char *key, json_t *value) {
    assert(json->depth < ISO_JSON_DEPTH);
    add(json, key, value);
    json->open[json->depth++] = value; /* not used if adding it failed */
}

void iso_json_begin_object(iso_json *json, const char *key) {
    begin(json, key, json_object());
}
void iso_json_end_object(iso_json *json) {
    json->depth--;
}
void iso_json_begin_array(iso_json *json, const char *key) {
    begin(json, key, json_array());
}
void iso_json_end_array(iso_json *json) {
    json->depth--;
}

/* NULL: no memory. */
static json_t *string_of(const char *text) {
    json_t *string = json_string(text);
    if (string) return string;
    char *clean = iso_text_clean_copy(text); /* it is not UTF-8 */
    string = json_string(clean);             /* NULL for NULL */
    free(clean);
    return string;
}

static json_t *real_of(double value) {
    return isfinite(value) ? json_real(value) : json_null();
}

void iso_json_string(iso_json *json, const char *key, const char *value) {
    add(json, key, value ? string_of(value) : json_null());
}

void iso_json_real(iso_json *json, const char *key, double value) {
    add(json, key, real_of(value));
}

void iso_json_integer(iso_json *json, const char *key, uint64_t value) {
    /* jansson's integers are signed. */
    add(json, key, value <= INT64_MAX ? json_integer((json_int_t)value) : json_real((double)value));
}

void iso_json_bool(iso_json *json, const char *key, bool value) {
    add(json, key, json_boolean(value));
}

void iso_json_reals(iso_json *json, const char *key, const double *values, int count) {
    iso_json_begin_array(json, key);
    for (int i = 0; i < count; i++) iso_json_real(json, NULL, values[i]);
    iso_json_end_array(json);
}

void iso_json_ints(iso_json *json, const char *key, const int *values, int count) {
    iso_json_begin_array(json, key);
    for (int i = 0; i < count; i++) add(json, NULL, json_integer(values[i]));
    iso_json_end_array(json);
}

/* ---- the document */

void iso_json_discard(iso_json *json) {
    json_decref(json->document);
    *json = (iso_json){0};
}

iso_status iso_json_write(iso_json *json, FILE *stream, iso_error *error) {
    /* In small pieces: what the stream cannot write stays in its buffer, and writing it again tells why. */
    const bool complete =
        !json->failed && json_dumpf(json->document, stream,
                                    (json->one_line ? 0 : JSON_INDENT(2)) | JSON_REAL_PRECISION(17)) == 0;
    iso_json_discard(json);
    if (!complete && !ferror(stream))
        return iso_fail(error, ISO_ERR_NOMEM, "out of memory for a report in JSON");
    fputc('\n', stream);
    return ISO_OK;
}

iso_status iso_json_commit(iso_json *json, iso_sink *sink, iso_error *error) {
    const iso_status status = iso_json_write(json, sink->stream, error);
    if (status == ISO_OK) return iso_sink_commit(sink, error);
    iso_sink_abort(sink);
    return status;
}
