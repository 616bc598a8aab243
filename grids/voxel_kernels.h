/* voxel_kernels: kernel families (base/simd.h) with a variant per voxel type. Internal: kernel files only. */
#ifndef ISO_GRIDS_VOXEL_KERNELS_H
#define ISO_GRIDS_VOXEL_KERNELS_H

#include "base/simd.h"
#include "grids/rgrid.h"

/* Names a function or constant of a body that voxel_kernels.inc includes: name_uint8_avx2 and the like. */
#define ISO_TYPED(name) ISO_PASTE(ISO_PASTE(name, ISO_VOXEL), ISO_LEVEL)

/* ISO_KERNEL of kernel_uint8, kernel_int16, kernel_uint16 or kernel_float, by iso_type. */
#define ISO_VOXEL_KERNEL(kernel, type, level)                                                                \
    ((type) == ISO_UINT8    ? ISO_KERNEL(kernel##_uint8, level)                                              \
     : (type) == ISO_INT16  ? ISO_KERNEL(kernel##_int16, level)                                              \
     : (type) == ISO_UINT16 ? ISO_KERNEL(kernel##_uint16, level)                                             \
                            : ISO_KERNEL(kernel##_float, level))

#endif
