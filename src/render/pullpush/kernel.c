/* kernel: compiles kernel_body.inc once per instruction set. */
#include "render/pullpush/kernel.h"

#include "base/simd.h"
#include "render/shading/phong.h"

/* Keys store a point's position within its pixel in 1/32 (pyramid.h). */
enum { PP_PART_BITS = 5, PP_PARTS = 1 << PP_PART_BITS };

/* Of which side of the surface points are drawn: what iso_pullpush_kind means for averages. */
typedef enum pp_sides {
    PP_ONE,
    PP_TWO,
    PP_NONE, /* normals have no sign */
    PP_SETS  /* surfaces as PP_TWO, and ribbons as PP_NONE, side by side */
} pp_sides;

/* How far ellipses of lines reach along the line, in pixels of their level. */
#define PP_REACH 2

#define ISO_KERNEL_BODY "render/pullpush/kernel_body.inc"
#include "base/kernel_levels.inc"

const iso_pullpush_kernel *iso_pullpush_kernel_get(iso_cpu_level level) {
    return ISO_KERNEL(kernel, level);
}
