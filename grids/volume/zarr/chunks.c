/* chunks: finds the chunks of a Zarr array in files, one for each chunk or each shard, and reads them. */
#include <errno.h>
#include <limits.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/crc32c.h"
#include "base/file.h"
#include "base/memory.h"
#include "grids/volume/zarr/zarr.h"

enum { KEPT_INDICES = 16 };

static uint64_t little_endian(const unsigned char *bytes, int count) {
    uint64_t value = 0;
    while (count-- > 0) value = value << 8 | bytes[count];
    return value;
}

/* The index of a shard: offset and size of each of its chunks, little-endian; all ones: it is absent. */
typedef struct shard_index {
    uint64_t shard[ISO_ZARR_AXES];
    uint64_t *entries; /* NULL: unused */
    uint64_t used;     /* when: the oldest one gives way */
} shard_index;

struct iso_zarr_chunks {
    char *folder;
    iso_zarr_array array;
    const iso_remote *remote; /* of a folder on a server */
    size_t bytes;             /* of a decoded chunk */
    int most_kept;            /* indices of shards that are kept */
    pthread_mutex_t lock;     /* of the following */
    shard_index kept[KEPT_INDICES];
    uint64_t time;
};

/* ---- sizes */

static uint64_t elements_of(const iso_zarr_array *array, const uint64_t sizes[ISO_ZARR_AXES]) {
    uint64_t elements = 1; /* metadata.c has checked that a whole shard does not overflow */
    for (int axis = 0; axis < array->axes; axis++) elements *= sizes[axis];
    return elements;
}

uint64_t iso_zarr_chunk_elements(const iso_zarr_array *array) {
    return elements_of(array, array->chunk);
}

uint64_t iso_zarr_most_encoded(const iso_zarr_array *array) {
    return iso_zarr_decode_room(iso_zarr_chunk_elements(array) * iso_scalar_size(array->scalar)) / 2;
}

uint64_t iso_zarr_index_bytes(const iso_zarr_array *array) {
    return array->sharded ? 16 * (elements_of(array, array->shard) / iso_zarr_chunk_elements(array)) : 0;
}

iso_status iso_zarr_chunks_create(const char *folder, const iso_zarr_array *array, const iso_remote *remote,
                                  uint64_t index_memory, iso_zarr_chunks **chunks, iso_error *error) {
    iso_zarr_chunks *made = calloc(1, sizeof *made);
    *chunks = NULL;
    if (made) made->folder = strdup(folder);
    if (!made || !made->folder) {
        free(made);
        return iso_fail_memory(error, folder);
    }
    made->array = *array;
    made->remote = remote;
    made->bytes = (size_t)(iso_zarr_chunk_elements(array) * iso_scalar_size(array->scalar));
    made->most_kept = KEPT_INDICES;
    while (made->most_kept > 1 && (uint64_t)made->most_kept * iso_zarr_index_bytes(array) > index_memory)
        made->most_kept--;
    pthread_mutex_init(&made->lock, NULL);
    *chunks = made;
    return ISO_OK;
}

void iso_zarr_chunks_destroy(iso_zarr_chunks *chunks) {
    if (!chunks) return;
    for (int i = 0; i < KEPT_INDICES; i++) iso_free(chunks->kept[i].entries);
    pthread_mutex_destroy(&chunks->lock);
    free(chunks->folder);
    free(chunks);
}

/* ---- names */

/* Where a chunk is: the file of its shard, or its own. */
typedef struct place {
    char path[PATH_MAX];
    char name[PATH_MAX + 64]; /* for messages: the path and, within a shard, the chunk's number */
    uint64_t shard[ISO_ZARR_AXES];
    size_t number; /* of the chunk in its shard */
} place;

