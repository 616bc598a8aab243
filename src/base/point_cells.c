/* point_cells: sorts points into cells of several sizes, lists blocks of cells by parity, and finds cells by
 * their coordinates in a hash table (hierarchical spatial hash grids: Eitz and Lixu 2007). */
#include "base/point_cells.h"

#include <stdlib.h>
#include <string.h>

#include "base/numbers.h"

enum {
    BLOCK_SHIFT = 3,             /* a block is 8 cells wide */
    CELL_BITS = 3 * BLOCK_SHIFT, /* of a key: the cell in its block */
    BLOCK_BITS = 16,             /* of a key: each of the block's coordinates */
    COORDINATE_BITS = BLOCK_BITS + BLOCK_SHIFT,
    LEVEL_BIT = CELL_BITS + 3 * BLOCK_BITS,
    /* Cells of the coarsest level by which the first point may lie behind the anchor: the anchor is a
     * multiple of the width of two blocks, so that cells and parities stay where they are when the box
     * around all points changes. */
    ANCHOR_CELLS = 2 << BLOCK_SHIFT
};

/* What determines the cell of a point. */
typedef struct placing {
    const iso_point_view *view;
    iso_affine affine;
    double factor;
    /* mm. Points outside lo .. hi are put into the cells nearest to them at its border: neighbours stay
     * neighbours. */
    double lo[3], hi[3];
    double anchor[3], largest; /* mm; the size of the cells of level 0 */
    int finest;                /* level */
} placing;

/* A point to be sorted. */
typedef struct record {
    uint64_t key;
    uint32_t span, index;
} record;

/* ---- places and keys */

/* Sets `position` to the point's position in mm, without the transform's origin; returns its reach, 0 for a
 * point that is left out. */
static double place_point(const placing *p, const iso_point_span *span, size_t index, double position[3]) {
    const iso_surfel surfel = iso_point_view_get(p->view, index);
    const iso_vec3 at = iso_affine_vector(&p->affine, iso_brick_position(span->brick, surfel.position));
    const double radius = p->view->radii ? (double)p->view->radii[index] : p->view->radius;
    iso_vec3_store(at, position);
    return iso_vec3_is_finite(at) && radius > 0 && isfinite(radius) ? radius * p->factor : 0;
}

static uint64_t key_of(int level, const uint32_t cell[3]) {
    uint64_t block = 0, inside = 0;
    for (int k = 2; k >= 0; k--) {
        block = block << BLOCK_BITS | cell[k] >> BLOCK_SHIFT;
        inside = inside << BLOCK_SHIFT | (cell[k] & ((1u << BLOCK_SHIFT) - 1));
    }
    return (uint64_t)level << LEVEL_BIT | block << CELL_BITS | inside;
}

static void cell_of(uint64_t key, uint32_t cell[3]) {
    for (int k = 0; k < 3; k++) {
        const uint64_t block = key >> (CELL_BITS + k * BLOCK_BITS) & ((1u << BLOCK_BITS) - 1),
                       inside = key >> (k * BLOCK_SHIFT) & ((1u << BLOCK_SHIFT) - 1);
        cell[k] = (uint32_t)(block << BLOCK_SHIFT | inside);
    }
}

static int parity_of(uint64_t block) {
    return (int)((block & 1) | (block >> BLOCK_BITS & 1) << 1 | (block >> 2 * BLOCK_BITS & 1) << 2);
}

/* Returns the finest level whose cells are at least twice as large as a reach. */
static int level_of(const placing *p, double reach) {
    int level = 0;
    for (double size = p->largest / 2; level < p->finest && size >= 2 * reach; size /= 2) level++;
    return level;
}

/* Chooses anchor and sizes of cells for lo .. hi. */
static void choose_sizes(placing *p, double most_reach) {
    double extent = 0;
    for (int k = 0; k < 3; k++) extent = fmax(extent, p->hi[k] - p->lo[k]);
    p->largest = fmax(2 * most_reach, extent / (1 << (COORDINATE_BITS - 1)));
    const double period = p->largest * ANCHOR_CELLS, most = (1 << COORDINATE_BITS) - 2;
    for (int k = 0; k < 3; k++) p->anchor[k] = floor(p->lo[k] / period) * period;
    double cells = extent / p->largest + ANCHOR_CELLS;
    for (p->finest = 0; p->finest < ISO_CELL_LEVELS - 1 && 2 * cells < most; p->finest++) cells *= 2;
}

