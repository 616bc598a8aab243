/* smooth_kernel: a unit for each instruction set (base/kernel_units.h). */
#include "grids/labels/smooth_kernel.h"

#define ISO_KERNEL_BODY "grids/labels/smooth_body.inc"
#include "base/kernel_levels.inc"