static iso_status find_place(const iso_zarr_chunks *chunks, const uint64_t index[ISO_ZARR_AXES], place *p,
                             iso_error *error) {
    const iso_zarr_array *array = &chunks->array;
    *p = (place){.number = 0};
    for (int i = 0; i < array->axes; i++) {
        const int axis = array->sharded ? array->shard_order[i] : i;
        const uint64_t across = array->shard[axis] / array->chunk[axis];
        p->shard[axis] = index[axis] / across;
        p->number = p->number * (size_t)across + (size_t)(index[axis] % across);
    }
    int length = snprintf(p->path, sizeof p->path, "%s/%s", chunks->folder, array->has_prefix ? "c" : "");
    for (int i = 0; i < array->axes; i++) {
        const int axis = array->n5 ? array->axes - 1 - i : i;
        const char separator[2] = {i || array->has_prefix ? array->separator : 0, 0};
        if (length < (int)sizeof p->path)
            length += snprintf(p->path + length, sizeof p->path - (size_t)length, "%s%llu", separator,
                               (unsigned long long)p->shard[axis]);
    }
    if (length >= (int)sizeof p->path)
        return iso_fail(error, ISO_ERR_IO, "%s: names of its chunks are too long", chunks->folder);
    if (array->sharded)
        snprintf(p->name, sizeof p->name, "%s, chunk %zu", p->path, p->number);
    else
        snprintf(p->name, sizeof p->name, "%s", p->path);
    return ISO_OK;
}

/* ---- files */

typedef struct part {
    uint64_t offset, size;
} part;

/* The file of a chunk or shard. */
typedef struct chunk_file {
    const iso_remote *remote; /* of one on a server, whose size is not known */
    int descriptor;           /* -1: it does not exist */
    uint64_t bytes;
} chunk_file;

/* Opens a file. Whether one on a server exists turns out when it is read. */
static iso_status open_file(const iso_zarr_chunks *chunks, const place *p, chunk_file *file,
                            iso_error *error) {
    *file = (chunk_file){chunks->remote, -1, UINT64_MAX};
    if (file->remote || (access(p->path, F_OK) != 0 && errno == ENOENT)) return ISO_OK;
    return iso_file_descriptor(p->path, &file->descriptor, &file->bytes, error);
}

static bool is_absent(const chunk_file *file) {
    return !file->remote && file->descriptor < 0;
}

static void close_file(const chunk_file *file) {
    if (file->descriptor >= 0) close(file->descriptor);
}

static iso_status read_part(const chunk_file *file, const place *p, part wanted, void *target,
                            iso_error *error) {
    for (uint64_t done = 0; done < wanted.size;) {
        const ssize_t got = pread(file->descriptor, (char *)target + done, (size_t)(wanted.size - done),
                                  (off_t)(wanted.offset + done));
        if (got < 0 && errno == EINTR) continue;
        if (got < 0) return iso_fail(error, ISO_ERR_IO, "%s: cannot read: %s", p->name, strerror(errno));
        if (got == 0) return iso_fail(error, ISO_ERR_IO, "%s: became shorter while it was read", p->name);
        done += (uint64_t)got;
    }
    return ISO_OK;
}

/* ---- shards */

/* Reads the bytes of the index of a shard. *absent: the server has no such file. */
static iso_status load_index(const iso_zarr_array *array, const chunk_file *file, const place *p, size_t size,
                             unsigned char *target, bool *absent, iso_error *error) {
    *absent = false;
    if (file->remote) {
        const iso_remote_part wanted = {array->index_at_start ? ISO_REMOTE_BYTES : ISO_REMOTE_LAST, 0, size};
        iso_buffer bytes = {0};
        size_t count;
        const iso_status status = file->remote->read(p->path, &wanted, &bytes, &count, absent, error);
        if (status == ISO_OK && !*absent) memcpy(target, bytes.data, size);
        iso_buffer_free(&bytes);
        return status;
    }
    if (file->bytes < size)
        return iso_fail(error, ISO_ERR_IO, "%s: truncated: %llu bytes are less than the index of a shard",
                        p->path, (unsigned long long)file->bytes);
    const part where = {array->index_at_start ? 0 : file->bytes - size, size};
    return read_part(file, p, where, target, error);
}

/* Reads the index of a shard, of 16 * in_shard bytes and perhaps a checksum. That of a shard that a server
 * does not have says that all chunks are absent. */
static iso_status read_index(const iso_zarr_chunks *chunks, const chunk_file *file, const place *p,
                             uint64_t *entries, iso_error *error) {
    const iso_zarr_array *array = &chunks->array;
    const size_t bytes = (size_t)iso_zarr_index_bytes(array),
                 size = bytes + (array->index_codecs.count ? 4 : 0);
    unsigned char *byte = (unsigned char *)entries;
    bool absent;
    ISO_TRY(load_index(array, file, p, size, byte, &absent, error));
    if (absent) {
        memset(entries, 0xff, bytes);
        return ISO_OK;
    }
    if (size > bytes && iso_crc32c(0, byte, bytes) != (uint32_t)little_endian(byte + bytes, 4))
        return iso_fail(error, ISO_ERR_IO, "%s, index of the shard: damaged (crc32c)", p->path);
    for (size_t i = 0; i < bytes / 8; i++) entries[i] = little_endian(byte + 8 * i, 8);
    return ISO_OK;
}

