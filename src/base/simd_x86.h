/* simd_x86: the AVX2 and AVX-512 levels of base/simd.h, which includes it. */
#ifndef ISO_BASE_SIMD_X86_H
#define ISO_BASE_SIMD_X86_H

#include "base/simd.h"

#if ISO_HAVE_X86
/* ---- AVX2 */

typedef float vf_avx2 __attribute__((vector_size(32)));
typedef int32_t vi_avx2 __attribute__((vector_size(32)));
ISO_SIMD_COMMON(avx2, ISO_TARGET_AVX2, 32)
ISO_SIMD_TRUTH(avx2, ISO_TARGET_AVX2)

ISO_SIMD_SLIDE(v_next1, avx2, ISO_TARGET_AVX2, 1, 2, 3, 4, 5, 6, 7, 8)
ISO_SIMD_SLIDE(v_next2, avx2, ISO_TARGET_AVX2, 2, 3, 4, 5, 6, 7, 8, 9)
ISO_SIMD_SLIDE(v_last1, avx2, ISO_TARGET_AVX2, 7, 8, 9, 10, 11, 12, 13, 14)
ISO_SIMD_SLIDE(v_last2, avx2, ISO_TARGET_AVX2, 6, 7, 8, 9, 10, 11, 12, 13)
ISO_SIMD_SLIDE(v_even, avx2, ISO_TARGET_AVX2, 0, 2, 4, 6, 8, 10, 12, 14)
ISO_SIMD_SLIDE(v_odd, avx2, ISO_TARGET_AVX2, 1, 3, 5, 7, 9, 11, 13, 15)
ISO_SIMD_SLIDE(v_zip_low, avx2, ISO_TARGET_AVX2, 0, 8, 1, 9, 2, 10, 3, 11)
ISO_SIMD_SLIDE(v_zip_high, avx2, ISO_TARGET_AVX2, 4, 12, 5, 13, 6, 14, 7, 15)

