/* The index of brick ranges: it is created by reading the grid in batches of bricks, and updated from the
 * change log. */
#include "grids/brick_index.h"

#include <math.h>

#include "base/numbers.h"
#include "base/primitives.h"
#include "grids/interval_tree.h"

/* The tree is rebuilt when more bricks than this are outside of it: 1/PENDING_SHARE of all, and PENDING_MIN.
 * Rebuilding takes about 15 ns for each brick of the grid, reading an edited brick 1 to 2 us. With up to 1/32
 * of the bricks outside the tree, rebuilding adds at most a few tenths to the cost of reading the edited
 * bricks, and a query scans at most 1/32 of all bricks, which takes a microsecond at 512^3. */
enum { PENDING_SHARE = 32, PENDING_MIN = 64 };

enum { FINITE = 1, PENDING = 2, DIRTY = 4 };

struct iso_brick_index {
    const iso_rgrid *grid;
    int bricks[3];
    size_t total;
    uint64_t seen;            /* the last edit that the index includes */
    float *lo, *hi;           /* by brick: its current range */
    iso_group_ranges *groups; /* by brick: the ranges of its row groups */
    /* by brick. FINITE: all voxels are finite; PENDING: the range differs from the tree's; DIRTY: to be read
     * in this update */
    uint8_t *flags;
    iso_interval_tree tree; /* over the ranges of the bricks when the tree was built */
    iso_buffer pending;     /* uint32_t: the bricks with the flag PENDING */
    size_t pending_count;
    iso_buffer dirty,
        fresh; /* for one update: the bricks to read (uint32_t) and the results (iso_brick_reading) */
    size_t dirty_count;
    iso_value_counts *counts; /* of all voxels of the grid as it was at `seen`; NULL: not counted */
    iso_cpu_level level;      /* the level of the kernels in the current update or creation */
};

static void set_brick(iso_brick_index *index, size_t brick, const iso_brick_reading *reading) {
    index->lo[brick] = reading->range.lo;
    index->hi[brick] = reading->range.hi;
    index->groups[brick] = reading->groups;
    index->flags[brick] = (uint8_t)((index->flags[brick] & ~FINITE) | (reading->range.finite ? FINITE : 0));
}

/* ---- creation */

/* Reading of all bricks. The bricks of a layer (one z) are divided along y into bands of most[1] rows; bands
 * are numbered along y, then z. */
typedef struct full_read {
    iso_brick_index *index;
    iso_value_counter *counter; /* counts the values, too; NULL: they are not wanted */
    int most[2], batches;       /* the largest batch along x and y; number of bands in a layer */
} full_read;

/* Counts the values of a row of bricks along x which have just been read; that is why they are in the cache.
 * Neighbouring bricks are counted together, except bricks of one value, for which one increment is enough. */
static void count_bricks(const full_read *read, int worker, const int first[3], int count,
                         const iso_brick_reading *readings) {
    const int *dims = read->index->grid->dims;
    int lo[3], hi[3];
    for (int axis = 0; axis < 3; axis++) {
        lo[axis] = first[axis] * ISO_BRICK;
        hi[axis] = iso_min_int(lo[axis] + ISO_BRICK, dims[axis]);
    }
    for (int next, i = 0; i < count; i = next) {
        const bool constant = readings[i].range.lo == readings[i].range.hi;
        for (next = i + 1; next < count && !constant; next++)
            if (readings[next].range.lo == readings[next].range.hi) break;
        lo[0] = (first[0] + i) * ISO_BRICK;
        hi[0] = iso_min_int((first[0] + next) * ISO_BRICK, dims[0]);
        if (constant)
            iso_value_counter_add_constant(read->counter, worker, lo, hi);
        else
            iso_value_counter_add(read->counter, worker, lo, hi, ISO_BRICK);
    }
}

