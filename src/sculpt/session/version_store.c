/* Blocks for versions, in memory or in mapped files. */
#include "sculpt/session/version_store.h"

#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "base/temporary_file.h"

/* Bytes of a file; sizes of blocks in files are multiples of GRAIN. */
static const size_t CHUNK = (size_t)32 << 20, GRAIN = 256;

static size_t class_of(size_t size) {
    return size ? (size + GRAIN - 1) / GRAIN - 1 : 0;
}

/* Maps another file, and lets go of the pages of the one before, which stay in the file. */
static bool add_chunk(iso_version_store *store) {
    const size_t bytes = store->chunk_count * sizeof(uint8_t *);
    if (iso_buffer_reserve(&store->chunks, bytes + sizeof(uint8_t *), bytes, NULL) != ISO_OK) return false;
    const int file = iso_temporary_file_create(CHUNK);
    if (file < 0) return false;
    void *mapped = mmap(NULL, CHUNK, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
    close(file);
    if (mapped == MAP_FAILED) return false;
    uint8_t **chunks = store->chunks.data;
    if (store->chunk_count) madvise(chunks[store->chunk_count - 1], CHUNK, MADV_DONTNEED);
    chunks[store->chunk_count++] = mapped;
    store->used = 0;
    return true;
}

static uint8_t *take_in_file(iso_version_store *store, size_t size) {
    const size_t class = class_of(size), room = (class + 1) * GRAIN;
    if (class >= ISO_VERSION_CLASSES || store->no_files) return NULL;
    uint8_t *block = store->free[class];
    if (block) {
        memcpy(&store->free[class], block, sizeof(void *));
        return block;
    }
    if (!store->chunk_count || store->used + room > CHUNK) store->no_files = !add_chunk(store);
    if (store->no_files) return NULL;
    block = ((uint8_t **)store->chunks.data)[store->chunk_count - 1] + store->used;
    store->used += room;
    return block;
}

uint8_t *iso_version_store_take(iso_version_store *store, size_t size) {
    uint8_t *block = store->in_memory + size > store->limit ? take_in_file(store, size) : NULL;
    if (block) {
        store->in_files += size;
        return block;
    }
    block = iso_alloc(size);
    if (block) store->in_memory += size;
    return block;
}

static bool is_in_file(const iso_version_store *store, const uint8_t *block) {
    uint8_t *const *chunks = store->chunks.data;
    for (size_t i = 0; i < store->chunk_count; i++)
        if ((uintptr_t)block >= (uintptr_t)chunks[i] && (uintptr_t)block < (uintptr_t)chunks[i] + CHUNK)
            return true;
    return false;
}

void iso_version_store_give(iso_version_store *store, uint8_t *block, size_t size) {
    if (!block) return;
    if (!is_in_file(store, block)) {
        store->in_memory -= size;
        iso_free(block);
        return;
    }
    store->in_files -= size;
    memcpy(block, &store->free[class_of(size)], sizeof(void *));
    store->free[class_of(size)] = block;
}

void iso_version_store_free(iso_version_store *store) {
    for (size_t i = 0; i < store->chunk_count; i++) munmap(((uint8_t **)store->chunks.data)[i], CHUNK);
    iso_buffer_free(&store->chunks);
    *store = (iso_version_store){.limit = store->limit};
}
