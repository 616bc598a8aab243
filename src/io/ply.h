/* ply: a reader of PLY files (Turk 1994) that trusts nothing: ASCII and both binary byte orders, scalars and
 * lists of all eight types under both of their names, LF and CRLF. Internal to src/io.
 *
 * Values are handed out one by one, in file order, as doubles (exact for every type). No memory is taken on
 * the header's word: what an element needs at least is checked against what the file still holds. Errors name
 * the file: ISO_ERR_IO (missing, unreadable, truncated), ISO_ERR_FORMAT (not PLY). One thread at a time. */
#ifndef ISO_IO_PLY_H
#define ISO_IO_PLY_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include "base/status.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { ISO_PLY_NAME = 64, ISO_PLY_ELEMENTS = 32, ISO_PLY_PROPERTIES = 512, ISO_PLY_BUFFER = 1 << 16 };

typedef enum iso_ply_format { ISO_PLY_ASCII, ISO_PLY_LITTLE, ISO_PLY_BIG } iso_ply_format;

typedef enum iso_ply_type {
    ISO_PLY_INT8,
    ISO_PLY_UINT8,
    ISO_PLY_INT16,
    ISO_PLY_UINT16,
    ISO_PLY_INT32,
    ISO_PLY_UINT32,
    ISO_PLY_FLOAT32,
    ISO_PLY_FLOAT64
} iso_ply_type;

typedef struct iso_ply_property {
    char name[ISO_PLY_NAME];
    iso_ply_type type; /* of a list: of its items */
    bool is_list;
    iso_ply_type count_type; /* of a list: an integer type */
} iso_ply_property;

typedef struct iso_ply_element {
    char name[ISO_PLY_NAME];
    uint64_t count;
    int first_property, property_count;
} iso_ply_element;

/* A file that is being read. Large (64 KiB): allocate it. */
typedef struct iso_ply {
    const char *path; /* borrowed */
    FILE *stream;
    iso_ply_format format;
    int element_count, property_count;
    iso_ply_element elements[ISO_PLY_ELEMENTS];
    iso_ply_property properties[ISO_PLY_PROPERTIES];
    uint64_t remaining; /* bytes after the current place */
    size_t place, end;  /* in the buffer */
    unsigned char buffer[ISO_PLY_BUFFER];
} iso_ply;

/* Opens `path` and reads the header; the place is then the first item of the first element. iso_ply_close
 * also after a failure. `path` is kept until then. */
iso_status iso_ply_open(const char *path, iso_ply *ply, iso_error *error);
void iso_ply_close(iso_ply *ply);

/* ISO_ERR_IO when the file cannot hold all items of `element`, the next to be read. */
iso_status iso_ply_check_size(const iso_ply *ply, const iso_ply_element *element, iso_error *error);

/* The next value, which the header says is of `type`. */
iso_status iso_ply_read_value(iso_ply *ply, iso_ply_type type, double *value, iso_error *error);

/* The next item of `element`: value[i] becomes its i-th property. Lists are skipped and leave theirs alone.
 */
iso_status iso_ply_read_item(iso_ply *ply, const iso_ply_element *element, double value[ISO_PLY_PROPERTIES],
                             iso_error *error);

/* Skips the next list, or all items of `element`. */
iso_status iso_ply_skip_list(iso_ply *ply, const iso_ply_property *list, iso_error *error);
iso_status iso_ply_skip_element(iso_ply *ply, const iso_ply_element *element, iso_error *error);

#ifdef __cplusplus
}
#endif
#endif
