/* brick_range_kernel: the variants for each voxel type. A unit for each instruction set
 * (base/kernel_units.h). */
#include "grids/brick_range_kernel.h"

#include "base/numbers.h"
#include "grids/voxel_kernels.h"

#define LINE_ITEMS(type) (ISO_GROUPS_SIDE * BATCH_BYTES / (int)sizeof(type) + LINES * COLUMN_SLACK)

static inline float value_of_key(int32_t key) {
    const int32_t bits = key_of_bits(key);
    float value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

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

#define FUNCTION(type) ISO_PASTE(ISO_PASTE(ranges, type), ISO_KERNEL_LEVEL)
const iso_range_kernel ISO_PASTE(iso_range_kernel, ISO_KERNEL_LEVEL) = {{[ISO_UINT8] = FUNCTION(uint8),
                                                                         [ISO_INT16] = FUNCTION(int16),
                                                                         [ISO_UINT16] = FUNCTION(uint16),
                                                                         [ISO_FLOAT32] = FUNCTION(float)},
                                                                        FUNCTION(finite)};
