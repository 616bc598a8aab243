/* zip: the files in a ZIP archive in memory (PKWARE's APPNOTE.TXT), stored or deflated, also in its 64-bit
 * form. Encrypted files and other methods are refused. */
#ifndef ISO_BASE_ZIP_H
#define ISO_BASE_ZIP_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/status.h"

/* The archive, and the place in its directory; `bytes` and `count` are borrowed. */
typedef struct iso_zip {
    const unsigned char *bytes;
    uint64_t count, at, entries;
} iso_zip;

typedef struct iso_zip_entry {
    const char *name; /* not terminated */
    size_t name_length;
    const unsigned char *data; /* `packed` bytes in the archive */
    uint64_t packed, size;
    uint32_t checksum; /* CRC-32 of the file */
    bool deflated;
} iso_zip_entry;

/* Finds the directory. ISO_ERR_FORMAT: no archive; ISO_ERR_IO: it is cut off. */
iso_status iso_zip_open(const char *path, const void *bytes, size_t count, iso_zip *zip, iso_error *error);
/* The next file; *more is false behind the last one. ISO_ERR_FORMAT, ISO_ERR_IO. */
iso_status iso_zip_next(const char *path, iso_zip *zip, iso_zip_entry *entry, bool *more, iso_error *error);
/* Unpacks a file to `bytes`, which has room for entry->size + 1 bytes. ISO_ERR_IO: damaged, by its checksum
 * too; ISO_ERR_LIMIT: more than 4 GB; ISO_ERR_NOMEM. */
iso_status iso_zip_unpack(const char *path, const iso_zip_entry *entry, void *bytes, iso_error *error);
/* Whether `bytes`, all of a file, have its checksum. ISO_ERR_IO: they do not. */
iso_status iso_zip_check(const char *path, const iso_zip_entry *entry, const void *bytes, iso_error *error);

#endif
