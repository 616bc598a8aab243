/* point_code_simd: packs and unpacks vectors of points, with the arithmetic of base/point_code.h, and the
 * tangents at their normals. For kernels. */
#ifndef ISO_BASE_POINT_CODE_SIMD_H
#define ISO_BASE_POINT_CODE_SIMD_H

#include "base/point_code.h"
#include "base/simd.h"

/* Loads ISO_LANES packed points, as the low and the high 32 bits of each. */
ISO_INLINE void load_points(const iso_point *points, vi *low, vi *high) {
    vf first = v_load((const float *)points), second = v_load((const float *)points + ISO_LANES);
    *low = v_bits(v_even(first, second));
    *high = v_bits(v_odd(first, second));
}

/* Sets `steps` to the positions, in quantisation steps; returns the 22 bits of the normals. */
ISO_INLINE vi unpack_points(vi low, vi high, vf steps[3]) {
    const int most = ISO_POINT_COORDINATE_STEPS - 1, split = 2 * ISO_POINT_COORDINATE_BITS, rest = 32 - split;
    steps[0] = v_to_float(low & most);
    steps[1] = v_to_float(low >> ISO_POINT_COORDINATE_BITS & most);
    steps[2] = v_to_float((low >> split & ((1 << rest) - 1)) | (high & (most >> rest)) << rest);
    return high >> ISO_POINT_NORMAL_BIT & ((1 << 2 * ISO_POINT_NORMAL_BITS) - 1);
}

/* Decodes normals with |x| + |y| + |z| = 1 from their octahedral bits (Meyer et al. 2010); higher bits are
 * ignored. */
ISO_INLINE void unfold_normals(vi bits, vf n[3]) {
    const float step = 2.0f / ISO_POINT_NORMAL_STEPS;
    vf u = v_to_float(bits & ISO_POINT_NORMAL_STEPS) * step - 1;
    vf v = v_to_float(bits >> ISO_POINT_NORMAL_BITS & ISO_POINT_NORMAL_STEPS) * step - 1;
    vf w = 1 - v_abs(u) - v_abs(v);
    vi fold = v_bits(v_max(-w, v_set(0)));
    n[0] = u - v_floats(fold | (v_bits(u) & INT32_MIN));
    n[1] = v - v_floats(fold | (v_bits(v) & INT32_MIN));
    n[2] = w;
}

/* Decodes normals of unit length. */
ISO_INLINE void unpack_normals(vi bits, vf n[3]) {
    unfold_normals(bits, n);
    const vf length = v_sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    for (int k = 0; k < 3; k++) n[k] /= length;
}

/* The octahedral bits of normals with |x| + |y| + |z| = 1, rounded as by iso_point_pack_scaled. */
ISO_INLINE vi fold_normals(const vf n[3]) {
    const float half = ISO_POINT_NORMAL_STEPS / 2.0f;
    const vf most = v_set(ISO_POINT_NORMAL_STEPS), least = v_set(0);
    const vi sign_u = v_bits(n[0]) & INT32_MIN, sign_v = v_bits(n[1]) & INT32_MIN;
    const vm lower = v_lt(n[2], v_set(0));
    const vf u = v_select(lower, v_floats(v_bits(1 - v_abs(n[1])) | sign_u), n[0]);
    const vf v = v_select(lower, v_floats(v_bits(1 - v_abs(n[0])) | sign_v), n[1]);
    const vi x = v_floor(v_min(v_max(u * half + (half + 0.5f), least), most));
    const vi y = v_floor(v_min(v_max(v * half + (half + 0.5f), least), most));
    return x | y << ISO_POINT_NORMAL_BITS;
}

/* Loads up to ISO_LANES surfels, and zeros in the lanes beyond `count`: positions, and normals scaled to |x|
 * + |y| + |z| = 1. Returns the lanes whose normal can be scaled. */
ISO_INLINE vm load_surfels(const iso_surfel *surfels, size_t count, vf position[3], vf normal[3]) {
    float columns[6][ISO_LANES];
    memset(columns, 0, sizeof columns);
    for (size_t lane = 0; lane < ISO_LANES && lane < count; lane++)
        for (int k = 0; k < 3; k++) {
            columns[k][lane] = surfels[lane].position[k];
            columns[3 + k][lane] = surfels[lane].normal[k];
        }
    for (int k = 0; k < 3; k++) {
        position[k] = v_load(columns[k]);
        normal[k] = v_load(columns[3 + k]);
    }
    vf length = v_abs(normal[0]) + v_abs(normal[1]) + v_abs(normal[2]);
    vm good = v_and(v_lt(v_set(0), length), v_lt(length, v_set(INFINITY)));
    length = v_select(good, length, v_set(1));
    for (int k = 0; k < 3; k++) normal[k] = v_select(good, normal[k] / length, v_set(0));
    return good;
}

/* Two tangents of a unit normal, the same as iso_curvature_frame. */
ISO_INLINE void make_tangents(const vf n[3], vf u[3], vf v[3]) {
    const vf sign = v_floats((v_bits(n[2]) & INT32_MIN) | v_bits(v_set(1)));
    const vf a = -1 / (sign + n[2]), b = n[0] * n[1] * a;
    u[0] = 1 + sign * (n[0] * n[0] * a);
    u[1] = sign * b;
    u[2] = -(sign * n[0]);
    v[0] = b;
    v[1] = sign + n[1] * n[1] * a;
    v[2] = -n[1];
}

#endif
