/* spool: an input that can be read only once (standard input, a FIFO) as a file that readers can open as
 * often as they like.
 *
 * The copy lies in TMPDIR (/tmp) and has no name: it is gone when the program ends, however it ends. Readers
 * open it by the path that the spool gives, which leads to the open descriptor (/proc/self/fd/N). What stands
 * first decides whether anything is copied: an input that is no volume is refused at once, and so is one
 * whose header asks for more memory than is allowed. Copying stops where the header says that the voxels end,
 * and for formats that do not say so at the memory limit. A standard input that is a regular file is not
 * copied.
 *
 * For an input path that may be a FIFO:
 *
 *     iso_spool spool = {0};
 *     if (iso_spool_needed(path)) {
 *         ISO_TRY(iso_spool_open(path, &opts, &spool, error));
 *         path = spool.path;
 *     }
 *     ... read path, several times if need be; messages of readers begin with spool.path ...
 *     iso_spool_close(&spool);
 */
#ifndef ISO_APPS_COMMON_SPOOL_H
#define ISO_APPS_COMMON_SPOOL_H

#include <stdbool.h>

#include "grids/volume/volume.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Zero-initialise. */
typedef struct iso_spool {
    char *path;     /* what to read instead of the input; owned; NULL: nothing was spooled */
    int descriptor; /* of the copy; open as long as path is not NULL */
    bool named;     /* the copy has a name, which is `path`: without /proc it cannot do without */
} iso_spool;

typedef struct iso_spool_opts {
    const iso_volume_opts *volume; /* how it will be read: the raw layout and the memory limit; borrowed */
    bool points;                   /* a .ply will be read as well */
} iso_spool_opts;

/* Whether the input has to be spooled: "-", which is standard input, or the name of a FIFO. */
bool iso_spool_needed(const char *path);

/* Reads `path`, for which iso_spool_needed is true, and waits for its writer. ISO_ERR_IO (it cannot be read,
 * or is empty), ISO_ERR_FORMAT (not a volume), ISO_ERR_LIMIT (the header or the input asks for more than the
 * memory limit), ISO_ERR_WRITE (no room in TMPDIR, which is named); the others name the input.
 * iso_spool_close, also after a failure. */
iso_status iso_spool_open(const char *path, const iso_spool_opts *opts, iso_spool *spool, iso_error *error);

/* Removes the copy. Safe on a zeroed spool. */
void iso_spool_close(iso_spool *spool);

/* What messages call the input: "standard input" for "-". */
const char *iso_spool_name(const char *path);

#ifdef __cplusplus
}
#endif
#endif
