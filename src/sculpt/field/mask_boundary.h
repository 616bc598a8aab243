/* wall: where a brush builds up against frozen voxels, or digs up to them.
 *
 * A frozen voxel stays on its side of the surface. Beside one that the brush has brought to the other side
 * the surface is cut off; what either held was the distance to something else, up to the band's end. Both
 * become what distances there can be: together no longer than the edge between them, the surface half-way
 * where neither is nearer. Internal to sculpt. */
#ifndef ISO_SCULPT_FIELD_MASK_BOUNDARY_H
#define ISO_SCULPT_FIELD_MASK_BOUNDARY_H

#include "sculpt/field/transaction.h"

/* Whether any voxel is frozen in the edited jobs' cells or in those around them. */
bool iso_mask_boundary_near(const iso_transaction *transaction);

/* After the brush, before redistancing: first the voxels that the brush changed, which are noted in
 * work->walls; then, when all cells around are jobs, the frozen ones beside them. Those between which and an
 * unchanged voxel the surface passes keep their value, to the bit. ISO_ERR_NOMEM. */
iso_status iso_mask_boundary_find(iso_transaction *transaction, iso_error *error);
void iso_mask_boundary_close(iso_transaction *transaction);

/* Voxels of a job whose distance what the brush changed can have changed: frozen ones beyond stay as they
 * are. */
void iso_mask_boundary_influence(const iso_transaction *transaction, const iso_edit_cell *edit_cell,
                                 iso_voxel_bits *reached);

#endif
