/* simd: vectors of floats and 32-bit integers with the width of each instruction set, so that a kernel body
 * is written once and compiled once per instruction set (level).
 *
 * A kernel file names its body and includes base/kernel_levels.inc, which includes the body with ISO_LEVEL
 * set to generic, avx2 and avx512 in turn. In the body vf, vi and vm are vectors of ISO_LANES floats,
 * integers and truth values, ISO_TARGET marks its functions and ISO_V(name) names them. Arithmetic on vf and
 * vi is written with operators, all else with the v_ functions below. Every operation is exact or correctly
 * rounded, so that each lane has the same bits at every level; a body's results must not depend on the number
 * of lanes. Code that needs instructions of one level is a function NAME_level, defined before the body,
 * which calls it as ISO_V(NAME).
 *
 * A kernel file chooses the variant in one function, iso_X_kernel_get(level), with the macro ISO_KERNEL. What
 * takes long to compile has a source for each variant instead: base/kernel_units.h.
 * Internal: for kernel files only. */
#ifndef ISO_BASE_SIMD_H
#define ISO_BASE_SIMD_H

#include <math.h>
#include <stdint.h>
#include <string.h>

#include "base/cpu.h"

#if ISO_HAVE_X86
#include <immintrin.h>
#endif

#define ISO_V(name) ISO_PASTE(name, ISO_LEVEL)
#define ISO_TARGET ISO_V(ISO_TARGET)
#define ISO_LANES ISO_V(ISO_LANES)
/* Marks a function of a body that is always inlined. */
#define ISO_INLINE ISO_TARGET static inline __attribute__((always_inline))
/* Marks a function that is neither inlined nor analysed together with its callers. Otherwise gcc 12 deletes
 * or reorders stores of large functions, and stale values are read. For functions that process hundreds of
 * items, so that the cost of the call does not matter. */
#ifdef __clang__
#define ISO_STEP __attribute__((noinline))
#else
#define ISO_STEP __attribute__((noipa))
#endif

#define ISO_TARGET_generic
#define ISO_TARGET_avx2 ISO_TARGET_AVX2
#define ISO_TARGET_avx512 ISO_TARGET_AVX512
enum { ISO_LANES_generic = 4, ISO_LANES_avx2 = 8, ISO_LANES_avx512 = 16, ISO_LANES_MAX = 16 };

/* The address of kernel_generic, kernel_avx2 or kernel_avx512 (functions or constants) for a level, or of the
 * best below it that this build has. */
