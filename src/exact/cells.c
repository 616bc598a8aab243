/* cells: copies selected elements of a row without gaps (pack_BYTES_LEVEL), for each instruction set, and
 * includes the kernel that finds a brick's crossed cells (cells_body.inc) once per instruction set. */
#include "exact/cells.h"

#include <math.h>
#include <string.h>

#include "grids/threshold.h"
#include "grids/voxel_kernels.h"

/* ---- pack_BYTES_LEVEL(to, from, mask): copies, without gaps, those of the 8 elements of 1, 2 or 4 bytes at
 * `from` whose bits in `mask` are set. `to` needs room for 8 elements; those after the copied ones are
 * undefined afterwards. */

#define ISO_EXACT_PACK_BITS(name, type)                                                                      \
    static inline void name(void *to, const void *from, uint32_t mask) {                                     \
        for (type *out = to; mask; mask &= mask - 1) *out++ = ((const type *)from)[__builtin_ctz(mask)];     \
    }
ISO_EXACT_PACK_BITS(pack_1_generic, uint8_t)
ISO_EXACT_PACK_BITS(pack_2_generic, uint16_t)
ISO_EXACT_PACK_BITS(pack_4_generic, float)

#if ISO_HAVE_X86
ISO_TARGET_AVX2 static inline void pack_1_avx2(void *to, const void *from, uint32_t mask) {
    uint64_t row;
    memcpy(&row, from, sizeof row);
    row = _pext_u64(row, _pdep_u64(mask, 0x0101010101010101u) * 0xff);
    memcpy(to, &row, sizeof row);
}
ISO_TARGET_AVX2 static inline void pack_2_avx2(void *to, const void *from, uint32_t mask) {
    uint64_t row[2];
    memcpy(row, from, sizeof row);
    for (int half = 0; half < 2; half++) {
        uint32_t bits = mask >> 4 * half & 15;
        row[half] = _pext_u64(row[half], _pdep_u64(bits, 0x0001000100010001u) * 0xffff);
    }
    memcpy(to, &row[0], sizeof row[0]);
    memcpy((uint16_t *)to + __builtin_popcount(mask & 15), &row[1], sizeof row[1]);
}
ISO_TARGET_AVX2 static inline void pack_4_avx2(void *to, const void *from, uint32_t mask) {
    __m256 row = _mm256_loadu_ps(from);
    _mm256_storeu_ps(to, _mm256_permutevar8x32_ps(row, iso_packed_lanes_avx2(mask)));
}
ISO_TARGET_AVX512 static inline void pack_1_avx512(void *to, const void *from, uint32_t mask) {
    pack_1_avx2(to, from, mask);
}
ISO_TARGET_AVX512 static inline void pack_2_avx512(void *to, const void *from, uint32_t mask) {
    _mm_storeu_si128(to, _mm_maskz_compress_epi16((__mmask8)mask, _mm_loadu_si128(from)));
}
ISO_TARGET_AVX512 static inline void pack_4_avx512(void *to, const void *from, uint32_t mask) {
    _mm256_storeu_ps(to, _mm256_maskz_compress_ps((__mmask8)mask, _mm256_loadu_ps(from)));
}
#endif

#define ISO_KERNEL_BODY "exact/cells_body.inc"
#include "base/kernel_levels.inc"

iso_exact_extract *iso_exact_extract_get(iso_type type, iso_cpu_level level) {
    return ISO_VOXEL_KERNEL(extract, type, level);
}
