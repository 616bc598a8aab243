/* timer: how long passes take on the GPU. Inside render/gl only. */
#ifndef ISO_RENDER_GL_TIMER_H
#define ISO_RENDER_GL_TIMER_H

#include "render/gl/engine.h"
#include "render/gl/internal.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { ISO_GL_QUERIES = 64 };

/* Zero-initialise, but for what software renderers do to queries: llvmpipe's (Mesa 22.3) begin and end when a
 * framebuffer is drawn to, so that those around compute shaders measure anything but them. */
typedef struct iso_gl_timer {
    bool by_clock; /* passes are waited for and timed by the computer's clock */
    double start;  /* by which: of the pass that runs */
    iso_gl_pass running;
    unsigned queries[ISO_GL_QUERIES]; /* 0: not made so far */
    iso_gl_pass pass[ISO_GL_QUERIES]; /* what each measures */
    int pending;                      /* of them, not read so far */
    double seconds[ISO_GL_PASSES];
} iso_gl_timer;

/* With the context current. What is between the two is one pass; passes do not overlap. */
void iso_gl_timer_begin(iso_gl_timer *timer, const GladGLContext *gl, iso_gl_pass pass);
void iso_gl_timer_end(iso_gl_timer *timer, const GladGLContext *gl);
/* Adds up what has been measured, waiting for it. */
void iso_gl_timer_read(iso_gl_timer *timer, const GladGLContext *gl);
void iso_gl_timer_free(iso_gl_timer *timer, const GladGLContext *gl);

#ifdef __cplusplus
}
#endif
#endif
