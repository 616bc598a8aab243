/* file: inputs that are regular files, and outputs that appear whole or not at all.
 *
 * A sink writes to a new file in its target's folder, which has no name there if the file system allows that.
 * Committing checks that all writes succeeded and gives the file the target's name, without fsync; aborting
 * removes the file. "-" is stdout. If the target is a symbolic link, the link stays and the file that it
 * leads to is replaced. A file without write permission for anybody (no bit of 0222) is not replaced, not
 * even by root. A target that exists and is not a regular file (a device, a pipe) is written to directly. One
 * thread at a time for each sink. */
#ifndef ISO_BASE_FILE_H
#define ISO_BASE_FILE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include "base/status.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Opens a regular file for reading. The caller closes *stream (fclose). *bytes (`bytes` may be NULL) is set
 * to the size of the file. ISO_ERR_IO: the file cannot be opened, or is not regular: opening a FIFO would
 * wait, and a device may never end. An input that may be a FIFO is copied to a file first
 * (apps/common/input_spool.h). */
iso_status iso_file_open(const char *path, FILE **stream, uint64_t *bytes, iso_error *error);

typedef struct iso_sink {
    FILE *stream;             /* to write to; iso_sink_commit finds errors */
    char *target, *temporary; /* owned; both NULL for stdout; `temporary` NULL for a device, "" for a file
                                 without a name */
} iso_sink;

/* Opens a sink for `path`. ISO_ERR_WRITE: the message has the path and the reason; nothing is left behind. */
iso_status iso_sink_open(const char *path, iso_sink *sink, iso_error *error);

/* Checks that a sink for `path` can be opened, else ISO_ERR_WRITE. Leaves nothing behind. Pipes are not
 * opened, because closing one again would end it for its reader. NULL and "-" are allowed. */
iso_status iso_sink_check(const char *path, iso_error *error);

/* Flushes and closes the file and gives it the target's name. ISO_ERR_WRITE: a write, or one of these steps,
 * has failed; the temporary file is removed. */
iso_status iso_sink_commit(iso_sink *sink, iso_error *error);

/* Returns the path that `path` leads to if its last part is a symbolic link (or a chain of them), else a copy
 * of `path`; to be freed with free(). The file at the end need not exist. NULL: no memory, or the links form
 * a circle. */
char *iso_file_follow(const char *path);

/* Removes an output that was written before another one failed: the file that a sink for `path` made.
 * Symbolic links are followed; files that are not regular stay. NULL and "-" are allowed. */
void iso_file_remove(const char *path);

/* Whether two paths lead to the same existing regular file, so that writing one would destroy the other. */
bool iso_file_same(const char *a, const char *b);

/* Closes and removes the temporary file. Does nothing after commit, and for a zero-initialised sink. */
void iso_sink_abort(iso_sink *sink);

#ifdef __cplusplus
}
#endif
#endif
