/* file_blocks: shared mappings of temporary files, and a table of their addresses. */
#include "base/file_blocks.h"

#include <errno.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdint.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/vfs.h>
#include <unistd.h>

#include "base/temporary_file.h"

enum { LEAST_PAGE = 4096 }; /* mappings begin at multiples of it on every system */

typedef struct file_block {
    void *address; /* NULL: this entry is free */
    size_t bytes;
} file_block;

static pthread_mutex_t mutex = PTHREAD_MUTEX_INITIALIZER; /* of the next three */
static file_block blocks[ISO_FILE_BLOCKS];
static size_t all_bytes, most_bytes;
static _Atomic(const char *) problem;
static atomic_size_t count; /* of blocks: while there are none, others are freed without the mutex */

static file_block *find(const void *address) {
    for (int i = 0; i < ISO_FILE_BLOCKS; i++)
        if (blocks[i].address == address) return &blocks[i];
    return NULL;
}

/* Enters a block into the table; false: it is full. */
static bool add(void *address, size_t bytes) {
    pthread_mutex_lock(&mutex);
    file_block *entry = find(NULL);
    if (entry) {
        *entry = (file_block){address, bytes};
        all_bytes += bytes;
        most_bytes = all_bytes > most_bytes ? all_bytes : most_bytes;
        atomic_fetch_add(&count, 1);
    }
    pthread_mutex_unlock(&mutex);
    return entry != NULL;
}

/* Removes a block from the table; returns its bytes, 0: there is no such block. */
static size_t take_out(void *address) {
    size_t bytes = 0;
    pthread_mutex_lock(&mutex);
    file_block *entry = find(address);
    if (entry) {
        bytes = entry->bytes;
        *entry = (file_block){NULL, 0};
        all_bytes -= bytes;
        atomic_fetch_sub(&count, 1);
    }
    pthread_mutex_unlock(&mutex);
    return bytes;
}

static void *refuse(const char *reason) {
    atomic_store(&problem, reason);
    return NULL;
}

/* Whether a file lies in memory: blocks in it would gain nothing. */
static bool lies_in_memory(int file) {
    enum { TMPFS = 0x01021994 };
    const unsigned RAMFS = 0x858458f6u;
    struct statfs info;
    return fstatfs(file, &info) == 0 && ((unsigned)info.f_type == TMPFS || (unsigned)info.f_type == RAMFS);
}

/* Maps a file of zeros. NULL: it cannot be mapped, or lies in memory. */
static void *map(int file, size_t bytes) {
    if (lies_in_memory(file)) return refuse("they would lie in memory (tmpfs)");
    void *address = mmap(NULL, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
    return address == MAP_FAILED ? refuse(strerror(errno)) : address;
}

void *iso_file_block_create(size_t bytes) {
    const int file = iso_temporary_file_create(bytes);
    if (file < 0) return refuse(strerror(-file));
    void *address = map(file, bytes);
    close(file);
    if (!address || add(address, bytes)) return address;
    munmap(address, bytes);
    return refuse("there are too many");
}

const char *iso_file_blocks_problem(void) {
    return atomic_load(&problem);
}

bool iso_file_block_destroy(void *block) {
    if (!atomic_load(&count) || (uintptr_t)block % LEAST_PAGE) return false;
    const size_t bytes = take_out(block);
    if (bytes) munmap(block, bytes);
    return bytes > 0;
}

size_t iso_file_blocks_most(void) {
    pthread_mutex_lock(&mutex);
    const size_t bytes = most_bytes;
    pthread_mutex_unlock(&mutex);
    return bytes;
}
