/* discs_kernel: what the kernel's body, kernel_body.inc, needs. A unit is compiled for each instruction set
 * (base/kernel_levels.inc). */
#include "render/discs/kernel.h"

#include <assert.h>
#include <string.h>

#include "base/simd.h"
#include "render/discs/discs_numbers.h"

/* Before loops over the values of a disc or over sums: unrolled, these stay in registers. Compilers do not
 * unroll so many iterations by themselves. */
#define ISO_UNROLL _Pragma("GCC unroll 32")
#define ISO_ALWAYS static inline __attribute__((always_inline))

/* The pixels that a disc may cover: those of columns box[0] .. box[2] and rows box[1] .. box[3] of the view
 * that lie in a circle. Pixel (i, j) has its centre at (i, j). */
typedef struct rf_cover {
    int32_t box[4];
    float x, y, radius; /* the circle */
} rf_cover;

/* Sets span[0] .. span[1] to the columns that the disc may cover in rows first .. last; false: none. `whole`:
 * all columns of the box. */
static inline bool cover_columns(const rf_cover *cover, int first, int last, bool whole, int span[2]) {
    span[0] = cover->box[0];
    span[1] = cover->box[2];
    if (whole) return true;
    const float above = (float)first - cover->y, below = cover->y - (float)last;
    const float off = above > 0 ? above : below > 0 ? below : 0;
    const float square = cover->radius * cover->radius - off * off;
    if (!(square >= 0)) return false;
    const float half = sqrtf(square);
    const float lo = cover->x - half, hi = cover->x + half;
    if (lo > (float)span[0]) span[0] = (int)lo;
    if (hi < (float)span[1]) span[1] = (int)hi;
    return span[0] <= span[1];
}

/* For scatter.inc. STEPS: pixels of a scattered disc's box, at most; WORDS: 32-bit words with a bit for
 * each. */
enum { STEPS = ISO_DISCS_BOX * ISO_DISCS_BOX, WORDS = (STEPS + 31) / 32 };
/* AT_ONCE: hits that are listed without a branch between them. FEW: steps of which one 64-bit word has the
 * bits of all lanes. */
enum { AT_ONCE = 4, FEW = 4 };

/* Moves bit k of 16 to bit FEW * k. */
static inline uint64_t spread(uint64_t bits) {
    bits = (bits | bits << 24) & 0x000000ff000000ffu;
    bits = (bits | bits << 12) & 0x000f000f000f000fu;
    bits = (bits | bits << 6) & 0x0303030303030303u;
    return (bits | bits << 3) & 0x1111111111111111u;
}

/* Adds `weight` times a record of `size` (8 or 16) floats to a pixel's sums, which count as 0 unless
 * `keep`. The record's last float is replaced by `depth`. */
ISO_ALWAYS void add_record_generic(float *sums, const float *record, const int size, float depth,
                                   float weight, bool keep) {
    const vi_generic kept = v_seti_generic(-(int32_t)keep);
    const vf_generic w = v_set_generic(weight);
    for (int k = 0; k < size; k += 4) {
        const vf_generic old = v_floats_generic(v_bits_generic(v_load_generic(sums + k)) & kept);
        vf_generic value = v_load_generic(record + k);
        if (k + 4 == size) value[3] = depth;
        v_store_generic(sums + k, old + w * value);
    }
}
#if ISO_HAVE_X86
ISO_TARGET_AVX2 ISO_ALWAYS void add_record_avx2(float *sums, const float *record, const int size, float depth,
                                                float weight, bool keep) {
    const vi_avx2 kept = v_seti_avx2(-(int32_t)keep);
    const vf_avx2 w = v_set_avx2(weight);
    for (int k = 0; k < size; k += 8) {
        const vf_avx2 old = v_floats_avx2(v_bits_avx2(v_load_avx2(sums + k)) & kept);
        __m256 value = (__m256)v_load_avx2(record + k);
        if (k + 8 == size) value = _mm256_blend_ps(value, _mm256_set1_ps(depth), 0x80);
        v_store_avx2(sums + k, old + w * (vf_avx2)value);
    }
}

ISO_TARGET_AVX512 ISO_ALWAYS void add_record_avx512(float *sums, const float *record, const int size,
                                                    float depth, float weight, bool keep) {
    if (size == 8) {
        add_record_avx2(sums, record, size, depth, weight, keep);
        return;
    }
    const __m512 old = _mm512_maskz_loadu_ps((__mmask16) - (int32_t)keep, sums);
    const __m512 value = _mm512_mask_broadcastss_ps((__m512)v_load_avx512(record), 0x8000, _mm_set_ss(depth));
    v_store_avx512(sums, (vf_avx512)old + v_set_avx512(weight) * (vf_avx512)value);
}
#endif

#define ISO_KERNEL_BODY "render/discs/kernel_body.inc"
#include "base/kernel_levels.inc"
