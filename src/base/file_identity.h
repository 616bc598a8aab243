/* file_identity: whether files are still the same, by their sizes and times of change. */
#ifndef ISO_BASE_FILE_IDENTITY_H
#define ISO_BASE_FILE_IDENTITY_H

#include <stdint.h>

#include "base/file_set.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The sizes of all files of a set that are read, together, when they were added. */
uint64_t iso_file_set_read_bytes(const iso_file_set *set);

/* A number made of the sizes of the files that are read and of when they changed: another one, most likely,
 * when one of them is another file. */
uint64_t iso_file_set_identity(const iso_file_set *set);

#ifdef __cplusplus
}
#endif
#endif
