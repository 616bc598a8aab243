/* patch_simd: patches of pixels, and the rays of their pixels relative to a shape's centre. For the kernel of
 * shapes.
 *
 * Numbers that a pixel's result depends on must not depend on the patch or vector that it is computed in:
 * offsets from a shape's centre are integers and halves, which are exact, less the centre's place in its
 * pixel, subtracted last. */
#ifndef ISO_RENDER_SHAPES_PATCH_SIMD_H
#define ISO_RENDER_SHAPES_PATCH_SIMD_H

#include "base/simd.h"
#include "render/shapes/kernel.h"
#include "render/shapes/solid.h"

/* A patch is a vector of pixels: one row of them, or two rows of eight where vectors have sixteen lanes. For
 * each level: its width and height; the places of its pixels' centres; loading depths; and storing depth and
 * record where a mask is set. `largest` is the largest lane of a vector without NaNs. */
enum { PATCH_HEIGHT = ISO_LANES == 16 ? 2 : 1, PATCH_WIDTH = ISO_LANES / PATCH_HEIGHT };

/* Pixels from an origin beyond which edges of boxes are not told apart. */
static const float FAR = 1 << 20;

#if ISO_LANES == 4
static inline float largest(vf v) {
    const float a = v[0] > v[1] ? v[0] : v[1], b = v[2] > v[3] ? v[2] : v[3];
    return a > b ? a : b;
}
#elif ISO_LANES == 8
static inline float largest(vf v) {
    __m128 most = _mm_max_ps(_mm256_castps256_ps128((__m256)v), _mm256_extractf128_ps((__m256)v, 1));
    most = _mm_max_ps(most, _mm_movehl_ps(most, most));
    return _mm_cvtss_f32(_mm_max_ss(most, _mm_shuffle_ps(most, most, 1)));
}
#endif

#if ISO_LANES < 16
static inline vf patch_columns(void) {
    return v_to_float(v_lanes()) + v_set(0.5f);
}
static inline vf patch_rows(void) {
    return v_set(0.5f);
}
static inline vf patch_load(const float *depth) {
    return v_load(depth);
}
static inline void patch_store(float *depth, int32_t *record, vm mask, vf z, int32_t number) {
    v_store(depth, v_select(mask, z, v_load(depth)));
    v_storei(record, v_selecti(mask, v_seti(number), v_loadi(record)));
}
#else
static inline float largest(vf v) {
    return _mm512_reduce_max_ps((__m512)v);
}
static inline vf patch_columns(void) {
    return v_to_float(v_lanes() & 7) + v_set(0.5f);
}
static inline vf patch_rows(void) {
    return v_to_float(v_lanes() >> 3) + v_set(0.5f);
}
static inline vf patch_load(const float *depth) {
    const __m512 first = _mm512_castps256_ps512(_mm256_loadu_ps(depth));
    return (vf)_mm512_insertf32x8(first, _mm256_loadu_ps(depth + ISO_SHAPES_PITCH), 1);
}
static inline void patch_store(float *depth, int32_t *record, vm mask, vf z, int32_t number) {
    const __m256i numbers = _mm256_set1_epi32(number);
    const __mmask8 low = (__mmask8)mask, high = (__mmask8)(mask >> 8);
    _mm256_mask_storeu_ps(depth, low, _mm512_castps512_ps256((__m512)z));
    _mm256_mask_storeu_ps(depth + ISO_SHAPES_PITCH, high, _mm512_extractf32x8_ps((__m512)z, 1));
    _mm256_mask_storeu_epi32(record, low, numbers);
    _mm256_mask_storeu_epi32(record + ISO_SHAPES_PITCH, high, numbers);
}
#endif

/* ---- a shape and the pixels around it */

/* The pixel at an offset from the projection of a shape's centre: its ray relative to the centre is
 * (k dx, k dy, 0) + s (u, v, 1), s the depth less the centre's. */
typedef struct sp_pixel {
    vf dx, dy, u, v, k, slope;
} sp_pixel;

/* The projection of a shape's centre, which all pixels of the shape share. */
typedef struct sp_place {
    vf u, v, k; /* of the centre's ray */
} sp_place;

ISO_INLINE sp_place place_of(const iso_shapes_frame *frame, vf pixel_x, vf pixel_y, const vf *field) {
    const vf spread = v_set(frame->spread);
    return (sp_place){(pixel_x + (field[ISO_FIELD_X] - frame->center_x)) * spread,
                      (pixel_y + (field[ISO_FIELD_Y] - frame->center_y)) * spread,
                      field[ISO_FIELD_Z] * frame->slope + frame->fixed};
}

ISO_INLINE sp_pixel pixel_of(const iso_shapes_frame *frame, const sp_place *at, vf dx, vf dy) {
    const vf spread = v_set(frame->spread);
    return (sp_pixel){dx, dy, at->u + dx * spread, at->v + dy * spread, at->k, spread};
}

#endif
