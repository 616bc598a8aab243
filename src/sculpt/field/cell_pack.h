/* cell_pack: a cell of the hgrid as bytes, without loss. An empty cell takes none; a brick is two bits a
 * voxel
 * (+band, -band or a distance) and the distances, a third to a quarter of its 16 KiB near a surface. Internal
 * to sculpt. */
#ifndef ISO_SCULPT_FIELD_CELL_PACK_H
#define ISO_SCULPT_FIELD_CELL_PACK_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/primitives.h"

enum { ISO_CELL_PACK_MAX = ISO_BRICK_VOXELS / 4 + ISO_BRICK_VOXELS * 4 };

/* Bytes that packing takes. */
size_t iso_cell_pack_size(const float *brick, float band);
/* Writes them. */
void iso_cell_pack(const float *brick, float band, uint8_t *bytes);
/* Restores the brick, to the bit; false when the bytes are not as many as such a brick takes. */
bool iso_cell_unpack(const uint8_t *bytes, size_t size, float band, float *brick);

#endif
