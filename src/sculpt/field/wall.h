/* wall: where a brush builds up against frozen voxels, or digs up to them.
 *
 * A frozen voxel stays on its side of the surface. Beside one that the brush has brought to the other side
 * the surface is cut off; what either held was the distance to something else, up to the band's end. Both
 * become what distances there can be: together no longer than the edge between them, the surface half-way
 * where neither is nearer. Internal to sculpt. */
#ifndef ISO_SCULPT_WALL_H
#define ISO_SCULPT_WALL_H

#include "sculpt/field/work.h"

/* Whether any voxel is frozen in the edited jobs' cells or in those around them. */
bool iso_wall_near(const iso_work *work);

/* After the brush, before redistancing: first the voxels that the brush changed, which are noted in
 * work->walls; then, when all cells around are jobs, the frozen ones beside them. Those between which and an
 * unchanged voxel the surface passes keep their value, to the bit. ISO_ERR_NOMEM. */
iso_status iso_wall_find(iso_work *work, iso_error *error);
void iso_wall_close(iso_work *work);

/* Voxels of a job whose distance what the brush changed can have changed: frozen ones beyond stay as they
 * are. */
void iso_wall_reach(const iso_work *work, const iso_job *job, iso_voxel_bits *reached);

#endif
