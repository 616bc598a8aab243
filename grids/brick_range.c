/* Computes the ranges of bricks: kernels (brick_range_body.inc) find the range of each row group in a batch
 * of bricks, and the range of a brick is the union of those of its groups. */
#include "grids/brick_range.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "base/numbers.h"
#include "base/primitives.h"
#include "grids/voxel_kernels.h"

/* A batch of bricks is read slice by slice. The rows of a slice follow each other in memory, and long ranges
 * of memory are read fastest (twice as fast as 17 rows of one brick at a time). The intermediate results of a
 * batch fit into the second-level cache: lines of columns, where a line has one value for each voxel along x
 * and stands for the rows of one group. */
enum {
    BATCH_BYTES = ISO_BATCH_BRICKS * ISO_BRICK,
    COLUMN_SLACK = 64,
    LINES = ISO_GROUPS_SIDE * ISO_BATCH_ROWS
};
#define LINE_ITEMS(type) (ISO_GROUPS_SIDE * BATCH_BYTES / (int)sizeof(type) + LINES * COLUMN_SLACK)

/* The box of voxels that a kernel reads; its first voxel is passed as a pointer. */
typedef struct range_box {
    ptrdiff_t stride_y, stride_z; /* elements */
    int n[3];
    int bricks, lines, pitch; /* bricks along x; number of lines; items from one line to the next */
} range_box;

/* The result of a kernel: the range of each row group of the bricks of a batch. */
typedef struct range_values {
    _Alignas(64) float lo[ISO_ROW_GROUPS][ISO_BATCH_BRICKS],
        hi[ISO_ROW_GROUPS][ISO_BATCH_BRICKS]; /* lo > hi: the group has no voxels */
} range_values;

/* Floats are compared as integers (keys) with the same order: infinities lie beyond all finite values, and
 * NaNs beyond the infinities, on either side. */
typedef int32_t __attribute__((may_alias)) float_bits;

static inline int32_t key_of_bits(int32_t bits) {
    return bits ^ (int32_t)((uint32_t)(bits >> 31) >> 1);
}

static inline float value_of_key(int32_t key) {
    const int32_t bits = key_of_bits(key);
    float value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

static inline int32_t key_of_value(float value) {
    int32_t bits;
    memcpy(&bits, &value, sizeof bits);
    return key_of_bits(bits);
}

enum {
    LARGEST_KEY = 0x7f7fffff,
    LEAST_KEY = ~LARGEST_KEY
}; /* keys of the largest and smallest finite float */

/* Reads a slice once, row by row, without using the values. The hardware prefetcher recognises this order; it
 * would not recognise that of the kernels, which read many rows at once. */
static inline void touch_slice(const void *slice, const range_box *box, size_t size) {
    for (int y = 0; y < box->n[1]; y++)
        for (size_t byte = 0; byte < (size_t)box->n[0] * size; byte += 64)
            (void)*((const volatile char *)slice + (ptrdiff_t)size * y * box->stride_y + byte);
}

static inline bool is_finite_key(int32_t key) {
    return (key >= LEAST_KEY) & (key <= LARGEST_KEY);
}

/* Return the key of a finite float. Other floats get the key that has no effect on a minimum (finite_low) or
 * a maximum (finite_high). */
static inline int32_t finite_low(int32_t bits) {
    const int32_t key = key_of_bits(bits);
    return is_finite_key(key) ? key : INT32_MAX;
}
static inline int32_t finite_high(int32_t bits) {
    const int32_t key = key_of_bits(bits);
    return is_finite_key(key) ? key : INT32_MIN;
}

#define ISO_KERNEL_BODY "grids/brick_range_types.inc"
#include "base/kernel_levels.inc"

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
    ISO_VOXEL_KERNEL(ranges, grid->type, level)(data, &box, &values);
    unite_groups(&values, bricks, readings);
    if (!all_finite(readings, bricks)) {
        bool finite[ISO_BATCH_BRICKS];
        for (int b = 0; b < bricks; b++) finite[b] = readings[b].range.finite;
        clear_values(&values, bricks);
        ISO_KERNEL(ranges_finite, level)(data, &box, &values);
        unite_groups(&values, bricks, readings);
        for (int b = 0; b < bricks; b++) readings[b].range.finite = finite[b];
    }
    quantise_groups(&values, bricks, readings);
}
