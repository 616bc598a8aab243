/* first_kernel: the drawing kernel that shows the first crossing of each ray. */
#define ISO_EXACT_LAYERED 0
#include "exact/draw_simd.h"

const iso_exact_kernel ISO_KERNEL_NAME(iso_exact_kernel) = {draw, flush_hits};
