/* exr: writes and reads OpenEXR pictures with the library's C API (OpenEXRCore). The library reads and writes
 * through callbacks on a file descriptor that this file opens. */
#include "image/exr.h"

#include <errno.h>
#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <openexr.h>

#include "base/file.h"
#include "base/memory.h"
#include "base/text.h"

bool iso_exr_available(void) {
    return true;
}

/* ---- channels */

/* The channels of an aov. Those from LAYERS_CHANNEL on are optional; those from ID_CHANNELS on are
 * integers. */
enum { LAYERS_CHANNEL = ISO_AOV_PLANES, ID_CHANNELS, CHANNELS = ID_CHANNELS + ISO_ID_PLANES };
static const char *const channel_names[CHANNELS] = {"A",      "N.X",        "N.Y",        "N.Z",       "Z",
                                                    "layers", "id.surface", "id.element", "id.segment"};

/* Bytes of a value in memory, float or integer. */
enum { VALUE = 4 };

/* Returns the plane of a channel; NULL: the aov does not have it. */
static char *plane_of(const iso_aov *aov, int channel) {
    float *const planes[ID_CHANNELS] = {aov->coverage,  aov->normal[0], aov->normal[1],
                                        aov->normal[2], aov->depth,     aov->layers};
    return channel < ID_CHANNELS ? (char *)planes[channel] : (char *)aov->ids[channel - ID_CHANNELS];
}

static exr_pixel_type_t type_of(int channel) {
    return channel < ID_CHANNELS ? EXR_PIXEL_FLOAT : EXR_PIXEL_UINT;
}

/* The channels of a picture of colours: R, G and B. */
enum { COLORS = 3 };
static const char *const color_names[COLORS] = {"R", "G", "B"};

/* Returns the index of a name among `count` names; -1: it is not among them. */
static int channel_number(const char *const *names, int count, const char *name) {
    for (int i = 0; i < count; i++)
        if (strcmp(name, names[i]) == 0) return i;
    return -1;
}

/* ---- the file: a descriptor, and the first error */

/* Thread-safe. */
typedef struct exr_file {
    int descriptor;
    pthread_mutex_t mutex;
    exr_result_t code; /* EXR_ERR_SUCCESS as long as there was no error */
    int system_code;   /* errno of a failed read or write, else 0 */
    char text[160];
} exr_file;

/* The file that this thread works on. */
static _Thread_local exr_file *current_file;

static void file_open(exr_file *file, int descriptor) {
    current_file = file;
    *file = (exr_file){.descriptor = descriptor};
    pthread_mutex_init(&file->mutex, NULL);
}

static void file_close(exr_file *file) {
    current_file = NULL;
    pthread_mutex_destroy(&file->mutex);
}

/* Records the first error. Later errors are ignored, because they follow from it. */
static void record_error(exr_file *file, exr_result_t code, int system_code, const char *text) {
    pthread_mutex_lock(&file->mutex);
    if (system_code && !file->system_code) file->system_code = system_code;
    if (file->code == EXR_ERR_SUCCESS) {
        file->code = code;
        snprintf(file->text, sizeof file->text, "%s", text);
    }
    pthread_mutex_unlock(&file->mutex);
}

/* Records the error of a library call; returns whether the call succeeded. */
static bool succeeded(exr_file *file, exr_result_t code) {
    if (code == EXR_ERR_SUCCESS) return true;
    record_error(file, code, 0, exr_get_default_error_message(code));
    return false;
}

static bool has_failed(exr_file *file) {
    pthread_mutex_lock(&file->mutex);
    bool failed = file->code != EXR_ERR_SUCCESS;
    pthread_mutex_unlock(&file->mutex);
    return failed;
}

static const char *reason_of(const exr_file *file) {
    return file->system_code ? strerror(file->system_code) : file->text;
}

/* The library may hold its context's lock, for which exr_get_user_data would wait. */
static void on_error(exr_const_context_t context, exr_result_t code, const char *text) {
    (void)context;
    exr_file *file = current_file;
    if (!file) return;
    char line[sizeof file->text];
    snprintf(line, sizeof line, "%s", text ? text : exr_get_default_error_message(code));
    for (char *c = line; *c; c++)
        if (*c == '\n') *c = ' ';
    record_error(file, code, 0, line);
}

