#include "extract/shape_kernel.h"

#include "base/simd.h"

#define ISO_LEVEL generic
#include "extract/shape_kernel_body.inc"
#undef ISO_LEVEL
#if ISO_HAVE_X86
#define ISO_LEVEL avx2
#include "extract/shape_kernel_body.inc"
#undef ISO_LEVEL
#define ISO_LEVEL avx512
#include "extract/shape_kernel_body.inc"
#undef ISO_LEVEL
#endif

const iso_shape_kernel *iso_shape_kernel_get(iso_cpu_level level) {
#if ISO_HAVE_X86
    if (level >= ISO_CPU_AVX512) return &kernel_avx512;
    if (level >= ISO_CPU_AVX2) return &kernel_avx2;
#endif
    (void)level;
    return &kernel_generic;
}
