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
    return ISO_KERNEL(kernel, level);
}
