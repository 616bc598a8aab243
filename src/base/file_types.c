/* file_types: the list of file_types.inc, looked up. */
#include "base/file_types.h"

#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include "base/file.h"
#include "base/text.h"

enum { MAGICS = 6, ANYWHERE = -1 };

typedef struct magic {
    int offset; /* ANYWHERE: in the head */
    uint8_t length;
    const char *bytes;
} magic;

typedef struct row {
    const char *name, *extensions;
    magic magics[MAGICS]; /* ends with a length of 0 */
    unsigned holds;
} row;

static const row ROWS_OF_TYPES[] = {
#define AT(offset, bytes) {offset, sizeof bytes - 1, bytes},
#define WITHIN(bytes) {ANYWHERE, sizeof bytes - 1, bytes},
#define VOLUME(x) | ISO_HOLDS_VOLUME
#define MESH(x) | ISO_HOLDS_MESH
#define VALUES(x) | ISO_HOLDS_VALUES
#define LINES(x) | ISO_HOLDS_LINES
#define GLYPHS(x) | ISO_HOLDS_GLYPHS
#define POINTS | ISO_HOLDS_POINTS
#define ROWS | ISO_HOLDS_ROWS
#define RAW | ISO_HOLDS_RAW
#define STROKES | ISO_HOLDS_STROKES
#define KEYS | ISO_HOLDS_KEYS
#define SCENE | ISO_HOLDS_SCENE
#define WRITE_MESH(x) | ISO_WRITES_MESH
#define WRITE_IMAGE(x) | ISO_WRITES_IMAGE
#define WRITE_VIDEO(x) | ISO_WRITES_VIDEO
#define WRITE_POINTS | ISO_WRITES_POINTS
#define WRITE_VOLUME | ISO_WRITES_VOLUME
#define WRITE_CHANNELS | ISO_WRITES_CHANNELS
#define WRITE_REPORT | ISO_WRITES_REPORT
#define WRITE_PAGE | ISO_WRITES_PAGE
#define FILE_TYPE(name, extensions, magic, handlers) {#name, extensions, {magic{0, 0, NULL}}, 0 handlers},
#include "base/file_types.inc"
};

const char *iso_file_type_name(iso_file_type type) {
    return ROWS_OF_TYPES[type].name;
}

unsigned iso_file_type_holds(iso_file_type type) {
    return type == ISO_FILE_UNKNOWN ? 0 : ROWS_OF_TYPES[type].holds;
}

/* Copies the next of the words at *at, which are separated by blanks; false: there are no more. */
static bool next_extension(const char **at, char extension[ISO_FILE_EXTENSION]) {
    const size_t length = strcspn(*at, " ");
    snprintf(extension, ISO_FILE_EXTENSION, "%.*s", (int)length, *at);
    *at += length + ((*at)[length] == ' ');
    return length > 0;
}

void iso_file_type_extension(iso_file_type type, char extension[ISO_FILE_EXTENSION]) {
    const char *at = ROWS_OF_TYPES[type].extensions;
    next_extension(&at, extension);
}

iso_file_type iso_file_type_of_name(const char *path, unsigned holds) {
    char extension[ISO_FILE_EXTENSION], name[ISO_FILE_PATH];
    const size_t query = iso_is_url(path) ? strcspn(path, "?#") : 0; /* behind the name of a URL's file */
    if (query && path[query]) {
        snprintf(name, sizeof name, "%.*s", (int)query, path);
        path = name;
    }
    for (int type = 0; type < ISO_FILE_TYPES; type++) {
        const char *at = ROWS_OF_TYPES[type].extensions;
        if (!(ROWS_OF_TYPES[type].holds & holds)) continue;
        while (next_extension(&at, extension))
            if (iso_text_has_extension(path, extension)) return (iso_file_type)type;
    }
    return ISO_FILE_UNKNOWN;
}

static bool fits(const magic *m, const char *head, size_t bytes) {
    if (m->offset == ANYWHERE) return memmem(head, bytes, m->bytes, m->length) != NULL;
    const size_t offset = (size_t)m->offset;
    return bytes >= offset + m->length && memcmp(head + offset, m->bytes, m->length) == 0;
}

iso_file_type iso_file_type_of_head(const void *head, size_t bytes, unsigned holds) {
    const size_t mark = iso_text_mark(head, bytes);
    const char *text = (const char *)head + mark; /* (no binary format begins with such a mark) */
    bytes = (bytes < ISO_FILE_HEAD ? bytes : ISO_FILE_HEAD) - mark;
    for (int type = 0; type < ISO_FILE_TYPES; type++) {
        if (!(ROWS_OF_TYPES[type].holds & holds)) continue;
        for (const magic *m = ROWS_OF_TYPES[type].magics; m->length; m++)
            if (fits(m, text, bytes)) return (iso_file_type)type;
    }
    return ISO_FILE_UNKNOWN;
}

iso_file_type iso_file_type_find(const char *path, unsigned holds) {
    char head[ISO_FILE_HEAD];
    const iso_file_type found = iso_file_type_of_head(head, iso_file_head(path, head, sizeof head), holds);
    return found != ISO_FILE_UNKNOWN ? found : iso_file_type_of_name(path, holds);
}

void iso_file_type_extensions(unsigned holds, unsigned without, const char *last, char *text, size_t room) {
    enum { MOST = 256 };
    const char *words[MOST];
    char extension[ISO_FILE_EXTENSION];
    int lengths[MOST], count = 0;
    for (int type = 0; type < ISO_FILE_TYPES; type++) {
        const char *at = ROWS_OF_TYPES[type].extensions, *word = at;
        if (!(ROWS_OF_TYPES[type].holds & holds) || ROWS_OF_TYPES[type].holds & without) continue;
        for (bool more = true; more && count < MOST && next_extension(&at, extension); word = at) {
            words[count] = word;
            lengths[count++] = (int)strlen(extension);
            more = !last;
        }
    }
    size_t used = 0;
    *text = 0;
    for (int i = 0; i < count && used < room; i++) {
        const bool ends = last && *last && i > 0 && i == count - 1;
        const char *comma = i == 0 ? "" : ends ? " " : last ? ", " : " ";
        used += (size_t)snprintf(text + used, room - used, "%s%s%s%.*s", comma, ends ? last : "",
                                 ends ? " " : "", lengths[i], words[i]);
    }
}
