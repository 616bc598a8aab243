/* memory: aligned allocation, growable buffers, and the memory that is available.
 *
 * The first access to fresh 4 KiB pages costs more than the arithmetic of extraction: large blocks therefore
 * ask for huge pages, and buffers are kept and reused. All functions are thread-safe; a buffer is for one
 * thread at a time. */
#ifndef ISO_BASE_MEMORY_H
#define ISO_BASE_MEMORY_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/c_linkage.h"
#include "base/status.h"

ISO_C_BEGIN

#define ISO_ALIGNMENT 64

/* Allocates `bytes` bytes, 64-byte aligned, uninitialised; blocks of 2 MiB and more are 2 MiB aligned and ask
 * for huge pages. NULL when there is no memory. Release with iso_free. With bytes == 0 the result is a block,
 * not NULL. */
void *iso_alloc(size_t bytes);

/* Gives free memory that the allocator keeps back to the system, where it can. */
void iso_memory_trim(void);

/* Asks the system for huge pages for memory that was allocated elsewhere; call it before the memory is first
 * written. */
void iso_advise_huge(void *block, size_t bytes);

/* Tells the system whether a block is used in no order (`random`) or in the order of its addresses, as at
 * first. In the latter case the pages around one that is needed are read as well. For blocks in files
 * (iso_memory_use_files) that are written at thousands of places in turn, these can need more memory than
 * there is. */
void iso_advise_order(void *block, size_t bytes, bool random);

/* Allocates count x size zeroed bytes, 16-byte aligned, without touching their pages. NULL on overflow or
 * without memory. */
void *iso_alloc_zero(size_t count, size_t size);

/* Limits what all blocks of iso_alloc and iso_alloc_zero may take together, in this process, those that exist
 * already included; what goes beyond it is refused as if there were no memory. For programs, once at their
 * start. UINT64_MAX: no limit, as before the first call. Where the C library does not tell the sizes of
 * blocks (it is not glibc) there is no limit. */
void iso_memory_set_limit(uint64_t bytes);
/* Whether the limit has ever refused a block. */
bool iso_memory_was_refused(void);
/* Whether so many bytes more stay below the limit, so that a block may be larger than what is known to be
 * needed. */
bool iso_memory_has_room(size_t bytes);

/* Lets blocks of 1 MiB and more lie in files without names in TMPDIR (/tmp) when all blocks together would
 * take more than the limit minus a reserve: a quarter of the limit, at most 256 MiB. Such blocks do not count
 * against the limit, and begin at pages only. The system writes their pages to the files when it needs the
 * memory, and reads them when they are used; their room on the disk is reserved at once. Where files cannot
 * be made, or would lie in memory (tmpfs), the limit holds for all blocks. For programs. */
void iso_memory_use_files(void);
/* Whether iso_memory_use_files has been called. */
bool iso_memory_uses_files(void);
/* The most bytes that have been in such files at a time. */
size_t iso_memory_in_files(void);

/* Releases a block of iso_alloc or iso_alloc_zero; NULL is ignored. */
void iso_free(void *block);

/* A block that grows and is reused. Zero-initialise; iso_buffer_free when done. */
typedef struct iso_buffer {
    void *data;
    size_t bytes;
} iso_buffer;

/* Makes room for at least `bytes` bytes (grows by half or more), keeping the first `keep` bytes.
 * ISO_ERR_NOMEM leaves the buffer as it was. */
iso_status iso_buffer_reserve(iso_buffer *buffer, size_t bytes, size_t keep, iso_error *error);
void iso_buffer_free(iso_buffer *buffer);

/* Copies memory that will not be read soon, bypassing the caches where that is faster (for many kilobytes,
 * twice as fast as memcpy). The copying thread must call iso_copy_stream_end before other threads read the
 * copy. */
void iso_copy_stream(void *to, const void *from, size_t bytes);
void iso_copy_stream_end(void);

/* *out = a * b; false on overflow. */
bool iso_size_multiply(size_t a, size_t b, size_t *out);

/* Bytes that can be allocated now without swapping: MemAvailable, bounded by the cgroup's limit.
 * UINT64_MAX when the system does not say. */
uint64_t iso_memory_available(void);

/* The number of bytes for the option --max-memory: `asked` bytes or, when that is 0, 80 % of the available
 * memory. */
uint64_t iso_memory_limit(uint64_t asked);

/* Largest resident size of this process so far, in bytes. */
uint64_t iso_memory_peak(void);

ISO_C_END
#endif
