/* pullpush: draws points by projecting each to a single pixel and reconstructing the surface between them in
 * image space (Marroquim, Kraus and Cavalcanti 2008, section 3), on the cpu, fast enough for interaction.
 *
 * A point is stored in the pixel that contains its centre, with its normal and its radius. Pull averages,
 * level by level, the pixels that lie less than a radius behind the frontmost one into a coarser pixel: of
 * these, if the ellipses of some contain its centre, only those. Push goes from coarse to fine: a pixel
 * without a point, or with a point behind the surface, gets the weighted mean of those of the four coarser
 * pixels around it whose ellipses contain its centre; the weights fall to nothing at the ellipse's edge. A
 * pixel's ellipse is the projection of a disc with the pixel's normal and radius, low-pass filtered (Zwicker
 * et al. 2001). Points outside the picture take part when their discs reach into it.
 *
 * Beyond the paper: depths are compared where the discs' planes meet a pixel's ray, instead of by intervals
 * that hold all averaged ones; the ellipse test of pull is made with ellipses half a coarser pixel wider, and
 * not into level 1, because without that front surfaces lose thin discs; discs end at the grid's border; and
 * gaps between ellipses, with values all around, are filled (gaps_simd.h). In the picture, samples in gaps,
 * and those beside the disc of their own pixel's point, need a point whose disc contains them, and samples
 * without a value beside the surface show the nearest disc that they meet (rims; finish_simd.h). Line
 * fragments and several sets in one pyramid keep the paper's intervals, have no ellipse test in pull, and
 * gaps are not filled.
 *
 * Back-facing points are left out when the set is closed and the eye is outside the box around it.
 * Otherwise they are drawn too; their normals are not flipped and point out of the solid. */
#ifndef ISO_RENDER_PULLPUSH_PULLPUSH_H
#define ISO_RENDER_PULLPUSH_PULLPUSH_H

#include "render/points/reconstruction.h"
#include "render/raster/raster.h"

/* Working memory that is reused from one picture to the next. For one call at a time. */
typedef struct iso_pullpush iso_pullpush;

/* ISO_ERR_NOMEM. Destroy with iso_pullpush_destroy, which takes NULL too. */
iso_status iso_pullpush_create(iso_pullpush **pullpush, iso_error *error);
void iso_pullpush_destroy(iso_pullpush *pullpush);

typedef struct iso_pullpush_opts {
    iso_reconstruction reconstruction; /* BOX or GAUSSIAN */
    iso_pullpush *workspace;           /* borrowed; NULL: made for the call */
} iso_pullpush_opts;

/* Draws one surface into the gbuffer, as iso_draw_points does: a sample is replaced when the new depth is
 * smaller. The result has the same bytes for every instruction set and number of threads, and when the
 * picture is drawn in strips made by iso_view_rows. Points whose position is not finite, or whose normal is
 * zero, are left out. ISO_ERR_NOMEM. */
iso_status iso_draw_pullpush(const iso_target *target, const iso_point_view *points,
                             const iso_pullpush_opts *opts, iso_error *error);

#endif
