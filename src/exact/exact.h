/* exact: the trilinear isosurface itself, drawn without tracing rays.
 *
 * The cells that the surface crosses are kept; drawing projects them front to back and solves, for each pixel
 * that a cell covers and that is still free, for the first crossing of the isovalue along the pixel's ray,
 * from either side. What it draws is what iso_draw_raycast draws (to rounding): first change between "at or
 * above" and "below", cells with a NaN or infinite corner empty, normals interpolated from the corners'
 * central differences. Splatting cells instead of marching rays: after Parker, Shirley, Livnat, Hansen and
 * Sloan 1998, "Interactive ray tracing for isosurface rendering", whose cubic per cell this solves, and
 * Westover 1990, "Footprint evaluation for volume rendering", whose front-to-back order over cells it uses.
 */
#ifndef ISO_EXACT_EXACT_H
#define ISO_EXACT_EXACT_H

#include "base/parallel.h"
#include "grids/grid.h"
#include "image/image.h"
#include "render/raster/raster.h"
#include "render/shading/shading.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct iso_exact_opts {
    double isovalue; /* physical (grids/grid.h): of a level set, mm */
    iso_pool *pool;  /* borrowed until destroy; NULL: the calling thread */
} iso_exact_opts;

/* A consumer of a grid's change log that owns the crossed cells of one isovalue. Not thread-safe; different
 * ones are independent. */
typedef struct iso_exact iso_exact;

/* The grid is borrowed until destroy. ISO_ERR_USAGE: isovalue not finite. ISO_ERR_NOMEM. */
iso_status iso_exact_create(const iso_grid *grid, const iso_exact_opts *opts, iso_exact **exact,
                            iso_error *error);
void iso_exact_destroy(iso_exact *exact);

/* Brings the cells up to date: the first time (and after iso_exact_isovalue) all bricks, later only those
 * that the change log names. Call it after edits and before drawing: normals are read from the grid itself.
 * ISO_ERR_USAGE: isovalue not finite. ISO_ERR_NOMEM: call again; what is there is sound, but older, or lacks
 * bricks. */
iso_status iso_exact_update(iso_exact *exact, iso_error *error);

/* Changes the isovalue (physical); the next update starts anew. */
void iso_exact_isovalue(iso_exact *exact, double isovalue);

typedef struct iso_exact_totals {
    size_t cells;  /* crossed cells that are kept */
    size_t bricks; /* looked into by the last update */
    size_t bytes;  /* that they take */
} iso_exact_totals;
iso_exact_totals iso_exact_stats(const iso_exact *exact);

/* Box of the points where the surface crosses the edges of its cells, in the space that `affine` takes index
 * coordinates to (NULL: index coordinates); empty when there are none. */
iso_box iso_exact_bounds(const iso_exact *exact, const iso_affine *affine);

/* Draws as iso_draw_raycast does: replaces samples that lie farther. The same bytes for every thread count
 * and instruction set, and in strips of any height. ISO_ERR_NOMEM. */
iso_status iso_draw_exact(const iso_target *target, const iso_exact *exact, iso_error *error);

/* Where a picture goes. All borrowed for the call. */
typedef struct iso_exact_canvas {
    const iso_view *view;       /* of the image's size */
    const iso_shading *shading; /* its first colour is the surface's */
    iso_image *image;
    iso_pool *pool; /* NULL: the calling thread */
} iso_exact_canvas;

/* The picture of this surface alone, one sample a pixel: the bytes that iso_shade makes of an empty gbuffer
 * into which the surface was drawn, but sooner, as no gbuffer has to go rays memory. *covered (NULL is
 * fine): pixels that show the surface. ISO_ERR_NOMEM. */
iso_status iso_paint_exact(const iso_exact_canvas *canvas, const iso_exact *exact, size_t *covered,
                           iso_error *error);

#ifdef __cplusplus
}
#endif
#endif
