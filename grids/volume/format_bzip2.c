/* format_bzip2: unpacks bzip2 with libbz2, also several streams one after the other, as parallel compressors
 * write. */
#include <string.h>

#include "base/memory.h"
#include "grids/volume/format.h"

#if ISO_HAVE_BZIP2
#include <bzlib.h>

enum { MAX_PART = 1 << 30 }; /* libbz2 counts in 32 bits */

struct iso_bunzip {
    const char *path;
    FILE *file;
    uint64_t done, total;
    bz_stream z;
    bool open; /* z is initialised and must be ended */
    char packed[1 << 16];
};

static bool restart(iso_bunzip *b) {
    if (b->open) BZ2_bzDecompressEnd(&b->z);
    char *next = b->z.next_in;
    unsigned left = b->z.avail_in;
    b->z = (bz_stream){.next_in = next, .avail_in = left};
    b->open = BZ2_bzDecompressInit(&b->z, 0, 0) == BZ_OK;
    return b->open;
}

iso_status iso_bunzip_create(const char *path, FILE *file, uint64_t total, iso_bunzip **bunzip,
                             iso_error *error) {
    iso_bunzip *made = iso_alloc_zero(1, sizeof *made);
    if (!made || !restart(made)) {
        iso_free(made);
        return iso_fail_memory(error, path);
    }
    made->path = path;
    made->file = file;
    made->total = total;
    *bunzip = made;
    return ISO_OK;
}

static bool refill(iso_bunzip *b) {
    if (b->z.avail_in) return true;
    b->z.next_in = b->packed;
    b->z.avail_in = (unsigned)fread(b->packed, 1, sizeof b->packed, b->file);
    return b->z.avail_in > 0;
}

iso_status iso_bunzip_read(iso_bunzip *b, void *target, size_t bytes, size_t *got, iso_error *error) {
    for (*got = 0; *got < bytes;) {
        size_t left = bytes - *got;
        unsigned part = left < MAX_PART ? (unsigned)left : MAX_PART;
        bool more = refill(b);
        if (!b->open && !more) break;
        if (!b->open && !restart(b)) return iso_fail_memory(error, b->path);
        b->z.next_out = (char *)target + *got;
        b->z.avail_out = part;
        int result = BZ2_bzDecompress(&b->z);
        unsigned now = part - b->z.avail_out;
        b->done += now;
        *got += now;
        if (result == BZ_MEM_ERROR) return iso_fail_memory(error, b->path);
        if (result != BZ_OK && result != BZ_STREAM_END)
            return iso_fail(error, ISO_ERR_IO, "%s: damaged compressed data", b->path);
        if (result == BZ_OK && !more && now == 0)
            return iso_format_truncated(b->path, b->done, b->total, error);
        if (result != BZ_STREAM_END) continue;
        BZ2_bzDecompressEnd(&b->z);
        b->open = false;
    }
    return ISO_OK;
}

void iso_bunzip_destroy(iso_bunzip *bunzip) {
    if (!bunzip) return;
    if (bunzip->open) BZ2_bzDecompressEnd(&bunzip->z);
    iso_free(bunzip);
}

#else

iso_status iso_bunzip_create(const char *path, FILE *file, uint64_t total, iso_bunzip **bunzip,
                             iso_error *error) {
    (void)file, (void)total, (void)bunzip;
    return iso_fail(error, ISO_ERR_UNSUPPORTED, "%s: built without libbz2, which unpacks bzip2", path);
}

iso_status iso_bunzip_read(iso_bunzip *bunzip, void *target, size_t bytes, size_t *got, iso_error *error) {
    (void)bunzip, (void)target, (void)bytes, (void)got;
    return iso_fail(error, ISO_ERR_UNSUPPORTED, "built without libbz2");
}

void iso_bunzip_destroy(iso_bunzip *bunzip) {
    (void)bunzip;
}

#endif
