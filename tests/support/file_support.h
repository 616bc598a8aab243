/* file_support: reads and writes whole files, for tests that truncate and damage them. */
#ifndef ISO_TESTS_FILE_SUPPORT_H
#define ISO_TESTS_FILE_SUPPORT_H

#include <stddef.h>

/* Reads a whole file into memory, to be released with free(); a zero follows its `count` bytes. Fails the
 * test on errors. */
void *slurp(const char *path, size_t *count);
/* Writes a whole file. Replaces the file instead of rewriting it, which some file systems flush to the disk.
 */
void spill(const char *path, const void *data, size_t count);

#endif
