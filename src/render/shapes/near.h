/* near: shapes that are drawn one ray at a time in double precision: those that the near plane or the
 * eye's plane cuts, and those so large in the picture that floats are too coarse. Internal to shapes and
 * render/gl. */
#ifndef ISO_RENDER_SHAPES_NEAR_H
#define ISO_RENDER_SHAPES_NEAR_H

#include "render/shapes/frame.h"

/* A sphere (both ends are equal), a rounded cone, a bilinear patch, or a solid with its centre at the first
 * end. */
typedef struct iso_near_shape {
    double end[2][3], radius[2];  /* view space */
    double axis[3], length, sine; /* of a rounded cone: unit vector, mm, difference of the radii / length */
    bool holds;                   /* of a rounded cone: one sphere holds the other */
    double inverse[3][3];         /* of a solid's map: rows */
    double across[2][3];          /* of a ribbon: unit vectors in view space */
    double nearest;               /* no visible sample is nearer */
    uint32_t id;
    int flags; /* ISO_TUBE_... */
    iso_shape_kind kind;
} iso_near_shape;

struct iso_shapes_bin;

/* A ray in view space: origin + t * direction, t the depth. */
typedef struct iso_near_ray {
    double origin[3], direction[3];
} iso_near_ray;

/* Which surface of a shape bounds a piece. */
typedef enum iso_near_surface {
    ISO_NEAR_FIRST, /* the sphere around the first end */
    ISO_NEAR_LAST,
    ISO_NEAR_SIDE, /* the cone between both spheres */
    ISO_NEAR_FIRST_CUT,
    ISO_NEAR_LAST_CUT,
    ISO_NEAR_FINISHED /* of ribbons and solids; and of all shapes, when iso_near_finish has been called */
} iso_near_surface;

/* Where a ray enters and leaves a shape, with the outward normals there (of ribbons, those on the ray's
 * side), and how far along a segment that is, 0 to 1. Nothing is met when t[0] > t[1]. Normals, and how far,
 * are set by iso_near_finish, because most pieces are hidden or inside others. */
typedef struct iso_near_piece {
    double t[2], normal[2][3], along[2];
    iso_near_surface surface[2];
} iso_near_piece;

enum { ISO_NEAR_PIECES = 2 }; /* of a ray in one shape, at most: in an arrow */

/* The ray of the sample in column x and row y of the picture. */
iso_near_ray iso_near_ray_of(const iso_shapes_frame *frame, int x, int y);
/* The pieces of a ray in a shape, also those before the near plane; returns their number. The two places
 * where a ray meets a ribbon are the ends of one piece. */
int iso_near_pieces(const iso_shapes_frame *frame, const iso_near_shape *shape, const iso_near_ray *ray,
                    iso_near_piece pieces[ISO_NEAR_PIECES]);

/* Sets the normal at an end of a piece of the ray in the shape, and how far along the segment it is. */
void iso_near_finish(const iso_near_shape *shape, const iso_near_ray *ray, iso_near_piece *piece, int end);

/* Whether floats suffice for a shape whose points are at the depth `front` or farther, and which reaches
 * `reach` mm from its centre or axis. */
bool iso_near_fits(const iso_shapes_frame *frame, double front, double reach);

/* A depth that no visible sample of a shape which begins at `front` is nearer than, rounding included. */
double iso_near_nearest(const iso_shapes_frame *frame, double front);

iso_near_shape iso_near_sphere(const iso_shapes_frame *frame, const double centre[3], double radius,
                               uint32_t id);
/* A vertex of a line in view space, with the least width of lines. */
typedef struct iso_near_vertex {
    double position[3], radius;
    bool widened;
} iso_near_vertex;
iso_near_vertex iso_near_vertex_of(const iso_shapes_frame *frame, uint32_t vertex);
/* The segment from the vertex `id` to the next, given both. */
iso_near_shape iso_near_between(const iso_shapes_frame *frame, const iso_near_vertex *a,
                                const iso_near_vertex *b, uint32_t id, int flags);
/* The segment between the vertices `id` and `id` + 1. */
iso_near_shape iso_near_segment(const iso_shapes_frame *frame, uint32_t id, int flags);

/* Draws a shape into the bin and keeps it in bin->near, which must have room for it. */
void iso_near_draw(struct iso_shapes_bin *bin, const iso_near_shape *shape);
/* Writes the pixels that show one of the near shapes into the target's gbuffer, and counts them. */
void iso_near_resolve(struct iso_shapes_bin *bin);

#endif
