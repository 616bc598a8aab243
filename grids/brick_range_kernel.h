/* brick_range_kernel: finds the ranges of the row groups in a batch of bricks. Internal to grids. */
#ifndef ISO_GRIDS_BRICK_RANGE_KERNEL_H
#define ISO_GRIDS_BRICK_RANGE_KERNEL_H

#include <stdalign.h>
#include <stddef.h>
#include <string.h>

#include "base/primitives.h"
#include "grids/brick_range.h"

/* A batch of bricks is read slice by slice. The rows of a slice follow each other in memory, and long ranges
 * of memory are read fastest (twice as fast as 17 rows of one brick at a time). The intermediate results of a
 * batch fit into the second-level cache: lines of columns, where a line has one value for each voxel along x
 * and stands for the rows of one group. */
enum {
    BATCH_BYTES = ISO_BATCH_BRICKS * ISO_BRICK,
    COLUMN_SLACK = 64,
    LINES = ISO_GROUPS_SIDE * ISO_BATCH_ROWS
};

/* The box of voxels that a kernel reads; its first voxel is passed as a pointer. */
typedef struct range_box {
    ptrdiff_t stride_y, stride_z; /* elements */
    int n[3];
    int bricks, lines, pitch; /* bricks along x; number of lines; items from one line to the next */
} range_box;

/* The result of a kernel: the range of each row group of the bricks of a batch. */
typedef struct range_values {
    alignas(64) float lo[ISO_ROW_GROUPS][ISO_BATCH_BRICKS],
        hi[ISO_ROW_GROUPS][ISO_BATCH_BRICKS]; /* lo > hi: the group has no voxels */
} range_values;

/* Floats are compared as integers (keys) with the same order: infinities lie beyond all finite values, and
 * NaNs beyond the infinities, on either side. */
typedef int32_t __attribute__((may_alias)) float_bits;

static inline int32_t key_of_bits(int32_t bits) {
    return bits ^ (int32_t)((uint32_t)(bits >> 31) >> 1);
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

typedef void iso_range_fn(const void *data, const range_box *box, range_values *values);
/* Of all voxels of a type; iso_range_finite: of floats, the finite ones. */
ISO_KERNEL_UNITS(iso_range_fn, iso_range_uint8);
ISO_KERNEL_UNITS(iso_range_fn, iso_range_int16);
ISO_KERNEL_UNITS(iso_range_fn, iso_range_uint16);
ISO_KERNEL_UNITS(iso_range_fn, iso_range_float);
ISO_KERNEL_UNITS(iso_range_fn, iso_range_finite);

#endif
