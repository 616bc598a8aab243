/* grid: one handle for either kind of grid, so that extraction, ray casting and programs need one code path.
 *
 * All values here are stored values unless they are called physical. Physical values are those of the file:
 * of an rgrid stored * scale + offset, of an hgrid, which stores distances in voxels, millimetres. */
#ifndef ISO_GRIDS_GRID_H
#define ISO_GRIDS_GRID_H

#include "grids/hgrid.h"
#include "grids/rgrid.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Exactly one of the two is set. Borrowed; small, passed by pointer. */
typedef struct iso_grid {
    iso_rgrid *rgrid;
    iso_hgrid *hgrid;
} iso_grid;

const int *iso_grid_dims(const iso_grid *grid); /* voxels, 3 */
const iso_transform *iso_grid_transform(const iso_grid *grid);
iso_change_log *iso_grid_log(const iso_grid *grid);
double iso_grid_stored(const iso_grid *grid, double physical); /* the stored isovalue for a physical one */
double iso_grid_physical(const iso_grid *grid, double stored);
/* Physical value of one stored unit: an rgrid's scale, an hgrid's voxel size (the same on every axis), mm. */
double iso_grid_scale(const iso_grid *grid);
int iso_grid_is_level_set(const iso_grid *grid);           /* negative inside: always for an hgrid */
void iso_grid_bricks(const iso_grid *grid, int bricks[3]); /* ceil(dims / 16) */
void iso_grid_destroy(iso_grid *grid);                     /* destroys whichever is set and clears both */

/* A grid of its own with the same values: a dense one contiguous and without an index, a sparse one with the
 * same cells. `pool` may be NULL. ISO_ERR_NOMEM. */
struct iso_pool;
iso_status iso_grid_copy(const iso_grid *from, struct iso_pool *pool, iso_grid *copy, iso_error *error);

/* Stored value at a voxel; coordinates outside are clamped. */
float iso_grid_at(const iso_grid *grid, int x, int y, int z);

/* A box of voxels copied to floats: what per-brick work reads. Side 19: voxels 16 * brick - 1 .. 16 * brick +
 * 17, at
 * [(z * 19 + y) * 19 + x]. Outside the grid, the clamped voxel. */
enum {
    ISO_WINDOW_LOW = 1,
    ISO_WINDOW = ISO_BRICK + 3,
    ISO_WINDOW_VOXELS = ISO_WINDOW * ISO_WINDOW * ISO_WINDOW
};

/* Fills `window` for a brick of the grid. */
void iso_grid_window(const iso_grid *grid, const int brick[3], float window[ISO_WINDOW_VOXELS]);

/* Whether any two finite voxels among 16*brick .. 16*brick+16 (clipped to the grid) lie on different sides of
 * the stored isovalue, "at or above" being one side. May answer 1 when unsure, never 0 wrongly. Much faster
 * than a window. */
int iso_grid_brick_may_cross(const iso_grid *grid, const int brick[3], float isovalue);

/* Trilinear value at index position p (clamped to the grid), in double. NaN when a corner is not finite. */
double iso_grid_sample(const iso_grid *grid, iso_vec3 p);

/* Gradient at a voxel, stored value per voxel: central differences, one-sided at the border, 0 along an axis
 * of one voxel. A non-finite neighbour counts as missing (one-sided then, or 0). The voxel must be inside. */
iso_vec3 iso_grid_voxel_gradient(const iso_grid *grid, int x, int y, int z);

/* Trilinear interpolation of the eight corners' voxel gradients at index position p (clamped to the grid). */
iso_vec3 iso_grid_gradient(const iso_grid *grid, iso_vec3 p);

/* Number of voxels that are NaN or infinite (0 for hgrids and integer types). `pool` may be NULL. */
size_t iso_grid_count_nonfinite(const iso_grid *grid, struct iso_pool *pool);

#ifdef __cplusplus
}
#endif
#endif
