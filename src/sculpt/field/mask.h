/* mask: the frozen region of a field: a bit a voxel, by cells; cells in which nothing is frozen have none.
 * Internal to sculpt. */
#ifndef ISO_SCULPT_FIELD_MASK_H
#define ISO_SCULPT_FIELD_MASK_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/primitives.h"
#include "base/status.h"

enum { ISO_BRICK_ROWS = ISO_BRICK * ISO_BRICK };

/* Bits of a brick's voxels, one word a row of x. */
typedef struct iso_voxel_bits {
    uint16_t row[ISO_BRICK_ROWS];
} iso_voxel_bits;

/* Zero-initialise; iso_mask_free when done. */
typedef struct iso_mask {
    iso_voxel_bits **cell; /* by the grid's cells; NULL: nothing is frozen there */
    size_t cells, used;    /* used: cells that have bits */
} iso_mask;

iso_status iso_mask_init(iso_mask *mask, size_t cells, iso_error *error);
void iso_mask_free(iso_mask *mask);
void iso_mask_clear(iso_mask *mask);

/* NULL: none. */
static inline const iso_voxel_bits *iso_mask_bits(const iso_mask *mask, size_t cell) {
    return mask->cell[cell];
}

/* Storage for a cell's bits, so that setting them cannot fail; none is set. */
iso_status iso_mask_reserve(iso_mask *mask, size_t cell, iso_error *error);
/* Copies the bits; NULL, or none set, frees the cell. ISO_ERR_NOMEM leaves the mask as it was. */
iso_status iso_mask_set(iso_mask *mask, size_t cell, const iso_voxel_bits *bits, iso_error *error);

#endif
