/* voxel_kernels: macros for kernel families (base/simd.h) that have a variant for each voxel type too.
 * Internal: kernel files only. */
#ifndef ISO_GRIDS_VOXEL_KERNELS_H
#define ISO_GRIDS_VOXEL_KERNELS_H

#include "base/simd.h"
#include "grids/rgrid.h"

/* The name of a function or constant in a body that voxel_kernels.inc includes, with voxel type and level:
 * for example name_uint8_avx2. */
#define ISO_TYPED(name) ISO_PASTE(ISO_PASTE(name, ISO_VOXEL), ISO_LEVEL)

/* The address of the variant of a kernel for a voxel type (iso_type) and an instruction set; chosen at run
 * time, like ISO_KERNEL. */
#define ISO_VOXEL_KERNEL(kernel, type, level)                                                                \
    ((type) == ISO_UINT8    ? ISO_KERNEL(kernel##_uint8, level)                                              \
     : (type) == ISO_INT16  ? ISO_KERNEL(kernel##_int16, level)                                              \
     : (type) == ISO_UINT16 ? ISO_KERNEL(kernel##_uint16, level)                                             \
                            : ISO_KERNEL(kernel##_float, level))

#endif