static int64_t read_at(exr_const_context_t context, void *data, void *buffer, uint64_t size, uint64_t offset,
                       exr_stream_error_func_ptr_t fail) {
    (void)context;
    (void)fail;
    exr_file *file = data;
    uint64_t done = 0;
    while (done < size) {
        ssize_t got = pread(file->descriptor, (char *)buffer + done, size - done, (off_t)(offset + done));
        if (got < 0 && errno == EINTR) continue;
        if (got < 0) record_error(file, EXR_ERR_READ_IO, errno, "cannot read");
        if (got < 0) return -1;
        if (got == 0) break;
        done += (uint64_t)got;
    }
    return (int64_t)done;
}

static int64_t write_at(exr_const_context_t context, void *data, const void *buffer, uint64_t size,
                        uint64_t offset, exr_stream_error_func_ptr_t fail) {
    (void)context;
    (void)fail;
    exr_file *file = data;
    uint64_t done = 0;
    while (done < size) {
        ssize_t put =
            pwrite(file->descriptor, (const char *)buffer + done, size - done, (off_t)(offset + done));
        if (put < 0 && errno == EINTR) continue;
        if (put <= 0) {
            record_error(file, EXR_ERR_WRITE_IO, put < 0 ? errno : EIO, "cannot write");
            return -1;
        }
        done += (uint64_t)put;
    }
    return (int64_t)done;
}

static int64_t file_size(exr_const_context_t context, void *data) {
    (void)context;
    const exr_file *file = data;
    struct stat info;
    return fstat(file->descriptor, &info) == 0 && S_ISREG(info.st_mode) ? (int64_t)info.st_size : -1;
}

/* The library writes other bytes, or says that data are corrupt, where it gets no memory. */
static void *allocate(size_t bytes) {
    void *block = malloc(bytes);
    if (!block && current_file) succeeded(current_file, EXR_ERR_OUT_OF_MEMORY);
    return block;
}

static exr_context_initializer_t initializer_for(exr_file *file) {
    exr_context_initializer_t initializer = EXR_DEFAULT_CONTEXT_INITIALIZER;
    initializer.alloc_fn = allocate;
    initializer.free_fn = free;
    initializer.error_handler_fn = on_error;
    initializer.user_data = file;
    initializer.read_fn = read_at;
    initializer.write_fn = write_at;
    initializer.size_fn = file_size;
    initializer.flags = EXR_CONTEXT_FLAG_DISABLE_CHUNK_RECONSTRUCTION;
    return initializer;
}

/* ---- writing: chunks of 16 rows are compressed by all threads and written in order */

typedef struct writer {
    exr_context_t context;
    const iso_aov *aov;
    exr_file file;
    int rows;                         /* of a chunk */
    exr_encode_pipeline_t *pipelines; /* one for each slot of iso_parallel_ordered */
} writer;

static void set_encode_planes(const writer *w, exr_encode_pipeline_t *pipeline) {
    for (int i = 0; i < pipeline->channel_count; i++) {
        exr_coding_channel_info_t *channel = &pipeline->channels[i];
        const int number = channel_number(channel_names, CHANNELS, channel->channel_name);
        const size_t first = (size_t)pipeline->chunk.start_y * (size_t)w->aov->width;
        channel->encode_from_ptr = (const uint8_t *)(plane_of(w->aov, number) + VALUE * first);
        channel->user_pixel_stride = VALUE;
        channel->user_line_stride = VALUE * w->aov->width;
        channel->user_bytes_per_element = VALUE;
        channel->user_data_type = (uint16_t)type_of(number);
    }
}

static exr_result_t encode_chunk(const writer *w, exr_encode_pipeline_t *pipeline) {
    set_encode_planes(w, pipeline);
    exr_result_t result = exr_encoding_choose_default_routines(w->context, 0, pipeline);
    if (result != EXR_ERR_SUCCESS) return result;
    /* without the pipeline's last step, writing, which would be out of order: write_chunk does it */
    pipeline->yield_until_ready_fn = NULL;
    pipeline->write_fn = NULL;
    return exr_encoding_run(w->context, 0, pipeline);
}

/* The three callbacks of iso_parallel_ordered. After an error they do nothing. */

