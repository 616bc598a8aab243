/* label_blocks: computes the fields of labels block by block, for the level sets. Internal to grids/labels.
 */
#ifndef ISO_GRIDS_LABELS_LABEL_BLOCKS_H
#define ISO_GRIDS_LABELS_LABEL_BLOCKS_H

#include <stdatomic.h>

#include "grids/labels/label_fields.h"

#define ISO_LABEL_BAND 5.0f /* the level sets' clamp, voxels, and what fields are where they are not known */

typedef struct iso_label_value {
    uint16_t label, x; /* of its voxel in the brick */
    float value;
} iso_label_value;

/* The fields, at the voxels of a brick, of the labels that can be the greatest near them: of the voxels next
 * to which there are at least two labels of one group. */
typedef struct iso_label_candidates {
    uint32_t start[ISO_BRICK * ISO_BRICK + 1]; /* of rows, along x */
    iso_label_value entry[];
} iso_label_candidates;

struct iso_label_fields {
    const iso_labels *labels;
    uint8_t *group; /* of every label; group[0] = 0 */
    int group_count;
    int labels_in_group[ISO_LABEL_GROUPS + 1];
    int bricks[3]; /* of the level sets */
    size_t brick_count;
    iso_hgrid *grid[ISO_LABEL_GROUPS + 1]; /* from 1 */
    uint64_t *own_groups, *near_groups;    /* of each brick: the groups in it; within reach */
    int places;                            /* as in iso_label_fields_make */
    bool has_undrawn;                      /* some label but the background is not drawn */
    bool *smoothed;                        /* of each brick: labels change in or near it */
    iso_label_candidates **candidates;     /* of each brick, or NULL */
    /* Of each block of ISO_LABEL_BLOCK^3 bricks, a bit for each octant of its bricks, x fastest: */
    int blocks[3];
    size_t block_count;
    uint64_t *apart;         /* its candidates are made */
    _Atomic uint64_t *asked; /* they are to be made */
};

enum {
    ISO_LABEL_BLOCK = 2,
    ISO_LABEL_OCTANT = ISO_BRICK / 2,            /* its side, voxels */
    ISO_LABEL_OCTANTS = 2 * ISO_LABEL_BLOCK,     /* along a block's side: 64 in all */
    ISO_LABEL_SIDE = ISO_LABEL_BLOCK * ISO_BRICK /* of a block, voxels */
};

/* The bit of the octant of a voxel of a block, or of the level sets. */
static inline int iso_label_octant(int x, int y, int z) {
    const int n = ISO_LABEL_OCTANTS, side = ISO_LABEL_OCTANT;
    return (z / side % n * n + y / side % n) * n + x / side % n;
}

/* Fills the bricks of the level sets. ISO_ERR_NOMEM. */
iso_status iso_label_blocks_smooth(iso_label_fields *fields, iso_pool *pool, iso_error *error);

/* Makes the candidates of the octants for which they are asked, unless they are made. In a block that has
 * some already they are made of all. ISO_ERR_NOMEM. */
iso_status iso_label_blocks_tell_apart(iso_label_fields *fields, iso_pool *pool, iso_error *error);

#endif
