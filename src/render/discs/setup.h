/* setup: bounds that the method discs derives from view and blocks, shared by the cpu and the gl
 * engine. Internal to render. */
#ifndef ISO_RENDER_DISCS_SETUP_H
#define ISO_RENDER_DISCS_SETUP_H

#include "render/points/point_blocks.h"

/* How much longer the projection of a ball can be than at the optical axis, in the picture and `beyond`
 * pixels around it, because rays are oblique: a factor, with a margin for rounding. */
float iso_discs_slant(const iso_view *view, double beyond);

/* The largest projected radius of a block's discs, pixels. */
float iso_discs_largest_radius(const iso_point_block *block);

/* Whether flat discs of a block are filtered (ISO_DISCS_LOW_PASS). */
bool iso_discs_is_filtered(const iso_point_block *block);

/* Voxels per mm along the axis with the smallest spacing; `normal` of an iso_projector. */
float iso_discs_voxels_per_mm(const float normal[9]);

#endif
