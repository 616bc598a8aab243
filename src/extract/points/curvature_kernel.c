/* curvature_kernel: the variants of curvature_kernel_body.inc, and the choice between them. */
#include "extract/points/curvature_kernel.h"

#define ISO_KERNEL_BODY "extract/points/curvature_kernel_body.inc"
#include "base/kernel_levels.inc"

const iso_curvature_kernel *iso_curvature_kernel_get(iso_cpu_level level) {
    return ISO_KERNEL(kernel, level);
}