static void compress_chunk(void *context, size_t index, size_t slot, int worker) {
    (void)worker;
    writer *w = context;
    current_file = &w->file;
    exr_encode_pipeline_t *pipeline = &w->pipelines[slot];
    exr_chunk_info_t chunk;
    int y = (int)index * w->rows;
    if (!has_failed(&w->file) &&
        succeeded(&w->file, exr_write_scanline_chunk_info(w->context, 0, y, &chunk)) &&
        succeeded(&w->file, exr_encoding_initialize(w->context, 0, &chunk, pipeline)))
        succeeded(&w->file, encode_chunk(w, pipeline));
}

static bool write_chunk(void *context, size_t slot, bool alone) {
    (void)alone;
    writer *w = context;
    const exr_encode_pipeline_t *pipeline = &w->pipelines[slot];
    /* Values that compression does not make smaller are written as they are; readers tell by the size. The
     * library, up to 3.4.7, compresses those whose size stays just the same (openexr issue 2306). */
    const bool smaller = pipeline->compressed_bytes < pipeline->packed_bytes;
    const void *data = smaller ? pipeline->compressed_buffer : pipeline->packed_buffer;
    const uint64_t bytes = smaller ? pipeline->compressed_bytes : pipeline->packed_bytes;
    if (!has_failed(&w->file))
        succeeded(&w->file, exr_write_scanline_chunk(w->context, 0, pipeline->chunk.start_y, data, bytes));
    return true;
}

static void free_chunk(void *context, size_t slot) {
    writer *w = context;
    exr_encoding_destroy(w->context, &w->pipelines[slot]);
}

static void write_chunks(writer *w, iso_pool *pool) {
    size_t chunks = ((size_t)w->aov->height + (size_t)w->rows - 1) / (size_t)w->rows;
    /* one slot for each thread; more would take more memory without being faster */
    iso_ordered steps = {.work = compress_chunk,
                         .place = write_chunk,
                         .finish = free_chunk,
                         .slots = (size_t)iso_pool_threads(pool)};
    w->pipelines = iso_alloc_zero(steps.slots, sizeof *w->pipelines);
    if (w->pipelines)
        iso_parallel_ordered(pool, chunks, &steps, w);
    else
        succeeded(&w->file, EXR_ERR_OUT_OF_MEMORY);
    iso_free(w->pipelines);
}

/* The matrices of the standard attributes, which multiply row vectors from the right. In OpenEXR's camera
 * space y points up, in iso_view's down. */
static void view_matrices(const iso_view *view, exr_attr_m44f_t *to_camera, exr_attr_m44f_t *to_ndc) {
    double rows[3][4]; /* view x, y, z of a world point */
    for (int i = 0; i < 3; i++) {
        const double *r = view->rotation + 3 * i;
        memcpy(rows[i], r, 3 * sizeof *r);
        rows[i][3] = -(r[0] * view->eye.x + r[1] * view->eye.y + r[2] * view->eye.z);
    }
    for (int j = 0; j < 4; j++) {
        double one = j == 3, w = view->orthographic ? one : rows[2][j];
        const double camera[4] = {rows[0][j], -rows[1][j], rows[2][j], one};
        const double ndc[4] = {(view->focal * rows[0][j] + view->cx * w) / view->width,
                               (view->focal * rows[1][j] + view->cy * w) / view->height, rows[2][j], w};
        for (int i = 0; i < 4; i++) {
            to_camera->m[4 * j + i] = (float)camera[i];
            to_ndc->m[4 * j + i] = (float)ndc[i];
        }
    }
}

static bool set_info(writer *w, const iso_exr_info *info) {
    exr_file *s = &w->file;
    exr_context_t c = w->context;
    if (info->software && !succeeded(s, exr_attr_set_string(c, 0, "software", info->software))) return false;
    char *comments = info->comments ? iso_text_clean_copy(info->comments) : NULL;
    bool written = !comments || succeeded(s, exr_attr_set_string(c, 0, "comments", comments));
    free(comments);
    if (!written) return false;
    if (!info->view) return true;
    exr_attr_m44f_t to_camera, to_ndc;
    view_matrices(info->view, &to_camera, &to_ndc);
    return succeeded(s, exr_attr_set_m44f(c, 0, "worldToCamera", &to_camera)) &&
           succeeded(s, exr_attr_set_m44f(c, 0, "worldToNDC", &to_ndc));
}

