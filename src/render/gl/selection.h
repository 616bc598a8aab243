/* selection: which points of a surface the discs of a tile are made of: deferred splatting (Guennebaud,
 * Barthe and Paulin 2004, section 4.1). Inside render/gl only; called by discs.c.
 *
 * The paper's passes for a frame, and what takes their place here:
 *
 *   1. Visibility splatting of the points seen in the frame before. Here: of those whose discs made the front
 *      of some pixel in it, which are few of those seen where points are dense.
 *   2. All points are drawn as pixels with their numbers, and the numbers are read back. Here: a vertex
 *      shader tests the discs of all blocks seen in the frame before against the deepest fronts of the
 *      squares of pixels that they reach, and marks those that are not hidden; a compute shader lists these
 *      for an indirect draw. So every disc is drawn that changes a pixel. It also marks discs that may make a
 *      front: small flat ones that are hit no farther than the front of some pixel, and all others. With
 *      ISO_SELECTION_VISIBLE small flat discs are chosen instead, without fronts: one minimum of depths for
 *      each of the four quarters of a pixel, and one for the discs that cover the pixel's centre; the points
 *      with these depths are visible. So there are up to six points a pixel, and every pixel that some disc
 *      covers stays covered.
 *   3. Visibility splatting of points that have become visible: those that may make a front by pass 2 and did
 *      not in the frame before. Then blocks that the fronts do not hide and that were not seen in the frame
 *      before are added in the same way, until there are none.
 *   4., 5. The sums of the discs that are not hidden, and their division (discs.c).
 *
 * Several surfaces in one picture are drawn one after the other, from the nearest on, each with marks of
 * its own frame before and its own placement in this frame, so that they may move, and each in the part of
 * the picture that it covers. What the samples of those drawn before hide is left out in the same way. (In
 * the paper all objects are drawn into one depth buffer, and pixels hold packed numbers of object and
 * point, which are sorted by object; here a point's mark belongs to its surface. The points of ten objects
 * as one surface, which is the most that one depth buffer could save, take as long:
 * tests/bench/gl_selection.c.)
 *
 * The frame before only decides what is drawn first. A point is left out only when all that it could change
 * lies behind the fronts, a block only when all that its points could change does, also by taking a quarter
 * of a pixel from points behind them: the picture has the same bytes as without a frame before. */
#ifndef ISO_RENDER_GL_SELECTION_H
#define ISO_RENDER_GL_SELECTION_H

#include "render/gl/discs_draw.h"

/* Whether the driver can select points of the surface, in tiles of at most this size: vertex shaders
 * need storage buffers, which must be large enough. Else all points are drawn. */
bool iso_gl_can_select(const iso_gl_surface *surface, int width, int height);

/* Whether it takes less time to leave out what is hidden. The costs of both passes are estimated from the
 * blocks in the view: it pays where much of the surface lies behind other parts of it, and the discs are so
 * many or so large that the tests cost less than they save; if there was a frame before, its points make the
 * fronts cheap. `room`: working memory. ISO_ERR_NOMEM. */
iso_status iso_gl_selection_pays(const iso_gl_discs_draw *draw, iso_buffer *room, bool *pays,
                                 iso_error *error);

/* How points of a block are selected, if its discs are not wider than the driver's points. */
iso_gl_block_kind iso_gl_block_kind_of(const iso_gl_discs_draw *draw, const iso_point_block *block);

/* Whether the picture that is drawn over (draw->before) hides everything that the block's points could
 * change. */
bool iso_gl_is_behind(const iso_gl_discs_draw *draw, const iso_point_block *block);

/* Sets which blocks of a tile, and which of their points, are drawn first: those seen in the frame
 * before, and those that made its fronts, if there was one. ISO_ERR_LIMIT. */
iso_status iso_gl_selection_begin(const iso_gl_discs_draw *draw, iso_gl_tile *tile, iso_error *error);

/* The passes for the dense and tested blocks that have draw commands, which must have been uploaded. Each
 * makes commands that draw a list of points (iso_gl_surface_draw_chosen). The tile's uniforms must be bound.
 * ISO_ERR_BACKEND.
 *
 * select_first: the chosen points of dense blocks, and the points of tested blocks that made fronts in
 * the frame before. select_revealed, when these are in the fronts: the points of tested blocks that may
 * change the fronts and did not make them before. select_last, when these are in the fronts, too: all
 * chosen and visible ones. */
iso_status iso_gl_select_first(const iso_gl_discs_draw *draw, const iso_gl_tile *tile, iso_error *error);
iso_status iso_gl_select_revealed(const iso_gl_discs_draw *draw, const iso_gl_tile *tile, iso_error *error);
iso_status iso_gl_select_last(const iso_gl_discs_draw *draw, const iso_gl_tile *tile, iso_error *error);

/* Finds which blocks the fronts hide. *revealed: the number of those that are neither hidden nor tested;
 * if there are any, the blocks that are not hidden are to be tested next. `room`: working memory.
 * ISO_ERR_NOMEM, ISO_ERR_BACKEND. */
iso_status iso_gl_find_hidden(const iso_gl_discs_draw *draw, iso_gl_tile *tile, iso_buffer *room,
                              size_t *revealed, iso_error *error);

/* Remembers the blocks that are seen for the next frame, and counts points. */
void iso_gl_selection_end(const iso_gl_discs_draw *draw, const iso_gl_tile *tile);

#endif
