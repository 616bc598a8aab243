/* layers_kernel: the drawing kernel that lists every crossing of each ray as a fragment (render/layers). The
 * same source as first_kernel.c's. Crossings of a pixel are found front to back, but:
 * - one in the face between two cells may be found in both, or in neither: crossings so near to a face are
 *   reported as doubtful, and their pixels are traced again in double precision (layers.c);
 * - a ray may cross the surface three times in a cell: its pieces are queued one by one. */
#define ISO_EXACT_LAYERED 1
#include "exact/draw_simd.h"

const iso_exact_kernel ISO_KERNEL_NAME(iso_exact_layers_kernel) = {draw, flush_hits};
