/* point_surface: draws the surface between points, by any of the reconstructions: discs, or an image pyramid.
 */
#ifndef ISO_RENDER_POINT_SURFACE_H
#define ISO_RENDER_POINT_SURFACE_H

#include "render/points/reconstruction.h"
#include "render/pullpush/pullpush.h"
#include "render/raster/raster.h"

/* Working memory that is reused from one picture to the next. For one call at a time. */
typedef struct iso_point_workspace iso_point_workspace;

/* ISO_ERR_NOMEM. Destroy with iso_point_workspace_destroy, which takes NULL too. */
iso_status iso_point_workspace_create(iso_point_workspace **workspace, iso_error *error);
void iso_point_workspace_destroy(iso_point_workspace *workspace);

/* The part for iso_draw_pullpush and its like (lines, hybrid, several sets); owned by the workspace. NULL for
 * NULL. */
iso_pullpush *iso_point_workspace_pullpush(iso_point_workspace *workspace);

/* What has been selected for discs in all calls with this workspace. */
iso_selection_counts iso_point_workspace_counts(const iso_point_workspace *workspace);

/* Zero: curved discs. */
typedef struct iso_point_surface_opts {
    iso_reconstruction reconstruction;
    iso_point_workspace *workspace; /* borrowed; NULL: made for the call */
    iso_point_selection selection;  /* of discs */
    /* The colour of all discs, instead of the surface's and the points'; NULL: none. Of discs only. */
    const iso_rgb *color;
} iso_point_surface_opts;

/* Draws one surface into the gbuffer, as iso_draw_points does: a sample is replaced when the new depth is
 * smaller. The result has the same bytes for every instruction set and number of threads, and when the
 * picture is drawn in strips made by iso_view_rows. Points whose position is not finite, or whose normal is
 * zero, are left out. ISO_ERR_NOMEM. */
iso_status iso_draw_point_surface(const iso_target *target, const iso_point_view *points,
                                  const iso_point_surface_opts *opts, iso_error *error);

#endif
