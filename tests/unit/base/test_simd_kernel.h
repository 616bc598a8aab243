/* test_simd_kernel: inputs and results of every operation of base/simd.h. */
#ifndef ISO_TEST_SIMD_KERNEL_H
#define ISO_TEST_SIMD_KERNEL_H

#include <stdint.h>

#include "base/cpu.h"

enum { SIMD_ITEMS = 1024, SIMD_TRUTHS = 9 };

typedef struct simd_inputs {
    float a[SIMD_ITEMS], b[SIMD_ITEMS], small[SIMD_ITEMS];
    int32_t k[SIMD_ITEMS], l[SIMD_ITEMS];
    uint8_t u8[SIMD_ITEMS];
    uint16_t u16[SIMD_ITEMS];
    int16_t i16[SIMD_ITEMS];
} simd_inputs;

typedef struct simd_results {
    float set[SIMD_ITEMS], floats[SIMD_ITEMS], to_float[SIMD_ITEMS], min[SIMD_ITEMS], max[SIMD_ITEMS],
        abs[SIMD_ITEMS], gather[SIMD_ITEMS], sqrt[SIMD_ITEMS], select[SIMD_ITEMS];
    int32_t u8[SIMD_ITEMS], u16[SIMD_ITEMS], i16[SIMD_ITEMS], lanes[SIMD_ITEMS], bits[SIMD_ITEMS],
        trunc[SIMD_ITEMS], floor[SIMD_ITEMS], selecti[SIMD_ITEMS];
    int slides[SIMD_ITEMS]; /* how many of four slides were right */
    uint8_t truth[SIMD_TRUTHS][SIMD_ITEMS];
    float packed[SIMD_ITEMS + ISO_LANES_MAX];
    int32_t packedi[SIMD_ITEMS + ISO_LANES_MAX];
    int packed_count;
    float gathered[12][SIMD_ITEMS], scattered[SIMD_ITEMS][5];
    float even[SIMD_ITEMS], odd[SIMD_ITEMS], zipped[2 * SIMD_ITEMS];
    uint8_t stored_u8[SIMD_ITEMS];
} simd_results;

/* Applies every operation to the inputs, in the order of `simd_results`. */
typedef void operate_fn(const simd_inputs *in, simd_results *out);
ISO_KERNEL_UNITS(operate_fn, operate);

#endif
