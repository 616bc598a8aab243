/* spans: sorts points into spans, one for each brick of 16^3 voxels, as extracted points have them: renderers
 * skip hidden bricks as a whole, and positions in a brick keep their precision in floats. Internal. */
#ifndef ISO_CLOUDS_SPANS_H
#define ISO_CLOUDS_SPANS_H

#include "base/memory.h"
#include "base/primitives.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The places of points in spans. Zero-initialise; free with iso_span_order_free. */
typedef struct iso_span_order {
    uint32_t *order; /* the numbers of the points, sorted by brick and within a brick by number */
    iso_point_span *spans;
    size_t span_count;
    double origin[3]; /* of voxel (0, 0, 0), relative to the positions' own origin */
    double voxel;     /* mm, a power of two: positions are converted to voxels without rounding */
} iso_span_order;

/* Sorts finite positions into bricks of cubic voxels, whose size is the power of two next to and not above
 * `voxel` (mm), but large enough for 2^20 bricks along an axis. ISO_ERR_NOMEM. */
iso_status iso_span_order_make(const float (*positions)[3], size_t count, double voxel, iso_span_order *spans,
                               iso_error *error);
void iso_span_order_free(iso_span_order *spans);

/* Sets `relative` to a position, in voxels, relative to the first voxel of its brick. */
static inline void iso_span_position(const iso_span_order *spans, const int32_t brick[3],
                                     const float position[3], float relative[3]) {
    const double voxels = 1 / spans->voxel; /* voxels per mm; exact, because it is a power of two */
    for (int axis = 0; axis < 3; axis++)
        relative[axis] = (float)(((double)position[axis] - spans->origin[axis]) * voxels -
                                 (double)ISO_BRICK * brick[axis]);
}

#ifdef __cplusplus
}
#endif
#endif
