/* mask_rewrite: the mask that is left when the border of a mask is smoothed, or voxels are added to it.
 * Internal to sculpt. */
#ifndef ISO_SCULPT_EDIT_MASK_REWRITE_H
#define ISO_SCULPT_EDIT_MASK_REWRITE_H

#include "base/memory.h"
#include "grids/hgrid.h"
#include "sculpt/brush/voxel_set.h"
#include "sculpt/field/mask.h"

/* How far voxels count, at most. */
enum { ISO_MASK_BLUR_MOST = ISO_BRICK };

/* A cell with the bits that it gets. */
typedef struct iso_mask_cell {
    uint32_t cell;
    iso_voxel_bits bits;
} iso_mask_cell;

/* Freezes the voxels around which more is frozen than not, in a mean over the voxels less than reach + 1
 * voxels away along each axis, whose weights fall linearly from the middle; the border of the grid is
 * repeated beyond it. The arithmetic is that of integers. Lists the cells that change (iso_mask_cell;
 * grows the buffer) and adds to *looked_at how many were looked at. reach: 1 .. ISO_MASK_BLUR_MOST.
 * ISO_ERR_NOMEM. */
iso_status iso_mask_blur(const iso_mask *mask, const iso_hgrid *grid, int reach, iso_buffer *changed,
                         size_t *count, size_t *looked_at, iso_error *error);

/* Lists the cells that change when the voxels whose centres lie in a voxel of the set are frozen, in the same
 * way. */
iso_status iso_mask_add_voxels(const iso_mask *mask, const iso_hgrid *grid, const iso_voxel_set *set,
                               iso_buffer *changed, size_t *count, size_t *looked_at, iso_error *error);

#endif
