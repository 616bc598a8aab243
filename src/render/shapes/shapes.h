/* shapes: draws the solids of a set of glyphs into a gbuffer by intersecting the rays of pixels with the
 * solids' equations, inside their exact boxes in the picture: depth, normal and outline are exact, at any
 * distance, with perspective and parallel views, the eye inside a solid and the near plane through it.
 *
 * Source: Gumhold 2003, "Splatting illuminated ellipsoids with depth correction" (VMV), for splatting
 * quadrics by their boxes with the depth of each pixel; the discriminants are written relative to each
 * shape's own centre (kernel_body.inc), so that floats suffice far from the eye. */
#ifndef ISO_RENDER_SHAPES_SHAPES_H
#define ISO_RENDER_SHAPES_SHAPES_H

#include "base/glyphs.h"
#include "render/raster/raster.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct iso_shapes_opts {
    iso_glyph glyph; /* the solid that is drawn at each point */
    double radius;   /* mm; of glyphs without radii */
    double scale;    /* factor of all sizes; 0 means 1 */
} iso_shapes_opts;

/* A set of shapes that is prepared for drawing: sorted into blocks of neighbours, which are culled as one.
 * Immutable; any number of threads may draw it at the same time. */
typedef struct iso_shapes iso_shapes;

/* Prepares glyphs. The arrays of `glyphs` but for the positions are borrowed until iso_shapes_destroy. Takes
 * 16 bytes a glyph and 48 a block of some 128 glyphs. Glyphs whose position is not finite, or whose size is
 * not a finite number above 0, are left out (iso_shapes_stats counts them). Errors: ISO_ERR_USAGE when
 * neither the set nor the options have the size or direction that the solid needs, or a number of the options
 * is out of range; ISO_ERR_LIMIT when there are 2^31 glyphs or more; ISO_ERR_NOMEM. */
iso_status iso_shapes_from_glyphs(const iso_glyphs *glyphs, const iso_shapes_opts *opts, iso_shapes **shapes,
                                  iso_error *error);
void iso_shapes_destroy(iso_shapes *shapes);

typedef struct iso_shapes_totals {
    size_t shapes;  /* that can be drawn */
    size_t skipped; /* glyphs that were left out */
    size_t blocks;
    size_t bytes; /* memory that the set takes */
} iso_shapes_totals;
iso_shapes_totals iso_shapes_stats(const iso_shapes *shapes);

/* World box of all shapes with their sizes, at most as large as the boxes of their blocks; empty when there
 * are none. */
iso_box iso_shapes_bounds(const iso_shapes *shapes);

/* Draws the shapes into a gbuffer: a sample is replaced when a shape is nearer than what it shows. Of equal
 * depths the earlier surface is kept. Where glyphs have colours, the gbuffer gets a plane of colours. The
 * gbuffer gets the same bytes for every instruction set and number of threads, and when drawn in strips of
 * any height. ISO_ERR_NOMEM. */
iso_status iso_draw_shapes(const iso_target *target, const iso_shapes *shapes, iso_error *error);

#ifdef __cplusplus
}
#endif
#endif
