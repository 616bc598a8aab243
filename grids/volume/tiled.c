/* tiled: reads tiled volumes as a whole with all threads, or chunk by chunk through a cache of decoded tiles.
 */
#define _GNU_SOURCE
#include "grids/volume/tiled.h"

#include <math.h>
#include <pthread.h>
#include <stdatomic.h>
#include <string.h>
#include <sys/mman.h>

#include "base/memory.h"
#include "base/numbers.h"
#include "grids/volume/format.h"
#include "grids/volume/mapping.h"

/* ---- tiles */

void iso_tiled_close(iso_tiled *tiled) {
    if (tiled->destroy) tiled->destroy(tiled->context);
    *tiled = (iso_tiled){0};
}

static void count_tiles(const iso_tiled *tiled, int tiles[3]) {
    for (int axis = 0; axis < 3; axis++) tiles[axis] = (tiled->dims[axis] - 1) / tiled->tile[axis] + 1;
}

static void tile_index(const int tiles[3], size_t number, int index[3]) {
    index[0] = (int)(number % (size_t)tiles[0]);
    index[1] = (int)(number / (size_t)tiles[0] % (size_t)tiles[1]);
    index[2] = (int)(number / (size_t)tiles[0] / (size_t)tiles[1]);
}

static uint64_t tile_bytes(const iso_tiled *tiled) {
    return iso_format_size(tiled->tile, iso_type_size(tiled->type));
}

/* A box of voxels in memory, and which voxel of the volume is its first. */
typedef struct target_box {
    void *data;
    ptrdiff_t stride_y, stride_z; /* voxels */
    int origin[3];
} target_box;

static char *target_row(const target_box *target, size_t size, int x, int y, int z) {
    const ptrdiff_t at = x - target->origin[0] + (y - target->origin[1]) * target->stride_y +
                         (z - target->origin[2]) * target->stride_z;
    return (char *)target->data + at * (ptrdiff_t)size;
}

/* Copies the voxels first .. end - 1 of the volume that lie in a tile. */
static void copy_tile(const iso_tiled *tiled, const int index[3], const void *values, const int first[3],
                      const int end[3], const target_box *target) {
    const size_t size = iso_type_size(tiled->type);
    int origin[3], lo[3], hi[3];
    for (int axis = 0; axis < 3; axis++) {
        origin[axis] = index[axis] * tiled->tile[axis];
        lo[axis] = origin[axis] > first[axis] ? origin[axis] : first[axis];
        const int64_t tile_end = (int64_t)origin[axis] + tiled->tile[axis];
        hi[axis] = tile_end < end[axis] ? (int)tile_end : end[axis];
    }
    const target_box tile = {(void *)(uintptr_t)values,
                             tiled->tile[0],
                             (ptrdiff_t)tiled->tile[0] * tiled->tile[1],
                             {origin[0], origin[1], origin[2]}};
    for (int z = lo[2]; z < hi[2]; z++)
        for (int y = lo[1]; y < hi[1]; y++)
            memcpy(target_row(target, size, lo[0], y, z), target_row(&tile, size, lo[0], y, z),
                   (size_t)(hi[0] - lo[0]) * size);
}

/* The failure of the first of several items that are worked on by several threads. Items are begun in order,
 * so that which one is first does not depend on the threads. */
typedef struct first_failure {
    pthread_mutex_t lock;
    atomic_size_t item; /* SIZE_MAX: none has failed */
    iso_status status;
    iso_error error;
} first_failure;

static void failure_init(first_failure *failure) {
    *failure = (first_failure){.status = ISO_OK};
    atomic_init(&failure->item, SIZE_MAX);
    pthread_mutex_init(&failure->lock, NULL);
}

static bool may_begin(first_failure *failure, size_t item) {
    return item < atomic_load_explicit(&failure->item, memory_order_relaxed);
}

static void failure_enter(first_failure *failure, size_t item, iso_status status, const iso_error *error) {
    pthread_mutex_lock(&failure->lock);
    if (item < atomic_load(&failure->item)) {
        atomic_store(&failure->item, item);
        failure->status = status;
        failure->error = *error;
    }
    pthread_mutex_unlock(&failure->lock);
}

static iso_status failure_finish(first_failure *failure, iso_error *error) {
    pthread_mutex_destroy(&failure->lock);
    return failure->status == ISO_OK ? ISO_OK : iso_fail(error, failure->status, "%s", failure->error.text);
}

/* ---- the whole volume */

