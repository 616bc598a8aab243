/* file: outputs that appear whole or not at all.
 *
 * A sink writes to a new file in its target's folder, without a name where the system can do that, and gives
 * it the target's name on commit, after checking every write and fsync-free flush; aborting removes it. "-"
 * is stdout. A target that is there and no regular file (a device, a pipe) is written to directly. One thread
 * at a time per sink. */
#ifndef ISO_BASE_FILE_H
#define ISO_BASE_FILE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

#include "base/status.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct iso_sink {
    FILE *stream; /* write to it freely; errors are found by iso_sink_commit */
    char *target,
        *temporary; /* owned; both NULL for stdout; temporary NULL for a device, "" without a name */
} iso_sink;

/* Opens a sink for `path`. ISO_ERR_WRITE names the path and the reason. On failure nothing is left behind. */
iso_status iso_sink_open(const char *path, iso_sink *sink, iso_error *error);

/* Flushes, closes and renames. On any failure the temporary file is removed and ISO_ERR_WRITE returned. */
iso_status iso_sink_commit(iso_sink *sink, iso_error *error);

/* Whether both names lead to the same regular file that is there: writing one would destroy the other. */
bool iso_file_same(const char *a, const char *b);

/* Closes and removes the temporary file. Safe after commit and on a zeroed sink. */
void iso_sink_abort(iso_sink *sink);

#ifdef __cplusplus
}
#endif
#endif
