/* candidates: which samples a shape may be met at. A test in floats, many samples at a time, that never
 * leaves out one where the shape is: before pieces are computed in double precision. Internal to shapes. */
#ifndef ISO_RENDER_SHAPES_CANDIDATES_H
#define ISO_RENDER_SHAPES_CANDIDATES_H

#include <math.h>

#include "base/cpu.h"
#include "render/shapes/near.h"

/* A part of the picture that holds a shape: all points within `radius` of the segment from (x, y) to
 * (x + dx, y + dy), in pixels from the corner of the samples; radius INFINITY: the whole picture. */
typedef struct iso_shapes_stadium {
    float x, y, dx, dy, radius;
} iso_shapes_stadium;

/* A rectangle of samples, and what can be seen at each: depths behind which nothing can (-INFINITY where
 * nothing can at all), `width` a row. ISO_LANES_MAX values more can be read. */
typedef struct iso_shapes_samples {
    const float *limit;
    int width;
} iso_shapes_samples;

/* Lists the samples of `box` (counted from the corner) that are in the stadium and where something at the
 * depth `nearest` can be seen, as y << 16 | x; returns how many. `out` has room for all samples of the box
 * and ISO_LANES_MAX more. */
typedef int iso_shapes_candidates_fn(const iso_shapes_samples *samples, const iso_shapes_stadium *stadium,
                                     const iso_shapes_rect *box, float nearest, int32_t *out);

ISO_KERNEL_UNITS(iso_shapes_candidates_fn, iso_shapes_find_candidates);

/* The function for an instruction set, or for the best below it that this build has. Never NULL. */
iso_shapes_candidates_fn *iso_shapes_candidates_get(iso_cpu_level level);

/* The disc that holds a sphere which iso_near_fits, in pixels from the picture's corner. */
typedef struct iso_shapes_disc {
    double x, y, radius;
} iso_shapes_disc;
iso_shapes_disc iso_shapes_disc_of(const iso_shapes_frame *frame, const double centre[3], double radius);
/* The stadium and box of what lies in the convex hull of two spheres, within the rectangle `all`, from whose
 * corner they are counted; false when they do not meet it. */
bool iso_shapes_stadium_of(const iso_shapes_disc *a, const iso_shapes_disc *b, const iso_shapes_rect *all,
                           iso_shapes_stadium *stadium, iso_shapes_rect *box);

#endif
