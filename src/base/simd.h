/* simd: vectors of floats and 32-bit integers with the width of an instruction set (base/kernel.h), so that a
 * kernel is written once.
 *
 * vf, vi and vm are vectors of ISO_LANES floats, integers and truth values. Arithmetic on vf and vi is
 * written with operators, all else with the v_ functions below. Every operation is exact or correctly
 * rounded, so that each lane has the same bits at every level; a kernel's results must not depend on the
 * number of lanes. Internal: for kernels only. */
#ifndef ISO_BASE_SIMD_H
#define ISO_BASE_SIMD_H

#include <math.h>
#include <stdint.h>
#include <string.h>

#include "base/kernel.h"

typedef float vf __attribute__((vector_size(4 * ISO_LANES)));
typedef int32_t vi __attribute__((vector_size(4 * ISO_LANES)));

/* ---- functions that are the same at every level */

/* All lanes with one value. */
static inline vf v_set(float value) {
    return value - (vf){0};
}
static inline vi v_seti(int32_t value) {
    return value - (vi){0};
}
/* ISO_LANES values in memory, which need not be aligned. */
static inline vf v_load(const float *from) {
    vf value;
    memcpy(&value, from, sizeof value);
    return value;
}
static inline vi v_loadi(const int32_t *from) {
    vi value;
    memcpy(&value, from, sizeof value);
    return value;
}
static inline void v_store(float *to, vf value) {
    memcpy(to, &value, sizeof value);
}
static inline void v_storei(int32_t *to, vi value) {
    memcpy(to, &value, sizeof value);
}
/* The bits of the lanes as values of the other type. */
static inline vi v_bits(vf value) {
    return (vi)value;
}
static inline vf v_floats(vi value) {
    return (vf)value;
}
/* Integers to the nearest floats. */
static inline vf v_to_float(vi value) {
    return __builtin_convertvector(value, vf);
}
/* Towards zero; values must fit. */
static inline vi v_trunc(vf value) {
    return __builtin_convertvector(value, vi);
}
static inline vf v_abs(vf value) {
    return (vf)((vi)value & INT32_MAX);
}

/* ---- functions with instructions of their own at each level
 *
 * v_load_u8(from), v_load_u16, v_load_i16   vi from ISO_LANES integers of 8 or 16 bits
 * v_store_u8(to, vi)          the low 8 bits of each lane
 * v_lanes()                   vi 0, 1, 2, ..
 * v_floor(vf)                 vf to vi, downwards; values must fit
 * v_min(vf a, vf b)           a < b ? a : b: b when one is a NaN
 * v_max(vf a, vf b)           a > b ? a : b: b when one is a NaN
 * v_sqrt(vf)
 * v_lt, v_le, v_eq(vf, vf)    comparisons: false if one is a NaN
 * v_lti, v_eqi(vi, vi)
 * v_select(vm, vf a, vf b)    a where true, else b; v_selecti for vi
 * v_and, v_or, v_andnot(vm a, vm b)   v_andnot: a and not b
 * v_mask(vm)                  truth values as bits of a uint32_t, lane 0 lowest
 * v_from_mask(uint32_t)       truth values from such bits; higher bits are ignored
 * v_gather(from, vi index)    from[index], lane by lane
 * v_next1(vf before, vf after), v_next2, v_last1, v_last2   ISO_LANES lanes of both vectors in a row, from a
 *                             lane of `before` on: lane 1, lane 2, the last lane, the last but one
 * v_compress(to, vm, vf), v_compressi(to, vm, vi)   store, without gaps, the lanes whose truth value is true;
 *                             memory for ISO_LANES items may be overwritten
 * v_load4(base, index, quads, out)   for each lane, out[k] = base[index[lane] + k], k below 4 * quads (quads
 *                             is a constant 1 to 4; indices are not negative)
 * v_store4(base, step, in)    for each lane, base[step * lane + k] = in[k], k below 4
 * v_even, v_odd(vf a, vf b)   the even and the odd lanes of the concatenation of a and b
 * v_zip_low, v_zip_high(vf a, vf b)   their inverse: the first and the second half of a0 b0 a1 b1 .. */

#if ISO_LANES < 16 /* truth values as vectors of 0 and -1, for levels without mask registers */
typedef vi vm;
static inline vm v_lt(vf a, vf b) {
    return (vm)(a < b);
}
static inline vm v_le(vf a, vf b) {
    return (vm)(a <= b);
}
static inline vm v_eq(vf a, vf b) {
    return (vm)(a == b);
}
static inline vm v_lti(vi a, vi b) {
    return (vm)(a < b);
}
static inline vm v_eqi(vi a, vi b) {
    return (vm)(a == b);
}
static inline vi v_selecti(vm mask, vi a, vi b) {
    return (a & mask) | (b & ~mask);
}
static inline vf v_select(vm mask, vf a, vf b) {
    return (vf)v_selecti(mask, (vi)a, (vi)b);
}
static inline vm v_and(vm a, vm b) {
    return a & b;
}
static inline vm v_or(vm a, vm b) {
    return a | b;
}
static inline vm v_andnot(vm a, vm b) {
    return a & ~b;
}
static inline vi v_floor(vf value) {
    vi whole = __builtin_convertvector(value, vi);
    return whole + (vi)(value < __builtin_convertvector(whole, vf));
}
#endif

/* Defines a shuffle of two vectors; the last arguments are the numbers of the lanes that it takes. */
#define ISO_SIMD_SLIDE(name, ...)                                                                            \
    static inline vf name(vf before, vf after) {                                                             \
        return __builtin_shufflevector(before, after, __VA_ARGS__);                                          \
    }

#if ISO_LANES == 4
#include "base/simd_generic.h"
#elif ISO_LANES == 8
#include "base/simd_avx2.h"
#else
#include "base/simd_avx512.h"
#endif

#endif
