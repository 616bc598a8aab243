/* coloring: surfaces coloured by data: by a volume, by their curvature, by their distance from something, by
 * depth or by their normals. Every sample of a picture is coloured by the data at its own place, in double
 * precision, however fine the surface's own volume is. */
#ifndef ISO_SCENE_COLORING_H
#define ISO_SCENE_COLORING_H

#include "extract/mesh/mesh.h"
#include "grids/distance/distance.h"
#include "grids/grid.h"
#include "image/colormap.h"
#include "render/view/gbuffer.h"
#include "render/view/surface_colors.h"
#include "scene/surface.h"
#include "scene/vertex_field.h"

/* How a surface is coloured. */
typedef struct iso_coloring {
    iso_color_source source;
    iso_grid grid;                    /* BY_VOLUME: that volume; BY_CURVATURE: the surface's; borrowed */
    iso_affine affine;                /* of the grid: iso_coloring_set_grid */
    const iso_vertex_field *vertices; /* BY_VOLUME: numbers of a mesh's vertices instead; borrowed */
    const iso_distance *distance;     /* BY_DISTANCE; borrowed */
    iso_surface_colors given;         /* at != NULL: these colours instead, which are no numbers'; borrowed */
    iso_color_bar bar;                /* which colours stand for which numbers; not BY_NORMAL */
} iso_coloring;

/* Sets the grid with its transform. */
void iso_coloring_set_grid(iso_coloring *coloring, const iso_grid *grid);

/* The number at a point. NaN, which is coloured in the neutral gray of iso_color_bar_at: BY_NORMAL; where
 * the volume is not finite or a vertex has no number, and outside of the volume, which is beyond half a
 * voxel from its outermost voxels' centres. nearby: as iso_surface_colors.at. Thread-safe. */
double iso_coloring_number(const iso_coloring *coloring, const iso_colored_point *point, iso_nearby *nearby);

/* The colours of all points; borrows the coloring. */
iso_surface_colors iso_coloring_colors(const iso_coloring *coloring);

/* Gives the samples of a gbuffer that show a surface with a coloring its colours. colorings: by surface
 * number, NULL: none; count: of them. The same bytes with every number of threads. `pool` may be NULL.
 * ISO_ERR_NOMEM. */
iso_status iso_colorings_paint(const iso_coloring *const *colorings, int count, const iso_view *view,
                               iso_gbuffer *gbuffer, iso_pool *pool, iso_error *error);

/* Sets bar.low and bar.high from the numbers at some of a mesh's vertices, evenly many of all its parts:
 * from their 2nd to their 98th percentile; if the source's numbers are signed, as much on both sides of 0, or
 * from 0 on where all between these percentiles have one sign. Wherever the camera is, a surface so has the
 * same range; but BY_DEPTH it is that of the view (which may be NULL otherwise). *points: the number of these
 * vertices; *found: of those where there is a number; with none the range is 0 .. 1. BY_NORMAL nothing is
 * set. The same with every number of threads. `pool` may be NULL. ISO_ERR_NOMEM. */
iso_status iso_coloring_find_range(iso_coloring *coloring, const iso_mesh_view *mesh, const iso_view *view,
                                   iso_pool *pool, size_t *points, size_t *found, iso_error *error);

/* The same of a surface, by its mesh; one is made if it has none. Also the errors of iso_mesh_set_update. */
iso_status iso_coloring_find_surface_range(iso_coloring *coloring, const iso_scene_surface *surface,
                                           const iso_view *view, size_t *points, size_t *found,
                                           iso_error *error);

/* Gives the vertices of a welded mesh their colours (iso_weld.colors). Not BY_DEPTH. transform: of its index
 * coordinates. `pool` may be NULL. ISO_ERR_NOMEM. */
iso_status iso_coloring_weld(const iso_coloring *coloring, const iso_transform *transform, iso_pool *pool,
                             iso_weld *weld, iso_error *error);

/* The colours of points: *colors (iso_point_view.colors) is the caller's, iso_free. Not BY_DEPTH. `pool` may
 * be NULL. ISO_ERR_NOMEM. */
iso_status iso_coloring_points(const iso_coloring *coloring, const iso_point_view *points, iso_pool *pool,
                               uint8_t (**colors)[3], iso_error *error);

/* The colormap of a source that is given none: a two-sided one for signed numbers on both sides of 0. */
iso_colormap iso_coloring_usual_map(iso_color_source source, const iso_color_bar *bar);

/* Whether a source's numbers have a sign that matters: curvature and distance. */
static inline bool iso_color_source_is_signed(iso_color_source source) {
    return source == ISO_COLOR_BY_CURVATURE || source == ISO_COLOR_BY_DISTANCE;
}

#endif
