/* input_spool: copies an input that can be read only once (standard input, a FIFO) to a temporary file, which
 * readers can open several times and seek in.
 *
 * The file is in TMPDIR (/tmp) and has no name, so that it vanishes with the program. Readers open it by the
 * path in the spool, which leads to the open descriptor (/proc/self/fd/N). The first bytes are checked before
 * anything is copied: an input that is no volume is refused at once, and so is one whose header needs more
 * memory than is allowed. Copying ends where the voxels end according to the header; for formats whose header
 * does not say so, at the memory limit. A standard input that is a regular file is not copied.
 *
 *     iso_spool spool = {0};
 *     if (iso_spool_is_stream(path)) {
 *         ISO_TRY(iso_spool_open(path, &opts, &spool, error));
 *         path = spool.path;
 *     }
 *     ... read path, several times if need be; messages of readers begin with spool.path ...
 *     iso_spool_close(&spool);
 */
#ifndef ISO_SCENE_INPUT_SPOOL_H
#define ISO_SCENE_INPUT_SPOOL_H

#include <stdbool.h>

#include "grids/volume/volume.h"

/* Zero-initialise. */
typedef struct iso_spool {
    char *path;     /* of the copy; owned; NULL: nothing was copied */
    int descriptor; /* of the copy; open as long as path is not NULL */
    bool named;     /* the copy has the name `path` and is removed by iso_spool_close; on systems without
                       /proc */
} iso_spool;

typedef struct iso_spool_opts {
    const iso_volume_opts *volume; /* borrowed; only the raw layout and the memory limit are used */
    bool points;                   /* also accept a .ply file */
} iso_spool_opts;

/* Whether an input is a FIFO or standard input ("-"), which can be read once. */
bool iso_spool_is_stream(const char *path);

/* Copies `path`, for which iso_spool_is_stream is true; waits for its writer. ISO_ERR_IO (it cannot be read,
 * or is empty), ISO_ERR_FORMAT (no volume), ISO_ERR_LIMIT (header or input exceed the memory limit),
 * ISO_ERR_WRITE (no room in TMPDIR, which the message names; other messages name the input). iso_spool_close,
 * also after an error. */
iso_status iso_spool_open(const char *path, const iso_spool_opts *opts, iso_spool *spool, iso_error *error);

/* Removes the copy. Safe on a zeroed spool. */
void iso_spool_close(iso_spool *spool);

/* Returns the name of an input for messages: "standard input" for "-". */
const char *iso_spool_name(const char *path);

#endif
