/* strip: consecutive rows of a picture as a gbuffer of samples. iso_shade turns a strip into colours,
 * iso_strip_measure into depth, normals, coverage and ids. */
#ifndef ISO_RENDER_VIEW_STRIP_H
#define ISO_RENDER_VIEW_STRIP_H

#include "base/parallel.h"
#include "image/aov.h"
#include "image/camera.h"
#include "render/view/gbuffer.h"

enum { ISO_FACTOR_MAX = 8 }; /* samples along a pixel's side, at most */

typedef struct iso_strip {
    const iso_view *view;       /* of the samples */
    const iso_gbuffer *gbuffer; /* (picture's width * factor) x (rows * factor) samples */
    int factor;                 /* a pixel is factor x factor samples, 1 .. ISO_FACTOR_MAX */
    int y0;                     /* the strip's first row in the picture, pixels */
} iso_strip;

/* Writes depth, normal (world space), coverage and, if `aov` has planes for them, ids of the strip's pixels
 * into their rows of `aov`, which has the picture's width. image/aov.h says how the samples of a pixel are
 * averaged. Segments are 0, elements are the gbuffer's: image/aov.h counts them as files do. */
void iso_strip_measure(const iso_strip *strip, iso_aov *aov, iso_pool *pool);

#endif
