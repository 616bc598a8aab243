/* laz: a block of LASzip says what compressed the points, and the chunk table, which is coded itself, where
 * the chunks are. Facts of the format: ASPRS LAZ Specification 1.4 R1, and LASzip. */
#include "io/glyphs/laz.h"

#include <string.h>

#include "base/file.h"
#include "base/memory.h"

enum { POINTWISE = 1, POINTWISE_CHUNKED, LAYERED_CHUNKED };

#define CONVERT "pdal translate scan.laz scan.las, or laszip, converts it"

static iso_status damaged(const iso_laz *laz, const char *what, iso_error *error) {
    return iso_fail(error, ISO_ERR_IO, "%s: damaged: %s", laz->path, what);
}

static uint64_t number_at(const unsigned char *bytes, int count) {
    uint64_t number = 0;
    while (count > 0) number = number << 8 | bytes[--count];
    return number;
}

/* ---- the block of LASzip */

/* The bytes of an item; 0: any number. */
static size_t bytes_of(int type) {
    static const size_t bytes[] = {
        [ISO_LAZ_POINT10] = 20,      [ISO_LAZ_GPSTIME11] = 8,     [ISO_LAZ_RGB12] = 6,
        [ISO_LAZ_WAVEPACKET13] = 29, [ISO_LAZ_POINT14] = 30,      [ISO_LAZ_RGB14] = 6,
        [ISO_LAZ_RGBNIR14] = 8,      [ISO_LAZ_WAVEPACKET14] = 29, [ISO_LAZ_BYTES14] = 0};
    return bytes[type];
}

static bool is_known(int type) {
    return type == ISO_LAZ_BYTES || (type >= ISO_LAZ_POINT10 && type <= ISO_LAZ_BYTES14);
}

static iso_status check_item(const iso_laz *laz, const iso_laz_item *item, iso_error *error) {
    const bool layered = laz->compressor == LAYERED_CHUNKED;
    if (!is_known(item->type) || (item->type >= ISO_LAZ_POINT14) != layered ||
        (bytes_of(item->type) ? item->bytes != bytes_of(item->type) : item->bytes == 0))
        return damaged(laz, "what its points consist of", error);
    const bool pointwise = item->version == 1 || (item->version == 2 && item->type != ISO_LAZ_WAVEPACKET13);
    if (layered ? item->version == 3 || item->version == 4 : pointwise) return ISO_OK;
    return iso_fail(error, ISO_ERR_UNSUPPORTED,
                    "%s: version %d of compressed points (LAZ) is not read: " CONVERT, laz->path,
                    item->version);
}

/* Adds an item, of which there may be one of each kind; the first is the point itself. */
static iso_status add_item(iso_laz *laz, const iso_laz_item *item, iso_error *error) {
    iso_laz_layout *layout = &laz->layout;
    const int first = laz->compressor == LAYERED_CHUNKED ? ISO_LAZ_POINT14 : ISO_LAZ_POINT10;
    ISO_TRY(check_item(laz, item, error));
    bool again = layout->count == 0 && item->type != first;
    for (int i = 0; i < layout->count; i++) again |= layout->items[i].type == item->type;
    if (again) return damaged(laz, "what its points consist of", error);
    layout->items[layout->count++] = *item;
    layout->record += item->bytes;
    return ISO_OK;
}

static iso_status read_block(iso_laz *laz, const unsigned char *block, size_t bytes, size_t record,
                             iso_error *error) {
    enum { HEAD = 34, ITEM = 6 };
    const size_t count = bytes < HEAD ? 0 : (size_t)number_at(block + 32, 2);
    if (count < 1 || count > ISO_LAZ_ITEMS || bytes < HEAD + count * ITEM)
        return damaged(laz, "its block of LASzip", error);
    laz->compressor = (int)number_at(block, 2);
    laz->chunk_points = (uint32_t)number_at(block + 12, 4);
    const int coder = (int)number_at(block + 2, 2);
    if (laz->compressor < POINTWISE || laz->compressor > LAYERED_CHUNKED || coder != 0)
        return iso_fail(error, ISO_ERR_UNSUPPORTED,
                        "%s: compressor %d with coder %d of LAZ is not read: " CONVERT, laz->path,
                        laz->compressor, coder);
    for (const unsigned char *at = block + HEAD; at < block + HEAD + count * ITEM; at += ITEM) {
        const iso_laz_item item = {(int)number_at(at, 2), (int)number_at(at + 4, 2),
                                   (size_t)number_at(at + 2, 2)};
        ISO_TRY(add_item(laz, &item, error));
    }
    if (laz->layout.record != record) return damaged(laz, "what its points consist of", error);
    if (record > ISO_LAZ_RECORD)
        return iso_fail(error, ISO_ERR_UNSUPPORTED,
                        "%s: compressed points of more than %d bytes are not read", laz->path,
                        ISO_LAZ_RECORD);
    laz->decoder = laz->compressor == LAYERED_CHUNKED ? &iso_laz_layered : &iso_laz_pointwise;
    return ISO_OK;
}

/* ---- the chunk table */