typedef struct filling {
    const char *path;
    const iso_volume_opts *opts;
    const iso_tiled *tiled;
    target_box target;
    int tiles[3];
    size_t count; /* of tiles */
    char *buffers;
    size_t buffer_bytes; /* of the buffer of a worker; 0: tiles lie in the grid as they are */
    first_failure failure;
    atomic_size_t done, absent;
    _Atomic float absent_value;
} filling;

/* Whether tiles are layers of whole slices, which are contiguous in the grid, and none reaches beyond it. */
static bool is_direct(const iso_tiled *tiled) {
    return tiled->tile[0] == tiled->dims[0] && tiled->tile[1] == tiled->dims[1] &&
           tiled->dims[2] % tiled->tile[2] == 0;
}

static iso_status fill_tile(filling *f, const int index[3], int worker, iso_error *error) {
    const iso_tiled *tiled = f->tiled;
    const int first[3] = {0, 0, 0};
    float value;
    if (tiled->is_absent && tiled->is_absent(tiled->context, index, &value)) {
        atomic_fetch_add(&f->absent, 1);
        atomic_store(&f->absent_value, value);
    }
    if (!f->buffer_bytes)
        return tiled->read(
            tiled->context, index,
            target_row(&f->target, iso_type_size(tiled->type), 0, 0, index[2] * tiled->tile[2]), error);
    void *buffer = f->buffers + (size_t)worker * f->buffer_bytes;
    ISO_TRY(tiled->read(tiled->context, index, buffer, error));
    copy_tile(tiled, index, buffer, first, tiled->dims, &f->target);
    return ISO_OK;
}

/* Worker 0 is the calling thread, which alone may call the caller's function. */
static iso_status report(filling *f, int worker, iso_error *error) {
    const size_t done = atomic_fetch_add(&f->done, 1) + 1;
    return worker ? ISO_OK : iso_format_progress(f->path, f->opts, (double)done / (double)f->count, error);
}

static void fill_task(void *context, size_t number, int worker) {
    filling *f = context;
    iso_error error = {0};
    int index[3];
    if (!may_begin(&f->failure, number)) return;
    tile_index(f->tiles, number, index);
    iso_status status = fill_tile(f, index, worker, &error);
    if (status == ISO_OK) status = report(f, worker, &error);
    if (status != ISO_OK) failure_enter(&f->failure, number, status, &error);
}

/* The pool, if the limit of memory allows a tile for each of its threads. */
static iso_pool *affordable_pool(const iso_volume_opts *opts, const iso_tiled *tiled, uint64_t grid_bytes) {
    const uint64_t limit = iso_format_memory_limit(opts), threads = (uint64_t)iso_pool_threads(opts->pool);
    uint64_t bytes;
    if (__builtin_add_overflow(tile_bytes(tiled), tiled->scratch, &bytes) ||
        __builtin_mul_overflow(bytes, threads, &bytes) ||
        __builtin_add_overflow(bytes, opts->mapped ? 0 : grid_bytes, &bytes))
        return NULL;
    return bytes <= limit ? opts->pool : NULL;
}

static void note_absent(const filling *f, iso_volume_info *info) {
    const size_t absent = atomic_load(&f->absent);
    if (absent)
        iso_volume_note(info, "%zu of %zu tiles are not in the file: their voxels are %g", absent, f->count,
                        (double)atomic_load(&f->absent_value) * info->scale + info->offset);
}

static iso_status fill_grid(filling *f, iso_rgrid *grid, iso_error *error) {
    const iso_tiled *tiled = f->tiled;
    const uint64_t bytes = tile_bytes(tiled);
    f->target = (target_box){grid->data, grid->stride_y, grid->stride_z, {0, 0, 0}};
    iso_pool *pool = affordable_pool(f->opts, tiled, iso_format_size(grid->dims, iso_type_size(grid->type)));
    if (!is_direct(tiled)) {
        f->buffer_bytes = ((size_t)bytes + ISO_ALIGNMENT - 1) / ISO_ALIGNMENT * ISO_ALIGNMENT;
        f->buffers =
            bytes <= SIZE_MAX / 2 ? iso_alloc(f->buffer_bytes * (size_t)iso_pool_threads(pool)) : NULL;
        if (!f->buffers) return iso_fail_memory(error, f->path);
    }
    failure_init(&f->failure);
    iso_parallel_for(pool, f->count, fill_task, f);
    iso_free(f->buffers);
    return failure_finish(&f->failure, error);
}

static iso_status create_grid(const char *path, const iso_volume_opts *opts, const iso_volume_info *info,
                              iso_grid *grid, iso_error *error) {
    iso_mapping *mapping = NULL;
    if (!opts->mapped) return iso_format_create(path, info, NULL, grid, error);
    ISO_TRY(iso_mapping_of_new_file(path, info->bytes, &mapping, error));
    const iso_format_data lent = {iso_mapping_data(mapping), iso_mapping_destroy, mapping};
    return iso_format_create(path, info, &lent, grid, error);
}

