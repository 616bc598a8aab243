/* voxel_kernel: the voxel type of a kernel that is compiled once for each (iso_kernels .. VARIANTS uint8
 * int16 uint16 float in CMakeLists.txt). Internal: for kernels only. */
#ifndef ISO_GRIDS_VOXEL_KERNEL_H
#define ISO_GRIDS_VOXEL_KERNEL_H

#include "base/kernel.h"
#include "grids/rgrid.h"

#ifndef ISO_VARIANT
#define ISO_VARIANT float
#endif

/* The C type of the voxels. */
#define ISO_T_uint8 uint8_t
#define ISO_T_int16 int16_t
#define ISO_T_uint16 uint16_t
#define ISO_T_float float
#define ISO_T ISO_PASTE(ISO_T, ISO_VARIANT)

/* Whether that is the type, for #if. */
#define ISO_VOXEL_uint8 1
#define ISO_VOXEL_int16 2
#define ISO_VOXEL_uint16 3
#define ISO_VOXEL_float 4
#define ISO_VOXEL_IS(type) (ISO_PASTE(ISO_VOXEL, ISO_VARIANT) == ISO_VOXEL_##type)

#endif
