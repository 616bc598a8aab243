/* memory: allocation, buffers, streaming copies, and the memory limits of Linux and its cgroups. */
#include "base/memory.h"

#include <stdatomic.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

#include "base/cgroup.h"
#include "base/file_blocks.h"

#ifdef __GLIBC__
#include <malloc.h>
#endif
#ifdef __SSE2__
#include <emmintrin.h>
#endif

#define HUGE_PAGE ((size_t)2 << 20)

void iso_memory_trim(void) {
#ifdef __GLIBC__
    malloc_trim(0);
#endif
}

/* Asks for huge pages only for the pages of 2 MiB that lie wholly in the block. */
void iso_advise_huge(void *block, size_t bytes) {
#ifdef MADV_HUGEPAGE
    const size_t before = (0 - (uintptr_t)block) % HUGE_PAGE;
    if (bytes < before + HUGE_PAGE) return;
    madvise((char *)block + before, (bytes - before) / HUGE_PAGE * HUGE_PAGE, MADV_HUGEPAGE);
#else
    (void)block, (void)bytes;
#endif
}

void iso_advise_order(void *block, size_t bytes, bool random) {
    const size_t page = (size_t)sysconf(_SC_PAGESIZE), before = (0 - (uintptr_t)block) % page;
    if (block && bytes >= before + page)
        posix_madvise((char *)block + before, (bytes - before) / page * page,
                      random ? POSIX_MADV_RANDOM : POSIX_MADV_NORMAL);
}

/* ---- the limit of all blocks */

static atomic_llong allocated; /* bytes of all blocks */
static atomic_llong most_allocated = INT64_MAX;
static atomic_bool refused;

static long long size_of(void *block) {
#ifdef __GLIBC__
    return (long long)malloc_usable_size(block);
#else
    (void)block;
    return 0;
#endif
}

void iso_memory_set_limit(uint64_t bytes) {
    atomic_store(&most_allocated, bytes < INT64_MAX ? (long long)bytes : INT64_MAX);
}

bool iso_memory_was_refused(void) {
    return atomic_load(&refused);
}

bool iso_memory_has_room(size_t bytes) {
    const long long left = atomic_load(&most_allocated) - atomic_load(&allocated);
    return left > 0 && (uint64_t)bytes < (uint64_t)left;
}

/* ---- blocks in files */

enum { FILE_BLOCK_LEAST = 1 << 20 };

static atomic_bool uses_files;

void iso_memory_use_files(void) {
    atomic_store(&uses_files, true);
}

bool iso_memory_uses_files(void) {
    return atomic_load(&uses_files);
}

size_t iso_memory_in_files(void) {
    return iso_file_blocks_most();
}

/* What large blocks leave of the limit for small ones. */
static long long reserve_of(long long limit) {
    const long long most = (long long)256 << 20;
    return limit / 4 < most ? limit / 4 : most;
}

static bool may_lie_in_file(size_t bytes) {
    return atomic_load(&uses_files) && bytes >= FILE_BLOCK_LEAST && bytes <= INT64_MAX;
}

/* Makes a block of zeros in a file, if it is large and memory is short. NULL: it belongs into memory. */
static void *alloc_in_file(size_t bytes) {
    const long long limit = atomic_load(&most_allocated);
    if (!may_lie_in_file(bytes) || atomic_load(&allocated) <= limit - reserve_of(limit) - (long long)bytes)
        return NULL;
    return iso_file_block_create(bytes);
}

/* Counts a fresh block of memory. One that goes beyond the limit, which another thread may have reached
 * since alloc_in_file, is freed; then the result is a block in a file, or NULL. */
static void *count_block(void *block, size_t asked) {
    const long long bytes = block ? size_of(block) : 0;
    if (atomic_fetch_add(&allocated, bytes) + bytes <= atomic_load(&most_allocated)) return block;
    atomic_fetch_sub(&allocated, bytes);
    free(block);
    void *in_file = may_lie_in_file(asked) ? iso_file_block_create(asked) : NULL;
    if (!in_file) atomic_store(&refused, true);
    return in_file;
}

/* ---- blocks */

/* Gives back what lies behind an aligned block. glibc maps large blocks with room for the alignment; what it
 * does not need before the block, which depends on the address, would count as the block's. A mapping that
 * shrinks does not move. */
static void *trim(void *block, size_t bytes) {
    const size_t least = 1 << 16; /* what is worth a system call */
    if (size_of(block) <= (long long)(bytes + least)) return block;
    void *trimmed = realloc(block, bytes);
    return trimmed ? trimmed : block;
}

