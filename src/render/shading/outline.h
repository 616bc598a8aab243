/* outline: where a drawing of the picture would have lines: along silhouettes, in front of what lies far
 * behind (Saito and Takahashi 1990, "Comprehensible rendering of 3-D shapes": from depths), and along creases
 * (from normals). Lines of silhouettes lie on the nearer surface, those of creases on both sides. */
#ifndef ISO_RENDER_SHADING_OUTLINE_H
#define ISO_RENDER_SHADING_OUTLINE_H

#include "base/parallel.h"
#include "image/camera.h"
#include "render/view/gbuffer.h"

/* A colour of lines that stand out against the background. */
iso_rgb iso_outline_color(iso_rgb background, bool transparent);

/* How many rows of pixels above and below a row its lines depend on. */
int iso_outline_reach(double width);

/* Sets gbuffer->ink of rows first .. last, which has been allocated: 1 in lines of `width` pixels, else 0. A
 * pixel is factor x factor samples. The bytes are the same for every number of threads. */
void iso_outline_draw(const iso_view *view, int factor, double width, int first, int last,
                      const iso_gbuffer *gbuffer, iso_pool *pool);

#endif
