/* fail_allocation: an LD_PRELOAD library in which one request for memory fails, as if there were none.
 *
 *     FAIL_ALLOCATION_AT     which request fails, from 1; 0 or not set: none
 *     FAIL_ALLOCATION_COUNT  the file to which the number of requests is written when the program exits
 *
 * Requests are malloc, calloc, realloc, aligned_alloc, memalign, posix_memalign, and mmap, of the program and
 * of all its libraries, from when this library was loaded; mmap only where it is called by this name, which
 * glibc itself does not. */
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <unistd.h>

/* glibc's own functions, which need no dlsym: that would ask for memory. */
void *__libc_malloc(size_t bytes);
void *__libc_calloc(size_t count, size_t size);
void *__libc_realloc(void *block, size_t bytes);
void *__libc_memalign(size_t alignment, size_t bytes);

static atomic_long requests;
static long failing;
static bool counting;
static void *(*real_mmap)(void *, size_t, int, int, int, off_t);

__attribute__((constructor)) static void start(void) {
    *(void **)&real_mmap = dlsym(RTLD_NEXT, "mmap");
    const char *at = getenv("FAIL_ALLOCATION_AT");
    failing = at ? atol(at) : 0;
    counting = true;
}

/* Whether this request, which is counted, fails. */
static bool fails(void) {
    if (!counting || atomic_fetch_add(&requests, 1) + 1 != failing) return false;
    errno = ENOMEM;
    return true;
}

__attribute__((destructor)) static void finish(void) {
    const char *path = getenv("FAIL_ALLOCATION_COUNT");
    char text[32];
    counting = false;
    if (!path) return;
    const int file = open(path, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    const int length = snprintf(text, sizeof text, "%ld\n", atomic_load(&requests));
    if (file < 0 || write(file, text, (size_t)length) != length) abort();
    close(file);
}

void *malloc(size_t bytes) {
    return fails() ? NULL : __libc_malloc(bytes);
}

void *calloc(size_t count, size_t size) {
    return fails() ? NULL : __libc_calloc(count, size);
}

void *realloc(void *block, size_t bytes) {
    return fails() ? NULL : __libc_realloc(block, bytes);
}

void *memalign(size_t alignment, size_t bytes);
void *memalign(size_t alignment, size_t bytes) {
    return fails() ? NULL : __libc_memalign(alignment, bytes);
}

void *aligned_alloc(size_t alignment, size_t bytes) {
    return fails() ? NULL : __libc_memalign(alignment, bytes);
}

int posix_memalign(void **block, size_t alignment, size_t bytes) {
    void *made = fails() ? NULL : __libc_memalign(alignment, bytes);
    if (!made) return ENOMEM;
    *block = made;
    return 0;
}

void *mmap(void *at, size_t bytes, int protection, int flags, int file, off_t offset) {
    return fails() ? MAP_FAILED : real_mmap(at, bytes, protection, flags, file, offset);
}
