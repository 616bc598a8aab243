/* curvature_kernel: a unit for each instruction set (base/kernel_units.h). */
#include "extract/points/curvature_kernel.h"

#define ISO_KERNEL_BODY "extract/points/curvature_kernel_body.inc"
#include "base/kernel_levels.inc"
