/* compose_kernel: includes the kernel's body once per instruction set. */
#include "render/layers/compose_kernel.h"

#include "render/shading/phong_vectors.h"

#define ISO_KERNEL_BODY "render/layers/compose_body.inc"
#include "base/kernel_levels.inc"

const iso_layer_kernel *iso_layer_kernel_get(iso_cpu_level level) {
    return ISO_KERNEL(kernel, level);
}
