/* kernel: includes the kernel's body once per instruction set. */
#include "render/gaussians/kernel.h"

#include "base/exponential.h"
#include "render/gaussians/gaussians.h"

#define ISO_KERNEL_BODY "render/gaussians/kernel_body.inc"
#include "base/kernel_levels.inc"

const iso_gaussian_kernel *iso_gaussian_kernel_get(iso_cpu_level level) {
    return ISO_KERNEL(kernel, level);
}
