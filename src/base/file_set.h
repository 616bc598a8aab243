/* file_set: the files that a program reads and writes, for the check that no output overwrites an input or
 * another output.
 *
 * An existing file is identified by device and inode, so that symbolic and hard links to a file count as the
 * same file. A file that does not exist yet is identified by its folder and its name. Files that are not
 * regular (a terminal, /dev/null, a pipe) are not added to the set. One thread at a time. */
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
    bool incomplete; /* there was no memory for some file; iso_file_set_check then fails */
} iso_file_set;

/* Adds a file that is read. Does nothing if `set` is NULL. */
void iso_file_set_read(iso_file_set *set, const char *path);

/* Adds a file that is read, and which messages call `name` instead of `path`. */
void iso_file_set_read_as(iso_file_set *set, const char *path, const char *name);

/* Adds an output; "-" is standard output. Does nothing if `path` is NULL. */
void iso_file_set_write(iso_file_set *set, const char *path);

/* Checks the outputs. ISO_ERR_USAGE: an output is the same file as an input or another output; the message
 * names both. ISO_ERR_NOMEM. Call it when all inputs and outputs are known and nothing has been written yet.
 */
iso_status iso_file_set_check(const iso_file_set *set, iso_error *error);

void iso_file_set_free(iso_file_set *set);

#ifdef __cplusplus
}
#endif
#endif
