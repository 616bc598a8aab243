/* component_mask_kernel: the bit masks of rows of voxels. For each voxel type there is a function that
 * compares 64 voxels with a range and returns 64 bits, with the instructions of each level, and one for whole
 * rows. */
#include "grids/parts/component_mask.h"

#include "base/simd.h"

/* ---- masks of 64 voxels; fewer voxels are compared one by one */

#define REST(voxel, type, low, high)                                                                         \
    static inline uint64_t rest_##voxel(const type *row, int count, const iso_mask_range *range) {           \
        uint64_t bits = 0;                                                                                   \
        for (int i = 0; i < count; i++)                                                                      \
            bits |= (uint64_t)((row[i] >= range->low) & (row[i] <= range->high)) << i;                       \
        return bits;                                                                                         \
    }
REST(uint8, uint8_t, lo, hi)
REST(int16, int16_t, lo, hi)
REST(uint16, uint16_t, lo, hi)
REST(float, float, float_lo, float_hi)

#if ISO_LANES == 4
#define WORD(voxel, type)                                                                                    \
    static inline uint64_t word_##voxel(const type *row, const iso_mask_range *range) {                      \
        return rest_##voxel(row, 64, range);                                                                 \
    }
WORD(uint8, uint8_t)
WORD(int16, int16_t)
WORD(uint16, uint16_t)
WORD(float, float)
#elif ISO_LANES == 8
static inline uint64_t word_uint8(const uint8_t *row, const iso_mask_range *range) {
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

#define WORD_16(name, type, min, max)                                                                        \
    static inline uint64_t name(const type *row, const iso_mask_range *range) {                              \
        const __m256i lo = _mm256_set1_epi16((short)range->lo), hi = _mm256_set1_epi16((short)range->hi);    \
        uint64_t bits = 0;                                                                                   \
        for (int part = 0; part < 2; part++) {                                                               \
            __m256i inside[2];                                                                               \
            for (int k = 0; k < 2; k++) {                                                                    \
                const __m256i v = _mm256_loadu_si256((const void *)(row + 32 * part + 16 * k));              \
                inside[k] =                                                                                  \
                    _mm256_and_si256(_mm256_cmpeq_epi16(max(v, lo), v), _mm256_cmpeq_epi16(min(v, hi), v));  \
            }                                                                                                \
            /* packing works on halves of 128 bits: the quarters are put in order */                         \
            const __m256i bytes = _mm256_permute4x64_epi64(_mm256_packs_epi16(inside[0], inside[1]), 0xd8);  \
            bits |= (uint64_t)(uint32_t)_mm256_movemask_epi8(bytes) << (32 * part);                          \
        }                                                                                                    \
        return bits;                                                                                         \
    }
WORD_16(word_int16, int16_t, _mm256_min_epi16, _mm256_max_epi16)
WORD_16(word_uint16, uint16_t, _mm256_min_epu16, _mm256_max_epu16)

static inline uint64_t word_float(const float *row, const iso_mask_range *range) {
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
#else
static inline uint64_t word_uint8(const uint8_t *row, const iso_mask_range *range) {
    const __m512i v = _mm512_loadu_si512(row);
    return _mm512_cmpge_epu8_mask(v, _mm512_set1_epi8((char)range->lo)) &
           _mm512_cmple_epu8_mask(v, _mm512_set1_epi8((char)range->hi));
}

#define WORD_16(name, type, ge, le)                                                                          \
    static inline uint64_t name(const type *row, const iso_mask_range *range) {                              \
        const __m512i lo = _mm512_set1_epi16((short)range->lo), hi = _mm512_set1_epi16((short)range->hi);    \
        const __m512i a = _mm512_loadu_si512(row), b = _mm512_loadu_si512(row + 32);                         \
        const uint64_t low = ge(a, lo) & le(a, hi), high = ge(b, lo) & le(b, hi);                            \
        return low | high << 32;                                                                             \
    }
WORD_16(word_int16, int16_t, _mm512_cmpge_epi16_mask, _mm512_cmple_epi16_mask)
WORD_16(word_uint16, uint16_t, _mm512_cmpge_epu16_mask, _mm512_cmple_epu16_mask)

static inline uint64_t word_float(const float *row, const iso_mask_range *range) {
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

/* ---- masks of rows */

#define MASK_ROW(voxel, type)                                                                                \
    static void mask_row_##voxel(const void *data, int count, const iso_mask_range *range,                   \
                                 uint64_t *words) {                                                          \
        const type *row = data;                                                                              \
        for (; count >= 64; count -= 64, row += 64) *words++ = word_##voxel(row, range);                     \
        if (count) *words = rest_##voxel(row, count, range);                                                 \
    }
MASK_ROW(uint8, uint8_t)
MASK_ROW(int16, int16_t)
MASK_ROW(uint16, uint16_t)
MASK_ROW(float, float)

iso_mask_kernels ISO_KERNEL_NAME(iso_mask_kernels) = {[ISO_UINT8] = mask_row_uint8,
                                                      [ISO_INT16] = mask_row_int16,
                                                      [ISO_UINT16] = mask_row_uint16,
                                                      [ISO_FLOAT32] = mask_row_float};
