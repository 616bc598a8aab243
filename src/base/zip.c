/* zip: directory and unpacking. */
#include "base/zip.h"

#include <limits.h>
#include <string.h>
#include <zlib.h>

static const uint64_t unknown = UINT32_MAX; /* of a number that stands in its 64-bit form */

static uint64_t number_at(const unsigned char *at, int bytes) {
    uint64_t number = 0;
    while (bytes--) number = number << 8 | at[bytes];
    return number;
}

static iso_status damaged(const char *path, const char *what, iso_error *error) {
    return iso_fail(error, ISO_ERR_IO, "%s: a damaged ZIP archive: %s", path, what);
}

/* Whether `length` bytes are at a place, beginning with a signature. */
static bool is_at(const iso_zip *zip, uint64_t at, uint64_t length, const char *signature) {
    return at <= zip->count && length <= zip->count - at && memcmp(zip->bytes + at, signature, 4) == 0;
}

iso_status iso_zip_open(const char *path, const void *bytes, size_t count, iso_zip *zip, iso_error *error) {
    enum { END = 22, LONGEST_COMMENT = 65535, LOCATOR = 20, END_64 = 56 };
    *zip = (iso_zip){.bytes = bytes, .count = count};
    if (!is_at(zip, 0, 4, "PK\3\4") && !is_at(zip, 0, 4, "PK\5\6"))
        return iso_fail(error, ISO_ERR_FORMAT, "%s: not a ZIP archive", path);
    uint64_t at = count < END ? 0 : count - END;
    const uint64_t first = at > LONGEST_COMMENT ? at - LONGEST_COMMENT : 0;
    while (at > first && !is_at(zip, at, END, "PK\5\6")) at--;
    if (!is_at(zip, at, END, "PK\5\6"))
        return iso_fail(error, ISO_ERR_IO, "%s: truncated: a ZIP archive without a directory", path);
    zip->entries = number_at(zip->bytes + at + 10, 2);
    zip->at = number_at(zip->bytes + at + 16, 4);
    if (at < LOCATOR || !is_at(zip, at - LOCATOR, LOCATOR, "PK\6\7")) return ISO_OK;
    const uint64_t end = number_at(zip->bytes + at - LOCATOR + 8, 8);
    if (!is_at(zip, end, END_64, "PK\6\6")) return damaged(path, "its 64-bit directory", error);
    zip->entries = number_at(zip->bytes + end + 32, 8);
    zip->at = number_at(zip->bytes + end + 48, 8);
    return ISO_OK;
}

/* Takes the numbers that are missing in an entry from its extra field, in their order. */
static void take_long_numbers(const unsigned char *extra, uint64_t length, uint64_t *numbers[3]) {
    for (uint64_t at = 0; at + 4 <= length;) {
        const uint64_t size = number_at(extra + at + 2, 2), end = at + 4 + size;
        if (end > length) return;
        if (number_at(extra + at, 2) != 1) {
            at = end;
            continue;
        }
        at += 4;
        for (int i = 0; i < 3; i++)
            if (*numbers[i] == unknown && at + 8 <= end) {
                *numbers[i] = number_at(extra + at, 8);
                at += 8;
            }
        return;
    }
}

iso_status iso_zip_next(const char *path, iso_zip *zip, iso_zip_entry *entry, bool *more, iso_error *error) {
    enum { HEADER = 46, LOCAL = 30 };
    *more = zip->entries > 0;
    if (!*more) return ISO_OK;
    if (!is_at(zip, zip->at, HEADER, "PK\1\2")) return damaged(path, "its directory", error);
    const unsigned char *head = zip->bytes + zip->at;
    const uint64_t name = number_at(head + 28, 2), extra = number_at(head + 30, 2),
                   method = number_at(head + 10, 2), whole = HEADER + name + extra + number_at(head + 32, 2);
    if (whole > zip->count - zip->at) return damaged(path, "its directory", error);
    uint64_t packed = number_at(head + 20, 4), size = number_at(head + 24, 4),
             local = number_at(head + 42, 4);
    take_long_numbers(head + HEADER + name, extra, (uint64_t *[]){&size, &packed, &local});
    if (!is_at(zip, local, LOCAL, "PK\3\4")) return damaged(path, "a file is not where it says", error);
    const unsigned char *at = zip->bytes + local;
    const uint64_t skipped = LOCAL + number_at(at + 26, 2) + number_at(at + 28, 2), left = zip->count - local;
    if (skipped > left || packed > left - skipped) return damaged(path, "a file is cut off", error);
    if ((method != 0 && method != 8) || number_at(head + 8, 2) & 1)
        return iso_fail(error, ISO_ERR_UNSUPPORTED,
                        "%s: a file in it is encrypted, or packed by a method that "
                        "is not read (zip -0 and zip -6 make others)",
                        path);
    if (method == 0 ? packed != size : size / 1032 > packed + 1)
        return damaged(path, "the size of a file is not possible", error);
    *entry = (iso_zip_entry){(const char *)head + HEADER,       (size_t)name, at + skipped, packed, size,
                             (uint32_t)number_at(head + 16, 4), method == 8};
    zip->at += whole;
    zip->entries--;
    return ISO_OK;
}

iso_status iso_zip_check(const char *path, const iso_zip_entry *entry, const void *bytes, iso_error *error) {
    return crc32_z(0, bytes, (z_size_t)entry->size) == entry->checksum
               ? ISO_OK
               : damaged(path, "the checksum of a file is wrong", error);
}

iso_status iso_zip_unpack(const char *path, const iso_zip_entry *entry, void *bytes, iso_error *error) {
    if (!entry->deflated) {
        memcpy(bytes, entry->data, (size_t)entry->size);
        return iso_zip_check(path, entry, bytes, error);
    }
    if (entry->size >= UINT_MAX || entry->packed > UINT_MAX)
        return iso_fail(error, ISO_ERR_LIMIT, "%s: a file in it is larger than 4 GB: store it (zip -0)",
                        path);
    z_stream z = {.next_in = (z_const Bytef *)(uintptr_t)entry->data,
                  .avail_in = (uInt)entry->packed,
                  .next_out = bytes,
                  .avail_out = (uInt)entry->size + 1};
    if (inflateInit2(&z, -15) != Z_OK) return iso_fail_memory(error, path);
    const int result = inflate(&z, Z_FINISH);
    const uint64_t got = z.total_out;
    inflateEnd(&z);
    return result == Z_STREAM_END && got == entry->size ? iso_zip_check(path, entry, bytes, error)
                                                        : damaged(path, "a compressed file", error);
}
