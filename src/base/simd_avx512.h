/* simd_avx512: the AVX-512 level of base/simd.h. */
#ifndef ISO_BASE_SIMD_AVX512_H
#define ISO_BASE_SIMD_AVX512_H

#include "base/simd.h"

#if ISO_LANES == 16
#include <immintrin.h>

typedef __mmask16 vm;
ISO_SIMD_SLIDE(v_next1, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16)
ISO_SIMD_SLIDE(v_next2, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17)
ISO_SIMD_SLIDE(v_last1, 15, 16, 17, 18, 19, 20, 21, 22, 23, 24, 25, 26, 27, 28, 29, 30)
ISO_SIMD_SLIDE(v_last2, 14, 15, 16, 17, 18, 19, 20, 21, 22, 23, 24, 25, 26, 27, 28, 29)
ISO_SIMD_SLIDE(v_even, 0, 2, 4, 6, 8, 10, 12, 14, 16, 18, 20, 22, 24, 26, 28, 30)
ISO_SIMD_SLIDE(v_odd, 1, 3, 5, 7, 9, 11, 13, 15, 17, 19, 21, 23, 25, 27, 29, 31)
ISO_SIMD_SLIDE(v_zip_low, 0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7, 23)
ISO_SIMD_SLIDE(v_zip_high, 8, 24, 9, 25, 10, 26, 11, 27, 12, 28, 13, 29, 14, 30, 15, 31)

static inline vi v_lanes(void) {
    return (vi){0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};
}
static inline vi v_load_u8(const uint8_t *from) {
    return (vi)_mm512_cvtepu8_epi32(_mm_loadu_si128((const __m128i *)from));
}
static inline vi v_load_u16(const uint16_t *from) {
    return (vi)_mm512_cvtepu16_epi32(_mm256_loadu_si256((const __m256i *)from));
}
static inline vi v_load_i16(const int16_t *from) {
    return (vi)_mm512_cvtepi16_epi32(_mm256_loadu_si256((const __m256i *)from));
}
static inline vi v_floor(vf value) {
    return (vi)_mm512_cvt_roundps_epi32((__m512)value, _MM_FROUND_TO_NEG_INF | _MM_FROUND_NO_EXC);
}
static inline vf v_gather(const float *from, vi index) {
    return (vf)_mm512_i32gather_ps((__m512i)index, from, 4);
}
static inline vf v_min(vf a, vf b) {
    return (vf)_mm512_min_ps((__m512)a, (__m512)b);
}
static inline vf v_max(vf a, vf b) {
    return (vf)_mm512_max_ps((__m512)a, (__m512)b);
}
static inline vf v_sqrt(vf value) {
    return (vf)_mm512_sqrt_ps((__m512)value);
}
static inline vm v_lt(vf a, vf b) {
    return _mm512_cmp_ps_mask((__m512)a, (__m512)b, _CMP_LT_OQ);
}
static inline vm v_le(vf a, vf b) {
    return _mm512_cmp_ps_mask((__m512)a, (__m512)b, _CMP_LE_OQ);
}
static inline vm v_eq(vf a, vf b) {
    return _mm512_cmp_ps_mask((__m512)a, (__m512)b, _CMP_EQ_OQ);
}
static inline vm v_lti(vi a, vi b) {
    return _mm512_cmplt_epi32_mask((__m512i)a, (__m512i)b);
}
static inline vm v_eqi(vi a, vi b) {
    return _mm512_cmpeq_epi32_mask((__m512i)a, (__m512i)b);
}
static inline vf v_select(vm mask, vf a, vf b) {
    return (vf)_mm512_mask_blend_ps(mask, (__m512)b, (__m512)a);
}
static inline vi v_selecti(vm mask, vi a, vi b) {
    return (vi)_mm512_mask_blend_epi32(mask, (__m512i)b, (__m512i)a);
}
static inline vm v_and(vm a, vm b) {
    return (vm)(a & b);
}
static inline vm v_or(vm a, vm b) {
    return (vm)(a | b);
}
static inline vm v_andnot(vm a, vm b) {
    return (vm)(a & ~b);
}
static inline uint32_t v_mask(vm mask) {
#if defined(__GNUC__) && !defined(__clang__) &&                                                              \
    (defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__))
    /* GCC 12 takes a mask of 16 bits that it has moved to the stack for one of 32 when its sanitizers are on.
     */
    uint32_t bits;
    __asm__("kmovw %1, %0" : "=r"(bits) : "k"(mask));
    return bits;
