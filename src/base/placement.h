/* placement: where instances of a surface stand (iso_placement in isopoint.h): checks, and what they do to
 * transforms and boxes. */
#ifndef ISO_BASE_PLACEMENT_H
#define ISO_BASE_PLACEMENT_H

#include "base/geometry.h"

/* Whether the placement's numbers can be used: ISO_ERR_USAGE with a reason if a number is not finite, a
 * position is beyond 1e12 mm, a scale is not 0 or from 1e-9 to 1e9. */
iso_status iso_placement_check(const iso_placement *placement, iso_error *error);

/* Whether the placement rotates. */
bool iso_placement_is_turned(const iso_placement *placement);

/* The transform of an instance of something whose own transform is `own`. A placement at 0 0 0 that neither
 * turns nor scales returns the same bits. */
iso_transform iso_placement_transform(const iso_placement *placement, const iso_transform *own);

/* The quaternion (x y z w) of a rotation by `degrees` about the world's x axis, then its y axis, then its z
 * axis (XYZ Euler angles, extrinsic). */
void iso_quaternion_of_angles(const double degrees[3], double quaternion[4]);

#endif
