/* spans: sorts points into spans, one for each brick of 16^3 voxels, as extracted points have them: renderers
 * skip hidden bricks as a whole, and positions in a brick keep their precision in floats. Internal. */
#ifndef ISO_CLOUDS_SPANS_H
#define ISO_CLOUDS_SPANS_H

#include "base/primitives.h"
#include "clouds/point_source.h"

/* Points in the order of their bricks (z, then y, then x), and within a brick in that of the source.
 * Zero-initialise; free with iso_sorted_points_free. */
typedef struct iso_sorted_points {
    iso_surfel *surfels; /* in voxels relative to their bricks, normals of length 1 or 0 */
    float *radii;        /* NULL, as the next two: the source has none */
    uint8_t (*colors)[3];
    uint8_t *opacities;
    iso_point_span *spans;
    iso_point_bounds *bounds; /* of each span */
    size_t span_count;
    double origin[3]; /* of voxel (0, 0, 0), relative to the source's origin */
    double voxel;     /* mm, a power of two: positions are converted to voxels without rounding */
} iso_sorted_points;

/* Sorts points with finite positions into bricks of cubic voxels, whose size is the power of two next to and
 * not above `voxel` (mm), but large enough for 2^20 bricks along an axis. `survey`: of these points. In
 * addition to the result it takes for each thread some 60 bytes for each point of the fullest of 2048 parts
 * of the volume that it sorts, and 72 bytes for each span. ISO_ERR_NOMEM; ISO_ERR_IO: the source has changed
 * since it was surveyed. */
iso_status iso_points_sort(const iso_point_source *source, const iso_point_survey *survey, double voxel,
                           iso_pool *pool, iso_sorted_points *sorted, iso_error *error);
void iso_sorted_points_free(iso_sorted_points *sorted);

#endif
