/* cpu: which instruction sets the kernels may use.
 *
 * Every kernel is compiled once for each instruction set (base/kernel.h); each variant gives the same
 * bytes. The level of the machine is determined by the first call and kept in an atomic, the only global
 * state of the library. */
#ifndef ISO_BASE_CPU_H
#define ISO_BASE_CPU_H

/* Each level includes those before it. */
typedef enum iso_cpu_level {
    ISO_CPU_GENERIC, /* plain C */
    ISO_CPU_AVX2,    /* x86-64-v3: AVX2, BMI1, BMI2, POPCNT */
    ISO_CPU_AVX512,  /* AVX-512 F, BW, CD, DQ, VL and VBMI2: Ice Lake, Zen 4 and later */
    ISO_CPU_LEVELS
} iso_cpu_level;

/* The floats in a vector of the highest level: arrays that kernels read or write in whole vectors have so
 * many items more. */
enum { ISO_LANES_MAX = 16 };

/* The highest level that this machine has, or the one that the environment variable ISO_CPU names (generic,
 * avx2 or avx512) when that is lower. Thread-safe. */
iso_cpu_level iso_cpu_best(void);

/* Limits iso_cpu_best to `highest` from now on; ISO_CPU_AVX512 removes the limit. Returns the new result of
 * iso_cpu_best. For tests and benchmarks that compare variants in one process. Point sets and meshes choose
 * their kernels when they are created or updated: set the limit before that, and while no other thread
 * extracts. */
iso_cpu_level iso_cpu_limit(iso_cpu_level highest);

/* The highest level that this machine has, without regard to ISO_CPU and iso_cpu_limit. */
iso_cpu_level iso_cpu_supported(void);

const char *iso_cpu_level_name(iso_cpu_level level);

/* Whether the machine is an x86-64, and the compiler has its intrinsics. */
#if defined(__x86_64__) && defined(__GNUC__)
#define ISO_HAVE_X86 1
#else
#define ISO_HAVE_X86 0
#endif

/* name_level, of macros too. */
#define ISO_PASTE_(name, level) name##_##level
#define ISO_PASTE(name, level) ISO_PASTE_(name, level)

/* Declares kernel_generic, kernel_avx2 and kernel_avx512, functions or constants of a type, which a kernel
 * file defines (base/kernel.h) and ISO_KERNEL_UNIT (base/kernel_units.h) chooses among. */
#define ISO_KERNEL_UNITS(type, kernel) extern type kernel##_generic, kernel##_avx2, kernel##_avx512

#endif
