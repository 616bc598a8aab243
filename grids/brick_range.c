/* Computes the ranges of bricks: kernels (brick_range_kernel.h) find the range of each row group in a batch
 * of bricks, and the range of a brick is the union of those of its groups. */
#include "grids/brick_range.h"

#include <assert.h>
#include <math.h>

#include "base/kernel_units.h"
#include "base/numbers.h"
#include "base/primitives.h"
#include "grids/brick_range_kernel.h"

/* ---- from groups to bricks */

static void clear_values(range_values *values, int bricks) {
    for (int g = 0; g < ISO_ROW_GROUPS; g++)
        for (int b = 0; b < bricks; b++) values->lo[g][b] = INFINITY, values->hi[g][b] = -INFINITY;
}

/* Whether a group has no finite voxel. */
static inline bool is_empty(float lo, float hi) {
    return !(lo <= hi);
}

/* Computes the ranges of bricks from those of their row groups. */
static void unite_groups(const range_values *values, int bricks, iso_brick_reading *readings) {
    float lo[ISO_BATCH_BRICKS], hi[ISO_BATCH_BRICKS];
    uint8_t odd[ISO_BATCH_BRICKS] = {0};
    for (int b = 0; b < bricks; b++) lo[b] = INFINITY, hi[b] = -INFINITY;
    for (int g = 0; g < ISO_ROW_GROUPS; g++)
        for (int b = 0; b < bricks; b++) {
            const float low = values->lo[g][b], high = values->hi[g][b];
            const bool below = key_of_value(low) < LEAST_KEY;
            const bool above = key_of_value(high) > LARGEST_KEY;
            odd[b] |= below | above;
            lo[b] = (!is_empty(low, high) & (low < lo[b])) ? low : lo[b];
            hi[b] = (!is_empty(low, high) & (high > hi[b])) ? high : hi[b];
        }
    for (int b = 0; b < bricks; b++) readings[b].range = (iso_brick_range){lo[b], hi[b], !odd[b]};
}

/* Quantises the ranges of row groups relative to their bricks' ranges, which must be known. */
static void quantise_groups(const range_values *values, int bricks, iso_brick_reading *readings) {
    float lo[ISO_BATCH_BRICKS], scale[ISO_BATCH_BRICKS];
    uint8_t low[ISO_BATCH_BRICKS], high[ISO_BATCH_BRICKS];
    for (int b = 0; b < bricks; b++) {
        lo[b] = readings[b].range.lo;
        scale[b] = iso_range_scale(lo[b], readings[b].range.hi);
    }
    for (int g = 0; g < ISO_ROW_GROUPS; g++) {
        for (int b = 0; b < bricks; b++) {
            const bool empty = is_empty(values->lo[g][b], values->hi[g][b]);
            const uint8_t least = iso_range_step(values->lo[g][b], lo[b], scale[b]),
                          most = iso_range_step(values->hi[g][b], lo[b], scale[b]);
            low[b] = empty ? UINT8_MAX : least;
            high[b] = empty ? 0 : most;
        }
        for (int b = 0; b < bricks; b++) {
            readings[b].groups.lo[g] = low[b];
            readings[b].groups.hi[g] = high[b];
        }
    }
}

/* ---- reading */

static bool all_finite(const iso_brick_reading *readings, int bricks) {
    bool all = true;
    for (int b = 0; b < bricks; b++) all &= readings[b].range.finite;
    return all;
}

void iso_brick_batch_max(const iso_rgrid *grid, int most[2]) {
    const int bricks = ISO_BATCH_BRICKS / (int)iso_type_size(grid->type),
              row = (grid->dims[0] - 1) / ISO_BRICK + 1;
    most[0] = iso_min_int(row, bricks);
    most[1] = iso_min_int(bricks / most[0], ISO_BATCH_ROWS);
}

static iso_range_fn *range_kernel(iso_type type, iso_cpu_level level) {
    switch (type) {
    case ISO_UINT8:
        return ISO_KERNEL_UNIT(iso_range_uint8, level);
    case ISO_INT16:
        return ISO_KERNEL_UNIT(iso_range_int16, level);
    case ISO_UINT16:
        return ISO_KERNEL_UNIT(iso_range_uint16, level);
    default:
        return ISO_KERNEL_UNIT(iso_range_float, level);
    }
}

void iso_brick_ranges(const iso_rgrid *grid, iso_cpu_level level, const iso_brick_batch *batch,
                      iso_brick_reading *readings) {
    const int columns = batch->count[0], rows = batch->count[1], bricks = columns * rows;
    assert(rows <= ISO_BATCH_ROWS && bricks * (int)iso_type_size(grid->type) <= ISO_BATCH_BRICKS);
    range_box box = {.stride_y = grid->stride_y,
                     .stride_z = grid->stride_z,
                     .bricks = columns,
                     .lines = rows * ISO_GROUPS_SIDE,
                     .pitch = columns * ISO_BRICK + COLUMN_SLACK};
    ptrdiff_t at = 0;
    const ptrdiff_t stride[3] = {1, grid->stride_y, grid->stride_z};
    const int count[3] = {columns, rows, 1};
    for (int axis = 0; axis < 3; axis++) {
        const int first = batch->first[axis] * ISO_BRICK;
        box.n[axis] = iso_min_int(count[axis] * ISO_BRICK + 1, grid->dims[axis] - first);
        at += first * stride[axis];
    }
    const char *data = (const char *)grid->data + at * (ptrdiff_t)iso_type_size(grid->type);
    range_values values;
    clear_values(&values, bricks);
    range_kernel(grid->type, level)(data, &box, &values);
    unite_groups(&values, bricks, readings);
    if (!all_finite(readings, bricks)) {
        bool finite[ISO_BATCH_BRICKS];
        for (int b = 0; b < bricks; b++) finite[b] = readings[b].range.finite;
        clear_values(&values, bricks);
        ISO_KERNEL_UNIT(iso_range_finite, level)(data, &box, &values);
        unite_groups(&values, bricks, readings);
        for (int b = 0; b < bricks; b++) readings[b].range.finite = finite[b];
    }
    quantise_groups(&values, bricks, readings);
}
