/* depth_pyramid: the greatest depths of squares of a gbuffer, in a pyramid (the hierarchical z-buffer of
 * Greene, Kass and Miller 1993): tells whether a part of the scene is hidden by what has been drawn. This
 * takes the place of the occlusion queries of Guennebaud et al. 2004, section 7.1. */
#ifndef ISO_RENDER_SELECTION_DEPTH_PYRAMID_H
#define ISO_RENDER_SELECTION_DEPTH_PYRAMID_H

#include "base/memory.h"
#include "render/view/gbuffer.h"
#include "render/view/project.h"

enum {
    ISO_DEPTH_CELL = 8,
    ISO_DEPTH_LEVELS = 24
}; /* pixels along the side of a cell of level 0; most levels */

/* Zero-initialise; free with iso_depth_pyramid_free. */
typedef struct iso_depth_pyramid {
    iso_buffer memory;
    float
        *level[ISO_DEPTH_LEVELS]; /* the greatest depth in every cell; a cell of level k covers four of level
                                       k - 1 */
    int width[ISO_DEPTH_LEVELS], height[ISO_DEPTH_LEVELS]; /* cells */
    int levels;
} iso_depth_pyramid;

/* Makes the pyramid of a whole gbuffer. ISO_ERR_NOMEM. */
iso_status iso_depth_pyramid_make(iso_depth_pyramid *pyramid, const iso_gbuffer *gbuffer, iso_error *error);
/* Brings it up to date after something was drawn that covers pixels of `area` only. */
void iso_depth_pyramid_update(iso_depth_pyramid *pyramid, const iso_gbuffer *gbuffer, const iso_area *area);
/* Whether the gbuffer has at every pixel of `area` a depth less than area->nearest: nothing that lies there
 * would be seen. True for an empty area. False answers may be wrong, true ones are not. */
bool iso_depth_pyramid_hides(const iso_depth_pyramid *pyramid, const iso_area *area);
void iso_depth_pyramid_free(iso_depth_pyramid *pyramid);

#endif