static bool write_header(writer *w, const iso_exr_info *info) {
    enum { LEVEL = 1 }; /* zlib's; level 9 makes files 2 % smaller and takes three times as long */
    exr_file *s = &w->file;
    exr_context_t c = w->context;
    if (!succeeded(s, exr_add_part(c, NULL, EXR_STORAGE_SCANLINE, NULL)) ||
        !succeeded(s, exr_initialize_required_attr_simple(c, 0, w->aov->width, w->aov->height,
                                                          EXR_COMPRESSION_ZIP)) ||
        !succeeded(s, exr_set_zip_compression_level(c, 0, LEVEL)))
        return false;
    for (int i = 0; i < CHANNELS; i++)
        if (plane_of(w->aov, i) &&
            !succeeded(s, exr_add_channel(c, 0, channel_names[i], type_of(i), EXR_PERCEPTUALLY_LINEAR, 1, 1)))
            return false;
    if (!succeeded(s, exr_attr_set_float(c, 0, "isopointVoxel", w->aov->voxel))) return false;
    if (info && !set_info(w, info)) return false;
    return succeeded(s, exr_write_header(c)) && succeeded(s, exr_get_scanlines_per_chunk(c, 0, &w->rows));
}

static bool write_all(writer *w, const char *path, const iso_exr_info *info, iso_pool *pool) {
    exr_context_initializer_t initializer = initializer_for(&w->file);
    if (!succeeded(&w->file, exr_start_write(&w->context, path, EXR_WRITE_FILE_DIRECTLY, &initializer)))
        return false;
    if (write_header(w, info)) write_chunks(w, pool);
    succeeded(&w->file, exr_finish(&w->context)); /* writes the table of chunks */
    return !has_failed(&w->file);
}

iso_status iso_exr_write(const char *path, const iso_aov *aov, const iso_exr_info *info, iso_pool *pool,
                         iso_error *error) {
    if (strcmp(path, "-") == 0)
        return iso_fail(error, ISO_ERR_USAGE, "an OpenEXR picture cannot go to standard output");
    iso_sink sink;
    ISO_TRY(iso_sink_open(path, &sink, error));
    writer w = {.aov = aov};
    file_open(&w.file, fileno(sink.stream));
    iso_status status = ISO_OK;
    if (!write_all(&w, path, info, pool)) {
        /* Nothing is decoded here: CORRUPT_CHUNK is what the library makes of zlib's having no memory. */
        const exr_result_t code = w.file.code;
        if (code == EXR_ERR_OUT_OF_MEMORY || code == EXR_ERR_CORRUPT_CHUNK)
            status = iso_fail_memory(error, path);
        else
            status = iso_fail(error, ISO_ERR_WRITE, "%s: cannot write: %s", path, reason_of(&w.file));
        iso_sink_abort(&sink);
    }
    file_close(&w.file);
    return status == ISO_OK ? iso_sink_commit(&sink, error) : status;
}

/* ---- reading: the file may be damaged or hostile. The header is checked before memory is allocated, each
 * chunk is checked against the data window, and the values are checked last. */

typedef struct reader {
    const char *path;
    exr_context_t context;
    exr_file file;
    int first_y, rows; /* first row of the data window; rows of a chunk */
    int width, height; /* of the data window */
    /* The channels that are read: the first `needed` of them must be there. */
    const char *const *names;
    int name_count, needed;
    bool found[CHANNELS];
    char *planes[CHANNELS]; /* pixel 0 of each channel; NULL: not read */
    int stride;             /* bytes from pixel to pixel */
} reader;

static iso_status fail_reading(reader *r, iso_error *error) {
    if (r->file.code == EXR_ERR_OUT_OF_MEMORY) return iso_fail_memory(error, r->path);
    if (r->file.system_code)
        return iso_fail(error, ISO_ERR_IO, "%s: cannot read: %s", r->path, reason_of(&r->file));
    return iso_fail(error, ISO_ERR_FORMAT, "%s: not a readable OpenEXR picture: %s", r->path,
                    reason_of(&r->file));
}

