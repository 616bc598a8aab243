/* steps_kernel: pull, push and the last push. A unit is compiled for each instruction set
 * (base/kernel_levels.inc) and each way of averaging: ISO_KERNEL_VARIANT is ONE, TWO or SETS. */
#include "base/simd.h"
#include "render/pullpush/kernel.h"
#include "render/shading/phong.h"

/* Of which side of the surface points are drawn: what iso_pullpush_kind means for averages. */
typedef enum pp_sides {
    PP_ONE,
    PP_TWO,
    PP_SETS /* surfaces as PP_TWO, and ribbons, whose normals have no sign, side by side */
} pp_sides;
#define PP_SIDES ISO_PASTE(PP, ISO_KERNEL_VARIANT)
#define PP_STEPS ISO_V(ISO_PASTE(iso_pullpush_steps, ISO_KERNEL_VARIANT))

/* How far ellipses of ribbons reach along the line, in pixels of their level. */
#define PP_REACH 2

#define ISO_KERNEL_BODY "render/pullpush/steps_body.inc"
#include "base/kernel_levels.inc"
