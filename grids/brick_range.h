/* brick_range: computes the range of values (minimum and maximum) of each brick of an rgrid and, quantised,
 * the ranges of its row groups, as fast as the voxels can be read from memory.
 *
 * The range of brick b includes voxels 16 * b .. 16 * b + 16 along each axis (clipped to the grid): its own
 * and the first ones of its upper neighbours, which are all voxels that its edges and cells read. A row group
 * is 4 x 4 rows of a brick in y and z; its range includes rows 4 * g .. 4 * g + 4 in both, with 17 voxels
 * each. Internal to grids. */
#ifndef ISO_GRIDS_BRICK_RANGE_H
#define ISO_GRIDS_BRICK_RANGE_H

#include <stdbool.h>
#include <stdint.h>

#include "base/cpu.h"
#include "grids/rgrid.h"

/* A range of stored values; exact for every type. */
typedef struct iso_brick_range {
    float lo, hi; /* the smallest and largest finite voxel; +infinity and -infinity if there is none */
    bool finite;  /* no voxel is NaN or infinite */
} iso_brick_range;

enum { ISO_GROUP_ROWS = 4, ISO_GROUPS_SIDE = 4, ISO_ROW_GROUPS = ISO_GROUPS_SIDE * ISO_GROUPS_SIDE };

/* The ranges of the finite voxels of a brick's row groups; group 4 * (z / 4) + y / 4 has row (y, z). They are
 * quantised by iso_range_step to 255ths of the brick's range. lo 255 and hi 0: the group has no finite voxel.
 */
typedef struct iso_group_ranges {
    uint8_t lo[ISO_ROW_GROUPS], hi[ISO_ROW_GROUPS];
} iso_group_ranges;

static inline float iso_range_scale(float lo, float hi) {
    return 255 / (hi - lo);
}

/* Quantises a value of a brick with the range lo, hi; monotonic. `scale` is iso_range_scale(lo, hi). NaN,
 * which overflow can yield, becomes 0. Integers in a range of at most 255 get different steps. */
static inline uint8_t iso_range_step(float value, float lo, float scale) {
    float step = (value - lo) * scale;
    step = step > 0 ? step : 0;
    return (uint8_t)(int)(step < 255 ? step : 255);
}

/* The ranges of one brick and of its row groups. */
typedef struct iso_brick_reading {
    iso_brick_range range;
    iso_group_ranges groups;
} iso_brick_reading;

/* A batch: adjacent bricks of one layer in z that are read together, count[0] along x and count[1] along y.
 */
enum { ISO_BATCH_BRICKS = 256, ISO_BATCH_ROWS = 8 };
typedef struct iso_brick_batch {
    int first[3], count[2];
} iso_brick_batch;

/* Sets `most` to the size of the largest batch along x and y, which is also the fastest for reading a whole
 * grid. */
void iso_brick_batch_max(const iso_rgrid *grid, int most[2]);

/* Reads the bricks of a batch and writes the result for brick (x, y) of the batch to readings[y * count[0] +
 * x]. The results are the same for every level. */
void iso_brick_ranges(const iso_rgrid *grid, iso_cpu_level level, const iso_brick_batch *batch,
                      iso_brick_reading *readings);

#endif
