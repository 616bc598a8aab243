#include "base/point_bounds.h"

#include <float.h>

#include "base/simd.h"

#define ISO_LEVEL generic
#include "base/point_bounds_body.inc"
#undef ISO_LEVEL
#if ISO_HAVE_X86
#define ISO_LEVEL avx2
#include "base/point_bounds_body.inc"
#undef ISO_LEVEL
#define ISO_LEVEL avx512
#include "base/point_bounds_body.inc"
#undef ISO_LEVEL
#endif

void iso_point_bounds_find(const iso_point_view *view, size_t first, size_t count, iso_point_bounds *bounds) {
#if ISO_HAVE_X86
    iso_cpu_level level = iso_cpu_best();
    if (level >= ISO_CPU_AVX512) {
        find_bounds_avx512(view, first, count, bounds);
        return;
    }
    if (level >= ISO_CPU_AVX2) {
        find_bounds_avx2(view, first, count, bounds);
        return;
    }
#endif
    find_bounds_generic(view, first, count, bounds);
}
