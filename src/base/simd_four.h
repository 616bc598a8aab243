/* simd_four: vectors of four floats at every level, for kernels whose data come in fours. As base/simd.h. */
#ifndef ISO_BASE_SIMD_FOUR_H
#define ISO_BASE_SIMD_FOUR_H

#include <stdbool.h>
#include <stdint.h>
#include <string.h>
#ifdef __SSE__
#include <xmmintrin.h>
#endif

typedef float v4 __attribute__((vector_size(16)));
typedef int32_t v4i __attribute__((vector_size(16)));

static inline v4 v4_set(float value) {
    return value - (v4){0};
}
static inline v4 v4_load(const float *from) {
    v4 value;
    memcpy(&value, from, sizeof value);
    return value;
}
static inline void v4_store(float *to, v4 value) {
    memcpy(to, &value, sizeof value);
}
static inline v4 v4_abs(v4 value) {
    return (v4)((v4i)value & INT32_MAX);
}
/* a > b ? a : b: b when one is a NaN. */
static inline v4 v4_max(v4 a, v4 b) {
    const v4i greater = (v4i)(b < a);
    return (v4)(((v4i)a & greater) | ((v4i)b & ~greater));
}
/* Whether no lane is a NaN. */
static inline bool v4_are_numbers(v4 value) {
    const v4i number = (v4i)(value == value);
#ifdef __SSE__
    return _mm_movemask_ps((__m128)number) == 15;
#else
    return number[0] & number[1] & number[2] & number[3];
#endif
}

#endif
