/* stream: buffered bytes of a file. */
#include "io/common/stream.h"

#include <errno.h>
#include <string.h>

#include "base/file.h"

iso_status iso_stream_open(const char *path, iso_stream *stream, iso_error *error) {
    stream->path = path;
    stream->file = NULL;
    stream->place = stream->end = 0;
    ISO_TRY(iso_file_open(path, &stream->file, &stream->remaining, error));
    setvbuf(stream->file, NULL, _IONBF, 0); /* buffered here */
    return ISO_OK;
}

void iso_stream_close(iso_stream *stream) {
    if (stream->file) fclose(stream->file);
    stream->file = NULL;
}

bool iso_stream_refill(iso_stream *stream, size_t bytes) {
    size_t have = stream->end - stream->place;
    memmove(stream->buffer, stream->buffer + stream->place, have);
    stream->place = 0;
    stream->end = have + fread(stream->buffer + have, 1, sizeof stream->buffer - have, stream->file);
    return stream->end >= bytes;
}

iso_status iso_stream_read(iso_stream *stream, void *to, size_t bytes, iso_error *error) {
    for (unsigned char *at = to; bytes > 0;) {
        if (!iso_stream_fill(stream, 1)) return iso_stream_fail(stream, error);
        const size_t have = stream->end - stream->place, step = bytes < have ? bytes : have;
        memcpy(at, stream->buffer + stream->place, step);
        iso_stream_advance(stream, step);
        at += step;
        bytes -= step;
    }
    return ISO_OK;
}

iso_status iso_stream_skip(iso_stream *stream, uint64_t bytes, iso_error *error) {
    while (bytes > 0) {
        if (!iso_stream_fill(stream, 1)) return iso_stream_fail(stream, error);
        size_t have = stream->end - stream->place, step = bytes < have ? (size_t)bytes : have;
        iso_stream_advance(stream, step);
        bytes -= step;
    }
    return ISO_OK;
}

iso_status iso_stream_fail(const iso_stream *stream, iso_error *error) {
    if (ferror(stream->file))
        return iso_fail(error, ISO_ERR_IO, "%s: cannot read: %s", stream->path, strerror(errno));
    return iso_fail(error, ISO_ERR_IO, "%s: truncated", stream->path);
}