#if ISO_HAVE_X86
#define ISO_KERNEL(kernel, level)                                                                            \
    ((level) >= ISO_CPU_AVX512 ? &kernel##_avx512                                                            \
     : (level) >= ISO_CPU_AVX2 ? &kernel##_avx2                                                              \
                               : &kernel##_generic)
#else
#define ISO_KERNEL(kernel, level) ((void)(level), &kernel##_generic)
#endif

#define vf ISO_V(vf)
#define vi ISO_V(vi)
#define vm ISO_V(vm)

#define v_set ISO_V(v_set)           /* vf of one float */
#define v_seti ISO_V(v_seti)         /* vi of one int32_t */
#define v_load ISO_V(v_load)         /* vf from ISO_LANES floats; no alignment needed */
#define v_loadi ISO_V(v_loadi)       /* vi from ISO_LANES int32_t */
#define v_load_u8 ISO_V(v_load_u8)   /* vi from ISO_LANES uint8_t */
#define v_load_u16 ISO_V(v_load_u16) /* vi from ISO_LANES uint16_t */
#define v_load_i16 ISO_V(v_load_i16) /* vi from ISO_LANES int16_t */
#define v_store ISO_V(v_store)       /* (float *, vf) */
#define v_storei ISO_V(v_storei)     /* (int32_t *, vi) */
#define v_lanes ISO_V(v_lanes)       /* vi 0, 1, 2, .. */
#define v_bits ISO_V(v_bits)         /* the bits of a vf as a vi */
#define v_floats ISO_V(v_floats)     /* the bits of a vi as a vf */
#define v_to_float ISO_V(v_to_float) /* integers to the nearest floats */
#define v_trunc ISO_V(v_trunc)       /* vf to vi, towards zero; values must fit */
#define v_floor ISO_V(v_floor)       /* vf to vi, downwards; values must fit */
#define v_min ISO_V(v_min)           /* a < b ? a : b: b when one is a NaN */
#define v_max ISO_V(v_max)           /* a > b ? a : b: b when one is a NaN */
#define v_abs ISO_V(v_abs)
#define v_sqrt ISO_V(v_sqrt)
#define v_lt ISO_V(v_lt) /* v_lt, v_le, v_eq compare vf: false if one is a NaN */
#define v_le ISO_V(v_le)
#define v_eq ISO_V(v_eq)
#define v_lti ISO_V(v_lti) /* comparisons of vi */
#define v_eqi ISO_V(v_eqi)
#define v_select ISO_V(v_select)   /* (mask, a, b): a where true, else b */
#define v_selecti ISO_V(v_selecti) /* as v_select, for vi */
#define v_and ISO_V(v_and)         /* of truth values, as v_or and v_andnot */
#define v_or ISO_V(v_or)
#define v_andnot ISO_V(v_andnot)       /* a and not b */
#define v_mask ISO_V(v_mask)           /* truth values as bits of a uint32_t, lane 0 lowest */
#define v_from_mask ISO_V(v_from_mask) /* truth values from such bits; higher bits are ignored */
#define v_gather ISO_V(v_gather)       /* (const float *, vi): from[index], lane by lane */
/* (vf before, vf after): ISO_LANES lanes of both vectors in a row, from a lane of `before` on: v_next1 and
 * v_next2 begin at lane 1 and 2, v_last1 at the last lane, v_last2 at the last but one. */
#define v_next1 ISO_V(v_next1)
#define v_next2 ISO_V(v_next2)
#define v_last1 ISO_V(v_last1)
#define v_last2 ISO_V(v_last2)
/* v_compress and v_compressi store, without gaps, the lanes whose truth value is true; memory for ISO_LANES
 * items may be overwritten. */
#define v_compress ISO_V(v_compress)   /* (float *, vm, vf) */
#define v_compressi ISO_V(v_compressi) /* (int32_t *, vm, vi) */
/* Transposing loads and stores. v_load4(base, index, quads, out): for each lane, out[k] = base[index[lane] +
 * k], k below 4 * quads (quads is a constant 1 to 4; indices are not negative). v_store4(base, step, in): for
 * each lane, base[step * lane + k] = in[k], k below 4. */
#define v_load4 ISO_V(v_load4)
#define v_store4 ISO_V(v_store4)
/* v_even and v_odd take the even and the odd lanes of the concatenation of a and b; v_zip_low and v_zip_high
 * are their inverse. */
#define v_even ISO_V(v_even)         /* (vf a, vf b) */
#define v_odd ISO_V(v_odd)           /* (vf a, vf b) */
#define v_zip_low ISO_V(v_zip_low)   /* the first half of a0 b0 a1 b1 .. */
#define v_zip_high ISO_V(v_zip_high) /* the second half */
#define v_store_u8 ISO_V(v_store_u8) /* (uint8_t *, vi): the low 8 bits of each lane */

/* ---- functions that are the same for every width: `bytes` is the size of a vector */

#define ISO_SIMD_COMMON(level, target, bytes)                                                                \
    enum { ISO_SIMD_BYTES_##level = bytes };                                                                 \
    target static inline vf_##level v_set_##level(float value) {                                             \
        return value - (vf_##level){0};                                                                      \
    }                                                                                                        \
    target static inline vi_##level v_seti_##level(int32_t value) {                                          \
        return value - (vi_##level){0};                                                                      \
    }                                                                                                        \
    target static inline vf_##level v_load_##level(const float *from) {                                      \
        vf_##level value;                                                                                    \
        memcpy(&value, from, bytes);                                                                         \
        return value;                                                                                        \
    }                                                                                                        \
    target static inline vi_##level v_loadi_##level(const int32_t *from) {                                   \
        vi_##level value;                                                                                    \
        memcpy(&value, from, bytes);                                                                         \
        return value;                                                                                        \
    }                                                                                                        \
    target static inline void v_store_##level(float *to, vf_##level value) {                                 \
        memcpy(to, &value, bytes);                                                                           \
    }                                                                                                        \
    target static inline void v_storei_##level(int32_t *to, vi_##level value) {                              \
        memcpy(to, &value, bytes);                                                                           \
    }                                                                                                        \
    target static inline vi_##level v_bits_##level(vf_##level value) {                                       \
        return (vi_##level)value;                                                                            \
    }                                                                                                        \
    target static inline vf_##level v_floats_##level(vi_##level value) {                                     \
        return (vf_##level)value;                                                                            \
    }                                                                                                        \
    target static inline vf_##level v_to_float_##level(vi_##level value) {                                   \
        return __builtin_convertvector(value, vf_##level);                                                   \
    }                                                                                                        \
    target static inline vi_##level v_trunc_##level(vf_##level value) {                                      \
        return __builtin_convertvector(value, vi_##level);                                                   \
    }                                                                                                        \
    target static inline vf_##level v_abs_##level(vf_##level value) {                                        \
        return (vf_##level)((vi_##level)value & INT32_MAX);                                                  \
    }

