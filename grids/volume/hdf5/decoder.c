/* decoder: chunks that libhdf5 decodes and converts, for filters and types that chunk.c does not know.
 *
 * A child process opens the array once and stays. It is asked for one chunk at a time over a socket, and
 * leaves the values in shared memory. When it ends, because libhdf5 crashes or takes too long, the chunk that
 * was asked for is damaged; a new process is started for the next one. */
#include <errno.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include "grids/volume/hdf5/types.h"

/* What both processes see. The parent trusts nothing in it. */
typedef struct answer {
    int finished;
    int index[3]; /* of the chunk that is asked for */
    iso_status status;
    iso_error error;
    _Alignas(16) unsigned char values[];
} answer;

struct iso_hdf5_decoder {
    const iso_hdf5_source *source;
    pthread_mutex_t lock;
    iso_hdf5_child child;
    int ends[2]; /* of the socket: the parent's and the child's */
    answer *shared;
};

static size_t shared_bytes(const iso_hdf5_array *array) {
    return sizeof(answer) + (size_t)iso_hdf5_chunk_bytes(array);
}

/* libhdf5 has a chunk as it is stored, unpacked, and on its way between two filters. */
uint64_t iso_hdf5_decoder_bytes(const iso_hdf5_array *array) {
    uint64_t bytes;
    return __builtin_mul_overflow(iso_hdf5_chunk_bytes(array), 4, &bytes) ? UINT64_MAX : bytes;
}

/* One byte asks for a chunk, and another one says that it is there. */
static bool send_byte(int end) {
    ssize_t sent;
    do sent = send(end, "", 1, MSG_NOSIGNAL);
    while (sent < 0 && errno == EINTR);
    return sent == 1;
}

static bool receive_byte(int end) {
    char byte;
    ssize_t got;
    do got = recv(end, &byte, 1, 0);
    while (got < 0 && errno == EINTR);
    return got == 1;
}

/* ---- in the child ---- */

typedef struct open_array {
    iso_hdf5_file file;
    hid_t dataset, type;
} open_array;

static iso_status open_dataset(const iso_hdf5_source *source, open_array *opened, iso_error *error) {
    ISO_TRY(iso_hdf5_open(source->path, &opened->file, error));
    const hid_t access = H5Pcreate(H5P_DATASET_ACCESS);
    H5Pset_chunk_cache(access, 0, 0, H5D_CHUNK_CACHE_W0_DEFAULT); /* no chunk is needed twice */
    opened->dataset = H5Dopen2(opened->file.id, source->array.path, access);
    opened->type = opened->dataset < 0 ? -1 : iso_hdf5_memory_type(opened->dataset);
    return opened->type >= 0 && H5Tget_size(opened->type) == source->array.element_bytes
               ? ISO_OK
               : iso_hdf5_fail(&opened->file, source->array.path, error);
}

/* Reads the part of a chunk that lies in the array. */
static iso_status read_values(const iso_hdf5_source *source, const open_array *opened, const int index[3],
                              void *values, iso_error *error) {
    const iso_hdf5_array *array = &source->array;
    char name[ISO_HDF5_CHUNK_NAME];
    uint64_t first[ISO_HDF5_AXES];
    hsize_t start[ISO_HDF5_AXES], count[ISO_HDF5_AXES], chunk[ISO_HDF5_AXES], zero[ISO_HDF5_AXES] = {0};
    iso_hdf5_chunk_start(array, index, first);
    for (int axis = 0; axis < array->rank; axis++) {
        const uint64_t left = array->sizes[axis] - first[axis];
        start[axis] = first[axis];
        chunk[axis] = array->chunk[axis];
        count[axis] = left < chunk[axis] ? left : chunk[axis];
    }
    const hid_t in_file = H5Dget_space(opened->dataset),
                in_memory = H5Screate_simple(array->rank, chunk, NULL);
    const bool is_read = H5Sselect_hyperslab(in_file, H5S_SELECT_SET, start, NULL, count, NULL) >= 0 &&
                         H5Sselect_hyperslab(in_memory, H5S_SELECT_SET, zero, NULL, count, NULL) >= 0 &&
                         H5Dread(opened->dataset, opened->type, in_memory, in_file, H5P_DEFAULT, values) >= 0;
    iso_hdf5_name_chunk(array, index, name);
    iso_status status = is_read ? ISO_OK : iso_hdf5_fail(&opened->file, name, error);
    if (status == ISO_ERR_LIMIT) /* the process has memory for every chunk of this size */
        status = iso_fail(error, ISO_ERR_IO, "%s: %s: damaged: it needs too much memory", source->path, name);
    H5Sclose(in_memory);
    H5Sclose(in_file);
    return status;
}

