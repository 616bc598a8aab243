/* frame: the box that a picture of points frames. It holds all points, but if a few lie far from the others
 * it leaves them out. */
#ifndef ISO_CLOUDS_FRAME_H
#define ISO_CLOUDS_FRAME_H

#include "clouds/point_source.h"

/* Sets *box to the world box of the points but those that lie far from the others, and *outside to how
 * many of these there are. They are looked for only if the box of all is more than three times as large as
 * that of the middle 96 % of the coordinates on each axis, and lie farther from it than half its diagonal.
 * `survey`: of these points. ISO_ERR_NOMEM. */
iso_status iso_cloud_frame(const iso_point_source *source, const iso_point_survey *survey, iso_box *box,
                           size_t *outside, iso_error *error);

#endif
