/* edge_rows_simd: the functions of the edge kernel that differ by instruction set:
 *   bits        (row, threshold): 64 voxels to 64 bits, set at or above the threshold. (A threshold outside
 *               the range of the voxel type does not fit a vector's lane, and is handled first.)
 *   expand      (mask, row, count, x, rows): writes the positions of the `count` set bits of a mask to x, and
 *               `row` as many times to rows. Both need room for 64 items: those after the written ones may be
 *               overwritten
 *   list_rows   (bits, next, columns, rows, z, axes): adds the crossed edges of slice z to the lists of the
 *               three axes. bits, next: the inside bits of the slice's rows in this block and in the next one
 *               along x; rows: a bit for each row whose edges are wanted; columns: the bits of the voxels
 *               whose edges are wanted. Returns the number of edges of each brick, 16 bits a brick */
#ifndef ISO_EXTRACT_POINTS_EDGE_ROWS_SIMD_H
#define ISO_EXTRACT_POINTS_EDGE_ROWS_SIMD_H

#include "base/simd.h"
#include "extract/points/edge_kernel.h"
#include "grids/threshold.h"
#include "grids/voxel_kernel.h"

/* The isovalue as the type with which voxels are compared: an integer or a float. */
#if ISO_VOXEL_IS(float)
#define ISO_THRESHOLD float
#define ISO_THRESHOLD_OF(isovalue) (isovalue)
#else
#define ISO_THRESHOLD int32_t
#define ISO_THRESHOLD_OF iso_integer_threshold
#endif

/* ---- bits */

#if ISO_LANES == 4
static inline uint64_t bits(const ISO_T *row, ISO_THRESHOLD threshold) {
    uint64_t bits = 0;
    for (int x = 0; x < 64; x++) bits |= (uint64_t)(row[x] >= threshold) << x;
    return bits;
}
#elif ISO_LANES == 8
#if ISO_VOXEL_IS(uint8)
static inline uint64_t bits(const uint8_t *row, int32_t threshold) {
    if (threshold <= 0 || threshold > 255) return threshold <= 0 ? ~(uint64_t)0 : 0;
    const __m256i limit = _mm256_set1_epi8((char)threshold);
    const __m256i a = _mm256_loadu_si256((const void *)row), b = _mm256_loadu_si256((const void *)(row + 32));
    uint32_t low = (uint32_t)_mm256_movemask_epi8(_mm256_cmpeq_epi8(_mm256_max_epu8(a, limit), a));
    uint32_t high = (uint32_t)_mm256_movemask_epi8(_mm256_cmpeq_epi8(_mm256_max_epu8(b, limit), b));
    return low | (uint64_t)high << 32;
}
#elif ISO_VOXEL_IS(float)
static inline uint64_t bits(const float *row, float threshold) {
    const __m256 limit = _mm256_set1_ps(threshold);
    uint64_t bits = 0;
    for (int part = 0; part < 8; part++) {
        __m256 above = _mm256_cmp_ps(_mm256_loadu_ps(row + 8 * part), limit, _CMP_GE_OQ);
        bits |= (uint64_t)(uint32_t)_mm256_movemask_ps(above) << (8 * part);
    }
    return bits;
}
#else
/* A bit for each of 64 voxels of 16 bits: set if the voxel, after xor with `bias`, is greater than `below` as
 * a signed number. */
static inline uint64_t bits_16(const void *row, int16_t below, int16_t bias) {
    const __m256i limit = _mm256_set1_epi16(below), flip = _mm256_set1_epi16(bias);
    uint64_t bits = 0;
    for (int part = 0; part < 2; part++) {
        const __m256i *p = (const __m256i *)row + 2 * part;
        __m256i a = _mm256_cmpgt_epi16(_mm256_xor_si256(_mm256_loadu_si256(p), flip), limit);
        __m256i b = _mm256_cmpgt_epi16(_mm256_xor_si256(_mm256_loadu_si256(p + 1), flip), limit);
        __m256i bytes = _mm256_permute4x64_epi64(_mm256_packs_epi16(a, b), 0xd8);
        bits |= (uint64_t)(uint32_t)_mm256_movemask_epi8(bytes) << (32 * part);
    }
    return bits;
}

