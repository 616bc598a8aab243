/* mask_boundary: limits distances where a brush builds up against frozen voxels, or digs up to them.
 *
 * A frozen voxel stays on its side of the surface. When the brush carries the voxel beside it to the other
 * side, a new surface appears between the two, but their values are still distances to other parts of the
 * surface, up to the band. Both are reduced to distances that are possible there: their sum is at most the
 * length of the edge between them, and the surface lies half-way where neither was nearer. Internal to
 * sculpt. */
#ifndef ISO_SCULPT_EDIT_MASK_BOUNDARY_H
#define ISO_SCULPT_EDIT_MASK_BOUNDARY_H

#include "sculpt/edit/transaction.h"

/* Whether any voxel is frozen in the edited cells or in the cells around them. */
bool iso_mask_boundary_any_frozen(const iso_transaction *transaction);

/* Called after the brush and before redistancing, one after the other. The first limits voxels that the brush
 * changed and that have a frozen voxel across the surface, and remembers them in transaction->mask_boundaries
 * (ISO_ERR_NOMEM). The second limits these frozen voxels; by then all neighbouring cells must be listed in
 * the transaction. A frozen voxel with the surface between it and an unchanged voxel keeps its value, to the
 * bit. */
iso_status iso_mask_boundary_limit_changed(iso_transaction *transaction, iso_error *error);
void iso_mask_boundary_limit_frozen(iso_transaction *transaction);

/* Marks in `reached` the voxels of a cell within ISO_TRANSACTION_SPREAD voxels, along each axis, of a voxel
 * that the brush changed. Only the distances of these voxels can change. */
void iso_mask_boundary_influence(const iso_transaction *transaction, const iso_edit_cell *edit_cell,
                                 iso_voxel_bits *reached);

#endif
