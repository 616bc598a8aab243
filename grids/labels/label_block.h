/* label_block: a block of bricks whose labels are smoothed, and what is known of it. Internal to
 * grids/labels. */
#ifndef ISO_GRIDS_LABELS_LABEL_BLOCK_H
#define ISO_GRIDS_LABELS_LABEL_BLOCK_H

#include <string.h>

#include "grids/labels/label_blocks.h"
#include "grids/labels/smooth_kernel.h"

enum {
    BLOCK_SIDE = 2 * ISO_BRICK,
    NEAR = 3,   /* how far from the block labels count, and voxels that would change their label */
    FILTER = 7, /* the greatest radius of a filter */
    FIELD = BLOCK_SIDE + 2 * NEAR,
    DISTANCES = FIELD + 2 * FILTER,
    WINDOW = DISTANCES + 2 * ISO_LABEL_REACH,
    OFFSET = FILTER + ISO_LABEL_REACH, /* of a field's voxels in the window */
    FIELD_VOXELS = FIELD * FIELD * FIELD,
    FIELD_ROWS = FIELD * FIELD,
    WINDOW_ROWS = WINDOW * WINDOW,
    COARSE = (FIELD + 3) / 4,
    SETS = 8, /* of rows, in block_memory */
    BEST_VOXELS = FIELD_VOXELS + ISO_LABEL_SLACK,
    DISTANCE_VOXELS = DISTANCES * DISTANCES * DISTANCES,
    WINDOW_VOXELS = WINDOW * WINDOW * WINDOW,
    BRICKS = 8, /* of a block */
    /* of the fields and distances of a block's labels, for where things are thin */
    KEPT = 16 * FIELD_VOXELS + 8 * DISTANCE_VOXELS,
    NEIGHBOURS = 27 /* a voxel and those around it */
};
/* The voxels lo .. hi - 1, counted from the first voxel of a block's fields. */
typedef struct extent {
    int lo[3], hi[3];
} extent;

/* A label near a block, and where in the block's fields it is, or near. */
typedef struct near_label {
    int label;
    extent box;
    uint64_t rows[COARSE * COARSE];     /* of 4 x 4 rows each: where its field is computed */
    extent kept_box;                    /* of what is kept: */
    float *kept_field, *kept_distances; /* its field by the wide filter; NULL: not kept */
} near_label;

/* Working memory of a worker. */
typedef struct block_memory {
    uint16_t *window; /* labels; those that are not drawn are 0 */
    uint8_t *mask;
    int8_t *work8, *squares;
    float *distance, *work, *field, *narrowed;
    float *kept; /* fields and distances of labels */
    size_t kept_count;
    uint16_t *groups; /* of the voxels of the block's fields */
    /* Sets of voxels of the rows of the block's fields: */
    uint64_t *cells;          /* the first corners of cells that a surface passes, and of those beside them */
    uint64_t *marked;         /* corners of such cells that have several labels */
    uint64_t *drawn, *needed; /* voxels whose values are drawn, and those that these depend on */
    uint64_t *blended;        /* those with a weight of the narrow filter */
    uint64_t *edges[3];       /* between voxels of different groups or labels; also work */
    uint64_t *sets;           /* all of these */
    uint8_t *ranges;          /* and of these: */
    uint8_t *lo[ISO_LABEL_STEPS], *hi[ISO_LABEL_STEPS]; /* of an iso_label_box */
    float *own, *other; /* at every voxel: its own label's field, and the greatest other one */
    float *loss;        /* what its own label's field is less than the distance */
    float *best;        /* the greatest field of each group, group 0 first */
    float *weight;      /* of the narrow filter */
    near_label *near;
    int near_count;
    int *place;               /* of a label in `near`; -1: it is not in it */
    iso_label_value *entries; /* candidates of a brick */
    bool failed, blends;
} block_memory;

typedef struct smoothing {
    iso_label_fields *fields;
    const iso_smooth_kernel *kernel;
    block_memory *scratch;
    int blocks[3];
} smoothing;

/* A block that is being smoothed. */
typedef struct label_block {
    const smoothing *all;
    block_memory *s;
    int first[3];  /* its first voxel that has values, in the level sets */
    int out[3];    /* its size: of the bricks that need values */
    int size[3];   /* of its fields */
    int window[3]; /* of its window */
    iso_label_candidates *candidates[BRICKS];
} label_block;

static inline size_t index_in(const int size[3], int x, int y, int z) {
    return ((size_t)z * (size_t)size[1] + (size_t)y) * (size_t)size[0] + (size_t)x;
}

static inline const uint16_t *window_row(const label_block *b, int y, int z) {
    return b->s->window + index_in(b->window, OFFSET, y + OFFSET, z + OFFSET);
}

static inline size_t row_in(const label_block *b, int y, int z) {
    return (size_t)z * (size_t)b->size[1] + (size_t)y;
}

/* The voxels lo .. hi - 1 of a row. */
static inline uint64_t range_of(int lo, int hi) {
    return lo < hi ? ~UINT64_C(0) >> (64 - hi) & ~UINT64_C(0) << lo : 0;
}

/* Of a set that is not empty. */
static inline int first_of(uint64_t set) {
    return __builtin_ctzll(set);
}
static inline int end_of(uint64_t set) {
    return 64 - __builtin_clzll(set);
}

/* Sets the window, the list of labels near the block, and the sets of cells and voxels. Returns whether there
 * are but two labels in the window. */
bool iso_label_block_look(label_block *b);

#endif
