/* edge_kernel: edge points of a block of four bricks in a row (64 x 16 x 16 voxels).
 *
 * One source (edge_kernel.c), compiled once for each voxel type and instruction set; every variant gives
 * the same bytes. There are two steps, so that the number of points is known, and memory is allocated, before
 * they are computed: `list_edges` classifies the block's voxels into 64-bit words, a bit per voxel, and lists
 * the crossed edges as the non-empty words of each edge direction; `compute_points` expands the words, copies
 * the edges' neighbouring voxels into arrays, and computes the points in whole vectors. Points are in the
 * order of the edge's axis, then z, y, x of its lower voxel. Sources: Baerentzen and Christensen 2003,
 * section 4; the row passes of Flying Edges (Schroeder, Maynard and Geveci 2015), here with bit masks. */
#ifndef ISO_EXTRACT_POINTS_EDGE_KERNEL_H
#define ISO_EXTRACT_POINTS_EDGE_KERNEL_H

#include <stdbool.h>
#include <stdint.h>

#include "base/cpu.h"
#include "base/primitives.h"
#include "grids/rgrid.h"

enum {
    ISO_EDGE_BRICKS = 4,                            /* bricks in a block, along x */
    ISO_EDGE_BLOCK_X = ISO_EDGE_BRICKS * ISO_BRICK, /* = bits of a mask word */
    ISO_EDGE_ROWS = ISO_BRICK * ISO_BRICK           /* words of an axis */
};

/* A row of a block is named by the number z << 5 | y, both 0 .. 16. The row's edges are a 64-bit word, whose
 * bit x stands for the edge that begins at voxel x. In a row whose number has the flag ISO_EDGE_FACE it
 * stands for the edge that begins at voxel x + 1, so that the last bit of a brick is an edge in the first
 * face of the next brick along x. */
enum { ISO_EDGE_FACE = 1 << 10, ISO_EDGE_ROW_NAMES = 2 << 10 };

/* A dense grid, without NaN or infinity where edges are extracted, and the isovalue. */
typedef struct iso_edge_source {
    const void *data;             /* the voxel (0, 0, 0) */
    ptrdiff_t stride_y, stride_z; /* elements */
    int dims[3];                  /* one past the grid's last voxel, by axis */
    float isovalue_ceil;
    bool level_set; /* normals point to higher values, else to lower ones */
    float residual; /* as in iso_threshold: the isovalue is isovalue_ceil + residual */
    int first[3];   /* the grid's first voxel: below 0 where `data` is a window into it */
    ptrdiff_t row_offset[ISO_EDGE_ROW_NAMES]; /* elements, by row number; set by iso_edge_source_prepare */
} iso_edge_source;

/* Sets row_offset, after the caller has set the other fields. */
void iso_edge_source_prepare(iso_edge_source *source);

/* The crossed edges along one axis, as words: bit x of mask[i] is the edge at voxel x of row[i]. Words
 * without edges are left out. */
enum { ISO_EDGE_LIST_SLACK = 8 }; /* words written past the end of a list */
typedef struct iso_edge_list {
    int count;
    uint64_t mask[ISO_EDGE_ROWS + ISO_EDGE_LIST_SLACK];
    uint16_t row[ISO_EDGE_ROWS + ISO_EDGE_LIST_SLACK];
} iso_edge_list;

/* A list of edges, borrowed. */
typedef struct iso_edge_entries {
    const uint64_t *mask;
    const uint16_t *row;
    int count;
} iso_edge_entries;

/* The part of a block that is to be extracted: bit k of `bricks` is brick k; bit k of `groups` is row group k
 * (grids/brick_range.h), which may have edges in at least one of these bricks. */
typedef struct iso_edge_active {
    uint16_t groups;
    uint8_t bricks;
} iso_edge_active;
#define ISO_EDGE_WHOLE ((iso_edge_active){.groups = 0xffff, .bricks = 15})

/* Rows of slice z (0 .. 16), a bit per row y. iso_edge_rows_read: the rows with voxels of the edges of the
 * active groups (y in 0 .. 16); iso_edge_rows_own: the rows with the lower voxels of these edges (y in 0 ..
 * 15). */
