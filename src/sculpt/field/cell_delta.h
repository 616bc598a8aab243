/* cell_delta: what differs between two contents of a brick, losslessly: which voxels, and their new values,
 * packed to about two bytes each. A delta can be applied to other contents than the one that it was made
 * from, if the voxels that it reads are the same in them: the seven that come before a changed one in the
 * cube of 2^3 voxels. In memory only: the bytes are those of this program. Internal to sculpt. */
#ifndef ISO_SCULPT_FIELD_CELL_DELTA_H
#define ISO_SCULPT_FIELD_CELL_DELTA_H

#include <stddef.h>
#include <stdint.h>

#include "sculpt/field/mask.h"

/* The largest delta: a bit for each row, its voxels, their codes, their values, and 8 bytes. */
enum {
    ISO_CELL_DELTA_MAX =
        ISO_BRICK_ROWS / 8 + ISO_BRICK_ROWS * 2 + ISO_BRICK_VOXELS / 2 + ISO_BRICK_VOXELS * 4 + 8
};

/* Writes the delta from `before` to `after` (4096 values each; bits are compared) and returns its size: 0:
 * they are the same; at most ISO_CELL_DELTA_MAX, the room that `bytes` must have. */
size_t iso_cell_delta_pack(const float *before, const float *after, float band, uint8_t *bytes);
/* Changes `brick` by a delta; a size of 0 changes nothing. */
void iso_cell_delta_apply(const uint8_t *bytes, size_t size, float band, float *brick);
/* Adds the voxels that a delta changes to `bits` (not those that it reads). */
void iso_cell_delta_add_bits(const uint8_t *bytes, size_t size, iso_voxel_bits *bits);

#endif
