/* raycast: the truth. Every sample's ray is intersected with the trilinear field itself.
 *
 * The first crossing of the isovalue along the ray, from either side, found to 1e-4 voxel; the normal is the
 * trilinear interpolation of the corners' central differences (iso_grid_gradient), pointing out of the solid.
 * Cells with a NaN or infinite corner are empty. Deliberately simple: exact first, fast elsewhere. */
#ifndef ISO_TRUTH_RAYCAST_H
#define ISO_TRUTH_RAYCAST_H

#include "grids/grid.h"
#include "render/raster/raster.h"

#ifdef __cplusplus
extern "C" {
#endif

/* An index over a grid that lets rays skip bricks the surface does not cross. Borrows the grid; rebuilt by
 * the caller after edits. */
typedef struct iso_raycaster iso_raycaster;

/* isovalue is physical (grids/grid.h). ISO_ERR_NOMEM. */
iso_status iso_raycaster_create(const iso_grid *grid, double isovalue, iso_pool *pool, iso_raycaster **caster,
                                iso_error *error);
void iso_raycaster_destroy(iso_raycaster *caster);

/* Draws as iso_draw_points does: replaces samples that lie farther. */
iso_status iso_draw_raycast(const iso_target *target, const iso_raycaster *caster, iso_error *error);

#ifdef __cplusplus
}
#endif
#endif