ISO_TARGET_AVX2 static inline vi_avx2 v_lanes_avx2(void) {
    return (vi_avx2){0, 1, 2, 3, 4, 5, 6, 7};
}
ISO_TARGET_AVX2 static inline vi_avx2 v_load_u8_avx2(const uint8_t *from) {
    return (vi_avx2)_mm256_cvtepu8_epi32(_mm_loadl_epi64((const __m128i *)from));
}
ISO_TARGET_AVX2 static inline vi_avx2 v_load_u16_avx2(const uint16_t *from) {
    return (vi_avx2)_mm256_cvtepu16_epi32(_mm_loadu_si128((const __m128i *)from));
}
ISO_TARGET_AVX2 static inline vi_avx2 v_load_i16_avx2(const int16_t *from) {
    return (vi_avx2)_mm256_cvtepi16_epi32(_mm_loadu_si128((const __m128i *)from));
}
ISO_TARGET_AVX2 static inline vf_avx2 v_gather_avx2(const float *from, vi_avx2 index) {
    return (vf_avx2)_mm256_i32gather_ps(from, (__m256i)index, 4);
}
ISO_TARGET_AVX2 static inline vf_avx2 v_min_avx2(vf_avx2 a, vf_avx2 b) {
    return (vf_avx2)_mm256_min_ps((__m256)a, (__m256)b);
}
ISO_TARGET_AVX2 static inline vf_avx2 v_max_avx2(vf_avx2 a, vf_avx2 b) {
    return (vf_avx2)_mm256_max_ps((__m256)a, (__m256)b);
}
ISO_TARGET_AVX2 static inline vf_avx2 v_sqrt_avx2(vf_avx2 value) {
    return (vf_avx2)_mm256_sqrt_ps((__m256)value);
}
ISO_TARGET_AVX2 static inline uint32_t v_mask_avx2(vm_avx2 mask) {
    return (uint32_t)_mm256_movemask_ps((__m256)mask);
}
ISO_TARGET_AVX2 static inline vm_avx2 v_from_mask_avx2(uint32_t mask) {
    const vi_avx2 bit = {1, 2, 4, 8, 16, 32, 64, 128};
    return (vm_avx2)((v_seti_avx2((int32_t)mask) & bit) == bit);
}
/* The numbers of the set bits of an 8-bit mask, ascending. */
ISO_TARGET_AVX2 static inline __m256i iso_packed_lanes_avx2(uint32_t mask) {
    uint64_t wide = _pdep_u64(mask, 0x0101010101010101u) * 0xff;
    return _mm256_cvtepu8_epi32(_mm_cvtsi64_si128((long long)_pext_u64(0x0706050403020100u, wide)));
}
ISO_TARGET_AVX2 static inline void v_compressi_avx2(int32_t *to, vm_avx2 mask, vi_avx2 value) {
    __m256i lanes = iso_packed_lanes_avx2(v_mask_avx2(mask));
    _mm256_storeu_si256((__m256i *)to, _mm256_permutevar8x32_epi32((__m256i)value, lanes));
}
ISO_TARGET_AVX2 static inline void v_compress_avx2(float *to, vm_avx2 mask, vf_avx2 value) {
    __m256i lanes = iso_packed_lanes_avx2(v_mask_avx2(mask));
    _mm256_storeu_ps(to, _mm256_permutevar8x32_ps((__m256)value, lanes));
}
/* rows[quad][j] holds four floats of lane j in its lower half and of lane j + 4 in its upper half. */
ISO_TARGET_AVX2 static inline __attribute__((always_inline)) void
v_load4_avx2(const float *base, const int32_t *index, int quads, vf_avx2 *out) {
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
        out[0] = (vf_avx2)_mm256_shuffle_ps(a, c, 0x44);
        out[1] = (vf_avx2)_mm256_shuffle_ps(a, c, 0xee);
        out[2] = (vf_avx2)_mm256_shuffle_ps(b, d, 0x44);
        out[3] = (vf_avx2)_mm256_shuffle_ps(b, d, 0xee);
    }
}
ISO_TARGET_AVX2 static inline void v_store4_avx2(float *base, int step, const vf_avx2 in[4]) {
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
ISO_TARGET_AVX2 static inline void v_store_u8_avx2(uint8_t *to, vi_avx2 value) {
    const __m256i first = _mm256_set1_epi32(0x0c080400);
    __m256i bytes = _mm256_shuffle_epi8((__m256i)value, first); /* low bytes of each half, in every 32 bits */
    int32_t low = _mm256_extract_epi32(bytes, 0), high = _mm256_extract_epi32(bytes, 4);
    memcpy(to, &low, 4);
    memcpy(to + 4, &high, 4);
}

/* ---- AVX-512 */

typedef float vf_avx512 __attribute__((vector_size(64)));
typedef int32_t vi_avx512 __attribute__((vector_size(64)));
typedef __mmask16 vm_avx512;
ISO_SIMD_COMMON(avx512, ISO_TARGET_AVX512, 64)

ISO_SIMD_SLIDE(v_next1, avx512, ISO_TARGET_AVX512, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16)
ISO_SIMD_SLIDE(v_next2, avx512, ISO_TARGET_AVX512, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17)
ISO_SIMD_SLIDE(v_last1, avx512, ISO_TARGET_AVX512, 15, 16, 17, 18, 19, 20, 21, 22, 23, 24, 25, 26, 27, 28, 29,
               30)
ISO_SIMD_SLIDE(v_last2, avx512, ISO_TARGET_AVX512, 14, 15, 16, 17, 18, 19, 20, 21, 22, 23, 24, 25, 26, 27, 28,
               29)
ISO_SIMD_SLIDE(v_even, avx512, ISO_TARGET_AVX512, 0, 2, 4, 6, 8, 10, 12, 14, 16, 18, 20, 22, 24, 26, 28, 30)
ISO_SIMD_SLIDE(v_odd, avx512, ISO_TARGET_AVX512, 1, 3, 5, 7, 9, 11, 13, 15, 17, 19, 21, 23, 25, 27, 29, 31)
ISO_SIMD_SLIDE(v_zip_low, avx512, ISO_TARGET_AVX512, 0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7, 23)
ISO_SIMD_SLIDE(v_zip_high, avx512, ISO_TARGET_AVX512, 8, 24, 9, 25, 10, 26, 11, 27, 12, 28, 13, 29, 14, 30,
               15, 31)

ISO_TARGET_AVX512 static inline vi_avx512 v_lanes_avx512(void) {
    return (vi_avx512){0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};
}
ISO_TARGET_AVX512 static inline vi_avx512 v_load_u8_avx512(const uint8_t *from) {
    return (vi_avx512)_mm512_cvtepu8_epi32(_mm_loadu_si128((const __m128i *)from));
}
ISO_TARGET_AVX512 static inline vi_avx512 v_load_u16_avx512(const uint16_t *from) {
    return (vi_avx512)_mm512_cvtepu16_epi32(_mm256_loadu_si256((const __m256i *)from));
}
ISO_TARGET_AVX512 static inline vi_avx512 v_load_i16_avx512(const int16_t *from) {
    return (vi_avx512)_mm512_cvtepi16_epi32(_mm256_loadu_si256((const __m256i *)from));
}
ISO_TARGET_AVX512 static inline vi_avx512 v_floor_avx512(vf_avx512 value) {
    return (vi_avx512)_mm512_cvt_roundps_epi32((__m512)value, _MM_FROUND_TO_NEG_INF | _MM_FROUND_NO_EXC);
}
ISO_TARGET_AVX512 static inline vf_avx512 v_gather_avx512(const float *from, vi_avx512 index) {
    return (vf_avx512)_mm512_i32gather_ps((__m512i)index, from, 4);
}
ISO_TARGET_AVX512 static inline vf_avx512 v_min_avx512(vf_avx512 a, vf_avx512 b) {
    return (vf_avx512)_mm512_min_ps((__m512)a, (__m512)b);
}
ISO_TARGET_AVX512 static inline vf_avx512 v_max_avx512(vf_avx512 a, vf_avx512 b) {
    return (vf_avx512)_mm512_max_ps((__m512)a, (__m512)b);
}
ISO_TARGET_AVX512 static inline vf_avx512 v_sqrt_avx512(vf_avx512 value) {
    return (vf_avx512)_mm512_sqrt_ps((__m512)value);
}
ISO_TARGET_AVX512 static inline vm_avx512 v_lt_avx512(vf_avx512 a, vf_avx512 b) {
    return _mm512_cmp_ps_mask((__m512)a, (__m512)b, _CMP_LT_OQ);
}
ISO_TARGET_AVX512 static inline vm_avx512 v_le_avx512(vf_avx512 a, vf_avx512 b) {
    return _mm512_cmp_ps_mask((__m512)a, (__m512)b, _CMP_LE_OQ);
}
ISO_TARGET_AVX512 static inline vm_avx512 v_eq_avx512(vf_avx512 a, vf_avx512 b) {
    return _mm512_cmp_ps_mask((__m512)a, (__m512)b, _CMP_EQ_OQ);
}
ISO_TARGET_AVX512 static inline vm_avx512 v_lti_avx512(vi_avx512 a, vi_avx512 b) {
    return _mm512_cmplt_epi32_mask((__m512i)a, (__m512i)b);
}
ISO_TARGET_AVX512 static inline vm_avx512 v_eqi_avx512(vi_avx512 a, vi_avx512 b) {
    return _mm512_cmpeq_epi32_mask((__m512i)a, (__m512i)b);
}
ISO_TARGET_AVX512 static inline vf_avx512 v_select_avx512(vm_avx512 mask, vf_avx512 a, vf_avx512 b) {
    return (vf_avx512)_mm512_mask_blend_ps(mask, (__m512)b, (__m512)a);
}
ISO_TARGET_AVX512 static inline vi_avx512 v_selecti_avx512(vm_avx512 mask, vi_avx512 a, vi_avx512 b) {
    return (vi_avx512)_mm512_mask_blend_epi32(mask, (__m512i)b, (__m512i)a);
}
ISO_TARGET_AVX512 static inline vm_avx512 v_and_avx512(vm_avx512 a, vm_avx512 b) {
    return (vm_avx512)(a & b);
}
ISO_TARGET_AVX512 static inline vm_avx512 v_or_avx512(vm_avx512 a, vm_avx512 b) {
    return (vm_avx512)(a | b);
}
ISO_TARGET_AVX512 static inline vm_avx512 v_andnot_avx512(vm_avx512 a, vm_avx512 b) {
    return (vm_avx512)(a & ~b);
}
ISO_TARGET_AVX512 static inline uint32_t v_mask_avx512(vm_avx512 mask) {
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
ISO_TARGET_AVX512 static inline vm_avx512 v_from_mask_avx512(uint32_t mask) {
    return (vm_avx512)mask;
}
/* Compresses in a register and stores the whole register. On Zen 4 this is many times faster than the
 * instruction that compresses while storing. */
ISO_TARGET_AVX512 static inline void v_compressi_avx512(int32_t *to, vm_avx512 mask, vi_avx512 value) {
    _mm512_storeu_si512(to, _mm512_maskz_compress_epi32(mask, (__m512i)value));
}
ISO_TARGET_AVX512 static inline void v_compress_avx512(float *to, vm_avx512 mask, vf_avx512 value) {
    _mm512_storeu_ps(to, _mm512_maskz_compress_ps(mask, (__m512)value));
}
/* Rows of four floats lie in 128-bit quarters: rows[quad][j] has lanes j, j + 4, j + 8 and j + 12. */
ISO_TARGET_AVX512 static inline __attribute__((always_inline)) void
v_load4_avx512(const float *base, const int32_t *index, int quads, vf_avx512 *out) {
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
        out[0] = (vf_avx512)_mm512_shuffle_ps(a, c, 0x44);
        out[1] = (vf_avx512)_mm512_shuffle_ps(a, c, 0xee);
        out[2] = (vf_avx512)_mm512_shuffle_ps(b, d, 0x44);
        out[3] = (vf_avx512)_mm512_shuffle_ps(b, d, 0xee);
    }
}
ISO_TARGET_AVX512 static inline void v_store4_avx512(float *base, int step, const vf_avx512 in[4]) {
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
ISO_TARGET_AVX512 static inline void v_store_u8_avx512(uint8_t *to, vi_avx512 value) {
    _mm_storeu_si128((__m128i *)to, _mm512_cvtepi32_epi8((__m512i)value));
}
#endif

#endif
