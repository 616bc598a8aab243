/* file: opens regular files for reading, and writes output files that appear whole or not at all.
 *
 * A sink writes to a new file in its target's folder (without a name, where the file system supports that).
 * Commit checks that all writes succeeded and renames the file to the target; it does not fsync. Abort
 * removes the file. A program that is killed while it commits, or where the file system has no files without
 * names, can leave TARGET.isonew1 behind, which the next sink for this target removes. "-" is standard
 * output. A symbolic link is followed: the file that it leads to is replaced, and the link stays. A file that
 * nobody may write to (no bit of 0222) is not replaced, also not by root. An existing target that is not a
 * regular file (a device, a pipe) is written to directly. One thread at a time per sink. */
#ifndef ISO_BASE_FILE_H
#define ISO_BASE_FILE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include "base/c_linkage.h"
#include "base/status.h"

ISO_C_BEGIN

/* Whether a path is a URL, which is read from a server. */
static inline bool iso_is_url(const char *path) {
    return strncmp(path, "https://", 8) == 0 || strncmp(path, "http://", 7) == 0;
}

enum { ISO_FILE_PATH = 4096 };
/* What makes a local copy of the file that a URL names, and sets `path` to it. */
typedef iso_status iso_file_fetcher(const char *url, char path[ISO_FILE_PATH], iso_error *error);
/* From now on URLs can be opened as files; before, or with NULL, they are refused. Called before there are
 * threads, or always with the same function. */
void iso_file_set_fetcher(iso_file_fetcher *fetcher);

/* Opens a regular file, or one that a URL names, for reading; *stream is the caller's (fclose), *bytes (may
 * be NULL) its size. ISO_ERR_IO: it cannot be opened, or is not a regular file. A FIFO is left unopened,
 * because its writer would go on, and fail when it is closed; a device may never end. An input that may be a
 * FIFO is copied to a file first (scene/input_spool.h). */
iso_status iso_file_open(const char *path, FILE **stream, uint64_t *bytes, iso_error *error);

/* The same, for what reads from a descriptor, which is the caller's (close). */
iso_status iso_file_descriptor(const char *path, int *descriptor, uint64_t *bytes, iso_error *error);

/* Reads the first bytes of a regular file, at most `bytes`, to find out what it is; returns how many there
 * are, 0 if it cannot be read. It needs no memory, so that no file is taken for another kind where there is
 * none. */
size_t iso_file_head(const char *path, void *head, size_t bytes);

/* ISO_ERR_FORMAT when the first bytes of a file that should be text are the byte order mark of UTF-16 or
 * UTF-32 (base/text.h): it says so. */
iso_status iso_file_check_text(const char *path, const void *head, size_t bytes, iso_error *error);

typedef struct iso_sink {
    FILE *stream;    /* write to it freely; errors are found by iso_sink_commit */
    char *target;    /* owned; NULL: standard output */
    char *temporary; /* owned; the new file's path, "" for a file without a name; NULL: none (stdout, a
                        device) */
} iso_sink;

/* Opens a sink for `path`; finish with iso_sink_commit or iso_sink_abort. ISO_ERR_WRITE names the path and
 * the reason; no file is left behind then. */
iso_status iso_sink_open(const char *path, iso_sink *sink, iso_error *error);

/* Opens a sink for a file that the program writes without being asked to, such as an index beside a volume.
 * No symbolic link is followed, and only a regular file that begins with the `bytes` bytes of `mark`, at most
 * 64, is replaced: nothing else that has this name is lost. ISO_ERR_WRITE. */
iso_status iso_sink_open_own(const char *path, const void *mark, size_t bytes, iso_sink *sink,
                             iso_error *error);

/* Removes what programs that were killed while they wrote `path` left beside it. */
void iso_file_remove_unfinished(const char *path);

/* Checks early whether a sink for `path` can be opened; ISO_ERR_WRITE if not. Leaves no file behind. Pipes
 * are not opened, because closing one again would end it for its reader. NULL and "-" always pass. */
iso_status iso_sink_check(const char *path, iso_error *error);

/* Flushes and closes the sink's file, and gives the file its target's name. On any failure the temporary file
 * is removed and ISO_ERR_WRITE returned. */
iso_status iso_sink_commit(iso_sink *sink, iso_error *error);

/* The path that `path` leads to if it is a symbolic link (links to links are followed); else a copy of it.
 * The target need not exist. Release with free(). NULL when there is no memory, or when links form a circle.
 */
char *iso_file_follow(const char *path);

/* Removes the file that a sink for `path` has written, for use when a later output fails. Follows symbolic
 * links; only regular files are removed. NULL and "-" are ignored. */
void iso_file_remove(const char *path);

/* Closes a stream of open_memstream, whose `bytes` are the caller's. False: there was no memory; *bytes is
 * NULL then. What fwrite and the like return must have been checked if more than a few kilobytes were
 * written. */
bool iso_memory_stream_close(FILE *stream, char **bytes);

/* Whether both names lead to the same existing regular file, so that writing one would destroy the other. */
bool iso_file_same(const char *a, const char *b);

/* Closes a sink and removes its temporary file. May be called after iso_sink_commit and for a sink of zeros,
 * and does nothing then. */
void iso_sink_abort(iso_sink *sink);

ISO_C_END
#endif