/* Shrinks lo .. hi to the range of nearly all points of a sample of the view, extended by its own width on
 * both sides, so that a few points far away do not make all cells large. */
static void leave_outliers(placing *p, size_t count) {
    enum { SAMPLES = 1024, CUT = SAMPLES / 64 };
    double sample[3][SAMPLES], at[3];
    size_t taken = 0, seen = 0;
    for (size_t s = 0; s < p->view->span_count; s++) {
        const iso_point_span *span = &p->view->spans[s];
        for (size_t i = span->first; i < span->first + span->count; i++) {
            if (!(place_point(p, span, i, at) > 0)) continue;
            if (seen++ * SAMPLES / count < taken || taken == SAMPLES) continue;
            for (int k = 0; k < 3; k++) sample[k][taken] = at[k];
            taken++;
        }
    }
    for (int k = 0; k < 3 && taken == SAMPLES; k++) {
        qsort(sample[k], SAMPLES, sizeof(double), iso_compare_doubles);
        const double lo = sample[k][CUT], hi = sample[k][SAMPLES - 1 - CUT];
        p->lo[k] = fmax(p->lo[k], lo - (hi - lo));
        p->hi[k] = fmin(p->hi[k], hi + (hi - lo));
    }
}

/* Sets up the cells for a view; returns the number of its points that are not left out. */
static size_t measure(placing *p) {
    double *lo = p->lo, *hi = p->hi, most = 0, least = INFINITY;
    size_t count = 0;
    for (int k = 0; k < 3; k++) {
        lo[k] = INFINITY;
        hi[k] = -INFINITY;
    }
    for (size_t s = 0; s < p->view->span_count; s++) {
        const iso_point_span *span = &p->view->spans[s];
        for (size_t i = span->first; i < span->first + span->count; i++) {
            double at[3];
            const double reach = place_point(p, span, i, at);
            if (!(reach > 0)) continue;
            for (int k = 0; k < 3; k++) {
                lo[k] = at[k] < lo[k] ? at[k] : lo[k];
                hi[k] = at[k] > hi[k] ? at[k] : hi[k];
            }
            most = reach > most ? reach : most;
            least = reach < least ? reach : least;
            count++;
        }
    }
    if (!count) return 0;
    choose_sizes(p, most);
    if (p->finest < ISO_CELL_LEVELS - 1 && p->largest > 4 * least * (1 << p->finest)) {
        /* the box is so large that cells cannot be small enough */
        leave_outliers(p, count);
        choose_sizes(p, most);
    }
    return count;
}

static void make_records(const placing *p, record *records) {
    for (size_t s = 0; s < p->view->span_count; s++) {
        const iso_point_span *span = &p->view->spans[s];
        for (size_t i = span->first; i < span->first + span->count; i++) {
            double at[3];
            const double reach = place_point(p, span, i, at);
            if (!(reach > 0)) continue;
            const int level = level_of(p, reach);
            const double scale = (1 << level) / p->largest;
            uint32_t cell[3];
            for (int k = 0; k < 3; k++) {
                const double inside = at[k] < p->lo[k] ? p->lo[k] : at[k] > p->hi[k] ? p->hi[k] : at[k];
                cell[k] = (uint32_t)((inside - p->anchor[k]) * scale);
            }
            *records++ = (record){key_of(level, cell), (uint32_t)s, (uint32_t)i};
        }
    }
}

/* ---- sorting */

/* Sorts by one byte of the keys; returns false without moving anything if the byte is the same in all
 * keys. */
