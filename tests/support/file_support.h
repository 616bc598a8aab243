/* file_support: whole files, for tests that cut and damage them. */
#ifndef ISO_TESTS_FILE_SUPPORT_H
#define ISO_TESTS_FILE_SUPPORT_H

#include <stddef.h>

/* All of a file, to be freed; a zero stands after its `count` bytes. The test fails when there is none. */
void *slurp(const char *path, size_t *count);
/* A new file each time: some file systems flush one that is rewritten to the disk. */
void spill(const char *path, const void *data, size_t count);

#endif
