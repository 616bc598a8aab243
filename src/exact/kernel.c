/* kernel: the drawing kernel that shows the first crossing of each ray. */
#define ISO_EXACT_LAYERED 0
#define ISO_EXACT_KERNEL iso_exact_kernel
#include "exact/kernel_source.inc"
