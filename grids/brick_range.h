/* brick_range: the least and the largest value of each brick of an rgrid and, more coarsely, of its parts,
 * read at memory speed.
 *
 * A brick's range is over voxels 16 * b .. 16 * b + 16 of every axis (clipped to the grid): its own and the
 * first of its upper neighbours, all that the edges and cells of the brick look at. A row group is four rows
 * in y by four in z of a brick, and its range is over rows 4 * g .. 4 * g + 4 of both, with all 17 voxels of
 * each. Internal to grids. */
#ifndef ISO_GRIDS_BRICK_RANGE_H
#define ISO_GRIDS_BRICK_RANGE_H

#include <stdbool.h>
#include <stdint.h>

#include "base/cpu.h"
#include "grids/rgrid.h"

/* Stored values; exact for every type. */
typedef struct iso_brick_range {
    float lo, hi; /* of the finite voxels; +infinity and -infinity when there are none */
    bool finite;  /* no voxel is NaN or infinite */
} iso_brick_range;

enum { ISO_GROUP_ROWS = 4, ISO_GROUPS_SIDE = 4, ISO_ROW_GROUPS = ISO_GROUPS_SIDE * ISO_GROUPS_SIDE };

/* The ranges of a brick's row groups, number 4 * (z / 4) + y / 4, in 255ths of the brick's range: a value's
 * step is iso_range_step of it, which never falls as values rise. Of the finite voxels; 255 and 0 for groups
 * without any. */
typedef struct iso_group_ranges {
    uint8_t lo[ISO_ROW_GROUPS], hi[ISO_ROW_GROUPS];
} iso_group_ranges;

static inline float iso_range_scale(float lo, float hi) {
    return 255 / (hi - lo);
}

/* `scale` is iso_range_scale(lo, hi) of the brick. NaN, which overflow can give, counts as 0. Integers in a
 * range of at most 255 have different steps. */
static inline uint8_t iso_range_step(float value, float lo, float scale) {
    float step = (value - lo) * scale;
    step = step > 0 ? step : 0;
    return (uint8_t)(int)(step < 255 ? step : 255);
}

/* What reading a brick gives. */
typedef struct iso_brick_reading {
    iso_brick_range range;
    iso_group_ranges groups;
} iso_brick_reading;

/* Bricks of one layer, that many along x and y: what is read at a time. */
enum { ISO_BATCH_BRICKS = 256, ISO_BATCH_ROWS = 8 };
typedef struct iso_brick_batch {
    int first[3], count[2];
} iso_brick_batch;

/* The most along x and y that one call takes, and the best for reading all of the grid. */
void iso_brick_batch_max(const iso_rgrid *grid, int most[2]);

/* Brick (x, y) of the band to readings[y * count[0] + x]. The same for every level. */
void iso_brick_ranges(const iso_rgrid *grid, iso_cpu_level level, const iso_brick_batch *batch,
                      iso_brick_reading *readings);

#endif
