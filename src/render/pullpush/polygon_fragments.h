/* polygon_fragments: triangles in the base level of a pyramid. Internal to render. */
#ifndef ISO_RENDER_PULLPUSH_POLYGON_FRAGMENTS_H
#define ISO_RENDER_PULLPUSH_POLYGON_FRAGMENTS_H

#include "render/project.h"
#include "render/pullpush/kernel.h"
#include "render/pullpush/pullpush.h"

/* Which bricks are drawn as triangles: those whose cells can be larger than `pixels` in the picture. */
typedef struct iso_brick_choice {
    iso_projector projector;
    double cell, pixels; /* size of a cell, mm; of a pixel */
} iso_brick_choice;

bool iso_brick_is_large(const iso_brick_choice *choice, const int32_t brick[3]);

/* Triangles of large bricks. Zero-initialise `picture`; free it when done. */
typedef struct iso_polygons {
    const iso_mesh_view *mesh; /* of these bricks only */
    iso_brick_choice choice;
    double radius;       /* of points' discs, mm */
    double to_index[9];  /* view space to index coordinates, without the origin */
    float normal[9];     /* normals from view to index space */
    iso_gbuffer picture; /* the triangles in all of the pyramid */
} iso_polygons;

/* Rasterizes the triangles into a picture as large as level 0 of the pyramid of `target`. ISO_ERR_NOMEM. */
iso_status iso_polygons_rasterize(iso_polygons *polygons, const iso_target *target,
                                  const iso_pyramid_layout *layout, iso_error *error);

/* Sets radius and interval of the points in rows of level 0, and adds the triangles. */
void iso_polygon_fragments_project(const iso_polygons *polygons, const iso_pyramid *pyramid, iso_rows rows);

/* Draws points and triangles in one pyramid (pullpush.c). `workspace` NULL: made for the call.
 * ISO_ERR_NOMEM. */
iso_status iso_draw_points_and_polygons(const iso_target *target, const iso_point_view *points,
                                        iso_polygons *polygons, iso_pullpush *workspace, iso_error *error);

#endif