void *iso_alloc(size_t bytes) {
    size_t alignment = bytes >= HUGE_PAGE ? HUGE_PAGE : ISO_ALIGNMENT;
    if (bytes > SIZE_MAX - alignment) return NULL;
    size_t rounded = (bytes + ISO_ALIGNMENT - 1) / ISO_ALIGNMENT * ISO_ALIGNMENT;
    void *block = alloc_in_file(rounded);
    if (block) return block;
    if (posix_memalign(&block, alignment, rounded ? rounded : ISO_ALIGNMENT) != 0) return NULL;
    if (alignment > ISO_ALIGNMENT) block = trim(block, rounded);
    iso_advise_huge(block, rounded);
    return count_block(block, rounded);
}

void *iso_alloc_zero(size_t count, size_t size) {
    size_t bytes;
    if (!iso_size_multiply(count, size, &bytes)) return NULL;
    void *block = alloc_in_file(bytes);
    return block ? block : count_block(calloc(count ? count : 1, size ? size : 1), bytes);
}

void iso_free(void *block) {
    if (!block || iso_file_block_destroy(block)) return;
    atomic_fetch_sub(&allocated, size_of(block));
    free(block);
}

/* Copies the beginning of a block that is then freed, and gives back its pages as they are copied: both
 * blocks together take little more memory than the new one. */
static void move_block(void *to, void *from, size_t bytes) {
    const size_t step = HUGE_PAGE, page = (size_t)sysconf(_SC_PAGESIZE);
    for (size_t at = 0; at < bytes; at += step) {
        const size_t part = bytes - at < step ? bytes - at : step;
        memcpy((char *)to + at, (char *)from + at, part);
        if (bytes < step) return;
        const uintptr_t first = ((uintptr_t)from + at + page - 1) / page * page,
                        end = ((uintptr_t)from + at + part) / page * page;
        madvise((char *)first, end - first, MADV_DONTNEED);
    }
}

iso_status iso_buffer_reserve(iso_buffer *buffer, size_t bytes, size_t keep, iso_error *error) {
    if (bytes <= buffer->bytes) return ISO_OK;
    size_t grown = buffer->bytes + buffer->bytes / 2;
    size_t wanted = bytes > grown ? bytes : grown;
    void *data = iso_alloc(wanted);
    if (!data) return iso_fail(error, ISO_ERR_NOMEM, "out of memory: %zu bytes refused", wanted);
    if (keep) move_block(data, buffer->data, keep < buffer->bytes ? keep : buffer->bytes);
    iso_free(buffer->data);
    *buffer = (iso_buffer){data, wanted};
    return ISO_OK;
}

void iso_buffer_free(iso_buffer *buffer) {
    iso_free(buffer->data);
    *buffer = (iso_buffer){0};
}

bool iso_size_multiply(size_t a, size_t b, size_t *out) {
    return !__builtin_mul_overflow(a, b, out);
}

uint64_t iso_memory_available(void) {
    const uint64_t kib = iso_number_in_file("/proc/meminfo", "MemAvailable:"),
                   available = kib == UINT64_MAX ? UINT64_MAX : kib * 1024, left = iso_cgroup_memory_left("");
    return left < available ? left : available;
}

uint64_t iso_memory_limit(uint64_t asked) {
    if (asked) return asked;
    uint64_t available = iso_memory_available();
    return available == UINT64_MAX ? available : available / 5 * 4;
}

uint64_t iso_memory_peak(void) {
    struct rusage usage;
    if (getrusage(RUSAGE_SELF, &usage) != 0) return 0;
    return (uint64_t)usage.ru_maxrss * 1024;
}

#ifdef __SSE2__
enum { STREAM_LINE = 64, STREAM_BYTES = 4096 };

void iso_copy_stream(void *to, const void *from, size_t bytes) {
    char *target = to;
    const char *source = from;
    if (bytes >= STREAM_BYTES) {
        const size_t head = (0 - (uintptr_t)target) % STREAM_LINE;
        memcpy(target, source, head);
        size_t at = head;
        for (; at + STREAM_LINE <= bytes; at += STREAM_LINE) /* whole cache lines: the target is not read */
            for (size_t k = at; k < at + STREAM_LINE; k += sizeof(__m128i))
                _mm_stream_si128((__m128i *)(void *)(target + k),
                                 _mm_loadu_si128((const __m128i *)(const void *)(source + k)));
        target += at;
        source += at;
        bytes -= at;
    }
    memcpy(target, source, bytes);
}

void iso_copy_stream_end(void) {
    _mm_sfence();
}
#else
void iso_copy_stream(void *to, const void *from, size_t bytes) {
    memcpy(to, from, bytes);
}

void iso_copy_stream_end(void) {}
#endif
