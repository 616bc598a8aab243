/* shapes: draws solids of glyphs, and lines as tubes, into a gbuffer by intersecting the rays of pixels with
 * the solids' equations, inside their exact boxes in the picture: depth, normal and outline are exact, at any
 * distance, with perspective and parallel views, the eye inside a solid and the near plane through it.
 *
 * A tube is a chain of rounded cones: each segment is the convex hull of the spheres around its vertices, so
 * that joints have no gaps. A ribbon is a chain of bilinear patches, which share their edges at vertices.
 *
 * Source: Gumhold 2003, "Splatting illuminated ellipsoids with depth correction" (VMV), for splatting
 * quadrics by their boxes with the depth of each pixel; the discriminants are written relative to each
 * shape's own centre (shapes_kernel.c), so that floats suffice far from the eye. */
#ifndef ISO_RENDER_SHAPES_SHAPES_H
#define ISO_RENDER_SHAPES_SHAPES_H

#include "base/glyphs.h"
#include "base/lines.h"
#include "render/raster/raster.h"

/* How glyphs are projected. */
typedef enum iso_glyph_projection {
    ISO_GLYPH_PROJECTION_EXACT,
    /* Billboards (Aguirre, Gutierrez and Perrin 2010, "Rendering Large Point Datasets with GPU Shaders",
     * sections 3 and 4): each glyph is the picture of a parallel projection of it, on a plane through its
     * centre that is parallel to the picture. Outlines are too small, by 1 - sqrt(1 - (r / d)^2) of a
     * sphere's radius r at the distance d, and are not stretched beside the optical axis. The same as exact
     * in parallel views. Glyphs that the near plane cuts or that are huge in the picture are drawn exactly.
     */
    ISO_GLYPH_PROJECTION_BILLBOARD
} iso_glyph_projection;

typedef enum iso_caps { ISO_CAPS_ROUND, ISO_CAPS_FLAT } iso_caps;

/* What lines are drawn as. A ribbon is a strip without thickness that is perpendicular to the normals of its
 * line: a bilinear patch for each segment, shaded from both sides. */
typedef enum iso_line_style { ISO_LINE_TUBE, ISO_LINE_RIBBON } iso_line_style;

/* How lines in the pyramid of pull-push are shaded (render/pullpush/lines.h). */
typedef enum iso_line_shading { ISO_LINE_ROUND, ISO_LINE_ILLUMINATED } iso_line_shading;

typedef struct iso_shapes_opts {
    double radius;   /* mm; of glyphs and lines without radii; half the width of ribbons; NAN: the usual one
                        (base/lines.h) */
    double scale;    /* factor of all sizes, of lines: of their radii; 0 means 1 */
    iso_glyph glyph; /* the solid that is drawn at each point */
    iso_glyph_projection projection; /* of glyphs */
    iso_line_style style;
    /* Lines: a tube that would be narrower than so many pixels at a vertex has this width there; 0: tubes are
     * drawn as they are, with gaps where they miss the centres of pixels. A ribbon has it where it is seen
     * from the front: from its edge it has no width. */
    double min_pixels;
    iso_caps caps;            /* of the ends of tubes */
    iso_line_shading shading; /* of tubes in pull-push's pyramid; exact shapes are always round */
    /* Lines in pull-push's pyramid: vertices are dropped where neither the line nor its outline moves by more
     * than so many pixels; 0: none. */
    double drop_pixels;
} iso_shapes_opts;

/* A set of shapes that is prepared for drawing: sorted into blocks of neighbours, which are culled as one.
 * Immutable; any number of threads may draw it at the same time. */
typedef struct iso_shapes iso_shapes;

/* Prepares glyphs. The arrays of `glyphs` but for the positions are borrowed until iso_shapes_destroy. Takes
 * less than 16 bytes a glyph: 15 of its own (16 in sets of more than 2^24 glyphs) and 36 of a block of some
 * 128 glyphs.
 *
 * Sizes: cones, cylinders and arrows are as long as their direction; their radius (of an arrow: its head's)
 * is the glyph's, or the options', or a third (cones) or a tenth of the length. Discs are perpendicular to
 * their direction. Ellipsoids and boxes have the glyph's half axes, each at least 1e-4 of the longest, or the
 * radius in all directions. Glyphs are left out when a number is not finite, a size is 0 or negative, a
 * direction is 0 or axes lie in one plane (iso_shapes_stats counts them).
 *
 * Errors: ISO_ERR_USAGE when neither the set nor the options have the size or direction that the solid needs,
 * or a number of the options is out of range; ISO_ERR_LIMIT when there are 2^31 glyphs or more;
 * ISO_ERR_NOMEM. */
iso_status iso_shapes_from_glyphs(const iso_glyphs *glyphs, const iso_shapes_opts *opts, iso_shapes **shapes,
                                  iso_error *error);
/* Prepares lines as tubes or ribbons. The colours of `lines` and, for sets that are drawn translucent
 * (render/shapes/fragments.h), its starts are borrowed until iso_shapes_destroy; vertices are copied. Takes
 * 16 bytes a vertex, 22 of ribbons, and less than two a segment. Segments are left out when a vertex is not
 * finite, a radius is not a finite number of at least 0, both are 0 without a least width, or a ribbon's
 * normal is 0 or along the line. Errors: as for glyphs; ISO_ERR_USAGE when ribbons have no normals
 * (iso_lines_add_normals); ISO_ERR_LIMIT when there are 2^29 vertices or more. */
iso_status iso_shapes_from_lines(const iso_lines *lines, const iso_shapes_opts *opts, iso_shapes **shapes,
                                 iso_error *error);
void iso_shapes_destroy(iso_shapes *shapes);

typedef struct iso_shapes_totals {
    size_t shapes;  /* glyphs or segments that can be drawn */
    size_t skipped; /* that were left out */
    size_t blocks;
    size_t bytes; /* memory that the set takes */
} iso_shapes_totals;
iso_shapes_totals iso_shapes_stats(const iso_shapes *shapes);

/* World box of all shapes, each with the size of its own (glyphs: as far as they reach in any direction);
 * empty when there are none. */
iso_box iso_shapes_bounds(const iso_shapes *shapes);
/* The same in the coordinates that are the dot products of world positions with three vectors. */
iso_box iso_shapes_bounds_along(const iso_shapes *shapes, const iso_vec3 vectors[3]);

/* What calls of iso_draw_shapes have drawn: they add to it. Zero-initialise. */
typedef struct iso_shapes_drawn {
    size_t samples; /* that show a shape of the set */
    size_t widened; /* of these, samples of segments that were widened to the least width */
} iso_shapes_drawn;

/* Draws the shapes into a gbuffer: a sample is replaced when a shape is nearer than what it shows. Of equal
 * depths the earlier surface is kept. Where the set has colours, the gbuffer gets a plane of colours; those
 * of lines are interpolated between vertices. If the gbuffer has a plane of elements, it gets the numbers of
 * the glyphs and of the segments' first vertices. The gbuffer gets the same bytes for every instruction set
 * and number of threads, and when drawn in strips of any height. `drawn` may be NULL. ISO_ERR_NOMEM.
 *
 * The target's clip cuts the shapes: where it takes the front of one away its inside is seen. Cut shapes are
 * drawn in double precision, of lines all that have one; their widened samples are not counted. */
iso_status iso_draw_shapes(const iso_target *target, const iso_shapes *shapes, iso_shapes_drawn *drawn,
                           iso_error *error);

#endif
