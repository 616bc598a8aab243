/* hollow: a solid as a wall of one thickness, with holes for what is left in it, for printing. */
#ifndef ISO_SCENE_HOLLOW_H
#define ISO_SCENE_HOLLOW_H

#include "base/parallel.h"
#include "grids/grid.h"

typedef struct iso_hollow_opts {
    double wall; /* its thickness, mm */
    double
        drain; /* diameter of the two holes, mm; 0: none. They lead along `up` from the lowest and the highest
                     place of the hollow out of the solid */
    iso_vec3 up;  /* a unit vector of the world */
    double voxel; /* of the level set, mm; 0: the least spacing of the grid, at most a third of the wall */
    iso_pool *pool;
} iso_hollow_opts;

/* Makes a level set, whose inside is what lies less than a wall's thickness inside the isosurface of a grid
 * (physical isovalue), by distances from the trilinear surface itself. Its own surface, at 0, is closed if
 * that of the grid is. ISO_ERR_EMPTY: there is no surface, or the solid is nowhere thicker than two walls;
 * ISO_ERR_LIMIT: it has more voxels along an axis than a level set can; ISO_ERR_NOMEM. */
iso_status iso_grid_hollow(const iso_grid *grid, double isovalue, const iso_hollow_opts *opts,
                           iso_hgrid **hollow, iso_error *error);

#endif
