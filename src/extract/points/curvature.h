/* shape: how the surface bends at extracted points, from the grid. Internal to extract.
 *
 * The shape operator of a level set is P H P / |g|, with g the gradient, H the Hessian and P the projection
 * onto the tangent plane (Goldman 2005, "Curvature formulas for implicit curves and surfaces"). At voxels, g
 * and H are central differences over their 18 nearest neighbours, which is what the trilinear surface itself
 * bends like; wider ones are smoother and lose thin things.
 *
 * Edge points know more: where the surface leaves the four faces around their edge, which is where it is an
 * edge point again. Shapes are moved to pass near these places, as little as they need to be (least squares
 * with Gaussian priors), and so is the direction that the surface is said to have, its tilt. That begins
 * where the field's slope along the edge itself has it, if the gradient over two voxels says something else.
 *
 * Where surfaces bend within a voxel, as noise and small things do, a quadric says little about where they
 * end: discs are held against the field in the four cells around their edge, and do with as much less of
 * their size as keeps them from reaching far outside it.
 *
 * Beyond the grid's border values go on linearly; where a value that is needed is not finite, or the gradient
 * vanishes, a point is flat. */
#ifndef ISO_EXTRACT_POINTS_CURVATURE_H
#define ISO_EXTRACT_POINTS_CURVATURE_H

#include <stddef.h>

#include "base/primitives.h"
#include "extract/brick.h"
#include "grids/rgrid.h"

/* Where values come from: a dense array, or a window of an hgrid. */
typedef struct iso_curvature_source {
    iso_type type;
    const void *data;                 /* of the brick's voxel (0, 0, 0) */
    ptrdiff_t stride_y, stride_z;     /* elements */
    int first[3], last[3];            /* the grid's first and last voxel, counted from there */
    float normal_sign, isovalue_ceil; /* as in iso_threshold */
} iso_curvature_source;

iso_curvature_source iso_curvature_source_grid(const iso_rgrid *grid, const int brick[3],
                                               const iso_threshold *surface);
iso_curvature_source iso_curvature_source_window(const iso_brick_window *window,
                                                 const iso_threshold *surface);

/* Points of one brick; one of the two arrays. */
typedef struct iso_curvature_points {
    const iso_point *packed;
    const iso_surfel *surfels;
    uint32_t count;
} iso_curvature_points;

/* Shapes and ends of a brick's edge points, which come axis by axis: g and H interpolated between the edge's
 * ends. Reads one voxel beyond both ends along the edge, and one to each side: no more than the points
 * themselves. */
void iso_curvatures_of_edges(const iso_curvature_source *source, const iso_curvature_points *points,
                             iso_curvature *curvatures);

/* Where foot points come from. */
typedef struct iso_curvature_feet {
    const int32_t *voxels;     /* z << 8 | y << 4 | x */
    float isovalue_ceil, band; /* as in iso_foot_surface */
} iso_curvature_feet;

/* Shapes of foot points of a distance field: those of the parallel surfaces through their voxels, which lie d
 * = value - at off the surface, taken back to it: S (1 - d S)^-1. */
void iso_curvatures_of_feet(const iso_curvature_source *source, const iso_curvature_points *points,
                            const iso_curvature_feet *feet, iso_curvature *curvatures);

/* Shapes of points anywhere in any scalar field: those at the nearest voxels of `grid`. */
void iso_curvatures_of_nearest_voxels(const iso_grid *grid, const int brick[3], float normal_sign,
                                      const iso_curvature_points *points, iso_curvature *curvatures);

#endif
