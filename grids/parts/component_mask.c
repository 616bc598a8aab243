/* component_mask: for each voxel type and instruction set a function that compares 64 voxels with a range;
 * the kernels for whole rows are in component_mask_body.inc. */
#include "grids/parts/component_mask.h"

#include <float.h>
#include <math.h>

#include "grids/voxel_kernels.h"

bool iso_mask_range_of(iso_type type, float at, bool below, iso_mask_range *range) {
    *range = (iso_mask_range){.float_lo = below ? -FLT_MAX : at,
                              .float_hi = below ? nextafterf(at, -INFINITY) : FLT_MAX};
    if (type == ISO_FLOAT32)
        return range->float_lo <= range->float_hi && range->float_hi >= -FLT_MAX &&
               range->float_lo <= FLT_MAX;
    const int32_t least = type == ISO_INT16 ? INT16_MIN : 0, most = type == ISO_UINT8   ? UINT8_MAX
                                                                    : type == ISO_INT16 ? INT16_MAX
                                                                                        : UINT16_MAX;
    /* The smallest integer at or above `at`; one beyond the type's range when there is none. */
    const double up = ceil((double)at);
    const int32_t first = up < least ? least : up > most ? most + 1 : (int32_t)up;
    range->lo = below ? least : first;
    range->hi = below ? first - 1 : most;
    return range->lo <= range->hi;
}

/* ---- words of 64 voxels by the instructions of each level; the rest of a row voxel by voxel */

#define SCALAR_WORD(voxel, type, low, high)                                                                  \
    static inline uint64_t rest_##voxel(const type *row, int count, const iso_mask_range *range) {           \
        uint64_t bits = 0;                                                                                   \
        for (int i = 0; i < count; i++)                                                                      \
            bits |= (uint64_t)((row[i] >= range->low) & (row[i] <= range->high)) << i;                       \
        return bits;                                                                                         \
    }                                                                                                        \
    static inline uint64_t word_##voxel##_generic(const type *row, const iso_mask_range *range) {            \
        return rest_##voxel(row, 64, range);                                                                 \
    }
SCALAR_WORD(uint8, uint8_t, lo, hi)
SCALAR_WORD(int16, int16_t, lo, hi)
SCALAR_WORD(uint16, uint16_t, lo, hi)
SCALAR_WORD(float, float, float_lo, float_hi)

#if ISO_HAVE_X86
/* ---- AVX2 */

ISO_TARGET_AVX2 static inline uint64_t word_uint8_avx2(const uint8_t *row, const iso_mask_range *range) {
    const __m256i lo = _mm256_set1_epi8((char)range->lo), hi = _mm256_set1_epi8((char)range->hi);
    uint64_t bits = 0;
    for (int part = 0; part < 2; part++) {
        const __m256i v = _mm256_loadu_si256((const void *)(row + 32 * part));
        const __m256i inside = _mm256_and_si256(_mm256_cmpeq_epi8(_mm256_max_epu8(v, lo), v),
                                                _mm256_cmpeq_epi8(_mm256_min_epu8(v, hi), v));
        bits |= (uint64_t)(uint32_t)_mm256_movemask_epi8(inside) << (32 * part);
    }
    return bits;
}

#define WORD_16_AVX2(name, type, min, max)                                                                   \
    ISO_TARGET_AVX2 static inline uint64_t name(const type *row, const iso_mask_range *range) {              \
        const __m256i lo = _mm256_set1_epi16((short)range->lo), hi = _mm256_set1_epi16((short)range->hi);    \
        uint64_t bits = 0;                                                                                   \
        for (int part = 0; part < 2; part++) {                                                               \
            __m256i inside[2];                                                                               \
            for (int k = 0; k < 2; k++) {                                                                    \
                const __m256i v = _mm256_loadu_si256((const void *)(row + 32 * part + 16 * k));              \
                inside[k] =                                                                                  \
                    _mm256_and_si256(_mm256_cmpeq_epi16(max(v, lo), v), _mm256_cmpeq_epi16(min(v, hi), v));  \
            }                                                                                                \
            /* packs_epi16 works on halves of 128 bits: restores the order of the quarters */                \
            const __m256i bytes = _mm256_permute4x64_epi64(_mm256_packs_epi16(inside[0], inside[1]), 0xd8);  \
            bits |= (uint64_t)(uint32_t)_mm256_movemask_epi8(bytes) << (32 * part);                          \
        }                                                                                                    \
        return bits;                                                                                         \
    }
