/* raycast: the reference renderer ("truth"), with which pictures of all methods are compared.
 *
 * For every sample it finds the first crossing of the isovalue by the trilinear field along the ray, from
 * either side, to 1e-4 voxel. The normal is the trilinear interpolation of the corners' central differences
 * (iso_grid_gradient), pointing out of the solid. Cells with a NaN or infinite corner are empty. The code is
 * simple rather than fast; src/exact draws the same surface fast. */
#ifndef ISO_TRUTH_RAYCAST_H
#define ISO_TRUTH_RAYCAST_H

#include "grids/grid.h"
#include "grids/spline/spline.h"
#include "render/raster/raster.h"

/* Knows which bricks of a grid the surface may cross, so that rays can skip the others. Borrows the grid. It
 * does not follow edits: after an edit, destroy it and create another one. */
typedef struct iso_raycaster iso_raycaster;

/* isovalue is physical (grids/grid.h). `pool` may be NULL. ISO_ERR_NOMEM. */
iso_status iso_raycaster_create(const iso_grid *grid, double isovalue, iso_pool *pool, iso_raycaster **caster,
                                iso_error *error);
/* The same of a spline, which is borrowed, with its grid: the truth of smooth surfaces. The normals are
 * those of the spline, or of scans those of the smoothed one (iso_spline_has_smoothed_normals). */
iso_status iso_raycaster_create_spline(const iso_spline *spline, double isovalue, iso_pool *pool,
                                       iso_raycaster **caster, iso_error *error);
void iso_raycaster_destroy(iso_raycaster *caster);

/* Draws into a gbuffer: replaces the samples that are farther than the surface. Cannot fail. */
iso_status iso_draw_raycast(const iso_target *target, const iso_raycaster *caster, iso_error *error);

#endif
