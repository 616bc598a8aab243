#include "apps/common/json.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"

static void put_string(FILE *stream, const char *value) {
    const unsigned char *text = (const unsigned char *)value;
    fputc('"', stream);
    while (*text) {
        int length = iso_text_utf8((const char *)text);
        if (length == 0) {
            fputs("\\ufffd", stream);
            length = 1;
        } else if (*text == '"' || *text == '\\') {
            fprintf(stream, "\\%c", *text);
        } else if (*text < 0x20 || *text == 0x7f) {
            fprintf(stream, "\\u%04x", *text);
        } else {
            fwrite(text, 1, (size_t)length, stream);
        }
        text += length;
    }
    fputc('"', stream);
}

static void put_real(FILE *stream, double value) {
    if (!isfinite(value)) {
        fputs("null", stream);
        return;
    }
    char text[40];
    for (int digits = 6; digits <= 17; digits++) {
        snprintf(text, sizeof text, "%.*g", digits, value);
        if (strtod(text, NULL) == value) break;
    }
    fputs(text, stream);
}

/* Writes the comma, line break and key that precede a value. */
static void begin_value(iso_json *json, const char *key) {
    if (json->filled) fputs(json->inlined ? ", " : ",", json->stream);
    if (json->depth > 0 && !json->inlined) fprintf(json->stream, "\n%*s", 2 * json->depth, "");
    if (key) {
        put_string(json->stream, key);
        fputs(": ", json->stream);
    }
    json->filled = true;
}

static void open_level(iso_json *json, const char *key, char bracket) {
    begin_value(json, key);
    fputc(bracket, json->stream);
    json->depth++;
    json->filled = false;
}

static void close_level(iso_json *json, char bracket) {
    json->depth--;
    if (json->filled) fprintf(json->stream, "\n%*s", 2 * json->depth, "");
    fputc(bracket, json->stream);
    json->filled = true;
    if (json->depth == 0) fputc('\n', json->stream);
}

void iso_json_begin_object(iso_json *json, const char *key) {
    open_level(json, key, '{');
}
void iso_json_end_object(iso_json *json) {
    close_level(json, '}');
}
void iso_json_begin_array(iso_json *json, const char *key) {
    open_level(json, key, '[');
}
void iso_json_end_array(iso_json *json) {
    close_level(json, ']');
}

void iso_json_string(iso_json *json, const char *key, const char *value) {
    if (!value) {
        iso_json_null(json, key);
        return;
    }
    begin_value(json, key);
    put_string(json->stream, value);
}

void iso_json_real(iso_json *json, const char *key, double value) {
    begin_value(json, key);
    put_real(json->stream, value);
}

void iso_json_integer(iso_json *json, const char *key, uint64_t value) {
    begin_value(json, key);
    fprintf(json->stream, "%llu", (unsigned long long)value);
}

void iso_json_bool(iso_json *json, const char *key, bool value) {
    begin_value(json, key);
    fputs(value ? "true" : "false", json->stream);
}

void iso_json_null(iso_json *json, const char *key) {
    begin_value(json, key);
    fputs("null", json->stream);
}

static void begin_line(iso_json *json, const char *key) {
    begin_value(json, key);
    fputc('[', json->stream);
    json->inlined = true;
    json->filled = false;
}

static void end_line(iso_json *json) {
    fputc(']', json->stream);
    json->inlined = false;
    json->filled = true;
}

void iso_json_reals(iso_json *json, const char *key, const double *values, int count) {
    begin_line(json, key);
    for (int i = 0; i < count; i++) iso_json_real(json, NULL, values[i]);
    end_line(json);
}

void iso_json_ints(iso_json *json, const char *key, const int *values, int count) {
    begin_line(json, key);
    for (int i = 0; i < count; i++) {
        begin_value(json, NULL);
        fprintf(json->stream, "%d", values[i]);
    }
    end_line(json);
}
