/* memory: aligned allocation, growable buffers, and how much memory is available.
 *
 * The first write to a new 4 KiB page takes longer than the arithmetic of extraction for its contents. Huge
 * pages are therefore asked for in large blocks, and buffers are kept and reused. All functions are
 * thread-safe, but a buffer is for one thread at a time.
 */
#ifndef ISO_BASE_MEMORY_H
#define ISO_BASE_MEMORY_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/status.h"

#ifdef __cplusplus
extern "C" {
#endif

#define ISO_ALIGNMENT 64

/* Allocates `bytes` bytes, 64-byte aligned and uninitialised; blocks of 2 MiB and more are 2 MiB aligned and
 * get huge pages if the system has them. NULL: out of memory. Free with iso_free. bytes == 0 gives a block
 * that can be freed. */
void *iso_alloc(size_t bytes);

/* Asks for huge pages in a block that was not allocated by iso_alloc. Call it before the block is first
 * written. */
void iso_advise_huge(void *block, size_t bytes);

/* Allocates count x size zeroed bytes, 16-byte aligned; pages take memory only when they are written. NULL:
 * the product overflows, or out of memory. */
void *iso_alloc_zero(size_t count, size_t size);

/* Frees a block from iso_alloc or iso_alloc_zero; NULL is allowed. */
void iso_free(void *block);

/* A block that grows and is reused. Zero-initialise; iso_buffer_free when done. */
typedef struct iso_buffer {
    void *data;
    size_t bytes;
} iso_buffer;

/* Makes room for at least `bytes` bytes (grows by half or more) and keeps the first `keep` bytes.
 * ISO_ERR_NOMEM: the buffer is as before. */
iso_status iso_buffer_reserve(iso_buffer *buffer, size_t bytes, size_t keep, iso_error *error);
void iso_buffer_free(iso_buffer *buffer);

/* Copies data that will not be read soon. Large copies (4 KiB or more) bypass the caches, which is twice as
 * fast as memcpy. Other threads may read the data after the copying thread has called iso_copy_stream_end. */
void iso_copy_stream(void *to, const void *from, size_t bytes);
void iso_copy_stream_end(void);

/* Computes *out = a * b; returns false on overflow. */
bool iso_size_multiply(size_t a, size_t b, size_t *out);

/* Returns the bytes that can be allocated now without swapping: MemAvailable, bounded by the limit of the
 * cgroup. UINT64_MAX: the system does not say. */
uint64_t iso_memory_available(void);

/* Returns the limit that --max-memory sets: `asked` bytes or, if this is 0, 80 % of the available memory. */
uint64_t iso_memory_limit(uint64_t asked);

/* Returns the largest resident size of this process so far, in bytes. */
uint64_t iso_memory_peak(void);

#ifdef __cplusplus
}
#endif
#endif
