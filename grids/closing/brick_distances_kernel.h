/* brick_distances_kernel: finds the voxels of a brick that a triangle may be nearest to. Internal to
 * grids/closing. */
#ifndef ISO_GRIDS_CLOSING_BRICK_DISTANCES_KERNEL_H
#define ISO_GRIDS_CLOSING_BRICK_DISTANCES_KERNEL_H

#include <stdint.h>

#include "base/cpu.h"
#include "grids/hgrid.h"

/* A triangle as the kernels need it. Unit: voxels, from the brick's first one. */
typedef struct near_triangle {
    int lo[3], hi[3];            /* the voxels of the brick that it reaches */
    float plane[4], sides[3][4]; /* (a, b, c, d): a x + b y + c z + d is the distance above the plane, and
                                     inside each side, along the plane */
    float outside;               /* how far outside its sides it reaches */
    float slack,
        most; /* what is added to squared bounds, and to that of the band, for the rounding of floats */
} near_triangle;

/* What (a, b, c, d) are at x = 0. */
static inline float row_value(const float plane[4], float y, float z) {
    return plane[1] * y + plane[2] * z + plane[3];
}

typedef int find_near_fn(const near_triangle *t, const float *bound, uint16_t *near);
ISO_KERNEL_UNITS(find_near_fn, iso_find_near_voxels);

#endif
