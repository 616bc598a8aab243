/* The variants of histogram_kernel_body.inc, and the choice between them. */
#include "extract/histogram_kernel.h"

#include "base/simd.h"

#define ISO_LEVEL generic
#include "extract/histogram_kernel_body.inc"
#undef ISO_LEVEL

#if ISO_HAVE_X86
#define ISO_LEVEL avx2
#include "extract/histogram_kernel_body.inc"
#undef ISO_LEVEL
#define ISO_LEVEL avx512
#include "extract/histogram_kernel_body.inc"
#undef ISO_LEVEL
#endif

const iso_histogram_kernels *iso_histogram_kernels_get(iso_cpu_level level) {
    return ISO_KERNEL(kernels, level);
}
