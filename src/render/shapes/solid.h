/* solid: glyphs other than spheres: what a glyph's numbers mean, and its place in a picture. Internal to
 * shapes.
 *
 * Every such glyph is the image of a unit solid under an affine map. In the unit solid's coordinates: the
 * ellipsoid is |p| <= 1; the box |x|, |y|, |z| <= 1; the cylinder x^2 + y^2 <= 1, |z| <= 1; the cone has its
 * base, of radius 1, at z = -1 and its apex at z = 1; the arrow is a cylinder and a cone; the disc is
 * x^2 + y^2 <= 1, z = 0. */
#ifndef ISO_RENDER_SHAPES_SOLID_H
#define ISO_RENDER_SHAPES_SOLID_H

#include "render/shapes/kernel.h"

/* The arrow's shaft ends and its head begins at this z; the shaft's radius. As vtkArrowSource has them. */
#define ISO_ARROW_NECK 0.3
#define ISO_ARROW_SHAFT 0.3

/* Whether the glyph has a direction: it is round about it. */
static inline bool iso_solid_is_directed(iso_glyph glyph) {
    return glyph == ISO_GLYPH_CONE || glyph == ISO_GLYPH_CYLINDER || glyph == ISO_GLYPH_ARROW ||
           glyph == ISO_GLYPH_DISC;
}

/* The radius of directed glyphs that have none, as a part of their length. */
static inline double iso_solid_slimness(iso_glyph glyph) {
    return glyph == ISO_GLYPH_CONE ? 1.0 / 3 : 0.1;
}

/* How far a glyph reaches from its position, mm, or 0 when it cannot be drawn. For spheres: the radius. */
double iso_solid_reach(const iso_shapes *shapes, uint32_t id);

/* Adds a glyph to the bin's chunk, or draws it in double precision. `place`: in the order of blocks. */
void iso_solid_add(iso_shapes_bin *bin, const iso_shapes_block *block, uint32_t place);

/* What rays in double precision meet of a glyph other than a sphere, and the samples of `limit` that can see
 * it; false when there are none. *billboard: whether it is one, which is met by rays that are
 * parallel to that of its centre. */
bool iso_solid_place(const iso_shapes_frame *frame, const iso_shapes_block *block, uint32_t place,
                     const iso_shapes_rect *limit, iso_near_shape *shape, iso_shapes_rect *rect,
                     bool *billboard);
/* The same of what lies in the convex hull of two spheres, the ends of the shape. */
bool iso_solid_place_hull(const iso_shapes_frame *frame, const iso_near_shape *shape,
                          const iso_shapes_rect *limit, iso_shapes_rect *rect);

#endif