/* Reads rows of bricks, with `columns` bricks each. */
static void read_bricks(const full_read *read, int worker, const int first[3], int columns, int rows) {
    iso_brick_index *index = read->index;
    const iso_brick_batch batch = {{first[0], first[1], first[2]}, {columns, rows}};
    iso_brick_reading readings[ISO_BATCH_BRICKS];
    iso_brick_ranges(index->grid, index->level, &batch, readings);
    for (int row = 0; row < rows; row++) {
        const int at[3] = {first[0], first[1] + row, first[2]};
        const uint32_t number = iso_brick_index_number(index, at);
        for (int i = 0; i < columns; i++)
            set_brick(index, number + (uint32_t)i, &readings[row * columns + i]);
        if (read->counter) count_bricks(read, worker, at, columns, &readings[row * columns]);
    }
}

/* Reads a batch at once; if values are counted, row by row, so that while one row is counted the next one can
 * be fetched from memory. */
static void read_batch(void *context, size_t number, int worker) {
    const full_read *read = context;
    const int *bricks = read->index->bricks, y = (int)(number % (size_t)read->batches) * read->most[1],
              z = (int)(number / (size_t)read->batches), end = iso_min_int(y + read->most[1], bricks[1]),
              rows = read->counter ? 1 : end - y;
    for (int first[3] = {0, y, z}; first[1] < end; first[1] += rows)
        for (first[0] = 0; first[0] < bricks[0]; first[0] += read->most[0])
            read_bricks(read, worker, first, iso_min_int(read->most[0], bricks[0] - first[0]), rows);
}

static void read_all(iso_brick_index *index, iso_pool *pool, iso_value_counter *counter) {
    full_read read = {.index = index, .counter = counter};
    iso_brick_batch_max(index->grid, read.most);
    read.batches = (index->bricks[1] - 1) / read.most[1] + 1;
    iso_parallel_for(pool, (size_t)read.batches * (size_t)index->bricks[2], read_batch, &read);
}

static iso_status allocate_tables(iso_brick_index *index, iso_error *error) {
    index->lo = iso_alloc(index->total * sizeof *index->lo);
    index->hi = iso_alloc(index->total * sizeof *index->hi);
    index->flags = iso_alloc_zero(index->total, sizeof *index->flags);
    index->groups = iso_alloc(index->total * sizeof *index->groups);
    if (index->lo && index->hi && index->flags && index->groups) return ISO_OK;
    return iso_fail(error, ISO_ERR_NOMEM, "out of memory for an index of %zu bricks", index->total);
}

/* Reads all bricks; counts the values if they are integers and `count` is set. */
static iso_status read_and_count(iso_brick_index *index, iso_pool *pool, bool count, iso_error *error) {
    iso_value_counter *counter = NULL;
    if (count && index->grid->type != ISO_FLOAT32)
        ISO_TRY(iso_value_counter_create(index->grid, iso_pool_threads(pool), &counter, error));
    read_all(index, pool, counter);
    if (counter) index->counts = iso_value_counter_finish(counter);
    return ISO_OK;
}

static iso_status create(const iso_rgrid *grid, iso_pool *pool, bool count, iso_brick_index **out,
                         iso_error *error) {
    iso_brick_index *index = iso_alloc_zero(1, sizeof *index);
    if (!index) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for an index of bricks");
    index->grid = grid;
    index->total = 1;
    for (int axis = 0; axis < 3; axis++) {
        index->bricks[axis] = (grid->dims[axis] - 1) / ISO_BRICK + 1;
        index->total *= (size_t)index->bricks[axis]; /* no overflow: an rgrid has fewer than 2^32 bricks */
    }
    index->seen = iso_change_log_now(grid->log);
    index->level = iso_cpu_best();
    iso_status status = allocate_tables(index, error);
    if (status == ISO_OK) status = read_and_count(index, pool, count, error);
    if (status == ISO_OK)
        status = iso_interval_tree_build(&index->tree, index->lo, index->hi, (uint32_t)index->total, error);
    if (status != ISO_OK) {
        iso_brick_index_destroy(index);
        return status;
    }
    *out = index;
    return ISO_OK;
}

iso_status iso_brick_index_create(const iso_rgrid *grid, iso_pool *pool, iso_brick_index **index,
                                  iso_error *error) {
    return create(grid, pool, false, index, error);
}

