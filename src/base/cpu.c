/* cpu: detection of instruction sets, and their limit by environment variable or by a test. */
#include "base/cpu.h"

#include <stdatomic.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

static const char *const names[ISO_CPU_LEVELS] = {"generic", "avx2", "avx512"};

const char *iso_cpu_level_name(iso_cpu_level level) {
    return names[level];
}

iso_cpu_level iso_cpu_supported(void) {
#if ISO_HAVE_X86
    bool v3 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("bmi") &&
              __builtin_cpu_supports("bmi2") && __builtin_cpu_supports("popcnt");
    if (!v3) return ISO_CPU_GENERIC;
    bool v4 = __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
              __builtin_cpu_supports("avx512cd") && __builtin_cpu_supports("avx512dq") &&
              __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512vbmi2");
    return v4 ? ISO_CPU_AVX512 : ISO_CPU_AVX2;
#else
    return ISO_CPU_GENERIC;
#endif
}

/* The highest level that the machine has and that ISO_CPU allows. */
static iso_cpu_level allowed(void) {
    int level = (int)iso_cpu_supported();
    const char *wanted = getenv("ISO_CPU");
    for (int i = 0; wanted && i < level; i++)
        if (strcmp(wanted, names[i]) == 0) level = i;
    return (iso_cpu_level)level;
}

static _Atomic int chosen = -1; /* the result of iso_cpu_best; -1: not determined yet */

iso_cpu_level iso_cpu_best(void) {
    int level = atomic_load_explicit(&chosen, memory_order_relaxed);
    if (level >= 0) return (iso_cpu_level)level;
    int none = -1;
    level = (int)allowed();
    /* keeps a limit that another thread may have set in the meantime */
    if (!atomic_compare_exchange_strong_explicit(&chosen, &none, level, memory_order_relaxed,
                                                 memory_order_relaxed))
        level = none;
    return (iso_cpu_level)level;
}

iso_cpu_level iso_cpu_limit(iso_cpu_level highest) {
    iso_cpu_level level = allowed();
    if (highest < level) level = highest;
    atomic_store_explicit(&chosen, (int)level, memory_order_relaxed);
    return level;
}
