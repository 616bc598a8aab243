#include "render/pullpush_kernel.h"

#include "base/simd.h"

/* Where in its pixel a point lies is known to 1/32 (pyramid.h). */
enum { PP_PART_BITS = 5, PP_PARTS = 1 << PP_PART_BITS };

#define ISO_LEVEL generic
#include "render/pullpush_project.inc"

#include "render/pullpush_levels.inc"

#include "render/pullpush_finish.inc"
#undef ISO_LEVEL
#if ISO_HAVE_X86
#define ISO_LEVEL avx2
#include "render/pullpush_project.inc"

#include "render/pullpush_levels.inc"

#include "render/pullpush_finish.inc"
#undef ISO_LEVEL
#define ISO_LEVEL avx512
#include "render/pullpush_project.inc"

#include "render/pullpush_levels.inc"

#include "render/pullpush_finish.inc"
#undef ISO_LEVEL
#endif

const iso_pullpush_kernel *iso_pullpush_kernel_get(iso_cpu_level level) {
    return ISO_KERNEL(kernel, level);
}
