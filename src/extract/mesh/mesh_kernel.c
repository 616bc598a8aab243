/* mesh_kernel: lists the edges and active cells of a block, and writes triangles from the case table. */
#include "extract/mesh/mesh_kernel.h"

#include <string.h>

#include "base/simd.h"
#include "mc_table.h"

/* ---- lists */

/* The classified voxels of a block by row (z * 17 + y), as words of bits by x. */
enum { ROWS = ISO_EDGE_SIDE * ISO_EDGE_SIDE, CELL_ROWS = ROWS - ISO_EDGE_SIDE - 1 };
typedef struct block_rows {
    uint64_t at[ROWS];                /* bit x: voxel x is inside */
    uint64_t after[ROWS];             /* bit x: voxel x + 1 is inside */
    uint64_t any[ROWS], all[ROWS];    /* bit x: voxel x or voxel x + 1 is inside; both are */
    uint64_t active[CELL_ROWS];       /* bit x: cell x has corners inside and outside */
    uint16_t list[ISO_EDGE_ROWS + 1]; /* numbers (z << 5 | y) of the rows with active cells */
    int count;                        /* length of the list */
} block_rows;

/* The part of a block that lies in the grid and in wanted bricks: bits by x, and limits on y and z. */
typedef struct block_limits {
    uint64_t own;   /* bit x: a wanted brick owns the edges that begin at voxel x */
    uint64_t far;   /* bit x: a wanted brick has far edges that begin at voxel x on its far y or z face */
    uint64_t faces; /* bit x: voxel x is the last of a wanted brick, whose far x face is at x + 1 */
    uint64_t cells; /* bit x: cell x is in the grid and in a wanted brick */
    iso_edge_active active;
    int rows[3]; /* by axis: own edges begin at the voxels 0 .. rows - 1 */
    int last[3]; /* by axis: the last voxel, 0 .. 16, which is also the number of cells */
} block_limits;

/* The current lengths of the lists of own and far edges. */
typedef struct list_ends {
    int own[3], far[3];
} list_ends;

static uint64_t bits_below(int count) {
    return count <= 0 ? 0 : count < 64 ? ((uint64_t)1 << count) - 1 : ~(uint64_t)0;
}

static block_limits limits_of(const iso_edge_source *source, iso_edge_active active,
                              const iso_mesh_block *block) {
    block_limits limits = {.active = active};
    int left[3];
    for (int axis = 0; axis < 3; axis++) {
        left[axis] = source->dims[axis] - block->origin[axis];
        limits.rows[axis] = left[axis] < ISO_BRICK ? left[axis] : ISO_BRICK;
        limits.last[axis] = left[axis] - 1 < ISO_BRICK ? left[axis] - 1 : ISO_BRICK;
    }
    uint64_t lanes = 0;
    for (int brick = 0; brick < ISO_EDGE_BRICKS; brick++)
        lanes |= (uint64_t)(block->bricks >> brick & 1) * 0xffff << (16 * brick);
    limits.own = bits_below(left[0]) & lanes;
    if (limits.last[1] == 0 || limits.last[2] == 0) return limits; /* a layer of one voxel has no cells */
    limits.cells = bits_below(left[0] - 1) & lanes;
    limits.faces = limits.cells & 0x8000800080008000u;
    limits.far = limits.own;
    if (left[0] % ISO_BRICK == 1 && left[0] < 64) limits.far &= bits_below(left[0] - 1);
    return limits;
}

static inline void append_far(iso_far_list *list, int *end, uint64_t mask, int row) {
    list->mask[*end] = mask;
    list->row[*end] = (uint16_t)row;
    *end += mask != 0;
}

/* Lists the edges that begin in a row with y = 16 or z = 16. All of them are far edges: those along the row's
 * bricks, and those on the bricks' far x faces. */
