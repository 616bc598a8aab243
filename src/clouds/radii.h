/* radii: estimates radii of points from the distances to their neighbours. Internal. */
#ifndef ISO_CLOUDS_RADII_H
#define ISO_CLOUDS_RADII_H

#include "clouds/normals.h"

/* The radius of a point in distances to its sixth nearest neighbour: the discs that renderers draw, of 1.35
 * radii, then leave about one in a thousand pixels of a surface with randomly placed points empty. */
#define ISO_CLOUD_RADIUS 0.8f

/* Sets radii[slot] of all slots: ISO_CLOUD_RADIUS times the median, over the point and its neighbours, of the
 * distance to the sixth nearest neighbour. A single point far from the others therefore gets a radius like
 * theirs. 0 where six neighbours are at the same place. The unit is that of positions. ISO_ERR_NOMEM. */
iso_status iso_radii_estimate(const iso_tree *tree, const iso_neighbour_row *neighbours, float *radii,
                              iso_pool *pool, iso_error *error);

#endif
