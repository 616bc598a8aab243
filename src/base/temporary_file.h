/* temporary_file: files without names, in TMPDIR or beside another file, for what does not fit into memory.
 * The system removes them when they are closed, and when the program ends in any way. */
#ifndef ISO_BASE_TEMPORARY_FILE_H
#define ISO_BASE_TEMPORARY_FILE_H

#include <stdint.h>

/* The value of TMPDIR, or /tmp. */
const char *iso_temporary_folder(void);

/* Makes a file without a name in the folder of the file `path`, for reading and writing; for any thread.
 * Returns its descriptor, which the caller closes, or a negative number: the negated errno. */
int iso_temporary_file_beside(const char *path);

/* Makes a file of `bytes` bytes in iso_temporary_folder(), for reading and writing. Its room on the disk is
 * reserved: a disk that is full when a mapped file is written to would end the program. Returns its
 * descriptor, which the caller closes, or a negative number: the negated errno. Any thread. */
int iso_temporary_file_create(uint64_t bytes);

#endif
