/* groups: draws points as flat discs with smooth weights, in one pass: deferred blending (Zhang and Pajarola
 * 2006, sections 3.2 and 5.1).
 *
 * Discs that overlap belong to one layer of the surface; their depths and normals are averaged, and discs far
 * behind the front are excluded. Other methods find the front in a separate pass. Here the points are divided
 * into groups whose discs do not overlap (render/groups/grouping.h), and each pixel has a slot for every
 * group. A slot keeps one disc, that with the smallest key; a key consists of a depth and the disc's number.
 * When all discs are drawn, a pixel's slots contain all discs of its front layer, which are intersected
 * again, exactly, and averaged.
 *
 * Two discs of one group can cover the same pixel if they are in different layers, or if they overlap because
 * the number of groups is limited. Of overlapping discs the one whose centre is nearer should be kept, as in
 * a Voronoi diagram (section 5.1): the key is therefore the depth plus 1.5 radii times e, where e is 0 at the
 * disc's centre and 1 at its rim. The paper's keys (eq. 6 and 10), which the option `bins` selects, divide
 * the depths of the whole scene into bins and order discs by their centres in each bin; layers are then cut
 * at the borders of bins.
 *
 * The average is taken over the discs of a pixel that have the side (front- or back-facing) of the nearest
 * one and are at most 1.5 radii of their points behind it, with weights exp(-3 e). */
#ifndef ISO_RENDER_GROUPS_GROUPS_H
#define ISO_RENDER_GROUPS_GROUPS_H

#include "render/groups/grouping.h"
#include "render/raster/raster.h"

/* Radius of a disc in radii of its point: about the smallest that leaves no holes between extracted
 * points. */
#define ISO_GROUPS_DISC 1.35f
/* Thickness of a layer of the surface, measured from its front, in radii of points. */
#define ISO_GROUPS_THICKNESS 1.5f
/* The default number of groups; eight slots of a pixel fill a cache line. */
enum { ISO_GROUPS_DEFAULT = 8 };

typedef struct iso_draw_groups_opts {
    const iso_groups
        *groups; /* groups of the points, with discs of ISO_GROUPS_DISC; NULL: made for this call */
    int bins;    /* n of eq. 6, up to 2^20; 0: no bins */
} iso_draw_groups_opts;

/* Returns the default options of iso_groups_make for splats. */
iso_groups_opts iso_groups_default_opts(iso_pool *pool);

/* Draws one surface into the gbuffer, as iso_draw_points does: a sample is replaced when the new depth is
 * smaller. The result has the same bytes for every number of threads, and when the picture is drawn in
 * strips made by iso_view_rows. Points that face away are left out when the set is closed and the eye is
 * outside the box around it. Points whose position is not finite or whose radius is not above 0 are left
 * out. `opts` NULL: defaults. ISO_ERR_NOMEM; ISO_ERR_LIMIT: 2^32 - 1 points or more. */
iso_status iso_draw_groups(const iso_target *target, const iso_point_view *points,
                           const iso_draw_groups_opts *opts, iso_error *error);

#endif
