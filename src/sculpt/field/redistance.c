/* redistance: chooses among the redistancing kernels (redistance_kernel.c). */
#include "sculpt/field/redistance.h"

#include "base/kernel_units.h"

const iso_redistancer *iso_redistancer_get(iso_cpu_level level) {
    return ISO_KERNEL_UNIT(iso_redistancer, level);
}
