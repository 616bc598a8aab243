/* pullpush: render/pullpush/pullpush.h by OpenGL. Box and gaussian reconstruction by compute shaders;
 * discs by splatting (Botsch, Hornung, Zwicker and Kobbelt 2005): first the nearest depths, then sums
 * over the discs that lie behind these by less than a thickness. */
#ifndef ISO_RENDER_GL_PULLPUSH_H
#define ISO_RENDER_GL_PULLPUSH_H

#include "render/gl/engine.h"
#include "render/point_surface.h"

typedef struct iso_gl_pullpush_opts {
    const iso_view *view;                  /* borrowed */
    const iso_gl_surface *const *surfaces; /* of points; surfaces[i] gets surface number i in the gbuffer */
    int surface_count;
    iso_reconstruction reconstruction; /* CURVED, FLAT, BOX or GAUSSIAN */
    iso_point_selection selection;     /* of CURVED and FLAT */
} iso_gl_pullpush_opts;

/* Draws all surfaces and fills the whole gbuffer, which must have the view's size: what
 * iso_draw_point_surface draws, except for rounding; the same bytes every time.
 *
 * Box and gaussian: of points of one pixel with equal depth, normal and position in the pixel, the
 * smallest radius and the smallest colour (as a number with blue in the highest byte) count. Refined:
 * the front at a pixel is the nearest disc of all; the cpu engine takes discs in the order of their
 * blocks, so its averages may include a little more.
 *
 * With ISO_SELECTION_VISIBLE, flat discs of up to 1.5 pixels radius are up to six a pixel, the nearest ones
 * of each quarter of it and those that cover its centre, so pictures of denser points differ a little
 * from those of all points; no pixel is covered that would not be, or the other way round. Larger discs
 * are left out only where they are hidden. The surface remembers which blocks and points a picture has
 * shown, to draw them first in the next one; the bytes do not depend on it.
 *
 * ISO_SELECTION_AUTO leaves out hidden discs of any size, and no others: its pictures have the bytes of
 * those of all points. It does so in software renderers, if it saves time by an estimate from the blocks of
 * points in the view (iso_gl_selection_pays); GPUs, where this has not been measured, draw all points.
 *
 * Errors: ISO_ERR_NOMEM, ISO_ERR_LIMIT (free main memory with a software renderer; the driver's storage
 * buffers cannot hold a strip of the picture), ISO_ERR_BACKEND; the gbuffer is then undefined. */
iso_status iso_gl_draw_pullpush(iso_gl_engine *engine, const iso_gl_pullpush_opts *opts, iso_gbuffer *gbuffer,
                                iso_error *error);

/* The same over the picture that the gbuffer holds: its samples are replaced where a surface is nearer.
 * surfaces[i] gets surface number `first` + i. `triangles`: of the only surface, if it is hybrid (hybrid.h);
 * else NULL. */
typedef struct iso_gl_triangles iso_gl_triangles;
iso_status iso_gl_draw_pullpush_over(iso_gl_engine *engine, const iso_gl_pullpush_opts *opts, int first,
                                     const iso_gl_triangles *triangles, iso_gbuffer *gbuffer,
                                     iso_error *error);

/* About how many bytes of GPU memory (of main memory with a software renderer) drawing takes for a picture
 * of this size, for points with radii and colours. The exact number depends on the guard
 * band around the picture, and so on the points. */
uint64_t iso_gl_pullpush_bytes(const iso_gl_engine *engine, iso_reconstruction reconstruction, int width,
                               int height);

/* Bytes that selection takes in addition, without the 4.4 bytes a point that are allocated
 * with the first picture. */
uint64_t iso_gl_selection_bytes(int width, int height);

#endif