/* Reads an index in the place of the one that was used least recently. */
static iso_status keep_index(iso_zarr_chunks *chunks, const chunk_file *file, const place *p,
                             shard_index **kept, iso_error *error) {
    enum { CHECKSUM = 8 };
    shard_index *oldest = &chunks->kept[0];
    for (int i = 1; i < chunks->most_kept; i++)
        if (chunks->kept[i].used < oldest->used) oldest = &chunks->kept[i];
    if (!oldest->entries)
        oldest->entries = iso_alloc((size_t)iso_zarr_index_bytes(&chunks->array) + CHECKSUM);
    if (!oldest->entries) return iso_fail_memory(error, p->path);
    const iso_status status = read_index(chunks, file, p, oldest->entries, error);
    if (status != ISO_OK) {
        iso_free(oldest->entries);
        *oldest = (shard_index){.used = 0};
        return status;
    }
    memcpy(oldest->shard, p->shard, sizeof p->shard);
    oldest->used = ++chunks->time;
    *kept = oldest;
    return ISO_OK;
}

static shard_index *find_kept(iso_zarr_chunks *chunks, const place *p) {
    for (int i = 0; i < chunks->most_kept; i++) {
        shard_index *kept = &chunks->kept[i];
        if (!kept->entries || memcmp(kept->shard, p->shard, sizeof p->shard) != 0) continue;
        kept->used = ++chunks->time;
        return kept;
    }
    return NULL;
}

/* Where a chunk lies in the file of its shard. */
static iso_status find_in_shard(iso_zarr_chunks *chunks, const chunk_file *file, const place *p, part *found,
                                iso_error *error) {
    iso_status status = ISO_OK;
    pthread_mutex_lock(&chunks->lock);
    shard_index *kept = find_kept(chunks, p);
    if (!kept) status = keep_index(chunks, file, p, &kept, error);
    if (status == ISO_OK) *found = (part){kept->entries[2 * p->number], kept->entries[2 * p->number + 1]};
    pthread_mutex_unlock(&chunks->lock);
    return status;
}

/* Reads the index of a shard, if it is not kept. NULL: it cannot be read. */
static const shard_index *index_of(iso_zarr_chunks *chunks, const place *p) {
    shard_index *kept = find_kept(chunks, p);
    chunk_file file;
    if (kept || open_file(chunks, p, &file, NULL) != ISO_OK || is_absent(&file)) return kept;
    if (keep_index(chunks, &file, p, &kept, NULL) != ISO_OK) kept = NULL;
    close_file(&file);
    return kept;
}

uint64_t iso_zarr_next_in_shard(iso_zarr_chunks *chunks, const uint64_t index[ISO_ZARR_AXES], int axis,
                                uint64_t count) {
    const iso_zarr_array *array = &chunks->array;
    place p;
    size_t step = 1; /* entries from one chunk to the next along the axis */
    uint64_t k = 0;
    for (int i = array->axes - 1; array->shard_order[i] != axis; i--)
        step *= (size_t)(array->shard[array->shard_order[i]] / array->chunk[array->shard_order[i]]);
    if (find_place(chunks, index, &p, NULL) != ISO_OK) return 0;
    pthread_mutex_lock(&chunks->lock);
    const shard_index *kept = index_of(chunks, &p);
    const uint64_t *entry = kept ? kept->entries + 2 * p.number : NULL;
    while (entry && k < count && entry[2 * k * step] == UINT64_MAX && entry[2 * k * step + 1] == UINT64_MAX)
        k++;
    pthread_mutex_unlock(&chunks->lock);
    return k;
}

/* ---- chunks */

