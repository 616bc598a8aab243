/* version_store: room for the packed versions of cells. Beyond a limit blocks lie in files without names,
 * whose pages the system writes out when it needs the memory. Internal to sculpt; for one thread. */
#ifndef ISO_SCULPT_SESSION_VERSION_STORE_H
#define ISO_SCULPT_SESSION_VERSION_STORE_H

#include <stddef.h>
#include <stdint.h>

#include "base/memory.h"

enum { ISO_VERSION_CLASSES = 128 };

/* Zero-initialise but for the limit. iso_version_store_free when done, after all blocks were given back, or
 * instead of that for those in files. */
typedef struct iso_version_store {
    size_t limit;               /* bytes in memory */
    size_t in_memory, in_files; /* bytes of blocks */
    iso_buffer chunks;          /* uint8_t *: mapped files */
    size_t chunk_count, used;   /* used: bytes of the last one */
    void *free
        [ISO_VERSION_CLASSES]; /* blocks in files that were given back, by size; each points to the next */
    int no_files;              /* files cannot be made: all lie in memory */
} iso_version_store;

/* Returns room for `size` bytes, uninitialised; NULL: no memory. */
uint8_t *iso_version_store_take(iso_version_store *store, size_t size);
/* Gives a block of this size back; NULL is ignored. */
void iso_version_store_give(iso_version_store *store, uint8_t *block, size_t size);
void iso_version_store_free(iso_version_store *store);

#endif
