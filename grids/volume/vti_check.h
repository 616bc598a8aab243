/* vti_check: checks the numbers in a .vti file before VTK allocates memory by them.
 *
 * VTK's reader allocates as many block sizes, and as much memory for a block, as the header of a compressed
 * array says, before it reads the data. It also keeps an object for every element of the XML, frees these
 * recursively, and searches attributes linearly. */
#ifndef ISO_GRIDS_VOLUME_VTI_CHECK_H
#define ISO_GRIDS_VOLUME_VTI_CHECK_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/c_linkage.h"
#include "base/status.h"

ISO_C_BEGIN

typedef enum iso_vti_encoding { ISO_VTI_TEXT, ISO_VTI_BASE64, ISO_VTI_RAW } iso_vti_encoding;

/* Where and how a file stores the values of one array. */
typedef struct iso_vti_layout {
    iso_vti_encoding encoding;
    bool compressed, lzma; /* lzma: decompression needs a dictionary as large as a block */
    bool big_endian;
    int header_bytes;  /* size of each number in the header before the values: 4 or 8 */
    int value_bytes;   /* size of a value */
    uint64_t position; /* in the file: of the values or, with `inside`, of the element that contains them */
    bool inside;
    uint64_t bytes; /* size of all values, uncompressed */
} iso_vti_layout;

/* Checks that the file has the data that the layout describes; *room becomes the memory that VTK takes beside
 * the array. ISO_ERR_IO: truncated or corrupt. */
iso_status iso_vti_check_array(const char *path, const iso_vti_layout *layout, uint64_t *room,
                               iso_error *error);

/* Whether `count` boxes, six numbers each (first and last on every axis), cover a box. */
bool iso_vti_covered(const int box[6], const int *boxes, size_t count);

/* Checks that parsing the XML up to the appended data takes less than 50 MB and little time. ISO_ERR_FORMAT,
 * ISO_ERR_IO. */
iso_status iso_vti_check_markup(const char *path, iso_error *error);

ISO_C_END
#endif
