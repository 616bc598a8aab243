/* discs_kernel: points to discs, and the two ways of adding them to pixels. */
#include "render/discs/scatter_simd.h"
#include "render/discs/splat_simd.h"

const iso_discs_kernel ISO_KERNEL_NAME(iso_discs_kernel) = {
    scatter_block,     splat_block,         resolve_pixels,    resolve_tiles,
    load_limits_tiles, find_deepest_pixels, find_deepest_tiles};
