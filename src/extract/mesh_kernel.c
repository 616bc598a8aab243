#include "extract/mesh_kernel.h"

#include <string.h>

#if ISO_HAVE_X86
#include <immintrin.h>
#endif

#include "mc_table.h"

#ifdef __clang__
#define ISO_STEP __attribute__((noinline))
#else
#define ISO_STEP __attribute__((noipa)) /* as in edge_kernel.c: gcc 12 must not look into these */
#endif

/* ---- lists */

/* The words of a row of cells: (y, z), (y + 1, z), (y, z + 1), (y + 1, z + 1); `after`: one voxel on in x. */
typedef struct row_words {
    uint64_t at[4], after[4];
} row_words;

/* What of a block lies in the grid and in wanted bricks: bits of x, and for y and z how many. */
typedef struct block_limits {
    uint64_t own, far; /* edges of a brick's own, and on its y and z faces */
    uint64_t faces;    /* x faces, at the voxel before */
    uint64_t cells;
    int rows[3], last[3]; /* rows of own edges; the last voxel, 0 .. 16, which is also the number of cells */
} block_limits;

/* Where the lists end so far, and points in them as four 16-bit counts. */
typedef struct list_ends {
    int own[3], far[3];
    uint64_t own_lanes, far_lanes;
} list_ends;

static uint64_t bits_below(int count) {
    return count <= 0 ? 0 : count < 64 ? ((uint64_t)1 << count) - 1 : ~(uint64_t)0;
}

static block_limits limits_of(const iso_edge_source *source, const iso_mesh_block *block) {
    block_limits limits = {0};
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

/* Whether the block has an edge: its voxels and the next ones are not all alike. */
static bool words_differ(const uint64_t *bits, const uint64_t *next) {
    uint64_t any = 0, all = ~(uint64_t)0;
    for (int i = 0; i < ISO_EDGE_SIDE * ISO_EDGE_SIDE; i++) {
        uint64_t after = 0 - (next[i] & 1);
        any |= bits[i] | after;
        all &= bits[i] & after;
    }
    return any != 0 && ~all != 0;
}

static inline row_words row_words_at(const uint64_t *bits, const uint64_t *next, int i) {
    const int index[4] = {i, i + 1, i + ISO_EDGE_SIDE, i + ISO_EDGE_SIDE + 1};
    row_words row;
    for (int k = 0; k < 4; k++) {
        row.at[k] = bits[index[k]];
        row.after[k] = row.at[k] >> 1 | next[index[k]] << 63;
    }
    return row;
}

/* Cells whose corners differ. */
static inline uint64_t active_cells(const row_words *row) {
    uint64_t any = 0, all = ~(uint64_t)0;
    for (int k = 0; k < 4; k++) {
        any |= row->at[k] | row->after[k];
        all &= row->at[k] & row->after[k];
    }
    return any & ~all;
}

static inline void append_far(iso_far_list *list, int *end, uint64_t mask, int row) {
    list->mask[*end] = mask;
    list->row[*end] = (uint16_t)row;
    *end += mask != 0;
}

/* A row at y = 16 or z = 16: its own edges belong to neighbours, and so do those where it leaves a brick
 * along x. */
static void list_far_row(const uint64_t *bits, const uint64_t *next, const block_limits *limits, int row,
                         list_ends *ends, iso_mesh_block *block) {
    const int y = row & 31, z = row >> 5, i = z * ISO_EDGE_SIDE + y;
    for (int axis = 0; axis < 3; axis++) {
        if ((axis == 1 && y == ISO_BRICK) || (axis == 2 && z == ISO_BRICK)) continue;
        const int step = axis == 1 ? 1 : ISO_EDGE_SIDE;
        uint64_t edges = bits[i] ^ (axis ? bits[i + step] : bits[i] >> 1 | next[i] << 63);
        uint64_t faces = axis ? (edges >> 1 | (next[i] ^ next[i + step]) << 63) & limits->faces : 0;
        edges &= limits->far;
        append_far(&block->far_list[axis], &ends->far[axis], edges, row);
        append_far(&block->far_list[axis], &ends->far[axis], faces, row | ISO_EDGE_FACE);
        ends->far_lanes += iso_edge_lane_counts(edges) + iso_edge_lane_counts(faces);
    }
}

static void finish_lists(const list_ends *ends, iso_mesh_block *block) {
    for (int axis = 0; axis < 3; axis++) {
        block->own_list[axis].count = ends->own[axis];
        block->far_list[axis].count = ends->far[axis];
    }
    for (int brick = 0; brick < ISO_EDGE_BRICKS; brick++) {
        block->own[brick] = ends->own_lanes >> (16 * brick) & 0xffff;
        block->far[brick] = ends->far_lanes >> (16 * brick) & 0xffff;
        const iso_cell_list *cells = &block->cells[brick];
        uint32_t triangles = 0;
        for (uint32_t i = 0; i < cells->count; i++) triangles += mc_cases[0][cells->inside[i]].triangles;
        block->triangles[brick] = triangles;
    }
}

#include "extract/mesh_kernel_variants.inc"

/* ---- triangles */

/* Two triangles are written always: most cells have one or two. */
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

ISO_STEP static void number_vertices(const iso_edge_key *keys, uint32_t count, uint16_t *vertex_of) {
    for (uint32_t i = 0; i < count; i++) vertex_of[keys[i]] = (uint16_t)i;
}

/* Room of bricks that are not wanted is never touched, but the edge kernel asks whether there is any. */
static iso_edge_output edge_output(const iso_mesh_block *block, const iso_mesh_output *output, bool far) {
    iso_edge_output edges = {0};
    for (int brick = 0; brick < ISO_EDGE_BRICKS; brick++) {
        const int from = block->bricks >> brick & 1 ? brick : __builtin_ctz(block->bricks);
        const uint32_t skip = far ? block->own[from] : 0;
        edges.surfels[brick] = output->vertices[from] + skip;
        edges.keys[brick] = output->keys[from] + skip;
    }
    return edges;
}

void iso_mesh_kernel_fill(const iso_mesh_kernel *kernel, const iso_edge_source *source, iso_mesh_block *block,
                          const iso_mesh_output *output) {
    iso_edge_entries own[3], far[3];
    for (int axis = 0; axis < 3; axis++) {
        const iso_edge_list *o = &block->own_list[axis];
        const iso_far_list *f = &block->far_list[axis];
        own[axis] = (iso_edge_entries){o->mask, o->row, o->count};
        far[axis] = (iso_edge_entries){f->mask, f->row, f->count};
    }
    iso_edge_output edges = edge_output(block, output, false);
    kernel->edges->fill_entries(source, block->origin, own, &edges);
    edges = edge_output(block, output, true);
    kernel->edges->fill_entries(source, block->origin, far, &edges);
    for (int brick = 0; brick < ISO_EDGE_BRICKS; brick++) {
        if (!(block->bricks >> brick & 1)) continue;
        number_vertices(output->keys[brick], block->own[brick] + block->far[brick], block->vertex_of);
        add_triangles(&block->cells[brick], block->vertex_of, source->level_set, output->triangles[brick]);
    }
}

iso_mesh_kernel iso_mesh_kernel_get(iso_type type, iso_cpu_level level) {
    iso_mesh_kernel kernel = {.edges = iso_edge_kernel_get(type, level), .list = list_generic};
#if ISO_HAVE_X86
    if (level == ISO_CPU_AVX2) kernel.list = list_avx2;
    if (level == ISO_CPU_AVX512) kernel.list = list_avx512;
#endif
    return kernel;
}
