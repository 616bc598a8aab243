/* area_plane: the mean plane of the surface around a dab, which SCRAPE, FILL and CLAY work towards. A
 * sample's own position and normal are those of one voxel, which on a scan are mostly noise. Internal to
 * sculpt. */
#ifndef ISO_SCULPT_EDIT_AREA_PLANE_H
#define ISO_SCULPT_EDIT_AREA_PLANE_H

#include "grids/hgrid.h"
#include "sculpt/brush/dab.h"

/* Sets each dab's plane and normal to those of the plane that fits the surface best, by least squares:
 * heights above the dab are searched along its normal at 29 places within 0.7 radii. Nothing beyond the
 * radius is read. A dab around which the surface is found at fewer than 8 places stays as it is. */
void iso_area_planes(const iso_hgrid *grid, iso_dabs *dabs);

#endif
