/* remote: bytes of files on web servers, for readers that need parts of a large file, or a few of many files.
 * The functions are a module's (grids/volume/module.h), libcurl's; volume.c gives them to the reader of a
 * path that is a URL. Nothing is asked of a server but what lies below the URL that the user named, by GET,
 * and what the server itself says has moved. */
#ifndef ISO_GRIDS_VOLUME_REMOTE_REMOTE_H
#define ISO_GRIDS_VOLUME_REMOTE_REMOTE_H

#include <stdio.h>

#include "base/file.h"
#include "base/memory.h"
#include "base/status.h"

/* What is wanted of a file. */
typedef struct iso_remote_part {
    enum { ISO_REMOTE_METADATA, ISO_REMOTE_WHOLE, ISO_REMOTE_BYTES, ISO_REMOTE_LAST } what;
    uint64_t offset; /* of ISO_REMOTE_BYTES */
    uint64_t size;   /* of these, and of ISO_REMOTE_LAST; else the most bytes that the file may have */
} iso_remote_part;

typedef struct iso_remote {
    /* Reads a file, or a part of it, into `bytes`, the caller's; *count: how many there are. *absent, without
     * an error: the server has no such file; of metadata also: it may not be read. What is no metadata is
     * kept in a cache, $XDG_CACHE_HOME/isopoint/remote (~/.cache), of at most ISO_REMOTE_CACHE megabytes
     * (1000; 0: none), and is taken from there if the server says that it has not changed; of metadata a
     * process takes what the server has said within some seconds. Waits for a server that is busy, and asks
     * again where a connection breaks, four times. For several threads at once. ISO_ERR_IO: no server, its
     * refusal, a short reply; ISO_ERR_LIMIT: more bytes than part->size; ISO_ERR_NOMEM. */
    iso_status (*read)(const char *url, const iso_remote_part *part, iso_buffer *bytes, size_t *count,
                       bool *absent, iso_error *error);
    /* Copies a whole file of at most `most` bytes into the cache, if it is not there or has changed, and sets
     * `path` to the copy, whose name ends as the URL does. Within some seconds a process does not ask again.
     * A file that is larger than the cache is kept until something else is. For several threads at once.
     * ISO_ERR_IO: no server, its refusal, it broke off, or there is no cache; ISO_ERR_LIMIT; ISO_ERR_WRITE:
     * no room. */
    iso_status (*fetch)(const char *url, uint64_t most, char path[ISO_FILE_PATH], iso_error *error);
} iso_remote;

/* The cache (remote/cache.c). An entry is a file with the server's mark of what it has sent, its ETag. */
typedef struct iso_remote_entry {
    char mark[256]; /* empty: there is no entry */
    iso_buffer bytes;
    size_t count;
} iso_remote_entry;

/* Finds what is kept of a part of a file; the buffer is the caller's. */
void iso_remote_cache_find(const char *url, const iso_remote_part *part, iso_remote_entry *entry);
/* Keeps it, if it can, and removes what was used longest ago beyond the cache's size. */
void iso_remote_cache_keep(const char *url, const iso_remote_part *part, const iso_remote_entry *entry);

/* The copy of a whole file in the cache. Beside it lies a file that states its URL, mark and size. */
typedef struct iso_remote_copy {
    char path[ISO_FILE_PATH];
    bool is_there;
    char mark[256]; /* of the copy; empty: only the server can say whether it is the same file */
} iso_remote_copy;

/* Finds where the copy of a file is, or is to be written, and marks it as used. False: there is no cache. */
bool iso_remote_copy_find(const char *url, iso_remote_copy *copy);
/* Says that the copy is there, whole and of this mark, and bounds the cache. */
void iso_remote_copy_keep(const char *url, const iso_remote_copy *copy, const char *mark);

#endif
