/* discs: the method discs (render/discs/discs.h) by OpenGL. Inside render/gl only. */
#ifndef ISO_RENDER_GL_DISCS_H
#define ISO_RENDER_GL_DISCS_H

#include "render/gl/surface.h"
#include "render/selection/depth_pyramid.h"
#include "render/view/project.h"

typedef struct iso_gl_discs_style {
    bool flat;    /* curvatures are not used and discs are filtered (ISO_FLAT_DISCS_FILTERED) */
    bool widened; /* with `flat`: the filter widens what they cover, too (ISO_FLAT_DISCS_EWA) */
    /* VISIBLE: only visible points are drawn (render/gl/selection.h), where the driver can select them; AUTO:
     * only where it also pays, and without choosing some of those that share a pixel */
    iso_point_selection selection;
    const iso_rgb *color; /* of a surface whose points have none; the picture has colours then. NULL: none */
    /* The greatest depths of the picture that is drawn over, in the whole view: blocks of points behind them
     * are left out. They may be those of an earlier state of it. NULL: none is left out. */
    const iso_depth_pyramid *before;
} iso_gl_discs_style;

/* Draws the points of a surface over the samples in the buffer ISO_GL_STORE_PICTURE, which has the view's
 * size. iso_point_blocks_set_view must have been called for the view; the context must be current.
 * `area`: the part of the view that is drawn into; NULL: what the surface covers. `number` is the surface
 * number written into the picture, `room` working memory. ISO_ERR_NOMEM, ISO_ERR_BACKEND. */
iso_status iso_gl_draw_discs(const iso_gl_surface *surface, const iso_view *view, int number,
                             iso_gl_discs_style style, const iso_area *area, iso_buffer *room,
                             iso_error *error);

/* Bytes of GPU memory that drawing takes for a picture of this many samples. */
uint64_t iso_gl_disc_targets_bytes(uint64_t samples);
void iso_gl_disc_targets_free(iso_gl_disc_targets *discs, const GladGLContext *gl);

#endif