/* Truth values as vectors of 0 and -1, for levels without mask registers. */
#define ISO_SIMD_TRUTH(level, target)                                                                        \
    typedef vi_##level vm_##level;                                                                           \
    target static inline vm_##level v_lt_##level(vf_##level a, vf_##level b) {                               \
        return (vm_##level)(a < b);                                                                          \
    }                                                                                                        \
    target static inline vm_##level v_le_##level(vf_##level a, vf_##level b) {                               \
        return (vm_##level)(a <= b);                                                                         \
    }                                                                                                        \
    target static inline vm_##level v_eq_##level(vf_##level a, vf_##level b) {                               \
        return (vm_##level)(a == b);                                                                         \
    }                                                                                                        \
    target static inline vm_##level v_lti_##level(vi_##level a, vi_##level b) {                              \
        return (vm_##level)(a < b);                                                                          \
    }                                                                                                        \
    target static inline vm_##level v_eqi_##level(vi_##level a, vi_##level b) {                              \
        return (vm_##level)(a == b);                                                                         \
    }                                                                                                        \
    target static inline vi_##level v_selecti_##level(vm_##level mask, vi_##level a, vi_##level b) {         \
        return (a & mask) | (b & ~mask);                                                                     \
    }                                                                                                        \
    target static inline vf_##level v_select_##level(vm_##level mask, vf_##level a, vf_##level b) {          \
        return (vf_##level)v_selecti_##level(mask, (vi_##level)a, (vi_##level)b);                            \
    }                                                                                                        \
    target static inline vm_##level v_and_##level(vm_##level a, vm_##level b) {                              \
        return a & b;                                                                                        \
    }                                                                                                        \
    target static inline vm_##level v_or_##level(vm_##level a, vm_##level b) {                               \
        return a | b;                                                                                        \
    }                                                                                                        \
    target static inline vm_##level v_andnot_##level(vm_##level a, vm_##level b) {                           \
        return a & ~b;                                                                                       \
    }                                                                                                        \
    target static inline vi_##level v_floor_##level(vf_##level value) {                                      \
        vi_##level whole = __builtin_convertvector(value, vi_##level);                                       \
        return whole + (vi_##level)(value < __builtin_convertvector(whole, vf_##level));                     \
    }

/* Defines a shuffle of two vectors; the last arguments are the numbers of the lanes that it takes. */
#define ISO_SIMD_SLIDE(name, level, target, ...)                                                             \
    target static inline vf_##level name##_##level(vf_##level before, vf_##level after) {                    \
        return __builtin_shufflevector(before, after, __VA_ARGS__);                                          \
    }

/* ---- generic: 16 bytes; compilers emulate such vectors where a machine has none */

