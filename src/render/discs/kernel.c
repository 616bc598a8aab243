/* kernel: chooses among the units in which the kernel is compiled (discs_kernel.c). */
#include "render/discs/kernel.h"

#include "base/kernel_units.h"

const iso_discs_kernel *iso_discs_kernel_get(iso_cpu_level level) {
    return ISO_KERNEL_UNIT(iso_discs_kernel, level);
}
