/* kernel: chooses the kernel of an instruction set. */
#include "render/gaussians/kernel.h"

#include "base/kernel_units.h"

const iso_gaussian_kernel *iso_gaussian_kernel_get(iso_cpu_level level) {
    return ISO_KERNEL_UNIT(iso_gaussian_kernel, level);
}
