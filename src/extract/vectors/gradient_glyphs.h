/* gradient_glyphs: makes glyphs of the gradients of a grid at points of its isosurface; their lengths show
 * how sharp the edge is that the surface follows. */
#ifndef ISO_EXTRACT_VECTORS_GRADIENT_GLYPHS_H
#define ISO_EXTRACT_VECTORS_GRADIENT_GLYPHS_H

#include "base/glyphs.h"
#include "base/primitives.h"
#include "grids/grid.h"

/* A surface and the grid that it was extracted from, both borrowed. */
typedef struct iso_gradient_source {
    const iso_grid *grid;
    iso_point_view points;
} iso_gradient_source;

/* The number of glyphs that opts.every 0 aims at: blocks are chosen so large that about so many remain. */
enum { ISO_GRADIENT_GLYPHS_USUAL = 10000 };

/* Options. Zero means the default. */
typedef struct iso_gradient_glyphs_opts {
    int every; /* side of a block in voxels; each surface gets one glyph in each block; 0: chosen */
    /* Length in mm of a gradient of 1 per mm. 0: the length that 95 % of the gradients do not exceed is drawn
     * as the side of a block, and longer gradients are shortened to it. */
    double scale;
    uint64_t max_memory; /* limit in bytes; 0: 80 % of the available memory */
} iso_gradient_glyphs_opts;

typedef struct iso_gradient_glyphs_totals {
    int every;
    double scale;
    size_t points;  /* number of points of the surfaces */
    size_t missing; /* number of glyphs left out because the gradient is 0 or not finite */
} iso_gradient_glyphs_totals;

/* Makes a glyph at that point of each block which is nearest to the block's middle. Free with
 * iso_glyphs_free. The direction points out of the solid: against the gradient, or along it in a level set.
 * The column "gradient" contains the gradient's length in the grid's physical units per mm. ISO_ERR_LIMIT,
 * ISO_ERR_NOMEM. */
iso_status iso_gradient_glyphs(const iso_gradient_source *sources, int count,
                               const iso_gradient_glyphs_opts *opts, iso_glyphs *glyphs,
                               iso_gradient_glyphs_totals *totals, iso_error *error);

#endif