static inline uint32_t iso_edge_group_rows(uint32_t groups) { /* first row of each of a slice's 4 groups */
    return (groups & 1) | (groups & 2) << 3 | (groups & 4) << 6 | (groups & 8) << 9;
}
static inline uint32_t iso_edge_rows_read(iso_edge_active active, int z) {
    const uint32_t here = (uint32_t)active.groups >> z / 4 * 4 & 15,
                   before = z % 4 ? 0 : (uint32_t)active.groups << 4 >> z & 15;
    const uint32_t first = iso_edge_group_rows(here | before);
    return first * 15 | first << 4;
}
static inline uint32_t iso_edge_rows_own(iso_edge_active active, int z) {
    return iso_edge_group_rows((uint32_t)active.groups >> z / 4 * 4 & 15) * 15;
}

/* Classified voxels of a run of blocks along x. Bit x of bits[b][z * 17 + y]: voxel x of row (y, z) of block
 * b is at or above the isovalue. The voxel after a row is the lowest bit of the next block's word, also for
 * the last block. Bits outside the active parts are undefined. Large: allocated once by the caller and
 * reused. */
enum { ISO_EDGE_SIDE = ISO_BRICK + 1, ISO_EDGE_WORD_BLOCKS = 32 };
typedef struct iso_edge_words {
    int blocks;                                   /* 1 .. ISO_EDGE_WORD_BLOCKS */
    iso_edge_active active[ISO_EDGE_WORD_BLOCKS]; /* set by the caller */
    uint64_t bits[ISO_EDGE_WORD_BLOCKS + 1][ISO_EDGE_SIDE * ISO_EDGE_SIDE];
} iso_edge_words;

/* The crossed edges of a block. */
typedef struct iso_edge_block {
    int origin[3];   /* first voxel; multiples of 64, 16, 16 */
    unsigned bricks; /* bit k: brick k is active */
    uint32_t points[ISO_EDGE_BRICKS];
    iso_edge_list axes[3];
} iso_edge_block;

/* Arrays for the points of the four bricks: either packed, or surfels and, if wanted, their keys. */
typedef struct iso_edge_output {
    iso_point *packed[ISO_EDGE_BRICKS];
    iso_surfel *surfels[ISO_EDGE_BRICKS];
    iso_edge_key *keys[ISO_EDGE_BRICKS]; /* for all bricks or for none */
} iso_edge_output;

/* Input and output of `compute_points` for one block. */
typedef struct iso_edge_task {
    int origin[3];
    iso_edge_entries axes[3];
    iso_edge_output output; /* packed points: no row may have ISO_EDGE_FACE, or y or z 16 */
    uint64_t lanes;         /* set to 0 before; afterwards each brick's number of points, 16 bits a brick */
} iso_edge_task;

/* The number of bits that are set in each 16 bits of a mask. */
static inline uint64_t iso_edge_lane_counts(uint64_t mask) {
    mask -= mask >> 1 & 0x5555555555555555u;
    mask = (mask & 0x3333333333333333u) + (mask >> 2 & 0x3333333333333333u);
    mask = (mask + (mask >> 4)) & 0x0f0f0f0f0f0f0f0fu;
    return (mask + (mask >> 8)) & 0x00ff00ff00ff00ffu;
}

typedef struct iso_edge_kernel {
    /* Classifies the voxels of words->blocks consecutive blocks along x, and lists and counts the crossed
     * edges of their active bricks. The caller sets blocks[0].origin, words->blocks and words->active; row
     * groups that are not active must have no crossed edges. */
    void (*list_edges)(const iso_edge_source *source, iso_edge_words *words, iso_edge_block *blocks);
    /* Computes the points of `count` tasks, a block each. Either all tasks write packed surfels or none does.
     * Calls with several tasks cost less per task. */
    void (*compute_points)(const iso_edge_source *source, iso_edge_task *tasks, int count);
    /* Only classifies the voxels, for meshes: sets words->bits of a run whose first block begins at
     * `origin`. */
    void (*classify_voxels)(const iso_edge_source *source, const int origin[3], iso_edge_words *words);
} iso_edge_kernel;

ISO_KERNEL_UNITS(const iso_edge_kernel, iso_edge_kernel_uint8);
ISO_KERNEL_UNITS(const iso_edge_kernel, iso_edge_kernel_int16);
ISO_KERNEL_UNITS(const iso_edge_kernel, iso_edge_kernel_uint16);
ISO_KERNEL_UNITS(const iso_edge_kernel, iso_edge_kernel_float);

/* The kernel for a voxel type at an instruction set, or at the best below it that this build has. Never NULL.
 */
const iso_edge_kernel *iso_edge_kernel_get(iso_type type, iso_cpu_level level);

#endif
