/* curvature: the shape operator of the surface at extracted points, from the grid. Internal to extract.
 *
 * The shape operator of a level set is P H P / |g|, with g the gradient, H the Hessian and P the projection
 * onto the tangent plane (Goldman 2005, "Curvature formulas for implicit curves and surfaces"). At voxels, g
 * and H are central differences over the 18 nearest neighbours, which follow the curvature of the trilinear
 * surface; wider differences are smoother and lose thin features.
 *
 * The curvature of an edge point also uses the four points where the surface leaves the faces beside the edge
 * (again edge points). The quadric of the point (tilt and shape operator) is fitted to pass near these four
 * points, by least squares with Gaussian priors around the derivatives. The prior of the tilt comes from the
 * field's slope along the edge, where that contradicts the gradient over two voxels.
 *
 * Where a surface curves strongly within a voxel, as in noise and small parts, the quadric says little about
 * where the surface ends. The disc of such a point is compared with the field in the four cells around the
 * edge and shrunk until little of it lies outside the surface (iso_curvature.extents, bits 14-15).
 *
 * Beyond the grid's border, values are extrapolated linearly. Where a value that is needed is not finite, or
 * the gradient vanishes, a point is flat. */
#ifndef ISO_EXTRACT_POINTS_CURVATURE_H
#define ISO_EXTRACT_POINTS_CURVATURE_H

#include <stddef.h>

#include "base/primitives.h"
#include "extract/brick.h"
#include "grids/rgrid.h"

/* Where the voxels in and around a brick are read: in a dense array, or in a window of an hgrid. */
typedef struct iso_curvature_source {
    iso_type type;
    const void *data;                 /* the brick's voxel (0, 0, 0) */
    ptrdiff_t stride_y, stride_z;     /* elements */
    int first[3], last[3];            /* the grid's first and last voxel, relative to the brick's first */
    float normal_sign, isovalue_ceil; /* as in iso_threshold */
} iso_curvature_source;

/* The source for a brick of an rgrid, or for the brick of a window; grid and window are borrowed. */
iso_curvature_source iso_curvature_source_grid(const iso_rgrid *grid, const int brick[3],
                                               const iso_threshold *surface);
iso_curvature_source iso_curvature_source_window(const iso_brick_window *window,
                                                 const iso_threshold *surface);

/* The points of one brick; exactly one of the two arrays is set. */
typedef struct iso_curvature_points {
    const iso_point *packed;
    const iso_surfel *surfels;
    uint32_t count;
} iso_curvature_points;

/* Computes the curvatures of a brick's edge points, which must be sorted by the axis of their edges; g and H
 * are interpolated between the edge's ends. A curvature depends on the voxels up to one beyond both ends of
 * the edge and one to each side, as the point itself does. */
void iso_curvatures_of_edges(const iso_curvature_source *source, const iso_curvature_points *points,
                             iso_curvature *curvatures);

/* For each foot point its voxel, and the band of the field. */
typedef struct iso_curvature_feet {
    const int32_t *voxels;     /* by point: z << 8 | y << 4 | x */
    float isovalue_ceil, band; /* as in iso_foot_surface */
} iso_curvature_feet;

/* Computes the curvatures of foot points of a distance field: S (1 - d S)^-1, with S the shape operator of
 * the parallel surface through the voxel, at the distance d = value - isovalue (voxels). */
void iso_curvatures_of_feet(const iso_curvature_source *source, const iso_curvature_points *points,
                            const iso_curvature_feet *feet, iso_curvature *curvatures);

/* Computes the curvatures of points at any position in any scalar field: each gets the curvature at its
 * nearest voxel of `grid`. */
void iso_curvatures_of_nearest_voxels(const iso_grid *grid, const int brick[3], float normal_sign,
                                      const iso_curvature_points *points, iso_curvature *curvatures);

#endif
