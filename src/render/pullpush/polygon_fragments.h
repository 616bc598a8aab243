/* polygon_fragments: triangles in the base level of a pyramid. Internal to render. */
#ifndef ISO_RENDER_PULLPUSH_POLYGON_FRAGMENTS_H
#define ISO_RENDER_PULLPUSH_POLYGON_FRAGMENTS_H

#include "render/pullpush/kernel.h"
#include "render/pullpush/pullpush.h"
#include "render/view/project.h"

/* Which bricks are drawn as triangles: those whose cells can be larger than `pixels` in the picture. */
typedef struct iso_brick_choice {
    iso_projector projector;
    double cell, pixels; /* size of a cell, mm; of a pixel */
} iso_brick_choice;

bool iso_brick_is_large(const iso_brick_choice *choice, const int32_t brick[3]);

/* The bricks of a surface, parted by a choice. Views borrow the other arrays of those they were made of. */
typedef struct iso_hybrid_parts {
    iso_brick_choice choice;
    iso_point_view points; /* of small bricks */
    iso_mesh_view mesh;    /* of large bricks */
    iso_point_span *point_spans;
    iso_mesh_span *mesh_spans;
} iso_hybrid_parts;

/* pixels: a brick whose cells can be larger is drawn as triangles; 0: 3. ISO_ERR_NOMEM; free with
 * iso_hybrid_parts_free also then. */
iso_status iso_hybrid_parts_make(const iso_view *view, const iso_point_view *points,
                                 const iso_mesh_view *mesh, double pixels, iso_hybrid_parts *parts,
                                 iso_error *error);
void iso_hybrid_parts_free(iso_hybrid_parts *parts);

/* The inverse of a 3x3 matrix; false: it has none. (hybrid.c) */
bool iso_matrix_invert(const double m[9], double out[9]);

/* Triangles with one surface number. */
typedef struct iso_polygon_set {
    const iso_mesh_view *mesh;
    uint8_t surface;
    /* Of hybrid surfaces, whose triangles continue points: which bricks are points, the radius of the
     * points' discs, mm, and from view space to index coordinates, without the origin. `choice` NULL:
     * triangles alone. */
    const iso_brick_choice *choice;
    double radius, to_index[9];
} iso_polygon_set;

/* Zero-initialise `picture`; free it when done. */
typedef struct iso_polygons {
    const iso_polygon_set *sets;
    size_t count;
    iso_projector projector; /* of the index space in which keys have normals */
    float normal[9];         /* normals from view to that index space */
    iso_gbuffer picture;     /* the triangles in all of the pyramid */
} iso_polygons;

/* The view of all of level 0 of the pyramid of a strip. */
iso_view iso_pyramid_view(const iso_view *strip, const iso_pyramid_layout *layout);

/* Rasterizes the triangles into a picture as large as level 0 of the pyramid of `target`. ISO_ERR_NOMEM. */
iso_status iso_polygons_rasterize(iso_polygons *polygons, const iso_target *target,
                                  const iso_pyramid_layout *layout, iso_error *error);

/* Adds the triangles to rows of level 0: all of them, with radius and interval, in a pyramid with index;
 * in one without, which is of a hybrid surface alone, those at the seam, as if they were points. */
void iso_polygon_fragments_project(const iso_polygons *polygons, const iso_pyramid *pyramid, iso_rows rows);

/* Draws the triangles of a hybrid surface over its points, which `target` shows already: a sample is
 * replaced by the triangles' when that is nearer or, where it shows points of this surface, less than a
 * depth interval behind. */
void iso_polygons_draw(const iso_polygons *polygons, const iso_target *target,
                       const iso_pyramid_layout *layout);

/* Sets the planes that only a pyramid of several sets has, at a pixel that shows no ribbon and no colour.
 * `set`: as in ISO_PLANE_SET. */
void iso_set_planes_clear(const iso_pyramid_level *level, size_t at, int set);

/* Draws points and triangles in one pyramid (pullpush.c). `workspace` NULL: made for the call.
 * ISO_ERR_NOMEM. */
iso_status iso_draw_points_and_polygons(const iso_target *target, const iso_point_view *points,
                                        iso_polygons *polygons, iso_pullpush *workspace, iso_error *error);

#endif
