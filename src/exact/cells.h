/* exact_cells: what `exact` keeps of a brick, and the kernels that find it. Internal to exact.
 *
 * A brick's cells lie in up to eight blocks of 8^3 cells: a block is what drawing culls and sets up at a
 * time. The corner values of a block's crossed cells are kept as the grid stores them, in planes: all first
 * corners, all second ones .. (bit 0 of a corner's number is +x, bit 1 +y, bit 2 +z), each plane padded with
 * zeros to whole groups of ISO_EXACT_GROUP cells. Cells are in the order z, y, x, x fastest. */
#ifndef ISO_EXACT_CELLS_H
#define ISO_EXACT_CELLS_H

#include <stddef.h>
#include <stdint.h>

#include "base/cpu.h"
#include "base/primitives.h"
#include "grids/grid.h"

enum {
    ISO_EXACT_SIDE = 8, /* cells */
    ISO_EXACT_CELLS = ISO_EXACT_SIDE * ISO_EXACT_SIDE * ISO_EXACT_SIDE,
    ISO_EXACT_BLOCKS = 8, /* in a brick */
    ISO_EXACT_GROUP = 16,
    ISO_EXACT_LATTICE = ISO_BRICK + 1,
};

typedef struct iso_exact_block {
    uint64_t mask[ISO_EXACT_SIDE]; /* bit 8 * y + x of mask[z]: the cell is crossed */
    uint32_t group;                /* its first group, counted from the brick's first */
    uint16_t cells;
    uint8_t origin[3];       /* of the block in the brick: 0 or 8 */
    uint8_t low[3], high[3]; /* first and last cell on each axis, in the block */
} iso_exact_block;

typedef struct iso_exact_span {
    int32_t brick[3];
    uint32_t blocks, cells;
    size_t block, group; /* the first ones */
} iso_exact_span;

static inline uint32_t iso_exact_groups(uint32_t cells) {
    return (cells + ISO_EXACT_GROUP - 1) / ISO_EXACT_GROUP;
}

/* Bytes of a group: eight corners of ISO_EXACT_GROUP cells. */
static inline size_t iso_exact_group_bytes(iso_type type) {
    return (size_t)8 * ISO_EXACT_GROUP * iso_type_size(type);
}

/* Rows of 17 voxels of a brick, as many as the cells need: all 17 of a row must be readable, also where there
 * are fewer cells than 16. */
typedef struct iso_exact_source {
    const void *voxels;
    ptrdiff_t stride_y, stride_z; /* elements */
    int cells[3];                 /* 1 .. 16 */
    float isovalue_ceil;          /* at or above it is inside */
} iso_exact_source;

/* What a brick has: blocks that are not empty, and their corners one after another. One worker's. */
typedef struct iso_exact_output {
    uint32_t blocks, groups, cells;
    iso_exact_block block[ISO_EXACT_BLOCKS];
    /* (a compressing store may write seven elements too many) */
    float corners[8 * ISO_BRICK_VOXELS], planes[8][ISO_EXACT_CELLS + ISO_EXACT_GROUP];
} iso_exact_output;

typedef void iso_exact_extract(const iso_exact_source *source, iso_exact_output *output);

/* The kernel for a voxel type at an instruction set, or at the best below it that this build has. Never NULL.
 */
iso_exact_extract *iso_exact_extract_get(iso_type type, iso_cpu_level level);

#endif
