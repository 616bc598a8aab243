/* strip: rows of a picture as samples, which shading turns into colours and iso_strip_measure into numbers.
 */
#ifndef ISO_RENDER_STRIP_H
#define ISO_RENDER_STRIP_H

#include "base/parallel.h"
#include "image/aov.h"
#include "image/camera.h"
#include "render/gbuffer.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { ISO_FACTOR_MAX = 8 };

typedef struct iso_strip {
    const iso_view *view;       /* of the samples */
    const iso_gbuffer *gbuffer; /* (picture's width * factor) x (rows * factor) samples */
    int factor;                 /* a pixel is factor x factor samples, 1 .. ISO_FACTOR_MAX */
    int y0;                     /* the picture's row that the strip begins with */
} iso_strip;

/* Depth, normal and coverage of the strip's pixels, into their rows of `aov`, which has the picture's width:
 * of one sample its own values (the normal in world space), of several what image/aov.h says. */
void iso_strip_measure(const iso_strip *strip, iso_aov *aov, iso_pool *pool);

#ifdef __cplusplus
}
#endif
#endif
