/* remote: bytes of files on web servers, for readers that need parts of a large file, or a few of many files.
 * The functions are a module's (grids/volume/module.h), libcurl's; volume.c gives them to the reader of a
 * path that is a URL. Nothing is asked of a server but what lies below the URL that the user named, by GET,
 * and what the server itself says has moved. */
#ifndef ISO_GRIDS_VOLUME_REMOTE_REMOTE_H
#define ISO_GRIDS_VOLUME_REMOTE_REMOTE_H

#include <stdio.h>
#include <string.h>

#include "base/memory.h"
#include "base/status.h"

/* Whether a path is a URL that is read from a server. */
static inline bool iso_is_url(const char *path) {
    return strncmp(path, "https://", 8) == 0 || strncmp(path, "http://", 7) == 0;
}

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
     * (1000; 0: none), and is taken from there if the server says that it has not changed. Waits for a
     * server that is busy, and asks again where a connection breaks, four times. For several threads at
     * once. ISO_ERR_IO: no server, its refusal, a short reply; ISO_ERR_LIMIT: more bytes than part->size;
     * ISO_ERR_NOMEM. */
    iso_status (*read)(const char *url, const iso_remote_part *part, iso_buffer *bytes, size_t *count,
                       bool *absent, iso_error *error);
    /* Writes a whole file to `stream` as it comes. Asks again as long as nothing has come. ISO_ERR_IO: no
     * server, its refusal, or it broke off; ISO_ERR_WRITE: the stream failed. */
    iso_status (*copy)(const char *url, FILE *stream, iso_error *error);
} iso_remote;

/* The cache (remote/cache.c). An entry is a file with the server's mark of what it has sent, its ETag. */
typedef struct iso_remote_entry {
    char mark[256]; /* empty: there is no entry */
    iso_buffer bytes;
    size_t count;
} iso_remote_entry;

/* Finds what is kept of a part of a file; the buffer is the caller's. */
void iso_remote_cache_find(const char *url, const iso_remote_part *part, iso_remote_entry *entry);
/* Keeps it, if it can, and removes what was kept longest ago beyond the cache's size. */
void iso_remote_cache_keep(const char *url, const iso_remote_part *part, const iso_remote_entry *entry);

#endif