/* Finds the bytes of a chunk in an open file. *absent: there are none. */
static iso_status find_part(iso_zarr_chunks *chunks, const chunk_file *file, const place *p, part *found,
                            bool *absent, iso_error *error) {
    *found = (part){0, file->bytes};
    *absent = false;
    if (chunks->array.sharded) {
        ISO_TRY(find_in_shard(chunks, file, p, found, error));
        *absent = found->offset == UINT64_MAX && found->size == UINT64_MAX;
        if (*absent) return ISO_OK;
        if (found->offset > file->bytes || found->size > file->bytes - found->offset)
            return iso_fail(error, ISO_ERR_IO, "%s: truncated: it ends at byte %llu of %llu", p->name,
                            (unsigned long long)(found->offset + found->size),
                            (unsigned long long)file->bytes);
    } else if (file->remote) {
        found->size = iso_zarr_most_encoded(&chunks->array);
    }
    if (found->size <= iso_zarr_most_encoded(&chunks->array)) return ISO_OK;
    return iso_fail(error, ISO_ERR_IO, "%s: damaged: %llu bytes are more than a chunk of %zu bytes can take",
                    p->name, (unsigned long long)found->size, chunks->bytes);
}

/* Reads the bytes of a chunk, which on a server are `where` of a shard, or a file. */
static iso_status load_chunk(const iso_zarr_chunks *chunks, const chunk_file *file, const place *p,
                             part where, iso_buffer *encoded, size_t *size, bool *absent, iso_error *error) {
    if (file->remote) {
        const iso_remote_part wanted = {chunks->array.sharded ? ISO_REMOTE_BYTES : ISO_REMOTE_WHOLE,
                                        where.offset, where.size};
        return file->remote->read(p->path, &wanted, encoded, size, absent, error);
    }
    *size = (size_t)where.size;
    if (iso_buffer_reserve(encoded, *size + 1, 0, NULL) != ISO_OK) return iso_fail_memory(error, p->name);
    return read_part(file, p, where, encoded->data, error);
}

static iso_status decode_chunk(const iso_zarr_chunks *chunks, const place *p, const void *encoded,
                               size_t size, void *target, iso_error *error) {
    void *room = iso_alloc((size_t)iso_zarr_decode_room(chunks->bytes));
    if (!room) return iso_fail_memory(error, p->name);
    const iso_status status =
        chunks->array.n5 ? iso_zarr_decode_block(&chunks->array, p->name, encoded, size, target, room, error)
                         : iso_zarr_decode(&chunks->array.codecs, p->name, encoded, size, target,
                                           chunks->bytes, room, error);
    iso_free(room);
    return status;
}

iso_status iso_zarr_read_chunk(iso_zarr_chunks *chunks, const uint64_t index[ISO_ZARR_AXES], void *target,
                               bool *absent, iso_error *error) {
    place p;
    part where;
    chunk_file file;
    iso_buffer encoded = {0};
    size_t size = 0;
    ISO_TRY(find_place(chunks, index, &p, error));
    ISO_TRY(open_file(chunks, &p, &file, error));
    *absent = is_absent(&file);
    if (*absent) return ISO_OK;
    iso_status status = find_part(chunks, &file, &p, &where, absent, error);
    if (status == ISO_OK && !*absent)
        status = load_chunk(chunks, &file, &p, where, &encoded, &size, absent, error);
    if (status == ISO_OK && !*absent)
        status = decode_chunk(chunks, &p, encoded.data ? encoded.data : "", size, target, error);
    iso_buffer_free(&encoded);
    close_file(&file);
    return status;
}

void iso_zarr_list_files(iso_zarr_chunks *chunks, uint64_t most, iso_file_set *files) {
    const iso_zarr_array *array = &chunks->array;
    uint64_t counts[ISO_ZARR_AXES] = {0}, index[ISO_ZARR_AXES] = {0}, all = 1;
    if (chunks->remote) return;
    for (int axis = 0; axis < array->axes; axis++) {
        counts[axis] = (array->shape[axis] - 1) / array->shard[axis] + 1;
        if (__builtin_mul_overflow(all, counts[axis], &all) || all > most) return;
    }
    for (uint64_t number = 0; number < all; number++) {
        place p;
        uint64_t rest = number;
        for (int axis = array->axes - 1; axis >= 0; axis--) {
            index[axis] = rest % counts[axis] * (array->shard[axis] / array->chunk[axis]);
            rest /= counts[axis];
        }
        if (find_place(chunks, index, &p, NULL) == ISO_OK && access(p.path, F_OK) == 0)
            iso_file_set_read(files, p.path);
    }
}