iso_status iso_tiled_read_grid(const char *path, const iso_volume_opts *opts, const iso_tiled *tiled,
                               iso_volume_info *info, iso_grid *grid, iso_error *error) {
    filling f = {.path = path, .opts = opts, .tiled = tiled};
    count_tiles(tiled, f.tiles);
    f.count = (size_t)f.tiles[0] * (size_t)f.tiles[1] * (size_t)f.tiles[2];
    ISO_TRY(create_grid(path, opts, info, grid, error));
    const iso_status status = fill_grid(&f, grid->rgrid, error);
    if (status == ISO_OK)
        note_absent(&f, info);
    else
        iso_grid_destroy(grid);
    return status;
}

/* ---- the cache */

/* A decoded tile. */
typedef struct cached_tile {
    size_t number;  /* of the tile */
    int32_t next;   /* the next one with the same hash; -1: none */
    bool is_read;   /* `values` are the tile's */
    bool is_recent; /* used since the hand passed it */
    uint64_t turn;  /* of the request that used it last: tiles in use do not give way */
    void *values;
} cached_tile;

/* What a grid of iso_tiled_make_grid owns. */
typedef struct tile_cache {
    iso_tiled tiled;
    int tiles[3];
    void *addresses; /* of the grid's voxels, without memory */
    size_t address_bytes;
    cached_tile *slots;
    int32_t *heads;           /* by hash: the first slot; -1: none */
    int32_t *wanted;          /* slots of the tiles that are being read or copied */
    int32_t most, used, hand; /* slots, slots with memory, the next one that may give way */
    uint64_t turn;
} tile_cache;

static uint64_t cache_bytes(const iso_volume_opts *opts) {
    return iso_format_memory_limit(opts) / 8;
}

/* The side of the chunks that isorender usually makes, and the voxels that one needs along an axis. */
enum { CHUNK_SIDE = 128, CHUNK_NEEDS = CHUNK_SIDE + ISO_CHUNK_BELOW + ISO_CHUNK_ABOVE };

bool iso_tiled_suits_chunks(const iso_tiled *tiled, const iso_volume_opts *opts) {
    double bytes = (double)iso_type_size(tiled->type), own = bytes;
    int tiles[3];
    count_tiles(tiled, tiles);
    for (int axis = 0; axis < 3; axis++) {
        const int touched = iso_min_int((CHUNK_NEEDS - 2) / tiled->tile[axis] + 2, tiles[axis]);
        bytes *= (double)touched * tiled->tile[axis];
        own *= iso_min_int(CHUNK_SIDE, tiled->dims[axis]);
    }
    return bytes <= (double)cache_bytes(opts) || bytes <= 8 * own;
}

static void cache_destroy(void *owner) {
    tile_cache *cache = owner;
    if (!cache) return;
    if (cache->addresses) munmap(cache->addresses, cache->address_bytes);
    for (int32_t i = 0; i < cache->used; i++) iso_free(cache->slots[i].values);
    iso_free(cache->slots);
    iso_free(cache->heads);
    iso_free(cache->wanted);
    iso_tiled_close(&cache->tiled);
    iso_free(cache);
}

static iso_status cache_allocate(tile_cache *cache, uint64_t bytes) {
    const uint64_t each = tile_bytes(&cache->tiled) + sizeof(cached_tile) + 2 * sizeof(int32_t);
    const uint64_t all = (uint64_t)cache->tiles[0] * (uint64_t)cache->tiles[1] * (uint64_t)cache->tiles[2];
    uint64_t most = bytes / each > 0 ? bytes / each : 1;
    if (most > all) most = all;
    cache->most = most < INT32_MAX ? (int32_t)most : INT32_MAX;
    cache->slots = iso_alloc_zero((size_t)cache->most, sizeof *cache->slots);
    cache->heads = iso_alloc((size_t)cache->most * sizeof *cache->heads);
    cache->wanted = iso_alloc((size_t)cache->most * sizeof *cache->wanted);
    if (!cache->slots || !cache->heads || !cache->wanted) return ISO_ERR_NOMEM;
    for (int32_t i = 0; i < cache->most; i++) cache->heads[i] = -1;
    return ISO_OK;
}

