#include "extract/points/shape_kernel.h"

#define ISO_KERNEL_BODY "extract/points/shape_kernel_body.inc"
#include "base/kernel_levels.inc"

const iso_shape_kernel *iso_shape_kernel_get(iso_cpu_level level) {
    return ISO_KERNEL(kernel, level);
}
