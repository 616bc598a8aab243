/* mask: the frozen voxels of a field, one bit for each voxel. Only cells with a frozen voxel have memory for
 * bits. Internal to sculpt. */
#ifndef ISO_SCULPT_FIELD_MASK_H
#define ISO_SCULPT_FIELD_MASK_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/primitives.h"
#include "base/status.h"

enum { ISO_BRICK_ROWS = ISO_BRICK * ISO_BRICK };

/* One bit for each voxel of a brick: bit x of row z * 16 + y. */
typedef struct iso_voxel_bits {
    uint16_t row[ISO_BRICK_ROWS];
} iso_voxel_bits;

/* Zero-initialise; iso_mask_free when done. */
typedef struct iso_mask {
    iso_voxel_bits **cell; /* indexed by cell; NULL: nothing is frozen in the cell */
    size_t cells;          /* cells of the grid */
    size_t used;           /* cells that have bits */
} iso_mask;

/* Prepares a mask for a grid of `cells` cells; nothing is frozen. ISO_ERR_NOMEM. */
iso_status iso_mask_init(iso_mask *mask, size_t cells, iso_error *error);
void iso_mask_free(iso_mask *mask);
/* Unfreezes all voxels. */
void iso_mask_clear(iso_mask *mask);

/* Returns the bits of a cell; NULL: nothing is frozen there. */
static inline const iso_voxel_bits *iso_mask_bits(const iso_mask *mask, size_t cell) {
    return mask->cell[cell];
}

/* Allocates the bits of a cell, all 0 if it had none, so that iso_mask_set cannot fail for it. ISO_ERR_NOMEM.
 */
iso_status iso_mask_reserve(iso_mask *mask, size_t cell, iso_error *error);
/* Sets the bits of a cell to a copy of `bits`. NULL, or bits that are all 0, frees the memory of the cell's
 * bits. ISO_ERR_NOMEM: the mask is as before. */
iso_status iso_mask_set(iso_mask *mask, size_t cell, const iso_voxel_bits *bits, iso_error *error);

#endif
