/* file_set: the files that a program reads and those that it writes, for checking that no output overwrites
 * an input or another output.
 *
 * An existing file is identified by device and inode, so that symbolic and hard links count as the same file;
 * a file that does not exist yet by its folder's inode and its name. Files that are not regular (a terminal,
 * /dev/null, a pipe) are not recorded. One thread at a time. */
#ifndef ISO_BASE_FILE_SET_H
#define ISO_BASE_FILE_SET_H

#include <stdbool.h>
#include <stddef.h>

#include "base/status.h"

/* The files that a program reads and writes. Initialise with zeros; free with iso_file_set_free. */
typedef struct iso_file_set {
    struct iso_file_entry *entries; /* owned */
    size_t count, room;
    bool incomplete; /* files are missing for lack of memory: iso_file_set_check fails */
} iso_file_set;

/* Adds a file that is read. A NULL set is ignored. */
void iso_file_set_read(iso_file_set *set, const char *path);

/* Adds a file that is read and that messages call `name` instead of `path`. */
void iso_file_set_read_as(iso_file_set *set, const char *path, const char *name);

/* Adds an output; "-" is standard output. A NULL path is ignored. */
void iso_file_set_write(iso_file_set *set, const char *path);

/* Checks all files. ISO_ERR_USAGE: an output is the same file as a file that is read or as another output;
 * the message names both. ISO_ERR_NOMEM. Call it when all files are added, before any output is written. */
iso_status iso_file_set_check(const iso_file_set *set, iso_error *error);

void iso_file_set_free(iso_file_set *set);

#endif
