/* cells: the crossed cells of a brick, as `exact` stores them, and the kernels that find them. Internal to
 * exact.
 *
 * A brick's crossed cells are stored in up to eight octants of 8^3 cells; an octant is culled and prepared
 * for drawing as a unit. The corner values of an octant's crossed cells are kept in the type of the grid's
 * voxels, in eight planes: the first corners of all cells, their second corners, .. (bit 0 of a corner's
 * number is +x, bit 1 +y, bit 2 +z). Each plane is padded with zeros to whole groups of ISO_EXACT_GROUP
 * cells. Cells are sorted by z, then y, then x. */
#ifndef ISO_EXACT_CELLS_H
#define ISO_EXACT_CELLS_H

#include <stddef.h>
#include <stdint.h>

#include "base/cpu.h"
#include "base/primitives.h"
#include "grids/grid.h"

enum {
    ISO_EXACT_SIDE = 8, /* cells along each side of an octant */
    ISO_EXACT_CELLS = ISO_EXACT_SIDE * ISO_EXACT_SIDE * ISO_EXACT_SIDE,
    ISO_EXACT_OCTANTS = 8,             /* in a brick */
    ISO_EXACT_GROUP = 16,              /* cells in a group */
    ISO_EXACT_LATTICE = ISO_BRICK + 1, /* voxels that a brick's cells have as corners, on an axis */
};

typedef struct iso_exact_octant {
    uint64_t mask[ISO_EXACT_SIDE]; /* bit 8 * y + x of mask[z]: the cell is crossed */
    uint32_t group;                /* the octant's first group, counted from the brick's first group */
    uint16_t cells;                /* number of crossed cells */
    uint8_t origin[3];             /* the octant's first cell in the brick: 0 or 8 on each axis */
    uint8_t low[3], high[3];       /* first and last crossed cell on each axis, counted from `origin` */
} iso_exact_octant;

/* The crossed cells of one brick. */
typedef struct iso_exact_span {
    int32_t brick[3];
    uint32_t octants, cells; /* numbers of octants with crossed cells, and of crossed cells */
    size_t octant, group;    /* indices of the first octant and the first group in the heaps of the set */
} iso_exact_span;

/* The number of groups that hold this many cells. */
static inline uint32_t iso_exact_groups(uint32_t cells) {
    return (cells + ISO_EXACT_GROUP - 1) / ISO_EXACT_GROUP;
}

/* Bytes of a group: eight corners of ISO_EXACT_GROUP cells. */
static inline size_t iso_exact_group_bytes(iso_type type) {
    return (size_t)8 * ISO_EXACT_GROUP * iso_type_size(type);
}

/* The voxels at the corners of a brick's cells: those of the brick and of its upper neighbours' first layers,
 * (cells[2] + 1) * (cells[1] + 1) rows. 17 voxels of each row must be readable, also where cells[0] is less
 * than 16. */
typedef struct iso_exact_source {
    const void *voxels;
    ptrdiff_t stride_y, stride_z; /* elements */
    int cells[3];                 /* number of the brick's cells along x, y, z: 1 .. 16 */
    float isovalue_ceil;          /* voxels at or above this value are inside */
} iso_exact_source;

/* The result for a brick: its octants with crossed cells, and in `corners` the corner values of these cells
 * in the voxels' type, one octant after the other. `planes` is working memory for one octant: it has room for
 * seven values too many, which a compressing store may write. Large: one for each worker. */
typedef struct iso_exact_output {
    uint32_t octants, groups, cells;
    iso_exact_octant octant[ISO_EXACT_OCTANTS];
    float corners[8 * ISO_BRICK_VOXELS], planes[8][ISO_EXACT_CELLS + ISO_EXACT_GROUP];
} iso_exact_output;

/* Finds the crossed cells of `source` and stores them in `output`. */
typedef void iso_exact_extract(const iso_exact_source *source, iso_exact_output *output);
typedef iso_exact_extract *const iso_exact_extracts[ISO_FLOAT32 + 1]; /* by voxel type */
ISO_KERNEL_UNITS(iso_exact_extracts, iso_exact_extracts);

/* The kernel for a voxel type at an instruction set, or at the best below it that this build has. Never NULL.
 */
iso_exact_extract *iso_exact_extract_get(iso_type type, iso_cpu_level level);

#endif
