/* page_files: what pages are made of (apps/page), embedded. opaque.wasm.gz and layers.wasm.gz are missing
 * where the build found no compiler for them. */
#ifndef ISO_APPS_COMMON_PAGE_FILES_H
#define ISO_APPS_COMMON_PAGE_FILES_H

#include <stddef.h>

typedef struct iso_page_file {
    const char *name;
    const unsigned char *bytes;
    size_t size;
} iso_page_file;

extern const iso_page_file iso_page_files[]; /* ends with a NULL name */

#endif
