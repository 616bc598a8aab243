/* Memory: aligned allocation, growable buffers, and what the machine has left.
 *
 * First touch of fresh 4 KiB pages costs more than the arithmetic of extraction, so large blocks are advised
 * to use huge pages and buffers are kept and reused. All functions are thread-safe; buffers are not shared.
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

/* `bytes` bytes, 64-byte aligned, uninitialised; blocks of 2 MiB and more are 2 MiB aligned and advised to
 * huge pages. NULL when there is no memory. Free with iso_free. bytes == 0 gives a block that can be freed.
 */
void *iso_alloc(size_t bytes);

/* Asks for huge pages for memory of someone else's making, as iso_alloc does for its own: before it is first
 * written to. */
void iso_advise_huge(void *block, size_t bytes);

/* count x size zeroed bytes, 16-byte aligned, pages untouched until used. NULL on overflow or no memory. */
void *iso_alloc_zero(size_t count, size_t size);

/* Frees what iso_alloc or iso_alloc_zero gave; NULL is fine. */
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

/* Copies what will not be read soon, past the caches where that is faster (many kilobytes; twice as fast as
 * memcpy then). Other threads see it after iso_copy_stream_end in the thread that copied. */
void iso_copy_stream(void *to, const void *from, size_t bytes);
void iso_copy_stream_end(void);

/* *out = a * b; false on overflow. */
bool iso_size_multiply(size_t a, size_t b, size_t *out);

/* Bytes that can be allocated now without swapping: MemAvailable, bounded by the cgroup's limit.
 * UINT64_MAX when the system does not say. */
uint64_t iso_memory_available(void);

/* `asked` bytes, or 80 % of what is available when that is 0: the limit that --max-memory sets. */
uint64_t iso_memory_limit(uint64_t asked);

/* Largest resident size of this process so far, in bytes. */
uint64_t iso_memory_peak(void);

#ifdef __cplusplus
}
#endif
#endif
