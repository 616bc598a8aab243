/* cpu: which instruction sets the kernels may use.
 *
 * A kernel family is one body that a file includes once for each instruction set; all variants give the same
 * bytes. The level is found by the first call of iso_cpu_best and kept in an atomic variable. */
#ifndef ISO_BASE_CPU_H
#define ISO_BASE_CPU_H

#ifdef __cplusplus
extern "C" {
#endif

/* Each level includes those before it. */
typedef enum iso_cpu_level {
    ISO_CPU_GENERIC, /* plain C */
    ISO_CPU_AVX2,    /* x86-64-v3: AVX2, BMI1, BMI2, POPCNT */
    ISO_CPU_AVX512,  /* AVX-512 F, BW, CD, DQ, VL and VBMI2: Ice Lake, Zen 4 and later */
    ISO_CPU_LEVELS
} iso_cpu_level;

/* Returns the highest level that this machine has, or the one that the environment variable ISO_CPU names
 * (generic, avx2 or avx512) if this is lower. Thread-safe. */
iso_cpu_level iso_cpu_best(void);

/* Sets the highest level that iso_cpu_best may return from now on; ISO_CPU_AVX512 removes the limit. Returns
 * what iso_cpu_best will return. For tests and benchmarks that compare variants in one process. Points and
 * meshes choose their kernels when they are created or updated, so call this before, while no other thread
 * extracts. */
iso_cpu_level iso_cpu_limit(iso_cpu_level highest);

/* Returns the highest level that this machine has, regardless of ISO_CPU. */
iso_cpu_level iso_cpu_supported(void);

const char *iso_cpu_level_name(iso_cpu_level level);

/* Attributes of functions that use an instruction set. Functions that are inlined into them have no attribute
 * or the same one. */
#if defined(__x86_64__) && defined(__GNUC__)
#define ISO_HAVE_X86 1
#define ISO_TARGET_AVX2 __attribute__((target("avx2,bmi,bmi2,popcnt")))
#ifdef __clang__
#define ISO_TARGET_AVX512                                                                                    \
    __attribute__((target("avx512f,avx512bw,avx512cd,avx512dq,avx512vl,avx512vbmi2,avx2,bmi,bmi2,popcnt"),   \
                   min_vector_width(512)))
#else
#define ISO_TARGET_AVX512                                                                                    \
    __attribute__((target("avx512f,avx512bw,avx512cd,avx512dq,avx512vl,avx512vbmi2,avx2,bmi,bmi2,popcnt,"    \
                          "prefer-vector-width=512")))
#endif
#else
#define ISO_HAVE_X86 0
#endif

#ifdef __cplusplus
}
#endif
#endif
