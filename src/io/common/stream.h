/* stream: a file that is read from beginning to end through a buffer, with the number of bytes that are left,
 * so that counts in a header can be compared with the file's size before memory is allocated. Internal to
 * src/io. One thread at a time. */
#ifndef ISO_IO_COMMON_STREAM_H
#define ISO_IO_COMMON_STREAM_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include "base/status.h"

enum { ISO_STREAM_BUFFER = 1 << 16 };

/* More than 64 KiB: allocate it on the heap. */
typedef struct iso_stream {
    const char *path;   /* borrowed; messages begin with it */
    FILE *file;         /* NULL: closed */
    uint64_t remaining; /* bytes that are not read yet */
    size_t place, end;  /* the unread part of the buffer */
    unsigned char buffer[ISO_STREAM_BUFFER];
} iso_stream;

/* Opens a regular file; ISO_ERR_IO. Call iso_stream_close also after a failure. `path` is borrowed until
 * then. */
iso_status iso_stream_open(const char *path, iso_stream *stream, iso_error *error);
void iso_stream_close(iso_stream *stream);

/* Moves the unread bytes to the beginning of the buffer and reads more behind them. Returns whether the
 * buffer then has `bytes` bytes. */
bool iso_stream_refill(iso_stream *stream, size_t bytes);

/* Makes at least `bytes` bytes, at most ISO_STREAM_BUFFER, available at buffer + place; false at the end of
 * the file. */
static inline bool iso_stream_fill(iso_stream *stream, size_t bytes) {
    return stream->end - stream->place >= bytes || iso_stream_refill(stream, bytes);
}

/* Advances by `bytes` bytes, which must be available. */
static inline void iso_stream_advance(iso_stream *stream, size_t bytes) {
    stream->place += bytes;
    stream->remaining -= bytes < stream->remaining ? bytes : stream->remaining;
}

/* Returns the next byte; -1 at the end. */
static inline int iso_stream_byte(iso_stream *stream) {
    if (!iso_stream_fill(stream, 1)) return -1;
    int byte = stream->buffer[stream->place];
    iso_stream_advance(stream, 1);
    return byte;
}

/* Goes back by the byte that iso_stream_byte has just returned. */
static inline void iso_stream_step_back(iso_stream *stream) {
    stream->place--;
    stream->remaining++;
}

/* Copies the next bytes; ISO_ERR_IO when the file ends before. */
iso_status iso_stream_read(iso_stream *stream, void *to, size_t bytes, iso_error *error);

/* Skips bytes; ISO_ERR_IO when the file ends before. */
iso_status iso_stream_skip(iso_stream *stream, uint64_t bytes, iso_error *error);

/* Fails with ISO_ERR_IO for a file that ended too early or could not be read. */
iso_status iso_stream_fail(const iso_stream *stream, iso_error *error);

#endif
