/* component_mask: ranges of voxels that masks stand for, and the choice of the kernel. */
#include "grids/parts/component_mask.h"

#include <float.h>
#include <math.h>

#include "base/kernel_units.h"

bool iso_mask_range_of(iso_type type, float at, bool below, iso_mask_range *range) {
    *range = (iso_mask_range){.float_lo = below ? -FLT_MAX : at,
                              .float_hi = below ? nextafterf(at, -INFINITY) : FLT_MAX};
    if (type == ISO_FLOAT32)
        return range->float_lo <= range->float_hi && range->float_hi >= -FLT_MAX &&
               range->float_lo <= FLT_MAX;
    const int32_t least = type == ISO_INT16 ? INT16_MIN : 0, most = type == ISO_UINT8   ? UINT8_MAX
                                                                    : type == ISO_INT16 ? INT16_MAX
                                                                                        : UINT16_MAX;
    /* The smallest integer at or above `at`, or the one after the type's largest if all are below. */
    const double up = ceil((double)at);
    const int32_t first = up < least ? least : up > most ? most + 1 : (int32_t)up;
    range->lo = below ? least : first;
    range->hi = below ? first - 1 : most;
    return range->lo <= range->hi;
}

iso_mask_kernel *iso_mask_kernel_get(iso_type type, iso_cpu_level level) {
    return (*ISO_KERNEL_UNIT(iso_mask_kernels, level))[type];
}
