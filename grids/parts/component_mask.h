/* component_mask: kernels that mark the voxels of a row within a range of values, with one bit for each
 * voxel. The results are the same for every instruction set. Thread-safe. Internal to the library. */
#ifndef ISO_GRIDS_PARTS_COMPONENT_MASK_H
#define ISO_GRIDS_PARTS_COMPONENT_MASK_H

#include <stdbool.h>
#include <stdint.h>

#include "base/cpu.h"
#include "grids/rgrid.h"

/* A range of stored values, both ends included. */
typedef struct iso_mask_range {
    int32_t lo, hi;           /* of integer types, within the type's range */
    float float_lo, float_hi; /* of ISO_FLOAT32 */
} iso_mask_range;

/* Computes the range of the finite values at or above `at` or, with `below`, of those below it. Returns false
 * if no value of the type is in the range. */
bool iso_mask_range_of(iso_type type, float at, bool below, iso_mask_range *range);

/* Writes the mask of a row of `count` voxels, ceil(count / 64) words: bit i is set if voxel i lies in the
 * range; bits from `count` on are 0. */
typedef void iso_mask_kernel(const void *row, int count, const iso_mask_range *range, uint64_t *words);
typedef iso_mask_kernel *const iso_mask_kernels[ISO_FLOAT32 + 1]; /* by voxel type */
ISO_KERNEL_UNITS(iso_mask_kernels, iso_mask_kernels);

/* Returns the kernel for a voxel type and an instruction set, or for the best one below it that this build
 * has. */
iso_mask_kernel *iso_mask_kernel_get(iso_type type, iso_cpu_level level);

#endif
