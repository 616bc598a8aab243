/* kernel: patches of pixels for each instruction set, and the kernel's body. A unit for each instruction set
 * (base/kernel_units.h). */
#include "render/shapes/solid.h"

/* A patch is a vector of pixels: one row of them, or two rows of eight where vectors have sixteen lanes. For
 * each level: its width and height; the places of its pixels' centres; loading depths; and storing depth and
 * record where a mask is set. `largest` is the largest lane of a vector without NaNs. */
enum {
    PATCH_WIDTH_generic = 4,
    PATCH_HEIGHT_generic = 1,
    PATCH_WIDTH_avx2 = 8,
    PATCH_HEIGHT_avx2 = 1,
    PATCH_WIDTH_avx512 = 8,
    PATCH_HEIGHT_avx512 = 2
};

/* Pixels from an origin beyond which edges of boxes are not told apart. */
static const float FAR = 1 << 20;

#define ONE_ROW_PATCHES(level, target)                                                                       \
    target static inline vf_##level patch_columns_##level(void) {                                            \
        return v_to_float_##level(v_lanes_##level()) + v_set_##level(0.5f);                                  \
    }                                                                                                        \
    target static inline vf_##level patch_rows_##level(void) {                                               \
        return v_set_##level(0.5f);                                                                          \
    }                                                                                                        \
    target static inline vf_##level patch_load_##level(const float *depth) {                                 \
        return v_load_##level(depth);                                                                        \
    }                                                                                                        \
    target static inline void patch_store_##level(float *depth, int32_t *record, vm_##level mask,            \
                                                  vf_##level z, int32_t number) {                            \
        v_store_##level(depth, v_select_##level(mask, z, v_load_##level(depth)));                            \
        v_storei_##level(record, v_selecti_##level(mask, v_seti_##level(number), v_loadi_##level(record)));  \
    }

ONE_ROW_PATCHES(generic, )
static inline float largest_generic(vf_generic v) {
    const float a = v[0] > v[1] ? v[0] : v[1], b = v[2] > v[3] ? v[2] : v[3];
    return a > b ? a : b;
}
#if ISO_HAVE_X86
ONE_ROW_PATCHES(avx2, ISO_TARGET_AVX2)
ISO_TARGET_AVX2 static inline float largest_avx2(vf_avx2 v) {
    __m128 most = _mm_max_ps(_mm256_castps256_ps128((__m256)v), _mm256_extractf128_ps((__m256)v, 1));
    most = _mm_max_ps(most, _mm_movehl_ps(most, most));
    return _mm_cvtss_f32(_mm_max_ss(most, _mm_shuffle_ps(most, most, 1)));
}

ISO_TARGET_AVX512 static inline float largest_avx512(vf_avx512 v) {
    return _mm512_reduce_max_ps((__m512)v);
}
ISO_TARGET_AVX512 static inline vf_avx512 patch_columns_avx512(void) {
    return v_to_float_avx512(v_lanes_avx512() & 7) + v_set_avx512(0.5f);
}
ISO_TARGET_AVX512 static inline vf_avx512 patch_rows_avx512(void) {
    return v_to_float_avx512(v_lanes_avx512() >> 3) + v_set_avx512(0.5f);
}
ISO_TARGET_AVX512 static inline vf_avx512 patch_load_avx512(const float *depth) {
    const __m512 first = _mm512_castps256_ps512(_mm256_loadu_ps(depth));
    return (vf_avx512)_mm512_insertf32x8(first, _mm256_loadu_ps(depth + ISO_SHAPES_PITCH), 1);
}
ISO_TARGET_AVX512 static inline void patch_store_avx512(float *depth, int32_t *record, vm_avx512 mask,
                                                        vf_avx512 z, int32_t number) {
    const __m256i numbers = _mm256_set1_epi32(number);
    const __mmask8 low = (__mmask8)mask, high = (__mmask8)(mask >> 8);
    _mm256_mask_storeu_ps(depth, low, _mm512_castps512_ps256((__m512)z));
    _mm256_mask_storeu_ps(depth + ISO_SHAPES_PITCH, high, _mm512_extractf32x8_ps((__m512)z, 1));
    _mm256_mask_storeu_epi32(record, low, numbers);
    _mm256_mask_storeu_epi32(record + ISO_SHAPES_PITCH, high, numbers);
}
#endif

#define ISO_KERNEL_BODY "render/shapes/kernel_body.inc"
#include "base/kernel_levels.inc"
