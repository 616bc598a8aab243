/* crease: distances beside the creases of a field, from the surface that the field itself has.
 *
 * At a crease a field's surface is blunter than what was meant: between voxels it is cut off. Distances that
 * redistancing finds beside it, in the fan of the voxels to which the crease is the nearest, lie between
 * those to the meant crease and those to the surface: up to a third of a voxel short. Where edges between
 * voxels cross the surface is known exactly, and no voxel can be farther from it than from the nearest of
 * them, nor nearer by much: in the fans that bounds the distance. Internal to sculpt. */
#ifndef ISO_SCULPT_FIELD_CREASE_H
#define ISO_SCULPT_FIELD_CREASE_H

#include "base/memory.h"
#include "base/primitives.h"

/* What a brick's distances depend on: itself and ISO_CREASE_MARGIN voxels on each side, x fastest. */
enum { ISO_CREASE_MARGIN = 5, ISO_CREASE_SIDE = ISO_BRICK + 2 * ISO_CREASE_MARGIN };

/* out = the brick in the middle of `window` (ISO_CREASE_SIDE^3 values), its distances in fans bounded. Voxels
 * beside the interface keep their value, so the zero set moves by no bit; none reaches the band's end or
 * leaves it, and beside those at its end none is left where foot points are made. Of a band wider than 3.6
 * voxels the rest stays as it is. `room`: the caller's, to use again. ISO_ERR_NOMEM. */
iso_status iso_crease_correct(const float *window, float band, iso_buffer *room, float *out);

#endif
