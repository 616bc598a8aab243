/* foot_lanes_simd: the functions of the kernel of foot points that differ by instruction set:
 *   band_hits        (row, at, top): which of a row's 16 voxels are in the band, a bit each
 *   any              (bytes): which of 64 bytes are not 0, a bit each
 *   row_addresses    (first, rows): the addresses of the 16 rows of a slice
 *   queue_half_row   (band, half_row, queue, voxel): queues the voxels of a half row that are in the band and
 *                    whose stencil has no clamped value; returns how many there are. queue: the next free
 *                    item of scratch->queue[0], voxel: of scratch->voxel */
#ifndef ISO_EXTRACT_POINTS_FOOT_LANES_SIMD_H
#define ISO_EXTRACT_POINTS_FOOT_LANES_SIMD_H

#include "base/simd.h"
#include "extract/points/foot_kernel.h"

/* A half row (eight voxels of a row of a brick) and its neighbours. */
typedef struct foot_half_row {
    uint32_t hits; /* bits of the voxels in the band */
    int32_t voxel; /* number of its first voxel in the brick */
    const float *here, *low_y, *high_y, *low_z, *high_z;
    const float *before, *after; /* the voxels before its first and after its last along x */
} foot_half_row;

#if ISO_LANES == 4

static inline uint32_t band_hits(const float *row, float at, float top) {
    uint32_t bits = 0;
    for (int x = 0; x < 16; x++) bits |= (uint32_t)((row[x] >= at) & (row[x] < top)) << (x & 7) << (x & 8);
    return bits;
}

/* Which of 64 bytes are not 0. */
static inline uint64_t any(const uint8_t *bytes) {
    uint64_t bits = 0;
    for (int i = 0; i < 64; i++) bits |= (uint64_t)(bytes[i] != 0) << i;
    return bits;
}

/* The addresses of the 16 rows of a slice. */
static inline void row_addresses(const float *first, const float **rows) {
    for (int y = 0; y < ISO_BRICK; y++) rows[y] = first + y * ISO_BRICK;
}

/* Queues the voxels of a half row that are in the band and whose stencil has no clamped value;
 * returns how many there are. queue: the next free item of scratch->queue[0], voxel: of scratch->voxel. */
static inline uint32_t queue_half_row(float band, const foot_half_row *half_row, float *queue,
                                      int32_t *voxel) {
    uint32_t n = 0;
    for (uint32_t hits = half_row->hits; hits; hits &= hits - 1) {
        const int i = __builtin_ctz(hits);
        const iso_foot_stencil s = {.centre = half_row->here[i],
                                    .low = {i > 0 ? half_row->here[i - 1] : *half_row->before,
                                            half_row->low_y[i], half_row->low_z[i]},
                                    .high = {i < 7 ? half_row->here[i + 1] : *half_row->after,
                                             half_row->high_y[i], half_row->high_z[i]}};
        if (iso_foot_is_clamped(band, &s)) continue;
        queue[n] = s.centre;
        for (int axis = 0; axis < 3; axis++)
            queue[(axis + 1) * ISO_FOOT_ROOM + (int)n] = s.high[axis] - s.low[axis];
        voxel[n++] = half_row->voxel + i;
    }
    return n;
}

#else

/* Entry k is the list of the positions of k's set bits: byte j is the position of the j-th one. */
#define BITS_BELOW(k, i)                                                                                     \
    (((k)&1 && i > 0) + ((k)&2 && i > 1) + ((k)&4 && i > 2) + ((k)&8 && i > 3) + ((k)&16 && i > 4) +         \
     ((k)&32 && i > 5) + ((k)&64 && i > 6))
#define PLACE(k, i) ((uint64_t)((k) >> i & 1) * i << 8 * BITS_BELOW(k, i))
#define PLACES(k)                                                                                            \
    (PLACE(k, 1) | PLACE(k, 2) | PLACE(k, 3) | PLACE(k, 4) | PLACE(k, 5) | PLACE(k, 6) | PLACE(k, 7))
#define PLACES_4(k) PLACES(k), PLACES(k + 1), PLACES(k + 2), PLACES(k + 3)
#define PLACES_16(k) PLACES_4(k), PLACES_4(k + 4), PLACES_4(k + 8), PLACES_4(k + 12)
#define PLACES_64(k) PLACES_16(k), PLACES_16(k + 16), PLACES_16(k + 32), PLACES_16(k + 48)
static const uint64_t set_places[256] = {PLACES_64(0), PLACES_64(64), PLACES_64(128), PLACES_64(192)};

/* The values of a half row's eight voxels and of their neighbours on each axis. */
typedef struct foot_lanes {
    __m256 centre, low[3], high[3];
} foot_lanes;

__attribute__((always_inline)) static inline foot_lanes lanes_of(const foot_half_row *half_row) {
    const __m256i down = _mm256_setr_epi32(0, 0, 1, 2, 3, 4, 5, 6),
                  up = _mm256_setr_epi32(1, 2, 3, 4, 5, 6, 7, 7);
    const __m256 v = _mm256_load_ps(half_row->here);
    const __m256 before = _mm256_broadcast_ss(half_row->before), after = _mm256_broadcast_ss(half_row->after);
    return (foot_lanes){.centre = v,
                        .low = {_mm256_blend_ps(_mm256_permutevar8x32_ps(v, down), before, 1),
                                _mm256_load_ps(half_row->low_y), _mm256_load_ps(half_row->low_z)},
                        .high = {_mm256_blend_ps(_mm256_permutevar8x32_ps(v, up), after, 128),
                                 _mm256_load_ps(half_row->high_y), _mm256_load_ps(half_row->high_z)}};
}

/* Queues the lanes whose bits in `kept` are set; returns how many there are. Always writes eight items: the
 * next half row overwrites those too many. first: number of the half row's first voxel. */
