/* point_code: packs points into 8 bytes and unpacks them, one at a time. Kernels call these functions in
 * their loops, or use base/point_code_simd.h for vectors; shaders use shaders/unpack.glsl. Internal. */
#ifndef ISO_BASE_POINT_CODE_H
#define ISO_BASE_POINT_CODE_H

#include <math.h>

#include "base/primitives.h"

/* Always inlined, so that compilers vectorize loops that call these functions. */
#define ISO_POINT_INLINE static inline __attribute__((always_inline))

/* The first bit of a normal in the high half of a point. */
enum { ISO_POINT_NORMAL_BIT = 3 * ISO_POINT_COORDINATE_BITS - 32 };

/* ---- unpacking */

/* The coordinate x, y or z of a point in quantisation steps above ISO_POINT_LOW. */
ISO_POINT_INLINE uint32_t iso_point_steps(iso_point point, int axis) {
    return (uint32_t)(point.bits >> axis * ISO_POINT_COORDINATE_BITS & (ISO_POINT_COORDINATE_STEPS - 1));
}

/* Converts a coordinate from quantisation steps above ISO_POINT_LOW to voxels. */
ISO_POINT_INLINE float iso_point_coordinate(float steps) {
    return ISO_POINT_LOW + ISO_POINT_STEP * steps;
}

/* The 22 bits of a point's octahedral normal: two numbers, the first in the low bits. */
ISO_POINT_INLINE uint32_t iso_point_normal_bits(iso_point point) {
    return (uint32_t)(point.bits >> 3 * ISO_POINT_COORDINATE_BITS);
}

/* Decodes an octahedral normal, two numbers of ISO_POINT_NORMAL_BITS bits, to a normal with |x| + |y| + |z| =
 * 1. */
ISO_POINT_INLINE void iso_point_unfold_normal(uint32_t bits, float normal[3]) {
    const float step = 2.0f / ISO_POINT_NORMAL_STEPS;
    const float u = (float)(bits & ISO_POINT_NORMAL_STEPS) * step - 1,
                v = (float)(bits >> ISO_POINT_NORMAL_BITS & ISO_POINT_NORMAL_STEPS) * step - 1,
                w = 1 - fabsf(u) - fabsf(v), fold = w < 0 ? -w : 0;
    normal[0] = u - copysignf(fold, u);
    normal[1] = v - copysignf(fold, v);
    normal[2] = w;
}

/* ---- packing: rounds to the nearest step by adding one half and truncating; the sums are positive for all
 * valid points */

/* Converts a coordinate from voxels to quantisation steps above ISO_POINT_LOW, and adds one half, so that
 * truncating the result rounds to the nearest step. */
ISO_POINT_INLINE float iso_point_scale_coordinate(float position) {
    const float per_voxel = ISO_POINT_COORDINATE_STEPS / ISO_POINT_RANGE,
                first = 0.5f - ISO_POINT_LOW * ISO_POINT_COORDINATE_STEPS / ISO_POINT_RANGE;
    return position * per_voxel + first;
}

/* Converts one of the two numbers of an octahedral normal from -1 .. 1 to quantisation steps, and adds one
 * half, so that truncating the result rounds to the nearest step. */
ISO_POINT_INLINE float iso_point_scale_normal(float part) {
    return part * (ISO_POINT_NORMAL_STEPS / 2.0f) + (ISO_POINT_NORMAL_STEPS / 2.0f + 0.5f);
}

/* The two numbers -1 .. 1 of a normal with |x| + |y| + |z| = 1: x and y, with the lower half (z < 0) of the
 * octahedron folded outwards. */
ISO_POINT_INLINE void iso_point_fold_normal(float x, float y, float z, float part[2]) {
    const float u = copysignf(1 - fabsf(y), x), v = copysignf(1 - fabsf(x), y);
    part[0] = z < 0 ? u : x;
    part[1] = z < 0 ? v : y;
}

/* Assembles a packed point from the quantisation steps of its coordinates and of the two numbers of its
 * normal. */
ISO_POINT_INLINE iso_point iso_point_join(uint32_t x, uint32_t y, uint32_t z, uint32_t u, uint32_t v) {
    const uint32_t low = x | y << ISO_POINT_COORDINATE_BITS | z << 2 * ISO_POINT_COORDINATE_BITS,
                   high = z >> (32 - 2 * ISO_POINT_COORDINATE_BITS) | u << ISO_POINT_NORMAL_BIT |
                          v << (ISO_POINT_NORMAL_BIT + ISO_POINT_NORMAL_BITS);
    return (iso_point){low | (uint64_t)high << 32};
}

/* Packs a point whose position is in [-2, 18) and whose normal is given by iso_point_fold_normal. */
ISO_POINT_INLINE iso_point iso_point_encode(float x, float y, float z, float u, float v) {
    return iso_point_join(
        (uint32_t)(int32_t)iso_point_scale_coordinate(x), (uint32_t)(int32_t)iso_point_scale_coordinate(y),
        (uint32_t)(int32_t)iso_point_scale_coordinate(z), (uint32_t)(int32_t)iso_point_scale_normal(u),
        (uint32_t)(int32_t)iso_point_scale_normal(v));
}

#endif
