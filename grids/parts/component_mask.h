/* component_mask: which voxels of a row lie in a range of values, one bit a voxel. Internal to the library.
 *
 * The same bits at every instruction set. Thread-safe. */
#ifndef ISO_GRIDS_PARTS_COMPONENT_MASK_H
#define ISO_GRIDS_PARTS_COMPONENT_MASK_H

#include <stdbool.h>
#include <stdint.h>

#include "base/cpu.h"
#include "grids/rgrid.h"

/* The stored values that count as solid, both ends included. Integers for integer types, inside the type's
 * range. */
typedef struct iso_mask_range {
    int32_t lo, hi;           /* of integer types */
    float float_lo, float_hi; /* of ISO_FLOAT32 */
} iso_mask_range;

/* The range of the solid: values at or above `at`, or below it when `below`, but finite ones only. False when
 * no value of the type is in it. */
bool iso_mask_range_of(iso_type type, float at, bool below, iso_mask_range *range);

/* Sets ceil(count / 64) words: bit i of the row is set when voxel i lies in the range, bits from `count` on
 * are 0. */
typedef void iso_mask_kernel(const void *row, int count, const iso_mask_range *range, uint64_t *words);

/* The kernel for a voxel type at an instruction set, or at the best below it that this build has. Never NULL.
 */
iso_mask_kernel *iso_mask_kernel_get(iso_type type, iso_cpu_level level);

#endif
