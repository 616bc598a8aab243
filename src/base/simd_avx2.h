/* simd_avx2: the AVX2 level of base/simd.h. */
#ifndef ISO_BASE_SIMD_AVX2_H
#define ISO_BASE_SIMD_AVX2_H

#include "base/simd.h"

#if ISO_LANES == 8
#include <immintrin.h>

ISO_SIMD_SLIDE(v_next1, 1, 2, 3, 4, 5, 6, 7, 8)
ISO_SIMD_SLIDE(v_next2, 2, 3, 4, 5, 6, 7, 8, 9)
ISO_SIMD_SLIDE(v_last1, 7, 8, 9, 10, 11, 12, 13, 14)
ISO_SIMD_SLIDE(v_last2, 6, 7, 8, 9, 10, 11, 12, 13)
ISO_SIMD_SLIDE(v_even, 0, 2, 4, 6, 8, 10, 12, 14)
ISO_SIMD_SLIDE(v_odd, 1, 3, 5, 7, 9, 11, 13, 15)
ISO_SIMD_SLIDE(v_zip_low, 0, 8, 1, 9, 2, 10, 3, 11)
ISO_SIMD_SLIDE(v_zip_high, 4, 12, 5, 13, 6, 14, 7, 15)

static inline vi v_lanes(void) {
    return (vi){0, 1, 2, 3, 4, 5, 6, 7};
}
static inline vi v_load_u8(const uint8_t *from) {
    return (vi)_mm256_cvtepu8_epi32(_mm_loadl_epi64((const __m128i *)from));
}
static inline vi v_load_u16(const uint16_t *from) {
    return (vi)_mm256_cvtepu16_epi32(_mm_loadu_si128((const __m128i *)from));
}
static inline vi v_load_i16(const int16_t *from) {
    return (vi)_mm256_cvtepi16_epi32(_mm_loadu_si128((const __m128i *)from));
}
static inline vf v_gather(const float *from, vi index) {
    return (vf)_mm256_i32gather_ps(from, (__m256i)index, 4);
}
static inline vf v_min(vf a, vf b) {
    return (vf)_mm256_min_ps((__m256)a, (__m256)b);
}
static inline vf v_max(vf a, vf b) {
    return (vf)_mm256_max_ps((__m256)a, (__m256)b);
}
static inline vf v_sqrt(vf value) {
    return (vf)_mm256_sqrt_ps((__m256)value);
}
static inline uint32_t v_mask(vm mask) {
    return (uint32_t)_mm256_movemask_ps((__m256)mask);
}
static inline vm v_from_mask(uint32_t mask) {
    const vi bit = {1, 2, 4, 8, 16, 32, 64, 128};
    return (vm)((v_seti((int32_t)mask) & bit) == bit);
}
/* The numbers of the set bits of an 8-bit mask, ascending. */
static inline __m256i iso_packed_lanes(uint32_t mask) {
    uint64_t wide = _pdep_u64(mask, 0x0101010101010101u) * 0xff;
    return _mm256_cvtepu8_epi32(_mm_cvtsi64_si128((long long)_pext_u64(0x0706050403020100u, wide)));
}
static inline void v_compressi(int32_t *to, vm mask, vi value) {
    __m256i lanes = iso_packed_lanes(v_mask(mask));
    _mm256_storeu_si256((__m256i *)to, _mm256_permutevar8x32_epi32((__m256i)value, lanes));
}
static inline void v_compress(float *to, vm mask, vf value) {
    __m256i lanes = iso_packed_lanes(v_mask(mask));
    _mm256_storeu_ps(to, _mm256_permutevar8x32_ps((__m256)value, lanes));
}
/* rows[quad][j] holds four floats of lane j in its lower half and of lane j + 4 in its upper half. */
ISO_INLINE void v_load4(const float *base, const int32_t *index, int quads, vf *out) {
    __m256 rows[4][4];
    for (int j = 0; j < 4; j++) {
        const float *low = base + (uint32_t)index[j], *high = base + (uint32_t)index[j + 4];
        for (int q = 0; q < quads; q++)
            rows[q][j] = _mm256_insertf128_ps(_mm256_castps128_ps256(_mm_loadu_ps(low + 4 * q)),
                                              _mm_loadu_ps(high + 4 * q), 1);
    }
    for (int q = 0; q < quads; q++, out += 4) {
        const __m256 a = _mm256_unpacklo_ps(rows[q][0], rows[q][1]),
                     b = _mm256_unpackhi_ps(rows[q][0], rows[q][1]),
                     c = _mm256_unpacklo_ps(rows[q][2], rows[q][3]),
                     d = _mm256_unpackhi_ps(rows[q][2], rows[q][3]);
        out[0] = (vf)_mm256_shuffle_ps(a, c, 0x44);
        out[1] = (vf)_mm256_shuffle_ps(a, c, 0xee);
        out[2] = (vf)_mm256_shuffle_ps(b, d, 0x44);
        out[3] = (vf)_mm256_shuffle_ps(b, d, 0xee);
    }
}
static inline void v_store4(float *base, int step, const vf in[4]) {
    __m256 t[4];
    for (int k = 0; k < 4; k += 2) {
        t[k] = _mm256_unpacklo_ps((__m256)in[k], (__m256)in[k + 1]);
        t[k + 1] = _mm256_unpackhi_ps((__m256)in[k], (__m256)in[k + 1]);
    }
    for (int j = 0; j < 4; j++) {
        __m256 row = j % 2 ? _mm256_shuffle_ps(t[j / 2], t[2 + j / 2], 0xee)
                           : _mm256_shuffle_ps(t[j / 2], t[2 + j / 2], 0x44);
        _mm_storeu_ps(base + j * step, _mm256_castps256_ps128(row));
        _mm_storeu_ps(base + (j + 4) * step, _mm256_extractf128_ps(row, 1));
    }
}
static inline void v_store_u8(uint8_t *to, vi value) {
    const __m256i first = _mm256_set1_epi32(0x0c080400);
    __m256i bytes = _mm256_shuffle_epi8((__m256i)value, first); /* low bytes of each half, in every 32 bits */
    int32_t low = _mm256_extract_epi32(bytes, 0), high = _mm256_extract_epi32(bytes, 4);
    memcpy(to, &low, 4);
    memcpy(to + 4, &high, 4);
}
#endif

#endif