void iso_brick_index_destroy(iso_brick_index *index) {
    if (!index) return;
    iso_free(index->counts);
    iso_free(index->lo);
    iso_free(index->hi);
    iso_free(index->flags);
    iso_free(index->groups);
    iso_interval_tree_free(&index->tree);
    iso_buffer_free(&index->pending);
    iso_buffer_free(&index->dirty);
    iso_buffer_free(&index->fresh);
    iso_free(index);
}

/* ---- updates */

static void mark_dirty(iso_brick_index *index, size_t brick) {
    if (index->flags[brick] & DIRTY) return;
    index->flags[brick] |= DIRTY;
    ((uint32_t *)index->dirty.data)[index->dirty_count++] = (uint32_t)brick;
}

/* Marks the brick of a change as dirty. If the change includes voxels of the brick's first layers, it also
 * marks the lower neighbours, whose ranges include those voxels. */
static void mark_change(iso_brick_index *index, const iso_change *change) {
    const size_t nx = (size_t)index->bricks[0], ny = (size_t)index->bricks[1];
    const size_t cell[3] = {change->cell % nx, change->cell / nx % ny, change->cell / nx / ny};
    const size_t step[3] = {1, nx, nx * ny};
    for (int corner = 0; corner < 8; corner++) {
        size_t brick = change->cell;
        bool sees = true;
        for (int axis = 0; axis < 3; axis++) {
            if (!(corner >> axis & 1)) continue;
            sees &= change->lo[axis] == 0 && cell[axis] > 0;
            brick -= step[axis];
        }
        if (sees) mark_dirty(index, brick);
    }
}

static void read_dirty(void *context, size_t i, int worker) {
    (void)worker;
    const iso_brick_index *index = context;
    const uint32_t brick = ((const uint32_t *)index->dirty.data)[i];
    const uint32_t nx = (uint32_t)index->bricks[0], ny = (uint32_t)index->bricks[1];
    const int at[3] = {(int)(brick % nx), (int)(brick / nx % ny), (int)(brick / nx / ny)};
    const iso_brick_batch batch = {{at[0], at[1], at[2]}, {1, 1}};
    iso_brick_ranges(index->grid, index->level, &batch, (iso_brick_reading *)index->fresh.data + i);
}

static void apply_reading(iso_brick_index *index, uint32_t brick, const iso_brick_reading *fresh) {
    const iso_brick_range *range = &fresh->range;
    const float lo = index->lo[brick], hi = index->hi[brick];
    const bool in_tree = lo < hi || range->lo < range->hi;
    const bool other = lo != range->lo || hi != range->hi;
    index->flags[brick] &= (uint8_t)~DIRTY;
    set_brick(index, brick, fresh);
    if (!in_tree || !other || index->flags[brick] & PENDING) return;
    index->flags[brick] |= PENDING;
    ((uint32_t *)index->pending.data)[index->pending_count++] = brick;
}

/* Rebuilds the tree if too many bricks are pending. If there is no memory for a new tree, the bricks stay
 * pending; queries are then slower, but right. */
static void rebuild_when_due(iso_brick_index *index) {
    if (index->pending_count <= index->total / PENDING_SHARE + PENDING_MIN) return;
    if (iso_interval_tree_build(&index->tree, index->lo, index->hi, (uint32_t)index->total, NULL) != ISO_OK)
        return;
    const uint32_t *pending = index->pending.data;
    for (size_t i = 0; i < index->pending_count; i++) index->flags[pending[i]] &= (uint8_t)~PENDING;
    index->pending_count = 0;
}

iso_status iso_brick_index_update(iso_brick_index *index, iso_pool *pool, iso_error *error) {
    const iso_change *changes = NULL;
    const size_t count = iso_change_log_since(index->grid->log, index->seen, &changes);
    size_t most = count > index->total / 8 ? index->total : 8 * count, pending = index->pending_count + most;
    if (pending > index->total) pending = index->total;
    ISO_TRY(iso_buffer_reserve(&index->dirty, most * sizeof(uint32_t), 0, error));
    ISO_TRY(iso_buffer_reserve(&index->fresh, most * sizeof(iso_brick_reading), 0, error));
    ISO_TRY(iso_buffer_reserve(&index->pending, pending * sizeof(uint32_t),
                               index->pending_count * sizeof(uint32_t), error));
    index->dirty_count = 0;
    if (count > 0) {
        iso_free(index->counts);
        index->counts = NULL;
    }
    for (size_t i = 0; i < count; i++) mark_change(index, &changes[i]);
    index->level = iso_cpu_best();
    iso_parallel_for(pool, index->dirty_count, read_dirty, index);
    const uint32_t *dirty = index->dirty.data;
    const iso_brick_reading *fresh = index->fresh.data;
    for (size_t i = 0; i < index->dirty_count; i++) apply_reading(index, dirty[i], &fresh[i]);
    index->seen = iso_change_log_now(index->grid->log);
    rebuild_when_due(index);
    return ISO_OK;
}

