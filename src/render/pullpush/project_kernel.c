/* project_kernel: projection of points to keys. A unit is compiled for each instruction set
 * (base/kernel_levels.inc). */
#include "base/simd.h"
#include "render/pullpush/kernel.h"

/* Keys store a point's position within its pixel in 1/32 (pyramid.h). */
enum { PP_PART_BITS = 5, PP_PARTS = 1 << PP_PART_BITS };

#define ISO_KERNEL_BODY "render/pullpush/project.inc"
#include "base/kernel_levels.inc"
