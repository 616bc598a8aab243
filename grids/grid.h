/* grid: one handle for both kinds of grid, with sampling and gradients, so that extraction, ray casting and
 * programs need one code path.
 *
 * Values are stored values unless they are called physical. Physical values are those of the file: for an
 * rgrid stored * scale + offset, for an hgrid, which stores distances in voxels, millimetres. */
#ifndef ISO_GRIDS_GRID_H
#define ISO_GRIDS_GRID_H

#include "base/c_linkage.h"
#include "grids/hgrid.h"
#include "grids/rgrid.h"

ISO_C_BEGIN

/* Exactly one of the two pointers is set. */
typedef struct iso_grid {
    iso_rgrid *rgrid;
    iso_hgrid *hgrid;
} iso_grid;

const int *iso_grid_dims(const iso_grid *grid); /* voxels along x, y, z */
const iso_transform *iso_grid_transform(const iso_grid *grid);
iso_change_log *iso_grid_log(const iso_grid *grid);
double iso_grid_stored(const iso_grid *grid, double physical); /* the stored value of a physical one */
double iso_grid_physical(const iso_grid *grid, double stored);
/* Returns the physical value of one stored unit: the scale of an rgrid, the voxel size of an hgrid in mm. */
double iso_grid_scale(const iso_grid *grid);
int iso_grid_is_level_set(const iso_grid *grid); /* inside is below the isovalue; always for an hgrid */
void iso_grid_bricks(const iso_grid *grid, int bricks[3]); /* ceil(dims / 16) */
void iso_grid_destroy(iso_grid *grid); /* destroys the grid that is set and clears both pointers */

/* Copies a grid. The copy of a dense grid has contiguous memory and no index. `pool` may be NULL.
 * ISO_ERR_NOMEM. */
struct iso_pool;
iso_status iso_grid_copy(const iso_grid *from, struct iso_pool *pool, iso_grid *copy, iso_error *error);

/* Returns the stored value of a voxel; coordinates outside the grid are clamped to it. */
float iso_grid_at(const iso_grid *grid, int x, int y, int z);

/* A window: a brick and its surroundings as floats, 19^3 voxels from 16 * brick - 1 to 16 * brick + 17, at
 * [(z * 19 + y) * 19 + x]. Beyond the grid its outermost voxels are repeated. */
enum {
    ISO_WINDOW_LOW = 1,
    ISO_WINDOW = ISO_BRICK + 3,
    ISO_WINDOW_VOXELS = ISO_WINDOW * ISO_WINDOW * ISO_WINDOW
};

/* Fills the window of a brick. */
void iso_grid_window(const iso_grid *grid, const int brick[3], float window[ISO_WINDOW_VOXELS]);

/* Whether finite voxels among 16*brick .. 16*brick+16 (clipped to the grid) may lie on both sides of the
 * stored isovalue: below it, and at or above it. Never 0 if they do. Much faster than filling a window; a
 * current index of the grid is used if there is one. */
int iso_grid_brick_may_cross(const iso_grid *grid, const int brick[3], float isovalue);

/* Returns the trilinear interpolation at a position in index coordinates (clamped to the grid), a stored
 * value. NaN: a corner is not finite. */
double iso_grid_sample(const iso_grid *grid, iso_vec3 p);

/* The same, and how the interpolation changes along each axis there, stored values a voxel; 0 along an axis
 * with one voxel. */
double iso_grid_sample_slope(const iso_grid *grid, iso_vec3 p, iso_vec3 *slope);

/* Returns the gradient at a voxel inside the grid, in stored values per voxel: central differences, one-sided
 * at the border, 0 along an axis of one voxel. Neighbours that are not finite count as missing. */
iso_vec3 iso_grid_voxel_gradient(const iso_grid *grid, int x, int y, int z);

/* Returns the trilinear interpolation of the gradients at the eight voxels around a position in index
 * coordinates (clamped to the grid). */
iso_vec3 iso_grid_gradient(const iso_grid *grid, iso_vec3 p);

/* Returns the number of voxels that are NaN or infinite (0 for hgrids and integer types). With a current
 * index, only bricks that have such voxels are read. `pool` may be NULL. */
size_t iso_grid_count_nonfinite(const iso_grid *grid, struct iso_pool *pool);

ISO_C_END
#endif
