/* file_set: the files that a program reads and those that it writes, so that none of them is written over.
 *
 * A file that is there is known by device and inode, so that symbolic and hard links are the same file; one
 * that is not there yet by its folder's inode and its name. What is no regular file (a terminal, /dev/null, a
 * pipe) is never in the set. One thread at a time. */
#ifndef ISO_BASE_FILE_SET_H
#define ISO_BASE_FILE_SET_H

#include <stdbool.h>
#include <stddef.h>

#include "base/status.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Zero-initialise; iso_file_set_free when done. */
typedef struct iso_file_set {
    struct iso_file_entry *entries; /* owned */
    size_t count, room;
    bool incomplete; /* there was no memory for all; iso_file_set_check says so */
} iso_file_set;

/* Adds a file that is read. NULL for the set: nothing happens. */
void iso_file_set_read(iso_file_set *set, const char *path);

/* As iso_file_set_read; messages call the file `name` instead of `path`. */
void iso_file_set_read_as(iso_file_set *set, const char *path, const char *name);

/* Adds an output; "-" is standard output. NULL for the path: nothing happens. */
void iso_file_set_write(iso_file_set *set, const char *path);

/* ISO_ERR_USAGE, naming both, when an output is a file that is read or another output; ISO_ERR_NOMEM. To be
 * called when all is known that will be read and before anything is written. */
iso_status iso_file_set_check(const iso_file_set *set, iso_error *error);

void iso_file_set_free(iso_file_set *set);

#ifdef __cplusplus
}
#endif
#endif