static iso_status check_storage(reader *r, iso_error *error) {
    exr_storage_t storage;
    exr_compression_t compression;
    if (!succeeded(&r->file, exr_get_storage(r->context, 0, &storage)) ||
        !succeeded(&r->file, exr_get_compression(r->context, 0, &compression)))
        return fail_reading(r, error);
    if (storage != EXR_STORAGE_SCANLINE)
        return iso_fail(error, ISO_ERR_FORMAT, "%s: tiled or deep: only scanline pictures are read", r->path);
    if (compression != EXR_COMPRESSION_NONE && compression != EXR_COMPRESSION_RLE &&
        compression != EXR_COMPRESSION_ZIPS && compression != EXR_COMPRESSION_ZIP)
        return iso_fail(error, ISO_ERR_FORMAT,
                        "%s: only the compressions none, RLE, ZIPS and ZIP are read, not number %d", r->path,
                        (int)compression);
    return ISO_OK;
}

static iso_status check_channel(const reader *r, const exr_attr_chlist_entry_t *channel, iso_error *error) {
    if (channel->pixel_type != EXR_PIXEL_FLOAT && channel->pixel_type != EXR_PIXEL_HALF)
        return iso_fail(error, ISO_ERR_FORMAT, "%s: channel %s holds integers", r->path, channel->name.str);
    if (channel->x_sampling != 1 || channel->y_sampling != 1)
        return iso_fail(error, ISO_ERR_FORMAT, "%s: channel %s is subsampled", r->path, channel->name.str);
    return ISO_OK;
}

static bool is_id(const exr_attr_chlist_entry_t *channel) {
    return channel->pixel_type == EXR_PIXEL_UINT && channel->x_sampling == 1 && channel->y_sampling == 1;
}

static iso_status fail_missing(const reader *r, int channel, iso_error *error) {
    return iso_fail(error, ISO_ERR_FORMAT, "%s: channel %s is missing (%s are needed)", r->path,
                    r->names[channel], r->names == color_names ? "R, G and B" : "A, N.X, N.Y, N.Z and Z");
}

static iso_status check_channels(reader *r, iso_error *error) {
    const exr_attr_chlist_t *list;
    if (!succeeded(&r->file, exr_get_channels(r->context, 0, &list))) return fail_reading(r, error);
    for (int i = 0; i < list->num_channels; i++) {
        int channel = channel_number(r->names, r->name_count, list->entries[i].name.str);
        if (channel < 0) continue;
        r->found[channel] = channel < ID_CHANNELS || is_id(&list->entries[i]);
        if (channel < ID_CHANNELS) ISO_TRY(check_channel(r, &list->entries[i], error));
    }
    for (int i = 0; i < r->needed; i++)
        if (!r->found[i]) return fail_missing(r, i, error);
    return ISO_OK;
}

static iso_status read_window(reader *r, iso_error *error) {
    exr_attr_box2i_t window;
    if (!succeeded(&r->file, exr_get_data_window(r->context, 0, &window)) ||
        !succeeded(&r->file, exr_get_scanlines_per_chunk(r->context, 0, &r->rows)))
        return fail_reading(r, error);
    int64_t wide = (int64_t)window.max.x - window.min.x + 1, high = (int64_t)window.max.y - window.min.y + 1;
    if (wide < 1 || high < 1 || wide > ISO_IMAGE_MAX || high > ISO_IMAGE_MAX)
        return iso_fail(error, ISO_ERR_FORMAT, "%s: %lldx%lld pixels, sides must be 1..%d", r->path,
                        (long long)wide, (long long)high, ISO_IMAGE_MAX);
    if (r->rows < 1) /* the library returns this for some damaged headers */
        return iso_fail(error, ISO_ERR_FORMAT, "%s: not a readable OpenEXR picture: chunks without rows",
                        r->path);
    r->first_y = window.min.y;
    r->width = (int)wide;
    r->height = (int)high;
    return ISO_OK;
}

