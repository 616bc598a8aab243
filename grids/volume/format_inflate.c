/* format_inflate: unpacks zlib and gzip streams of any size with zlib. */
#include <errno.h>
#include <string.h>
#include <zlib.h>

#include "base/file.h"
#include "base/memory.h"
#include "grids/volume/format.h"

/* zlib's counters have 32 bits. */
enum { MAX_PART = 1 << 30 };

struct iso_inflater {
    const char *path;
    FILE *file;
    uint64_t done, total;
    bool bare; /* a stream of deflate without a header, of which none follows */
    z_stream z;
    unsigned char packed[1 << 16];
};

static iso_status create(const char *path, FILE *file, uint64_t total, bool bare, iso_inflater **inflater,
                         iso_error *error) {
    iso_inflater *made = iso_alloc_zero(1, sizeof *made);
    if (!made || inflateInit2(&made->z, bare ? -15 : 15 + 32) != Z_OK) { /* + 32: detects zlib or gzip */
        iso_free(made);
        return iso_fail_memory(error, path);
    }
    made->path = path;
    made->file = file;
    made->total = total;
    made->bare = bare;
    *inflater = made;
    return ISO_OK;
}

iso_status iso_inflater_create(const char *path, FILE *file, uint64_t total, iso_inflater **inflater,
                               iso_error *error) {
    return create(path, file, total, false, inflater, error);
}

iso_status iso_inflater_create_bare(const char *path, FILE *file, uint64_t total, iso_inflater **inflater,
                                    iso_error *error) {
    return create(path, file, total, true, inflater, error);
}

static void refill(iso_inflater *f) {
    if (f->z.avail_in) return;
    f->z.next_in = f->packed;
    f->z.avail_in = (uInt)fread(f->packed, 1, sizeof f->packed, f->file);
}

/* Calls inflate once, after reading more of the file if needed. A gzip file may have several members, which
 * follow each other. */
static int inflate_some(iso_inflater *f) {
    refill(f);
    int result = inflate(&f->z, Z_NO_FLUSH);
    if (result != Z_STREAM_END || f->z.avail_out == 0 || f->bare) return result;
    refill(f);
    return f->z.avail_in ? inflateReset(&f->z) : result;
}

static iso_status damaged(const iso_inflater *f, iso_error *error) {
    return iso_fail(error, ISO_ERR_IO, "%s: damaged compressed data", f->path);
}

iso_status iso_inflater_read(iso_inflater *f, void *target, size_t bytes, size_t *got, iso_error *error) {
    for (*got = 0; *got < bytes;) {
        size_t left = bytes - *got;
        uInt part = left < MAX_PART ? (uInt)left : MAX_PART;
        f->z.next_out = (unsigned char *)target + *got;
        f->z.avail_out = part;
        int result = inflate_some(f);
        f->done += part - f->z.avail_out;
        *got += part - f->z.avail_out;
        if (result != Z_OK && result != Z_STREAM_END && result != Z_BUF_ERROR) return damaged(f, error);
        if (*got < bytes && result == Z_BUF_ERROR)
            return iso_format_truncated(f->path, f->done, f->total, error);
        if (result == Z_STREAM_END) break;
    }
    return ISO_OK;
}

iso_status iso_inflater_fill(iso_inflater *f, void *target, size_t bytes, iso_error *error) {
    size_t got = 0;
    ISO_TRY(iso_inflater_read(f, target, bytes, &got, error));
    return got == bytes ? ISO_OK : iso_format_truncated(f->path, f->done, f->total, error);
}

iso_status iso_inflater_finish(iso_inflater *f, bool *more, iso_error *error) {
    unsigned char byte;
    f->z.next_out = &byte;
    f->z.avail_out = 1;
    int result = Z_OK;
    while (result == Z_OK && f->z.avail_out) result = inflate_some(f);
    if (more) *more = f->z.avail_out == 0;
    return result == Z_OK || result == Z_STREAM_END || result == Z_BUF_ERROR ? ISO_OK : damaged(f, error);
}

void iso_inflater_destroy(iso_inflater *inflater) {
    if (!inflater) return;
    inflateEnd(&inflater->z);
    iso_free(inflater);
}

size_t iso_gzip_head(const void *packed, size_t count, void *bytes, size_t room) {
    static const unsigned char magic[] = {0x1f, 0x8b};
    if (count < sizeof magic || memcmp(packed, magic, sizeof magic) != 0) return 0;
    z_stream z = {.next_in = (z_const Bytef *)packed,
                  .avail_in = (uInt)count,
                  .next_out = bytes,
                  .avail_out = (uInt)room};
    if (inflateInit2(&z, 15 + 16) != Z_OK) return 0;
    inflate(&z, Z_SYNC_FLUSH);
    inflateEnd(&z);
    return room - z.avail_out;
}

iso_status iso_format_read_head(const char *path, void *bytes, size_t *count, bool *gzip, iso_error *error) {
    FILE *file;
    ISO_TRY(iso_file_open(path, &file, NULL, error));
    unsigned char magic[2] = {0};
    *gzip = fread(magic, 1, 2, file) == 2 && magic[0] == 0x1f && magic[1] == 0x8b;
    rewind(file);
    iso_inflater *inflater = NULL;
    iso_status status = ISO_OK;
    const size_t wanted = *count;
    if (*gzip) {
        status = iso_inflater_create(path, file, wanted, &inflater, error);
        if (status == ISO_OK) status = iso_inflater_read(inflater, bytes, wanted, count, error);
    } else {
        *count = fread(bytes, 1, wanted, file);
        if (ferror(file)) status = iso_fail(error, ISO_ERR_IO, "%s: cannot read: %s", path, strerror(errno));
    }
    iso_inflater_destroy(inflater);
    fclose(file);
    return status;
}
