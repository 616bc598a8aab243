/* file: inputs that are regular files, and outputs that appear whole or not at all.
 *
 * A sink writes to a new file in its target's folder, without a name where the system can do that, and gives
 * it the target's name on commit, after checking every write and fsync-free flush; aborting removes it. "-"
 * is stdout. A symbolic link is followed: it stays, and the file that it leads to is replaced. A file that
 * nobody may write to (no bit of 0222) stays as it is, also for root. A target that is there and no regular
 * file (a device, a pipe) is written to directly. One thread at a time per sink. */
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

/* Opens a file for reading; *stream is the caller's (fclose), `bytes` (may be NULL) gets its size.
 * ISO_ERR_IO: it cannot be opened, or is no regular file: a FIFO would be waited for, a device may never end.
 * An input that may be a FIFO is copied to a file first (apps/common/input_spool.h). */
iso_status iso_file_open(const char *path, FILE **stream, uint64_t *bytes, iso_error *error);

typedef struct iso_sink {
    FILE *stream; /* write to it freely; errors are found by iso_sink_commit */
    char *target,
        *temporary; /* owned; both NULL for stdout; temporary NULL for a device, "" without a name */
} iso_sink;

/* Opens a sink for `path`. ISO_ERR_WRITE names the path and the reason. On failure nothing is left behind. */
iso_status iso_sink_open(const char *path, iso_sink *sink, iso_error *error);

/* ISO_ERR_WRITE when a sink for `path` cannot be opened. Leaves nothing behind, and does not open pipes: one
 * that is opened and closed has ended for its reader. NULL and "-" are fine. */
iso_status iso_sink_check(const char *path, iso_error *error);

/* Flushes, closes and renames. On any failure the temporary file is removed and ISO_ERR_WRITE returned. */
iso_status iso_sink_commit(iso_sink *sink, iso_error *error);

/* The path that `path` leads to when its last part is a symbolic link, of any depth; else a copy. What it
 * leads to need not be there. free(). NULL without memory, or when links go around in circles. */
char *iso_file_follow(const char *path);

/* Removes an output that was written before another one failed: the file that a sink for `path` made, behind
 * symbolic links, and nothing that is no regular file. NULL and "-" are fine. */
void iso_file_remove(const char *path);

/* Whether both names lead to the same regular file that is there: writing one would destroy the other. */
bool iso_file_same(const char *a, const char *b);

/* Closes and removes the temporary file. Safe after commit and on a zeroed sink. */
void iso_sink_abort(iso_sink *sink);

#ifdef __cplusplus
}
#endif
#endif
