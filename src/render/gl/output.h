/* output: destination of a drawing: a gbuffer in main memory, or a canvas. Inside render/gl only. */
#ifndef ISO_RENDER_GL_OUTPUT_H
#define ISO_RENDER_GL_OUTPUT_H

#include "render/gl/canvas.h"

typedef struct iso_gl_output {
    iso_gbuffer *gbuffer; /* NULL: the two below are set */
    iso_gl_canvas *canvas;
    const iso_gl_paint *paint;
} iso_gl_output;

iso_status iso_gl_draw_to(iso_gl_engine *engine, const iso_gl_draw_opts *opts, const iso_gl_output *to,
                          iso_error *error);
iso_status iso_gl_draw_pullpush_to(iso_gl_engine *engine, const iso_gl_pullpush_opts *opts,
                                   const iso_gl_output *to, iso_error *error);

/* Samples along a side of a pixel. Parts of a picture begin and end at whole pixels. */
static inline int iso_gl_output_factor(const iso_gl_output *to) {
    return to->gbuffer ? 1 : to->paint->factor;
}

/* Shades one part of a picture into the canvas. The part's samples are read from the engine's framebuffer, or
 * with `pullpush` from its picture buffer; its first sample is sample (x, y) of the picture. */
iso_status iso_gl_canvas_shade(const iso_gl_output *to, bool pullpush, const iso_view *part, int x, int y,
                               iso_error *error);

#endif
