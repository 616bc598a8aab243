/* kernel: the drawing kernel that shows the first crossing of each ray. */
#define ISO_EXACT_LAYERED 0
#include "exact/kernel_source.inc"

const iso_exact_kernel *iso_exact_kernel_get(iso_cpu_level level) {
    return ISO_KERNEL(kernel, level);
}
