/* edge_kernel: edge points of a block of four bricks (64 x 16 x 16 voxels), as fast as memory allows.
 *
 * One kernel body per voxel type (edge_kernel_body.inc), included once per instruction set; every variant
 * gives the same bytes. Work is in two steps so that the place of every point is known before it is computed:
 * `count` classifies the block's voxels into 64-bit masks and lists the non-empty words of each edge
 * direction, `fill` expands them, fetches neighbours into arrays and does the arithmetic on whole vectors.
 * Order within a brick: axis, then z, y, x of the lower voxel. Baerentzen and Christensen 2003, section 4;
 * the word lists are an idea of Flying Edges' row passes (Schroeder, Maynard and Geveci 2015) taken to bit
 * masks. */
#ifndef ISO_EXTRACT_POINTS_EDGE_KERNEL_H
#define ISO_EXTRACT_POINTS_EDGE_KERNEL_H

#include <stdbool.h>
#include <stdint.h>

#include "base/cpu.h"
#include "base/primitives.h"
#include "grids/rgrid.h"

#ifdef __cplusplus
extern "C" {
#endif

enum {
    ISO_EDGE_BRICKS = 4,                            /* bricks in a block, along x */
    ISO_EDGE_BLOCK_X = ISO_EDGE_BRICKS * ISO_BRICK, /* = bits of a mask word */
    ISO_EDGE_ROWS = ISO_BRICK * ISO_BRICK           /* words of an axis */
};

/* A row of a block is named z << 5 | y, both 0 .. 16; with ISO_EDGE_FACE, voxel x of it means voxel x + 1,
 * the first of the next brick for the last x of each. */
enum { ISO_EDGE_FACE = 1 << 10, ISO_EDGE_ROW_NAMES = 2 << 10 };

/* What is extracted: a dense grid without NaN or infinity (where edges are), and a stored isovalue. */
typedef struct iso_edge_source {
    const void *data;             /* of voxel 0, 0, 0 */
    ptrdiff_t stride_y, stride_z; /* elements */
    int dims[3];                  /* one past the grid's last voxel */
    float isovalue_ceil;
    bool level_set; /* normals point to higher values */
    float residual; /* as in iso_threshold: the isovalue is isovalue_ceil + residual */
    int first[3];   /* the grid's first voxel: below 0 where `data` is a window into it */
    ptrdiff_t row_offset[ISO_EDGE_ROW_NAMES]; /* set by iso_edge_source_prepare */
} iso_edge_source;

/* Sets row_offset; the other fields are the caller's. */
void iso_edge_source_prepare(iso_edge_source *source);

/* The non-empty words of one axis: bit x of mask is an edge at voxel x of the row. */
enum { ISO_EDGE_LIST_SLACK = 8 }; /* words written past the end of a list */
typedef struct iso_edge_list {
    int count;
    uint64_t mask[ISO_EDGE_ROWS + ISO_EDGE_LIST_SLACK];
    uint16_t row[ISO_EDGE_ROWS + ISO_EDGE_LIST_SLACK];
} iso_edge_list;

/* A list, borrowed. */
typedef struct iso_edge_entries {
    const uint64_t *mask;
    const uint16_t *row;
    int count;
} iso_edge_entries;

/* The active part of a block: bit k of `bricks` is brick k, bit k of `groups` row group k
 * (grids/brick_range.h) of any of them. */
typedef struct iso_edge_active {
    uint16_t groups;
    uint8_t bricks;
} iso_edge_active;
#define ISO_EDGE_WHOLE ((iso_edge_active){.groups = 0xffff, .bricks = 15})

/* For slice z (0 .. 16), a bit per row: the rows that the active groups read (0 .. 16), and the rows whose
 * edges they own (0 .. 15). */
static inline uint32_t iso_edge_group_rows(uint32_t groups) { /* bits 0, 4, 8 and 12, each group's first */
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

/* Mask words of a run of blocks along x: what `count` classifies into, kept by the caller for reuse.
 * bits[b][z * 17 + y] is row (y, z) of block b; the lowest bit of the next block's word is the voxel after
 * it, also for the last block. Bits outside the active parts are undefined. */
enum { ISO_EDGE_SIDE = ISO_BRICK + 1, ISO_EDGE_WORD_BLOCKS = 32 };
typedef struct iso_edge_words {
    int blocks;                                   /* 1 .. ISO_EDGE_WORD_BLOCKS */
    iso_edge_active active[ISO_EDGE_WORD_BLOCKS]; /* set by the caller */
    uint64_t bits[ISO_EDGE_WORD_BLOCKS + 1][ISO_EDGE_SIDE * ISO_EDGE_SIDE];
} iso_edge_words;

/* What `count` leaves for `fill`. */
typedef struct iso_edge_block {
    int origin[3];   /* voxels; multiples of 64, 16, 16 */
    unsigned bricks; /* bit k: brick k is active */
    uint32_t points[ISO_EDGE_BRICKS];
    iso_edge_list axes[3];
} iso_edge_block;

/* Where the points of the four bricks go: packed, or in floats with their keys. */
typedef struct iso_edge_output {
    iso_point *packed[ISO_EDGE_BRICKS];
    iso_surfel *surfels[ISO_EDGE_BRICKS];
    iso_edge_key *keys[ISO_EDGE_BRICKS]; /* all or none; not with packed */
} iso_edge_output;

/* Input and output of `fill` for one block: the lists of its three axes and where the points go. */
typedef struct iso_edge_task {
    int origin[3];
    iso_edge_entries axes[3];
    iso_edge_output output; /* only own rows with packed */
    uint64_t lanes;         /* 0; then how many points each brick has so far, in 16 bits */
} iso_edge_task;

/* Bits set in each 16-bit lane of a mask, lane by lane. */
static inline uint64_t iso_edge_lane_counts(uint64_t mask) {
    mask -= mask >> 1 & 0x5555555555555555u;
    mask = (mask & 0x3333333333333333u) + (mask >> 2 & 0x3333333333333333u);
    mask = (mask + (mask >> 4)) & 0x0f0f0f0f0f0f0f0fu;
    return (mask + (mask >> 8)) & 0x00ff00ff00ff00ffu;
}

typedef struct iso_edge_kernel {
    /* Counts and lists the points of the active bricks of words->blocks consecutive blocks along x;
     * blocks[0].origin names the first. Inactive row groups must have no points. */
    void (*count)(const iso_edge_source *source, iso_edge_words *words, iso_edge_block *blocks);
    /* Makes the points of several blocks, packed for all of them or for none: the more there are, the less
     * each costs. Uses up `lanes`. */
    void (*fill)(const iso_edge_source *source, iso_edge_task *jobs, int count);
    /* The part of `count` that meshes put together anew: the mask words of a run that begins at `origin`. */
    void (*classify)(const iso_edge_source *source, const int origin[3], iso_edge_words *words);
} iso_edge_kernel;

/* The kernel for a voxel type at an instruction set, or at the best below it that this build has. Never NULL.
 */
const iso_edge_kernel *iso_edge_kernel_get(iso_type type, iso_cpu_level level);

#ifdef __cplusplus
}
#endif
#endif
