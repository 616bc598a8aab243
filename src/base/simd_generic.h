/* simd_generic: the level of base/simd.h for every machine: compilers emulate vectors of 16 bytes where it
 * has none. */
#ifndef ISO_BASE_SIMD_GENERIC_H
#define ISO_BASE_SIMD_GENERIC_H

#include "base/simd.h"

#if ISO_LANES == 4
#ifdef __SSE__
#include <xmmintrin.h>
#endif

ISO_SIMD_SLIDE(v_next1, 1, 2, 3, 4)
ISO_SIMD_SLIDE(v_next2, 2, 3, 4, 5)
ISO_SIMD_SLIDE(v_last1, 3, 4, 5, 6)
ISO_SIMD_SLIDE(v_last2, 2, 3, 4, 5)
ISO_SIMD_SLIDE(v_even, 0, 2, 4, 6)
ISO_SIMD_SLIDE(v_odd, 1, 3, 5, 7)
ISO_SIMD_SLIDE(v_zip_low, 0, 4, 1, 5)
ISO_SIMD_SLIDE(v_zip_high, 2, 6, 3, 7)

static inline vi v_lanes(void) {
    return (vi){0, 1, 2, 3};
}
static inline vi v_load_u8(const uint8_t *from) {
    return (vi){from[0], from[1], from[2], from[3]};
}
static inline vi v_load_u16(const uint16_t *from) {
    return (vi){from[0], from[1], from[2], from[3]};
}
static inline vi v_load_i16(const int16_t *from) {
    return (vi){from[0], from[1], from[2], from[3]};
}
static inline vf v_gather(const float *from, vi index) {
    return (vf){from[index[0]], from[index[1]], from[index[2]], from[index[3]]};
}
static inline vf v_min(vf a, vf b) {
    return v_select(v_lt(a, b), a, b);
}
static inline vf v_max(vf a, vf b) {
    return v_select(v_lt(b, a), a, b);
}
static inline vf v_sqrt(vf value) {
    return (vf){sqrtf(value[0]), sqrtf(value[1]), sqrtf(value[2]), sqrtf(value[3])};
}
static inline uint32_t v_mask(vm mask) {
#ifdef __SSE__
    return (uint32_t)_mm_movemask_ps((__m128)mask);
#else
    return (uint32_t)((mask[0] & 1) | (mask[1] & 2) | (mask[2] & 4) | (mask[3] & 8));
#endif
}
static inline vm v_from_mask(uint32_t mask) {
    const vi bit = {1, 2, 4, 8};
    return (vm)((v_seti((int32_t)mask) & bit) == bit);
}
static inline void v_compressi(int32_t *to, vm mask, vi value) {
    int count = 0;
    for (int lane = 0; lane < ISO_LANES; lane++) {
        to[count] = value[lane];
        count += mask[lane] & 1;
    }
}
static inline void v_compress(float *to, vm mask, vf value) {
    int count = 0;
    for (int lane = 0; lane < ISO_LANES; lane++) {
        to[count] = value[lane];
        count += mask[lane] & 1;
    }
}
static inline void v_store_u8(uint8_t *to, vi value) {
    for (int lane = 0; lane < ISO_LANES; lane++) to[lane] = (uint8_t)value[lane];
}

static inline void v_load4(const float *base, const int32_t *index, int quads, vf *out) {
    for (int k = 0; k < 4 * quads; k++)
        out[k] = (vf){base[index[0] + k], base[index[1] + k], base[index[2] + k], base[index[3] + k]};
}
static inline void v_store4(float *base, int step, const vf in[4]) {
    for (int lane = 0; lane < ISO_LANES; lane++)
        for (int k = 0; k < 4; k++) base[lane * step + k] = in[k][lane];
}
#endif

#endif
