/* glyphs_format: the readers of single formats (base/file_types.inc), behind iso_glyphs_read. Internal to
 * src/io/glyphs. Each returns the errors of iso_glyphs_read, whose messages begin with the path, and sets
 * `glyphs` only when it succeeds. */
#ifndef ISO_IO_GLYPHS_GLYPHS_FORMAT_H
#define ISO_IO_GLYPHS_GLYPHS_FORMAT_H

#include "base/glyphs.h"
#include "io/common/reading.h"

#define GLYPHS(reader)                                                                                       \
    iso_status iso_glyphs_read_##reader(iso_reading *reading, iso_glyphs *glyphs, iso_error *error);
#define FILE_TYPE(name, extensions, magic, handlers) handlers
#include "base/file_types.inc"

#endif
