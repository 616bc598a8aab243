/* kernel: chooses among the units in which the kernel is compiled (discs_kernel.c). */
#include "render/refined/kernel.h"

#include "base/kernel_units.h"

ISO_KERNEL_UNITS(iso_refined_kernel, iso_refined_kernel);

const iso_refined_kernel *iso_refined_kernel_get(iso_cpu_level level) {
    return ISO_KERNEL_UNIT(iso_refined_kernel, level);
}
