/* normals: estimates normals of points from their neighbours, and turns them consistently. Internal. */
#ifndef ISO_CLOUDS_NORMALS_H
#define ISO_CLOUDS_NORMALS_H

#include "clouds/neighbours.h"

/* The neighbours of a point from which its normal and its radius are estimated. */
enum { ISO_CLOUD_NEIGHBOURS = 12 };

/* The neighbours of a point: ISO_CLOUD_NEIGHBOURS slots, nearest first. If there are fewer, the last one is
 * repeated; a single point is its own neighbour. */
typedef uint32_t iso_neighbour_row[ISO_CLOUD_NEIGHBOURS];

/* Sets the normals that are 0; the others are given and stay as they are. `normals`: by slot.
 *
 * A normal is the direction in which the neighbours of a point extend least (Hoppe et al. 1992, "Surface
 * reconstruction from unorganized points", section 3.1), or that of a quadratic function if one fits them
 * better (clouds/quadric.h). Its sign is propagated from neighbour to neighbour
 * along the most reliable pairs first, a minimum spanning tree (section 3.3), as follows: on a circular arc
 * through two points, the normal of one is the mirror image of the other's, so a pair is the more reliable
 * the more parallel one normal is to the mirror image of the other (Konig and Gumhold 2009, "Consistent
 * propagation of normal orientations in point clouds", section 3). Signs begin at the given normals; a set
 * of points that neighbours do not connect to them is turned so that its surface encloses a positive volume,
 * or, if it is open, so that most of it faces away from its centre.
 *
 * Results do not depend on the number of threads. ISO_ERR_NOMEM: the normals are not oriented. */
iso_status iso_normals_estimate(const iso_tree *tree, const iso_neighbour_row *neighbours,
                                float (*normals)[3], iso_pool *pool, iso_error *error);

#endif
