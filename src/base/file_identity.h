/* file_identity: whether files are still the same, by inodes, sizes, times and a part of their content. */
#ifndef ISO_BASE_FILE_IDENTITY_H
#define ISO_BASE_FILE_IDENTITY_H

#include <stdint.h>

#include "base/file_set.h"

/* The sizes of all files of a set that are read, together, when they were added. */
uint64_t iso_file_set_read_bytes(const iso_file_set *set);

/* A number made of the inodes and sizes of the files that are read, of when they were modified and changed,
 * and of a few blocks of the first of them (of those that iso_file_set_read has added): another one, most
 * likely, when one of them is another file, or the same with other content, whatever times have been set. It
 * reads the files. */
uint64_t iso_file_set_identity(const iso_file_set *set);

/* A number made of the sizes of the files that are read and, of few files, of a few blocks of each: the same
 * for copies in other folders and on other machines. It reads the files. */
uint64_t iso_file_set_content(const iso_file_set *set);

/* Goes on with the hash of some bytes (Fowler, Noll and Vo's FNV-1a); begin with any number. */
uint64_t iso_hash(uint64_t hash, const void *bytes, size_t count);

#endif
