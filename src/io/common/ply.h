/* ply: a reader of PLY files (Turk 1994), safe for damaged files: ASCII and both binary byte orders, scalars
 * and lists of all eight types under both of their names, lines that end in LF or CRLF. Internal to src/io.
 *
 * Values are read one by one, in file order, as doubles (exact for every type); items of one size can be read
 * many at a time from iso_ply.in. In ASCII an item begins in a row of its own and may take several; numbers
 * behind its last one are skipped, as VTK does. Only if the file has fewer rows than items do items follow
 * each other in a row; numbers behind the last of these are an error. Before memory is allocated for an
 * element, call iso_ply_check_size, which compares the header's count with the size of the file.
 * Messages begin with the path: ISO_ERR_IO (missing, unreadable, truncated), ISO_ERR_FORMAT (not PLY). One
 * thread at a time. */
#ifndef ISO_IO_COMMON_PLY_H
#define ISO_IO_COMMON_PLY_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/status.h"
#include "grids/volume/format.h"
#include "io/common/stream.h"

enum { ISO_PLY_NAME = 64, ISO_PLY_ELEMENTS = 32, ISO_PLY_PROPERTIES = 512 };

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
    int first_property, property_count; /* in iso_ply.properties */
} iso_ply_element;

/* A file that is being read. More than 64 KiB: allocate it on the heap. */
typedef struct iso_ply {
    iso_stream in;
    iso_ply_format format;
    int element_count, property_count;
    iso_ply_element elements[ISO_PLY_ELEMENTS];
    iso_ply_property properties[ISO_PLY_PROPERTIES];
    /* From the comment "closed surface of N points" (io/points_write.h): N; 0: the header has none. */
    uint64_t closed_points;
    uint64_t items_left; /* of ASCII: items that have not been read to their end */
    enum {
        ISO_PLY_NOT_KNOWN,
        ISO_PLY_BY_ROW,
        ISO_PLY_IN_ROW
    } items; /* of ASCII: how they follow each other */
} iso_ply;

/* Opens `path` and reads the header; the first item of the first element is read next. Call iso_ply_close
 * also after a failure. `path` is borrowed until then. */
iso_status iso_ply_open(const char *path, iso_ply *ply, iso_error *error);
void iso_ply_close(iso_ply *ply);

/* Checks that the rest of the file is long enough for all items of `element`, which is read next; ISO_ERR_IO
 * if not. */
iso_status iso_ply_check_size(const iso_ply *ply, const iso_ply_element *element, iso_error *error);

/* The type of a property's values in memory. */
iso_scalar iso_ply_scalar(iso_ply_type type);

/* Returns the bytes of every item of `element`: its values, one after the other, in the byte order of the
 * format. 0: in text, or with lists, items have different sizes. */
size_t iso_ply_record_bytes(const iso_ply *ply, const iso_ply_element *element);

/* Reads the next value, of the type that the header gives. */
iso_status iso_ply_read_value(iso_ply *ply, iso_ply_type type, double *value, iso_error *error);

/* Ends an item that was read by single values. ISO_ERR_IO. */
iso_status iso_ply_end_item(iso_ply *ply, iso_error *error);

/* Reads the next item of `element`: sets value[i] to its i-th property. Lists are skipped, and their value[i]
 * is not changed. */
iso_status iso_ply_read_item(iso_ply *ply, const iso_ply_element *element, double value[ISO_PLY_PROPERTIES],
                             iso_error *error);

/* Reads the number of items of the next list, which are read next, and compares it with the file's size. */
iso_status iso_ply_read_list_count(iso_ply *ply, const iso_ply_property *list, uint64_t *count,
                                   iso_error *error);

/* Skip the next list; skip all items of `element`, which is read next. */
iso_status iso_ply_skip_list(iso_ply *ply, const iso_ply_property *list, iso_error *error);
iso_status iso_ply_skip_element(iso_ply *ply, const iso_ply_element *element, iso_error *error);

#endif
