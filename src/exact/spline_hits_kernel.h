/* spline_hits_kernel: Newton's method for the hits in one cell. Internal to exact. */
#ifndef ISO_EXACT_SPLINE_HITS_KERNEL_H
#define ISO_EXACT_SPLINE_HITS_KERNEL_H

#include "base/cpu.h"
#include "grids/spline/spline.h"

enum { ISO_SPLINE_HITS = 256 };

/* What became of a hit: it is on the spline; it has reached the border of the cell, and is to be moved again
 * in the next one; the method found no crossing, or one where the ray crosses the other way. */
enum { ISO_SPLINE_MOVED, ISO_SPLINE_AGAIN, ISO_SPLINE_LOST };

/* Up to 256 hits in one cell. */
typedef struct iso_spline_hits {
    bool prefilter, smooths; /* values: 6^3 voxels, else 4^3 coefficients; `smoothed` is set, for normals */
    int count;               /* at least 1; the arrays are written up to the next multiple of 16 */
    float isovalue, values[ISO_SPLINE_VOXELS], smoothed[ISO_SPLINE_COEFFICIENTS];
    /* Positions in the cell's coordinates, and how they change for each mm of depth. */
    float at[3][ISO_SPLINE_HITS], step[3][ISO_SPLINE_HITS];
    /* The change of the field along the ray where it was moved first, for each mm; 0: it is moved first.
     * Set. */
    float toward[ISO_SPLINE_HITS];
    float shift[ISO_SPLINE_HITS], gradient[3][ISO_SPLINE_HITS]; /* results: mm of depth; stored values */
    int32_t state[ISO_SPLINE_HITS];
} iso_spline_hits;

typedef void iso_spline_hits_fn(iso_spline_hits *hits);
/* Every instruction set gives the same bytes. */
ISO_KERNEL_UNITS(iso_spline_hits_fn, iso_spline_hits_units);

#endif
