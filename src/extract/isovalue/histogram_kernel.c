/* histogram_kernel: the variants of histogram_kernel_body.inc, and the choice between them. */
#include "extract/isovalue/histogram_kernel.h"

#define ISO_KERNEL_BODY "extract/isovalue/histogram_kernel_body.inc"
#include "base/kernel_levels.inc"

const iso_histogram_kernels *iso_histogram_kernels_get(iso_cpu_level level) {
    return ISO_KERNEL(kernels, level);
}
