/* solid: glyphs other than spheres: what a glyph's numbers mean, and its place in a picture. Internal to
 * shapes and render/gl.
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
static inline double iso_solid_radius_ratio(iso_glyph glyph) {
    return glyph == ISO_GLYPH_CONE ? 1.0 / 3 : 0.1;
}

/* The affine map of a glyph's unit solid: its centre relative to the glyph's position, and the images of the
 * unit vectors. */
typedef struct iso_solid_map {
    double centre[3], axis[3][3];
} iso_solid_map;

/* The map of a glyph; false: it cannot be drawn. */
bool iso_solid_map_of(const iso_shapes *shapes, uint32_t id, iso_solid_map *map);
/* The inverse of a map's axes: rows. */
void iso_solid_invert(const double axis[3][3], double inverse[3][3]);
/* How far the solid reaches from its glyph's position, mm. */
double iso_solid_extent(iso_glyph glyph, const iso_solid_map *map);

/* A glyph in view space, with the inverse of its map (rows). */
typedef struct iso_solid_placed {
    double centre[3], axis[3][3], inverse[3][3];
} iso_solid_placed;
iso_solid_placed iso_solid_in_view(const iso_shapes_frame *frame, const iso_solid_map *map,
                                   const double position[3]);
/* Whether floats suffice for a glyph that reaches `reach` mm from its position, whose depth is given. */
bool iso_solid_fits(const iso_shapes_frame *frame, const iso_solid_placed *placed, double depth,
                    double reach);
/* The glyph for tracing in double precision. */
iso_near_shape iso_solid_near(const iso_shapes_frame *frame, const iso_solid_placed *placed, uint32_t id);

/* How far a glyph reaches from its position, mm, or 0 when it cannot be drawn. For spheres: the radius. */
double iso_solid_reach(const iso_shapes *shapes, uint32_t id);

/* Adds a glyph to the bin's chunk, or draws it in double precision. `place`: in the order of blocks. */
void iso_solid_add(iso_shapes_bin *bin, const iso_shapes_block *block, uint32_t place);

/* What rays in double precision meet of a glyph other than a sphere, and the samples of `limit` that can see
 * it; false when there are none. *billboard: whether it is one, which is met by rays along the optical axis.
 */
bool iso_solid_place(const iso_shapes_frame *frame, const iso_shapes_block *block, uint32_t place,
                     const iso_shapes_rect *limit, iso_near_shape *shape, iso_shapes_rect *rect,
                     bool *billboard);

#endif
