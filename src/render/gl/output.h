/* output: where drawn samples go: back to main memory, or to a canvas. Inside render/gl only. */
#ifndef ISO_RENDER_GL_OUTPUT_H
#define ISO_RENDER_GL_OUTPUT_H

#include "render/gl/canvas.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct iso_gl_output {
    iso_gbuffer *gbuffer; /* or NULL, and: */
    iso_gl_canvas *canvas;
    const iso_gl_paint *paint;
} iso_gl_output;

iso_status iso_gl_draw_to(iso_gl_engine *engine, const iso_gl_draw_opts *opts, const iso_gl_output *to,
                          iso_error *error);
iso_status iso_gl_draw_pullpush_to(iso_gl_engine *engine, const iso_gl_pullpush_opts *opts,
                                   const iso_gl_output *to, iso_error *error);

/* Samples along a pixel: parts of pictures begin and end with whole pixels. */
static inline int iso_gl_output_factor(const iso_gl_output *to) {
    return to->gbuffer ? 1 : to->paint->factor;
}

/* A part of a picture that lies in the engine's framebuffer, or (`pullpush`) in its buffer, is shaded into
 * the canvas, its corner at sample x, y. */
iso_status iso_gl_canvas_shade(const iso_gl_output *to, bool pullpush, const iso_view *part, int x, int y,
                               iso_error *error);

#ifdef __cplusplus
}
#endif
#endif
