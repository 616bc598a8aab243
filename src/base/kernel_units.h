/* kernel_units: chooses among the variants of a kernel family that are compiled as sources of their own, one
 * for each instruction set (iso_kernel_units in CMakeLists.txt): what takes long to compile is compiled on
 * all processors, and a build for one machine alone (ISO_KERNELS=native) leaves the other variants out.
 *
 * In its header a family declares ISO_KERNEL_UNITS(type, name): constants name_generic, name_avx2 and
 * name_avx512. Each unit defines one of them, as ISO_V(name). Internal. */
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