bool iso_brick_index_current(const iso_brick_index *index) {
    return index->seen == iso_change_log_now(index->grid->log);
}

static iso_status index_of(iso_rgrid *grid, iso_pool *pool, bool count, const iso_brick_index **index,
                           iso_error *error) {
    if (grid->index && !iso_brick_index_current(grid->index))
        ISO_TRY(iso_brick_index_update(grid->index, pool, error));
    if (!grid->index) {
        ISO_TRY(create(grid, pool, count, &grid->index, error));
        grid->destroy_index = iso_brick_index_destroy;
    }
    if (index) *index = grid->index;
    return ISO_OK;
}

iso_status iso_brick_index_of(iso_rgrid *grid, iso_pool *pool, const iso_brick_index **index,
                              iso_error *error) {
    return index_of(grid, pool, false, index, error);
}

iso_status iso_brick_index_with_counts(iso_rgrid *grid, iso_pool *pool, iso_error *error) {
    return index_of(grid, pool, true, NULL, error);
}

const iso_value_counts *iso_brick_index_counts(const iso_rgrid *grid) {
    return grid->index && iso_brick_index_current(grid->index) ? grid->index->counts : NULL;
}

/* ---- look-ups */

uint32_t iso_brick_index_number(const iso_brick_index *index, const int brick[3]) {
    const uint32_t nx = (uint32_t)index->bricks[0], ny = (uint32_t)index->bricks[1];
    return ((uint32_t)brick[2] * ny + (uint32_t)brick[1]) * nx + (uint32_t)brick[0];
}

iso_brick_range iso_brick_index_range(const iso_brick_index *index, uint32_t brick) {
    return (iso_brick_range){index->lo[brick], index->hi[brick], iso_brick_index_finite(index, brick)};
}

bool iso_brick_index_crosses(const iso_brick_index *index, uint32_t brick, float isovalue) {
    return index->lo[brick] < isovalue && index->hi[brick] >= isovalue;
}

uint32_t iso_brick_index_groups(const iso_brick_index *index, uint32_t brick, float isovalue) {
    const float lo = index->lo[brick], scale = iso_range_scale(lo, index->hi[brick]);
    const bool floats = index->grid->type == ISO_FLOAT32;
    /* `below`: the largest value below the isovalue; `at`: the smallest at or above it. For floats both are
     * taken to be the isovalue, so that a group too many may be included. */
    const float at = floats ? isovalue : ceilf(isovalue), below = floats ? isovalue : at - 1;
    const uint8_t most = iso_range_step(below, lo, scale), least = iso_range_step(at, lo, scale);
    const iso_group_ranges *groups = &index->groups[brick];
    uint32_t crossed = 0;
    for (int g = 0; g < ISO_ROW_GROUPS; g++)
        crossed |= (uint32_t)((groups->lo[g] <= most) & (groups->hi[g] >= least)) << g;
    return crossed;
}

void iso_brick_index_fetch(const iso_brick_index *index, uint32_t brick) {
    __builtin_prefetch(&index->lo[brick]);
    __builtin_prefetch(&index->hi[brick]);
    __builtin_prefetch(&index->groups[brick]);
}

bool iso_brick_index_finite(const iso_brick_index *index, uint32_t brick) {
    return index->flags[brick] & FINITE;
}

size_t iso_brick_index_bricks(const iso_brick_index *index) {
    return index->total;
}

size_t iso_brick_index_pending(const iso_brick_index *index) {
    return index->pending_count;
}

