/* selection: which points of a surface the discs of a tile are made of: deferred splatting (Guennebaud,
 * Barthe and Paulin 2004, section 4.1). Inside render/gl only; called by refined.c.
 *
 * The paper's passes for a frame, and what takes their place here:
 *
 *   1. Visibility splatting of the points seen in the frame before. Here: of the visible points of the
 *      blocks seen in the frame before.
 *   2. All points are drawn as pixels with their numbers, and the numbers are read back. Here: one minimum
 *      of depths for each of the four quarters of a pixel, and one for the discs that cover the pixel's
 *      centre; the points with these depths are visible, and are listed by a compute shader for an indirect
 *      draw. So there are up to six points a pixel, and every pixel that some disc covers stays covered.
 *      Only small discs are chosen one by one; larger ones are left out by blocks alone.
 *   3. Visibility splatting of points that have become visible. Here: blocks that the fronts do not hide
 *      and that were not seen in the frame before are added, and passes 1 and 2 are repeated, until there
 *      are none.
 *   4., 5. The sums of the discs that are not hidden, and their division (refined.c).
 *
 * The frame before only decides which blocks are looked at first. A block is left out only when all that
 * its points could change, also by taking a quarter of a pixel from points behind them, lies behind the
 * fronts: the picture has the same bytes as without a frame before. */
#ifndef ISO_RENDER_GL_SELECTION_H
#define ISO_RENDER_GL_SELECTION_H

#include "render/gl/refined_draw.h"

/* Whether the driver can select points of the surface, in tiles of at most this size: vertex shaders
 * need storage buffers, which must be large enough. Else all points are drawn. */
bool iso_gl_can_select(const iso_gl_surface *surface, int width, int height);

/* Whether points of a block are chosen one by one. */
bool iso_gl_is_small(const iso_gl_refined_draw *draw, const iso_point_block *block);

/* Sets which blocks of a tile are looked at first: those seen in the frame before, if there was one. */
void iso_gl_selection_begin(const iso_gl_refined_draw *draw, iso_gl_tile *tile);

/* Chooses the visible points of the small blocks that have draw commands, which must have been uploaded, and
 * makes commands that draw them (iso_gl_surface_draw_chosen). The tile's uniforms must be
 * bound. ISO_ERR_BACKEND. */
iso_status iso_gl_select_points(const iso_gl_refined_draw *draw, const iso_gl_tile *tile, iso_error *error);
/* Makes such commands again, for other draw commands of blocks whose points have been chosen. */
iso_status iso_gl_list_chosen(const iso_gl_refined_draw *draw, const iso_gl_tile *tile, iso_error *error);

/* Finds which blocks the fronts hide. *revealed: the number of those that are neither hidden nor tested;
 * if there are any, the blocks that are not hidden are to be tested next. `room`: working memory.
 * ISO_ERR_NOMEM, ISO_ERR_BACKEND. */
iso_status iso_gl_find_hidden(const iso_gl_refined_draw *draw, iso_gl_tile *tile, iso_buffer *room,
                              size_t *revealed, iso_error *error);

/* Remembers the blocks that are seen for the next frame, and counts points. */
void iso_gl_selection_end(const iso_gl_refined_draw *draw, const iso_gl_tile *tile);

#endif