static bool sort_by_byte(const record *from, record *to, size_t count, int byte) {
    size_t start[257] = {0};
    for (size_t i = 0; i < count; i++) start[(from[i].key >> 8 * byte & 255) + 1]++;
    for (int k = 0; k < 256; k++)
        if (start[k + 1] == count) return false;
    for (int k = 0; k < 256; k++) start[k + 1] += start[k];
    for (size_t i = 0; i < count; i++) to[start[from[i].key >> 8 * byte & 255]++] = from[i];
    return true;
}

/* A stable radix sort by key; returns the sorted one of the two arrays. */
static record *sort_records(record *records, record *spare, size_t count) {
    for (int byte = 0; byte < 8; byte++) {
        if (!sort_by_byte(records, spare, count, byte)) continue;
        record *const sorted = spare;
        spare = records;
        records = sorted;
    }
    return records;
}

/* ---- cells, blocks and the hash table */

static size_t slot_of(const iso_point_cells *cells, uint64_t key) {
    return (size_t)(key * 0x9e3779b97f4a7c15u >> 20) & cells->table_mask;
}

static void fill_points(iso_point_cells *cells, const placing *p, const record *records) {
    iso_cell_point *to = cells->points.data;
    for (size_t i = 0; i < cells->point_count; i++) {
        double at[3];
        const double reach = place_point(p, &p->view->spans[records[i].span], records[i].index, at);
        to[i] = (iso_cell_point){.reach = (float)reach, .index = records[i].index};
        for (int k = 0; k < 3; k++) to[i].position[k] = (float)(at[k] - p->anchor[k]);
    }
}

static bool begins(const record *records, size_t i, int shift) {
    return i == 0 || records[i].key >> shift != records[i - 1].key >> shift;
}

static void fill_cells(iso_point_cells *cells, const record *records) {
    iso_point_cell *to = cells->cells.data;
    size_t count = 0;
    for (size_t i = 0; i < cells->point_count; i++)
        if (begins(records, i, 0)) to[count++] = (iso_point_cell){records[i].key, (uint32_t)i};
    to[count] = (iso_point_cell){UINT64_MAX, (uint32_t)cells->point_count};
}

/* Returns the number of the list for blocks of this block's level and parity. */
static size_t list_of(uint64_t block) {
    return (size_t)(block >> (LEVEL_BIT - CELL_BITS)) * ISO_CELL_PARITIES + (size_t)parity_of(block);
}

/* Makes the block of the cells from `first` on that have the same block in their keys. */
static iso_cell_block make_block(const iso_point_cell *cell, uint32_t first) {
    iso_cell_block block = {.key = cell[first].key >> CELL_BITS, .first = first, .end = first};
    for (; cell[block.end].key >> CELL_BITS == block.key; block.end++) {
        const unsigned inside = (unsigned)(cell[block.end].key & ((1u << CELL_BITS) - 1));
        block.occupied[inside >> 6] |= (uint64_t)1 << (inside & 63);
        for (unsigned z = (inside >> 6) + 1; z < 8; z++) block.before[z]++;
    }
    return block;
}

static void fill_blocks(iso_point_cells *cells) {
    iso_cell_block *blocks = cells->blocks.data;
    uint32_t *table = cells->table.data;
    size_t next[ISO_CELL_LEVELS * ISO_CELL_PARITIES];
    memcpy(next, cells->start, sizeof next);
    memset(table, 0, (cells->table_mask + 1) * sizeof *table);
    for (uint32_t i = 0; i < cells->cell_count;) {
        const iso_cell_block block = make_block(cells->cells.data, i);
        const size_t number = next[list_of(block.key)]++;
        size_t slot = slot_of(cells, block.key);
        while (table[slot]) slot = (slot + 1) & cells->table_mask;
        table[slot] = (uint32_t)number + 1;
        blocks[number] = block;
        i = block.end;
    }
}

