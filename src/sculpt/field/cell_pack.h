/* cell_pack: lossless compression of a brick, for undo steps and checkpoints. Two bits a voxel say whether it
 * is +band, -band or a distance; the distances follow as floats. Near a surface this takes a third to a
 * quarter of the brick's 16 KiB. Internal to sculpt. */
#ifndef ISO_SCULPT_FIELD_CELL_PACK_H
#define ISO_SCULPT_FIELD_CELL_PACK_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/primitives.h"

enum { ISO_CELL_PACK_MAX = ISO_BRICK_VOXELS / 4 + ISO_BRICK_VOXELS * 4 };

/* Returns the size of the packed brick in bytes, at most ISO_CELL_PACK_MAX. */
size_t iso_cell_pack_size(const float *brick, float band);
/* Writes the packed brick to `bytes`, which must have room for iso_cell_pack_size bytes. */
void iso_cell_pack(const float *brick, float band, uint8_t *bytes);
/* Restores the brick, to the bit. False: `bytes` is not a packed brick of this size. */
bool iso_cell_unpack(const uint8_t *bytes, size_t size, float band, float *brick);

#endif