/* The processor time that is allowed for a chunk. */
static int seconds_for(const iso_hdf5_array *array) {
    return 3 + (int)(iso_hdf5_chunk_bytes(array) >> 23);
}

/* Answers until the parent closes its end. Files and sockets of the parent are closed, because nobody expects
 * that they stay open for longer than the parent lives. */
static void decode_chunks(void *context) {
    const iso_hdf5_decoder *decoder = context;
    const iso_hdf5_source *source = decoder->source;
    answer *shared = decoder->shared;
    const int end = dup2(decoder->ends[1], STDERR_FILENO + 1);
    open_array opened;
    iso_error error = {0};
    close_range((unsigned)end + 1, ~0u, 0);
    const iso_status status = open_dataset(source, &opened, &error);
    while (receive_byte(end)) {
        iso_hdf5_allow_seconds(seconds_for(&source->array));
        shared->status = status;
        shared->error = error;
        if (status == ISO_OK)
            shared->status = read_values(source, &opened, shared->index, shared->values, &shared->error);
        if (!send_byte(end)) return;
    }
}

/* ---- in the parent ---- */

static iso_status start_process(iso_hdf5_decoder *decoder, iso_error *error) {
    const char *path = decoder->source->path;
    if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, decoder->ends) != 0)
        return iso_fail(error, ISO_ERR_NOMEM, "%s: no process can be started to read it: %s", path,
                        strerror(errno));
    const iso_status status = iso_hdf5_start_child(path, &decoder->child, error);
    close(decoder->ends[1]);
    if (status != ISO_OK) close(decoder->ends[0]);
    return status;
}

/* Ends the process, or finds out why it has ended. */
static void end_process(iso_hdf5_decoder *decoder, char reason[ISO_HDF5_SPECIAL]) {
    if (!decoder->child.id) return;
    close(decoder->ends[0]);
    iso_hdf5_end_child(&decoder->child, reason);
}

iso_status iso_hdf5_decoder_create(const iso_hdf5_source *source, iso_hdf5_decoder **decoder,
                                   iso_error *error) {
    enum { LIBRARY_BYTES = 64 << 20 }; /* for libhdf5 itself, and what it keeps of the file's structure */
    iso_hdf5_decoder *d = calloc(1, sizeof *d);
    if (!d) return iso_fail_memory(error, source->path);
    *decoder = d; /* the caller destroys it, also when starting fails */
    pthread_mutex_init(&d->lock, NULL);
    d->source = source;
    d->shared = iso_hdf5_share(shared_bytes(&source->array));
    if (!d->shared) return iso_fail_memory(error, source->path);
    d->child = (iso_hdf5_child){.work = decode_chunks,
                                .context = d,
                                .memory = LIBRARY_BYTES + iso_hdf5_decoder_bytes(&source->array),
                                .seconds = seconds_for(&source->array),
                                .stays = true,
                                .finished = &d->shared->finished};
    return start_process(d, error);
}

void iso_hdf5_decoder_destroy(iso_hdf5_decoder *decoder) {
    char reason[ISO_HDF5_SPECIAL];
    if (!decoder) return;
    end_process(decoder, reason);
    iso_hdf5_unshare(decoder->shared, shared_bytes(&decoder->source->array));
    pthread_mutex_destroy(&decoder->lock);
    free(decoder);
}

static iso_status fail_ended(iso_hdf5_decoder *decoder, const int index[3], iso_error *error) {
    char name[ISO_HDF5_CHUNK_NAME], reason[ISO_HDF5_SPECIAL] = "";
    end_process(decoder, reason);
    iso_hdf5_name_chunk(&decoder->source->array, index, name);
    return iso_fail(error, ISO_ERR_IO, "%s: %s: damaged: %s", decoder->source->path, name, reason);
}

static iso_status ask(iso_hdf5_decoder *decoder, const int index[3], iso_error *error) {
    answer *shared = decoder->shared;
    if (!decoder->child.id) ISO_TRY(start_process(decoder, error));
    memcpy(shared->index, index, sizeof shared->index);
    if (!send_byte(decoder->ends[0]) || !receive_byte(decoder->ends[0]))
        return fail_ended(decoder, index, error);
    const iso_status status = shared->status;
    shared->error.text[sizeof shared->error.text - 1] = 0;
    return status == ISO_OK ? ISO_OK : iso_fail(error, status, "%s", shared->error.text);
}

iso_status iso_hdf5_decode_chunk(iso_hdf5_decoder *decoder, const int index[3], void *values,
                                 iso_error *error) {
    pthread_mutex_lock(&decoder->lock);
    const iso_status status = ask(decoder, index, error);
    if (status == ISO_OK)
        memcpy(values, decoder->shared->values, (size_t)iso_hdf5_chunk_bytes(&decoder->source->array));
    pthread_mutex_unlock(&decoder->lock);
    return status;
}
