/* Stores the bits of frozen voxels; only cells that have frozen voxels get memory. */
#include "sculpt/field/mask.h"

#include <string.h>

#include "base/memory.h"

iso_status iso_mask_init(iso_mask *mask, size_t cells, iso_error *error) {
    mask->cell = iso_alloc_zero(cells, sizeof(iso_voxel_bits *));
    mask->cells = cells;
    return mask->cell ? ISO_OK : iso_fail(error, ISO_ERR_NOMEM, "out of memory for the mask");
}

void iso_mask_clear(iso_mask *mask) {
    for (size_t i = 0; mask->used && i < mask->cells; i++) {
        mask->used -= mask->cell[i] != NULL;
        iso_free(mask->cell[i]);
        mask->cell[i] = NULL;
    }
}

void iso_mask_free(iso_mask *mask) {
    iso_mask_clear(mask);
    iso_free(mask->cell);
    mask->cell = NULL;
}

static bool any_set(const iso_voxel_bits *bits) {
    uint32_t any = 0;
    for (int row = 0; row < ISO_BRICK_ROWS; row++) any |= bits->row[row];
    return any != 0;
}

iso_status iso_mask_reserve(iso_mask *mask, size_t cell, iso_error *error) {
    if (mask->cell[cell]) return ISO_OK;
    mask->cell[cell] = iso_alloc_zero(1, sizeof(iso_voxel_bits));
    if (!mask->cell[cell]) return iso_fail(error, ISO_ERR_NOMEM, "out of memory for the mask");
    mask->used++;
    return ISO_OK;
}

iso_status iso_mask_set(iso_mask *mask, size_t cell, const iso_voxel_bits *bits, iso_error *error) {
    if (!bits || !any_set(bits)) {
        mask->used -= mask->cell[cell] != NULL;
        iso_free(mask->cell[cell]);
        mask->cell[cell] = NULL;
        return ISO_OK;
    }
    ISO_TRY(iso_mask_reserve(mask, cell, error));
    *mask->cell[cell] = *bits;
    return ISO_OK;
}
