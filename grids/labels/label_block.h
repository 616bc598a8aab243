/* label_block: a block of bricks whose labels are smoothed, and what is known of it. Internal to
 * grids/labels. */
#ifndef ISO_GRIDS_LABELS_LABEL_BLOCK_H
#define ISO_GRIDS_LABELS_LABEL_BLOCK_H

#include <string.h>

#include "grids/labels/label_blocks.h"
#include "grids/labels/smooth_kernel.h"

enum {
    NEAR = 3,   /* how far from the block labels count, and voxels that would change their label */
    FILTER = 7, /* the greatest radius of a filter */
    FIELD = ISO_LABEL_SIDE + 2 * NEAR,
    DISTANCES = FIELD + 2 * FILTER,
    MASK = DISTANCES + 2 * ISO_LABEL_REACH,
    FIELD_VOXELS = FIELD * FIELD * FIELD,
    FIELD_ROWS = FIELD * FIELD,
    MASK_ROWS = MASK * MASK,
    COARSE = (FIELD + 3) / 4,
    SETS = 7, /* of rows, in block_memory */
    BEST_VOXELS = FIELD_VOXELS + ISO_LABEL_SLACK,
    DISTANCE_VOXELS = DISTANCES * DISTANCES * DISTANCES,
    MASK_VOXELS = MASK * MASK * MASK,
    BRICKS = 8, /* of a block */
    /* of the fields and distances of a block's labels, for where things are thin */
    KEPT = 16 * FIELD_VOXELS + 8 * DISTANCE_VOXELS,
    NEIGHBOURS = 27 /* a voxel and those around it */
};
/* The voxels lo .. hi - 1, counted from the first voxel of a block's fields. */
typedef struct extent {
    int lo[3], hi[3];
} extent;

/* A label near a block, or a group as if it were one label, and where in the block's fields it is, or near.
 */
typedef struct near_label {
    int label; /* its place in the list of labels, or the group's number */
    extent box;
    uint64_t rows[COARSE * COARSE];     /* of 4 x 4 rows each: where its field is computed */
    extent kept_box;                    /* of what is kept: */
    float *kept_field, *kept_distances; /* its field by the wide filter; NULL: not kept */
} near_label;

/* Working memory of a worker. */
typedef struct block_memory {
    uint16_t *window; /* the group of each voxel of the block's fields, or its label: 0 if it is not drawn */
    uint8_t *mask;
    int8_t *work8, *squares;
    float *distance, *work, *field, *narrowed;
    float *kept; /* fields and distances of labels */
    size_t kept_count;
    /* Sets of voxels of the rows of the block's fields: */
    uint64_t *cells;          /* the first corners of cells that a surface passes, and of those beside them */
    uint64_t *drawn, *needed; /* voxels whose values are drawn, and those that these depend on */
    uint64_t *blended;        /* those with a weight of the narrow filter */
    uint64_t *edges[3];       /* between voxels of different groups or labels; also work */
    uint64_t *sets;           /* all of these */
    uint8_t *ranges;          /* and of these: */
    uint8_t *lo[ISO_LABEL_STEPS], *hi[ISO_LABEL_STEPS]; /* of an iso_label_box */
    float *own, *other; /* at every voxel: its own label's field, and the greatest other one */
    float *loss;        /* what its own label's field is less than the distance */
    float *best;        /* the field of each group, group 0 first; of labels: the greatest one */
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
} smoothing;

/* A block that is being smoothed: its groups, each as if it were one label, or the labels in them. */
typedef struct label_block {
    const smoothing *all;
    block_memory *s;
    bool solids;      /* its groups, not labels */
    uint64_t octants; /* in which labels are told apart */
    int first[3];     /* its first voxel that has values, in the level sets */
    int out[3];       /* its size: of the bricks that need values */
    int size[3];      /* of its fields */
    iso_label_candidates *candidates[BRICKS];
} label_block;

static inline size_t index_in(const int size[3], int x, int y, int z) {
    return ((size_t)z * (size_t)size[1] + (size_t)y) * (size_t)size[0] + (size_t)x;
}

static inline const uint16_t *window_row(const label_block *b, int y, int z) {
    return b->s->window + index_in(b->size, 0, y, z);
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

/* Rows of a box of voxels, in which those of a group or label, and no others, have this number. */
typedef struct label_rows {
    const label_block *b;
    int at[3];             /* the first voxel, counted from the first of the block's fields */
    int n;                 /* voxels of a row */
    int label;             /* -1: of all groups */
    int lo[2], hi[2];      /* the rows lo .. hi - 1 along y and z are in the volume as they are: */
    const uint16_t *first; /* the first of them */
    ptrdiff_t pitch, slice;
    uint16_t *copy; /* of another row: room for n + ISO_LABEL_SLACK */
} label_rows;
label_rows iso_label_block_rows(const label_block *b, const int at[3], int n, int label, uint16_t *copy);

/* Makes a copy of a row that is not in the volume as it is. */
void iso_label_block_copy_row(const label_rows *rows, int y, int z);

/* Row y, z of the box; until the next call. */
static inline const uint16_t *label_row(const label_rows *r, int y, int z) {
    if (y >= r->lo[0] && y < r->hi[0] && z >= r->lo[1] && z < r->hi[1])
        return r->first + (y - r->lo[0]) * r->pitch + (z - r->lo[1]) * r->slice;
    iso_label_block_copy_row(r, y, z);
    return r->copy;
}

/* Of the groups: sets the window, the list of groups near the block, and the sets of cells and voxels. *pair:
 * there are but two groups, as far as the fields depend on them; where these are is not listed then. False:
 * no voxel's value is drawn. */
bool iso_label_block_groups(label_block *b, bool *pair);

/* The same of labels: `drawn` are the corners of cells that have several labels beside the background. */
bool iso_label_block_labels(label_block *b);

#endif