#if ISO_VOXEL_IS(int16)
static inline uint64_t bits(const int16_t *row, int32_t threshold) {
    if (threshold <= INT16_MIN || threshold > INT16_MAX) return threshold <= INT16_MIN ? ~(uint64_t)0 : 0;
    return bits_16(row, (int16_t)(threshold - 1), 0);
}
#else
static inline uint64_t bits(const uint16_t *row, int32_t threshold) {
    if (threshold <= 0 || threshold > UINT16_MAX) return threshold <= 0 ? ~(uint64_t)0 : 0;
    return bits_16(row, (int16_t)(threshold - 1 - 0x8000), INT16_MIN);
}
#endif
#endif
#elif ISO_VOXEL_IS(uint8)
static inline uint64_t bits(const uint8_t *row, int32_t threshold) {
    if (threshold <= 0 || threshold > 255) return threshold <= 0 ? ~(uint64_t)0 : 0;
    return _mm512_cmpge_epu8_mask(_mm512_loadu_si512(row), _mm512_set1_epi8((char)threshold));
}
#elif ISO_VOXEL_IS(int16)
static inline uint64_t bits(const int16_t *row, int32_t threshold) {
    if (threshold <= INT16_MIN || threshold > INT16_MAX) return threshold <= INT16_MIN ? ~(uint64_t)0 : 0;
    const __m512i limit = _mm512_set1_epi16((int16_t)threshold);
    return _mm512_cmpge_epi16_mask(_mm512_loadu_si512(row), limit) |
           (uint64_t)_mm512_cmpge_epi16_mask(_mm512_loadu_si512(row + 32), limit) << 32;
}
#elif ISO_VOXEL_IS(uint16)
static inline uint64_t bits(const uint16_t *row, int32_t threshold) {
    if (threshold <= 0 || threshold > UINT16_MAX) return threshold <= 0 ? ~(uint64_t)0 : 0;
    const __m512i limit = _mm512_set1_epi16((int16_t)threshold);
    return _mm512_cmpge_epu16_mask(_mm512_loadu_si512(row), limit) |
           (uint64_t)_mm512_cmpge_epu16_mask(_mm512_loadu_si512(row + 32), limit) << 32;
}
#else
static inline uint64_t bits(const float *row, float threshold) {
    const __m512 limit = _mm512_set1_ps(threshold);
    uint64_t bits = 0;
    for (int part = 0; part < 4; part++)
        bits |= (uint64_t)_mm512_cmp_ps_mask(_mm512_loadu_ps(row + 16 * part), limit, _CMP_GE_OQ)
                << (16 * part);
    return bits;
}
#endif

/* ---- expand, list_rows */

#if ISO_LANES < 16
static inline void expand(uint64_t mask, uint16_t row, int count, uint8_t *x, uint16_t *rows) {
    for (int i = 0; i < 16; i++) rows[i] = row;
    if (count > 16)
        for (int i = 16; i < 64; i++) rows[i] = row;
    for (int i = 0; i < count; i += 4) /* four at a time: most words have few bits, one branch decides */
        for (int k = 0; k < 4; k++) {
            x[i + k] = (uint8_t)__builtin_ctzll(mask | (uint64_t)1 << 63);
            mask &= mask - 1;
        }
}

static inline uint64_t list_rows(const uint64_t *bits, const uint64_t *next, uint64_t columns, uint32_t rows,
                                 int z, iso_edge_list axes[3]) {
    uint64_t lanes = 0;
    for (; rows; rows &= rows - 1) {
        const int y = __builtin_ctz(rows);
        const uint64_t here = bits[y];
        const uint64_t edges[3] = {(here ^ (here >> 1 | next[y] << 63)) & columns,
                                   (here ^ bits[y + 1]) & columns,
                                   (here ^ bits[y + ISO_EDGE_SIDE]) & columns};
        if (!(edges[0] | edges[1] | edges[2])) continue;
        /* without branches: a word is always written, and counted only if it is not empty */
        for (int axis = 0; axis < 3; axis++) {
            iso_edge_list *list = &axes[axis];
            list->mask[list->count] = edges[axis];
            list->row[list->count] = (uint16_t)(z << 5 | y);
            list->count += edges[axis] != 0;
            lanes += iso_edge_lane_counts(edges[axis]);
        }
    }
    return lanes;
}
#else
static inline void expand(uint64_t mask, uint16_t row, int count, uint8_t *x, uint16_t *rows) {
    const __m512i all =
        _mm512_set_epi8(63, 62, 61, 60, 59, 58, 57, 56, 55, 54, 53, 52, 51, 50, 49, 48, 47, 46, 45, 44, 43,
                        42, 41, 40, 39, 38, 37, 36, 35, 34, 33, 32, 31, 30, 29, 28, 27, 26, 25, 24, 23, 22,
                        21, 20, 19, 18, 17, 16, 15, 14, 13, 12, 11, 10, 9, 8, 7, 6, 5, 4, 3, 2, 1, 0);
    _mm512_storeu_si512(x, _mm512_maskz_compress_epi8(mask, all));
    _mm512_storeu_si512(rows, _mm512_set1_epi16((short)row));
    if (count > 32) _mm512_storeu_si512(rows + 32, _mm512_set1_epi16((short)row));
}

