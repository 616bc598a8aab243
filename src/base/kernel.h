/* kernel: what every kernel file includes, directly or by base/simd.h, which has vectors.
 *
 * A kernel is a plain file NAME_kernel.c, which CMake (iso_kernels in CMakeLists.txt) compiles once for
 * each instruction set (level), with the compiler's options for it and with ISO_LEVEL defined as generic,
 * avx2 or avx512. It exports one thing, a function or a constant table of its functions, named
 * ISO_KERNEL_NAME(name): its header declares it by ISO_KERNEL_UNITS (base/cpu.h), and ordinary files choose
 * among the levels by ISO_KERNEL_UNIT (base/kernel_units.h). All else in a kernel and in the headers that it
 * includes is static: of an inline function that several files shared, the linker would keep one, with
 * instructions that other machines may not have (tests/rules/kernels.cmake).
 *
 * Headers NAME_simd.h hold parts of kernels. Where ISO_LEVEL is not defined, as in editors, the level is
 * generic. Internal: for kernels only. */
#ifndef ISO_BASE_KERNEL_H
#define ISO_BASE_KERNEL_H

#include "base/cpu.h"

#ifndef ISO_LEVEL
#define ISO_LEVEL generic
#endif
/* The name of what a kernel file exports, with the level: name_avx2. */
#define ISO_KERNEL_NAME(name) ISO_PASTE(name, ISO_LEVEL)

/* The floats in a vector: code for one level alone stands under `#if ISO_LANES == 8` (avx2) or 16 (avx512).
 */
#define ISO_LANES_generic 4
#define ISO_LANES_avx2 8
#define ISO_LANES_avx512 16
#define ISO_LANES ISO_PASTE(ISO_LANES, ISO_LEVEL)

/* Marks a function that is always inlined. */
#define ISO_INLINE static inline __attribute__((always_inline))
/* Marks a function that is neither inlined nor analysed together with its callers. Otherwise gcc 12 deletes
 * or reorders stores of large functions, and stale values are read. For functions that process hundreds of
 * items, so that the cost of the call does not matter. */
#ifdef __clang__
#define ISO_STEP __attribute__((noinline))
#else
#define ISO_STEP __attribute__((noipa))
#endif

#endif
