/* discs: draws points as second-order discs. Internal to render; called by iso_draw_point_surface
 * (render/point_surface.h).
 *
 * Pull-push averages points before it is known where rays meet the surface, which blurs it. Here every
 * point is a disc of its own: the part inside a ball of the quadric n.q + q.Sq / 2 = 0, where q is the
 * position relative to the point, n its normal and S its shape operator. (Guennebaud and Gross 2007 fit
 * algebraic spheres for the same purpose.) S is given a curvature along the normal as well, the largest
 * principal curvature if that is convex. Without it a disc would be a paraboloid and would not round off
 * at silhouettes; with it the disc of a point on a sphere is the sphere, and that of a point on a cylinder
 * the cylinder.
 *
 * At each pixel, the discs that the ray hits no more than 1.5 radii behind the nearest hit are averaged
 * with Gaussian weights. The depth is the mean of the hits'. The normal is the mean of the points' normals
 * plus the mean shape operator times the mean offset of the hit from the points: exact where normals
 * change linearly, and elsewhere an average that reduces noise. The second term is reduced the more the
 * discs' shape operators differ and the larger they are, because such curvature is probably noise.
 *
 * Where back-facing discs are drawn, their normals are flipped towards the eye, and they are never
 * averaged with front-facing ones: at silhouettes, where both are close together, the mean normal would
 * face the eye.
 *
 * The balls are spheres when voxels are cubes, else ellipsoids with the same number of voxels along every
 * axis. A disc is clipped at the border of the grid. Where the surface curves strongly, the disc is also
 * clipped to the extents of its point (iso_curvature), because the surface turns away within a voxel, and
 * discs that would be far from the surface are drawn smaller.
 *
 * What has been drawn into the gbuffer before hides discs too: hits more than 1.5 radii behind it are left
 * out. (Hits that are less far behind can be averaged with hits before it.)
 *
 * Blocks of points are drawn from front to back, and discs that are hidden by what has been drawn are
 * skipped. Small curved discs are intersected a vector of discs at a time, all others a vector of pixels
 * at a time (render/discs/kernel.h). */
#ifndef ISO_RENDER_DISCS_DISCS_H
#define ISO_RENDER_DISCS_DISCS_H

#include "render/points/point_blocks.h"
#include "render/points/reconstruction.h"
#include "render/raster/raster.h"

/* How flat discs are filtered and averaged. */
typedef enum iso_flat_disc_style {
    ISO_FLAT_DISCS_PLAIN, /* as above, without a filter */
    /* As above, with a low-pass filter against aliasing: a small disc also adds to pixels whose centres are
     * near its own (Botsch et al. 2005, section 4), but only to those that some disc covers, so that
     * silhouettes do not grow. Points with radii of their own, and overlapping ones (iso_point_view), are
     * drawn twice, fronts first: then the order of the discs does not matter. (So are points around the eye
     * by all styles but ONEPASS: the larger discs are, the more pixels show where their order does.) */
    ISO_FLAT_DISCS_FILTERED,
    /* Baerentzen and Christensen 2003, section 4.2: no filter; a disc is averaged with the first one of a
     * pixel, rejected behind it, or replaces what is there. */
    ISO_FLAT_DISCS_ONEPASS,
    /* EWA splatting (Zwicker et al. 2001): the ellipse of a disc is convolved with the low-pass filter, which
     * also decides which pixels it covers. Drawn in two passes, as in Guennebaud and Paulin 2003. */
    ISO_FLAT_DISCS_EWA,
    /* The high-quality shading of Schuetz, Kerbl and Wimmer 2021. No discs: a pixel is the mean of the points
     * with centres in it that are no more than 1.5 radii and 4 pixels behind the nearest of them, which a
     * first pass finds (in the paper: 1 % of its depth). For very many points in a pixel: where a pixel has
     * none there are holes, and outlines are up to half a pixel wider. */
    ISO_FLAT_DISCS_MEAN
} iso_flat_disc_style;

typedef struct iso_discs_opts {
    iso_flat_disc_style flat; /* for points without curvatures or with colours, whose discs are flat */
    bool
        draw_hidden; /* draw also the discs that are hidden by what has been drawn; the picture is the same */
    const iso_rgb *color; /* of all discs, for points without colours; NULL: none */
} iso_discs_opts;

/* Working memory, reused from one picture to the next. Zero-initialise; free with iso_discs_free. */
typedef struct iso_discs {
    iso_buffer corners, sorted, reached, order, start, memory, tallies;
    iso_selection_counts counts; /* of all calls */
} iso_discs;

/* Draws points into the gbuffer where they are nearer. `blocks`: made of the points for the target's view.
 * ISO_ERR_NOMEM. */
iso_status iso_discs_draw(iso_discs *workspace, const iso_target *target, const iso_point_view *points,
                          const iso_point_blocks *blocks, const iso_discs_opts *opts, iso_error *error);
void iso_discs_free(iso_discs *workspace);

#endif
