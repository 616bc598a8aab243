/* mask: the frozen voxels of a field, one bit for each voxel; the items (cell_items.h) are iso_voxel_bits.
 * Only cells with a frozen voxel have memory for bits. Internal to sculpt. */
#ifndef ISO_SCULPT_FIELD_MASK_H
#define ISO_SCULPT_FIELD_MASK_H

#include "base/primitives.h"
#include "sculpt/field/cell_items.h"

enum { ISO_BRICK_ROWS = ISO_BRICK * ISO_BRICK };

/* One bit for each voxel of a brick: bit x of row z * 16 + y. */
typedef struct iso_voxel_bits {
    uint16_t row[ISO_BRICK_ROWS];
} iso_voxel_bits;

typedef iso_cell_items iso_mask;

/* Prepares a mask for a grid of `cells` cells; nothing is frozen. ISO_ERR_NOMEM. */
static inline iso_status iso_mask_init(iso_mask *mask, size_t cells, iso_error *error) {
    return iso_cell_items_init(mask, "the mask", cells, sizeof(iso_voxel_bits), error);
}

/* Returns the bits of a cell; NULL: nothing is frozen there. */
static inline const iso_voxel_bits *iso_mask_bits(const iso_mask *mask, size_t cell) {
    return (const iso_voxel_bits *)mask->cell[cell];
}

#endif
