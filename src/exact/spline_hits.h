/* spline_hits: moves what exact has drawn of a refined spline (grids/spline) onto the spline itself,
 * along the rays, by Newton's method, and gives it the spline's normals. */
#ifndef ISO_EXACT_SPLINE_HITS_H
#define ISO_EXACT_SPLINE_HITS_H

#include "grids/spline/spline.h"
#include "render/raster/raster.h"

/* Corrects the samples of the target that show its surface, whose number nothing else has. A sample from
 * which the method does not converge within half a voxel keeps its depth. isovalue: stored. The same
 * bytes with every number of threads and instruction set. */
void iso_exact_move_to_spline(const iso_target *target, const iso_spline *spline, double isovalue);

#endif