/* Counts cells and blocks, and makes room for all arrays. */
static iso_status reserve(iso_point_cells *cells, const record *records, iso_error *error) {
    size_t blocks = 0, size = 2;
    memset(cells->start, 0, sizeof cells->start);
    for (size_t i = 0; i < cells->point_count; i++) {
        cells->cell_count += begins(records, i, 0);
        if (!begins(records, i, CELL_BITS)) continue;
        cells->levels |= 1u << (records[i].key >> LEVEL_BIT);
        cells->start[list_of(records[i].key >> CELL_BITS) + 1]++;
        blocks++;
    }
    for (size_t k = 0; k < ISO_CELL_LEVELS * ISO_CELL_PARITIES; k++) cells->start[k + 1] += cells->start[k];
    while (size < 2 * blocks) size *= 2;
    cells->table_mask = size - 1;
    ISO_TRY(iso_buffer_reserve(&cells->points, cells->point_count * sizeof(iso_cell_point), 0, error));
    ISO_TRY(iso_buffer_reserve(&cells->cells, (cells->cell_count + 1) * sizeof(iso_point_cell), 0, error));
    ISO_TRY(iso_buffer_reserve(&cells->blocks, blocks * sizeof(iso_cell_block), 0, error));
    return iso_buffer_reserve(&cells->table, size * sizeof(uint32_t), 0, error);
}

static iso_status build(iso_point_cells *cells, const placing *p, record *memory, iso_error *error) {
    make_records(p, memory);
    const record *records = sort_records(memory, memory + cells->point_count, cells->point_count);
    ISO_TRY(reserve(cells, records, error));
    fill_points(cells, p, records);
    fill_cells(cells, records);
    fill_blocks(cells);
    return ISO_OK;
}

iso_status iso_point_cells_make(iso_point_cells *cells, const iso_point_view *view, double factor,
                                iso_error *error) {
    placing p = {.view = view, .affine = iso_transform_affine(&view->transform), .factor = factor};
    for (size_t s = 0; s < view->span_count; s++)
        if (view->spans[s].first + view->spans[s].count >= UINT32_MAX)
            return iso_fail(error, ISO_ERR_LIMIT, "2^32 - 1 points or more");
    cells->cell_count = 0;
    cells->levels = 0;
    cells->point_count = measure(&p);
    record *memory = iso_alloc(2 * cells->point_count * sizeof *memory);
    if (!memory) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for cells of points");
    const iso_status status = build(cells, &p, memory, error);
    iso_free(memory);
    return status;
}

void iso_point_cells_free(iso_point_cells *cells) {
    iso_buffer_free(&cells->points);
    iso_buffer_free(&cells->cells);
    iso_buffer_free(&cells->blocks);
    iso_buffer_free(&cells->table);
    *cells = (iso_point_cells){0};
}

/* ---- queries */

int iso_point_cells_level(const iso_point_cells *cells, uint32_t cell) {
    return (int)(((const iso_point_cell *)cells->cells.data)[cell].key >> LEVEL_BIT);
}

const iso_cell_block *iso_point_cells_block(const iso_point_cells *cells, uint64_t key) {
    const iso_cell_block *blocks = cells->blocks.data;
    const uint32_t *table = cells->table.data;
    for (size_t slot = slot_of(cells, key); table[slot]; slot = (slot + 1) & cells->table_mask)
        if (blocks[table[slot] - 1].key == key) return &blocks[table[slot] - 1];
    return NULL;
}

int iso_point_cells_block_level(uint64_t key) {
    return (int)(key >> (LEVEL_BIT - CELL_BITS));
}

int iso_point_cells_blocks_around(uint64_t key, int level, uint64_t keys[ISO_CELL_BLOCKS_AROUND]) {
    /* A cell's neighbours are at most one cell of `level` away from it, hence at most one block. */
    const int finer = iso_point_cells_block_level(key) - level, last = (1 << BLOCK_BITS) - 1;
    int at[3], count = 0;
    for (int k = 0; k < 3; k++) at[k] = (int)(key >> (k * BLOCK_BITS) & (uint64_t)last) >> finer;
    for (int i = 0; i < ISO_CELL_BLOCKS_AROUND; i++) {
        const int x = at[0] + i % 3 - 1, y = at[1] + i / 3 % 3 - 1, z = at[2] + i / 9 - 1;
        if (x < 0 || y < 0 || z < 0 || x > last || y > last || z > last) continue;
        keys[count++] = (uint64_t)level << (LEVEL_BIT - CELL_BITS) | (uint64_t)z << 2 * BLOCK_BITS |
                        (uint64_t)y << BLOCK_BITS | (uint64_t)x;
    }
    return count;
}

