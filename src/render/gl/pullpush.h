/* gl/pullpush: render/pullpush/pullpush.h by OpenGL: box and gaussian reconstruction by compute shaders,
 * refined by splats (Botsch, Hornung, Zwicker and Kobbelt 2005): the nearest depths first, then sums over the
 * discs that are no further behind these than their thickness. */
#ifndef ISO_RENDER_GL_PULLPUSH_H
#define ISO_RENDER_GL_PULLPUSH_H

#include "render/gl/engine.h"
#include "render/pullpush/pullpush.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct iso_gl_pullpush_opts {
    const iso_view *view;                /* borrowed */
    const iso_gl_surface *const *shapes; /* of points; shape i is surface i of the gbuffer */
    int shape_count;
    iso_reconstruction reconstruction;
} iso_gl_pullpush_opts;

/* Draws all shapes and fills the whole gbuffer, which has the view's size, with what iso_draw_pullpush draws
 * but for rounding, colours too; the same bytes every time. Box and gaussian: where points of one pixel are
 * alike in depth, normal and place, the smallest radius and the smallest colour (as a number, blue first)
 * count. Refined: in front is what is nearest at a pixel, while the cpu engine takes discs in their blocks'
 * order: where those behind come first, its means may have a little more in them. Errors: ISO_ERR_NOMEM,
 * ISO_ERR_LIMIT (a picture that the driver's storage buffers cannot hold rows of), ISO_ERR_BACKEND; the
 * gbuffer is then undefined. */
iso_status iso_gl_draw_pullpush(iso_gl_engine *engine, const iso_gl_pullpush_opts *opts, iso_gbuffer *gbuffer,
                                iso_error *error);

/* Bytes that drawing takes from the GPU, or where the driver has none from main memory, for pictures of this
 * many samples, with all that points may have (refined: but colours): about, since how wide the guard band
 * around the picture is depends on the points. */
uint64_t iso_gl_pullpush_bytes(const iso_gl_engine *engine, iso_reconstruction reconstruction, int width,
                               int height);

#ifdef __cplusplus
}
#endif
#endif