size_t iso_brick_index_bytes(const iso_brick_index *index) {
    return sizeof *index + (index->counts ? sizeof *index->counts : 0) +
           index->total * (2 * sizeof(float) + 1 + sizeof *index->groups) +
           iso_interval_tree_bytes(&index->tree) + index->pending.bytes + index->dirty.bytes +
           index->fresh.bytes;
}

/* The bytes of each brick: 41 for its ranges, groups and flags, 16 in the tree's lists, 8 for nodes, and 12
 * more while the tree is built. */
uint64_t iso_brick_index_estimate(const int dims[3]) {
    uint64_t bytes = 2 * sizeof(float) + 1 + sizeof(iso_group_ranges) + 3 * sizeof(iso_interval_end) +
                     sizeof(float) + 2 * sizeof(uint32_t);
    for (int axis = 0; axis < 3; axis++)
        if (__builtin_mul_overflow(bytes, (uint64_t)((dims[axis] - 1) / ISO_BRICK + 1), &bytes))
            return UINT64_MAX;
    const uint64_t fixed = sizeof(iso_brick_index) + 2 * (sizeof(float) + sizeof(uint32_t));
    return bytes < UINT64_MAX - fixed ? bytes + fixed : UINT64_MAX;
}

/* ---- queries */

/* Sorts the bricks of a query in ascending order: a radix sort by as many bytes as the largest number has. */
static void sort_bricks(iso_brick_query *query, size_t largest) {
    for (int shift = 0; largest >> shift; shift += 8) {
        const uint32_t *from = query->bricks.data;
        uint32_t *to = query->scratch.data;
        size_t offset[257] = {0};
        for (size_t i = 0; i < query->count; i++) offset[(from[i] >> shift & 255) + 1]++;
        for (int value = 0; value < 255; value++) offset[value + 1] += offset[value];
        for (size_t i = 0; i < query->count; i++) to[offset[from[i] >> shift & 255]++] = from[i];
        iso_buffer swap = query->bricks;
        query->bricks = query->scratch;
        query->scratch = swap;
    }
}

iso_status iso_brick_index_query(const iso_brick_index *index, float isovalue, iso_brick_query *query,
                                 iso_error *error) {
    iso_interval_run runs[ISO_INTERVAL_RUNS];
    query->count = 0;
    query->visited = index->pending_count;
    int run_count = iso_interval_tree_query(&index->tree, isovalue, runs, &query->visited);
    size_t most = index->pending_count;
    for (int i = 0; i < run_count; i++) most += runs[i].count;
    size_t bytes = most * sizeof(uint32_t);
    ISO_TRY(iso_buffer_reserve(&query->bricks, bytes, 0, error));
    ISO_TRY(iso_buffer_reserve(&query->scratch, bytes, 0, error));
    uint32_t *bricks = query->bricks.data;
    size_t count = 0;
    for (int i = 0; i < run_count; i++)
        for (size_t k = 0; k < runs[i].count; k++) {
            bricks[count] = runs[i].ends[k].interval;
            count += !(index->flags[bricks[count]] & PENDING);
        }
    const uint32_t *pending = index->pending.data;
    for (size_t i = 0; i < index->pending_count; i++)
        if (iso_brick_index_crosses(index, pending[i], isovalue)) bricks[count++] = pending[i];
    query->count = count;
    sort_bricks(query, index->total - 1);
    return ISO_OK;
}

void iso_brick_query_free(iso_brick_query *query) {
    iso_buffer_free(&query->bricks);
    iso_buffer_free(&query->scratch);
    *query = (iso_brick_query){0};
}

void iso_brick_index_extremes(const iso_brick_index *index, double *lo, double *hi) {
    *lo = INFINITY;
    *hi = -INFINITY;
    for (size_t i = 0; i < iso_brick_index_bricks(index); i++) {
        const iso_brick_range range = iso_brick_index_range(index, (uint32_t)i);
        if (!(range.lo <= range.hi)) continue; /* the brick has no finite voxel */
        if ((double)range.lo < *lo) *lo = (double)range.lo;
        if ((double)range.hi > *hi) *hi = (double)range.hi;
    }
}