static void set_decode_planes(const reader *r, size_t row, exr_decode_pipeline_t *pipeline) {
    const int line = r->stride * r->width;
    for (int i = 0; i < pipeline->channel_count; i++) {
        exr_coding_channel_info_t *channel = &pipeline->channels[i];
        int plane = channel_number(r->names, r->name_count, channel->channel_name);
        if (plane < 0 || !r->planes[plane]) continue;
        channel->decode_to_ptr = (uint8_t *)(r->planes[plane] + row * (size_t)line);
        channel->user_pixel_stride = r->stride;
        channel->user_line_stride = line;
        channel->user_bytes_per_element = VALUE;
        channel->user_data_type = (uint16_t)type_of(plane);
    }
}

static exr_result_t decode_chunk(const reader *r, size_t row, exr_decode_pipeline_t *pipeline) {
    set_decode_planes(r, row, pipeline);
    exr_result_t result = exr_decoding_choose_default_routines(r->context, 0, pipeline);
    return result == EXR_ERR_SUCCESS ? exr_decoding_run(r->context, 0, pipeline) : result;
}

static void read_chunk(void *context, size_t index, int worker) {
    (void)worker;
    reader *r = context;
    current_file = &r->file;
    exr_chunk_info_t chunk;
    size_t row = index * (size_t)r->rows, left = (size_t)r->height - row;
    if (has_failed(&r->file) ||
        !succeeded(&r->file, exr_read_scanline_chunk_info(r->context, 0, r->first_y + (int)row, &chunk)))
        return;
    if (chunk.start_y != r->first_y + (int)row || chunk.width != r->width ||
        chunk.height != (int)(left < (size_t)r->rows ? left : (size_t)r->rows)) {
        succeeded(&r->file, EXR_ERR_BAD_CHUNK_LEADER);
        return;
    }
    exr_decode_pipeline_t pipeline = EXR_DECODE_PIPELINE_INITIALIZER;
    if (!succeeded(&r->file, exr_decoding_initialize(r->context, 0, &chunk, &pipeline))) return;
    succeeded(&r->file, decode_chunk(r, row, &pipeline));
    exr_decoding_destroy(r->context, &pipeline);
}

/* Checks the values of a pixel; replaces those of an uncovered one. */
static bool check_pixel(iso_aov *aov, size_t pixel) {
    float *normal[3] = {aov->normal[0] + pixel, aov->normal[1] + pixel, aov->normal[2] + pixel};
    float coverage = aov->coverage[pixel];
    if (coverage == 0) {
        aov->coverage[pixel] = 0; /* replaces -0 */
        aov->depth[pixel] = INFINITY;
        for (int axis = 0; axis < 3; axis++) *normal[axis] = 0;
        for (int i = 0; aov->ids[0] && i < ISO_ID_PLANES; i++) aov->ids[i][pixel] = 0;
        return true;
    }
    if (aov->layers && !(aov->layers[pixel] >= 0 && isfinite(aov->layers[pixel]))) return false;
    return coverage > 0 && coverage <= 1 && isfinite(aov->depth[pixel]) && isfinite(*normal[0]) &&
           isfinite(*normal[1]) && isfinite(*normal[2]);
}

static iso_status check_values(const reader *r, iso_aov *aov, iso_error *error) {
    size_t width = (size_t)aov->width, count = width * (size_t)aov->height;
    for (size_t i = 0; i < count; i++)
        if (!check_pixel(aov, i))
            return iso_fail(error, ISO_ERR_FORMAT,
                            "%s: pixel %zu,%zu: coverage %g with depth %g and normal %g %g %g", r->path,
                            i % width, i / width, (double)aov->coverage[i], (double)aov->depth[i],
                            (double)aov->normal[0][i], (double)aov->normal[1][i], (double)aov->normal[2][i]);
    return ISO_OK;
}

static float read_voxel(const reader *r) {
    const exr_attribute_t *attribute;
    if (exr_get_attribute_by_name(r->context, 0, "isopointVoxel", &attribute) != EXR_ERR_SUCCESS ||
        attribute->type != EXR_ATTR_FLOAT)
        return 0;
    return attribute->f > 0 && isfinite(attribute->f) ? attribute->f : 0;
}

/* Reads all chunks into r->planes. */
static iso_status read_chunks(reader *r, iso_pool *pool, iso_error *error) {
    const size_t chunks = ((size_t)r->height + (size_t)r->rows - 1) / (size_t)r->rows;
    iso_parallel_for(pool, chunks, read_chunk, r);
    return has_failed(&r->file) ? fail_reading(r, error) : ISO_OK;
}

