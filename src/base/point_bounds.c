/* point_bounds: includes point_bounds_body.inc once per instruction set, and chooses the variant. */
#include "base/point_bounds.h"

#include <float.h>

#define ISO_KERNEL_BODY "base/point_bounds_body.inc"
#include "base/kernel_levels.inc"

void iso_point_bounds_find(const iso_point_view *view, size_t first, size_t count, iso_point_bounds *bounds) {
    ISO_KERNEL(find_bounds, iso_cpu_best())(view, first, count, bounds);
}