WORD_16_AVX2(word_int16_avx2, int16_t, _mm256_min_epi16, _mm256_max_epi16)
WORD_16_AVX2(word_uint16_avx2, uint16_t, _mm256_min_epu16, _mm256_max_epu16)

ISO_TARGET_AVX2 static inline uint64_t word_float_avx2(const float *row, const iso_mask_range *range) {
    const __m256 lo = _mm256_set1_ps(range->float_lo), hi = _mm256_set1_ps(range->float_hi);
    uint64_t bits = 0;
    for (int part = 0; part < 8; part++) {
        const __m256 v = _mm256_loadu_ps(row + 8 * part);
        const __m256 inside =
            _mm256_and_ps(_mm256_cmp_ps(v, lo, _CMP_GE_OQ), _mm256_cmp_ps(v, hi, _CMP_LE_OQ));
        bits |= (uint64_t)(uint32_t)_mm256_movemask_ps(inside) << (8 * part);
    }
    return bits;
}

/* ---- AVX-512 */

ISO_TARGET_AVX512 static inline uint64_t word_uint8_avx512(const uint8_t *row, const iso_mask_range *range) {
    const __m512i v = _mm512_loadu_si512(row);
    return _mm512_cmpge_epu8_mask(v, _mm512_set1_epi8((char)range->lo)) &
           _mm512_cmple_epu8_mask(v, _mm512_set1_epi8((char)range->hi));
}

#define WORD_16_AVX512(name, type, ge, le)                                                                   \
    ISO_TARGET_AVX512 static inline uint64_t name(const type *row, const iso_mask_range *range) {            \
        const __m512i lo = _mm512_set1_epi16((short)range->lo), hi = _mm512_set1_epi16((short)range->hi);    \
        const __m512i a = _mm512_loadu_si512(row), b = _mm512_loadu_si512(row + 32);                         \
        const uint64_t low = ge(a, lo) & le(a, hi), high = ge(b, lo) & le(b, hi);                            \
        return low | high << 32;                                                                             \
    }
WORD_16_AVX512(word_int16_avx512, int16_t, _mm512_cmpge_epi16_mask, _mm512_cmple_epi16_mask)
WORD_16_AVX512(word_uint16_avx512, uint16_t, _mm512_cmpge_epu16_mask, _mm512_cmple_epu16_mask)

ISO_TARGET_AVX512 static inline uint64_t word_float_avx512(const float *row, const iso_mask_range *range) {
    const __m512 lo = _mm512_set1_ps(range->float_lo), hi = _mm512_set1_ps(range->float_hi);
    uint64_t bits = 0;
    for (int part = 0; part < 4; part++) {
        const __m512 v = _mm512_loadu_ps(row + 16 * part);
        bits |= (uint64_t)(_mm512_cmp_ps_mask(v, lo, _CMP_GE_OQ) & _mm512_cmp_ps_mask(v, hi, _CMP_LE_OQ))
                << (16 * part);
    }
    return bits;
}
#endif

#define ISO_KERNEL_BODY "grids/voxel_kernels.inc"
#define ISO_VOXEL_BODY "grids/parts/component_mask_body.inc"
#include "base/kernel_levels.inc"
#undef ISO_VOXEL_BODY

iso_mask_kernel *iso_mask_kernel_get(iso_type type, iso_cpu_level level) {
    return ISO_VOXEL_KERNEL(mask_row, type, level);
}
