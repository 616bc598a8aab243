/* tiled: reads tiled volumes as a whole with all threads, or chunk by chunk through a cache of decoded tiles.
 */
#include "grids/volume/tiled.h"

#include <stdatomic.h>
#include <string.h>
#include <sys/mman.h>

#include "base/memory.h"
#include "base/numbers.h"
#include "grids/volume/first_failure.h"
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

static uint64_t next_stored(const iso_tiled *tiled, uint64_t from, uint64_t end) {
    return tiled->next_stored ? tiled->next_stored(tiled->context, from, end) : from;
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

/* Copies the voxels first .. end - 1 from one box to another one. */
static void copy_box(size_t size, const target_box *from, const int first[3], const int end[3],
                     const target_box *to) {
    for (int z = first[2]; z < end[2]; z++)
        for (int y = first[1]; y < end[1]; y++)
            memcpy(target_row(to, size, first[0], y, z), target_row(from, size, first[0], y, z),
                   (size_t)(end[0] - first[0]) * size);
}

/* Copies a tile's voxels that lie in the volume. */
static void copy_tile(const iso_tiled *tiled, const int index[3], const void *values,
                      const target_box *target) {
    int first[3], end[3];
    for (int axis = 0; axis < 3; axis++) {
        first[axis] = index[axis] * tiled->tile[axis];
        const int64_t tile_end = (int64_t)first[axis] + tiled->tile[axis];
        end[axis] = tile_end < tiled->dims[axis] ? (int)tile_end : tiled->dims[axis];
    }
    const target_box tile = {(void *)(uintptr_t)values,
                             tiled->tile[0],
                             (ptrdiff_t)tiled->tile[0] * tiled->tile[1],
                             {first[0], first[1], first[2]}};
    copy_box(iso_type_size(tiled->type), &tile, first, end, target);
}

/* ---- the whole volume */

typedef struct filling {
    const char *path;
    const iso_volume_opts *opts;
    const iso_tiled *tiled;
    target_box target;
    int tiles[3];
    size_t count, per_task; /* of tiles */
    char *buffers;
    size_t buffer_bytes; /* of the buffer of a worker; 0: tiles lie in the grid as they are */
    iso_first_failure failure;
    atomic_size_t done, stored; /* tasks; tiles that are in the file */
} filling;

/* Whether tiles are layers of whole slices, which are contiguous in the grid, and none reaches beyond it. */
static bool is_direct(const iso_tiled *tiled) {
    return tiled->tile[0] == tiled->dims[0] && tiled->tile[1] == tiled->dims[1] &&
           tiled->dims[2] % tiled->tile[2] == 0;
}

static iso_status fill_tile(filling *f, size_t number, int worker, iso_error *error) {
    const iso_tiled *tiled = f->tiled;
    int index[3];
    tile_index(f->tiles, number, index);
    if (!f->buffer_bytes)
        return tiled->read(
            tiled->context, index,
            target_row(&f->target, iso_type_size(tiled->type), 0, 0, index[2] * tiled->tile[2]), error);
    void *buffer = f->buffers + (size_t)worker * f->buffer_bytes;
    ISO_TRY(tiled->read(tiled->context, index, buffer, error));
    copy_tile(tiled, index, buffer, &f->target);
    return ISO_OK;
}

/* Worker 0 is the calling thread, which alone may call the caller's function. */
static iso_status report(filling *f, size_t tiles, int worker, iso_error *error) {
    const size_t done = atomic_fetch_add(&f->done, tiles) + tiles;
    return worker ? ISO_OK : iso_format_progress(f->path, f->opts, (double)done / (double)f->count, error);
}

/* Reads the tiles of a task that are in the file. */
static void fill_task(void *context, size_t task, int worker) {
    filling *f = context;
    iso_error error = {0};
    iso_status status = ISO_OK;
    const size_t begin = task * f->per_task,
                 end = begin + f->per_task < f->count ? begin + f->per_task : f->count;
    size_t number = begin, stored = 0;
    if (!iso_first_failure_may_begin(&f->failure, begin)) return;
    while (status == ISO_OK && (number = (size_t)next_stored(f->tiled, number, end)) < end) {
        status = fill_tile(f, number, worker, &error);
        if (status != ISO_OK) break;
        stored++;
        number++;
    }
    atomic_fetch_add(&f->stored, stored);
    if (status == ISO_OK) status = report(f, end - begin, worker, &error);
    if (status != ISO_OK) iso_first_failure_enter(&f->failure, number, status, &error);
}

/* Whether the limit of memory allows a tile for each thread of a pool. */
static bool is_affordable(const iso_pool *pool, const iso_volume_opts *opts, const iso_tiled *tiled,
                          uint64_t grid_bytes) {
    const uint64_t threads = (uint64_t)iso_pool_threads(pool);
    uint64_t bytes;
    return !__builtin_add_overflow(tile_bytes(tiled), tiled->scratch, &bytes) &&
           !__builtin_mul_overflow(bytes, threads, &bytes) &&
           !__builtin_add_overflow(bytes, opts->mapped ? 0 : grid_bytes, &bytes) &&
           bytes <= iso_format_memory_limit(opts);
}

/* The pool that reads the tiles; *own, which may be that one, is to be destroyed. */
static iso_pool *choose_pool(const filling *f, uint64_t grid_bytes, iso_pool **own) {
    enum { WAITING = 8 };
    *own = NULL;
    if (f->tiled->waits && iso_pool_create(WAITING, own, NULL) == ISO_OK &&
        is_affordable(*own, f->opts, f->tiled, grid_bytes))
        return *own;
    return is_affordable(f->opts->pool, f->opts, f->tiled, grid_bytes) ? f->opts->pool : NULL;
}

static void note_absent(const filling *f, iso_volume_info *info) {
    const size_t absent = f->count - atomic_load(&f->stored);
    if (absent)
        iso_volume_note(info, "%zu of %zu tiles are not in the file: their voxels are %g", absent, f->count,
                        (double)f->tiled->fill * info->scale + info->offset);
}

static void fill_slice(void *context, size_t z, int worker) {
    const filling *f = context;
    (void)worker;
    for (int y = 0; y < f->tiled->dims[1]; y++)
        iso_scalar_fill(f->tiled->type, f->tiled->fill,
                        target_row(&f->target, iso_type_size(f->tiled->type), 0, y, (int)z),
                        (size_t)f->tiled->dims[0]);
}

/* Whether some tile is not in the file. A file that has many is asked for all of them. */
static bool lacks_tiles(const filling *f) {
    for (uint64_t number = 0; number < f->count; number++)
        if (next_stored(f->tiled, number, number + 1) != number) return true;
    return false;
}

static iso_status fill_grid(filling *f, iso_rgrid *grid, iso_error *error) {
    enum { MOST_TASKS = 1 << 16 };
    const iso_tiled *tiled = f->tiled;
    const uint64_t bytes = tile_bytes(tiled);
    f->target = (target_box){grid->data, grid->stride_y, grid->stride_z, {0, 0, 0}};
    iso_pool *own, *pool = choose_pool(f, iso_format_size(grid->dims, iso_type_size(grid->type)), &own);
    if (!is_direct(tiled)) {
        f->buffer_bytes = ((size_t)bytes + ISO_ALIGNMENT - 1) / ISO_ALIGNMENT * ISO_ALIGNMENT;
        f->buffers =
            bytes <= SIZE_MAX / 2 ? iso_alloc(f->buffer_bytes * (size_t)iso_pool_threads(pool)) : NULL;
        if (!f->buffers) {
            iso_pool_destroy(own);
            return iso_fail_memory(error, f->path);
        }
    }
    if (tiled->next_stored && lacks_tiles(f))
        iso_parallel_for(f->opts->pool, (size_t)tiled->dims[2], fill_slice, f);
    iso_first_failure_init(&f->failure);
    f->per_task = (f->count - 1) / MOST_TASKS + 1;
    iso_parallel_for(pool, (f->count - 1) / f->per_task + 1, fill_task, f);
    iso_free(f->buffers);
    iso_pool_destroy(own);
    return iso_first_failure_finish(&f->failure, error);
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

/* A decoded tile, or its last layers along an axis. */
typedef struct cached_piece {
    size_t number;  /* of the tile */
    int32_t next;   /* the next one with the same hash; -1: none */
    bool is_read;   /* `values` are the tile's */
    bool is_recent; /* used since the hand passed it */
    uint64_t turn;  /* of the request that used it last: pieces in use do not give way */
    void *values;
} cached_piece;

/* Pieces of the same box of voxels of tiles. */
typedef struct piece_table {
    int first[3], size[3]; /* the box, in a tile */
    bool by_age;           /* the piece that was read first gives way, whether it was used since or not */
    cached_piece *slots;
    int32_t *heads;           /* by hash: the first slot; -1: none */
    int32_t most, used, hand; /* slots, slots with memory, the next one that may give way */
} piece_table;

/* The kinds of pieces. Chunks end a little below borders of tiles (iso_chunk_cuts), so that the chunks beyond
 * need only the last layers of a tile again. */
enum { PIECE_WHOLE, PIECE_END, PIECE_KINDS = PIECE_END + 3 /* one for each axis */ };
enum { END_LAYERS = ISO_BRICK - 1 + ISO_CHUNK_ABOVE + ISO_CHUNK_BELOW };

/* What is done with a tile of a request. */
typedef struct wanted_tile {
    size_t number; /* of the tile in the box of the request */
    int kind;      /* of the piece that is copied; below 0: the chunk does not need the tile */
    int32_t slot;
    int32_t ends[3]; /* slots for its last layers, of tiles that are read; below 0: they are not kept */
} wanted_tile;

/* What a grid of iso_tiled_make_grid owns. */
typedef struct tile_cache {
    iso_tiled tiled;
    int tiles[3];
    void *addresses; /* of the grid's voxels, without memory */
    size_t address_bytes;
    piece_table kinds[PIECE_KINDS];
    wanted_tile *wanted; /* tiles that are being read or copied, as many as there are slots for whole ones */
    uint64_t turn;
    int chunk_side;        /* iso_volume_opts.chunk_side */
    atomic_size_t decoded; /* tiles so far */
} tile_cache;

static uint64_t cache_bytes(const iso_volume_opts *opts) {
    return iso_format_memory_limit(opts) / 3;
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

static void table_free(piece_table *table) {
    for (int32_t i = 0; i < table->used; i++) iso_free(table->slots[i].values);
    iso_free(table->slots);
    iso_free(table->heads);
}

static void cache_destroy(void *owner) {
    tile_cache *cache = owner;
    if (!cache) return;
    if (cache->addresses) munmap(cache->addresses, cache->address_bytes);
    for (int kind = 0; kind < PIECE_KINDS; kind++) table_free(&cache->kinds[kind]);
    iso_free(cache->wanted);
    iso_tiled_close(&cache->tiled);
    iso_free(cache);
}

/* Bytes of a piece and its slot. */
static uint64_t piece_bytes(const tile_cache *cache, int kind) {
    return iso_format_size(cache->kinds[kind].size, iso_type_size(cache->tiled.type)) + sizeof(cached_piece) +
           sizeof(int32_t) + (kind == PIECE_WHOLE ? sizeof(wanted_tile) : 0);
}

/* Ends that are needed again by the next chunk, the next row of chunks and the next layer of them. */
static uint64_t ends_to_keep(const tile_cache *cache, int axis) {
    uint64_t across[3]; /* tiles of a chunk */
    for (int i = 0; i < 3; i++) {
        const int side = cache->tiled.tile[i],
                  tiles = side < cache->chunk_side ? cache->chunk_side / side : 1;
        across[i] = (uint64_t)iso_min_int(tiles, cache->tiles[i]);
    }
    const uint64_t columns = (uint64_t)cache->tiles[0], rows = (uint64_t)cache->tiles[1];
    if (axis == 0) return 2 * across[1] * across[2];
    if (axis == 1) return (columns + across[0]) * across[2];
    return columns * rows + (columns + across[0]) * across[1];
}

static iso_status table_allocate(piece_table *table, uint64_t most) {
    table->most = most < INT32_MAX ? (int32_t)most : INT32_MAX;
    table->slots = iso_alloc_zero((size_t)table->most, sizeof *table->slots);
    table->heads = iso_alloc((size_t)table->most * sizeof *table->heads);
    if (!table->slots || !table->heads) return ISO_ERR_NOMEM;
    for (int32_t i = 0; i < table->most; i++) table->heads[i] = -1;
    return ISO_OK;
}

/* How many pieces of each kind there is memory for: all tiles if they fit; otherwise ends along x, y and z,
 * as far as they leave room for the tiles that are read at once, and tiles. Visits of some chunks only read
 * tiles for the sake of their ends, so that twice as many along x and y are of use. */
static void divide_memory(const tile_cache *cache, uint64_t bytes, uint64_t most[PIECE_KINDS]) {
    enum { AT_ONCE = 4 };
    const uint64_t all = (uint64_t)cache->tiles[0] * (uint64_t)cache->tiles[1] * (uint64_t)cache->tiles[2],
                   each = piece_bytes(cache, PIECE_WHOLE);
    memset(most, 0, PIECE_KINDS * sizeof *most);
    for (int turn = 0; turn < 2; turn++)
        for (int axis = 0; axis < 3 - turn && bytes / each < all; axis++) {
            const uint64_t more = ends_to_keep(cache, axis),
                           needs = more * piece_bytes(cache, PIECE_END + axis);
            const bool has_ends = cache->kinds[PIECE_END + axis].first[axis] > 0;
            if (!has_ends || bytes < AT_ONCE * each || needs > bytes - AT_ONCE * each) continue;
            most[PIECE_END + axis] += more;
            bytes -= needs;
        }
    most[PIECE_WHOLE] = bytes / each > 0 ? bytes / each : 1;
    if (most[PIECE_WHOLE] > all) most[PIECE_WHOLE] = all;
}

static void describe_pieces(tile_cache *cache) {
    for (int kind = 0; kind < PIECE_KINDS; kind++) {
        piece_table *table = &cache->kinds[kind];
        const int axis = kind - PIECE_END;
        memcpy(table->size, cache->tiled.tile, sizeof table->size);
        if (kind == PIECE_WHOLE || table->size[axis] <= END_LAYERS) continue;
        table->by_age = true;
        table->first[axis] = table->size[axis] - END_LAYERS;
        table->size[axis] = END_LAYERS;
    }
}

static iso_status cache_allocate(tile_cache *cache, uint64_t bytes) {
    uint64_t most[PIECE_KINDS];
    describe_pieces(cache);
    divide_memory(cache, bytes, most);
    for (int kind = 0; kind < PIECE_KINDS; kind++)
        if (most[kind] && table_allocate(&cache->kinds[kind], most[kind]) != ISO_OK) return ISO_ERR_NOMEM;
    cache->wanted = iso_alloc((size_t)cache->kinds[PIECE_WHOLE].most * sizeof *cache->wanted);
    return cache->wanted ? ISO_OK : ISO_ERR_NOMEM;
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
    cache->chunk_side = opts->chunk_side > 0 ? opts->chunk_side : CHUNK_SIDE;
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

static int32_t *head_of(piece_table *table, size_t number) {
    return &table->heads[number % (size_t)table->most];
}

static int32_t find_slot(piece_table *table, size_t number) {
    if (!table->most) return -1;
    int32_t slot = *head_of(table, number);
    while (slot >= 0 && table->slots[slot].number != number) slot = table->slots[slot].next;
    return slot;
}

static void unlink_slot(piece_table *table, int32_t slot) {
    int32_t *link = head_of(table, table->slots[slot].number);
    while (*link != slot) link = &table->slots[*link].next;
    *link = table->slots[slot].next;
}

/* A slot with memory that is not in use: a new one, or that of a piece that was not used for a while. Below
 * 0: there is none, or no memory for it. */
static int32_t free_slot(const tile_cache *cache, piece_table *table) {
    if (table->used < table->most) {
        void *values = iso_alloc((size_t)iso_format_size(table->size, iso_type_size(cache->tiled.type)));
        if (values) {
            table->slots[table->used].values = values;
            return table->used++;
        }
    }
    for (int32_t passed = 0; passed < 2 * table->used; passed++) {
        const int32_t slot = table->hand;
        cached_piece *piece = &table->slots[slot];
        table->hand = slot + 1 < table->used ? slot + 1 : 0;
        if (piece->turn == cache->turn) continue;
        if (!piece->is_recent || table->by_age) {
            unlink_slot(table, slot);
            return slot;
        }
        piece->is_recent = false;
    }
    return -1;
}

static void use_slot(const tile_cache *cache, piece_table *table, int32_t slot) {
    table->slots[slot].is_recent = true;
    table->slots[slot].turn = cache->turn;
}

/* The slot of a piece; is_read tells whether it was cached. Below 0: there is none. */
static int32_t take_slot(const tile_cache *cache, piece_table *table, size_t number) {
    int32_t slot = find_slot(table, number);
    if (slot < 0 && table->most) {
        slot = free_slot(cache, table);
        if (slot < 0) return slot;
        cached_piece *piece = &table->slots[slot];
        piece->number = number;
        piece->is_read = false;
        piece->next = *head_of(table, number);
        *head_of(table, number) = slot;
    }
    if (slot >= 0) use_slot(cache, table, slot);
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

static size_t tile_number(const tile_cache *cache, const int index[3]) {
    return ((size_t)index[2] * (size_t)cache->tiles[1] + (size_t)index[1]) * (size_t)cache->tiles[0] +
           (size_t)index[0];
}

/* The first tile of a box, from `number` on, that is in the file; box->count: there is none. */
static size_t next_in_box(const tile_cache *cache, const tile_box *box, size_t number) {
    const int *tiles = box->tiles;
    int last[3];
    tile_of_box(box, box->count - 1, last);
    const uint64_t end = tile_number(cache, last) + 1;
    while (number < box->count) {
        int at[3];
        tile_of_box(box, number, at);
        const uint64_t stored = next_stored(&cache->tiled, tile_number(cache, at), end);
        if (stored >= end) break;
        tile_index(cache->tiles, (size_t)stored, at);
        for (int axis = 0; axis < 3; axis++) at[axis] -= box->first_tile[axis];
        const bool in_rows = at[1] >= 0 && at[1] < tiles[1],
                   in_row = in_rows && at[0] >= 0 && at[0] < tiles[0];
        /* the stored tile, or the first one of the box behind it */
        const size_t layer = (size_t)at[2] + (at[1] >= tiles[1]),
                     row = layer * (size_t)tiles[1] + (in_rows ? (size_t)at[1] + (at[0] >= tiles[0]) : 0);
        number = row * (size_t)tiles[0] + (in_row ? (size_t)at[0] : 0);
        if (in_row) return number;
    }
    return box->count;
}

static bool lacks_tiles_of(const tile_cache *cache, const tile_box *box) {
    for (size_t number = 0; number < box->count; number++)
        if (next_in_box(cache, box, number) != number) return true;
    return false;
}

typedef struct chunk_reading {
    tile_cache *cache;
    const iso_grid_chunk *chunk;
    const tile_box *box;
    int crop[3]; /* the voxel of the volume that is the grid's first */
    target_box target;
    iso_first_failure failure;
} chunk_reading;

/* The voxels of a chunk that lie in a tile, in the volume's numbers. */
static void overlap(const chunk_reading *r, const int index[3], int first[3], int end[3]) {
    for (int axis = 0; axis < 3; axis++) {
        const int side = r->cache->tiled.tile[axis];
        const int64_t begin = (int64_t)index[axis] * side;
        first[axis] = begin > r->box->first[axis] ? (int)begin : r->box->first[axis];
        end[axis] = begin + side < r->box->end[axis] ? (int)(begin + side) : r->box->end[axis];
    }
}

static void copy_piece(const chunk_reading *r, const wanted_tile *wanted, const int index[3]) {
    const piece_table *table = &r->cache->kinds[wanted->kind];
    int first[3], end[3];
    target_box piece = {.data = table->slots[wanted->slot].values,
                        .stride_y = table->size[0],
                        .stride_z = (ptrdiff_t)table->size[0] * table->size[1]};
    for (int axis = 0; axis < 3; axis++)
        piece.origin[axis] = index[axis] * r->cache->tiled.tile[axis] + table->first[axis];
    overlap(r, index, first, end);
    copy_box(iso_type_size(r->cache->tiled.type), &piece, first, end, &r->target);
}

/* Keeps the last layers of a tile that was read. */
static void keep_ends(const chunk_reading *r, const wanted_tile *wanted, const void *values) {
    const int *tile = r->cache->tiled.tile;
    const target_box whole = {(void *)(uintptr_t)values, tile[0], (ptrdiff_t)tile[0] * tile[1], {0, 0, 0}};
    for (int axis = 0; axis < 3; axis++) {
        const piece_table *table = &r->cache->kinds[PIECE_END + axis];
        if (wanted->ends[axis] < 0) continue;
        cached_piece *piece = &table->slots[wanted->ends[axis]];
        const target_box target = {piece->values,
                                   table->size[0],
                                   (ptrdiff_t)table->size[0] * table->size[1],
                                   {table->first[0], table->first[1], table->first[2]}};
        copy_box(iso_type_size(r->cache->tiled.type), &whole, table->first, tile, &target);
        piece->is_read = true;
    }
}

static void read_task(void *context, size_t number, int worker) {
    (void)worker;
    chunk_reading *r = context;
    const iso_tiled *tiled = &r->cache->tiled;
    const wanted_tile *wanted = &r->cache->wanted[number];
    iso_error error = {0};
    int index[3];
    if (wanted->kind < 0 || !iso_first_failure_may_begin(&r->failure, number)) return;
    cached_piece *piece = &r->cache->kinds[wanted->kind].slots[wanted->slot];
    tile_of_box(r->box, wanted->number, index);
    if (!piece->is_read) {
        const iso_status status = tiled->read(tiled->context, index, piece->values, &error);
        if (status != ISO_OK) {
            iso_first_failure_enter(&r->failure, number, status, &error);
            return;
        }
        piece->is_read = true;
        atomic_fetch_add_explicit(&r->cache->decoded, 1, memory_order_relaxed);
        keep_ends(r, wanted, piece->values);
    }
    copy_piece(r, wanted, index);
}

/* Finds a piece that has what the chunk needs of a tile. */
static bool find_piece(const chunk_reading *r, const int index[3], wanted_tile *wanted) {
    tile_cache *cache = r->cache;
    const size_t number = tile_number(cache, index);
    int first[3], end[3];
    overlap(r, index, first, end);
    for (int kind = 0; kind < PIECE_KINDS; kind++) {
        piece_table *table = &cache->kinds[kind];
        const int axis = kind - PIECE_END;
        if (kind != PIECE_WHOLE && first[axis] < index[axis] * cache->tiled.tile[axis] + table->first[axis])
            continue;
        wanted->slot = find_slot(table, number);
        if (wanted->slot < 0 || !table->slots[wanted->slot].is_read) continue;
        wanted->kind = kind;
        use_slot(cache, table, wanted->slot);
        return true;
    }
    return false;
}

/* Whether a chunk beyond this one will need the last layers of a tile: a chunk's last tile has some voxels
 * above the chunk. */
static bool is_last(const chunk_reading *r, const int index[3], int axis) {
    const int side = r->cache->tiled.tile[axis];
    const int64_t end = (int64_t)(index[axis] + 1) * side;
    return index[axis] + 1 < r->cache->tiles[axis] && end >= r->box->end[axis];
}

/* Decides what is done with a tile. False: all slots are in use, or there is no memory. */
static bool want_tile(const chunk_reading *r, size_t in_box, wanted_tile *wanted) {
    tile_cache *cache = r->cache;
    int index[3], first[3], end[3];
    *wanted = (wanted_tile){.number = in_box, .kind = -1, .ends = {-1, -1, -1}};
    tile_of_box(r->box, in_box, index);
    overlap(r, index, first, end);
    for (int axis = 0; axis < 3; axis++) {
        first[axis] -= r->crop[axis];
        end[axis] -= r->crop[axis];
    }
    if (!iso_grid_chunk_needs(r->chunk, first, end) || find_piece(r, index, wanted)) return true;
    const size_t number = tile_number(cache, index);
    wanted->kind = PIECE_WHOLE;
    wanted->slot = take_slot(cache, &cache->kinds[PIECE_WHOLE], number);
    for (int axis = 0; axis < 3 && wanted->slot >= 0; axis++)
        if (is_last(r, index, axis))
            wanted->ends[axis] = take_slot(cache, &cache->kinds[PIECE_END + axis], number);
    return wanted->slot >= 0;
}

/* Takes slots for as many tiles of the box as the cache holds at once, from tile *next on, which is moved
 * behind them. */
static int32_t take_slots(const chunk_reading *r, size_t *next) {
    tile_cache *cache = r->cache;
    int32_t count = 0;
    cache->turn++;
    while (*next < r->box->count && count < cache->kinds[PIECE_WHOLE].most) {
        if (!want_tile(r, *next, &cache->wanted[count])) break;
        count++;
        *next = next_in_box(cache, r->box, *next + 1);
    }
    return count;
}

static iso_status read_tiles(chunk_reading *r, iso_pool *pool, iso_error *error) {
    for (size_t next = next_in_box(r->cache, r->box, 0); next < r->box->count;) {
        const int32_t count = take_slots(r, &next);
        if (!count) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for a tile of the volume");
        iso_first_failure_init(&r->failure);
        iso_parallel_for(pool, (size_t)count, read_task, r);
        ISO_TRY(iso_first_failure_finish(&r->failure, error));
    }
    return ISO_OK;
}

static void fill_chunk(const iso_tiled *tiled, iso_rgrid *grid) {
    for (int z = 0; z < grid->dims[2]; z++)
        for (int y = 0; y < grid->dims[1]; y++)
            iso_scalar_fill(tiled->type, tiled->fill,
                            (char *)grid->data + (y * grid->stride_y + z * grid->stride_z) *
                                                     (ptrdiff_t)iso_type_size(grid->type),
                            (size_t)grid->dims[0]);
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
    chunk_reading r = {.cache = whole->owner, .chunk = chunk, .box = &box};
    add_crop(whole, r.crop);
    ISO_TRY(iso_rgrid_create(&desc, grid, error));
    r.target = (target_box){
        .data = (*grid)->data,
        .stride_y = (*grid)->stride_y,
        .stride_z = (*grid)->stride_z,
        .origin = {ISO_BRICK * chunk->origin[0], ISO_BRICK * chunk->origin[1], ISO_BRICK * chunk->origin[2]}};
    add_crop(whole, r.target.origin);
    if (lacks_tiles_of(r.cache, &box)) fill_chunk(&r.cache->tiled, *grid);
    const iso_status status = read_tiles(&r, pool, error);
    if (status == ISO_OK) return ISO_OK;
    iso_rgrid_destroy(*grid);
    *grid = NULL;
    return status;
}

static bool is_constant(void *context, const iso_grid_chunk *chunk, float *value) {
    const iso_rgrid *whole = context;
    const tile_cache *cache = whole->owner;
    const tile_box box = tiles_of_chunk(whole, chunk);
    *value = cache->tiled.fill;
    return next_in_box(cache, &box, 0) == box.count;
}

static bool give_back(void *context) {
    tile_cache *cache = ((const iso_rgrid *)context)->owner;
    bool given = false;
    for (int kind = 0; kind < PIECE_KINDS; kind++) {
        piece_table *table = &cache->kinds[kind];
        const int32_t most = kind == PIECE_WHOLE && table->most == 1 ? 1 : table->most / 2;
        given |= most < table->most;
        for (int32_t i = 0; i < table->used; i++) iso_free(table->slots[i].values);
        for (int32_t i = 0; i < table->most; i++) table->heads[i] = -1;
        table->used = table->hand = 0;
        table->most = most;
    }
    return given;
}

static uint64_t decoded(void *context) {
    tile_cache *cache = ((const iso_rgrid *)context)->owner;
    return atomic_load(&cache->decoded) * tile_bytes(&cache->tiled);
}

iso_chunk_source iso_tiled_source(const iso_rgrid *grid) {
    const tile_cache *cache = grid->owner;
    iso_chunk_source source = iso_chunk_source_of(grid);
    add_crop(grid, source.in_tile);
    for (int axis = 0; axis < 3; axis++) {
        source.tile[axis] = cache->tiled.tile[axis];
        source.in_tile[axis] %= source.tile[axis];
    }
    source.decoded = decoded;
    source.give_back = give_back;
    source.read = read_chunk;
    if (cache->tiled.next_stored) source.is_constant = is_constant;
    return source;
}
