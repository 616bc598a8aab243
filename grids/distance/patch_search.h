/* patch_search: the distance of the isosurface of a grid from points. Internal to grids/distance. */
#ifndef ISO_GRIDS_DISTANCE_PATCH_SEARCH_H
#define ISO_GRIDS_DISTANCE_PATCH_SEARCH_H

#include "base/nearby.h"
#include "grids/distance/patch_tree.h"

/* The distance, mm, of the surface from p, which is relative to the grid's origin. It does
 * not depend on *nearby but for rounding. Thread-safe. */
double iso_patch_search(const iso_patch_tree *tree, iso_vec3 p, iso_nearby *nearby);

#endif