typedef float vf_generic __attribute__((vector_size(16)));
typedef int32_t vi_generic __attribute__((vector_size(16)));
ISO_SIMD_COMMON(generic, , 16)
ISO_SIMD_TRUTH(generic, )

ISO_SIMD_SLIDE(v_next1, generic, , 1, 2, 3, 4)
ISO_SIMD_SLIDE(v_next2, generic, , 2, 3, 4, 5)
ISO_SIMD_SLIDE(v_last1, generic, , 3, 4, 5, 6)
ISO_SIMD_SLIDE(v_last2, generic, , 2, 3, 4, 5)
ISO_SIMD_SLIDE(v_even, generic, , 0, 2, 4, 6)
ISO_SIMD_SLIDE(v_odd, generic, , 1, 3, 5, 7)
ISO_SIMD_SLIDE(v_zip_low, generic, , 0, 4, 1, 5)
ISO_SIMD_SLIDE(v_zip_high, generic, , 2, 6, 3, 7)

static inline vi_generic v_lanes_generic(void) {
    return (vi_generic){0, 1, 2, 3};
}
static inline vi_generic v_load_u8_generic(const uint8_t *from) {
    return (vi_generic){from[0], from[1], from[2], from[3]};
}
static inline vi_generic v_load_u16_generic(const uint16_t *from) {
    return (vi_generic){from[0], from[1], from[2], from[3]};
}
static inline vi_generic v_load_i16_generic(const int16_t *from) {
    return (vi_generic){from[0], from[1], from[2], from[3]};
}
static inline vf_generic v_gather_generic(const float *from, vi_generic index) {
    return (vf_generic){from[index[0]], from[index[1]], from[index[2]], from[index[3]]};
}
static inline vf_generic v_min_generic(vf_generic a, vf_generic b) {
    return v_select_generic(v_lt_generic(a, b), a, b);
}
static inline vf_generic v_max_generic(vf_generic a, vf_generic b) {
    return v_select_generic(v_lt_generic(b, a), a, b);
}
static inline vf_generic v_sqrt_generic(vf_generic value) {
    return (vf_generic){sqrtf(value[0]), sqrtf(value[1]), sqrtf(value[2]), sqrtf(value[3])};
}
static inline uint32_t v_mask_generic(vm_generic mask) {
#if ISO_HAVE_X86
    return (uint32_t)_mm_movemask_ps((__m128)mask);
#else
    return (uint32_t)((mask[0] & 1) | (mask[1] & 2) | (mask[2] & 4) | (mask[3] & 8));
#endif
}
static inline vm_generic v_from_mask_generic(uint32_t mask) {
    const vi_generic bit = {1, 2, 4, 8};
    return (vm_generic)((v_seti_generic((int32_t)mask) & bit) == bit);
}
static inline void v_compressi_generic(int32_t *to, vm_generic mask, vi_generic value) {
    int count = 0;
    for (int lane = 0; lane < ISO_LANES_generic; lane++) {
        to[count] = value[lane];
        count += mask[lane] & 1;
    }
}
static inline void v_compress_generic(float *to, vm_generic mask, vf_generic value) {
    int count = 0;
    for (int lane = 0; lane < ISO_LANES_generic; lane++) {
        to[count] = value[lane];
        count += mask[lane] & 1;
    }
}
static inline void v_store_u8_generic(uint8_t *to, vi_generic value) {
    for (int lane = 0; lane < ISO_LANES_generic; lane++) to[lane] = (uint8_t)value[lane];
}

static inline void v_load4_generic(const float *base, const int32_t *index, int quads, vf_generic *out) {
    for (int k = 0; k < 4 * quads; k++)
        out[k] = (vf_generic){base[index[0] + k], base[index[1] + k], base[index[2] + k], base[index[3] + k]};
}
static inline void v_store4_generic(float *base, int step, const vf_generic in[4]) {
    for (int lane = 0; lane < ISO_LANES_generic; lane++)
        for (int k = 0; k < 4; k++) base[lane * step + k] = in[k][lane];
}

#if ISO_HAVE_X86
#include "base/simd_x86.h"
#endif

#endif
