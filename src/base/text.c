/* text: validation of UTF-8, and escaping of all that is not printable. */
#include "base/text.h"

#include <stdlib.h>
#include <string.h>
#include <strings.h>

int iso_text_utf8(const char *bytes) {
    const unsigned char *text = (const unsigned char *)bytes;
    if (text[0] < 0x80) return 1;
    int length = text[0] >= 0xf0 && text[0] < 0xf5   ? 4
                 : text[0] >= 0xe0 && text[0] < 0xf0 ? 3
                 : text[0] >= 0xc2 && text[0] < 0xe0 ? 2
                                                     : 0;
    for (int i = 1; i < length; i++)
        if ((text[i] & 0xc0) != 0x80) return 0;
    bool overlong = (text[0] == 0xe0 && text[1] < 0xa0) || (text[0] == 0xf0 && text[1] < 0x90);
    bool outside = (text[0] == 0xed && text[1] > 0x9f) || (text[0] == 0xf4 && text[1] > 0x8f);
    return overlong || outside ? 0 : length;
}

/* Whether a valid sequence is a visible character that neither breaks a line nor changes the direction of
 * writing: not U+0080 to U+009F, U+061C, U+200E, U+200F, U+2028 to U+202E, U+2066 to U+2069, nor a byte order
 * mark. */
static bool begins(const void *text, size_t bytes, const char *mark, size_t length) {
    return bytes >= length && memcmp(text, mark, length) == 0;
}

size_t iso_text_mark(const void *text, size_t bytes) {
    return begins(text, bytes, "\xef\xbb\xbf", 3) ? 3 : 0;
}

const char *iso_text_wide(const void *text, size_t bytes) {
    if (begins(text, bytes, "\0\0\xfe\xff", 4) || begins(text, bytes, "\xff\xfe\0\0", 4)) return "UTF-32";
    return begins(text, bytes, "\xfe\xff", 2) || begins(text, bytes, "\xff\xfe", 2) ? "UTF-16" : NULL;
}

static bool is_printable(const unsigned char *c, int length) {
    if (length == 1) return c[0] >= 0x20 && c[0] != 0x7f;
    if (length == 2) return !(c[0] == 0xc2 && c[1] < 0xa0) && !(c[0] == 0xd8 && c[1] == 0x9c);
    if (length == 4) return true;
    if (c[0] == 0xef && c[1] == 0xbb && c[2] == 0xbf) return false;
    if (c[0] != 0xe2) return true;
    if (c[1] == 0x80) return !(c[2] == 0x8e || c[2] == 0x8f || (c[2] >= 0xa8 && c[2] <= 0xae));
    return !(c[1] == 0x81 && c[2] >= 0xa6 && c[2] <= 0xa9);
}

/* A unit of clean text: a printable character, or the escape sequence of one byte. */
typedef struct unit {
    char text[5];
    int length; /* of text; 0 at the end of the string */
} unit;

/* Returns the next unit of *text and advances *text behind it. */
static unit next_unit(const char **text) {
    const char *at = *text;
    unit u = {{0}, 0};
    if (!*at) return u;
    int length = iso_text_utf8(at);
    if (length && is_printable((const unsigned char *)at, length)) {
        memcpy(u.text, at, (size_t)length);
        u.length = length;
        *text += length;
        return u;
    }
    const char *letters = "\nn\tt\rr";
    u.length = 4;
    for (int i = 0; i < 6; i += 2)
        if (*at == letters[i]) u.length = snprintf(u.text, sizeof u.text, "\\%c", letters[i + 1]);
    if (u.length == 4) snprintf(u.text, sizeof u.text, "\\x%02x", (unsigned char)*at);
    ++*text;
    return u;
}

static size_t clean_length(const char *text) {
    size_t length = 0;
    for (unit u = next_unit(&text); u.length; u = next_unit(&text)) length += (size_t)u.length;
    return length;
}

/* Copies units of `text`, from the byte `from` of its clean form on, as many as fit into `room` bytes,
 * without a zero. Returns their length. */
