/* point_code: converts a point to 8 bytes and back. Kernels that work on arrays use these functions in their
 * loops, or base/point_code.inc for vectors; shaders/unpack.glsl does the same in GLSL. Internal. */
#ifndef ISO_BASE_POINT_CODE_H
#define ISO_BASE_POINT_CODE_H

#include <math.h>

#include "base/primitives.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Functions that are always inlined, so that compilers can vectorise loops that call them. */
#define ISO_POINT_INLINE static inline __attribute__((always_inline))

/* The first bit of the normal in the high 32 bits of a point. */
enum { ISO_POINT_NORMAL_BIT = 3 * ISO_POINT_COORDINATE_BITS - 32 };

/* ---- unpacking */

/* Returns coordinate 0, 1 or 2 in steps from ISO_POINT_LOW. */
ISO_POINT_INLINE uint32_t iso_point_steps(iso_point point, int axis) {
    return (uint32_t)(point.bits >> axis * ISO_POINT_COORDINATE_BITS & (ISO_POINT_COORDINATE_STEPS - 1));
}

/* Converts a coordinate from steps to voxels. */
ISO_POINT_INLINE float iso_point_coordinate(float steps) {
    return ISO_POINT_LOW + ISO_POINT_STEP * steps;
}

/* Returns the bits of both numbers of the normal; the first one has the lower bits. */
ISO_POINT_INLINE uint32_t iso_point_normal_bits(iso_point point) {
    return (uint32_t)(point.bits >> 3 * ISO_POINT_COORDINATE_BITS);
}

/* Computes the normal, scaled to |x| + |y| + |z| = 1, from its bits. */
ISO_POINT_INLINE void iso_point_unfold_normal(uint32_t bits, float normal[3]) {
    const float step = 2.0f / ISO_POINT_NORMAL_STEPS;
    const float u = (float)(bits & ISO_POINT_NORMAL_STEPS) * step - 1,
                v = (float)(bits >> ISO_POINT_NORMAL_BITS & ISO_POINT_NORMAL_STEPS) * step - 1,
                w = 1 - fabsf(u) - fabsf(v), fold = w < 0 ? -w : 0;
    normal[0] = u - copysignf(fold, u);
    normal[1] = v - copysignf(fold, v);
    normal[2] = w;
}

/* ---- packing, to the nearest step. Sums like the following are positive for all points, so that cutting off
 * the fraction rounds down. */

/* Converts a coordinate from voxels to steps and adds 1/2; cutting off the fraction of the result then rounds
 * to the nearest step. */
ISO_POINT_INLINE float iso_point_scale_coordinate(float position) {
    const float per_voxel = ISO_POINT_COORDINATE_STEPS / ISO_POINT_RANGE,
                first = 0.5f - ISO_POINT_LOW * ISO_POINT_COORDINATE_STEPS / ISO_POINT_RANGE;
    return position * per_voxel + first;
}

/* Converts a number of a normal, -1 .. 1, to steps in the same way. */
ISO_POINT_INLINE float iso_point_scale_normal(float part) {
    return part * (ISO_POINT_NORMAL_STEPS / 2.0f) + (ISO_POINT_NORMAL_STEPS / 2.0f + 0.5f);
}

/* Computes the two numbers of a normal with |x| + |y| + |z| = 1, by folding the lower half of this octahedron
 * over the upper half. */
ISO_POINT_INLINE void iso_point_fold_normal(float x, float y, float z, float part[2]) {
    const float u = copysignf(1 - fabsf(y), x), v = copysignf(1 - fabsf(x), y);
    part[0] = z < 0 ? u : x;
    part[1] = z < 0 ? v : y;
}

/* Packs steps into a point. */
ISO_POINT_INLINE iso_point iso_point_join(uint32_t x, uint32_t y, uint32_t z, uint32_t u, uint32_t v) {
    const uint32_t low = x | y << ISO_POINT_COORDINATE_BITS | z << 2 * ISO_POINT_COORDINATE_BITS,
                   high = z >> (32 - 2 * ISO_POINT_COORDINATE_BITS) | u << ISO_POINT_NORMAL_BIT |
                          v << (ISO_POINT_NORMAL_BIT + ISO_POINT_NORMAL_BITS);
    return (iso_point){low | (uint64_t)high << 32};
}

/* Packs a point with a position in [-2, 18) and the two numbers of its normal. */
ISO_POINT_INLINE iso_point iso_point_encode(float x, float y, float z, float u, float v) {
    return iso_point_join(
        (uint32_t)(int32_t)iso_point_scale_coordinate(x), (uint32_t)(int32_t)iso_point_scale_coordinate(y),
        (uint32_t)(int32_t)iso_point_scale_coordinate(z), (uint32_t)(int32_t)iso_point_scale_normal(u),
        (uint32_t)(int32_t)iso_point_scale_normal(v));
}

#ifdef __cplusplus
}
#endif
#endif
