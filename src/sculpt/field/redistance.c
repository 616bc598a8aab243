/* Compiles the redistancing kernels (redistance_body.inc) for each instruction set and selects one at run
 * time. */
#include "sculpt/field/redistance.h"

#define ISO_KERNEL_BODY "sculpt/field/redistance_body.inc"
#include "base/kernel_levels.inc"

const iso_redistancer *iso_redistancer_get(iso_cpu_level level) {
    return ISO_KERNEL(redistancer, level);
}
