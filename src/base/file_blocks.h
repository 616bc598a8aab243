/* file_blocks: blocks of memory that lie in temporary files (base/temporary_file.h): the system writes their
 * pages to the file when it needs the memory, and reads them again when they are used. Made by iso_alloc and
 * iso_alloc_zero after iso_memory_use_files; others ask only why one could not be made. */
#ifndef ISO_BASE_FILE_BLOCKS_H
#define ISO_BASE_FILE_BLOCKS_H

#include <stdbool.h>
#include <stddef.h>

enum { ISO_FILE_BLOCKS = 1024 }; /* most blocks */

/* Makes a block of zeros that begins at a page. NULL: iso_file_blocks_problem says why. Any thread, also
 * below. A process that forks shares its blocks with its child. */
void *iso_file_block_create(size_t bytes);

/* Why the last block that could not be made was refused; NULL: none was. */
const char *iso_file_blocks_problem(void);

/* Removes a block and its file. Returns false, and does nothing, if `block` was not made by
 * iso_file_block_create. */
bool iso_file_block_destroy(void *block);

/* The most bytes that all blocks together have had. */
size_t iso_file_blocks_most(void);

#endif