__attribute__((always_inline)) static inline uint32_t
store_lanes(const foot_lanes *lanes, uint32_t kept, int32_t first, float *queue, int32_t *voxel) {
    const __m256i places = _mm256_cvtepu8_epi32(_mm_loadl_epi64((const void *)&set_places[kept]));
    _mm256_storeu_si256((void *)voxel, _mm256_add_epi32(places, _mm256_set1_epi32(first)));
    _mm256_storeu_ps(queue, _mm256_permutevar8x32_ps(lanes->centre, places));
    for (int axis = 0; axis < 3; axis++) {
        const __m256 difference = _mm256_sub_ps(lanes->high[axis], lanes->low[axis]);
        _mm256_storeu_ps(queue + (axis + 1) * ISO_FOOT_ROOM, _mm256_permutevar8x32_ps(difference, places));
    }
    return (uint32_t)__builtin_popcount(kept);
}

#if ISO_LANES == 8

static inline __m256 in_band(const float *values, float at, float top) {
    const __m256 v = _mm256_load_ps(values);
    return _mm256_and_ps(_mm256_cmp_ps(v, _mm256_set1_ps(at), _CMP_GE_OQ),
                         _mm256_cmp_ps(v, _mm256_set1_ps(top), _CMP_LT_OQ));
}

static inline uint32_t band_hits(const float *row, float at, float top) {
    return (uint32_t)_mm256_movemask_ps(in_band(row, at, top)) |
           (uint32_t)_mm256_movemask_ps(in_band(row + 8, at, top)) << 8;
}

static inline uint64_t any(const uint8_t *bytes) {
    const __m256i zero = _mm256_setzero_si256();
    const __m256i a = _mm256_load_si256((const void *)bytes),
                  b = _mm256_load_si256((const void *)(bytes + 32));
    const uint32_t low = (uint32_t)_mm256_movemask_epi8(_mm256_cmpeq_epi8(a, zero)),
                   high = (uint32_t)_mm256_movemask_epi8(_mm256_cmpeq_epi8(b, zero));
    return ~(low | (uint64_t)high << 32);
}

static inline void row_addresses(const float *first, const float **rows) {
    const __m256i four_rows = _mm256_set1_epi64x(4 * sizeof(float[ISO_BRICK]));
    __m256i place =
        _mm256_add_epi64(_mm256_set1_epi64x((intptr_t)first), _mm256_setr_epi64x(0, 64, 128, 192));
    for (int y = 0; y < ISO_BRICK; y += 4) {
        _mm256_store_si256((void *)(rows + y), place);
        place = _mm256_add_epi64(place, four_rows);
    }
}

/* The greater of two magnitudes, lane by lane. With a NaN the result may be either: such a voxel is irregular
 * and computed again. */
static inline __m256 greater(__m256 a, __m256 b) {
    const __m256 sign = _mm256_set1_ps(-0.0f);
    return _mm256_max_ps(_mm256_andnot_ps(sign, a), _mm256_andnot_ps(sign, b));
}

static inline uint32_t queue_half_row(float band, const foot_half_row *half_row, float *queue,
                                      int32_t *voxel) {
    const foot_lanes lanes = lanes_of(half_row);
    __m256 most = _mm256_andnot_ps(_mm256_set1_ps(-0.0f), lanes.centre);
    for (int axis = 0; axis < 3; axis++)
        most = _mm256_max_ps(greater(lanes.low[axis], lanes.high[axis]), most);
    const __m256 clamped = _mm256_cmp_ps(most, _mm256_set1_ps(band), _CMP_GE_OQ);
    const uint32_t kept = half_row->hits & ~(uint32_t)_mm256_movemask_ps(clamped);
    return store_lanes(&lanes, kept, half_row->voxel, queue, voxel);
}

#else

static inline uint32_t band_hits(const float *row, float at, float top) {
    const __m512 v = _mm512_load_ps(row);
    const __mmask16 above = _mm512_cmp_ps_mask(v, _mm512_set1_ps(at), _CMP_GE_OQ);
    return _mm512_mask_cmp_ps_mask(above, v, _mm512_set1_ps(top), _CMP_LT_OQ);
}

static inline uint64_t any(const uint8_t *bytes) {
    const __m512i v = _mm512_load_si512((const void *)bytes);
    return _mm512_test_epi8_mask(v, v);
}

static inline void row_addresses(const float *first, const float **rows) {
    const __m512i steps = _mm512_setr_epi64(0, 64, 128, 192, 256, 320, 384, 448);
    const __m512i place = _mm512_add_epi64(_mm512_set1_epi64((intptr_t)first), steps);
    _mm512_store_si512((void *)rows, place);
    _mm512_store_si512((void *)(rows + 8), _mm512_add_epi64(place, _mm512_set1_epi64(512)));
}

/* Works on eight lanes, not 16, because few of a row's sixteen voxels are in the band. */
static inline uint32_t queue_half_row(float band, const foot_half_row *half_row, float *queue,
                                      int32_t *voxel) {
    const foot_lanes lanes = lanes_of(half_row);
    enum { GREATER_MAGNITUDE = 0x0b };
    __m256 most = lanes.centre;
    for (int axis = 0; axis < 3; axis++)
        most = _mm256_range_ps(most, _mm256_range_ps(lanes.low[axis], lanes.high[axis], GREATER_MAGNITUDE),
                               GREATER_MAGNITUDE);
    const __mmask8 clamped = _mm256_cmp_ps_mask(most, _mm256_set1_ps(band), _CMP_GE_OQ);
    return store_lanes(&lanes, half_row->hits & ~(uint32_t)clamped, half_row->voxel, queue, voxel);
}

#endif
#endif

#endif
