/* glyphs_support: reads files of glyphs, and checks what was read, for the tests of their readers. */
#ifndef ISO_TESTS_GLYPHS_SUPPORT_H
#define ISO_TESTS_GLYPHS_SUPPORT_H

#include "io/glyphs/glyphs_read.h"

/* What the last of these readings reported. */
extern iso_read_report report;

/* Reads a file; fails the test if that fails. `opts.report` is set here. */
iso_glyphs read_with(const char *path, iso_read_opts opts);
/* Writes a file and reads it. */
iso_glyphs read_text(const char *path, const char *text);

/* Fails the test unless reading fails with a status and a message that has the path and `reason`. */
void refuse(const char *path, iso_read_opts opts, iso_status wanted, const char *reason);
void refuse_text(const char *path, const char *text, iso_status status, const char *reason);

/* Writes every beginning of a file and reads it: it is read, or refused with a message of one line that has
 * the path. */
void read_truncated(const char *path, const void *bytes, size_t count, iso_read_opts opts);

/* The attribute with that name; fails the test if there is none. */
const iso_attribute *find_attribute(const iso_glyphs *glyphs, const char *name);
void check_vector(const float got[3], double x, double y, double z);
/* The position of a glyph in the world. */
void check_place(const iso_glyphs *glyphs, size_t glyph, double x, double y, double z, double tolerance);

#endif