/* More points than any encoder gets into so many bytes would take any memory. Each symbol that does not come
 * keeps 2^-15 of the interval, so that a point, three symbols at least of 33 and more, takes 0.007 bits. */
static bool can_hold(uint64_t bytes, uint64_t points, size_t record) {
    const uint64_t most = 8 * 256;
    return bytes >= record && (points - 1) / most <= bytes - record;
}

static iso_status add_chunk(iso_laz *laz, const iso_laz_chunk *chunk, iso_error *error) {
    if (chunk->points == 0) return ISO_OK;
    if (!can_hold(chunk->bytes, chunk->points, laz->layout.record))
        return damaged(laz, "a chunk is too short for its points", error);
    ((iso_laz_chunk *)laz->chunks.data)[laz->chunk_count++] = *chunk;
    return ISO_OK;
}

/* Where the chunk table is; some writers say it at the end of the file. */
static iso_status find_table(const iso_laz *laz, uint64_t begin, uint64_t *table, iso_error *error) {
    const unsigned char *file = iso_mapping_data(laz->mapping);
    if (begin > laz->size || laz->size - begin < 16)
        return iso_fail(error, ISO_ERR_IO, "%s: truncated: its points are missing", laz->path);
    *table = number_at(file + begin, 8);
    if (*table == UINT64_MAX) *table = number_at(file + laz->size - 8, 8);
    if (*table == begin) return damaged(laz, "its chunk table was not written", error);
    if (*table < begin + 8) return damaged(laz, "the place of its chunk table", error);
    if (*table > laz->size - 8)
        return iso_fail(error, ISO_ERR_IO, "%s: truncated: its chunk table is missing", laz->path);
    return number_at(file + *table, 4) == 0 ? ISO_OK : damaged(laz, "its chunk table", error);
}

typedef struct table_coder {
    iso_laz_coder coder;
    iso_laz_memory memory;
    iso_laz_integers integers;
    uint16_t numbers[64 * ISO_LAZ_ROOM];
} table_coder;

/* Reads `count` chunks, which lie between `begin` and the table. */
static iso_status read_chunks(iso_laz *laz, table_coder *t, uint64_t count, uint64_t begin, uint64_t table,
                              uint64_t points, iso_error *error) {
    const bool varies = laz->chunk_points == UINT32_MAX;
    uint32_t own = 0, bytes = 0;
    uint64_t first = 0;
    for (uint64_t i = 0; i < count; i++) {
        if (varies) own = iso_laz_integer(&t->coder, &t->integers, 32, own, 0);
        bytes = iso_laz_integer(&t->coder, &t->integers, 32, bytes, 1);
        if (t->coder.faults || bytes > table - begin) return damaged(laz, "its chunk table", error);
        const uint64_t left = points - first, most = varies ? own : laz->chunk_points;
        const iso_laz_chunk chunk = {begin, bytes, first, most < left ? most : left};
        ISO_TRY(add_chunk(laz, &chunk, error));
        begin += bytes;
        first += chunk.points;
    }
    return first == points ? ISO_OK : damaged(laz, "its chunk table has not all points", error);
}

static iso_status read_table(iso_laz *laz, uint64_t begin, uint64_t points, iso_error *error) {
    const unsigned char *file = iso_mapping_data(laz->mapping);
    uint64_t table = 0;
    ISO_TRY(find_table(laz, begin, &table, error));
    begin += 8;
    const uint64_t count = number_at(file + table + 4, 4);
    if (count > (table - begin) / laz->layout.record) return damaged(laz, "its chunk table", error);
    table_coder *t = iso_alloc_zero(1, sizeof *t);
    iso_status status = ISO_ERR_NOMEM;
    if (t && iso_buffer_reserve(&laz->chunks, (size_t)count * sizeof(iso_laz_chunk), 0, NULL) == ISO_OK) {
        t->memory.numbers = t->numbers;
        iso_laz_begin(&t->coder, &t->memory, file + table + 8, (size_t)(laz->size - table - 8));
        status = read_chunks(laz, t, count, begin, table, points, error);
    } else {
        iso_fail_memory(error, laz->path);
    }
    iso_free(t);
    return status;
}

/* All points are one chunk, which ends somewhere in the rest of the file. */
static iso_status take_whole(iso_laz *laz, uint64_t begin, uint64_t points, iso_error *error) {
    if (begin > laz->size)
        return iso_fail(error, ISO_ERR_IO, "%s: truncated: its points are missing", laz->path);
    if (iso_buffer_reserve(&laz->chunks, sizeof(iso_laz_chunk), 0, NULL) != ISO_OK)
        return iso_fail_memory(error, laz->path);
    const iso_laz_chunk chunk = {begin, laz->size - begin, 0, points};
    return add_chunk(laz, &chunk, error);
}