static size_t copy_units(const char *text, size_t from, char *target, size_t room) {
    size_t at = 0, used = 0;
    for (unit u = next_unit(&text); u.length; u = next_unit(&text)) {
        if (at >= from && used + (size_t)u.length > room) break;
        if (at >= from) {
            memcpy(target + used, u.text, (size_t)u.length);
            used += (size_t)u.length;
        }
        at += (size_t)u.length;
    }
    return used;
}

size_t iso_text_clean(const char *text, char *clean, size_t room) {
    static const char gap[] = "...";
    size_t whole = clean_length(text), space = room - 1, used;
    if (whole <= space || space < 4 * sizeof gap) {
        used = copy_units(text, 0, clean, space);
    } else {
        size_t tail = (space - (sizeof gap - 1)) / 2, head = space - (sizeof gap - 1) - tail;
        used = copy_units(text, 0, clean, head);
        memcpy(clean + used, gap, sizeof gap - 1);
        used += sizeof gap - 1;
        used += copy_units(text, whole - tail, clean + used, tail);
    }
    clean[used] = 0;
    return whole;
}

/* Removes an incomplete UTF-8 sequence at the end. */
static void cut_incomplete(char *text, size_t length) {
    for (size_t back = 1; back <= 3 && back <= length; back++) {
        unsigned char c = (unsigned char)text[length - back];
        if (c < 0x80) return;
        if (c < 0xc0) continue; /* a continuation byte */
        size_t wanted = c >= 0xf0 ? 4 : c >= 0xe0 ? 3 : 2;
        if (wanted > back) text[length - back] = 0;
        return;
    }
}

void iso_text_clean_in_place(char *text, size_t room) {
    size_t length = strlen(text);
    if (length + 1 >= room) cut_incomplete(text, length);
    char *copy = iso_text_clean_copy(text);
    if (copy)
        iso_text_clean(copy, text, room);
    else /* without memory: keeps ASCII only */
        for (char *c = text; *c; c++)
            if (*c < 0x20 || *c > 0x7e) *c = '?';
    free(copy);
}

char *iso_text_clean_copy(const char *text) {
    size_t room = clean_length(text) + 1;
    char *copy = malloc(room);
    if (copy) iso_text_clean(text, copy, room);
    return copy;
}

size_t iso_text_begins(const char *text, const char *name) {
    size_t length = 0;
    for (unit u = next_unit(&name); u.length; u = next_unit(&name)) {
        if (strncmp(text + length, u.text, (size_t)u.length) != 0) return 0;
        length += (size_t)u.length;
    }
    return length;
}

void iso_text_put(FILE *stream, const char *text) {
    for (unit u = next_unit(&text); u.length; u = next_unit(&text))
        fwrite(u.text, 1, (size_t)u.length, stream);
}

void iso_text_format(char *clean, size_t room, const char *format, va_list arguments) {
    /* room for two paths and a sentence; a longer text is cut at its end */
    char raw[2 * 4096 + 1024];
    vsnprintf(raw, sizeof raw, format, arguments);
    if (strlen(raw) + 1 == sizeof raw) cut_incomplete(raw, sizeof raw - 1);
    iso_text_clean(raw, clean, room);
}

bool iso_text_ends_with(const char *text, const char *suffix) {
    size_t length = strlen(text), tail = strlen(suffix);
    return length >= tail && strcmp(text + length - tail, suffix) == 0;
}

bool iso_text_has_extension(const char *name, const char *extension) {
    size_t length = strlen(name), tail = strlen(extension);
    return (length > tail || (length == tail && *extension != '.')) &&
           strcasecmp(name + length - tail, extension) == 0;
}

bool iso_text_has_word(const char *words, const char *word, size_t length) {
    while (words && *words) {
        const size_t next = strcspn(words, " ");
        if (next == length && memcmp(words, word, length) == 0) return true;
        words += next + (words[next] == ' ');
    }
    return false;
}