static void list_far_row(const block_rows *rows, const block_limits *limits, int row, list_ends *ends,
                         iso_mesh_block *block) {
    const int y = row & 31, z = row >> 5, i = z * ISO_EDGE_SIDE + y;
    const int group = (z < ISO_BRICK ? z : ISO_BRICK - 1) / 4 * 4 + (y < ISO_BRICK ? y : ISO_BRICK - 1) / 4;
    if (!(limits->active.groups >> group & 1)) return;
    for (int axis = 0; axis < 3; axis++) {
        if ((axis == 1 && y == ISO_BRICK) || (axis == 2 && z == ISO_BRICK)) continue;
        const int step = axis == 1 ? 1 : ISO_EDGE_SIDE;
        const uint64_t edges = rows->at[i] ^ (axis ? rows->at[i + step] : rows->after[i]);
        append_far(&block->far_list[axis], &ends->far[axis], edges & limits->far, row);
        if (axis == 0) continue;
        const uint64_t faces = rows->after[i] ^ rows->after[i + step];
        append_far(&block->far_list[axis], &ends->far[axis], faces & limits->faces, row | ISO_EDGE_FACE);
    }
}

/* The key of the first edge of row i (z * 17 + y). */
static inline uint16_t first_key(int i) {
    return (uint16_t)(i * ISO_LATTICE);
}

#if ISO_LANES < 16
/* Appends cell x of a row to the list of its brick. words: bits 0 and 1 of each are two of the cell's
 * corners; key: of the row's first edge. */
static inline void add_cell(const uint64_t words[4], int key, int x, iso_mesh_block *block) {
    iso_cell_list *cells = &block->cells[x / ISO_BRICK];
    cells->key[cells->count] = (uint16_t)(key + x % ISO_BRICK);
    cells->inside[cells->count++] =
        (uint8_t)((words[0] & 3) | (words[1] & 3) << 2 | (words[2] & 3) << 4 | (words[3] & 3) << 6);
}

/* Appends the active cells of row i that are in `valid` to the lists of their bricks. */
static inline void add_cells(const block_rows *rows, int i, uint64_t valid, iso_mesh_block *block) {
    const int at[4] = {i, i + 1, i + ISO_EDGE_SIDE, i + ISO_EDGE_SIDE + 1};
    const uint64_t active = rows->active[i] & valid;
    uint64_t words[4];
    for (uint64_t left = active & INT64_MAX; left; left &= left - 1) {
        const int x = __builtin_ctzll(left);
        for (int k = 0; k < 4; k++) words[k] = rows->at[at[k]] >> x;
        add_cell(words, first_key(i), x, block);
    }
    if (!(active >> 63)) return;
    for (int k = 0; k < 4; k++) words[k] = rows->after[at[k]] >> 62;
    add_cell(words, first_key(i), 63, block);
}
#else
/* Appends them: computes the cases of all 64 cells of a row at once, then compresses those of active cells.
 */
static inline void add_cells(const block_rows *rows, int i, uint64_t valid, iso_mesh_block *block) {
    const int at[4] = {i, i + 1, i + ISO_EDGE_SIDE, i + ISO_EDGE_SIDE + 1};
    const uint64_t active = rows->active[i] & valid;
    __m512i inside = _mm512_setzero_si512();
    for (int k = 0; k < 4; k++) {
        const __m512i low = _mm512_set1_epi8((char)(1 << 2 * k)), high = _mm512_set1_epi8((char)(2 << 2 * k));
        inside = _mm512_mask_add_epi8(inside, rows->at[at[k]], inside, low);
        inside = _mm512_mask_add_epi8(inside, rows->after[at[k]], inside, high);
    }
    const __m256i keys =
        _mm256_add_epi16(_mm256_set1_epi16((short)first_key(i)),
                         _mm256_set_epi16(15, 14, 13, 12, 11, 10, 9, 8, 7, 6, 5, 4, 3, 2, 1, 0));
    const __m128i lane[4] = {_mm512_castsi512_si128(inside), _mm512_extracti32x4_epi32(inside, 1),
                             _mm512_extracti32x4_epi32(inside, 2), _mm512_extracti32x4_epi32(inside, 3)};
    for (int brick = 0; brick < ISO_EDGE_BRICKS; brick++) {
        iso_cell_list *cells = &block->cells[brick];
        const __mmask16 part = (__mmask16)(active >> (16 * brick));
        _mm256_storeu_si256((void *)(cells->key + cells->count), _mm256_maskz_compress_epi16(part, keys));
        _mm_storeu_si128((void *)(cells->inside + cells->count), _mm_maskz_compress_epi8(part, lane[brick]));
        cells->count += (uint32_t)__builtin_popcount(part);
    }
}
#endif

