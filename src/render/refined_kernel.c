#include "render/refined_kernel.h"

#include <assert.h>
#include <string.h>

#include "base/simd.h"

/* Loops over the values of discs and sums, so that these stay in registers: more of them than compilers
 * unroll by themselves. */
#define ISO_UNROLL _Pragma("GCC unroll 32")

/* Pixels: how discs of less bend within them is too little to be seen. */
static const float FLAT_RADIUS = 0.9f;

/* 1 / voxel: how much surfaces bend before it is asked where they turn away, and how much until what bends
 * is as likely noise. (Normals come from gradients over two voxels, shapes from second differences over
 * one.) */
static const float TURNING_BEND = 0.15f, NOISY_BEND = 1;

/* Whether a block's points have shapes that matter. */
static inline bool has_shapes(const iso_refined_job *job, const iso_point_block *block) {
    return job->points->shapes && block->radius[1] >= FLAT_RADIUS;
}

/* The pixels that a disc may cover: columns box[0] .. box[2] of the view and rows box[1] .. box[3], within a
 * circle. Positions count from pixels' centres. */
typedef struct rf_cover {
    int32_t box[4];
    float x, y, radius;
} rf_cover;

/* The columns that the disc may cover in rows first .. last; false when none. */
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

#define REFINED_KERNEL                                                                                       \
    static const iso_refined_kernel ISO_V(kernel) = {ISO_V(scatter),       ISO_V(splat),                     \
                                                     ISO_V(finish_pixels), ISO_V(finish_tiles),              \
                                                     ISO_V(survey_pixels), ISO_V(survey_tiles)}

/* The sums of one pixel, in fours, which every instruction set has. */
enum { QUADS = ISO_SUMS / 4 };
/* Pixels of a disc's box, at most. */
enum { STEPS = ISO_REFINED_BOX * ISO_REFINED_BOX };

/* Adds a record, the last four of which are `place`, to a pixel's sums, or (not `keep`) puts it there. */
static inline void add_record_generic(float *sums, const float *record, vf_generic place, float weight,
                                      bool keep) {
    const vi_generic kept = v_seti_generic(-(int32_t)keep);
    const vf_generic w = v_set_generic(weight);
    for (int k = 0; k < QUADS; k++) {
        const vf_generic old = v_floats_generic(v_bits_generic(v_load_generic(sums + 4 * k)) & kept);
        v_store_generic(sums + 4 * k, old + w * (k == QUADS - 1 ? place : v_load_generic(record + 4 * k)));
    }
}
#if ISO_HAVE_X86
ISO_TARGET_AVX2 static inline void add_record_avx2(float *sums, const float *record, vf_generic place,
                                                   float weight, bool keep) {
    const vi_avx2 kept = v_seti_avx2(-(int32_t)keep);
    const vf_avx2 w = v_set_avx2(weight);
    const __m256 last = _mm256_insertf128_ps((__m256)v_load_avx2(record + 8), (__m128)place, 1);
    const vf_avx2 value[2] = {v_load_avx2(record), (vf_avx2)last};
    for (int k = 0; k < 2; k++) {
        const vf_avx2 old = v_floats_avx2(v_bits_avx2(v_load_avx2(sums + 8 * k)) & kept);
        v_store_avx2(sums + 8 * k, old + w * value[k]);
    }
}

ISO_TARGET_AVX512 static inline void add_record_avx512(float *sums, const float *record, vf_generic place,
                                                       float weight, bool keep) {
    const __m512 old = _mm512_maskz_loadu_ps((__mmask16) - (int32_t)keep, sums);
    const __m512 value = _mm512_insertf32x4((__m512)v_load_avx512(record), (__m128)place, 3);
    v_store_avx512(sums, (vf_avx512)old + v_set_avx512(weight) * (vf_avx512)value);
}
#endif

#define ISO_LEVEL generic
#include "render/refined_disc.inc"

#include "render/refined_common.inc"

#include "render/refined_scatter.inc"

#include "render/refined_splat.inc"

REFINED_KERNEL;
#undef ISO_LEVEL
#if ISO_HAVE_X86
#define ISO_LEVEL avx2
#include "render/refined_disc.inc"

#include "render/refined_common.inc"

#include "render/refined_scatter.inc"

#include "render/refined_splat.inc"

REFINED_KERNEL;
#undef ISO_LEVEL
#define ISO_LEVEL avx512
#include "render/refined_disc.inc"

#include "render/refined_common.inc"

#include "render/refined_scatter.inc"

#include "render/refined_splat.inc"

REFINED_KERNEL;
#undef ISO_LEVEL
#endif

const iso_refined_kernel *iso_refined_kernel_get(iso_cpu_level level) {
    return ISO_KERNEL(kernel, level);
}
