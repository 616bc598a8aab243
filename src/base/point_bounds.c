/* point_bounds: chooses the kernel (point_bounds_kernel.c). */
#include "base/point_bounds.h"

#include "base/kernel_units.h"

void iso_point_bounds_find(const iso_point_view *view, size_t first, size_t count, iso_point_bounds *bounds) {
    ISO_KERNEL_UNIT(iso_find_point_bounds, iso_cpu_best())(view, first, count, bounds);
}