iso_status iso_laz_open(iso_laz *laz, const char *path, const unsigned char *block, size_t block_bytes,
                        uint64_t begin, uint64_t points, size_t record, iso_error *error) {
    FILE *file;
    laz->path = path;
    ISO_TRY(read_block(laz, block, block_bytes, record, error));
    if (points == 0) return ISO_OK;
    ISO_TRY(iso_file_open(path, &file, &laz->size, error));
    const iso_status status = iso_mapping_of_file(path, file, laz->size, &laz->mapping, error);
    fclose(file);
    ISO_TRY(status);
    return laz->compressor == POINTWISE ? take_whole(laz, begin, points, error)
                                        : read_table(laz, begin, points, error);
}

void iso_laz_close(iso_laz *laz) {
    if (laz->mapping) iso_mapping_destroy(laz->mapping);
    iso_buffer_free(&laz->chunks);
}

const unsigned char *iso_laz_first(const iso_laz *laz) {
    if (laz->chunk_count == 0) return NULL;
    const iso_laz_chunk *chunks = laz->chunks.data;
    return (const unsigned char *)iso_mapping_data(laz->mapping) + chunks[0].begin;
}

/* ---- points */

enum { BLOCK = 512 }; /* points that are decoded at a time */

typedef struct worker {
    void *decoder;
    unsigned char *records;
} worker;

typedef struct job {
    const iso_laz *laz;
    const iso_polydata *data; /* has room for all points, and its origin */
    const iso_record_field *fields;
    int field_count;
    worker *workers;
    bool *good; /* of each chunk */
} job;

/* Adds the points of a chunk to `data` where they belong. */
static bool add_chunk_points(const job *j, worker *w, size_t index, iso_polydata *data) {
    const iso_laz *laz = j->laz;
    const iso_laz_chunk *chunk = (const iso_laz_chunk *)laz->chunks.data + index;
    const unsigned char *bytes = (const unsigned char *)iso_mapping_data(laz->mapping) + chunk->begin;
    if (!laz->decoder->begin(w->decoder, bytes, (size_t)chunk->bytes)) return false;
    data->point_count = (size_t)chunk->first;
    for (uint64_t left = chunk->points; left > 0;) {
        const size_t some = left < BLOCK ? (size_t)left : BLOCK;
        if (!laz->decoder->next(w->decoder, w->records, some)) return false;
        iso_polydata_add_records(data, j->fields, j->field_count, w->records, some);
        left -= some;
    }
    return laz->compressor == POINTWISE || laz->decoder->ends(w->decoder);
}

static void decode_chunk(void *context, size_t index, int number) {
    const job *j = context;
    iso_polydata part = *j->data; /* the same room, another place in it */
    j->good[index] = add_chunk_points(j, &j->workers[number], index, &part);
}

/* Decodes all chunks. Before, the first point has made the origin of all; if it has no place, chunks are
 * decoded in their order, until one has. */
static void decode(const job *j, iso_polydata *data, iso_pool *pool) {
    iso_polydata_add_records(data, j->fields, j->field_count, iso_laz_first(j->laz), 1);
    if (data->has_origin)
        iso_parallel_until(pool, j->laz->chunk_count, decode_chunk, (void *)(uintptr_t)j);
    else
        for (size_t i = 0; i < j->laz->chunk_count; i++)
            j->good[i] = add_chunk_points(j, &j->workers[0], i, data);
}

static bool make_workers(job *j, int count) {
    j->workers = iso_alloc_zero((size_t)count, sizeof *j->workers);
    j->good = iso_alloc_zero(j->laz->chunk_count, sizeof *j->good);
    bool good = j->workers && j->good;
    for (int i = 0; good && i < count; i++) {
        j->workers[i].decoder = j->laz->decoder->make(&j->laz->layout);
        j->workers[i].records = iso_alloc(BLOCK * j->laz->layout.record);
        good = j->workers[i].decoder && j->workers[i].records;
    }
    return good;
}

static void free_workers(job *j, int count) {
    for (int i = 0; j->workers && i < count; i++) {
        iso_free(j->workers[i].decoder);
        iso_free(j->workers[i].records);
    }
    iso_free(j->workers);
    iso_free(j->good);
}

iso_status iso_laz_add_points(const iso_laz *laz, iso_polydata *data, const iso_record_field *fields,
                              int count, iso_pool *pool, iso_error *error) {
    if (laz->chunk_count == 0) return ISO_OK;
    const iso_laz_chunk *last = (const iso_laz_chunk *)laz->chunks.data + laz->chunk_count - 1;
    const int threads = laz->chunk_count > 1 ? iso_pool_threads(pool) : 1;
    job j = {laz, data, fields, count, NULL, NULL};
    iso_status status = iso_polydata_reserve(data, (size_t)(last->first + last->points), error);
    if (status == ISO_OK && !make_workers(&j, threads)) status = iso_fail_memory(error, laz->path);
    if (status == ISO_OK) {
        decode(&j, data, threads > 1 ? pool : NULL);
        status = iso_pool_check(pool, laz->path, error);
    }
    for (size_t i = 0; i < laz->chunk_count && status == ISO_OK; i++)
        if (!j.good[i])
            status = iso_fail(error, ISO_ERR_IO, "%s: damaged: chunk %zu of %zu", laz->path, i + 1,
                              laz->chunk_count);
    data->point_count = (size_t)(last->first + last->points);
    free_workers(&j, threads);
    return status;
}
