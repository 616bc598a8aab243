/* spline_hits: draws the isosurface of a spline (grids/spline). exact draws a shell around it; then each
 * sample is moved along its ray onto the spline, by Newton's method, and gets the spline's normal. Samples
 * from which the method does not arrive, next to outlines, are traced. */
#ifndef ISO_EXACT_SPLINE_HITS_H
#define ISO_EXACT_SPLINE_HITS_H

#include "exact/exact.h"
#include "grids/ray/ray_tracer.h"
#include "grids/spline/spline.h"

/* All members are borrowed for the call. */
typedef struct iso_exact_spline {
    const iso_exact *shell; /* of the refined spline's shell (iso_spline_refine) */
    const iso_spline *spline;
    const iso_ray_tracer *tracer; /* of the spline, with the same isovalue */
    double isovalue;              /* stored */
} iso_exact_spline;

/* Draws the surface into a gbuffer: replaces the samples that are farther. The same bytes with every number
 * of threads and instruction set, and in strips of any height. ISO_ERR_NOMEM. */
iso_status iso_draw_exact_spline(const iso_target *target, const iso_exact_spline *of, iso_error *error);

#endif