static iso_status reserve_addresses(tile_cache *cache, uint64_t bytes) {
    if (bytes > SIZE_MAX) return ISO_ERR_NOMEM;
    void *addresses =
        mmap(NULL, (size_t)bytes, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    if (addresses == MAP_FAILED) return ISO_ERR_NOMEM;
    cache->addresses = addresses;
    cache->address_bytes = (size_t)bytes;
    return ISO_OK;
}

iso_status iso_tiled_make_grid(const char *path, const iso_volume_opts *opts, iso_tiled *tiled,
                               const iso_volume_info *info, iso_grid *grid, iso_error *error) {
    tile_cache *cache = iso_alloc_zero(1, sizeof *cache);
    if (!cache) {
        iso_tiled_close(tiled);
        return iso_fail_memory(error, path);
    }
    cache->tiled = *tiled;
    *tiled = (iso_tiled){0};
    count_tiles(&cache->tiled, cache->tiles);
    if (reserve_addresses(cache, info->bytes) != ISO_OK ||
        cache_allocate(cache, cache_bytes(opts)) != ISO_OK) {
        cache_destroy(cache);
        return iso_fail_memory(error, path);
    }
    const iso_format_data lent = {cache->addresses, cache_destroy, cache};
    return iso_format_create(path, info, &lent, grid, error);
}

/* ---- slots */

static int32_t *head_of(tile_cache *cache, size_t number) {
    return &cache->heads[number % (size_t)cache->most];
}

static int32_t find_slot(tile_cache *cache, size_t number) {
    int32_t slot = *head_of(cache, number);
    while (slot >= 0 && cache->slots[slot].number != number) slot = cache->slots[slot].next;
    return slot;
}

static void unlink_slot(tile_cache *cache, int32_t slot) {
    int32_t *link = head_of(cache, cache->slots[slot].number);
    while (*link != slot) link = &cache->slots[*link].next;
    *link = cache->slots[slot].next;
}

/* A slot with memory that is not in use: a new one, or that of a tile that was not used for a while. Below 0:
 * out of memory. The caller asks for no more slots in a turn than there are. */
static int32_t free_slot(tile_cache *cache) {
    if (cache->used < cache->most) {
        void *values = iso_alloc((size_t)tile_bytes(&cache->tiled));
        if (values) {
            cache->slots[cache->used].values = values;
            return cache->used++;
        }
    }
    for (int32_t passed = 0; passed < 2 * cache->used; passed++) {
        const int32_t slot = cache->hand;
        cached_tile *tile = &cache->slots[slot];
        cache->hand = slot + 1 < cache->used ? slot + 1 : 0;
        if (tile->turn == cache->turn) continue;
        if (!tile->is_recent) {
            unlink_slot(cache, slot);
            return slot;
        }
        tile->is_recent = false;
    }
    return -1;
}

/* The slot of a tile; is_read tells whether it was cached. Below 0: out of memory. */
static int32_t take_slot(tile_cache *cache, size_t number) {
    int32_t slot = find_slot(cache, number);
    if (slot < 0) {
        slot = free_slot(cache);
        if (slot < 0) return slot;
        cached_tile *tile = &cache->slots[slot];
        tile->number = number;
        tile->is_read = false;
        tile->next = *head_of(cache, number);
        *head_of(cache, number) = slot;
    }
    cache->slots[slot].is_recent = true;
    cache->slots[slot].turn = cache->turn;
    return slot;
}

/* ---- chunks */

bool iso_tiled_is(const iso_rgrid *grid) {
    return grid->release == cache_destroy;
}

/* Adds the volume's voxel that is the first of the grid, which may be cropped. */
static void add_crop(const iso_rgrid *grid, int voxel[3]) {
    const tile_cache *cache = grid->owner;
    const ptrdiff_t at =
        ((const char *)grid->data - (const char *)cache->addresses) / (ptrdiff_t)iso_type_size(grid->type);
    voxel[0] += (int)(at % grid->stride_y);
    voxel[1] += (int)(at % grid->stride_z / grid->stride_y);
    voxel[2] += (int)(at / grid->stride_z);
}

/* The voxels first .. end - 1 of the volume and the tiles that have them. */
typedef struct tile_box {
    int first[3], end[3];
    int first_tile[3], tiles[3];
    size_t count; /* of tiles */
} tile_box;

static tile_box tiles_of_chunk(const iso_rgrid *grid, const iso_grid_chunk *chunk) {
    const tile_cache *cache = grid->owner;
    tile_box box = {.count = 1};
    iso_grid_chunk_voxels(chunk, box.first, box.end);
    add_crop(grid, box.first);
    add_crop(grid, box.end);
    for (int axis = 0; axis < 3; axis++) {
        const int side = cache->tiled.tile[axis];
        box.first_tile[axis] = box.first[axis] / side;
        box.tiles[axis] = (box.end[axis] - 1) / side + 1 - box.first_tile[axis];
        box.count *= (size_t)box.tiles[axis];
    }
    return box;
}

static void tile_of_box(const tile_box *box, size_t number, int index[3]) {
    tile_index(box->tiles, number, index);
    for (int axis = 0; axis < 3; axis++) index[axis] += box->first_tile[axis];
}

typedef struct chunk_reading {
    tile_cache *cache;
    const tile_box *box;
    target_box target;
    size_t begin; /* the first tile of the box that is in cache->wanted */
    first_failure failure;
} chunk_reading;

static void read_task(void *context, size_t number, int worker) {
    (void)worker;
    chunk_reading *r = context;
    const iso_tiled *tiled = &r->cache->tiled;
    cached_tile *tile = &r->cache->slots[r->cache->wanted[number]];
    iso_error error = {0};
    int index[3];
    if (!may_begin(&r->failure, number)) return;
    tile_of_box(r->box, r->begin + number, index);
    if (!tile->is_read) {
        const iso_status status = tiled->read(tiled->context, index, tile->values, &error);
        if (status != ISO_OK) {
            failure_enter(&r->failure, number, status, &error);
            return;
        }
        tile->is_read = true;
    }
    copy_tile(tiled, index, tile->values, r->box->first, r->box->end, &r->target);
}

/* Takes slots for as many tiles of the box as the cache holds at once, from tile `begin` on. */
static int32_t take_slots(tile_cache *cache, const tile_box *box, size_t begin) {
    int32_t count = 0;
    cache->turn++;
    for (size_t number = begin; number < box->count && count < cache->most; number++) {
        int index[3];
        tile_of_box(box, number, index);
        const size_t tile =
            ((size_t)index[2] * (size_t)cache->tiles[1] + (size_t)index[1]) * (size_t)cache->tiles[0] +
            (size_t)index[0];
        const int32_t slot = take_slot(cache, tile);
        if (slot < 0) break;
        cache->wanted[count++] = slot;
    }
    return count;
}

static iso_status read_tiles(chunk_reading *r, iso_pool *pool, iso_error *error) {
    for (size_t begin = 0; begin < r->box->count;) {
        const int32_t count = take_slots(r->cache, r->box, begin);
        if (!count) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for a tile of the volume");
        r->begin = begin;
        failure_init(&r->failure);
        iso_parallel_for(pool, (size_t)count, read_task, r);
        ISO_TRY(failure_finish(&r->failure, error));
        begin += (size_t)count;
    }
    return ISO_OK;
}

static iso_status read_chunk(void *context, const iso_grid_chunk *chunk, iso_pool *pool, iso_rgrid **grid,
                             iso_error *error) {
    const iso_rgrid *whole = context;
    const tile_box box = tiles_of_chunk(whole, chunk);
    const iso_rgrid_desc desc = {.dims = {chunk->size[0], chunk->size[1], chunk->size[2]},
                                 .type = whole->type,
                                 .scale = whole->scale,
                                 .offset = whole->offset,
                                 .transform = &whole->transform,
                                 .level_set = whole->level_set};
    chunk_reading r = {.cache = whole->owner, .box = &box};
    ISO_TRY(iso_rgrid_create(&desc, grid, error));
    r.target = (target_box){
        .data = (*grid)->data,
        .stride_y = (*grid)->stride_y,
        .stride_z = (*grid)->stride_z,
        .origin = {ISO_BRICK * chunk->origin[0], ISO_BRICK * chunk->origin[1], ISO_BRICK * chunk->origin[2]}};
    add_crop(whole, r.target.origin);
    const iso_status status = read_tiles(&r, pool, error);
    if (status == ISO_OK) return ISO_OK;
    iso_rgrid_destroy(*grid);
    *grid = NULL;
    return status;
}

static bool is_constant(void *context, const iso_grid_chunk *chunk, float *value) {
    const iso_rgrid *grid = context;
    const tile_box box = tiles_of_chunk(grid, chunk);
    const iso_tiled *tiled = &((const tile_cache *)grid->owner)->tiled;
    for (size_t number = 0; number < box.count; number++) {
        int index[3];
        tile_of_box(&box, number, index);
        if (!tiled->is_absent(tiled->context, index, value)) return false; /* the value is that of all */
    }
    return true;
}

iso_chunk_source iso_tiled_source(const iso_rgrid *grid) {
    const tile_cache *cache = grid->owner;
    iso_chunk_source source = iso_chunk_source_of(grid);
    source.read = read_chunk;
    if (cache->tiled.is_absent) source.is_constant = is_constant;
    return source;
}