/* ---- triangles */

enum { STEP_Y = ISO_LATTICE, STEP_Z = ISO_LATTICE * ISO_LATTICE };

/* Writes the triangles of a brick (iso_mesh_kernel). */
#if ISO_LANES == 4
/* Two triangles are always written, as most cells have one or two; the next cell overwrites a triangle that
 * is not there. */
ISO_STEP static void add_triangles(const iso_cell_list *cells, const uint16_t *vertex_of, bool flip,
                                   uint16_t (*triangles)[3]) {
    uint16_t *out = triangles[0];
    for (uint32_t i = 0; i < cells->count; i++) {
        const mc_case *row = &mc_cases[flip][cells->inside[i]];
        const uint16_t *near = vertex_of + cells->key[i];
        for (int k = 0; k < 6; k++) out[k] = near[row->key[k]];
        if (row->triangles > 2)
            for (int k = 6; k < 15; k++) out[k] = near[row->key[k]];
        out += 3 * row->triangles;
    }
}
#else
/* Two consecutive numbers of 16 bits as one int. */
static inline int pair_at(const uint16_t *numbers) {
    int pair;
    memcpy(&pair, numbers, sizeof pair);
    return pair;
}

/* Reads the vertex numbers of a cell's twelve edges, and shuffles them into up to five triangles, without
 * branches. */
ISO_STEP static void add_triangles(const iso_cell_list *cells, const uint16_t *vertex_of, bool flip,
                                   uint16_t (*triangles)[3]) {
    uint16_t *out = triangles[0];
    for (uint32_t i = 0; i < cells->count; i++) {
        const uint8_t *shuffle = mc_shuffles[flip][cells->inside[i]];
        const uint16_t *x = vertex_of + cells->key[i], *y = x + ISO_LATTICE_VOXELS,
                       *z = y + ISO_LATTICE_VOXELS;
        const __m128i along_x =
            _mm_set_epi32(pair_at(x + STEP_Z + STEP_Y), pair_at(x + STEP_Z), pair_at(x + STEP_Y), pair_at(x));
        const __m128i others =
            _mm_set_epi32(pair_at(z + STEP_Y), pair_at(z), pair_at(y + STEP_Z), pair_at(y));
        const __m256i low = _mm256_shuffle_epi8(_mm256_broadcastsi128_si256(along_x),
                                                _mm256_loadu_si256((const void *)shuffle));
        const __m256i high = _mm256_shuffle_epi8(_mm256_broadcastsi128_si256(others),
                                                 _mm256_loadu_si256((const void *)(shuffle + 32)));
        _mm256_storeu_si256((void *)out, _mm256_or_si256(low, high));
        out += 3 * mc_cases[0][cells->inside[i]].triangles;
    }
}
#endif

/* ---- blocks */

/* Sets `rows` from the inside bits of a block (`bits`) and of the next block along x (`next`). */
static void find_rows(const uint64_t *restrict bits, const uint64_t *restrict next,
                      const block_limits *limits, block_rows *restrict rows) {
    for (int i = 0; i < ROWS; i++) {
        rows->at[i] = bits[i];
        rows->after[i] = bits[i] >> 1 | next[i] << 63;
        rows->any[i] = rows->at[i] | rows->after[i];
        rows->all[i] = rows->at[i] & rows->after[i];
    }
    for (int i = 0; i < CELL_ROWS; i++) {
        const uint64_t any =
            rows->any[i] | rows->any[i + 1] | rows->any[i + ISO_EDGE_SIDE] | rows->any[i + ISO_EDGE_SIDE + 1];
        const uint64_t all =
            rows->all[i] & rows->all[i + 1] & rows->all[i + ISO_EDGE_SIDE] & rows->all[i + ISO_EDGE_SIDE + 1];
        rows->active[i] = any & ~all;
    }
    rows->count = 0;
    for (int z = 0; z < limits->rows[2]; z++) {
        const uint32_t wanted = iso_edge_rows_own(limits->active, z);
        for (int y = 0; y < limits->rows[1]; y++) { /* always written, counted only if active: no branches */
            rows->list[rows->count] = (uint16_t)(z << 5 | y);
            rows->count += (rows->active[z * ISO_EDGE_SIDE + y] != 0) & wanted >> y;
        }
    }
}

