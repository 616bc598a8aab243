/* lines_format: the readers of single formats (base/file_types.inc), behind iso_lines_read. Internal to
 * src/io/lines. Each returns the errors of iso_lines_read, whose messages begin with the path, and sets
 * `lines` only when it succeeds. */
#ifndef ISO_IO_LINES_LINES_FORMAT_H
#define ISO_IO_LINES_LINES_FORMAT_H

#include "io/common/reading.h"

#define LINES(reader)                                                                                        \
    iso_status iso_lines_read_##reader(iso_reading *reading, iso_lines *lines, iso_error *error);
#define FILE_TYPE(name, extensions, magic, handlers) handlers
#include "base/file_types.inc"

#endif