#else
    return mask;
#endif
}
static inline vm v_from_mask(uint32_t mask) {
    return (vm)mask;
}
/* Compresses in a register and stores the whole register. On Zen 4 this is many times faster than the
 * instruction that compresses while storing. */
static inline void v_compressi(int32_t *to, vm mask, vi value) {
    _mm512_storeu_si512(to, _mm512_maskz_compress_epi32(mask, (__m512i)value));
}
static inline void v_compress(float *to, vm mask, vf value) {
    _mm512_storeu_ps(to, _mm512_maskz_compress_ps(mask, (__m512)value));
}
/* Rows of four floats lie in 128-bit quarters: rows[quad][j] has lanes j, j + 4, j + 8 and j + 12. */
ISO_INLINE void v_load4(const float *base, const int32_t *index, int quads, vf *out) {
    __m512 rows[4][4];
    for (int j = 0; j < 4; j++) {
        const float *lane[4];
        for (int k = 0; k < 4; k++) lane[k] = base + (uint32_t)index[j + 4 * k];
        for (int q = 0; q < quads; q++) {
            __m512 row = _mm512_castps128_ps512(_mm_loadu_ps(lane[0] + 4 * q));
            row = _mm512_insertf32x4(row, _mm_loadu_ps(lane[1] + 4 * q), 1);
            row = _mm512_insertf32x4(row, _mm_loadu_ps(lane[2] + 4 * q), 2);
            rows[q][j] = _mm512_insertf32x4(row, _mm_loadu_ps(lane[3] + 4 * q), 3);
        }
    }
    for (int q = 0; q < quads; q++, out += 4) {
        const __m512 a = _mm512_unpacklo_ps(rows[q][0], rows[q][1]),
                     b = _mm512_unpackhi_ps(rows[q][0], rows[q][1]),
                     c = _mm512_unpacklo_ps(rows[q][2], rows[q][3]),
                     d = _mm512_unpackhi_ps(rows[q][2], rows[q][3]);
        out[0] = (vf)_mm512_shuffle_ps(a, c, 0x44);
        out[1] = (vf)_mm512_shuffle_ps(a, c, 0xee);
        out[2] = (vf)_mm512_shuffle_ps(b, d, 0x44);
        out[3] = (vf)_mm512_shuffle_ps(b, d, 0xee);
    }
}
static inline void v_store4(float *base, int step, const vf in[4]) {
    __m512 t[4];
    for (int k = 0; k < 4; k += 2) {
        t[k] = _mm512_unpacklo_ps((__m512)in[k], (__m512)in[k + 1]);
        t[k + 1] = _mm512_unpackhi_ps((__m512)in[k], (__m512)in[k + 1]);
    }
    for (int j = 0; j < 4; j++) {
        __m512 row = j % 2 ? _mm512_shuffle_ps(t[j / 2], t[2 + j / 2], 0xee)
                           : _mm512_shuffle_ps(t[j / 2], t[2 + j / 2], 0x44);
        _mm_storeu_ps(base + j * step, _mm512_castps512_ps128(row));
        _mm_storeu_ps(base + (j + 4) * step, _mm512_extractf32x4_ps(row, 1));
        _mm_storeu_ps(base + (j + 8) * step, _mm512_extractf32x4_ps(row, 2));
        _mm_storeu_ps(base + (j + 12) * step, _mm512_extractf32x4_ps(row, 3));
    }
}
static inline void v_store_u8(uint8_t *to, vi value) {
    _mm_storeu_si128((__m128i *)to, _mm512_cvtepi32_epi8((__m512i)value));
}
#endif

#endif
