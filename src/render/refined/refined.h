/* refined: a surface from points as second-order discs. Internal to render; render/pullpush/pullpush.h has
 * the face.
 *
 * What pull-push costs pictures is that it averages points before it asks where the surface is. Here each
 * point is a disc of its own: the quadric n.q + q.Sq / 2 = 0 around it, q from the point, with S its shape
 * operator (Guennebaud and Gross 2007 fit spheres to like purpose), within a ball. So that discs round off
 * at silhouettes as the surface does, instead of running on as paraboloids, S gets a curvature along the
 * normal as well: the largest principal one where that is convex. A sphere's disc is then the sphere, a
 * cylinder's the cylinder.
 *
 * A pixel's ray meets the discs around it. Those within 1.5 radii behind the front are averaged with Gaussian
 * weights: depth from where the ray meets each; the normal is the mean of the discs' plus the mean shape
 * operator times the mean offset, which is exact where normals change linearly and averages noise elsewhere.
 *
 * Mean shapes count the less the more those of the discs differ, and the more they bend, which is noise.
 * Discs that face away and were turned never mix with others: at silhouettes, where both sides come together,
 * the mean would face the eye.
 *
 * Balls are round where voxels are cubes, and reach as many voxels along every axis elsewhere.
 *
 * A surface ends at its grid's border, and where it bends much it turns away within a voxel: there, discs end
 * at the border and where the surface comes to the next edge of the cells around (iso_curvature's ends).
 * Discs that would be far off the surface there are smaller.
 *
 * Blocks come from front to back; discs that lie behind all that is drawn around them are left out. Small
 * discs are measured a vector at a time, larger ones splatted one by one (render/refined/kernel.h). */
#ifndef ISO_RENDER_REFINED_REFINED_H
#define ISO_RENDER_REFINED_REFINED_H

#include "render/point_blocks.h"
#include "render/raster/raster.h"

/* Zero-initialise. */
typedef struct iso_refined {
    iso_buffer corners, sorted, reached, order, start, memory;
} iso_refined;

/* Draws points whose blocks have been made for this view. ISO_ERR_NOMEM. */
iso_status iso_refined_draw(iso_refined *workspace, const iso_target *target, const iso_point_view *points,
                            const iso_point_blocks *blocks, iso_error *error);
void iso_refined_free(iso_refined *workspace);

#endif