/* The blocks around a cell. There are 8 of them at most, one for each parity. */
typedef struct found_blocks {
    uint64_t key[ISO_CELL_PARITIES];
    const iso_cell_block *block[ISO_CELL_PARITIES];
} found_blocks;

static const iso_cell_block *find_again(const iso_point_cells *cells, found_blocks *found, uint64_t key) {
    const int parity = parity_of(key);
    if (found->key[parity] != key) {
        found->key[parity] = key;
        found->block[parity] = iso_point_cells_block(cells, key);
    }
    return found->block[parity];
}

/* Appends the points of cells x .. last of a row in one block: cells of a row follow each other. */
static int add_row(const iso_point_cells *cells, found_blocks *found, int level, const uint32_t at[3],
                   uint32_t last, iso_cell_range *ranges, int count) {
    const uint64_t key = key_of(level, at);
    const iso_cell_block *block = find_again(cells, found, key >> CELL_BITS);
    const unsigned inside = (unsigned)(key & ((1u << CELL_BITS) - 1)), z = inside >> 6;
    const uint64_t bit = (uint64_t)1 << (inside & 63), row = (((uint64_t)2 << (last - at[0])) - 1) * bit;
    if (!block || !(block->occupied[z] & row)) return count;
    const iso_point_cell *cell = (const iso_point_cell *)cells->cells.data + block->first + block->before[z] +
                                 __builtin_popcountll(block->occupied[z] & (bit - 1));
    const int wide = __builtin_popcountll(block->occupied[z] & row);
    ranges[count] = (iso_cell_range){cell[0].first, cell[wide].first};
    return count + 1;
}

/* Finds the cells first .. last, along one axis, of a level that can hold neighbours of points in cell `at`
 * of a level that is `finer` levels finer: reaches are half of the cells' sizes at most. */
static void find_cells(uint32_t at, int finer, uint32_t *first, uint32_t *last) {
    const int64_t size = (int64_t)1 << finer, lo = 2 * (int64_t)at - size - 1,
                  hi = 2 * (int64_t)at + 2 + size;
    *first = lo < 0 ? 0 : (uint32_t)(lo >> (finer + 1));
    *last = (uint32_t)(hi >> (finer + 1));
}

int iso_point_cells_around(const iso_point_cells *cells, uint32_t cell, int level,
                           iso_cell_range ranges[ISO_CELL_ROWS]) {
    found_blocks found;
    uint32_t at[3], first[3], last[3];
    int count = 0;
    memset(found.key, 0xff, sizeof found.key); /* no block has this key */
    cell_of(((const iso_point_cell *)cells->cells.data)[cell].key, at);
    for (int k = 0; k < 3; k++)
        find_cells(at[k], iso_point_cells_level(cells, cell) - level, &first[k], &last[k]);
    for (uint32_t z = first[2]; z <= last[2]; z++)
        for (uint32_t y = first[1]; y <= last[1]; y++)
            for (uint32_t x = first[0], end; x <= last[0]; x = end + 1) {
                const uint32_t block_end = x | ((1u << BLOCK_SHIFT) - 1);
                end = last[0] < block_end ? last[0] : block_end;
                count = add_row(cells, &found, level, (const uint32_t[3]){x, y, z}, end, ranges, count);
            }
    return count;
}

int iso_point_cells_all_around(const iso_point_cells *cells, uint32_t cell,
                               iso_cell_range ranges[ISO_CELL_RANGES], int *coarser) {
    const int own = iso_point_cells_level(cells, cell);
    int count = 0;
    for (int level = 0; level <= own; level++) {
        if (coarser && level == own) *coarser = count;
        if (cells->levels >> level & 1) count += iso_point_cells_around(cells, cell, level, ranges + count);
    }
    return count;
}
