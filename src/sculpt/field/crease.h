/* crease: corrects the distances of a level set beside creases.
 *
 * A sampled distance field rounds creases: its zero set cuts the corner between voxels. In the fan of voxels
 * to which the crease is the nearest part of the surface, redistancing yields values between the distance to
 * the intended crease and the distance to the zero set: up to a third of a voxel too small. The positions
 * where the zero set crosses the edges between voxels are known exactly. A voxel cannot be farther from the
 * zero set than from the nearest edge point, nor much nearer, which bounds the distances in the fans.
 * Internal to sculpt. */
#ifndef ISO_SCULPT_FIELD_CREASE_H
#define ISO_SCULPT_FIELD_CREASE_H

#include "base/memory.h"
#include "base/primitives.h"

/* The window from which the distances of a brick are corrected: the brick and ISO_CREASE_MARGIN voxels on
 * each side. */
enum { ISO_CREASE_MARGIN = 5, ISO_CREASE_SIDE = ISO_BRICK + 2 * ISO_CREASE_MARGIN };

/* Writes to `out` the brick in the middle of `window` (ISO_CREASE_SIDE^3 values in voxels, x fastest) with
 * the distances in fans bounded. Voxels beside the interface keep their values, so the zero set does not
 * move. No value enters or leaves the band. A voxel in a fan with a neighbour at the band's end is kept at
 * least the square root of 3 from the surface, so that extraction makes no foot point of it. In bands wider
 * than 3.6 voxels, values beyond 3.6 stay as they are. `room` is working memory, kept for the next call.
 * ISO_ERR_NOMEM. */
iso_status iso_crease_correct(const float *window, float band, iso_buffer *room, float *out);

#endif
