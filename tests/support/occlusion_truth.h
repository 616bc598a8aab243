/* occlusion_truth: ambient occlusion by many random rays through the trilinear field in double precision:
 * what src/render/occlusion is compared with. */
#ifndef ISO_TESTS_OCCLUSION_TRUTH_H
#define ISO_TESTS_OCCLUSION_TRUTH_H

#include "grids/grid.h"

/* The share of `rays` random rays, distributed by the cosine to the normal, that do not meet the solid within
 * `range` mm of a place of its surface: a position in index coordinates with a unit normal in the world. Rays
 * begin 0.75 voxels beside the surface. The same result on every machine but for the rounding of sin and cos.
 */
double iso_occlusion_truth(const iso_grid *grid, double isovalue, iso_vec3 position, iso_vec3 normal,
                           double range, int rays, uint64_t seed);

#endif
