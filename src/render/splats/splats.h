/* splats: draws points as flat discs with smooth weights, in one pass: deferred blending (Zhang and Pajarola
 * 2006, sections 3.2 and 5.1).
 *
 * Discs that overlap belong to one surface, and their depths and normals are to be averaged; discs far
 * behind the front must not take part. Usually the front is found first, in a pass of its own. Here the
 * points are divided into groups whose discs do not overlap (base/groups.h), and each pixel has a slot for
 * every group. A slot keeps one disc: the smallest of all keys, which are made of a depth and the disc's
 * number. When all discs are drawn, a pixel's slots hold all discs of its front layer, which are intersected
 * again, exactly, and averaged.
 *
 * Two discs of one group can cover a pixel, for they lie in different layers, or overlap all the same
 * because the number of groups is limited. Of overlapping ones the disc whose centre is nearer shall win, as
 * in a Voronoi diagram (section 5.1): a key is the depth plus 1.5 radii times e, where e is 0 at the disc's
 * centre and 1 at its rim. The paper's keys (eq. 6 and 10) divide the depths of the whole scene into bins,
 * and order discs by their centres in each bin; `bins` chooses them. They cut layers along the bins'
 * borders.
 *
 * The average: of the discs of a pixel those with the side (front- or back-facing) of the nearest one, and
 * not farther behind it than 1.5 radii of their points, with weights exp(-3 e). */
#ifndef ISO_RENDER_SPLATS_SPLATS_H
#define ISO_RENDER_SPLATS_SPLATS_H

#include "base/groups.h"
#include "render/raster/raster.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Radius of a disc in radii of its point: about the smallest that leaves no holes between extracted
 * points. */
#define ISO_SPLATS_DISC 1.35f
/* How far a layer of the surface reaches behind its front, in radii of points. */
#define ISO_SPLATS_THICKNESS 1.5f
/* The number of groups when none is asked for: eight slots of a pixel are a line of the cache. */
enum { ISO_SPLATS_GROUPS = 8 };

typedef struct iso_splats_opts {
    const iso_groups *groups; /* of the points, with discs of ISO_SPLATS_DISC; NULL: made for the call */
    int bins;                 /* n of eq. 6, up to 2^20; 0: none */
} iso_splats_opts;

/* The options for iso_groups_make that splats are drawn with when none are given. */
iso_groups_opts iso_splats_grouping(iso_pool *pool);

/* Draws one surface into the gbuffer, as iso_draw_points does: a sample is replaced when the new depth is
 * smaller. The result has the same bytes for every number of threads, and when the picture is drawn in
 * strips made by iso_view_rows. Points that face away are left out when the set is closed and the eye is
 * outside the box around it. Points whose position is not finite or whose radius is not above 0 are left
 * out. `opts` NULL: defaults. ISO_ERR_NOMEM; ISO_ERR_LIMIT: 2^32 - 1 points or more. */
iso_status iso_draw_splats(const iso_target *target, const iso_point_view *points,
                           const iso_splats_opts *opts, iso_error *error);

#ifdef __cplusplus
}
#endif
#endif
