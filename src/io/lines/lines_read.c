/* lines_read: finds the reader of a file of lines. */
#include "io/lines/lines_read.h"

#include <string.h>

#include "base/decimal_point.h"
#include "base/file.h"
#include "base/text.h"
#include "io/lines/lines_format.h"

typedef iso_status read_fn(iso_reading *reading, iso_lines *lines, iso_error *error);

static read_fn *reader_of(iso_file_type type) {
    switch (type) {
#define LINES(reader) return iso_lines_read_##reader;
#include "base/file_types.inc"
    default:
        break;
    }
    return NULL;
}

iso_status iso_lines_read(const char *path, const iso_read_opts *opts, iso_lines *lines, iso_error *error) {
    iso_read_report unused;
    iso_reading reading = iso_reading_begin(path, opts, &unused);
    iso_file_type type;
    ISO_TRY(iso_reading_find_type(&reading, ISO_HOLDS_LINES, "lines", &type, error));
    void *numbers = iso_decimal_point_begin();
    iso_status status = reader_of(type)(&reading, lines, error);
    iso_decimal_point_end(numbers);
    return status;
}

bool iso_lines_fill_vtk(const char *path) {
    char head[1024];
    const size_t bytes = iso_file_head(path, head, sizeof head - 1);
    head[bytes] = 0;
    return strncmp(head + iso_text_mark(head, bytes), "# vtk DataFile", 14) == 0 &&
           strcasestr(head, "\nDATASET POLYDATA");
}
