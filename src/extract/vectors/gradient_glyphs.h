/* gradient_glyphs: the gradients of a grid at points of its isosurface, as directions of glyphs: how sharp an
 * edge the surface is. */
#ifndef ISO_EXTRACT_VECTORS_GRADIENT_GLYPHS_H
#define ISO_EXTRACT_VECTORS_GRADIENT_GLYPHS_H

#include "base/glyphs.h"
#include "base/primitives.h"
#include "grids/grid.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A surface and the grid that it was extracted from, both borrowed. */
typedef struct iso_gradient_source {
    const iso_grid *grid;
    iso_point_view points;
} iso_gradient_source;

/* With opts.every 0, blocks are so large that about so many glyphs remain. */
enum { ISO_GRADIENT_GLYPHS_USUAL = 10000 };

/* All zero means the default. */
typedef struct iso_gradient_glyphs_opts {
    int every; /* one glyph for each surface and block of so many voxels on each axis; 0: chosen */
    /* mm for a gradient of 1 per mm; 0: that which 95 % of the gradients do not exceed is as long as a block,
     * and so are the others. */
    double scale;
    uint64_t max_memory; /* bytes; 0: 80 % of what is available */
} iso_gradient_glyphs_opts;

typedef struct iso_gradient_glyphs_totals {
    int every;
    double scale;
    size_t points;  /* of the surfaces */
    size_t missing; /* glyphs left out: the gradient is 0 or not finite */
} iso_gradient_glyphs_totals;

/* Makes a glyph at the point of each block that is nearest to its middle; iso_glyphs_free when done. The
 * direction points out of the solid: against the gradient, or along it in a level set. The column "gradient"
 * has its length in the grid's physical units per mm. ISO_ERR_LIMIT, ISO_ERR_NOMEM. */
iso_status iso_gradient_glyphs(const iso_gradient_source *sources, int count,
                               const iso_gradient_glyphs_opts *opts, iso_glyphs *glyphs,
                               iso_gradient_glyphs_totals *totals, iso_error *error);

#ifdef __cplusplus
}
#endif
#endif
