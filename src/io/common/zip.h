/* zip: the files in a ZIP archive in memory (PKWARE's APPNOTE.TXT), stored or deflated, also in its 64-bit
 * form. Encrypted files and other methods are refused. Internal to src/io. */
#ifndef ISO_IO_COMMON_ZIP_H
#define ISO_IO_COMMON_ZIP_H

#include "io/common/reading.h"

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
    bool deflated;
} iso_zip_entry;

/* Finds the directory. ISO_ERR_FORMAT: no archive; ISO_ERR_IO: it is cut off. */
iso_status iso_zip_open(const iso_reading *reading, const void *bytes, size_t count, iso_zip *zip,
                        iso_error *error);
/* The next file; *more is false behind the last one. ISO_ERR_FORMAT, ISO_ERR_IO. */
iso_status iso_zip_next(const iso_reading *reading, iso_zip *zip, iso_zip_entry *entry, bool *more,
                        iso_error *error);
/* The bytes of a file: in the archive, or unpacked into `buffer`. ISO_ERR_IO: damaged. ISO_ERR_LIMIT,
 * ISO_ERR_NOMEM. */
iso_status iso_zip_unpack(iso_reading *reading, const iso_zip_entry *entry, iso_buffer *buffer,
                          const unsigned char **bytes, iso_error *error);

#endif
