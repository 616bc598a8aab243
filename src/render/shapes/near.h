/* near: shapes that are drawn one ray at a time in double precision: those that the near plane or the
 * eye's plane cuts, and those so large in the picture that floats are too coarse. Internal to shapes and
 * render/gl. */
#ifndef ISO_RENDER_SHAPES_NEAR_H
#define ISO_RENDER_SHAPES_NEAR_H

#include "render/shapes/frame.h"

/* A sphere (both ends are equal), a rounded cone, a bilinear patch, or a solid with its centre at the first
 * end. */
typedef struct iso_near_shape {
    double end[2][3], radius[2]; /* view space */
    double inverse[3][3];        /* of a solid's map: rows */
    double across[2][3];         /* of a ribbon: unit vectors in view space */
    double nearest;              /* no visible sample is nearer */
    uint32_t id;
    int flags; /* ISO_TUBE_... */
    iso_shape_kind kind;
} iso_near_shape;

struct iso_shapes_bin;

/* A ray in view space: origin + t * direction, t the depth. */
typedef struct iso_near_ray {
    double origin[3], direction[3];
} iso_near_ray;

/* Where a ray enters and leaves a shape, with the outward normals there (of ribbons, those on the ray's
 * side), and how far along a segment that is, 0 to 1. Nothing is met when t[0] > t[1]. */
typedef struct iso_near_piece {
    double t[2], normal[2][3], along[2];
} iso_near_piece;

enum { ISO_NEAR_PIECES = 2 }; /* of a ray in one shape, at most: in an arrow */

/* The ray of the sample in column x and row y of the picture. */
iso_near_ray iso_near_ray_of(const iso_shapes_frame *frame, int x, int y);
/* The pieces of a ray in a shape, also those before the near plane; returns their number. The two places
 * where a ray meets a ribbon are the ends of one piece. */
int iso_near_pieces(const iso_shapes_frame *frame, const iso_near_shape *shape, const iso_near_ray *ray,
                    iso_near_piece pieces[ISO_NEAR_PIECES]);

/* Whether floats suffice for a shape whose points are at the depth `front` or farther, and which reaches
 * `reach` mm from its centre or axis. */
bool iso_near_fits(const iso_shapes_frame *frame, double front, double reach);

iso_near_shape iso_near_sphere(const iso_shapes_frame *frame, const double centre[3], double radius,
                               uint32_t id);
/* The segment between the vertices `id` and `id` + 1, with the least width of lines. */
iso_near_shape iso_near_segment(const iso_shapes_frame *frame, uint32_t id, int flags);

/* Draws a shape into the bin and keeps it in bin->near, which must have room for it. */
void iso_near_draw(struct iso_shapes_bin *bin, const iso_near_shape *shape);
/* Writes the pixels that show one of the near shapes into the target's gbuffer, and counts them. */
void iso_near_resolve(struct iso_shapes_bin *bin);

#endif