/* Lists the crossed edges that begin in a row with y, z < 16: the bricks' own edges, and the far edges on
 * their x faces. */
static inline void list_row(const block_rows *rows, const block_limits *limits, int row, list_ends *ends,
                            iso_mesh_block *block) {
    const int i = (row >> 5) * ISO_EDGE_SIDE + (row & 31);
    const uint64_t edges[3] = {rows->at[i] ^ rows->after[i], rows->at[i] ^ rows->at[i + 1],
                               rows->at[i] ^ rows->at[i + ISO_EDGE_SIDE]};
    const uint64_t faces[3] = {0, rows->after[i] ^ rows->after[i + 1],
                               rows->after[i] ^ rows->after[i + ISO_EDGE_SIDE]};
    for (int axis = 0; axis < 3; axis++) {
        const uint64_t own = edges[axis] & limits->own;
        block->own_list[axis].mask[ends->own[axis]] = own;
        block->own_list[axis].row[ends->own[axis]] = (uint16_t)row;
        ends->own[axis] += own != 0;
        if (axis > 0)
            append_far(&block->far_list[axis], &ends->far[axis], faces[axis] & limits->faces,
                       row | ISO_EDGE_FACE);
    }
}

/* Lists the edges and cells of all rows, in the order of rows. Rows with y = 16 or z = 16 have far edges
 * only. */
static void list_rows(const block_rows *rows, const block_limits *limits, list_ends *ends,
                      iso_mesh_block *block) {
    int z = 0;
    for (int n = 0; n <= rows->count; n++) {
        const int row = n < rows->count ? rows->list[n] : limits->rows[2] << 5;
        for (; z < row >> 5; z++)
            if (limits->last[1] == ISO_BRICK) list_far_row(rows, limits, z << 5 | ISO_BRICK, ends, block);
        if (n == rows->count) break;
        list_row(rows, limits, row, ends, block);
        const int y = row & 31;
        if (y < limits->last[1] && z < limits->last[2])
            add_cells(rows, z * ISO_EDGE_SIDE + y, limits->cells, block);
    }
    if (limits->last[2] == ISO_BRICK)
        for (int y = 0; y <= limits->last[1]; y++)
            list_far_row(rows, limits, ISO_BRICK << 5 | y, ends, block);
}

/* The number of edges of a list in each of the block's four bricks, 16 bits a brick. */
static inline uint64_t lanes(const uint64_t *mask, int count) {
    uint64_t lanes = 0;
    for (int i = 0; i < count; i++) lanes += iso_edge_lane_counts(mask[i]);
    return lanes;
}

/* Sets the lengths of the block's lists of edges, and the number of own and far edges of each brick. */
static void count_block(const list_ends *ends, iso_mesh_block *block) {
    uint64_t own = 0, far = 0;
    for (int axis = 0; axis < 3; axis++) {
        block->own_list[axis].count = ends->own[axis];
        block->far_list[axis].count = ends->far[axis];
        own += lanes(block->own_list[axis].mask, ends->own[axis]);
        far += lanes(block->far_list[axis].mask, ends->far[axis]);
    }
    for (int brick = 0; brick < ISO_EDGE_BRICKS; brick++) {
        block->own[brick] = own >> (16 * brick) & 0xffff;
        block->far[brick] = far >> (16 * brick) & 0xffff;
        const iso_cell_list *cells = &block->cells[brick];
        uint32_t triangles = 0;
        for (uint32_t i = 0; i < cells->count; i++) triangles += mc_cases[0][cells->inside[i]].triangles;
        block->triangles[brick] = triangles;
    }
}

ISO_STEP static void list_block(const iso_edge_source *source, const iso_edge_words *words, int number,
                                iso_mesh_block *block) {
    list_ends ends = {0};
    block_rows rows;
    const block_limits limits = limits_of(source, words->active[number], block);
    for (int brick = 0; brick < ISO_EDGE_BRICKS; brick++) block->cells[brick].count = 0;
    find_rows(words->bits[number], words->bits[number + 1], &limits, &rows);
    if (rows.count) list_rows(&rows, &limits, &ends, block);
    count_block(&ends, block);
}

const iso_mesh_kernel ISO_KERNEL_NAME(iso_mesh_kernel) = {list_block, add_triangles};