static iso_status read_planes(reader *r, iso_pool *pool, iso_aov *aov, iso_error *error) {
    bool ids = true;
    for (int i = 0; i < ISO_ID_PLANES; i++) ids &= r->found[ID_CHANNELS + i];
    if (r->found[LAYERS_CHANNEL]) ISO_TRY(iso_aov_add_layers(aov, error));
    if (ids) ISO_TRY(iso_aov_add_ids(aov, error));
    for (int i = 0; i < CHANNELS; i++) r->planes[i] = plane_of(aov, i);
    r->stride = VALUE;
    ISO_TRY(read_chunks(r, pool, error));
    return check_values(r, aov, error);
}

static iso_status read_aov(reader *r, iso_pool *pool, void *out, iso_error *error) {
    iso_aov aov = {0};
    ISO_TRY(iso_aov_create(r->width, r->height, &aov, error));
    aov.voxel = read_voxel(r);
    const iso_status status = read_planes(r, pool, &aov, error);
    if (status == ISO_OK)
        *(iso_aov *)out = aov;
    else
        iso_aov_free(&aov);
    return status;
}

static iso_status read_colors(reader *r, iso_pool *pool, void *out, iso_error *error) {
    float *rgb = iso_alloc((size_t)r->width * (size_t)r->height * COLORS * sizeof *rgb);
    if (!rgb) return iso_fail_memory(error, r->path);
    for (int i = 0; i < COLORS; i++) r->planes[i] = (char *)(rgb + i);
    r->stride = COLORS * VALUE;
    const iso_status status = read_chunks(r, pool, error);
    if (status == ISO_OK)
        *(iso_float_image *)out = (iso_float_image){r->width, r->height, rgb};
    else
        iso_free(rgb);
    return status;
}

/* Reads the picture of an open file whose header has been checked. */
typedef iso_status read_fn(reader *r, iso_pool *pool, void *out, iso_error *error);

static iso_status read_checked(reader *r, read_fn *read, iso_pool *pool, void *out, iso_error *error) {
    ISO_TRY(check_storage(r, error));
    ISO_TRY(check_channels(r, error));
    ISO_TRY(read_window(r, error));
    return read(r, pool, out, error);
}

/* Opens the file of `r`, reads its picture into *out, and closes it. */
static iso_status read_file(reader *r, read_fn *read, iso_pool *pool, void *out, iso_error *error) {
    FILE *stream;
    ISO_TRY(iso_file_open(r->path, &stream, NULL, error));
    file_open(&r->file, fileno(stream));
    exr_context_initializer_t initializer = initializer_for(&r->file);
    iso_status status;
    if (succeeded(&r->file, exr_start_read(&r->context, r->path, &initializer)))
        status = read_checked(r, read, pool, out, error);
    else
        status = fail_reading(r, error);
    if (r->context) exr_finish(&r->context);
    file_close(&r->file);
    fclose(stream);
    return status;
}

iso_status iso_exr_read(const char *path, iso_pool *pool, iso_aov *aov, iso_error *error) {
    reader r = {.path = path, .names = channel_names, .name_count = CHANNELS, .needed = ISO_AOV_PLANES};
    return read_file(&r, read_aov, pool, aov, error);
}

iso_status iso_exr_read_color(const char *path, iso_pool *pool, iso_float_image *image, iso_error *error) {
    reader r = {.path = path, .names = color_names, .name_count = COLORS, .needed = COLORS};
    return read_file(&r, read_colors, pool, image, error);
}

bool iso_exr_size(const char *path, uint32_t size[2]) {
    FILE *stream;
    if (iso_file_open(path, &stream, NULL, NULL) != ISO_OK) return false;
    reader r = {.path = path};
    file_open(&r.file, fileno(stream));
    exr_context_initializer_t initializer = initializer_for(&r.file);
    const bool found =
        succeeded(&r.file, exr_start_read(&r.context, path, &initializer)) && read_window(&r, NULL) == ISO_OK;
    if (r.context) exr_finish(&r.context);
    file_close(&r.file);
    fclose(stream);
    size[0] = (uint32_t)r.width;
    size[1] = (uint32_t)r.height;
    return found;
}