/* iso_edge_lane_counts of eight words at once. */
static inline __m512i lane_counts(__m512i mask) {
    const __m512i pairs = _mm512_set1_epi8(0x55), nibbles = _mm512_set1_epi8(0x33),
                  bytes = _mm512_set1_epi8(0x0f);
    mask = _mm512_sub_epi8(mask, _mm512_and_si512(_mm512_srli_epi16(mask, 1), pairs));
    mask = _mm512_add_epi8(_mm512_and_si512(mask, nibbles),
                           _mm512_and_si512(_mm512_srli_epi16(mask, 2), nibbles));
    mask = _mm512_and_si512(_mm512_add_epi8(mask, _mm512_srli_epi16(mask, 4)), bytes);
    return _mm512_maddubs_epi16(mask, _mm512_set1_epi8(1));
}

/* Adds those words of eight rows that are in `kept` and not empty to a list; returns their lane counts. */
static inline __m512i append(__m512i edges, __m128i rows, __mmask8 kept, iso_edge_list *list) {
    kept = _mm512_mask_test_epi64_mask(kept, edges, edges);
    _mm512_storeu_si512(list->mask + list->count, _mm512_maskz_compress_epi64(kept, edges));
    _mm_storeu_si128((void *)(list->row + list->count), _mm_maskz_compress_epi16(kept, rows));
    list->count += __builtin_popcount(kept);
    return lane_counts(_mm512_maskz_mov_epi64(kept, edges));
}

/* Eight rows at a time. */
static inline uint64_t list_rows(const uint64_t *bits, const uint64_t *next, uint64_t columns, uint32_t rows,
                                 int z, iso_edge_list axes[3]) {
    const __m512i inside = _mm512_set1_epi64((int64_t)columns);
    __m512i lanes = _mm512_setzero_si512();
    for (int y = 0; y < ISO_BRICK; y += 8) {
        const __mmask8 kept = (__mmask8)(rows >> y);
        if (!kept) continue;
        const __m512i here = _mm512_loadu_si512(bits + y);
        const __m512i right =
            _mm512_or_si512(_mm512_srli_epi64(here, 1), _mm512_slli_epi64(_mm512_loadu_si512(next + y), 63));
        const __m512i ahead[3] = {right, _mm512_loadu_si512(bits + y + 1),
                                  _mm512_loadu_si512(bits + y + ISO_EDGE_SIDE)};
        const __m128i numbers =
            _mm_add_epi16(_mm_set1_epi16((short)(z << 5 | y)), _mm_setr_epi16(0, 1, 2, 3, 4, 5, 6, 7));
        for (int axis = 0; axis < 3; axis++) {
            const __m512i edges = _mm512_and_si512(_mm512_xor_si512(here, ahead[axis]), inside);
            lanes = _mm512_add_epi16(lanes, append(edges, numbers, kept, &axes[axis]));
        }
    }
    const __m256i four = _mm256_add_epi16(_mm512_castsi512_si256(lanes), _mm512_extracti64x4_epi64(lanes, 1));
    const __m128i two = _mm_add_epi16(_mm256_castsi256_si128(four), _mm256_extracti128_si256(four, 1));
    return (uint64_t)_mm_cvtsi128_si64(_mm_add_epi16(two, _mm_unpackhi_epi64(two, two)));
}
#endif

#endif
