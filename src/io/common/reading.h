/* reading: what the readers of lines and of glyphs share: options, accounting of memory, and named columns of
 * numbers that become attributes. Internal to src/io. */
#ifndef ISO_IO_COMMON_READING_H
#define ISO_IO_COMMON_READING_H

#include "base/file_types.h"
#include "base/lines.h"
#include "base/memory.h"
#include "base/zip.h"
#include "io/common/read_opts.h"

/* A file that is being read. */
typedef struct iso_reading {
    const char *path; /* borrowed; messages begin with it */
    iso_read_opts opts;
    iso_read_report *report; /* never NULL */
    uint64_t limit, used;    /* limit in bytes for buffers; bytes that they use now */
} iso_reading;

/* Begins reading `path` with `opts`, which may be NULL, and adds the file to opts->files. `report`, which the
 * caller provides, is used if opts has none. */
iso_reading iso_reading_begin(const char *path, const iso_read_opts *opts, iso_read_report *report);

/* Finds the type of the file among those with one of the bits `holds`, and stores its name in the report.
 * `what` is used in messages, for example "lines". ISO_ERR_IO; ISO_ERR_FORMAT: none of these types. */
iso_status iso_reading_find_type(iso_reading *reading, unsigned holds, const char *what, iso_file_type *type,
                                 iso_error *error);

/* Like iso_buffer_reserve, for `count` items of `each` bytes, keeping the first `keep` items. ISO_ERR_LIMIT:
 * all buffers of this file together would exceed the limit. ISO_ERR_NOMEM. */
iso_status iso_reading_reserve(iso_reading *reading, iso_buffer *buffer, size_t count, size_t each,
                               size_t keep, iso_error *error);
/* Frees a buffer that iso_reading_reserve has filled. */
void iso_reading_free(iso_reading *reading, iso_buffer *buffer);

/* Reads the whole file into `text`, followed by a zero that *bytes does not count. ISO_ERR_IO, ISO_ERR_LIMIT,
 * ISO_ERR_NOMEM. */
iso_status iso_reading_load(iso_reading *reading, iso_buffer *text, size_t *bytes, iso_error *error);

/* The bytes of a file in a ZIP archive: there, or unpacked into `buffer`. Errors: those of iso_zip_unpack;
 * ISO_ERR_LIMIT. */
iso_status iso_reading_unzip(iso_reading *reading, const iso_zip_entry *entry, iso_buffer *buffer,
                             const unsigned char **bytes, iso_error *error);

/* Adds a line to the report's notes, or drops it when there are too many. Arguments may contain any bytes. */
#if defined(__GNUC__)
__attribute__((format(printf, 2, 3)))
#endif
void iso_reading_note(iso_reading *reading, const char *format, ...);

/* Decides whether coordinates are RAS and must be converted, and stores the space in the report. `stated`:
 * the space that the format or the file states, or ISO_SPACE_FILE. A space in the caller's options takes
 * precedence. */
bool iso_reading_is_ras(iso_reading *reading, iso_space stated);

/* The largest allowed coordinate and radius, mm, as for volumes (grids/volume/volume.c). With larger ones no
 * camera could be placed. */
#define ISO_FARTHEST 1e12

/* ---- columns */

enum { ISO_COLUMN_NAME = 64 };

/* The meaning of a column. The first column with a role fills the corresponding array of the set; every other
 * column becomes an attribute. */
typedef enum iso_role {
    ISO_ROLE_NONE,
    ISO_ROLE_RADIUS, /* mm */
    ISO_ROLE_NORMAL, /* three components */
    ISO_ROLE_VECTOR, /* three components */
    ISO_ROLE_TENSOR, /* nine components, row by row */
    ISO_ROLE_COLOR   /* red, green and blue, 0 .. 255; further components are ignored */
} iso_role;

/* A column of a file: `components` floats for each item, one item after the other. */
typedef struct iso_column {
    char name[ISO_COLUMN_NAME];
    int components;
    bool per_line;
    iso_role role;
    iso_buffer values;
    float factor; /* of colours: what they are multiplied by to lie in 0 .. 255; 0: nothing */
} iso_column;

/* Sets the role of a column by its name ("radius", "nx", ..) and number of components, if it has none. */
void iso_column_set_role(iso_column *column);

/* The first column with this role, not per line, that has values; NULL if there is none. */
iso_column *iso_column_find(iso_column *columns, int count, iso_role role);

/* Turns vectors and tensors from RAS to LPS. `items`: vertices, glyphs or lines. */
void iso_column_turn(iso_column *column, size_t items);

/* Moves the radii out of a column. Radii that are negative or not finite are set to 0 and counted. */
float *iso_column_take_radii(iso_reading *reading, iso_column *column, size_t items);

/* Converts colours to bytes and frees the column's values. ISO_ERR_NOMEM. */
iso_status iso_column_take_colors(iso_reading *reading, iso_column *column, size_t items,
                                  uint8_t (**colors)[3], iso_error *error);

/* Moves the vectors out of a column. Those that are not finite become 0; `unit`: the others are normalised.
 */
float (*iso_column_take_vectors(iso_column *column, size_t items, bool unit))[3];

/* Makes attributes of the columns that have values: those move out of the buffers. Names are made printable
 * and unique. ISO_ERR_NOMEM: nothing has moved. */
iso_status iso_columns_take(iso_column *columns, int count, iso_attribute **attributes, int *attribute_count,
                            iso_error *error);

#endif
