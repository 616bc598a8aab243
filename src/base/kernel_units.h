/* kernel_units: chooses among the variants of a kernel, which are compiled from one file once for each
 * instruction set (base/kernel.h). A build for one machine alone (ISO_KERNELS=native in CMakeLists.txt) has
 * only that machine's. Files that choose include this; their headers declare the variants by ISO_KERNEL_UNITS
 * (base/cpu.h). Internal. */
#ifndef ISO_BASE_KERNEL_UNITS_H
#define ISO_BASE_KERNEL_UNITS_H

#include "base/cpu.h"
#include "built_levels.h" /* generated: defines ISO_BUILT_LEVEL where this build has one level only */

/* The address of the variant for a level, or of the best below it that this build has; of the only one, if
 * there is one only. */
#ifdef ISO_BUILT_LEVEL
#define ISO_KERNEL_UNIT(kernel, level) ((void)(level), &ISO_PASTE(kernel, ISO_BUILT_LEVEL))
#else
#define ISO_KERNEL_UNIT(kernel, level)                                                                       \
    ((level) >= ISO_CPU_AVX512 ? &kernel##_avx512                                                            \
     : (level) >= ISO_CPU_AVX2 ? &kernel##_avx2                                                              \
                               : &kernel##_generic)
#endif

#endif
