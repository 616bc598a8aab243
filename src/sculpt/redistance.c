#include "sculpt/redistance.h"

#include "base/simd.h"

#define ISO_LEVEL generic
#include "sculpt/redistance_body.inc"
#undef ISO_LEVEL
#if ISO_HAVE_X86
#define ISO_LEVEL avx2
#include "sculpt/redistance_body.inc"
#undef ISO_LEVEL
#define ISO_LEVEL avx512
#include "sculpt/redistance_body.inc"
#undef ISO_LEVEL
#endif

const iso_redistancer *iso_redistancer_get(iso_cpu_level level) {
    static const iso_redistancer *const kernels[ISO_CPU_LEVELS] = {
        [ISO_CPU_GENERIC] = &redistancer_generic,
#if ISO_HAVE_X86
        [ISO_CPU_AVX2] = &redistancer_avx2,
        [ISO_CPU_AVX512] = &redistancer_avx512,
#endif
    };
    return level < ISO_CPU_LEVELS ? kernels[level] : NULL;
}
