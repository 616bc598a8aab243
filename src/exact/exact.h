/* exact: the trilinear isosurface itself, drawn without tracing rays.
 *
 * An iso_exact stores the cells that the surface crosses. Drawing projects them front to back and finds, for
 * each pixel that a cell covers and that shows nothing yet, the first crossing of the isovalue along the
 * pixel's ray, from either side. The picture is that of iso_draw_raycast, to rounding: the first change
 * between "at or above the isovalue" and "below"; cells with a NaN or infinite corner are empty; normals are
 * interpolated from the corners' central differences.
 *
 * Sources: Parker, Shirley, Livnat, Hansen and Sloan 1998, "Interactive ray tracing for isosurface
 * rendering", for the cubic that is solved in each cell; Westover 1990, "Footprint evaluation for volume
 * rendering", for projecting cells front to back instead of marching along rays. */
#ifndef ISO_EXACT_EXACT_H
#define ISO_EXACT_EXACT_H

#include "base/c_linkage.h"
#include "base/parallel.h"
#include "grids/grid.h"
#include "grids/grid_chunk.h"
#include "image/image.h"
#include "render/raster/raster.h"
#include "render/shading/shading.h"
#include "render/view/key_image.h"

ISO_C_BEGIN

typedef struct iso_exact_opts {
    double isovalue; /* physical (grids/grid.h): of a level set, mm */
    iso_pool *pool;  /* borrowed until destroy; NULL: the calling thread */
    /* The grid is that of this chunk: the cells are those of the chunk's bricks, numbered and drawn as in the
     * whole. Copied. Edits are not followed. NULL: the grid is the whole. */
    const iso_grid_chunk *chunk;
    /* The side of a cell in the index coordinates of iso_exact_bounds: 1/2 of a refined spline
     * (grids/spline/spline.h). 0: 1. */
    double cell_side;
} iso_exact_opts;

/* Owns the crossed cells of one isovalue, and follows the grid's change log. Not thread-safe; different
 * iso_exact objects are independent. */
typedef struct iso_exact iso_exact;

/* Creates an iso_exact without cells: iso_exact_update extracts them. The grid is borrowed until
 * iso_exact_destroy. ISO_ERR_USAGE: isovalue not finite. ISO_ERR_NOMEM. */
iso_status iso_exact_create(const iso_grid *grid, const iso_exact_opts *opts, iso_exact **exact,
                            iso_error *error);
void iso_exact_destroy(iso_exact *exact);

/* Extracts the cells of all bricks the first time and after iso_exact_set_isovalue, later only those of the
 * bricks that the change log names. Call it after edits and before drawing; normals are always computed from
 * the grid as it is when drawing. ISO_ERR_USAGE: isovalue not finite. ISO_ERR_NOMEM: the cells extracted so
 * far can be drawn, but may be out of date or incomplete; call iso_exact_update again. */
iso_status iso_exact_update(iso_exact *exact, iso_error *error);

/* Sets the isovalue (physical); the next update then extracts all bricks. */
void iso_exact_set_isovalue(iso_exact *exact, double isovalue);

typedef struct iso_exact_totals {
    size_t cells;  /* number of crossed cells stored */
    size_t bricks; /* number of bricks extracted by the last update */
    size_t bytes;  /* memory that the cells take */
} iso_exact_totals;
iso_exact_totals iso_exact_stats(const iso_exact *exact);

/* The box of the points where the surface crosses the edges of its cells, in the coordinates to which
 * `affine` maps index coordinates (NULL: in index coordinates). The box is empty if there are no crossed
 * cells. */
iso_box iso_exact_bounds(const iso_exact *exact, const iso_affine *affine);

/* Draws the surface into a gbuffer: replaces the samples that are farther than the surface. The gbuffer gets
 * the same bytes with every number of threads and instruction set, and when drawn in strips of any height.
 * ISO_ERR_NOMEM, ISO_ERR_LIMIT (more than 65536 x 32768 samples). */
iso_status iso_draw_exact(const iso_target *target, const iso_exact *exact, iso_error *error);

/* A picture to draw into a key image; all pointers are borrowed for the call. */
typedef struct iso_exact_key_picture {
    const iso_view *view; /* of the size of the key image's planes */
    iso_rgb color;        /* of the surface */
    iso_key_image *keys;  /* of one plane, or of three for caps, which are then drawn beside it */
    iso_pool *pool;       /* NULL: the calling thread */
    const iso_clip *clip; /* what is cut away of the surface; NULL: nothing */
} iso_exact_key_picture;

/* Draws the surface, or the chunk of it that the iso_exact has, into a key image: (the brick's place in the
 * drawing order of the whole) << 32 | RGBA. The iso_exact need not have been updated: bricks that the picture
 * may still show are read when they are met, and drawn without being stored. When all chunks of a surface
 * have been drawn, each once, in any order and into any number of key images that are then merged,
 * iso_key_image_paint makes of them the bytes of iso_paint_exact: a pixel belongs to the first cell of that
 * order that its ray crosses. ISO_ERR_NOMEM. */
iso_status iso_draw_exact_keys(const iso_exact_key_picture *picture, const iso_exact *exact,
                               iso_error *error);

/* A picture to paint; all pointers are borrowed for the call. */
typedef struct iso_exact_picture {
    const iso_view *view;       /* of all samples: of the image's size if there is one a pixel */
    const iso_shading *shading; /* the surface gets the first of its colours */
    iso_image *image;
    iso_pool *pool;       /* NULL: the calling thread */
    const iso_clip *clip; /* what is cut away of the surface; NULL: nothing */
    int factor;           /* a pixel is factor x factor samples (ISO_FACTOR_MAX at most); 1 or 0: one */
} iso_exact_picture;

/* Draws and shades this surface alone, without a gbuffer. Faster than iso_draw_exact into an empty gbuffer
 * followed by iso_shade, and gives the same bytes. *covered (may be NULL): the number of samples that show
 * the surface. ISO_ERR_NOMEM, ISO_ERR_LIMIT (more than 65536 x 32768 samples). */
iso_status iso_paint_exact(const iso_exact_picture *picture, const iso_exact *exact, size_t *covered,
                           iso_error *error);

ISO_C_END
#endif
